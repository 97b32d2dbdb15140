//! The engine's callbacks, which are function pointers of the whole process, behind one handler that may fail.
//!
//! The shim's side of them turns a failure into an engine error, after the handler has returned: that error jumps over every
//! frame between it and the guard, and no frame of Rust may be among them.

use std::os::raw::c_int;

use crate::{mjData, mjModel, mjtNum};

/// The controls are to be set (`mjcb_control`).
pub const CONTROL: c_int = 0;
/// Passive forces may be added to (`mjcb_passive`).
pub const PASSIVE: c_int = 1;
/// The readings of user sensors of a stage are to be set (`mjcb_sensor`).
pub const SENSOR: c_int = 2;
/// May two geoms collide (`mjcb_contactfilter`)? The value is not zero if they may not.
pub const CONTACT_FILTER: c_int = 3;
/// The derivative of an activation (`mjcb_act_dyn`).
pub const ACTUATOR_DYNAMICS: c_int = 4;
/// The gain of an actuator (`mjcb_act_gain`).
pub const ACTUATOR_GAIN: c_int = 5;
/// The bias of an actuator (`mjcb_act_bias`).
pub const ACTUATOR_BIAS: c_int = 6;

/// What answers: what is asked for, the model, the data, up to two numbers (the stage, the two geoms, the actuator), and the
/// value, which holds what the engine does without a callback. A result other than zero is an error of the engine call.
pub type Handler = unsafe extern "C" fn(c_int, *const mjModel, *mut mjData, c_int, c_int, *mut mjtNum) -> c_int;

unsafe extern "C" {
    /// Makes `handler` answer what the engine asks for, from now on and for the whole process. The handler is one for
    /// everything, so it must be the same in each call.
    ///
    /// # Safety
    ///
    /// The handler must be sound for every model and data that any thread of the process simulates, must not unwind, and must
    /// not raise an engine error.
    #[link_name = "mujoco_sys_answer"]
    pub fn answer(what: c_int, handler: Handler);

    /// Makes a monotonic clock, in seconds, the engine's (`mjcb_time`), for the whole process.
    ///
    /// # Safety
    ///
    /// [`crate::guard::install`] asks for no more.
    #[link_name = "mujoco_sys_install_clock"]
    pub fn install_clock();
}
