//! Simulations: the state, the inputs, and all quantities that are computed from them.
//!
//! [`Data`] is a simulation. The other types are arguments and results of its methods. The page [`pipeline`] lists the calls for single parts
//! of a step; the [guide](crate::guide::concepts) explains which quantities are valid after which call.

mod call;
mod constraint;
mod contact;
mod diagnostics;
mod distance;
mod frame;
mod inertia;
mod jacobian;
pub(crate) mod length_range;
pub mod pipeline;
mod ray;
mod reset;
mod state;
mod step;
mod warning;

use std::fmt;
use std::ptr::{self, NonNull};
use std::sync::Arc;

use mujoco_sys::{self as sys, guard, mjData};

use self::call::CallbackSlot;
pub(crate) use self::call::EngineCallbacks;
pub use self::constraint::ConeHessian;
pub use self::contact::{Contact, ContactForce, NewContact};
pub use self::diagnostics::{SolverIteration, Timer, TimerCount};
pub use self::distance::GeomDistance;
pub use self::frame::{Axes, FrameId, SpatialVector};
pub use self::inertia::Accelerations;
pub use self::jacobian::Jacobian;
pub use self::ray::{RayHit, RayOptions};
pub use self::state::StateSpec;
pub(crate) use self::warning::silence as silence_warnings;
pub use self::warning::{Warning, WarningCount};
pub use crate::engine::enable_timers;
use crate::error::{Error, Outcome, Result};
pub use crate::error::{Instability, UnstableField};
use crate::ffi;
use crate::field_docs::field_docs;
use crate::model::{IntoModel, Model, ModelMut};
pub(crate) use crate::stage::PipelineFlags;
pub use crate::stage::{MissingResults, SensorUpdate, Stage};

/// Simulation: its state, its inputs, and the quantities that are computed from them. It holds its model in an [`Arc`], so the
/// model lives as long as the simulation, and any number of simulations share one model.
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
/// If the engine raises an error during a call, the call returns [`Error::Engine`]. (In C, the engine prints a message, waits for
/// a key and ends the process.) The effect on the data depends on the receiver of the call:
///
/// - After a call with `&mut Data`, such as [`step`](Self::step), [`rne_into`](Self::rne_into) or
///   [`Scene::update`](crate::Scene::update), the data may be half computed. It is poisoned: every call that computes
///   from it returns [`Error::Poisoned`] until a [`reset`](Self::reset). The arrays can still be read. The `# Errors` sections
///   mention this error only for calls that can cause it.
/// - A call with `&Data`, such as [`ray`](Self::ray) or [`Scene::select`](crate::Scene::select), only reads. The data is
///   unchanged and usable.
///
/// # Uses that the compiler rejects
///
/// A view, a slice or a contact borrows the simulation, so it cannot outlive the simulation:
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
/// A step cannot change the arrays while such a borrow exists:
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
/// The model of a simulation is shared, and can only be changed through [`edit_model`](Self::edit_model):
///
/// ```compile_fail,E0596
/// # use mujoco_safe::{Data, sample};
/// let data = Data::new(sample::humanoid()).unwrap();
/// let mut model = data.model().clone();
/// model.edit(); // cannot borrow data in an `Arc` as mutable
/// ```
///
/// Any number of threads may read a simulation, or one thread may step it, but not both at the same time:
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
    /// Valid results for the present model.
    computed: PipelineFlags,
    /// Text of the error that poisoned the data.
    failure: Option<Box<str>>,
    /// Callbacks of the innermost [`with_callbacks`](Self::with_callbacks).
    pub(crate) callbacks: Option<Arc<CallbackSlot>>,
}

// SAFETY: the engine's data has no thread affinity, and this is its only owner.
unsafe impl Send for Data {}
// SAFETY: all methods with `&Data` read fields, or call an engine function that takes `const mjData*`: mj_jac, mj_jacBody,
// mj_jacBodyCom, mj_jacGeom, mj_jacSite, mj_mulM, mj_contactForce, mj_objectVelocity, mj_objectAcceleration, mj_ray,
// mj_rayMesh, mj_rayHfield, mj_copyData (its source), or a function whose `mjData*` is not const but which only reads it:
// mj_mulJacVec, mj_mulJacTVec, mj_local2Global. These functions write only to their output arguments.
unsafe impl Sync for Data {}

impl Data {
    /// Creates a simulation of a [`Model`], an `Arc<Model>` or an `&Arc<Model>`, in the reference position and at rest.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate it.
    #[doc(alias = "mj_makeData")]
    #[doc(alias = "init_data")]
    pub fn new(model: impl IntoModel) -> Result<Self> {
        let model = model.into_model();
        let mut made = ptr::null_mut();
        // SAFETY: a valid model, and a valid pointer for the result.
        ffi::check_without_data("mj_makeData", unsafe { guard::mj_make_data(model.as_ptr(), &raw mut made) })?;
        // SAFETY: the engine made it for this model.
        unsafe { Self::from_raw(made, model) }
    }

    /// # Safety
    ///
    /// `raw` is NULL, or a data that the engine made for a model of the same structure as `model` and that has no other owner.
    unsafe fn from_raw(raw: *mut mjData, model: Arc<Model>) -> Result<Self> {
        let raw = NonNull::new(raw).ok_or(Error::OutOfMemory { function: "mj_makeData" })?;
        Ok(Self { raw, model, computed: PipelineFlags::empty(), failure: None, callbacks: None })
    }

    /// Returns the model.
    #[inline]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Changes the model of this simulation. A shared model is copied first, so that other simulations keep theirs unchanged.
    ///
    /// All results were computed for the old model, so they count as not computed afterwards.
    ///
    /// The closure returns nothing or a [`Result`], as for [`Rollout::edit_model`](crate::Rollout::edit_model); the call returns the
    /// value in its `Ok`.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the copy of the model cannot be allocated. The model is unchanged then, and
    /// the data is not poisoned. The error of the closure, if it returns one. Its changes before the error remain.
    ///
    /// ```
    /// use mujoco_safe::enums::Cone;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.edit_model(|model| model.options(|options| options.cone = Cone::Elliptic))?;
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
    pub fn edit_model<O: Outcome>(&mut self, edit: impl FnOnce(&mut ModelMut<'_>) -> O) -> Result<O::Value> {
        if Arc::get_mut(&mut self.model).is_none() {
            self.model = Arc::new(self.model.try_clone()?);
        }
        let model = Arc::get_mut(&mut self.model).expect("Bug: a fresh copy of a model is shared");
        self.computed = PipelineFlags::empty();
        edit(&mut model.edit()).into_result()
    }

    /// Sets the simulated time, s.
    #[inline]
    pub fn set_time(&mut self, time: f64) {
        self.raw_mut().time = time;
    }

    /// Returns the potential and kinetic energy, J. [`forward`](Self::forward), [`step`](Self::step) and
    /// [`inverse`](Self::inverse) compute them while [`EnableFlags::ENERGY`](crate::model::EnableFlags::ENERGY) is set. Without the flag
    /// they are zero after a reset. If the flag is cleared later, the values are stale.
    pub fn energy(&self) -> [f64; 2] {
        self.raw().energy
    }

    /// Returns the last stage whose results are all valid.
    #[inline]
    pub fn stage(&self) -> Stage {
        self.computed.stage()
    }

    /// Returns an error unless these results have been computed for the present model: those of a [`Stage`], or of a constant of
    /// [`MissingResults`].
    ///
    /// The getters of plain arrays such as [`xpos`](Self::xpos) and [`sensordata`](Self::sensordata) return slices of the
    /// engine's memory without a check. Before the first [`forward`](Self::forward) these arrays are zero, and after a change of
    /// the model they hold stale values. Call this method before a loop that reads them, or inside: it costs a comparison of two
    /// integers.
    ///
    /// Results count as computed until a reset, a change of the model, or a new computation of the quantities that they depend
    /// on. After [`step`](Self::step) they belong to the state before the step. Writes to the arrays, for example through
    /// [`qpos_mut`](Self::qpos_mut), are not tracked: call `forward` after them.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] with the call that computes the results, [`Error::Poisoned`] after an engine error.
    ///
    /// ```
    /// use mujoco_safe::data::MissingResults;
    /// use mujoco_safe::{Data, Error, Stage, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// assert!(matches!(data.require(Stage::Position), Err(Error::NotComputed { .. })));
    /// data.step()?;
    /// data.require(Stage::Acceleration)?;
    /// data.require(MissingResults::SENSORS)?;
    /// // A step does not compute the forces on bodies.
    /// assert!(data.require(MissingResults::BODY_FORCES).is_err());
    /// data.rne_post_constraint()?;
    /// data.require(MissingResults::BODY_FORCES)?;
    /// println!("{:?}", data.cfrc_ext());
    /// # Ok::<(), Error>(())
    /// ```
    #[inline]
    pub fn require(&self, needs: impl Into<MissingResults>) -> Result<()> {
        self.check_usable()?;
        match needs.into().not_in(self.computed) {
            None => Ok(()),
            Some(missing) => Err(Error::NotComputed { call: "Data::require", missing }),
        }
    }

    /// Replaces the record of valid results.
    pub(crate) fn set_computed(&mut self, computed: PipelineFlags) {
        self.computed = computed;
    }

    /// Returns a pointer to the engine's struct, for direct calls of the engine.
    #[inline]
    pub fn as_ptr(&self) -> *const mjData {
        self.raw.as_ptr()
    }

    /// Returns a mutable pointer to the engine's struct, for direct calls of the engine. These must leave the struct in a state in
    /// which an engine call could leave it, because this crate trusts its sizes, addresses and pointers.
    #[inline]
    pub fn as_mut_ptr(&mut self) -> *mut mjData {
        self.raw.as_ptr()
    }

    #[inline]
    pub(crate) fn raw(&self) -> &mjData {
        // SAFETY: valid until `self` is dropped, and written only through `&mut self`.
        unsafe { self.raw.as_ref() }
    }

    #[inline]
    pub(crate) fn raw_mut(&mut self) -> &mut mjData {
        // SAFETY: valid until `self` is dropped, and borrowed exclusively.
        unsafe { self.raw.as_mut() }
    }

    /// Returns an error if an earlier error has poisoned the data.
    #[inline]
    pub(crate) fn check_usable(&self) -> Result<()> {
        match &self.failure {
            None => Ok(()),
            Some(failure) => Err(Error::Poisoned { failure: failure.to_string() }),
        }
    }

    /// Returns an error if a stage that `call` needs has not been computed.
    #[inline]
    pub(crate) fn check_computed(&self, call: &'static str, needs: Stage) -> Result<()> {
        self.check_usable()?;
        if self.computed.contains(needs.into()) {
            Ok(())
        } else {
            Err(Error::NotComputed { call, missing: needs.into() })
        }
    }
}

impl Drop for Data {
    fn drop(&mut self) {
        // SAFETY: `self` is the only owner. The function only frees memory and cannot raise an error.
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

field_docs!(data::Data, "Data", "xpos", "Cartesian position of body frame (nbody x 3)", 118);
