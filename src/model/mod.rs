//! What is simulated: bodies, joints, geoms and the rest, compiled and constant while it runs.
//!
//! | file | what is in it |
//! |---|---|
//! | `load.rs` | from a path, a text, a text with files in memory, a binary model |
//! | `text_check.rs` | what the engine's compiler must not see in a text |
//! | `load_options.rs` | files in memory and directories of packages |
//! | `package.rs` | `package://` URIs of meshes |
//! | `virtual_files.rs` | the engine's virtual file system, for loading from memory |
//! | `names.rs` | names to ids and back |
//! | `options/` | options of the physics, settings of the visualiser, statistics: typed and checked |
//! | `edit.rs` | what may be changed after compilation |
//! | `length_range.rs` | the length ranges of actuators, by simulation |
//! | `position.rs` | differences and sums of positions, where a quaternion is not three numbers |
//! | `hazard.rs` | what the engine compiles and then mishandles |
//! | `shortcut.rs` | what the engine leaves out because the compiler said so |
//! | `save.rs` | to a binary model |
//! | `save_xml/` | to XML, with a check that the text loads as the same model |
//! | `schema.rs` | what a model text may have in it |
//! | `mjb/` | the validation of binary models |

mod edit;
mod hazard;
mod length_range;
mod load;
mod load_options;
mod mjb;
mod names;
mod options;
mod package;
mod position;
mod save;
mod save_xml;
mod schema;
mod shortcut;
mod text_check;
mod virtual_files;

use std::fmt;
use std::ptr::{self, NonNull};

use mujoco_sys::{self as sys, guard, mjModel};

pub use self::edit::ModelMut;
pub use self::length_range::{LengthRangeMode, LengthRangeOptions};
pub use self::load_options::LoadOptions;
pub use self::options::{
    DisableFlags, EnableFlags, Options, Statistics, Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality,
    VisualRgba, VisualScale,
};
pub use self::save_xml::{LostEdit, SaveXmlOptions, XmlCheck};
pub use self::schema::{schema, schema_html};
use crate::error::Result;
use crate::ffi;
use crate::id::Lineage;

/// A compiled model. Constant once it is shared: a [`Data`](crate::Data) holds it in an [`Arc`](std::sync::Arc), and any
/// number of threads may use it at once. Before that it is changed through [`edit`](Model::edit), and afterwards through
/// [`Data::edit_model`](crate::Data::edit_model).
///
/// ```
/// use mujoco_safe::Model;
///
/// let model = Model::from_xml_str(
///     r#"<mujoco>
///          <worldbody>
///            <body name="ball" pos="0 0 1"><freejoint/><geom size="0.1"/></body>
///          </worldbody>
///        </mujoco>"#,
/// )?;
/// assert_eq!((model.nq(), model.nv()), (7, 6));
/// assert_eq!(format!("{model:?}"), "Model: 2 bodies, 1 joint, 1 geom (nq 7, nv 6, nu 0)");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mjModel")]
pub struct Model {
    raw: NonNull<mjModel>,
    lineage: Lineage,
    warnings: Vec<String>,
    /// See [`has_adhesion`](Model::has_adhesion).
    adhesive: bool,
    /// See [`has_ranged_fields`](Model::has_ranged_fields).
    ranged_fields: bool,
}

// SAFETY: the engine's promise is that "all top-level API functions treat mjModel as const", and its structures have no thread
// affinity. This crate writes to a model only through `&mut Model`.
unsafe impl Send for Model {}
// SAFETY: as above: `&Model` only ever reads.
unsafe impl Sync for Model {}

impl Model {
    /// Takes ownership of a model of the engine's.
    ///
    /// # Safety
    ///
    /// `raw` is a model of this engine that nobody else owns, and that the engine compiled or this crate validated.
    unsafe fn from_raw(raw: NonNull<mjModel>, lineage: Lineage, warnings: Vec<String>) -> Self {
        let mut model = Self { raw, lineage, warnings, adhesive: false, ranged_fields: false };
        model.adhesive = model.find_adhesion();
        model.ranged_fields = model.find_ranged_fields();
        model.edit().forget_wrong_simple_bodies();
        model
    }

    /// A copy, or an error if there is no memory for it. [`Clone`] panics in that case.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`](crate::Error::Engine) if the engine cannot allocate it.
    #[doc(alias = "mj_copyModel")]
    pub fn try_clone(&self) -> Result<Self> {
        let mut copy = ptr::null_mut();
        // SAFETY: with NULL as its destination the engine allocates a new model; `self` is a valid source.
        ffi::check_without_data("mj_copyModel", unsafe {
            guard::mj_copy_model(ptr::null_mut(), self.as_ptr(), &raw mut copy)
        })?;
        let raw = NonNull::new(copy).ok_or(crate::Error::OutOfMemory { function: "mj_copyModel" })?;
        // SAFETY: a copy of a valid model, and ours alone.
        Ok(unsafe { Self::from_raw(raw, self.lineage, self.warnings.clone()) })
    }

    /// What the engine's compiler warned about when the model was loaded.
    pub fn compile_warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The engine's structure, for calls past this crate.
    #[inline]
    pub fn as_ptr(&self) -> *const mjModel {
        self.raw.as_ptr()
    }

    /// For changing the model, as long as it is not shared.
    ///
    /// ```
    /// use mujoco_safe::{Integrator, sample};
    ///
    /// let mut model = sample::cartpole();
    /// model.edit().options(|options| {
    ///     options.timestep = 0.002;
    ///     options.integrator = Integrator::Rk4;
    /// })?;
    /// model.edit().body_mass_mut()[1] = 2.0;
    /// assert_eq!(model.timestep(), 0.002);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn edit(&mut self) -> ModelMut<'_> {
        ModelMut::new(self)
    }

    /// Whether ids and data of the one fit the other: the same model, or a clone of it.
    pub fn is_same_structure(&self, other: &Self) -> bool {
        self.lineage == other.lineage
    }

    #[inline]
    pub(crate) fn lineage(&self) -> Lineage {
        self.lineage
    }

    /// The engine's structure.
    #[inline]
    pub(crate) fn raw(&self) -> &mjModel {
        // SAFETY: valid until `self` is dropped, and only written to through `&mut self`.
        unsafe { self.raw.as_ref() }
    }

    #[inline]
    pub(crate) fn raw_mut(&mut self) -> &mut mjModel {
        // SAFETY: valid until `self` is dropped, and borrowed exclusively.
        unsafe { self.raw.as_mut() }
    }
}

impl Clone for Model {
    /// # Panics
    ///
    /// If there is no memory; see [`try_clone`](Self::try_clone).
    fn clone(&self) -> Self {
        self.try_clone().unwrap_or_else(|error| panic!("cannot clone a model: {error}"))
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        // SAFETY: ours, and nobody else holds the pointer. The function only frees memory and cannot raise an error.
        unsafe { sys::mj_deleteModel(self.raw.as_ptr()) }
    }
}

impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |number: usize, one: &str, many: &str| format!("{number} {}", if number == 1 { one } else { many });
        write!(
            f,
            "Model: {}, {}, {}",
            count(self.nbody(), "body", "bodies"),
            count(self.njnt(), "joint", "joints"),
            count(self.ngeom(), "geom", "geoms")
        )?;
        for (number, one, many) in [
            (self.nu(), "actuator", "actuators"),
            (self.nsensor(), "sensor", "sensors"),
            (self.ntendon(), "tendon", "tendons"),
            (self.nkey(), "keyframe", "keyframes"),
        ] {
            if number > 0 {
                write!(f, ", {}", count(number, one, many))?;
            }
        }
        write!(f, " (nq {}, nv {}, nu {})", self.nq(), self.nv(), self.nu())
    }
}
