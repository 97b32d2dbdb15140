//! Derivatives of sensors of joints, tendons and actuators.
//!
//! The derivatives of scalar joints, tendons and their limits are rows of Jacobians. The
//! derivatives of the velocities of a spatial tendon also contain the change of its moment arms
//! (`../tendon.rs`). The orientation of a ball joint has the derivative `q e/2` by a turn about its
//! own axis e.

use mujoco_sys::{mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON};

use super::{Point, Rows};
use crate::data::Data;
use crate::derivative::analytic::actuators;
use crate::derivative::newton::add_row;
use crate::enums::{JointType, SensorType};
use crate::ffi;
use crate::math;
use crate::model::Model;
use crate::numerics::linear_algebra::add;

pub(super) fn is_ball(model: &Model, joint: usize) -> bool {
    JointType::of_field(model.jnt_type()[joint]) == JointType::Ball
}

pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let Point { data, tendons, .. } = point;
    let model = data.model();
    let nv = model.nv();
    let object = ffi::size(model.sensor_objid()[sensor]);
    let kind = SensorType::from_raw(model.sensor_type()[sensor]);
    let (positions, rest) = rows.row_mut(0).split_at_mut(nv);
    let velocities = &mut rest[..nv];
    match kind {
        Some(SensorType::JointPosition) => positions[ffi::size(model.jnt_dofadr()[object])] = 1.0,
        Some(SensorType::JointVelocity) => velocities[ffi::size(model.jnt_dofadr()[object])] = 1.0,
        Some(SensorType::TendonPosition) => data.tendon_row(object).write_into(positions),
        Some(SensorType::TendonVelocity) => {
            positions.copy_from_slice(tendons.velocity_change(object));
            data.tendon_row(object).write_into(velocities);
        }
        Some(SensorType::ActuatorPosition) => data.moment_row(object).write_into(positions),
        Some(SensorType::ActuatorVelocity) if actuators::has_velocities(model) => {
            actuators::add_velocity_change(data, point.tree, tendons, object, 1.0, positions);
            data.moment_row(object).write_into(velocities);
        }
        Some(SensorType::ActuatorForce) if point.has_actuators => {
            actuators::write_force(data, point.tree, tendons, object, rows.row_mut(0));
        }
        Some(SensorType::JointLimitPosition) => add_limit(data, mjCNSTR_LIMIT_JOINT, object, positions),
        Some(SensorType::JointLimitVelocity) => add_limit(data, mjCNSTR_LIMIT_JOINT, object, velocities),
        Some(SensorType::TendonLimitPosition) => add_limit(data, mjCNSTR_LIMIT_TENDON, object, positions),
        Some(SensorType::TendonLimitVelocity) => {
            add_limit(data, mjCNSTR_LIMIT_TENDON, object, velocities);
            // The row has the moment arms of the tendon, or their negatives for an upper limit.
            let arms = data.tendon_row(object).iter();
            let product: f64 = arms.map(|(dof, arm)| arm * velocities[dof]).sum();
            let sign = if product == 0.0 { 0.0 } else { product.signum() };
            add(positions, tendons.velocity_change(object), sign);
        }
        Some(SensorType::BallAngularVelocity) => {
            let dof = ffi::size(model.jnt_dofadr()[object]);
            (0..3).for_each(|axis| rows.row_mut(axis)[nv + dof + axis] = 1.0);
        }
        Some(SensorType::BallQuaternion) => add_ball(data, object, rows),
        // The time is not an input.
        _ => {}
    }
}

/// Adds the Jacobian of the first limit of a joint or a tendon that has a row.
fn add_limit(data: &Data, kind: u32, object: usize, row: &mut [f64]) {
    let mut limits = (0..data.nefc()).filter(|&row| data.efc_type()[row] as u32 == kind);
    if let Some(limit) = limits.find(|&row| ffi::size(data.efc_id()[row]) == object) {
        add_row(data, limit, 1.0, row);
    }
}

fn add_ball(data: &Data, joint: usize, rows: &mut Rows<'_>) {
    let model = data.model();
    let (dof, at) = (ffi::size(model.jnt_dofadr()[joint]), ffi::size(model.jnt_qposadr()[joint]));
    let mut quat = *data.qpos()[at..].first_chunk().expect("Bug: the quaternion is in qpos");
    math::normalize4(&mut quat);
    for axis in 0..3 {
        let mut turn = [0.0; 4];
        turn[axis + 1] = 0.5;
        for (component, value) in math::mul_quat(&quat, &turn).into_iter().enumerate() {
            rows.row_mut(component)[dof + axis] = value;
        }
    }
}
