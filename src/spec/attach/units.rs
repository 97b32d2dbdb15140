//! Units and conventions of angles in the text of a model.

use super::super::tree::{Index, Tree};
use super::super::{names, paths, value};
use crate::error::{Error, InvalidKind, Result};

/// Settings of `compiler` on angles.
#[derive(Clone, PartialEq)]
pub(super) struct Angles {
    /// Radians in a unit.
    pub(super) unit: f64,
    /// Order of Euler angles.
    pub(super) eulerseq: String,
}

impl Angles {
    pub(super) fn of(tree: &Tree) -> Self {
        let unit = if paths::setting(tree, "angle") == Some("radian") { 1.0 } else { 1_f64.to_radians() };
        Self { unit, eulerseq: paths::setting(tree, "eulerseq").unwrap_or("xyz").to_owned() }
    }

    /// Converts a number to the unit of other settings.
    pub(super) fn in_unit_of(&self, new: &Self, number: f64) -> f64 {
        number * self.unit / new.unit
    }
}

/// Parses the numbers of an attribute.
pub(super) fn parsed(tree: &Tree, index: Index, attribute: &str, text: &str) -> Result<Vec<f64>> {
    value::numbers(text).ok_or_else(|| {
        let what = format!("attribute '{attribute}' of {}", names::describe(tree, index));
        Error::invalid(InvalidKind::Text, what, format!("'{text}'"), "a list of numbers")
    })
}
