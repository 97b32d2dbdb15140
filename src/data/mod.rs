//! The state of a simulation, and everything that is computed from it.
//!
//! `call.rs` holds the gates through which every call of the engine on a simulation goes, and `computed.rs` the record of what has
//! been computed; the other files are themes of [`Data`]'s methods.

mod call;
mod computed;
mod constraint;
mod contact;
mod distance;
mod inertia;
mod jacobian;
mod keyframe;
pub(crate) mod length_range;
mod momentum;
mod needs;
mod new_contact;
mod object;
pub mod pipeline;
mod print;
mod ray;
mod stability;
mod stage;
mod state;
mod statistics;
mod step;
mod warning;

use std::ffi::c_int;
use std::fmt;
use std::ptr::{self, NonNull};
use std::sync::Arc;

use mujoco_sys::{self as sys, guard, mjData, mjModel};

pub(crate) use self::computed::Computed;
pub use self::contact::{Contact, ContactForce};
pub use self::distance::GeomDistance;
pub use self::jacobian::Jacobian;
pub use self::needs::Needs;
pub use self::new_contact::NewContact;
pub use self::object::{Axes, Frame, Motion};
pub use self::ray::{RayHit, RayOptions};
pub use self::stability::{Instability, Quantity};
pub use self::stage::Stage;
pub use self::state::StateSpec;
pub use self::statistics::{SolverIteration, Timer, TimerCount};
pub use self::warning::{Warning, WarningCount};
use crate::callback::Slot;
use crate::element::Key;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{Id, kind};
use crate::model::{Model, ModelMut};

/// A simulation: its state, its inputs, and what was computed from them. It holds its model in an [`Arc`], so the two cannot
/// come apart, and any number of simulations share one model.
///
/// ```
/// use std::sync::Arc;
/// use mujoco_safe::{Data, sample};
///
/// let model = Arc::new(sample::cartpole());
/// let mut data = Data::new(model.clone())?;
/// data.qpos_mut()[1] = 0.1;
/// for _ in 0..100 {
///     data.step()?;
/// }
/// assert!((data.time() - 1.0).abs() < 1e-9);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// # Errors of the engine
///
/// Where the engine itself would print, wait for a key and end the process, the call returns [`Error::Engine`]. The receiver of
/// the call decides about the data:
///
/// - After a call with `&mut Data`, such as [`step`](Self::step), [`rne`](Self::rne) or
///   [`Scene::update`](crate::Scene::update), the data may be half computed. It is poisoned: every call that computes
///   from it returns [`Error::Poisoned`] until a [`reset`](Self::reset). The arrays can still be read. The `# Errors` sections
///   mention this error only for calls that can cause it.
/// - A call with `&Data`, such as [`ray`](Self::ray) or [`Scene::select`](crate::Scene::select), only reads. The data stays as
///   it was and usable.
///
/// # What does not compile
///
/// A view, a slice or a contact borrows the simulation, so it cannot outlive it,
///
/// ```compile_fail,E0597
/// # use mujoco_safe::{Data, sample};
/// let knee = {
///     let data = Data::new(sample::humanoid()).unwrap();
///     data.joint("left_knee").unwrap() // `data` does not live long enough
/// };
/// println!("{:?}", knee.qpos());
/// ```
///
/// and a step cannot change what it shows:
///
/// ```compile_fail,E0502
/// # use mujoco_safe::{Data, sample};
/// let mut data = Data::new(sample::humanoid()).unwrap();
/// let qpos = data.qpos();
/// data.step().unwrap(); // also borrowed as immutable
/// println!("{qpos:?}");
/// ```
///
/// ```compile_fail,E0502
/// # use mujoco_safe::{Data, sample};
/// let mut data = Data::new(sample::humanoid()).unwrap();
/// let contacts: Vec<_> = data.contacts().collect();
/// data.reset().unwrap(); // also borrowed as immutable
/// println!("{:?}", contacts[0].force());
/// ```
///
/// The model of a simulation is shared, and changes through [`edit_model`](Self::edit_model) only:
///
/// ```compile_fail,E0596
/// # use mujoco_safe::{Data, sample};
/// let data = Data::new(sample::humanoid()).unwrap();
/// let mut model = data.model().clone();
/// model.edit(); // cannot borrow data in an `Arc` as mutable
/// ```
///
/// Any number of threads may read a simulation, or one may step it, but not both at once:
///
/// ```compile_fail,E0502
/// # use mujoco_safe::{Data, sample};
/// let mut data = Data::new(sample::humanoid()).unwrap();
/// let torso = data.body("torso").unwrap();
/// std::thread::scope(|scope| {
///     scope.spawn(|| data.step()); // also borrowed as immutable
///     println!("{:?}", torso.xpos());
/// });
/// ```
///
/// ```compile_fail,E0499
/// # use mujoco_safe::{Data, sample};
/// let mut data = Data::new(sample::humanoid()).unwrap();
/// std::thread::scope(|scope| {
///     scope.spawn(|| data.step());
///     scope.spawn(|| data.step()); // more than once as mutable
/// });
/// ```
#[doc(alias = "mjData")]
pub struct Data {
    raw: NonNull<mjData>,
    model: Arc<Model>,
    /// Results that have been computed for the present model.
    computed: Computed,
    /// Why the data is unusable, if it is.
    failure: Option<Box<str>>,
    /// The closures that the engine calls, within the scope of [`with_callbacks`](Self::with_callbacks).
    pub(crate) callbacks: Option<Arc<Slot>>,
}

// SAFETY: the engine's data has no thread affinity, and it is ours alone.
unsafe impl Send for Data {}
// SAFETY: whatever takes `&Data` reads fields, or calls an engine function that takes `const mjData*`: mj_jac, mj_jacBody,
// mj_jacBodyCom, mj_jacGeom, mj_jacSite, mj_mulM, mj_contactForce, mj_objectVelocity, mj_objectAcceleration, mj_ray,
// mj_rayMesh, mj_rayHfield, mj_copyData (its source), or one whose `mjData*` is not const but which only reads it: mj_mulJacVec,
// mj_mulJacTVec, mj_local2Global. Those write to nothing but their output arguments.
unsafe impl Sync for Data {}

impl Data {
    /// A simulation of this model, in its reference position and at rest. Takes a [`Model`] or an `Arc<Model>`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    #[doc(alias = "mj_makeData")]
    #[doc(alias = "init_data")]
    pub fn new(model: impl Into<Arc<Model>>) -> Result<Self> {
        let model = model.into();
        let mut made = ptr::null_mut();
        // SAFETY: a valid model, a place for the result.
        ffi::check_without_data("mj_makeData", unsafe { guard::mj_make_data(model.as_ptr(), &raw mut made) })?;
        // SAFETY: the engine made it for this model.
        unsafe { Self::from_raw(made, model) }
    }

    /// # Safety
    ///
    /// `raw` is NULL or a data that the engine made for a model of the same structure as `model`, and nobody else's.
    unsafe fn from_raw(raw: *mut mjData, model: Arc<Model>) -> Result<Self> {
        let raw = NonNull::new(raw).ok_or(Error::OutOfMemory { function: "mj_makeData" })?;
        Ok(Self { raw, model, computed: Computed::empty(), failure: None, callbacks: None })
    }

    /// The model.
    #[inline]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Changes the model of this simulation. A model that others share is copied first, so theirs stays as it is.
    ///
    /// What has been computed so far was computed for the model as it was, so it counts as not computed afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the copy of the model cannot be allocated. Nothing is changed then, and the
    /// data is not poisoned.
    ///
    /// ```
    /// use mujoco_safe::{Cone, Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.edit_model(|model| model.options(|options| options.cone = Cone::Elliptic))??;
    /// assert_eq!(data.model().options().cone, Cone::Elliptic);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// The model cannot be replaced by another one in this way:
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
    /// data.edit_model(|model| std::mem::swap(model, &mut other)); // a `ModelMut` is no `Model`
    /// ```
    ///
    /// nor can anything of it be kept:
    ///
    /// ```compile_fail,E0521
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid()).unwrap();
    /// let mut mass = None;
    /// data.edit_model(|model| mass = Some(model.body_mass_mut())); // borrowed data escapes
    /// data.step();
    /// ```
    pub fn edit_model<R>(&mut self, edit: impl FnOnce(&mut ModelMut<'_>) -> R) -> Result<R> {
        if Arc::get_mut(&mut self.model).is_none() {
            self.model = Arc::new(self.model.try_clone()?);
        }
        let model = Arc::get_mut(&mut self.model).expect("Bug: a fresh copy of a model is shared");
        self.computed = Computed::empty();
        Ok(edit(&mut model.edit()))
    }

    /// Resets to the reference position, at rest, with no controls and no applied forces. Makes a poisoned data usable again.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the engine fails. It fails for no model that was loaded.
    #[doc(alias = "mj_resetData")]
    pub fn reset(&mut self) -> Result<()> {
        self.reset_by("mj_resetData", |m, d| {
            // SAFETY: a model and a data that go together.
            unsafe { guard::mj_reset_data(m, d) }
        })
    }

    /// Resets, and then sets time, positions, velocities, activations, mocap poses and controls from a keyframe, given by its
    /// name, its index or its id.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] if there is no such keyframe; the data is unchanged then. (The engine would
    /// make a plain reset.) [`Error::Engine`] as for [`reset`](Self::reset).
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
        let key: Id<kind::Keyframe> = key.id(&self.model)?;
        self.reset_by("mj_resetDataKeyframe", |m, d| {
            // SAFETY: a model and a data that go together, and a keyframe of the model.
            unsafe { guard::mj_reset_data_keyframe(m, d, key.index() as c_int) }
        })
    }

    fn reset_by(
        &mut self,
        function: &'static str,
        reset: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        self.computed = Computed::empty();
        self.failure = None;
        self.call_mut(function, reset)
    }

    /// Returns a copy, or an error if there is no memory for it. [`Clone`] panics in that case. The copy of a poisoned data is
    /// poisoned.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    #[doc(alias = "mj_copyData")]
    pub fn try_clone(&self) -> Result<Self> {
        let mut copy = ptr::null_mut();
        self.call("mj_copyData", |m, _| {
            // SAFETY: with NULL as its destination the engine allocates a new data; the source is valid and made for the model.
            self.with_unused_stack(|source| unsafe { guard::mj_copy_data(ptr::null_mut(), m, source, &raw mut copy) })
        })?;
        // SAFETY: made for this model, and ours alone.
        let mut copy = unsafe { Self::from_raw(copy, self.model.clone()) }?;
        copy.computed = self.computed;
        copy.failure.clone_from(&self.failure);
        warning::lower_copied(copy.raw_mut());
        Ok(copy)
    }

    /// Copies everything from another simulation, without allocating. The models must have the same structure; this
    /// simulation keeps its own. It is poisoned afterwards exactly if the other one is.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if the other simulation is of a model that was loaded separately. [`Error::Engine`] if the engine
    /// fails. It fails for no two models of the same structure.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        if !self.model.is_same_structure(&other.model) {
            return Err(Error::OtherModel { what: "the data to copy from" });
        }
        let mut copied = ptr::null_mut();
        self.call_mut("mj_copyData", |m, d| {
            // SAFETY: two data of models with the same structure, so of the same sizes.
            other.with_unused_stack(|source| unsafe { guard::mj_copy_data(d, m, source, &raw mut copied) })
        })?;
        // What was computed under other options is laid out otherwise.
        self.computed = if Arc::ptr_eq(&self.model, &other.model) { other.computed } else { Computed::empty() };
        self.failure.clone_from(&other.failure);
        warning::lower_copied(self.raw_mut());
        Ok(())
    }

    /// This data as the engine copies it. What is on its stack in the middle of a step is of no use to a copy, and the engine
    /// refuses to copy it: after it has allocated the copy, which then is lost.
    fn with_unused_stack<R>(&self, copy: impl FnOnce(*const mjData) -> R) -> R {
        if self.raw().pstack == 0 {
            return copy(self.as_ptr());
        }
        copy(&raw const *Box::new(mjData { pstack: 0, ..*self.raw() }))
    }

    /// Sets the simulated time, s.
    #[inline]
    pub fn set_time(&mut self, time: f64) {
        self.raw_mut().time = time;
    }

    /// Potential and kinetic energy, J. [`forward`](Self::forward), [`step`](Self::step) and [`inverse`](Self::inverse) compute them
    /// while [`EnableFlags::ENERGY`](crate::EnableFlags::ENERGY) is set. Without the flag they are zero after a reset, but a program
    /// that clears the flag later reads old numbers.
    pub fn energy(&self) -> [f64; 2] {
        self.raw().energy
    }

    /// Returns how far the present quantities have been computed.
    #[inline]
    pub fn stage(&self) -> Stage {
        self.computed.stage()
    }

    /// Returns an error unless these results have been computed for the present model: a [`Stage`], or one of the constants of
    /// [`Needs`].
    ///
    /// Plain arrays such as [`xpos`](Self::xpos) and [`sensordata`](Self::sensordata) are slices of the engine's memory and check
    /// nothing. Before the first [`forward`](Self::forward) they are zero, and after a change of the model they hold old numbers. Call
    /// this before a loop that reads them, or in it: the cost is a comparison of two integers.
    ///
    /// Results count as computed until a reset, a change of the model, or a new computation of the quantities that they depend on.
    /// After [`step`](Self::step) they belong to the state before the step. Numbers that a program writes, such as
    /// [`qpos_mut`](Self::qpos_mut), are not tracked: call `forward` after them.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] with the call that computes the results, [`Error::Poisoned`] after an engine error.
    ///
    /// ```
    /// use mujoco_safe::{Data, Error, Needs, Stage, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// assert!(matches!(data.require(Stage::Position), Err(Error::NotComputed { .. })));
    /// data.step()?;
    /// data.require(Stage::Acceleration)?;
    /// data.require(Needs::SENSORS)?;
    /// // A step does not compute the forces on bodies.
    /// assert!(data.require(Needs::BODY_FORCES).is_err());
    /// data.rne_post_constraint()?;
    /// data.require(Needs::BODY_FORCES)?;
    /// println!("{:?}", data.cfrc_ext());
    /// # Ok::<(), Error>(())
    /// ```
    #[inline]
    pub fn require(&self, needs: impl Into<Needs>) -> Result<()> {
        self.check_usable()?;
        match needs.into().missing(self.computed) {
            None => Ok(()),
            Some(needs) => Err(Error::NotComputed { call: "Data::require", needs }),
        }
    }

    /// Notes how far the engine has come, for a closure that it calls in the middle of its work.
    pub(crate) fn is_at(&mut self, computed: Computed) {
        self.computed = computed;
    }

    /// The engine's structure, for calls past this crate.
    #[inline]
    pub fn as_ptr(&self) -> *const mjData {
        self.raw.as_ptr()
    }

    /// The engine's structure, for calls past this crate. Those must leave it as an engine call would: its sizes, addresses
    /// and pointers are trusted.
    #[inline]
    pub fn as_mut_ptr(&mut self) -> *mut mjData {
        self.raw.as_ptr()
    }

    #[inline]
    pub(crate) fn raw(&self) -> &mjData {
        // SAFETY: valid until `self` is dropped, and only written to through `&mut self`.
        unsafe { self.raw.as_ref() }
    }

    #[inline]
    pub(crate) fn raw_mut(&mut self) -> &mut mjData {
        // SAFETY: valid until `self` is dropped, and borrowed exclusively.
        unsafe { self.raw.as_mut() }
    }

    /// Refuses a data that an earlier error has left half computed.
    #[inline]
    pub(crate) fn check_usable(&self) -> Result<()> {
        match &self.failure {
            None => Ok(()),
            Some(failure) => Err(Error::Poisoned { failure: failure.to_string() }),
        }
    }

    /// Rejects a call that needs a stage that has not been computed.
    #[inline]
    pub(crate) fn check_computed(&self, call: &'static str, needs: Stage) -> Result<()> {
        self.check_usable()?;
        if self.computed.contains(needs.into()) {
            Ok(())
        } else {
            Err(Error::NotComputed { call, needs: needs.into() })
        }
    }
}

impl Clone for Data {
    /// # Panics
    ///
    /// If there is no memory; see [`try_clone`](Self::try_clone).
    fn clone(&self) -> Self {
        self.try_clone().unwrap_or_else(|error| panic!("cannot clone a data: {error}"))
    }

    /// Reuses the memory where the models have the same structure.
    fn clone_from(&mut self, source: &Self) {
        if self.copy_from(source).is_ok() {
            self.model = source.model.clone();
            self.computed = source.computed;
        } else {
            *self = source.clone();
        }
    }
}

impl Drop for Data {
    fn drop(&mut self) {
        // SAFETY: ours, and nobody else holds the pointer. The function only frees memory and cannot raise an error.
        unsafe { sys::mj_deleteData(self.raw.as_ptr()) }
    }
}

impl fmt::Debug for Data {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Data: time {} s, {} contacts, {} constraints, of {:?}",
            self.time(),
            self.ncon(),
            self.nefc(),
            self.model
        )?;
        match &self.failure {
            Some(failure) => write!(f, "; unusable since {failure}"),
            None => Ok(()),
        }
    }
}
