//! Derivatives of actuators with affine gain and bias, and of muscles (`muscle.rs`).
//!
//! The force of an actuator is `gain(l, l̇) u + bias(l, l̇)`, where u is the control or, for an
//! actuator with activation, the activation. Its length l depends on the position by its moment
//! arms m: `∂l/∂q = ∂l̇/∂v = m`. They are constant except for spatial tendons (`tendon.rs`) and
//! sites (`site.rs`).

mod muscle;
mod site;

use self::site::for_each_change;
pub(super) use self::site::site_of;
use super::super::kinks::{self, is_at, is_inside};
use super::super::method::{Fallback, Kinks};
use super::tendon::{Tendons, tendon_of};
use super::tree::Tree;
use crate::data::Data;
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, JointType, TransmissionType};
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::add;

/// Smallest time constant of a filter, as in the engine.
pub(super) const MIN_TIME_CONSTANT: f64 = mujoco_sys::mjMINVAL;

/// Returns the reason why an actuator has no closed form here, if there is one.
pub(in crate::derivative) fn obstacle(model: &Model) -> Option<Fallback> {
    let is_covered = |actuator: usize| {
        let dynamics = ActuatorDynamics::from_raw(model.actuator_dyntype()[actuator]);
        let gain = ActuatorGain::from_raw(model.actuator_gaintype()[actuator]);
        let bias = ActuatorBias::from_raw(model.actuator_biastype()[actuator]);
        matches!(
            dynamics,
            Some(
                ActuatorDynamics::None
                    | ActuatorDynamics::Integrator
                    | ActuatorDynamics::Filter
                    | ActuatorDynamics::Muscle
            )
        ) && matches!(gain, Some(ActuatorGain::Fixed | ActuatorGain::Affine | ActuatorGain::Muscle))
            && matches!(bias, Some(ActuatorBias::None | ActuatorBias::Affine | ActuatorBias::Muscle))
            && has_known_moment(model, actuator)
    };
    // Without actuation, the engine leaves the derivatives of activations as they were.
    let stale = model.na() > 0 && actuation_is_disabled(model);
    (stale || !(0..model.nactuator()).all(is_covered)).then_some(Fallback::Actuator)
}

pub(super) fn actuation_is_disabled(model: &Model) -> bool {
    model.raw().opt.disableflags as u32 & DisableFlags::ACTUATION.bits() != 0
}

/// Returns `true` if the velocities of actuators follow the velocities of the joints. Since 3.2
/// they are constant without actuation.
pub(super) fn has_velocities(model: &Model) -> bool {
    cfg!(not(engine_since = "3.2.0")) || !actuation_is_disabled(model)
}

/// Returns `true` if the moment arms of an actuator are constant or belong to a tendon, and if its
/// length depends on the position only by them.
fn has_known_moment(model: &Model, actuator: usize) -> bool {
    let object = ffi::size(model.actuator_trnid()[actuator][0]);
    let transmission = TransmissionType::from_raw(model.actuator_trntype()[actuator]);
    match transmission {
        // `tendon.rs` differentiates the moment arms of spatial tendons.
        Some(TransmissionType::Tendon) => true,
        Some(TransmissionType::Site) => site_of(model, actuator).is_some(),
        Some(TransmissionType::Joint | TransmissionType::JointInParent) => {
            match JointType::of_field(model.jnt_type()[object]) {
                JointType::Hinge | JointType::Slide => true,
                // The length is a component of the rotation vector, of which the moment arm is not
                // the derivative.
                JointType::Ball | JointType::Free => {
                    transmission == Some(TransmissionType::Joint) && !depends_on_length(model, actuator)
                }
            }
        }
        _ => false,
    }
}

/// Returns `true` if the moment arms of an actuator are the derivatives of its length, that is, if
/// it acts on a hinge, a slide or a tendon.
pub(super) fn has_differentiable_length(model: &Model, actuator: usize) -> bool {
    match TransmissionType::from_raw(model.actuator_trntype()[actuator]) {
        Some(TransmissionType::Tendon) => true,
        Some(TransmissionType::Joint | TransmissionType::JointInParent) => {
            let joint = ffi::size(model.actuator_trnid()[actuator][0]);
            matches!(JointType::of_field(model.jnt_type()[joint]), JointType::Hinge | JointType::Slide)
        }
        _ => false,
    }
}

/// Returns `true` if the force of an actuator depends on its length.
fn depends_on_length(model: &Model, actuator: usize) -> bool {
    let gain = match ActuatorGain::from_raw(model.actuator_gaintype()[actuator]) {
        Some(ActuatorGain::Fixed) => false,
        Some(ActuatorGain::Affine) => model.actuator_gainprm()[actuator][1] != 0.0,
        _ => true,
    };
    let bias = match ActuatorBias::from_raw(model.actuator_biastype()[actuator]) {
        Some(ActuatorBias::None) => false,
        Some(ActuatorBias::Affine) => model.actuator_biasprm()[actuator][1] != 0.0,
        _ => true,
    };
    gain || bias
}

/// Gain or bias of an actuator, with its derivatives by the length and the velocity of the
/// actuator.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Curve {
    pub(super) value: f64,
    pub(super) by_length: f64,
    pub(super) by_velocity: f64,
}

impl Curve {
    fn affine(parameters: &[f64; 10], length: f64, velocity: f64) -> Self {
        let [constant, by_length, by_velocity, ..] = *parameters;
        Self { value: constant + by_length * length + by_velocity * velocity, by_length, by_velocity }
    }
}

/// Derivatives of the force of an actuator by its length and velocity, and by its control or
/// activation.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceSlopes {
    /// Control after clamping, or activation.
    pub(super) input: f64,
    pub(super) by_length: f64,
    pub(super) by_velocity: f64,
    by_input: f64,
    /// Column of the control or the activation among positions, velocities, activations and
    /// controls.
    input_column: usize,
    /// True for a force at an end of its range.
    is_at_limit: bool,
}

impl ForceSlopes {
    /// Returns the derivatives, or `None` for a force beyond its range.
    pub(super) fn new(data: &Data, actuator: usize) -> Option<Self> {
        let model = data.model();
        let (nv, na) = (model.nv(), model.na());
        let (input, input_slope, input_column) = if let Some(activation) = model.activation_of(actuator) {
            (data.act()[activation], 1.0, 2 * nv + activation)
        } else {
            let (control, slope) = clamped_control(data, actuator);
            (control, slope, 2 * nv + na + actuator)
        };
        let (length, velocity) = (data.actuator_length()[actuator], data.actuator_velocity()[actuator]);
        let gain = match ActuatorGain::from_raw(model.actuator_gaintype()[actuator]) {
            Some(ActuatorGain::Affine) => Curve::affine(&model.actuator_gainprm()[actuator], length, velocity),
            Some(ActuatorGain::Muscle) => muscle::gain(model, actuator, length, velocity),
            _ => Curve { value: model.actuator_gainprm()[actuator][0], ..Curve::default() },
        };
        let bias = match ActuatorBias::from_raw(model.actuator_biastype()[actuator]) {
            Some(ActuatorBias::Affine) => Curve::affine(&model.actuator_biasprm()[actuator], length, velocity),
            Some(ActuatorBias::Muscle) => muscle::bias(model, actuator, length),
            _ => Curve::default(),
        };
        let force = gain.value * input + bias.value;
        let [low, high] = model.actuator_forcerange()[actuator];
        let is_limited = model.actuator_forcelimited()[actuator] != 0;
        if is_limited && !is_inside(force, [low, high]) {
            return None;
        }
        // The length of an actuator on a site is constant.
        let changes_length = f64::from(u8::from(site_of(model, actuator).is_none()));
        Some(Self {
            input,
            by_length: changes_length * (gain.by_length * input + bias.by_length),
            by_velocity: gain.by_velocity * input + bias.by_velocity,
            by_input: gain.value * input_slope,
            input_column,
            is_at_limit: is_limited && (is_at(force, low) || is_at(force, high)),
        })
    }
}

/// Derivative of the force of an actuator by its velocity, as the implicit integrator has it:
/// regardless of limits, of which newer engines consider some.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VelocityGain {
    pub(super) total: f64,
    /// Derivative of the total by the control or the activation.
    pub(super) by_input: f64,
}

/// Returns the velocity gain of an actuator with affine gain and bias.
pub(super) fn velocity_gain(data: &Data, actuator: usize) -> VelocityGain {
    let model = data.model();
    let Some((input, slope)) = velocity_gain_input(data, actuator) else { return VelocityGain::default() };
    let is_affine = model.actuator_gaintype()[actuator] == ActuatorGain::Affine.raw();
    let by_input = if is_affine { model.actuator_gainprm()[actuator][2] } else { 0.0 };
    let is_affine = model.actuator_biastype()[actuator] == ActuatorBias::Affine.raw();
    let constant = if is_affine { model.actuator_biasprm()[actuator][2] } else { 0.0 };
    VelocityGain { total: constant + by_input * input, by_input: by_input * slope }
}

/// Returns the number that the coefficient of the velocity in the gain multiplies, and its
/// derivative by the control or the activation; `None` if the velocity gain is zero.
pub(super) fn velocity_gain_input(data: &Data, actuator: usize) -> Option<(f64, f64)> {
    let model = data.model();
    if actuation_is_disabled(model) {
        return None;
    }
    let (force, [low, high]) = (data.actuator_force()[actuator], model.actuator_forcerange()[actuator]);
    let is_limited = cfg!(engine_since = "3.5.0") && model.actuator_forcelimited()[actuator] != 0;
    if is_limited && (force <= low || force >= high) {
        return None;
    }
    Some(match model.activation_of(actuator) {
        Some(activation) => (data.act()[activation], 1.0),
        None if cfg!(engine_since = "3.17.0") => clamped_control(data, actuator),
        None => (data.ctrl()[actuator], 1.0),
    })
}

/// Adds the derivative of the velocity of an actuator by the position.
pub(super) fn add_velocity_change(
    data: &Data,
    tree: &Tree,
    tendons: &Tendons,
    actuator: usize,
    factor: f64,
    row: &mut [f64],
) {
    let model = data.model();
    if let Some(tendon) = tendon_of(model, actuator) {
        add(row, tendons.velocity_change(tendon), factor * model.actuator_gear()[actuator][0]);
    }
    for_each_change(data, tree, actuator, |k, j, change| row[j] += factor * change * data.qvel()[k]);
}

/// Writes the derivatives of the force of an actuator by positions, velocities, activations and
/// controls to a row of zeros.
pub(super) fn write_force(data: &Data, tree: &Tree, tendons: &Tendons, actuator: usize, row: &mut [f64]) {
    let model = data.model();
    let nv = model.nv();
    if actuation_is_disabled(model) {
        return;
    }
    let Some(slopes) = ForceSlopes::new(data, actuator) else { return };
    for (dof, arm) in data.moment_row(actuator).iter() {
        row[dof] = slopes.by_length * arm;
        row[nv + dof] = slopes.by_velocity * arm;
    }
    add_velocity_change(data, tree, tendons, actuator, slopes.by_velocity, &mut row[..nv]);
    row[slopes.input_column] = slopes.by_input;
}

/// Derivatives of the activation after a step, by the activation and by the control of the same
/// actuator.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NextActivation {
    pub(super) actuator: usize,
    pub(super) by_activation: f64,
    pub(super) by_control: f64,
}

/// Subtracts the derivatives of the actuator forces by positions, velocities, activations and
/// controls, at constant moment arms of tendons, from the derivatives of the residual. Writes the
/// derivatives of the next activations, `(na)`. Returns the kinks of actuators.
pub(super) fn differentiate(
    data: &Data,
    tree: &Tree,
    tendons: &Tendons,
    residual: &mut Matrix,
    next: &mut [NextActivation],
) -> Kinks {
    let model = data.model();
    let nv = model.nv();
    let mut kinks = kinks::of_inputs(data, None);
    if actuation_is_disabled(model) {
        return Kinks::empty();
    }
    for actuator in 0..model.nactuator() {
        if let Some(activation) = model.activation_of(actuator) {
            next[activation] = next_activation(data, actuator, activation, &mut kinks);
        }
        let force = data.actuator_force()[actuator];
        for_each_change(data, tree, actuator, |k, j, change| residual[(k, j)] -= force * change);
        let Some(slopes) = ForceSlopes::new(data, actuator) else { continue };
        kinks.set(Kinks::FORCES, kinks.contains(Kinks::FORCES) || slopes.is_at_limit);
        let moment = data.moment_row(actuator);
        for (dof, arm) in moment.iter() {
            if arm != 0.0 {
                let row = residual.row_mut(dof);
                if slopes.by_length != 0.0 {
                    moment.add_to(&mut row[..nv], -arm * slopes.by_length);
                }
                if slopes.by_velocity != 0.0 {
                    moment.add_to(&mut row[nv..2 * nv], -arm * slopes.by_velocity);
                    add_velocity_change(data, tree, tendons, actuator, -arm * slopes.by_velocity, &mut row[..nv]);
                }
                row[slopes.input_column] -= arm * slopes.by_input;
            }
        }
    }
    kinks
}

/// Returns the control after clamping to its range, and its derivative: 1 within the range
/// including its ends, 0 beyond it.
fn clamped_control(data: &Data, actuator: usize) -> (f64, f64) {
    let (model, control) = (data.model(), data.ctrl()[actuator]);
    let clamps = model.raw().opt.disableflags as u32 & DisableFlags::CLAMPCTRL.bits() == 0;
    if !clamps || model.actuator_ctrllimited()[actuator] == 0 {
        return (control, 1.0);
    }
    let [low, high] = model.actuator_ctrlrange()[actuator];
    let is_free = low < high && is_inside(control, [low, high]);
    (control.max(low).min(high), f64::from(u8::from(is_free)))
}

/// Returns the kinks of forces at an end of their range.
pub(super) fn kinks_of_forces(data: &Data) -> Kinks {
    let is_at_limit = |actuator| ForceSlopes::new(data, actuator).is_some_and(|slopes| slopes.is_at_limit);
    if (0..data.model().nactuator()).any(is_at_limit) { Kinks::FORCES } else { Kinks::empty() }
}

/// Returns `true` unless the activation after a step is clamped to its range.
pub(super) fn is_next_activation_free(data: &Data, actuator: usize, activation: usize) -> bool {
    let model = data.model();
    let next = data.act()[activation] + model.raw().opt.timestep * data.act_dot()[activation];
    model.actuator_actlimited()[actuator] == 0 || is_inside(next, model.actuator_actrange()[actuator])
}

/// Differentiates `act + h ȧ`, clamped to the range of the activation.
fn next_activation(data: &Data, actuator: usize, activation: usize, kinks: &mut Kinks) -> NextActivation {
    let model = data.model();
    let (control, control_slope) = clamped_control(data, actuator);
    let h = model.raw().opt.timestep;
    let next = data.act()[activation] + h * data.act_dot()[activation];
    let range @ [low, high] = model.actuator_actrange()[actuator];
    if model.actuator_actlimited()[actuator] != 0 {
        if !is_inside(next, range) {
            return NextActivation { actuator, ..NextActivation::default() };
        }
        kinks.set(Kinks::ACTIVATIONS, kinks.contains(Kinks::ACTIVATIONS) || is_at(next, low) || is_at(next, high));
    }
    let (rate_by_activation, rate_by_control) = match ActuatorDynamics::from_raw(model.actuator_dyntype()[actuator]) {
        Some(ActuatorDynamics::Filter) => {
            let rate = 1.0 / model.actuator_dynprm()[actuator][0].max(MIN_TIME_CONSTANT);
            (-rate, rate)
        }
        Some(ActuatorDynamics::Muscle) => {
            let sides = kinks::muscle_sides(data, actuator, activation);
            muscle::activation_rate(model, actuator, (control, data.act()[activation]), sides)
        }
        _ => (0.0, 1.0),
    };
    NextActivation {
        actuator,
        by_activation: 1.0 + h * rate_by_activation,
        by_control: h * rate_by_control * control_slope,
    }
}
