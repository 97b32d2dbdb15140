//! Keyframes: states that a simulation can be reset to.

use super::{View, ViewMut};
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Keyframe on Model {
    /// Time, s.
    time: f64 = key_time, set_time in key_time_mut;
    /// Position. `(nq)`
    qpos: [f64] = key_qpos, qpos_mut in key_qpos_mut;
    /// Velocity. `(nv)`
    qvel: [f64] = key_qvel, qvel_mut in key_qvel_mut;
    /// Activation. `(na)`
    act: [f64] = key_act, act_mut in key_act_mut;
    /// Positions of the mocap bodies, m. `(3 nmocap)`
    mpos: [f64] = key_mpos, mpos_mut in key_mpos_mut;
    /// Orientations of the mocap bodies: unit quaternions `[w, x, y, z]`. `(4 nmocap)`
    mquat: [f64] = key_mquat, mquat_mut in key_mquat_mut;
    /// Control. `(nu)`
    ctrl: [f64] = key_ctrl, ctrl_mut in key_ctrl_mut;
});
