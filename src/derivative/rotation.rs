//! Derivatives of the integration of the quaternions of ball and free joints.

use crate::enums::JointType;
use crate::ffi;
use crate::math;
use crate::model::Model;

/// Derivatives of the integration of a quaternion. `dof` is the first of its three degrees of
/// freedom.
#[derive(Clone, Debug)]
pub(super) struct Rotation {
    pub(super) dof: usize,
    /// Row-major `(3, 3)`: derivative of the next rotation by the present one.
    pub(super) by_position: [f64; 9],
    /// Row-major `(3, 3)`: derivative of the next rotation by the angle `h ω` of the step.
    pub(super) by_velocity: [f64; 9],
}

/// Writes the derivatives for all quaternions of a model. `next_velocity` returns the velocity of a
/// degree of freedom after a step.
pub(super) fn differentiate(model: &Model, next_velocity: impl Fn(usize) -> f64, rotations: &mut Vec<Rotation>) {
    rotations.clear();
    let h = model.raw().opt.timestep;
    for (&kind, &dof) in model.jnt_type().iter().zip(model.jnt_dofadr()) {
        let dof = match JointType::of_field(kind) {
            JointType::Free => ffi::size(dof) + 3,
            JointType::Ball => ffi::size(dof),
            JointType::Slide | JointType::Hinge => continue,
        };
        let derivative = math::quat_integrate_derivative(&[0, 1, 2].map(|axis| next_velocity(dof + axis)), h);
        rotations.push(Rotation { dof, by_position: derivative.dquat, by_velocity: derivative.dvel });
    }
}
