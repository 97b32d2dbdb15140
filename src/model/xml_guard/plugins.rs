//! References to instances of engine plugins.
//!
//! The compiler of 3.5 crashes on a reference to an instance that does not exist.

use std::collections::HashSet;

use super::tags::Tag;

/// Names of the instances of a model, and of those that its elements use.
#[derive(Default)]
pub(super) struct Plugins {
    instances: HashSet<Vec<u8>>,
    used: Vec<Vec<u8>>,
}

impl Plugins {
    /// Records a tag.
    pub(super) fn record(&mut self, tag: &Tag<'_>) {
        let name = |attribute: &[u8]| tag.attribute(attribute).filter(|name| !name.is_empty());
        match tag.name {
            b"instance" => self.instances.extend(name(b"name").map(std::borrow::Cow::into_owned)),
            b"plugin" => self.used.extend(name(b"instance").map(std::borrow::Cow::into_owned)),
            _ => {}
        }
    }

    /// Returns the reason to reject the model.
    pub(super) fn check(&self) -> Option<String> {
        if cfg!(any(not(engine_since = "2.3.0"), engine_since = "3.17.0")) {
            return None;
        }
        let unknown = self.used.iter().find(|name| !self.instances.contains(*name))?;
        Some(format!("the plugin instance '{}' does not exist", String::from_utf8_lossy(unknown)))
    }
}
