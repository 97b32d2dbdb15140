//! The engine's model of muscles (MuJoCo's documentation, "Modeling", "Muscles").
//!
//! The nine parameters `prm` are those of a muscle's `actuator_gainprm`: `[range[0], range[1], force, scale, lmin, lmax, vmax,
//! fpmax, fvmax]`. `lengthrange` (m) is the actuator's, and `acc0` the acceleration that unit force gives it in the reference
//! position; with a negative `force` the peak force is `scale / acc0`.

use mujoco_sys as sys;

/// The active force (N) of a muscle at full activation, at the length `len` (m) and the velocity `vel` (m/s) of the actuator.
/// Not positive: muscles pull.
#[doc(alias = "mju_muscleGain")]
pub fn muscle_gain(len: f64, vel: f64, lengthrange: &[f64; 2], acc0: f64, prm: &[f64; 9]) -> f64 {
    // SAFETY: two and nine numbers to read.
    unsafe { sys::mju_muscleGain(len, vel, lengthrange.as_ptr(), acc0, prm.as_ptr()) }
}

/// The passive force (N) of a muscle at the length `len` (m) of the actuator. Not positive.
#[doc(alias = "mju_muscleBias")]
pub fn muscle_bias(len: f64, lengthrange: &[f64; 2], acc0: f64, prm: &[f64; 9]) -> f64 {
    // SAFETY: two and nine numbers to read.
    unsafe { sys::mju_muscleBias(len, lengthrange.as_ptr(), acc0, prm.as_ptr()) }
}

/// The change per second of a muscle's activation `act` under the control `ctrl`, with the time constants (s) of activation and
/// deactivation in `prm`: M. Millard and others, "Flexing computational muscle", Journal of Biomechanical Engineering 135, 2013.
#[doc(alias = "mju_muscleDynamics")]
pub fn muscle_dynamics(ctrl: f64, act: f64, prm: &[f64; 2]) -> f64 {
    // SAFETY: two numbers to read.
    unsafe { sys::mju_muscleDynamics(ctrl, act, prm.as_ptr()) }
}
