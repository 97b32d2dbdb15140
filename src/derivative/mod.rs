//! Derivatives of a step of the simulation ([`Data::transition_fd`](crate::Data::transition_fd))
//! and of inverse dynamics ([`Data::inverse_fd`](crate::Data::inverse_fd)).
//!
//! With the state difference `dx = [dq; dv; da]` of length `2 nv + na`, where `dq` is in the
//! tangent space of positions
//! ([`Model::differentiate_pos_into`](crate::Model::differentiate_pos_into)), a step of the
//! simulation is to first order
//!
//! ```text
//! dx' = A dx + B du        dy = C dx + D du
//! ```
//!
//! and [`Data::transition_fd`](crate::Data::transition_fd) computes A, B, C and D at the present
//! state and controls. A [`Lineariser`] computes them faster, repeatedly, in several threads, and
//! along trajectories. It either differences steps, as the engine does, or differentiates the
//! equations of motion implicitly: from differences of inverse dynamics, or in closed form.
//!
//! [`Lineariser::parameter_jacobian`] differentiates the same steps by parameters of the model,
//! `dx' = ∂f/∂θ dθ`, [`Lineariser::cost_gradient`] a cost along a trajectory by everything that it
//! depends on.
//!
//! The derivatives of differences and sums of quaternions are in
//! [`math`](crate::math::sub_quat_derivative).

mod actuation;
mod adjoint;
mod analytic;
mod columns;
mod convergence;
mod implicit;
mod input_columns;
mod inverse;
mod kinks;
mod lineariser;
mod method;
pub(crate) mod newton;
mod parameter;
mod parameter_jacobian;
mod perturbation;
mod residual;
mod rotation;
mod support;
mod trajectory;
mod transition;
mod worker;

pub use self::inverse::{InverseJacobians, InverseOutputs};
pub use self::lineariser::Lineariser;
pub use self::method::{DifferencedTerms, Fallback, Kinks, LinearisationReport, TransitionMethod, TransitionOptions};
pub use self::parameter::{InertialParameters, ModelParameter, ParameterJacobian, ParameterOutputs};
pub use self::trajectory::{CostGradient, CostSlopes};
pub(crate) use self::transition::sizes;
pub use self::transition::{StateSpace, TransitionOutputs};
use crate::error::{Error, Result};
use crate::macros::with_aliases;

with_aliases! {
    pub use self::inverse::{InverseForce = "flg_actuation"};
}

/// Smallest step of differences. With a smaller one, rounding would silently make them zero.
const MIN_EPS: f64 = 1e-12;
/// Largest step of differences. With a larger one, they do not approximate a derivative.
const MAX_EPS: f64 = 1.0;

/// Scheme of finite differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Differences {
    /// `(f(x + ε) − f(x)) / ε`: one evaluation for each column; the error is of order ε.
    Forward,
    /// `(f(x + ε) − f(x − ε)) / 2ε`: two evaluations for each column; the error is of order ε².
    #[doc(alias = "centered")]
    Central,
}

fn check_eps(call: &str, eps: f64) -> Result<()> {
    if (MIN_EPS..=MAX_EPS).contains(&eps) {
        return Ok(());
    }
    Err(Error::out_of_range(format!("eps of {call}"), eps, format!("between {MIN_EPS:e} and {MAX_EPS}")))
}
