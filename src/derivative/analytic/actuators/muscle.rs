//! Derivatives of the engine's muscle model.
//!
//! For the normalised length L and velocity V, the gain is `−F FL(L) FV(V)` and the bias `−F FP(L)`, where F is the peak active
//! force and all curves are piecewise quadratic. The activation follows the control with a time constant that depends on the
//! activation: `ȧ = (u − a)/τ(a)`, `τ = τ₀ s` for u above a and `τ₁/s` below it, `s = 0.5 + 1.5 a`. (M. Millard, T. Uchida, A. Seth
//! and S. Delp, "Flexing computational muscle", Journal of Biomechanical Engineering 2013; "Muscle actuators" in the engine's
//! documentation.)

use super::{Curve, MIN_TIME_CONSTANT};
use crate::model::Model;

/// Smallest divisor, as in the engine.
const MIN: f64 = mujoco_sys::mjMINVAL;

/// Quantities that gain and bias share.
struct Muscle {
    force: f64,
    /// Length, as a multiple of the optimum.
    length: f64,
    /// Change of the normalised length with the length.
    scale: f64,
    longest: f64,
}

impl Muscle {
    fn new(model: &Model, actuator: usize, parameters: &[f64; 10], length: f64) -> Self {
        let [low, high, force, scale, _, longest, ..] = *parameters;
        let [shortest_length, longest_length] = model.actuator_lengthrange()[actuator];
        let optimum = ((longest_length - shortest_length) / (high - low).max(MIN)).max(MIN);
        Self {
            force: if force < 0.0 { scale / model.actuator_acc0()[actuator].max(MIN) } else { force },
            length: low + (length - shortest_length) / optimum,
            scale: 1.0 / optimum,
            longest,
        }
    }
}

/// Returns the active force for an activation of 1.
pub(super) fn gain(model: &Model, actuator: usize, length: f64, velocity: f64) -> Curve {
    let parameters = &model.actuator_gainprm()[actuator];
    let [low, high, _, _, shortest, _, fastest, _, peak, ..] = *parameters;
    let muscle = Muscle::new(model, actuator, parameters, length);
    let [shortest_length, longest_length] = model.actuator_lengthrange()[actuator];
    let optimum = (longest_length - shortest_length) / (high - low).max(MIN);
    let velocity_scale = 1.0 / (optimum * fastest).max(MIN);
    let (by_length, length_slope) = length_curve(muscle.length, shortest, muscle.longest);
    let (by_velocity, velocity_slope) = velocity_curve(velocity * velocity_scale, peak);
    Curve {
        value: -muscle.force * by_length * by_velocity,
        by_length: -muscle.force * length_slope * muscle.scale * by_velocity,
        by_velocity: -muscle.force * by_length * velocity_slope * velocity_scale,
    }
}

/// Returns the value and the slope of FL.
fn length_curve(length: f64, shortest: f64, longest: f64) -> (f64, f64) {
    let (low, high) = (0.5 * (shortest + 1.0), 0.5 * (1.0 + longest));
    // Each piece is 0.5 x² or 1 − 0.5 x², with x linear in the length.
    let piece = |from: f64, to: f64, sign: f64| {
        let width = (to - from).abs().max(MIN);
        let x = sign * (length - from) / width;
        (x, sign / width)
    };
    let rising = |(x, slope): (f64, f64)| (0.5 * x * x, x * slope);
    let falling = |(x, slope): (f64, f64)| (1.0 - 0.5 * x * x, -x * slope);
    if (shortest..=low).contains(&length) {
        rising(piece(shortest, low, 1.0))
    } else if length <= 1.0 {
        // The engine continues this piece below the shortest length.
        falling(piece(1.0, low, -1.0))
    } else if length <= high {
        falling(piece(1.0, high, 1.0))
    } else if length <= longest {
        rising(piece(longest, high, -1.0))
    } else {
        (0.0, 0.0)
    }
}

/// Returns the value and the slope of FV.
fn velocity_curve(velocity: f64, peak: f64) -> (f64, f64) {
    let last = peak - 1.0;
    if velocity <= -1.0 {
        (0.0, 0.0)
    } else if velocity <= 0.0 {
        ((velocity + 1.0).powi(2), 2.0 * (velocity + 1.0))
    } else if velocity <= last {
        let width = last.max(MIN);
        (peak - (last - velocity).powi(2) / width, 2.0 * (last - velocity) / width)
    } else {
        (peak, 0.0)
    }
}

/// Returns the passive force.
pub(super) fn bias(model: &Model, actuator: usize, length: f64) -> Curve {
    let parameters = &model.actuator_biasprm()[actuator];
    let muscle = Muscle::new(model, actuator, parameters, length);
    let passive = muscle.force * parameters[7];
    let bend = 0.5 * (1.0 + muscle.longest);
    let width = (bend - 1.0).max(MIN);
    let (value, slope) = if muscle.length <= 1.0 {
        (0.0, 0.0)
    } else if muscle.length <= bend {
        let x = (muscle.length - 1.0) / width;
        (0.5 * x * x, x / width)
    } else {
        (0.5 + (muscle.length - bend) / width, 1.0 / width)
    };
    Curve { value: -passive * value, by_length: -passive * slope * muscle.scale, by_velocity: 0.0 }
}

/// Returns the derivatives of the rate of an activation by the activation and by the control.
pub(super) fn activation_rate(model: &Model, actuator: usize, control: f64, activation: f64) -> (f64, f64) {
    let [rise, fall, ..] = model.actuator_dynprm()[actuator];
    let clamped = control.clamp(0.0, 1.0);
    let control_slope = if (0.0..=1.0).contains(&control) { 1.0 } else { 0.0 };
    let scale = 0.5 + 1.5 * activation.clamp(0.0, 1.0);
    let scale_slope = if (0.0..=1.0).contains(&activation) { 1.5 } else { 0.0 };
    let (constant, constant_slope) = if clamped > activation {
        (rise * scale, rise * scale_slope)
    } else {
        (fall / scale, -fall * scale_slope / (scale * scale))
    };
    if constant < MIN_TIME_CONSTANT {
        return (-1.0 / MIN_TIME_CONSTANT, control_slope / MIN_TIME_CONSTANT);
    }
    let by_activation = -1.0 / constant - (clamped - activation) * constant_slope / (constant * constant);
    (by_activation, control_slope / constant)
}
