//! Creation and copies of simulations, and their model.

use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr::{self, NonNull};
use std::sync::Arc;

use mujoco_sys::{adapted, guard, mjData};

use super::{ActiveCallbacks, Data, PipelineFlags, warning};
use crate::error::{Error, Outcome, Result};
use crate::ffi;
use crate::model::{CheckedEdit, IntoModel, Model, ModelMut, Relation};

/// # Creation, copies and the model
impl Data {
    /// Creates a simulation of a [`Model`], an `Arc<Model>` or an `&Arc<Model>`, in the reference
    /// position and at rest.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    /// [`Error::Invalid`] for a model that was edited so that the engine would access memory
    /// outside of the model's arrays; see [`ModelMut`].
    #[doc(alias = "mj_makeData")]
    #[doc(alias = "init_data")]
    pub fn new(model: impl IntoModel) -> Result<Self> {
        let model = model.into_model();
        model.check_addresses()?;
        let mut made = ptr::null_mut();
        // SAFETY: a valid model, and a valid pointer for the result.
        ffi::check_without_data("mj_makeData", unsafe { guard::mj_make_data(model.as_ptr(), &raw mut made) })?;
        // SAFETY: the engine made it for this model.
        unsafe { Self::from_raw(made, model) }.map(Self::with_plugin_states)
    }

    /// Clears the states of plugins that have no function that resets them: the engine leaves them
    /// as it finds the memory.
    fn with_plugin_states(mut self) -> Self {
        let model = self.model.clone();
        for ((_, instance), (place, _)) in model.plugin_parts() {
            // SAFETY: an instance of the model, whose plugin is registered and never removed.
            if unsafe { adapted::plugin_has_reset(model.as_ptr(), instance as c_int) } == 0 {
                self.plugin_state_values_mut()[place].fill(0.0);
            }
        }
        self
    }

    /// Returns the model.
    #[inline]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Changes the model of this simulation. A shared model is copied first, so that other
    /// simulations keep theirs unchanged.
    ///
    /// All results were computed for the old model, so they count as not computed afterwards.
    /// Sleeping bodies wake.
    ///
    /// The closure returns nothing or a [`Result`], as for
    /// [`Rollout::with_model_edits`](crate::Rollout::with_model_edits); the call returns the value
    /// in its `Ok`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the copy of the model cannot be allocated.
    /// The model is unchanged then, and the data is not poisoned. The error of the closure, if it
    /// returns one. Its changes before the error remain. [`Error::Invalid`] for values with which
    /// the engine would access memory outside of the model's arrays; see [`ModelMut`]. All changes
    /// of the arrays with such values are then undone.
    ///
    /// ```
    /// use mujoco_safe::enums::Cone;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.edit_model(|model| model.edit_options(|options| options.cone = Cone::Elliptic))?;
    /// assert_eq!(data.model().options().cone, Cone::Elliptic);
    ///
    /// let mass = data.edit_model(|model| {
    ///     model.body_mut("torso")?.scale_mass(2.0)?;
    ///     model.update_constants()?;
    ///     Ok(model.total_mass())
    /// })?;
    /// assert!(mass > 40.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// <details><summary>Uses that the compiler rejects</summary>
    ///
    /// The closure cannot replace the model by another one:
    ///
    /// ```compile_fail,E0521
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut a = Data::new(sample::humanoid()).unwrap();
    /// let mut b = Data::new(sample::cartpole()).unwrap();
    /// a.edit_model(|a| b.edit_model(|b| std::mem::swap(a, b))); // borrowed data escapes
    /// ```
    ///
    /// ```compile_fail,E0308
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid()).unwrap();
    /// let mut other = sample::cartpole();
    /// data.edit_model(|model| std::mem::swap(model, &mut other)); // a `ModelMut` is not a `Model`
    /// ```
    ///
    /// It cannot keep a borrow of the model either:
    ///
    /// ```compile_fail,E0521
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid()).unwrap();
    /// let mut mass = None;
    /// data.edit_model(|model| mass = Some(model.body_mass_mut())); // borrowed data escapes
    /// data.step();
    /// ```
    ///
    /// </details>
    pub fn edit_model<O: Outcome>(&mut self, edit: impl FnOnce(&mut ModelMut<'_>) -> O) -> Result<O::Value> {
        self.own_model()?;
        self.computed = PipelineFlags::empty();
        #[cfg(engine_since = "3.0.0")]
        let active = self.model.equality_active().to_vec();
        let mut checked = CheckedEdit::new(self.own_model()?);
        // A panic keeps the changes that the closure has made, so the simulation follows them.
        let result = catch_unwind(AssertUnwindSafe(|| edit(checked.model()).into_result()));
        let check = checked.finish();
        #[cfg(engine_since = "3.0.0")]
        self.switch_equalities(&active);
        self.wake_for_new_model();
        result.unwrap_or_else(|panic| resume_unwind(panic)).and_then(|value| check.map(|()| value))
    }

    /// Returns the model for changes that no result depends on. A shared model is copied first.
    pub(super) fn own_model(&mut self) -> Result<&mut Model> {
        if Arc::get_mut(&mut self.model).is_none() {
            self.model = Arc::new(self.model.try_clone()?);
        }
        Ok(Arc::get_mut(&mut self.model).expect("Bug: a fresh copy of a model is shared"))
    }

    /// Switches the equality constraints that an edit has switched in the model, where newer
    /// engines have only their initial activity.
    #[cfg(engine_since = "3.0.0")]
    fn switch_equalities(&mut self, before: &[u8]) {
        let model = self.model.clone();
        // SAFETY: the engine allocated the array with this length, and `self` is borrowed
        // exclusively.
        let present = unsafe { ffi::array_mut(self.raw_mut().eq_active, before.len()) };
        for ((present, &active), before) in present.iter_mut().zip(model.equality_active()).zip(before) {
            if active != *before {
                *present = active;
            }
        }
    }

    /// Exchanges the model for another one of the same structure. All results count as not computed
    /// afterwards.
    pub(crate) fn swap_model(&mut self, model: &mut Arc<Model>) {
        assert!(self.model.is_same_structure(model), "Bug: a simulation gets a model of another structure");
        std::mem::swap(&mut self.model, model);
        self.computed = PipelineFlags::empty();
        self.take_equalities_of_model();
        self.wake_for_new_model();
    }

    /// Activates the equality constraints that are active in the model. With newer engines they
    /// belong to the simulation.
    #[cfg_attr(not(engine_since = "3.0.0"), allow(clippy::unused_self, reason = "they belong to the model"))]
    fn take_equalities_of_model(&mut self) {
        #[cfg(engine_since = "3.0.0")]
        {
            let model = self.model.clone();
            let active = model.equality_active();
            // SAFETY: the engine allocated the array with this length, and `self` is borrowed
            // exclusively.
            unsafe { ffi::array_mut(self.raw_mut().eq_active, active.len()) }.copy_from_slice(active);
        }
    }

    /// Returns a copy, or an error if memory is exhausted. [`Clone`] panics in that case. A copy of
    /// poisoned data is poisoned. The copy has no [callbacks](Self::set_callbacks).
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    #[doc(alias = "mj_copyData")]
    pub fn try_clone(&self) -> Result<Self> {
        let mut copy = ptr::null_mut();
        self.call("mj_copyData", |m, _| {
            // SAFETY: for a NULL destination the engine allocates a new data; the source is valid
            // and was made for the model.
            self.with_empty_stack(|source| unsafe { guard::mj_copy_data(ptr::null_mut(), m, source, &raw mut copy) })
        })?;
        // SAFETY: the engine made it for this model, and nothing else refers to it.
        let mut copy = unsafe { Self::from_raw(copy, self.model.clone()) }?;
        copy.computed = self.computed;
        copy.failure.clone_from(&self.failure);
        warning::restore_copied(copy.raw_mut());
        Ok(copy)
    }

    /// Copies all fields from another simulation without allocation. The models must have the same
    /// structure; this simulation keeps its own model and its [callbacks](Self::set_callbacks).
    /// Afterwards it is poisoned if and only if the other one is.
    ///
    /// If the simulations do not share their model, all results count as not computed, and sleeping
    /// bodies wake.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the model of the other simulation was loaded separately.
    /// [`Error::Engine`] if the engine fails, which does not occur for two models of the same
    /// structure.
    #[doc(alias = "mj_copyData")]
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.copy_fields(other)?;
        if self.model.relation(&other.model) == Relation::Same {
            self.computed = other.computed;
        } else {
            // With other options, results may have another layout.
            self.take_equalities_of_model();
            self.wake_for_new_model();
        }
        Ok(())
    }

    /// Copies all fields. All results count as not computed afterwards.
    fn copy_fields(&mut self, other: &Self) -> Result<()> {
        self.model.relation(&other.model).check("the data to copy from")?;
        let mut copied = ptr::null_mut();
        self.call_mut("mj_copyData", |m, d| {
            // SAFETY: the models of both data have the same structure, so the data have the same
            // sizes.
            other.with_empty_stack(|source| unsafe { guard::mj_copy_data(d, m, source, &raw mut copied) })
        })?;
        self.computed = PipelineFlags::empty();
        self.failure.clone_from(&other.failure);
        warning::restore_copied(self.raw_mut());
        Ok(())
    }

    /// Calls `copy` with this data, or during a step with a shallow copy whose stack is empty. The
    /// engine does not copy a data whose stack is in use, and leaks the destination that it has
    /// allocated. A copy does not need the contents of the stack.
    fn with_empty_stack<R>(&self, copy: impl FnOnce(*const mjData) -> R) -> R {
        if self.raw().pstack == 0 {
            return copy(self.as_ptr());
        }
        // SAFETY: a bitwise copy of the structure, whose pointers nothing uses after this call.
        let mut shallow = unsafe { Box::new(std::ptr::read(self.as_ptr())) };
        shallow.pstack = 0;
        #[cfg(engine_since = "3.0.0")]
        {
            shallow.pbase = 0;
        }
        copy(&raw const *shallow)
    }

    /// # Safety
    ///
    /// `raw` is NULL, or a data that the engine made for a model of the same structure as `model`
    /// and that has no other owner.
    unsafe fn from_raw(raw: *mut mjData, model: Arc<Model>) -> Result<Self> {
        let raw = NonNull::new(raw).ok_or(Error::OutOfMemory { function: "mj_makeData" })?;
        Ok(Self { raw, model, computed: PipelineFlags::empty(), failure: None, callbacks: ActiveCallbacks::default() })
    }
}

impl Clone for Data {
    /// # Panics
    ///
    /// If memory is exhausted; see [`try_clone`](Self::try_clone).
    fn clone(&self) -> Self {
        self.try_clone().unwrap_or_else(|error| panic!("cannot clone the data: {error}"))
    }

    /// Reuses the memory if the models have the same structure. As after an assignment of a clone,
    /// this simulation has no [callbacks](Self::set_callbacks).
    fn clone_from(&mut self, source: &Self) {
        if self.copy_fields(source).is_ok() {
            self.model = source.model.clone();
            self.computed = source.computed;
            self.callbacks = ActiveCallbacks::default();
        } else {
            *self = source.clone();
        }
    }
}
