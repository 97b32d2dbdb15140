//! Derivatives of accelerations of frames.
//!
//! The acceleration of the origin of a frame with the velocity V = `[ω; v]` and the spatial
//! acceleration A = `[α; a]`, both about the origin, is `a + ω × v` (R. Featherstone, "Rigid Body
//! Dynamics Algorithms", section 2.11). It includes minus gravity. In axes that move with degree of
//! freedom j (`rigid_body.rs`)
//!
//! ```text
//! ∂V/∂q_j = ψ_j,    ∂A/∂q_j = χ_j − V × ψ_j,    ∂V/∂v_j = S_j,    ∂A/∂v_j = σ_j − V × S_j,    ∂A/∂a_j = S_j
//! ```
//!
//! An accelerometer measures in these axes. The axes of the world do not move, so there the
//! derivatives by the position have an additional term: the turn of the measured vector with j.

use super::pose::Pose;
use super::{Point, Rows};
use crate::enums::SensorType;
use crate::numerics::linear_algebra;
use crate::numerics::spatial::{Spatial, Vec3, add, angular, cross, cross_motion, linear, sub};

pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let Point { data, tree, bodies, deceleration, .. } = point;
    let model = data.model();
    let nv = model.nv();
    let kind = SensorType::from_raw(model.sensor_type()[sensor]);
    let is_local = kind == Some(SensorType::Accelerometer);
    let is_angular = kind == Some(SensorType::FrameAngularAcceleration);
    let pose = Pose::of_object(data, sensor);
    let about_tree = &data.cvel()[pose.body];
    let velocity = pose.velocity(data);
    let measured = |velocity_change: &Spatial, acceleration_change: &Spatial| -> Vec3 {
        if is_angular {
            return angular(acceleration_change);
        }
        let convected = add(
            &cross(&angular(velocity_change), &linear(&velocity)),
            &cross(&angular(&velocity), &linear(velocity_change)),
        );
        add(&linear(acceleration_change), &convected)
    };
    let in_frame = |vector: Vec3| if is_local { pose.to_local(&vector) } else { vector };
    let acceleration = tree.last[pose.body].map_or([0.0; 6], |dof| pose.at_origin(bodies.acceleration(tree, dof)));
    let present = if is_angular {
        angular(&acceleration)
    } else {
        add(&linear(&acceleration), &cross(&angular(&velocity), &linear(&velocity)))
    };
    for dof in pose.dofs(point) {
        let axis = &data.cdof()[dof];
        let psi = bodies.velocity_change(dof);
        let (chi, sigma) = bodies.acceleration_changes(dof);
        let convected = |change: &Spatial, by: &Spatial| pose.at_origin(&sub(change, &cross_motion(about_tree, by)));
        let mut by_position = measured(&pose.at_origin(psi), &convected(chi, psi));
        if !is_local {
            by_position = add(&by_position, &cross(&angular(axis), &present));
        }
        rows.add(dof, &in_frame(by_position));
        rows.add(nv + dof, &in_frame(measured(&pose.at_origin(axis), &convected(sigma, axis))));
        let by_acceleration = in_frame(measured(&[0.0; 6], &pose.at_origin(axis)));
        for (component, value) in by_acceleration.into_iter().enumerate() {
            linear_algebra::add(rows.row_mut(component), deceleration.row(dof), -value);
        }
    }
}
