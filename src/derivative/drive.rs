//! How actuators depend on what drives them: their controls and activations.

use std::ffi::c_int;

use mujoco_sys::{mjDSBL_CLAMPCTRL, mjSENS_ACTUATORFRC};

use super::method::Step;
use super::through_inverse::add;
use super::worker::{Input, Wanted, Worker, sides};
use super::{Differences, sizes};
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;

/// The derivatives by what drives an actuator, for all actuators.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    force: Vec<f64>,
    activation: Vec<f64>,
    sensors: Vec<f64>,
}

impl Drive {
    pub(super) fn zeros(model: &Model) -> Self {
        let nu = model.nu();
        Self { force: vec![0.0; nu], activation: vec![0.0; nu], sensors: vec![0.0; model.nsensordata()] }
    }

    fn clear(&mut self) {
        for values in [&mut self.force, &mut self.activation, &mut self.sensors] {
            values.fill(0.0);
        }
    }
}

impl Worker {
    /// The derivatives by what drives the actuators. Each depends on its own control and activation only, so they are moved all
    /// at once.
    pub(super) fn drive(&mut self, model: &Model, step: Step, wanted: Wanted) -> Result<()> {
        let clamped = model.raw().opt.disableflags & mjDSBL_CLAMPCTRL as c_int == 0;
        let central = Step { differences: Differences::Central, ..step };
        for controls in [true, false] {
            let drive = if controls { &mut self.base.by_control } else { &mut self.base.by_activation };
            drive.clear();
            if model.nu() == 0 || (!controls && model.na() == 0) {
                continue;
            }
            for sign in [1.0, -1.0] {
                let eps = sign * step.eps;
                if controls {
                    for control in 0..model.nu() {
                        let (right, left) = sides(&self.data, Input::Control(control), central);
                        if !clamped || (if sign > 0.0 { right } else { left }) {
                            self.data.ctrl_mut()[control] += eps;
                        }
                    }
                } else {
                    self.data.act_mut().iter_mut().for_each(|act| *act += eps);
                }
                self.data.fwd_actuation()?;
                if wanted.sensors {
                    self.data.inv_constraint()?;
                    self.data.sensor_acc()?;
                }
                let drive = if controls { &mut self.base.by_control } else { &mut self.base.by_activation };
                add(&mut drive.force, self.data.actuator_force(), sign);
                add(&mut drive.sensors, self.data.sensordata(), sign);
                for activation in 0..model.na() {
                    let next = next_activation(model, &self.data, activation);
                    drive.activation[activation + model.nu() - model.na()] += sign * next;
                }
                self.restore()?;
            }
            // Divided by how far each was moved.
            let drive = if controls { &mut self.base.by_control } else { &mut self.base.by_activation };
            for actuator in 0..model.nu() {
                let sides = if controls && clamped {
                    let (right, left) = sides(&self.data, Input::Control(actuator), central);
                    u8::from(right) + u8::from(left)
                } else {
                    2
                };
                let factor = if sides == 0 { 0.0 } else { 1.0 / (f64::from(sides) * step.eps) };
                drive.force[actuator] *= factor;
                drive.activation[actuator] *= factor;
                for sensor in sensors_of(model, actuator) {
                    drive.sensors[sensor] *= factor;
                }
            }
        }
        self.data.fwd_actuation()?;
        self.data.inv_constraint()
    }

    /// The column of what drives an actuator.
    pub(super) fn driven_column(&mut self, model: &Model, input: Input, actuator: usize, row: &mut [f64]) {
        let base = &mut self.base;
        let drive = if matches!(input, Input::Control(_)) { &base.by_control } else { &base.by_activation };
        let (nv, nx) = (model.nv(), sizes(model).0);
        row.fill(0.0);
        let slope = drive.force[actuator];
        for (column, moment) in base.column.iter_mut().zip(self.data.actuator_moment().row(actuator)) {
            *column = -slope * moment;
        }
        if let Some(activation) = (actuator + model.na()).checked_sub(model.nu()) {
            row[2 * nv + activation] = drive.activation[actuator];
        }
        for sensor in sensors_of(model, actuator) {
            row[nx + sensor] = drive.sensors[sensor];
        }
        base.finish(model, row, input, None);
    }
}

/// The activation after a step.
fn next_activation(model: &Model, data: &Data, activation: usize) -> f64 {
    let actuator = activation + model.nu() - model.na();
    let next = data.act()[activation] + model.raw().opt.timestep * data.act_dot()[activation];
    let [low, high] = model.actuator_actrange()[actuator];
    if model.actuator_actlimited()[actuator] == 0 { next } else { next.max(low).min(high) }
}

/// Where the sensors of the force of an actuator write to.
fn sensors_of(model: &Model, actuator: usize) -> impl Iterator<Item = usize> {
    let sensors = model.sensor_type().iter().zip(model.sensor_objid()).zip(model.sensor_adr());
    sensors.filter_map(move |((&kind, &object), &address)| {
        (kind as u32 == mjSENS_ACTUATORFRC && object as usize == actuator).then_some(address as usize)
    })
}
