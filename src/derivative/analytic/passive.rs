//! Derivatives of the passive forces: springs and dampers of joints and tendons.

use super::super::kinks::{is_at, is_inside};
use super::super::method::Kinks;
use super::tendon::Tendons;
use crate::data::Data;
use crate::enums::JointType;
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::model::DisableFlags;
use crate::numerics::linear_algebra::add;

/// Returns the kinks of the springs of tendons: lengths at which they become slack.
pub(super) fn kinks(data: &Data) -> Kinks {
    let model = data.model();
    let disabled = DisableFlags::from_bits_retain(model.raw().opt.disableflags as u32);
    let has_springs = !disabled.contains(DisableFlags::PASSIVE) && !disabled.contains(DisableFlags::SPRING);
    let is_at_end = |tendon: usize| {
        let ([low, high], length) = (model.tendon_rest_length(tendon), data.ten_length()[tendon]);
        low < high && model.tendon_stiffness()[tendon] != 0.0 && (is_at(length, low) || is_at(length, high))
    };
    if has_springs && (0..model.ntendon()).any(is_at_end) { Kinks::SPRINGS } else { Kinks::empty() }
}

/// Subtracts the derivatives of the passive forces, at constant moment arms, from the derivatives
/// of the residual.
pub(super) fn differentiate(data: &Data, tendons: &Tendons, row: &mut [f64], residual: &mut Matrix) {
    let model = data.model();
    let nv = model.nv();
    if model.raw().opt.disableflags as u32 & DisableFlags::PASSIVE.bits() != 0 {
        return;
    }
    for (dof, &damping) in model.dof_damping().iter().enumerate() {
        residual[(dof, nv + dof)] += damping;
    }
    for (joint, &stiffness) in model.jnt_stiffness().iter().enumerate() {
        if stiffness != 0.0 {
            add_spring(data, joint, stiffness, residual);
        }
    }
    for tendon in 0..model.ntendon() {
        let range @ [low, high] = model.tendon_rest_length(tendon);
        let is_slack = low < high && is_inside(data.ten_length()[tendon], range);
        let stiffness = if is_slack { 0.0 } else { model.tendon_stiffness()[tendon] };
        let damping = model.tendon_damping()[tendon];
        if stiffness != 0.0 || damping != 0.0 {
            data.tendon_row(tendon).write_into(row);
            for (dof, &moment) in row.iter().enumerate() {
                if moment != 0.0 {
                    let (by_position, by_velocity) = residual.row_mut(dof)[..2 * nv].split_at_mut(nv);
                    add(by_position, row, stiffness * moment);
                    add(by_position, tendons.velocity_change(tendon), damping * moment);
                    add(by_velocity, row, damping * moment);
                }
            }
        }
    }
}

/// Adds the derivative of the force that a joint's spring needs.
fn add_spring(data: &Data, joint: usize, stiffness: f64, residual: &mut Matrix) {
    let model = data.model();
    let (mut dof, mut at) = (ffi::size(model.jnt_dofadr()[joint]), ffi::size(model.jnt_qposadr()[joint]));
    let kind = JointType::of_field(model.jnt_type()[joint]);
    if kind == JointType::Free {
        (dof..dof + 3).for_each(|dof| residual[(dof, dof)] += stiffness);
        (dof, at) = (dof + 3, at + 3);
    }
    if matches!(kind, JointType::Free | JointType::Ball) {
        let quat = |values: &[f64]| *values[at..].first_chunk::<4>().expect("Bug: the quaternion is in qpos");
        let mut present = quat(data.qpos());
        math::normalize4(&mut present);
        let derivative = math::sub_quat_derivative(&present, &quat(model.qpos_spring())).da;
        for (index, value) in derivative.into_iter().enumerate() {
            residual[(dof + index / 3, dof + index % 3)] += stiffness * value;
        }
    } else {
        residual[(dof, dof)] += stiffness;
    }
}
