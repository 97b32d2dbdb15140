//! Derivatives by finite differences: of a step of the simulation ([`Data::transition_fd`](crate::Data::transition_fd)), and of
//! inverse dynamics ([`Data::inverse_fd`](crate::Data::inverse_fd)).
//!
//! With the state difference `dx = [dq; dv; da]` of length `2 nv + na`, where `dq` is in the tangent space of positions
//! ([`Model::differentiate_pos`](crate::Model::differentiate_pos)), one step of the simulation is to first order
//!
//! ```text
//! dx' = A dx + B du        dy = C dx + D du
//! ```
//!
//! and [`Data::transition_fd`](crate::Data::transition_fd) computes A, B, C and D at the present state and controls. A
//! [`Lineariser`] does so faster, again and again, in several threads, and along trajectories.
//!
//! The derivatives of differences and sums of quaternions are in [`math`](crate::math::sub_quat_derivative).

mod actuation;
mod columns;
mod implicit;
mod inverse;
mod linear_algebra;
mod lineariser;
mod method;
mod newton;
mod perturbation;
mod residual;
mod transition;
mod work_queue;
mod worker;

pub use self::inverse::{InverseJacobians, InverseOutputs};
pub use self::lineariser::Lineariser;
pub use self::method::{Fallback, LinearisationReport, TransitionMethod, TransitionOptions};
pub(crate) use self::transition::sizes;
pub use self::transition::{StateSpace, TransitionOutputs};
use crate::error::{Error, Result};

/// Below this the differences drown in rounding, and would be zeros without a word.
const SMALLEST_EPS: f64 = 1e-12;
/// Beyond this they are no derivative.
const LARGEST_EPS: f64 = 1.0;

/// How a derivative is approximated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Differences {
    /// `(f(x + ε) − f(x)) / ε`: one more evaluation for each column; an error of the order of ε.
    Forward,
    /// `(f(x + ε) − f(x − ε)) / 2ε`: two for each column; an error of the order of ε².
    #[doc(alias = "centered")]
    Central,
}

fn check_eps(call: &str, eps: f64) -> Result<()> {
    if (SMALLEST_EPS..=LARGEST_EPS).contains(&eps) {
        return Ok(());
    }
    Err(Error::invalid(format!("eps of {call}"), eps, format!("between {SMALLEST_EPS:e} and {LARGEST_EPS}")))
}
