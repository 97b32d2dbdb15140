//! Scalar functions: the spring-damper, smooth steps, Halton's sequence, and the engine's muscle
//! model.
//!
//! The muscle model is described in MuJoCo's documentation, "Modeling", "Muscles". Its nine
//! parameters `prm` are the same as in a muscle's `actuator_gainprm`: `[range[0], range[1], force,
//! scale, lmin, lmax, vmax, fpmax, fvmax]`. `lengthrange` (m) is the length range of the actuator,
//! and `acc0` its acceleration from unit force in the reference configuration. With a negative
//! `force` the peak force is `scale / acc0`.

use std::ffi::c_int;

use mujoco_sys as sys;

use crate::error::{Error, Result};

/// Returns the exact solution of `ẍ = −Kp x − Kv ẋ` at the time `dt` (s), for the initial position
/// `pos0` and velocity `vel0`.
///
/// ```
/// // Without damping, after half a period.
/// let position = mujoco_safe::math::spring_damper(1.0, 0.0, 4.0, 0.0, std::f64::consts::FRAC_PI_2);
/// assert!((position + 1.0).abs() < 1e-15);
/// ```
pub fn spring_damper(pos0: f64, vel0: f64, kp: f64, kv: f64, dt: f64) -> f64 {
    // SAFETY: a pure function of its arguments.
    unsafe { sys::mju_springDamper(pos0, vel0, kp, kv, dt) }
}

/// Returns a smooth step from 0 for `x ≤ 0` to 1 for `x ≥ 1`, of two parabolas, or since 2.3.6 of a
/// polynomial of fifth degree.
pub fn sigmoid(x: f64) -> f64 {
    // SAFETY: a pure function of its arguments.
    unsafe { sys::mju_sigmoid(x) }
}

/// Returns element `index` of Halton's sequence: the digits of `index` in a base, mirrored at the
/// radix point. Sequences of pairwise coprime bases fill a cube evenly.
///
/// # Errors
///
/// [`Error::Invalid`] for a base below 2 (the engine would divide by zero or loop forever), and for
/// numbers beyond a C `int`.
///
/// ```
/// use mujoco_safe::math;
///
/// assert_eq!(math::halton(6, 2)?, 0.375); // 110 → 0.011
/// assert!(math::halton(6, 1).is_err());
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn halton(index: u32, base: u32) -> Result<f64> {
    let largest = c_int::MAX;
    let number = |what: &str, value: u32, least: c_int| {
        c_int::try_from(value).ok().filter(|&value| value >= least).ok_or_else(|| {
            Error::out_of_range(format!("the {what} of halton"), value, format!("between {least} and {largest}"))
        })
    };
    let (index, base) = (number("index", index, 0)?, number("base", base, 2)?);
    // SAFETY: the base is at least 2, so each division reduces the index and the loop terminates.
    Ok(unsafe { sys::mju_Halton(index, base) })
}

/// Returns the active force (N) of a muscle at full activation, for the length `len` (m) and the
/// velocity `vel` (m/s) of the actuator. It is never positive: muscles pull.
pub fn muscle_gain(len: f64, vel: f64, lengthrange: &[f64; 2], acc0: f64, prm: &[f64; 9]) -> f64 {
    // SAFETY: the arrays have the lengths that the engine reads.
    unsafe { sys::mju_muscleGain(len, vel, lengthrange.as_ptr(), acc0, prm.as_ptr()) }
}

/// Returns the passive force (N) of a muscle for the length `len` (m) of the actuator. It is never
/// positive.
pub fn muscle_bias(len: f64, lengthrange: &[f64; 2], acc0: f64, prm: &[f64; 9]) -> f64 {
    // SAFETY: the arrays have the lengths that the engine reads.
    unsafe { sys::mju_muscleBias(len, lengthrange.as_ptr(), acc0, prm.as_ptr()) }
}

/// Returns the time derivative (1/s) of a muscle's activation `act` for the control `ctrl`. `prm`
/// contains the time constants (s) of activation and deactivation, between which it switches at
/// once (`tausmooth` of newer engines is 0). Source: M. Millard and others, "Flexing computational
/// muscle", Journal of Biomechanical Engineering 135, 2013.
pub fn muscle_dynamics(ctrl: f64, act: f64, prm: &[f64; 2]) -> f64 {
    // Since 2.3.6 the engine reads a third number, the width of a smooth transition.
    let prm = [prm[0], prm[1], 0.0];
    // SAFETY: the array has the length that the engine reads.
    unsafe { sys::mju_muscleDynamics(ctrl, act, prm.as_ptr()) }
}
