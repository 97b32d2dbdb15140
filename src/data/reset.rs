//! Resets, keyframes and copies.

use std::ffi::c_int;
use std::ptr;
use std::sync::Arc;

use mujoco_sys::{guard, mjData, mjModel};

use super::{Data, PipelineFlags, StateSpec, warning};
use crate::error::{Error, Result};
use crate::id::{Id, Key};
use crate::kind;

impl Data {
    /// Resets to the reference position, at rest, with no controls and no applied forces. Makes poisoned data usable again.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the engine fails, which does not occur for a loaded model.
    #[doc(alias = "mj_resetData")]
    pub fn reset(&mut self) -> Result<()> {
        self.reset_with("mj_resetData", |m, d| {
            // SAFETY: a model and a data of this model.
            unsafe { guard::mj_reset_data(m, d) }
        })
    }

    /// Resets, and then sets time, positions, velocities, activations, mocap poses and controls from a keyframe, which is
    /// selected by name, index or id.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] if the keyframe does not exist; the data is unchanged then. (The engine
    /// would do a plain reset.) [`Error::Engine`] as for [`reset`](Self::reset).
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
    #[doc(alias = "resetkey")]
    pub fn reset_to_key(&mut self, key: impl Key<kind::Keyframe>) -> Result<()> {
        let key: Id<kind::Keyframe> = key.id(self.model.as_ref())?;
        self.reset_with("mj_resetDataKeyframe", |m, d| {
            // SAFETY: a model, a data of this model, and a keyframe of the model.
            unsafe { guard::mj_reset_data_keyframe(m, d, key.index() as c_int) }
        })
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

    /// Writes the present time, positions, velocities, activations, mocap poses and controls to a keyframe of this simulation's
    /// model, which is selected by name, index or id. [`reset_to_key`](Self::reset_to_key) restores them. A shared model is copied
    /// first, so that other simulations keep theirs unchanged.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] if the keyframe does not exist, [`Error::Engine`] or
    /// [`Error::OutOfMemory`] if the copy cannot be allocated.
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
        // No results depend on keyframes, so they stay valid.
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

    /// Returns a copy, or an error if memory is exhausted. [`Clone`] panics in that case. A copy of poisoned data is poisoned.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    #[doc(alias = "mj_copyData")]
    pub fn try_clone(&self) -> Result<Self> {
        let mut copy = ptr::null_mut();
        self.call("mj_copyData", |m, _| {
            // SAFETY: for a NULL destination the engine allocates a new data; the source is valid and was made for the model.
            self.with_empty_stack(|source| unsafe { guard::mj_copy_data(ptr::null_mut(), m, source, &raw mut copy) })
        })?;
        // SAFETY: the engine made it for this model, and nothing else refers to it.
        let mut copy = unsafe { Self::from_raw(copy, self.model.clone()) }?;
        copy.computed = self.computed;
        copy.failure.clone_from(&self.failure);
        warning::restore_copied(copy.raw_mut());
        Ok(copy)
    }

    /// Copies all fields from another simulation without allocation. The models must have the same structure; this
    /// simulation keeps its own model. Afterwards it is poisoned if and only if the other one is.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the model of the other simulation was loaded separately. [`Error::Engine`] if the engine fails,
    /// which does not occur for two models of the same structure.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        if !self.model.is_same_structure(&other.model) {
            return Err(Error::OtherModel { what: "the data to copy from" });
        }
        let mut copied = ptr::null_mut();
        self.call_mut("mj_copyData", |m, d| {
            // SAFETY: the models of both data have the same structure, so the data have the same sizes.
            other.with_empty_stack(|source| unsafe { guard::mj_copy_data(d, m, source, &raw mut copied) })
        })?;
        // With other options, results may have another layout.
        self.computed = if Arc::ptr_eq(&self.model, &other.model) { other.computed } else { PipelineFlags::empty() };
        self.failure.clone_from(&other.failure);
        warning::restore_copied(self.raw_mut());
        Ok(())
    }

    /// Calls `copy` with this data, or during a step with a shallow copy whose stack is empty. The engine does not copy a data
    /// whose stack is in use, and leaks the destination that it has allocated. A copy does not need the contents of the stack.
    fn with_empty_stack<R>(&self, copy: impl FnOnce(*const mjData) -> R) -> R {
        if self.raw().pstack == 0 {
            return copy(self.as_ptr());
        }
        copy(&raw const *Box::new(mjData { pstack: 0, ..*self.raw() }))
    }
}

impl Clone for Data {
    /// # Panics
    ///
    /// If memory is exhausted; see [`try_clone`](Self::try_clone).
    fn clone(&self) -> Self {
        self.try_clone().unwrap_or_else(|error| panic!("cannot clone the data: {error}"))
    }

    /// Reuses the memory if the models have the same structure.
    fn clone_from(&mut self, source: &Self) {
        if self.copy_from(source).is_ok() {
            self.model = source.model.clone();
            self.computed = source.computed;
        } else {
            *self = source.clone();
        }
    }
}
