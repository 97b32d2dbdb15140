//! Return types of closures.

use super::Result;

/// Return type of a closure that may fail: nothing, or a [`Result`].
///
/// A call with such a closure returns the closure's error as its own, so one `?` is enough. A
/// closure for [`Data::edit_model`](crate::Data::edit_model) can return a value in `Ok`; the other
/// closures of this crate, such as a [`Controller`](crate::Controller) or the edit of a
/// [`with_model_edits`](crate::Rollout::with_model_edits), return `()` or `Result<()>`.
///
/// ```
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.edit_model(|model| model.body_mass_mut()[1] = 10.0)?;
/// data.edit_model(|model| model.set_timestep(0.002))?;
/// let mass = data.edit_model(|model| Ok(model.total_mass()))?;
/// assert!(mass > 10.0);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// A value without `Ok` is rejected:
///
/// ```compile_fail,E0277
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid()).unwrap();
/// let mass = data.edit_model(|model| model.total_mass()); // a closure of this call cannot return `f64`
/// ```
#[diagnostic::on_unimplemented(
    message = "a closure of this call cannot return `{Self}`",
    label = "expected `()` or a `Result` with `mujoco_safe::Error`",
    note = "end the closure with `;` to return nothing, or return the value in `Ok(…)` where the call accepts one"
)]
pub trait Outcome {
    /// Type of the value without the error.
    type Value;

    /// Converts the return value to a result.
    ///
    /// # Errors
    ///
    /// The error that the closure returned.
    fn into_result(self) -> Result<Self::Value>;
}

impl Outcome for () {
    type Value = ();

    fn into_result(self) -> Result<()> {
        Ok(())
    }
}

impl<T> Outcome for Result<T> {
    type Value = T;

    fn into_result(self) -> Self {
        self
    }
}
