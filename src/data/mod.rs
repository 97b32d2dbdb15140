//! Simulations: the state, the inputs, and all quantities that are computed from them.
//!
//! [`Data`] is a simulation. The other types are arguments and results of its methods. The page
//! [`pipeline`] lists the calls for single parts of a step; the [guide](crate::guide::concepts)
//! explains which quantities are valid after which call.

// The page of `Data` in the documentation has the methods in the order of the modules.
mod create;

mod step;

mod reset;
mod results;
mod state;

mod active_callbacks;
mod adopt;
mod call;
mod collision;
mod constraint;
mod diagnostics;
mod history;
pub(crate) mod length_range;
pub mod pipeline;
mod rigid_body;
mod sleep;
mod warning;
mod weld;

use std::fmt;
use std::ptr::NonNull;
use std::sync::Arc;

use mujoco_sys::{self as sys, mjData};

use self::active_callbacks::ActiveCallbacks;
pub(crate) use self::active_callbacks::{EngineCallbacks, OwnCallbacks};
pub use self::collision::{ContactForce, ContactSide, FlexHit, FlexRayOptions, GeomDistance, RayHit, RayOptions};
pub use self::diagnostics::{SolverIteration, TimerCount};
// For the analytic linearisation, which is that of 2.2.2.
#[cfg_attr(engine_since = "2.3.0", allow(unused_imports))]
pub(crate) use self::collision::{CollisionFunction, FoundContact};
pub use self::rigid_body::{Jacobian, SpatialVector};
pub use self::warning::WarningCount;
pub(crate) use self::warning::{WarningCounters, silence as silence_warnings};
use crate::error::{Error, Result};
pub use crate::error::{Instability, UnstableField};
use crate::field_docs::field_docs;
use crate::macros::with_aliases;
use crate::model::Model;
pub use crate::stage::MissingResults;
pub(crate) use crate::stage::PipelineFlags;

with_aliases! {
    pub use self::constraint::{ConeHessian = "flg_coneHessian"};
    pub use self::collision::{
        Contact = "mjContact",
        NewContact = "mjContact",
    };
    pub use self::diagnostics::{Timer = "mjtTimer"};
    pub use self::history::{Interpolation = "interp"};
    pub use self::rigid_body::{
        Accelerations = "flg_acc",
        Axes = "flg_local",
        FrameId = "mjtObj",
    };
    pub use self::state::{StateSpec = "mjtState"};
    pub use self::warning::{Warning = "mjtWarning"};
    pub use crate::engine::{enable_timers = "mjcb_time"};
    pub use crate::stage::{
        SensorUpdate = "skipsensor",
        Stage = "mjtStage",
    };
}

/// Simulation: its state, its inputs, and the quantities that are computed from them. It holds its
/// model in an [`Arc`], so the model lives as long as the simulation, and any number of simulations
/// share one model.
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
/// If the engine raises an error during a call, the call returns [`Error::Engine`]. (In C, the
/// engine prints a message, waits for a key and ends the process.) The effect on the data depends
/// on the receiver of the call:
///
/// - After a call with `&mut Data`, such as [`step`](Self::step), [`rne_into`](Self::rne_into) or
///   [`Scene::update`](crate::Scene::update), the data may be half computed. It is poisoned: every
///   call that computes from it returns [`Error::Poisoned`] until a [`reset`](Self::reset). The
///   arrays can still be read. The `# Errors` sections mention this error only for calls that can
///   cause it.
/// - A call with `&Data`, such as [`ray`](Self::ray) or [`Scene::select`](crate::Scene::select),
///   only reads. The data is unchanged and usable.
///
/// # Uses that the compiler rejects
///
/// <details><summary>Borrows that would outlive the simulation, changes of a shared model, and concurrent steps</summary>
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
/// The model of a simulation is shared, and can only be changed through
/// [`edit_model`](Self::edit_model):
///
/// ```compile_fail,E0596
/// # use mujoco_safe::{Data, sample};
/// let data = Data::new(sample::humanoid()).unwrap();
/// let mut model = data.model().clone();
/// model.edit(); // cannot borrow data in an `Arc` as mutable
/// ```
///
/// Any number of threads may read a simulation, or one thread may step it, but not both at the same
/// time:
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
///
/// </details>
#[doc(alias = "mjData")]
#[doc(alias = "mj_deleteData")]
pub struct Data {
    raw: NonNull<mjData>,
    model: Arc<Model>,
    /// Valid results for the present model.
    computed: PipelineFlags,
    /// Text of the error that poisoned the data.
    failure: Option<Box<str>>,
    callbacks: ActiveCallbacks,
}

// SAFETY: the engine's data has no thread affinity, and this is its only owner.
unsafe impl Send for Data {}
// SAFETY: all methods with `&Data` read fields, or call an engine function that takes
// `const mjData*`: mj_jac, mj_jacBody, mj_jacBodyCom, mj_jacGeom, mj_jacSite, mj_mulM,
// mj_contactForce, mj_objectVelocity, mj_objectAcceleration, mj_ray, mj_rayMesh, mj_rayHfield,
// mj_copyData (its source), or a function whose `mjData*` is not const but which only reads it:
// mj_mulJacVec, mj_mulJacTVec, mj_local2Global. These functions write only to their output
// arguments.
unsafe impl Sync for Data {}

/// # Raw access
impl Data {
    /// Returns a pointer to the engine's struct, for direct calls of the engine.
    #[inline]
    pub fn as_ptr(&self) -> *const mjData {
        self.raw.as_ptr()
    }

    /// Returns a mutable pointer to the engine's struct, for direct calls of the engine. These must
    /// leave the struct in a state in which an engine call could leave it, because this crate
    /// trusts its sizes, addresses and pointers.
    #[inline]
    pub fn as_mut_ptr(&mut self) -> *mut mjData {
        self.raw.as_ptr()
    }

    /// Returns the record of valid results.
    pub(crate) fn computed(&self) -> PipelineFlags {
        self.computed
    }

    /// Replaces the record of valid results.
    pub(crate) fn set_computed(&mut self, computed: PipelineFlags) {
        self.computed = computed;
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
        // SAFETY: `self` is the only owner. The function only frees memory and cannot raise an
        // error.
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

field_docs!(data::Data, "Data", "xpos", "Cartesian position of body frame (nbody x 3)");
