//! Conversion of a model into the shared model of a simulation.

use std::sync::Arc;

use super::Model;
use crate::id::sealed::Sealed;

/// Model that a simulation can share: a [`Model`], an `Arc<Model>`, or an `&Arc<Model>`, whose
/// clone is cheap.
///
/// Several simulations of one model share it in an [`Arc`]:
///
/// ```
/// use std::sync::Arc;
/// use mujoco_safe::{Data, sample};
///
/// let model = Arc::new(sample::cartpole());
/// let first = Data::new(&model)?;
/// let second = Data::new(model.clone())?;
/// let third = Data::new(first.model())?;
/// assert!(Arc::ptr_eq(&model, second.model()) && Arc::ptr_eq(&model, third.model()));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// An `&Model` is rejected, because a copy of the model is expensive:
///
/// ```compile_fail,E0277
/// use mujoco_safe::{Data, sample};
///
/// let model = sample::cartpole();
/// let data = Data::new(&model); // `&Model` is not a model that a simulation can share
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a model that a simulation can share",
    label = "expected a `Model` or an `Arc<Model>`",
    note = "pass the `Model`, or keep it in an `Arc<Model>` and pass the `Arc`, its `clone()` or a reference to it, which are cheap"
)]
pub trait IntoModel: Sealed {
    /// Returns the shared model.
    fn into_model(self) -> Arc<Model>;
}

impl IntoModel for Model {
    fn into_model(mut self) -> Arc<Model> {
        self.edit().tighten_bounds();
        Arc::new(self)
    }
}

impl Sealed for Arc<Model> {}

impl IntoModel for Arc<Model> {
    fn into_model(self) -> Self {
        self
    }
}

impl Sealed for &Arc<Model> {}

impl IntoModel for &Arc<Model> {
    fn into_model(self) -> Arc<Model> {
        self.clone()
    }
}
