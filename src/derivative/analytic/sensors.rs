//! Derivatives of sensors that are linear functions of the state: joints, fixed tendons, lengths and velocities of actuators, and
//! clocks.

use crate::data::Data;
use crate::derivative::TransitionOutputs;
use crate::enums::{JointType, SensorType, TransmissionType};
use crate::ffi;
use crate::model::{DisableFlags, Model};

/// Returns true if all sensors of a model have a formula here.
pub(super) fn are_covered(model: &Model) -> bool {
    let is_covered = |sensor: usize| {
        let object = ffi::size(model.sensor_objid()[sensor]);
        let is_linear = match SensorType::from_raw(model.sensor_type()[sensor]) {
            Some(
                SensorType::JointPosition
                | SensorType::JointVelocity
                | SensorType::TendonPosition
                | SensorType::TendonVelocity
                | SensorType::Clock,
            ) => true,
            Some(SensorType::ActuatorPosition | SensorType::ActuatorVelocity) => !is_on_quaternion(model, object),
            _ => false,
        };
        is_linear && model.sensor_cutoff()[sensor] == 0.0
    };
    model.raw().opt.disableflags as u32 & DisableFlags::SENSOR.bits() == 0 && (0..model.nsensor()).all(is_covered)
}

/// Returns true if an actuator acts on a ball or a free joint, whose length is not linear.
fn is_on_quaternion(model: &Model, actuator: usize) -> bool {
    let transmission = TransmissionType::from_raw(model.actuator_trntype()[actuator]);
    matches!(transmission, Some(TransmissionType::Joint | TransmissionType::JointInParent)) && {
        let joint = ffi::size(model.actuator_trnid()[actuator][0]);
        matches!(JointType::of_field(model.jnt_type()[joint]), JointType::Ball | JointType::Free)
    }
}

/// Writes C and D, if they are wanted, for a model whose sensors [are covered](are_covered).
pub(super) fn write(data: &Data, outputs: &mut TransitionOutputs<'_>) {
    let model = data.model();
    let nv = model.nv();
    if let Some(d) = outputs.d.take() {
        d.as_mut_slice().fill(0.0);
    }
    let Some(c) = outputs.c.take() else { return };
    c.as_mut_slice().fill(0.0);
    for sensor in 0..model.nsensor() {
        let row = c.row_mut(ffi::size(model.sensor_adr()[sensor]));
        let (positions, velocities) = row[..2 * nv].split_at_mut(nv);
        let object = ffi::size(model.sensor_objid()[sensor]);
        match SensorType::from_raw(model.sensor_type()[sensor]) {
            Some(SensorType::JointPosition) => positions[ffi::size(model.jnt_dofadr()[object])] = 1.0,
            Some(SensorType::JointVelocity) => velocities[ffi::size(model.jnt_dofadr()[object])] = 1.0,
            Some(SensorType::TendonPosition) => data.tendon_row(object).write_into(positions),
            Some(SensorType::TendonVelocity) => data.tendon_row(object).write_into(velocities),
            Some(SensorType::ActuatorPosition) => data.moment_row(object).write_into(positions),
            Some(SensorType::ActuatorVelocity) => data.moment_row(object).write_into(velocities),
            // The time is not a part of the linear system's state.
            _ => {}
        }
    }
}
