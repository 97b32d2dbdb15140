//! Custom texts.

use std::borrow::Cow;

use super::{View, range};
use crate::id::kind;
use crate::model::Model;

fields!(Text on Model {
    /// The text. A file may hold bytes that are not UTF-8; those come as replacement characters, in a copy.
    #[doc(alias = "text_data")]
    #[doc(alias = "text_adr")]
    #[doc(alias = "text_size")]
    data: {Cow<'a, str>} = |text| String::from_utf8_lossy(text.bytes());
});

impl<'a> View<'a, Model, kind::Text> {
    /// The bytes of the text, without the NUL byte that ends it in the engine's array.
    pub fn bytes(&self) -> &'a [u8] {
        let with_end = &self.owner.text_data()[range(self.owner.text_adr(), self.owner.text_size(), self.index())];
        with_end.strip_suffix(&[0]).unwrap_or(with_end)
    }
}
