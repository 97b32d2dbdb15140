//! Edits of a model between two uses of a computation that keeps simulations of it.

use std::sync::Arc;

use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;

/// Returns `true` if a simulation has another model than this one, because its model has been
/// edited. `what` names the simulation in an error.
///
/// # Errors
///
/// [`Error::OtherModel`] if the models have different structures.
pub(crate) fn is_edited(model: &Arc<Model>, data: &Data, what: &'static str) -> Result<bool> {
    if Arc::ptr_eq(model, data.model()) {
        return Ok(false);
    }
    if !model.is_same_structure(data.model()) {
        return Err(Error::OtherModel { what });
    }
    Ok(true)
}
