//! Optimal control: linear-quadratic regulators, the Riccati equation and trajectory optimisation.
//!
//! [`Lqr`] holds a simulation at a set-point, [`TimeVaryingLqr`] holds it on a trajectory, and
//! [`ilqr`] finds trajectories of minimal cost. [`residual`] composes costs from weighted norms of
//! poses, velocities, momenta, sensors and controls. [`predictive`] repeats the optimisation from
//! the present state of a running simulation. [`riccati`] solves the equation behind the
//! regulators. Simple controllers are in [`controller`](crate::controller).

mod feedback;
#[doc(alias = "ddp")]
#[doc(alias = "trajectory optimisation")]
#[doc(alias = "trajectory optimization")]
pub mod ilqr;
mod lqr;
#[doc(alias = "mpc")]
#[doc(alias = "model predictive control")]
#[doc(alias = "receding horizon")]
pub mod predictive;
pub mod residual;
pub mod riccati;
mod time_varying;
mod weights;

pub use self::lqr::Lqr;
pub use self::time_varying::TimeVaryingLqr;
pub use self::weights::LqrWeights;
use crate::error::Error;

impl From<riccati::RiccatiError> for Error {
    fn from(error: riccati::RiccatiError) -> Self {
        Self::Solver(Box::new(error))
    }
}
