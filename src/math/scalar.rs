//! Functions of numbers.

use std::ffi::c_int;

use mujoco_sys as sys;

use crate::error::{Error, Result};

/// Where `ẍ = −Kp x − Kv ẋ` leads in the time `dt` (s) from the position `pos0` and the velocity `vel0`, exactly.
///
/// ```
/// // Without damping, half a period later.
/// let there = mujoco_safe::math::spring_damper(1.0, 0.0, 4.0, 0.0, std::f64::consts::FRAC_PI_2);
/// assert!((there + 1.0).abs() < 1e-15);
/// ```
#[doc(alias = "mju_springDamper")]
pub fn spring_damper(pos0: f64, vel0: f64, kp: f64, kv: f64, dt: f64) -> f64 {
    // SAFETY: the function only computes.
    unsafe { sys::mju_springDamper(pos0, vel0, kp, kv, dt) }
}

/// A smooth step from 0, for `x ≤ 0`, to 1, for `x ≥ 1`, of two parabolas. (Newer engines use a polynomial of the fifth degree.)
#[doc(alias = "mju_sigmoid")]
pub fn sigmoid(x: f64) -> f64 {
    // SAFETY: the function only computes.
    unsafe { sys::mju_sigmoid(x) }
}

/// The number `index` of Halton's sequence of a base: the digits of `index` in that base, mirrored at the point. Sequences of
/// bases that are prime to each other fill a cube evenly.
///
/// # Errors
///
/// [`Error::Invalid`] for a base below 2 (the engine would divide by zero, or never end), and for numbers beyond a C int.
///
/// ```
/// use mujoco_safe::math;
///
/// assert_eq!(math::halton(6, 2)?, 0.375); // 110 → 0.011
/// assert!(math::halton(6, 1).is_err());
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_Halton")]
pub fn halton(index: u32, base: u32) -> Result<f64> {
    let largest = c_int::MAX;
    let number = |what: &str, value: u32, least: c_int| {
        c_int::try_from(value).ok().filter(|&value| value >= least).ok_or_else(|| {
            Error::invalid(format!("the {what} of halton"), value, format!("between {least} and {largest}"))
        })
    };
    let (index, base) = (number("index", index, 0)?, number("base", base, 2)?);
    // SAFETY: the base is at least 2, so each division makes the index smaller.
    Ok(unsafe { sys::mju_Halton(index, base) })
}
