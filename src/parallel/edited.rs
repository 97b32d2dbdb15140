//! Edits of a model between two uses of a computation that keeps simulations of it.

use std::sync::Arc;

use crate::data::Data;
use crate::error::Result;
use crate::model::{Model, Relation};

/// Returns `true` if a simulation has another model than this one, because its model has been
/// edited. `what` names the simulation in an error.
///
/// # Errors
///
/// [`Error::OtherModel`](crate::Error::OtherModel) if the models have different structures.
pub(crate) fn is_edited(model: &Arc<Model>, data: &Data, what: &'static str) -> Result<bool> {
    Ok(model.relation(data.model()).check(what)? == Relation::Copies)
}
