//! Derivatives of readings by parameters of the model, at constant state and accelerations.
//!
//! A change of the inertia of a body changes the force of inverse dynamics that force and torque
//! sensors above it measure. Gravity is part of the accelerations that sensors measure. The forces,
//! lengths and velocities of actuators are those of `../actuators/`.

use mujoco_sys::mjOBJ_BODY;

use super::pose::Pose;
use super::{actuators, formula};
use crate::data::Data;
use crate::derivative::parameter::Effect;
use crate::enums::SensorType;
use crate::ffi;
use crate::model::Model;
use crate::numerics::spatial::{Spatial, linear, momentum};

/// Returns `true` if the readings of a sensor with a [`formula`] have one for their derivative by a
/// parameter, too.
pub(in crate::derivative::analytic) fn is_covered(model: &Model, effect: &Effect, sensor: usize) -> bool {
    match effect {
        Effect::Other => false,
        // The inertial frame of a body moves with its centre of mass.
        Effect::Inertial { .. } => {
            let is_inertial = |kind: i32| kind as u32 == mjOBJ_BODY;
            let is_of_subtree = matches!(
                kind(model, sensor),
                Some(SensorType::SubtreeCom | SensorType::SubtreeLinearVelocity | SensorType::SubtreeAngularMomentum)
            );
            !is_of_subtree
                && !is_inertial(model.sensor_objtype()[sensor])
                && !is_inertial(model.sensor_reftype()[sensor])
        }
        // The forces of constraints change.
        Effect::Solver(_) => !matches!(
            kind(model, sensor),
            Some(
                SensorType::Touch
                    | SensorType::JointLimitForce
                    | SensorType::TendonLimitForce
                    | SensorType::Force
                    | SensorType::Torque
            )
        ),
        _ => true,
    }
}

fn kind(model: &Model, sensor: usize) -> Option<SensorType> {
    SensorType::from_raw(model.sensor_type()[sensor])
}

fn address(model: &Model, sensor: usize) -> usize {
    ffi::size(model.sensor_adr()[sensor])
}

/// Adds a change of the force of inverse dynamics on a body, about the reference point of its tree.
pub(in crate::derivative::analytic) fn add_force(
    data: &Data,
    body: usize,
    force: &Spatial,
    mut add: impl FnMut(usize, f64),
) {
    let model = data.model();
    for sensor in 0..model.nsensor() {
        let kind = kind(model, sensor);
        if !matches!(kind, Some(SensorType::Force | SensorType::Torque)) || formula(model, sensor).is_none() {
            continue;
        }
        let pose = Pose::of_object(data, sensor);
        if is_below(model, body, pose.body) {
            add_measured(model, sensor, &pose, force, &mut add);
        }
    }
}

/// Adds the change of the acceleration of the world by a component of gravity.
pub(in crate::derivative::analytic) fn add_gravity(data: &Data, axis: usize, mut add: impl FnMut(usize, f64)) {
    let model = data.model();
    let mut change = [0.0; 6];
    change[3 + axis] = -1.0;
    for sensor in 0..model.nsensor() {
        if formula(model, sensor).is_none() {
            continue;
        }
        match kind(model, sensor) {
            Some(SensorType::Accelerometer) => {
                let local = Pose::of_object(data, sensor).to_local(&linear(&change));
                (0..3).for_each(|i| add(address(model, sensor) + i, local[i]));
            }
            Some(SensorType::FrameLinearAcceleration) => add(address(model, sensor) + axis, -1.0),
            Some(SensorType::Force | SensorType::Torque) => {
                let pose = Pose::of_object(data, sensor);
                add_measured(model, sensor, &pose, &momentum(&data.crb()[pose.body], &change), &mut add);
            }
            _ => {}
        }
    }
}

fn add_measured(model: &Model, sensor: usize, pose: &Pose, force: &Spatial, add: &mut impl FnMut(usize, f64)) {
    let is_torque = kind(model, sensor) == Some(SensorType::Torque);
    let measured = pose.to_local(&if is_torque { pose.torque(force) } else { linear(force) });
    (0..3).for_each(|axis| add(address(model, sensor) + axis, measured[axis]));
}

/// Adds a change of the force of an actuator.
pub(in crate::derivative::analytic) fn add_actuator_force(
    model: &Model,
    actuator: usize,
    force: f64,
    add: impl FnMut(usize, f64),
) {
    add_reading(model, actuator, SensorType::ActuatorForce, force, add);
}

/// Adds changes of the length and the velocity of an actuator.
pub(in crate::derivative::analytic) fn add_transmission(
    model: &Model,
    actuator: usize,
    [length, velocity]: [f64; 2],
    mut add: impl FnMut(usize, f64),
) {
    add_reading(model, actuator, SensorType::ActuatorPosition, length, &mut add);
    if actuators::has_velocities(model) {
        add_reading(model, actuator, SensorType::ActuatorVelocity, velocity, add);
    }
}

fn add_reading(model: &Model, actuator: usize, of: SensorType, change: f64, mut add: impl FnMut(usize, f64)) {
    for sensor in 0..model.nsensor() {
        if kind(model, sensor) == Some(of) && ffi::size(model.sensor_objid()[sensor]) == actuator {
            add(address(model, sensor), change);
        }
    }
}

/// Returns `true` if a body is in the subtree of another.
fn is_below(model: &Model, mut body: usize, root: usize) -> bool {
    // Parents have smaller indices.
    while body > root {
        body = ffi::size(model.body_parentid()[body]);
    }
    body == root
}
