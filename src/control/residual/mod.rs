//! Costs as residuals: weighted norms of functions of the state and the controls.
//!
//! A [`ResidualCost`] is the sum over [`Term`]s
//!
//! ```text
//! cost(x, u) = Σ_t w_t Σ_i ρ_t(s_ti r_ti(x, u))
//! ```
//!
//! with a weight w, a [`Norm`] ρ, scales s and a residual r, such as the distance of a hand from
//! its target. It is a [`TrajectoryCost`](super::ilqr::TrajectoryCost): [`Ilqr`](super::ilqr::Ilqr)
//! minimises it. Weights, norms and targets can change between two searches.
//!
//! | residual | components | unit |
//! |---|---|---|
//! | [`JointPosition`] | difference of joint positions from a target, in tangent coordinates | m, rad |
//! | [`JointVelocity`] | difference of joint velocities from a target | m/s, rad/s |
//! | [`FramePosition`] | position of a body or a site relative to a target, world frame | m |
//! | [`FramePose`] | position and orientation, also relative to another frame that moves | m, rad |
//! | [`Gaze`] | direction of an axis of a frame, minus the direction to a point | 1 |
//! | [`JointCoupling`] | linear combination of joint positions, minus a target | m, rad |
//! | [`FrameOrientation`] | rotation vector from a target to the orientation of a body or a site | rad |
//! | [`Subtree`] | centre of mass of a subtree, its velocity, or the angular momentum, minus a target | m, m/s, kg·m²/s |
//! | [`SensorReading`] | reading of a sensor, minus a target | of the sensor |
//! | [`Controls`] | controls, minus a target | of the actuators |
//!
//! These have Jacobians in closed form. Implement [`Residual`] for others, with a Jacobian or with
//! differences.
//!
//! # Derivatives
//!
//! With the Jacobian J of the scaled residual, the gradient of a term is `w Jᵀ ρ′`, and the second
//! derivatives are approximated by `w Jᵀ diag(ρ″) J`, without the second derivatives of the
//! residual (the Gauss–Newton approximation; J. Nocedal and S. J. Wright, *Numerical Optimization*,
//! 2006, chapter 10). This matrix is positive semidefinite, because the norms are convex.

mod controls;
mod cost;
mod coupling;
mod evaluator;
mod frame;
mod gaze;
mod jacobian;
mod joint;
mod momentum;
mod norm;
mod pose;
mod sensor;
mod subtree;
mod term;

pub use self::controls::Controls;
pub use self::cost::ResidualCost;
pub use self::coupling::JointCoupling;
pub use self::frame::{Frame, FrameOrientation, FramePosition};
pub use self::gaze::Gaze;
pub use self::jacobian::ResidualJacobian;
pub use self::joint::{JointPosition, JointVelocity};
pub use self::norm::Norm;
pub use self::pose::FramePose;
pub use self::sensor::SensorReading;
pub use self::subtree::Subtree;
pub use self::term::Term;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::id::Lineage;

/// Results of the pipeline that a [`Residual`] reads, apart from the state and the controls. Each
/// includes the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Needs {
    /// None: positions, velocities, activations, controls and other inputs suffice.
    State,
    /// Poses, centres of mass, and what [`Data::jac_site`] and similar functions need:
    /// [`Data::kinematics`] and [`Data::com_pos`].
    Poses,
    /// Velocities of bodies and momenta of subtrees: [`Data::com_vel`] and [`Data::subtree_vel`].
    Velocities,
    /// All results of [`Data::forward`], such as contacts, accelerations and sensor readings. It
    /// takes about as long as a step.
    Forward,
}

impl Needs {
    /// Computes the results.
    pub(crate) fn compute(self, data: &mut Data) -> Result<()> {
        if self == Self::Forward {
            data.forward()?;
            return data.subtree_vel();
        }
        if self >= Self::Poses {
            data.kinematics()?;
            data.com_pos()?;
        }
        if self >= Self::Velocities {
            data.com_vel()?;
            data.subtree_vel()?;
        }
        Ok(())
    }
}

/// Vector function of the state and the controls, for a [`Term`] of a [`ResidualCost`].
///
/// ```
/// use mujoco_safe::control::ilqr::TrajectoryCost;
/// use mujoco_safe::control::residual::{Needs, Residual, ResidualCost, Term};
/// use mujoco_safe::{Data, Result, sample};
///
/// /// Kinetic and potential energy of the pole relative to that at rest in the upright position, J.
/// struct Energy;
///
/// impl Residual for Energy {
///     fn size(&self) -> usize {
///         1
///     }
///
///     fn needs(&self) -> Needs {
///         Needs::State
///     }
///
///     fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
///         let (angle, rate) = (data.qpos()[1], data.qvel()[1]);
///         residual[0] = 0.5 * 0.1 * rate * rate + 2.0 * (angle.cos() - 1.0);
///         Ok(())
///     }
/// }
///
/// let cost = ResidualCost::new(sample::cartpole(), [Term::new("energy", Energy)])?;
/// assert_eq!(cost.value(0, &[0.0, 0.0, 0.0, 2.0], Some(&[0.0]))?, 0.5 * 0.2 * 0.2);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub trait Residual: Send + Sync {
    /// Returns the number of components.
    fn size(&self) -> usize;

    /// Returns the results that [`evaluate`](Self::evaluate) and
    /// [`differentiate`](Self::differentiate) read.
    fn needs(&self) -> Needs;

    /// Writes the residual of the present state and controls of a simulation. At the end of a
    /// trajectory, controls are zero. The state must not be changed.
    ///
    /// # Errors
    ///
    /// Any error of the residual.
    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()>;

    /// Writes the Jacobian, whose entries are zero before the call. By default calls
    /// [`ResidualJacobian::difference`], which is slow.
    ///
    /// # Errors
    ///
    /// Any error of the residual.
    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        jacobian.difference(self, data)
    }

    /// Returns the target for [`Term::set_target`], if there is one.
    fn target_mut(&mut self) -> Option<&mut [f64]> {
        None
    }
}

/// Checks that a simulation is of the model that a residual was created for.
fn check_model(data: &Data, lineage: Lineage) -> Result<()> {
    if data.model().lineage() == lineage { Ok(()) } else { Err(Error::OtherModel { what: "a residual" }) }
}

/// Writes the difference of two vectors.
fn subtract(values: &[f64], target: &[f64], residual: &mut [f64]) {
    for ((residual, value), target) in residual.iter_mut().zip(values).zip(target) {
        *residual = value - target;
    }
}
