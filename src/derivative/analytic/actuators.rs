//! Derivatives of actuators with affine gain and bias.
//!
//! The force of an actuator is `gain(l, l̇) u + bias(l, l̇)`, where u is the control or, for an actuator with activation, the
//! activation. Its length l depends on the position by its moment arms m, which are constant for hinges, slides and fixed
//! tendons: `∂l/∂q = ∂l̇/∂v = m`.

use super::super::linear_algebra::add;
use super::super::method::Fallback;
use crate::data::Data;
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, JointType, TransmissionType};
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};

/// Smallest time constant of a filter, as in the engine.
const MIN_TIME_CONSTANT: f64 = mujoco_sys::mjMINVAL;

/// Returns the reason why an actuator has no closed form here, if there is one.
pub(super) fn obstacle(model: &Model) -> Option<Fallback> {
    let is_covered = |actuator: usize| {
        let dynamics = ActuatorDynamics::from_raw(model.actuator_dyntype()[actuator]);
        let gain = ActuatorGain::from_raw(model.actuator_gaintype()[actuator]);
        let bias = ActuatorBias::from_raw(model.actuator_biastype()[actuator]);
        matches!(dynamics, Some(ActuatorDynamics::None | ActuatorDynamics::Integrator | ActuatorDynamics::Filter))
            && matches!(gain, Some(ActuatorGain::Fixed | ActuatorGain::Affine))
            && matches!(bias, Some(ActuatorBias::None | ActuatorBias::Affine))
            && has_constant_moment(model, actuator)
    };
    // Without actuation, the engine leaves the derivatives of activations as they were.
    let stale = model.na() > 0 && actuation_is_disabled(model);
    (stale || !(0..model.nu()).all(is_covered)).then_some(Fallback::Actuator)
}

fn actuation_is_disabled(model: &Model) -> bool {
    model.raw().opt.disableflags as u32 & DisableFlags::ACTUATION.bits() != 0
}

/// Returns true if the moment arms of an actuator are constant, and if its length depends on the position only by them.
fn has_constant_moment(model: &Model, actuator: usize) -> bool {
    let object = ffi::size(model.actuator_trnid()[actuator][0]);
    let transmission = TransmissionType::from_raw(model.actuator_trntype()[actuator]);
    match transmission {
        // Spatial tendons are an obstacle of their own.
        Some(TransmissionType::Tendon) => true,
        Some(TransmissionType::Joint | TransmissionType::JointInParent) => {
            match JointType::of_field(model.jnt_type()[object]) {
                JointType::Hinge | JointType::Slide => true,
                // The length is a component of the rotation vector, of which the moment arm is not the derivative.
                JointType::Ball | JointType::Free => {
                    transmission == Some(TransmissionType::Joint)
                        && length_slope(model, actuator, 1.0) == 0.0
                        && length_slope(model, actuator, 0.0) == 0.0
                }
            }
        }
        _ => false,
    }
}

/// Returns the derivative of the force by the length, for an input.
fn length_slope(model: &Model, actuator: usize, input: f64) -> f64 {
    slope(model, actuator, input, 1)
}

/// Returns a component of the affine function of `[1, length, velocity]` that the force is, for an input.
fn slope(model: &Model, actuator: usize, input: f64, component: usize) -> f64 {
    let is_affine = model.actuator_gaintype()[actuator] == ActuatorGain::Affine.raw();
    let gain = if is_affine || component == 0 { model.actuator_gainprm()[actuator][component] } else { 0.0 };
    let is_affine = model.actuator_biastype()[actuator] == ActuatorBias::Affine.raw();
    let bias = if is_affine { model.actuator_biasprm()[actuator][component] } else { 0.0 };
    gain * input + bias
}

/// Derivatives of the activation after a step, by the activation and by the control of the same actuator.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NextActivation {
    pub(super) by_activation: f64,
    pub(super) by_control: f64,
}

/// Subtracts the derivatives of the actuator forces from those of the residual, by positions, velocities, activations and
/// controls, and writes those of the next activations, `(na)`.
pub(super) fn differentiate(data: &Data, residual: &mut Matrix, next: &mut [NextActivation]) {
    let model = data.model();
    let (nv, na, nu) = (model.nv(), model.na(), model.nu());
    if actuation_is_disabled(model) {
        return;
    }
    let moments = data.actuator_moment();
    for actuator in 0..nu {
        let (control, control_slope) = clamped_control(data, actuator);
        // Actuators with activation are the last ones.
        let activation = (actuator + na).checked_sub(nu);
        let (input, input_slope, input_column) = match activation {
            Some(activation) => (data.act()[activation], 1.0, 2 * nv + activation),
            None => (control, control_slope, 2 * nv + na + actuator),
        };
        if let Some(activation) = activation {
            next[activation] = next_activation(data, actuator, activation, control_slope);
        }
        let [force, by_length, by_velocity] = [0, 1, 2].map(|component| slope(model, actuator, input, component));
        let (length, velocity) = (data.actuator_length()[actuator], data.actuator_velocity()[actuator]);
        let gain = gain(model, actuator, length, velocity);
        let force = force + by_length * length + by_velocity * velocity;
        let [low, high] = model.actuator_forcerange()[actuator];
        if model.actuator_forcelimited()[actuator] != 0 && !(low..=high).contains(&force) {
            continue;
        }
        let moment = moments.row(actuator);
        for (dof, &arm) in moment.iter().enumerate() {
            if arm != 0.0 {
                let row = residual.row_mut(dof);
                if by_length != 0.0 {
                    add(&mut row[..nv], moment, -arm * by_length);
                }
                if by_velocity != 0.0 {
                    add(&mut row[nv..2 * nv], moment, -arm * by_velocity);
                }
                row[input_column] -= arm * gain * input_slope;
            }
        }
    }
}

fn gain(model: &Model, actuator: usize, length: f64, velocity: f64) -> f64 {
    let [constant, by_length, by_velocity, ..] = model.actuator_gainprm()[actuator];
    if model.actuator_gaintype()[actuator] == ActuatorGain::Affine.raw() {
        constant + by_length * length + by_velocity * velocity
    } else {
        constant
    }
}

/// Returns the control after clamping to its range, and its derivative: 1 within the range including its ends, 0 beyond it.
fn clamped_control(data: &Data, actuator: usize) -> (f64, f64) {
    let (model, control) = (data.model(), data.ctrl()[actuator]);
    let clamps = model.raw().opt.disableflags as u32 & DisableFlags::CLAMPCTRL.bits() == 0;
    if !clamps || model.actuator_ctrllimited()[actuator] == 0 {
        return (control, 1.0);
    }
    let [low, high] = model.actuator_ctrlrange()[actuator];
    let is_free = low < high && (low..=high).contains(&control);
    (control.max(low).min(high), f64::from(u8::from(is_free)))
}

/// Differentiates `act + h ȧ`, clamped to the range of the activation.
fn next_activation(data: &Data, actuator: usize, activation: usize, control_slope: f64) -> NextActivation {
    let model = data.model();
    let h = model.raw().opt.timestep;
    let next = data.act()[activation] + h * data.act_dot()[activation];
    let [low, high] = model.actuator_actrange()[actuator];
    if model.actuator_actlimited()[actuator] != 0 && !(low..=high).contains(&next) {
        return NextActivation::default();
    }
    let (rate_by_activation, rate_by_control) = match ActuatorDynamics::from_raw(model.actuator_dyntype()[actuator]) {
        Some(ActuatorDynamics::Filter) => {
            let rate = 1.0 / model.actuator_dynprm()[actuator][0].max(MIN_TIME_CONSTANT);
            (-rate, rate)
        }
        _ => (0.0, 1.0),
    };
    NextActivation { by_activation: 1.0 + h * rate_by_activation, by_control: h * rate_by_control * control_slope }
}
