//! Derivatives of the limits of joints and fixed tendons.
//!
//! The Jacobian is constant, and `∂pos = J`, except for balls. The position of a ball's limit is
//! its range minus the angle θ = |φ| of its rotation vector φ, so the row of J is −α, α = φ/θ, with
//!
//! ```text
//! ∂α = (1 − α αᵀ) ∂φ / θ,
//! ```
//!
//! where ∂φ is the derivative of the logarithm of the rotation ([`math::sub_quat_derivative`]).

use mujoco_sys::mjCNSTR_LIMIT_JOINT;

use super::rows::{Rows, Slopes};
use crate::data::Data;
use crate::enums::JointType;
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;
use crate::numerics::spatial::{Vec3, add_scaled, dot, scale};

pub(super) fn differentiate(rows: &mut Rows, data: &Data, row: usize, residual: &mut Matrix) {
    let ball = ball_of(data, row);
    rows.load(data, row, 1, ball.map(|(dof, _)| dof..dof + 3));
    let slopes = Slopes::of(data, row);
    let span = rows.span.clone();
    let jacobian = &rows.jacobian.row(0)[span.clone()];
    add(&mut rows.residual.row_mut(0)[span.clone()], jacobian, slopes.residual);
    add(&mut rows.log_inertia[span], jacobian, slopes.log_inertia);
    if let Some((dof, quat)) = ball {
        add_turning_axis(rows, data, row, dof, &quat, residual);
    }
}

/// Returns the first degree of freedom and the quaternion of the ball joint that a row limits, if
/// it limits one.
fn ball_of(data: &Data, row: usize) -> Option<(usize, [f64; 4])> {
    let (model, joint) = (data.model(), ffi::size(data.efc_id()[row]));
    let is_joint = data.efc_type()[row] as u32 == mjCNSTR_LIMIT_JOINT;
    (is_joint && JointType::of_field(model.jnt_type()[joint]) == JointType::Ball).then(|| {
        let at = ffi::size(model.jnt_qposadr()[joint]);
        let mut quat = *data.qpos()[at..].first_chunk().expect("Bug: the quaternion is in qpos");
        math::normalize4(&mut quat);
        (ffi::size(model.jnt_dofadr()[joint]), quat)
    })
}

/// Adds the derivative of the Jacobian of a ball's limit.
fn add_turning_axis(rows: &mut Rows, data: &Data, row: usize, dof: usize, quat: &[f64; 4], residual: &mut Matrix) {
    let identity = [1.0, 0.0, 0.0, 0.0];
    let rotation = math::sub_quat(quat, &identity);
    let logarithm = math::sub_quat_derivative(quat, &identity).da;
    let angle = math::norm(&rotation);
    let axis = scale(&rotation, 1.0 / angle);
    let (damping, force) = (data.efc_KBIP()[row][1], data.efc_force()[row]);
    for column in 0..3 {
        let turn = std::array::from_fn(|component| logarithm[3 * component + column] / angle);
        let mut change: Vec3 = turn;
        add_scaled(&mut change, &axis, -dot(&axis, &turn));
        for (component, change) in change.into_iter().enumerate() {
            let rate = data.qacc()[dof + component] + damping * data.qvel()[dof + component];
            rows.residual[(0, dof + column)] -= change * rate;
            residual[(dof + component, dof + column)] += force * change;
        }
    }
}
