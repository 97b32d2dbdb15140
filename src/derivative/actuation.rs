//! Derivatives of actuator forces with respect to controls and activations.

use std::ffi::c_int;

use mujoco_sys::{mjDYN_FILTEREXACT, mjMINVAL, mjSENS_ACTUATORFRC};

use super::kinks::{self, Scale, sides};
use super::method::{Kinks, Step};
use super::perturbation::{Input, PerturbedData, Settings};
use super::{Differences, sizes};
use crate::data::Data;
use crate::error::Result;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::add;

/// Derivatives with respect to the controls and activations at the base point.
#[derive(Clone, Debug)]
pub(super) struct Actuation {
    by_control: ActuatorValues,
    by_activation: ActuatorValues,
    /// Values at the base point, and the sums of the values to its right and to its left.
    base: ActuatorValues,
    sum: ActuatorValues,
    /// `(na)`: activations after a step from the base point, before clamping.
    next_activations: Vec<f64>,
}

/// Quantities of each actuator, or their derivatives with respect to its own control or its own
/// activation.
#[derive(Clone, Debug)]
struct ActuatorValues {
    /// `(nu)`: force.
    force: Vec<f64>,
    /// `(nu)`: activation after the step; zero for actuators without activation.
    activation: Vec<f64>,
    /// `(nsensordata)`: readings. Only the readings of the actuator force sensors are used.
    sensors: Vec<f64>,
}

impl ActuatorValues {
    fn zeros(model: &Model) -> Self {
        let nu = model.nu();
        Self { force: vec![0.0; nu], activation: vec![0.0; nu], sensors: vec![0.0; model.nsensordata()] }
    }

    fn clear(&mut self) {
        for values in [&mut self.force, &mut self.activation, &mut self.sensors] {
            values.fill(0.0);
        }
    }

    /// Adds a multiple of the quantities at the present state.
    fn add(&mut self, data: &Data, factor: f64) {
        let model = data.model();
        add(&mut self.force, data.actuator_force(), factor);
        add(&mut self.sensors, data.sensordata(), factor);
        for (actuator, value) in self.activation.iter_mut().enumerate() {
            if let Some(activation) = model.activation_of(actuator) {
                *value += factor * next_activation(model, data, actuator, activation);
            }
        }
    }
}

impl Actuation {
    pub(super) fn zeros(model: &Model) -> Self {
        let zeros = ActuatorValues::zeros(model);
        let [by_control, by_activation, base, sum] = [zeros.clone(), zeros.clone(), zeros.clone(), zeros];
        Self { by_control, by_activation, base, sum, next_activations: vec![0.0; model.na()] }
    }

    /// Computes the derivatives by central differences, one-sided at kinks of controls and
    /// activations. Returns these kinks, and [`Kinks::DIFFERENCES`] if both sides disagree, such as
    /// for a force at the end of its range.
    ///
    /// An actuator depends only on its own control and activation, so one difference perturbs all
    /// actuators at once.
    pub(super) fn differentiate(&mut self, point: &mut PerturbedData, settings: Settings<'_>) -> Result<Kinks> {
        let Settings { model, wanted, step, .. } = settings;
        let central = Step { differences: Differences::Central, ..step };
        let Self { by_control, by_activation, base, sum, next_activations: next } = self;
        next_activations(model, &point.data, next);
        let mut kinks = kinks::of_inputs(&point.data, Some(next));
        base.clear();
        base.add(&point.data, 1.0);
        for controls in [true, false] {
            let derivatives = if controls { &mut *by_control } else { &mut *by_activation };
            derivatives.clear();
            sum.clear();
            if model.nu() == 0 || (!controls && model.na() == 0) {
                continue;
            }
            for sign in [1.0, -1.0] {
                let eps = sign * step.eps;
                let is_perturbed = |data: &Data, input: Input| {
                    let (right, left) = sides(data, input, central, next);
                    if sign > 0.0 { right } else { left }
                };
                if controls {
                    for control in 0..model.nu() {
                        if is_perturbed(&point.data, Input::Control(control)) {
                            point.data.ctrl_mut()[control] += eps;
                        }
                    }
                } else {
                    // The side depends on the difference of an activation from its control, and on
                    // nothing else that is perturbed here.
                    for activation in 0..model.na() {
                        if is_perturbed(&point.data, Input::Activation(activation)) {
                            point.data.act_mut()[activation] += eps;
                        }
                    }
                }
                point.data.fwd_actuation()?;
                if wanted.sensors {
                    point.data.inv_constraint()?;
                    point.data.sensor_acc()?;
                }
                derivatives.add(&point.data, sign);
                sum.add(&point.data, 1.0);
                point.restore()?;
            }
            // Divides by the width of the perturbation, which is one-sided at kinks.
            for actuator in 0..model.nu() {
                let input = if controls {
                    Some(Input::Control(actuator))
                } else {
                    model.activation_of(actuator).map(Input::Activation)
                };
                let sides = input.map_or(0, |input| {
                    let (right, left) = sides(&point.data, input, central, next);
                    u8::from(right) + u8::from(left)
                });
                let factor = if sides == 0 { 0.0 } else { 1.0 / (f64::from(sides) * step.eps) };
                let mut divide = |derivative: &mut f64, base: f64, sum: f64| {
                    *derivative *= factor;
                    let disagreement = (sum - 2.0 * base) / step.eps;
                    if sides == 2 && Scale::of([*derivative].into_iter()).disagreement(disagreement, *derivative) > 1.0
                    {
                        kinks |= Kinks::DIFFERENCES;
                    }
                };
                divide(&mut derivatives.force[actuator], base.force[actuator], sum.force[actuator]);
                divide(&mut derivatives.activation[actuator], base.activation[actuator], sum.activation[actuator]);
                if wanted.sensors {
                    for sensor in force_sensors(model, actuator) {
                        divide(&mut derivatives.sensors[sensor], base.sensors[sensor], sum.sensors[sensor]);
                    }
                }
            }
        }
        point.data.fwd_actuation()?;
        point.data.inv_constraint()?;
        Ok(kinks)
    }

    /// Writes the derivative of the residual, and of the activations and force sensors in a row of
    /// the linear system, with respect to the control or the activation of an actuator.
    pub(super) fn column(
        &self,
        data: &Data,
        model: &Model,
        input: Input,
        actuator: usize,
        residual: &mut [f64],
        row: &mut [f64],
    ) {
        let derivatives = if matches!(input, Input::Control(_)) { &self.by_control } else { &self.by_activation };
        let (nv, nx) = (model.nv(), sizes(model).0);
        row.fill(0.0);
        let slope = derivatives.force[actuator];
        data.moment_row(actuator).write_into(residual);
        for residual in residual.iter_mut() {
            *residual *= -slope;
        }
        if let Some(activation) = model.activation_of(actuator) {
            row[2 * nv + activation] = derivatives.activation[actuator];
        }
        for sensor in force_sensors(model, actuator) {
            row[nx + sensor] = derivatives.sensors[sensor];
        }
    }
}

/// Computes the activations after a step, before clamping, from their present rates.
pub(super) fn next_activations(model: &Model, data: &Data, next: &mut [f64]) {
    if next.is_empty() {
        return;
    }
    for actuator in 0..model.nactuator() {
        for activation in model.activations_of(actuator) {
            next[activation] = unclamped_activation(model, data, actuator, activation);
        }
    }
}

/// Returns an activation after the step.
pub(super) fn next_activation(model: &Model, data: &Data, actuator: usize, activation: usize) -> f64 {
    let next = unclamped_activation(model, data, actuator, activation);
    let [low, high] = model.actuator_actrange()[actuator];
    let is_clamped = model.actuator_actlimited()[actuator] != 0 && !freezes_activations(model);
    if is_clamped { next.max(low).min(high) } else { next }
}

/// Returns `true` if a step leaves the activations unchanged, because actuation is disabled. Before
/// 3.0 they continue at their last rates.
fn freezes_activations(model: &Model) -> bool {
    cfg!(engine_since = "3.0.0") && model.options().disable.contains(DisableFlags::ACTUATION)
}

/// Returns `true` if the group of an actuator is disabled. A step then leaves its activation
/// unchanged, except that it clamps it.
fn is_in_disabled_group(model: &Model, actuator: usize) -> bool {
    let disabled = model.options().disableactuator;
    disabled != 0
        && u32::try_from(model.actuator_group()[actuator]).is_ok_and(|group| group < 31 && disabled & (1 << group) != 0)
}

fn unclamped_activation(model: &Model, data: &Data, actuator: usize, activation: usize) -> f64 {
    if freezes_activations(model) || is_in_disabled_group(model, actuator) {
        return data.act()[activation];
    }
    let mut duration = model.raw().opt.timestep;
    if model.actuator_dyntype()[actuator] == mjDYN_FILTEREXACT as c_int {
        let constant = model.actuator_dynprm()[actuator][0].max(mjMINVAL);
        duration = constant * (1.0 - (-duration / constant).exp());
    }
    data.act()[activation] + duration * data.act_dot()[activation]
}

/// Returns the addresses in `sensordata` of the sensors of an actuator's force.
fn force_sensors(model: &Model, actuator: usize) -> impl Iterator<Item = usize> {
    let sensors = model.sensor_type().iter().zip(model.sensor_objid()).zip(model.sensor_adr());
    sensors.filter_map(move |((&kind, &object), &address)| {
        (kind as u32 == mjSENS_ACTUATORFRC && object as usize == actuator).then_some(address as usize)
    })
}
