//! Relation of two models, which decides if a simulation of one can serve the other.

use std::sync::Arc;

use super::Model;
use crate::error::{Error, Result};

/// Relation of two models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// The same object.
    Same,
    /// Copies of one model, with different edits. Ids and simulations of one are valid for the
    /// other.
    Copies,
    /// Models that were loaded separately.
    Unrelated,
}

impl Model {
    /// Returns the relation to another model.
    pub(crate) fn relation(self: &Arc<Self>, other: &Arc<Self>) -> Relation {
        if Arc::ptr_eq(self, other) {
            Relation::Same
        } else if self.is_same_structure(other) {
            Relation::Copies
        } else {
            Relation::Unrelated
        }
    }
}

impl Relation {
    /// Returns [`Error::OtherModel`] for unrelated models. `what` names the value of the other
    /// model.
    pub(crate) fn check(self, what: &'static str) -> Result<Self> {
        if self == Self::Unrelated { Err(Error::OtherModel { what }) } else { Ok(self) }
    }
}
