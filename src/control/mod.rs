//! Control: what decides on `ctrl` at every step.
//!
//! | file | what is in it |
//! |---|---|
//! | `riccati.rs` | the discrete algebraic Riccati equation |
//! | `lqr.rs` | the linear-quadratic regulator |
//! | `time_varying.rs` | the regulator along a trajectory: a table of gains |
//! | `ilqr.rs` | trajectories of least cost, by the iterative regulator |
//! | `feedback.rs` | the deviation from a set-point, and what a gain makes of it |
//! | `simple.rs` | zero, random and PD controllers |

mod feedback;
pub mod ilqr;
mod lqr;
pub mod riccati;
mod simple;
mod time_varying;

pub use self::lqr::{Lqr, LqrWeights};
pub use self::simple::{PdController, RandomController, ZeroController};
pub use self::time_varying::TimeVaryingLqr;
use crate::data::Data;
use crate::error::Result;

/// What sets the controls of a simulation, once before every step.
///
/// A closure is one. It may return nothing, or a [`Result`]:
///
/// ```
/// use mujoco_safe::{Controller, Data, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut push = |data: &mut Data| data.ctrl_mut()[0] = 0.1;
/// for _ in 0..10 {
///     push.control(&mut data)?;
///     data.step()?;
/// }
/// assert!(data.qpos()[0] > 0.0);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub trait Controller {
    /// Sets the controls for the present state.
    ///
    /// # Errors
    ///
    /// Whatever the controller cannot do; the caller does not step then.
    fn control(&mut self, data: &mut Data) -> Result<()>;
}

/// What a closure that is a [`Controller`] may return: `()`, or `Result<()>`.
pub trait Outcome {
    /// As a result.
    ///
    /// # Errors
    ///
    /// The closure's own.
    fn into_result(self) -> Result<()>;
}

impl Outcome for () {
    fn into_result(self) -> Result<()> {
        Ok(())
    }
}

impl Outcome for Result<()> {
    fn into_result(self) -> Result<()> {
        self
    }
}

impl<F, O> Controller for F
where
    F: FnMut(&mut Data) -> O,
    O: Outcome,
{
    fn control(&mut self, data: &mut Data) -> Result<()> {
        self(data).into_result()
    }
}
