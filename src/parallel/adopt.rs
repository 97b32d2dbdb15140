//! Edits of a model between two uses of a computation that keeps simulations of it.

use std::sync::Arc;

use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;

/// Replaces a model by the model of a simulation if they differ, because the simulation's model has
/// been edited. Returns `true` if they differ. `what` names the simulation in an error.
///
/// # Errors
///
/// [`Error::OtherModel`] if the models have different structures.
pub(crate) fn adopt_model(model: &mut Arc<Model>, data: &Data, what: &'static str) -> Result<bool> {
    if Arc::ptr_eq(model, data.model()) {
        return Ok(false);
    }
    if !model.is_same_structure(data.model()) {
        return Err(Error::OtherModel { what });
    }
    *model = data.model().clone();
    Ok(true)
}
