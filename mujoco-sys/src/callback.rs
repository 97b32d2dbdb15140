//! Fallible callbacks. The engine's callbacks are process-wide function pointers; the shim forwards
//! them to one handler that may fail.
//!
//! The shim turns a failure into an engine error after the handler has returned. The error jumps
//! over every frame up to the guard, so no Rust frame may be among them.

use std::os::raw::c_int;

use crate::{mjData, mjModel, mjtNum};

/// Sets the controls (`mjcb_control`).
pub const CONTROL: c_int = 0;
/// Adds to the passive forces (`mjcb_passive`).
pub const PASSIVE: c_int = 1;
/// Sets the readings of the user sensors of a stage (`mjcb_sensor`).
pub const SENSOR: c_int = 2;
/// Filters pairs of geoms (`mjcb_contactfilter`). A nonzero value excludes the pair.
pub const CONTACT_FILTER: c_int = 3;
/// Returns the time derivative of an activation (`mjcb_act_dyn`).
pub const ACTUATOR_DYNAMICS: c_int = 4;
/// Returns the gain of an actuator (`mjcb_act_gain`).
pub const ACTUATOR_GAIN: c_int = 5;
/// Returns the bias of an actuator (`mjcb_act_bias`).
pub const ACTUATOR_BIAS: c_int = 6;

/// Handler of all callbacks. Arguments: the callback's identifier, the model, the data, up to two
/// indices (the stage, the two geoms or the actuator), and the value, which holds the engine's
/// default on entry and the result on return. A nonzero return value makes the engine call fail.
pub type Handler = unsafe extern "C" fn(c_int, *const mjModel, *mut mjData, c_int, c_int, *mut mjtNum) -> c_int;

unsafe extern "C" {
    /// Installs `handler` for one callback, for the whole process. All callbacks share the handler,
    /// so every call must pass the same.
    ///
    /// # Safety
    ///
    /// The handler must be sound for every model and data that any thread of the process simulates,
    /// must not unwind, and must not raise an engine error.
    #[link_name = "mujoco_sys_install_callback"]
    pub fn install_callback(callback: c_int, handler: Handler);

    /// Installs a monotonic clock, in seconds, as `mjcb_time`, for the whole process.
    ///
    /// # Safety
    ///
    /// The requirements of [`crate::guard::install`].
    #[link_name = "mujoco_sys_install_clock"]
    pub fn install_clock();
}
