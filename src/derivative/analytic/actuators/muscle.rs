//! Derivatives of the engine's muscle model.
//!
//! For the normalised length L and velocity V, the gain is `−F FL(L) FV(V)` and the bias
//! `−F FP(L)`, where F is the peak active force and all curves are piecewise quadratic. The
//! activation follows the control with a time constant that depends on the activation:
//! `ȧ = (u − a)/τ(a)`, `τ = τ₀ s` for u above a and `τ₁/s` below it, `s = 0.5 + 1.5 a`; since 2.3.6
//! a smooth step of any width can replace that at u = a. (M. Millard, T. Uchida, A. Seth and S.
//! Delp, "Flexing computational muscle", Journal of Biomechanical Engineering 2013; "Muscle
//! actuators" in the engine's documentation.)

use super::{Curve, MIN_TIME_CONSTANT};
use crate::derivative::kinks::{MuscleSides, is_inside};
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
    if cfg!(engine_since = "3.1.2") && !(shortest..=longest).contains(&length) {
        return (0.0, 0.0);
    }
    if (shortest..=low).contains(&length) {
        rising(piece(shortest, low, 1.0))
    } else if length <= 1.0 {
        // Before 3.1.2 the engine continues this piece below the shortest length.
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

/// Returns the derivatives of the rate of an activation by the activation and by the control, each
/// on its side of the kink.
pub(super) fn activation_rate(
    model: &Model,
    actuator: usize,
    (control, activation): (f64, f64),
    sides: MuscleSides,
) -> (f64, f64) {
    let [rise, fall, width, ..] = model.actuator_dynprm()[actuator];
    let clamped = control.clamp(0.0, 1.0);
    let control_slope = if is_inside(control, [0.0, 1.0]) { 1.0 } else { 0.0 };
    let scale = 0.5 + 1.5 * activation.clamp(0.0, 1.0);
    let scale_slope = if is_inside(activation, [0.0, 1.0]) { 1.5 } else { 0.0 };
    let excess = clamped - activation;
    let rising = (rise * scale, rise * scale_slope);
    let falling = (fall / scale, -fall * scale_slope / (scale * scale));
    // The time constant, and its derivatives by the activation at a constant excess, and by the
    // excess.
    let time_constant = |is_rising: bool| {
        if cfg!(not(engine_since = "2.3.6")) || width < MIN {
            let (constant, slope) = if is_rising { rising } else { falling };
            return (constant, slope, 0.0);
        }
        let (step, step_slope) = smooth_step(excess / width + 0.5);
        let mix = |rising: f64, falling: f64| falling + step * (rising - falling);
        (mix(rising.0, falling.0), mix(rising.1, falling.1), (rising.0 - falling.0) * step_slope / width)
    };
    let rate = |is_rising: bool| {
        let (constant, by_activation, by_excess) = time_constant(is_rising);
        if constant < MIN_TIME_CONSTANT {
            return (-1.0 / MIN_TIME_CONSTANT, 1.0 / MIN_TIME_CONSTANT);
        }
        let of_constant = excess / (constant * constant);
        let by_control = 1.0 / constant - of_constant * by_excess;
        (-by_control - of_constant * by_activation, by_control)
    };
    (rate(sides.of_activation).0, control_slope * rate(sides.of_control).1)
}

/// Returns the value and the slope of the engine's sigmoid, a polynomial between 0 and 1.
fn smooth_step(x: f64) -> (f64, f64) {
    if x <= 0.0 {
        (0.0, 0.0)
    } else if x >= 1.0 {
        (1.0, 0.0)
    } else {
        (x.powi(3) * (3.0 * x * (2.0 * x - 5.0) + 10.0), 30.0 * (x * (1.0 - x)).powi(2))
    }
}
