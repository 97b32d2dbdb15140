//! Resets and keyframes.

use std::ffi::c_int;

use mujoco_sys::{guard, mjData, mjModel};

#[cfg(not(engine_since = "3.2.0"))]
use super::StateSpec;
use super::{Data, PipelineFlags};
use crate::error::Result;
use crate::id::{Id, IntoId};
use crate::kind;

/// # Reset and keyframes
impl Data {
    /// Resets to the reference position, at rest, with no controls and no applied forces. Makes
    /// poisoned data usable again.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`](crate::Error::Engine) if the engine fails, which does not occur for a
    /// loaded model.
    #[doc(alias = "reset!")]
    #[doc(alias = "mj_resetData")]
    pub fn reset(&mut self) -> Result<()> {
        self.reset_with("mj_resetData", |m, d| {
            // SAFETY: a model and a data of this model.
            unsafe { guard::mj_reset_data(m, d) }
        })
    }

    /// Resets, and then sets time, positions, velocities, activations, mocap poses and controls
    /// from a keyframe, which is selected by name, index or id.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) if the keyframe does not exist; the data
    /// is unchanged then. (The engine would do a plain reset.)
    /// [`Error::Engine`](crate::Error::Engine) as for [`reset`](Self::reset).
    ///
    /// ```
    /// use mujoco_safe::{Data, Error, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("squat")?;
    /// data.reset_to_key(1)?;
    /// assert!(matches!(data.reset_to_key("handstand"), Err(Error::NoSuchName { .. })));
    /// assert!(matches!(data.reset_to_key(99), Err(Error::NoSuchIndex { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mj_resetDataKeyframe")]
    #[doc(alias = "resetkey!")]
    #[doc(alias = "resetkey")]
    pub fn reset_to_key(&mut self, key: impl IntoId<kind::Keyframe>) -> Result<()> {
        let key: Id<kind::Keyframe> = key.id_in(self.model.as_ref())?;
        self.reset_with("mj_resetDataKeyframe", |m, d| {
            // SAFETY: a model, a data of this model, and a keyframe of the model.
            unsafe { guard::mj_reset_data_keyframe(m, d, key.index() as c_int) }
        })
    }

    /// Sets the controls to their neutral values: zero, and the identity for the quaternions that
    /// are inputs of actuators of the type `orientation` (engines from 3.11).
    #[doc(alias = "mj_resetCtrl")]
    pub fn reset_ctrl(&mut self) {
        // SAFETY: a valid model and a data of it; the function writes `nu` controls.
        unsafe { mujoco_sys::adapted::reset_ctrl(self.model.as_ptr(), self.raw.as_ptr()) };
    }

    fn reset_with(
        &mut self,
        function: &'static str,
        reset: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        self.computed = PipelineFlags::empty();
        self.failure = None;
        self.call_mut(function, reset)
    }

    /// Writes the present time, positions, velocities, activations, mocap poses and controls, and
    /// since 4.0 plastic deformations, to a keyframe of this simulation's model, which is selected
    /// by name, index or id. [`reset_to_key`](Self::reset_to_key) restores them. A shared model is
    /// copied first, so that other simulations keep theirs unchanged.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) if the keyframe does not exist,
    /// [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory)
    /// if the copy cannot be allocated.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.step()?;
    /// data.set_keyframe("squat")?;
    /// let state = data.physics_state();
    /// data.reset()?;
    /// data.reset_to_key("squat")?;
    /// assert_eq!(data.physics_state(), state);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_setKeyframe")]
    pub fn set_keyframe(&mut self, key: impl IntoId<kind::Keyframe>) -> Result<()> {
        let key: Id<kind::Keyframe> = key.id_in(self.model().as_ref())?;
        // No results depend on keyframes, so they stay valid.
        self.write_keyframe(key.index())
    }

    #[cfg(engine_since = "3.2.0")]
    fn write_keyframe(&mut self, key: usize) -> Result<()> {
        let data = self.as_ptr();
        let model: *mut mjModel = self.own_model()?.raw_mut();
        // SAFETY: a model that nothing shares, a data of a model of this structure, and a keyframe
        // of it. The function only copies the state.
        unsafe { mujoco_sys::adapted::set_keyframe(model, data, key as c_int) };
        Ok(())
    }

    // Older engines have no function for this.
    #[cfg(not(engine_since = "3.2.0"))]
    fn write_keyframe(&mut self, key: usize) -> Result<()> {
        let part = |spec| self.state(spec);
        let (time, qpos, qvel, act) = (self.time(), part(StateSpec::QPOS), part(StateSpec::QVEL), part(StateSpec::ACT));
        let (pos, quat) = (part(StateSpec::MOCAP_POS), part(StateSpec::MOCAP_QUAT));
        let ctrl = part(StateSpec::CTRL);
        let mut model = self.own_model()?.edit();
        model.key_time_mut()[key] = time;
        model.key_qpos_mut().into_row(key).copy_from_slice(&qpos);
        model.key_qvel_mut().into_row(key).copy_from_slice(&qvel);
        model.key_act_mut().into_row(key).copy_from_slice(&act);
        model.key_mpos_mut().into_row(key).copy_from_slice(&pos);
        model.key_mquat_mut().into_row(key).copy_from_slice(&quat);
        model.key_ctrl_mut().into_row(key).copy_from_slice(&ctrl);
        Ok(())
    }
}
