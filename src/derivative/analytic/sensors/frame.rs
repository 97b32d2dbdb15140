//! Derivatives of the poses and velocities of frames, absolute or relative to a moving reference
//! frame.
//!
//! Degree of freedom j displaces a frame that it moves by its twist S_j = `[ω; s]`, s at the origin
//! of the frame. In axes that move with j, the frame's velocity changes by ψ_j and by S_j
//! (`rigid_body.rs`); in the world's axes, by the position, by `ψ_j + ω ×` the velocity. For the
//! frame with the position p, orientation q, velocity v and angular velocity w, the reference frame
//! with the index r and the rotation R, and d = p − p_r, the sensors are
//!
//! ```text
//! Rᵀ d,      Rᵀ axis,      q̄_r q,      Rᵀ (w − w_r),      Rᵀ (v − v_r + d × w_r)
//! ```
//!
//! A gyro and a velocimeter measure in the frame itself, so their derivatives are ψ_j and S_j in
//! its axes.

use super::pose::Pose;
use super::{Point, Rows};
use crate::enums::SensorType;
use crate::math;
use crate::numerics::spatial::{Spatial, Vec3, add, angular, cross, linear, scale, sub};

/// Derivatives of the pose and the velocity of a frame by a degree of freedom that moves it, in the
/// world's axes.
struct Change {
    turn: Vec3,
    shift: Vec3,
    angular_velocity: Vec3,
    velocity: Vec3,
    /// Derivative of the velocity by the velocity of the degree of freedom.
    by_velocity: Spatial,
}

impl Change {
    fn new(point: Point<'_>, pose: &Pose, velocity: &Spatial, dof: usize) -> Self {
        let twist = pose.at_origin(&point.data.cdof()[dof]);
        let turn = angular(&twist);
        let local = pose.at_origin(point.bodies.velocity_change(dof));
        Self {
            turn,
            shift: linear(&twist),
            angular_velocity: add(&angular(&local), &cross(&turn, &angular(velocity))),
            velocity: add(&linear(&local), &cross(&turn, &linear(velocity))),
            by_velocity: twist,
        }
    }
}

pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let model = point.data.model();
    let kind = SensorType::from_raw(model.sensor_type()[sensor]);
    let pose = Pose::of_object(point.data, sensor);
    match kind {
        Some(SensorType::Magnetometer) => {
            for dof in pose.dofs(point) {
                let turn = angular(&point.data.cdof()[dof]);
                rows.add(dof, &pose.to_local(&cross(&model.raw().opt.magnetic, &turn)));
            }
        }
        Some(SensorType::Gyro) => add_in_own_frame(point, &pose, angular, rows),
        Some(SensorType::Velocimeter) => add_in_own_frame(point, &pose, linear, rows),
        Some(SensorType::FrameLinearVelocity | SensorType::FrameAngularVelocity) => {
            let reference = Pose::of_reference(point.data, sensor);
            add_velocity(point, kind == Some(SensorType::FrameAngularVelocity), &pose, reference.as_ref(), rows);
        }
        Some(SensorType::FrameQuaternion) => {
            add_quaternion(point, &pose, Pose::of_reference(point.data, sensor).as_ref(), rows);
        }
        _ => add_vector(point, kind, &pose, Pose::of_reference(point.data, sensor).as_ref(), rows),
    }
}

fn add_in_own_frame(point: Point<'_>, pose: &Pose, part: fn(&Spatial) -> Vec3, rows: &mut Rows<'_>) {
    let nv = point.data.model().nv();
    for dof in pose.dofs(point) {
        let by_position = pose.at_origin(point.bodies.velocity_change(dof));
        rows.add(dof, &pose.to_local(&part(&by_position)));
        rows.add(nv + dof, &pose.to_local(&part(&pose.at_origin(&point.data.cdof()[dof]))));
    }
}

/// Adds the derivatives of a position or of an axis.
fn add_vector(point: Point<'_>, kind: Option<SensorType>, pose: &Pose, reference: Option<&Pose>, rows: &mut Rows<'_>) {
    let axis = match kind {
        Some(SensorType::FrameXAxis) => Some(pose.axis(0)),
        Some(SensorType::FrameYAxis) => Some(pose.axis(1)),
        Some(SensorType::FrameZAxis) => Some(pose.axis(2)),
        _ => None,
    };
    let in_reference = |vector: Vec3| reference.map_or(vector, |reference| reference.to_local(&vector));
    for dof in pose.dofs(point) {
        let twist = pose.at_origin(&point.data.cdof()[dof]);
        let change = axis.map_or(linear(&twist), |axis| cross(&angular(&twist), &axis));
        rows.add(dof, &in_reference(change));
    }
    let Some(reference) = reference else { return };
    let vector = axis.unwrap_or_else(|| sub(&pose.position, &reference.position));
    for dof in reference.dofs(point) {
        let twist = reference.at_origin(&point.data.cdof()[dof]);
        let mut change = cross(&vector, &angular(&twist));
        if axis.is_none() {
            change = sub(&change, &linear(&twist));
        }
        rows.add(dof, &reference.to_local(&change));
    }
}

/// Adds the derivatives of an orientation: `∂q = ω q/2`.
fn add_quaternion(point: Point<'_>, pose: &Pose, reference: Option<&Pose>, rows: &mut Rows<'_>) {
    let left = reference.map_or([1.0, 0.0, 0.0, 0.0], |reference| math::neg_quat(&reference.quaternion));
    for (moved, sign) in [(Some(pose), 0.5), (reference, -0.5)] {
        let Some(moved) = moved else { continue };
        for dof in moved.dofs(point) {
            let [x, y, z] = scale(&angular(&point.data.cdof()[dof]), sign);
            let change = math::mul_quat(&math::mul_quat(&left, &[0.0, x, y, z]), &pose.quaternion);
            for (component, value) in change.into_iter().enumerate() {
                rows.row_mut(component)[dof] += value;
            }
        }
    }
}

/// Adds the derivatives of a velocity, or of an angular velocity.
fn add_velocity(point: Point<'_>, is_angular: bool, pose: &Pose, reference: Option<&Pose>, rows: &mut Rows<'_>) {
    let nv = point.data.model().nv();
    let velocity = pose.velocity(point.data);
    let of_reference = reference.map_or([0.0; 6], |reference| reference.velocity(point.data));
    let reference_turn = angular(&of_reference);
    let in_reference = |vector: Vec3| reference.map_or(vector, |reference| reference.to_local(&vector));
    for dof in pose.dofs(point) {
        let change = Change::new(point, pose, &velocity, dof);
        let (by_position, by_velocity) = if is_angular {
            (change.angular_velocity, angular(&change.by_velocity))
        } else {
            (add(&change.velocity, &cross(&change.shift, &reference_turn)), linear(&change.by_velocity))
        };
        rows.add(dof, &in_reference(by_position));
        rows.add(nv + dof, &in_reference(by_velocity));
    }
    let Some(reference) = reference else { return };
    let distance = sub(&pose.position, &reference.position);
    let mut relative = sub(&velocity, &of_reference);
    if !is_angular {
        let [_, _, _, x, y, z] = relative;
        let [x, y, z] = add(&[x, y, z], &cross(&distance, &reference_turn));
        relative[3..].copy_from_slice(&[x, y, z]);
    }
    let measured = if is_angular { angular(&relative) } else { linear(&relative) };
    for dof in reference.dofs(point) {
        let change = Change::new(point, reference, &of_reference, dof);
        let turned = cross(&measured, &change.turn);
        let (by_position, by_velocity) = if is_angular {
            (sub(&turned, &change.angular_velocity), scale(&change.turn, -1.0))
        } else {
            let fixed = sub(&cross(&distance, &change.angular_velocity), &cross(&change.shift, &reference_turn));
            let by_velocity = sub(&cross(&distance, &change.turn), &linear(&change.by_velocity));
            (add(&turned, &sub(&fixed, &change.velocity)), by_velocity)
        };
        rows.add(dof, &reference.to_local(&by_position));
        rows.add(nv + dof, &reference.to_local(&by_velocity));
    }
}
