//! The state as a keyframe of the model.

use super::{Data, StateSpec};
use crate::error::Result;
use crate::id::{Id, Key, kind};

impl Data {
    /// Writes the present time, positions, velocities, activations, mocap poses and controls to a keyframe of this simulation's
    /// model, given by its name, its index or its id, from which [`reset_to_key`](Self::reset_to_key) sets them again. A model
    /// that others share is copied first, so theirs stays as it is.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) if there is no such
    /// keyframe, [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory) if the copy cannot be
    /// allocated.
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
    pub fn set_keyframe(&mut self, key: impl Key<kind::Keyframe>) -> Result<()> {
        let key: Id<kind::Keyframe> = key.id(self.model().as_ref())?;
        let key = key.index();
        let part = |spec| self.state(spec);
        let (time, qpos, qvel, act) = (self.time(), part(StateSpec::QPOS), part(StateSpec::QVEL), part(StateSpec::ACT));
        let (pos, quat) = (part(StateSpec::MOCAP_POS), part(StateSpec::MOCAP_QUAT));
        let ctrl = part(StateSpec::CTRL);
        // Nothing is computed from keyframes.
        let computed = self.computed;
        self.edit_model(|model| {
            model.key_time_mut()[key] = time;
            model.key_qpos_mut().into_row(key).copy_from_slice(&qpos);
            model.key_qvel_mut().into_row(key).copy_from_slice(&qvel);
            model.key_act_mut().into_row(key).copy_from_slice(&act);
            model.key_mpos_mut().into_row(key).copy_from_slice(&pos);
            model.key_mquat_mut().into_row(key).copy_from_slice(&quat);
            model.key_ctrl_mut().into_row(key).copy_from_slice(&ctrl);
        })?;
        self.computed = computed;
        Ok(())
    }
}
