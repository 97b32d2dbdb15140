//! The model of a simulated system: bodies, joints, geoms and other elements, compiled from MJCF or
//! URDF and constant during the simulation.
//!
//! A [`Model`] is loaded from XML or from the binary format, and can be saved in both. Before the
//! engine reads such input, this module rejects all inputs that are known to crash it. [`ModelMut`]
//! is the checked interface for changes after compilation.

// The page of `Model` in the documentation has the methods in the order of the modules.
mod load;

mod names;

mod difference;
mod edit;
mod options;

mod addressing;
mod adoption;
mod bounds;
mod cached_flags;
#[cfg(engine_since = "2.3.0")]
mod engine_features;
mod engine_limits;
mod identity;
#[cfg(validates_binaries)]
mod mjb;
mod number;
mod parts;
mod pipeline_features;
mod position;
mod relation;
pub(crate) mod save;
mod schema;
mod shared;
mod survivors;
#[cfg(any(feature = "renderer", feature = "html", feature = "gltf"))]
mod texture;
mod xml_guard;

use std::fmt;
use std::ptr::{self, NonNull};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use mujoco_sys::{self as sys, guard, mjModel};

pub(crate) use self::addressing::CheckedEdit;
pub use self::adoption::{Adoption, ChangedElement};
pub(crate) use self::difference::{EditedModel, ModelDifference};
pub use self::edit::ModelMut;
pub(crate) use self::identity::{IDENTIFIED, Identities, Identity};
pub use self::load::LoadOptions;
pub(crate) use self::load::TEXT;
pub(crate) use self::number::NumberArray;
pub(crate) use self::options::FIRST_ABSENT_FLAG;
#[cfg(feature = "viewer")]
pub(crate) use self::options::SettingMut;
pub use self::options::{VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba, VisualScale};
pub(crate) use self::parts::kept_parts;
pub(crate) use self::relation::Relation;
pub use self::save::{SaveXmlOptions, XmlCheck};
pub(crate) use self::schema::Schema;
pub use self::shared::IntoModel;
pub(crate) use self::survivors::Survivors;
#[cfg(any(feature = "renderer", feature = "html", feature = "gltf"))]
pub(crate) use self::texture::TexturePixels;
use crate::error::Result;
pub use crate::error::UnsavedField;
use crate::ffi;
pub use crate::field_docs::FieldDoc;
use crate::field_docs::field_docs;
use crate::id::Lineage;
use crate::kind::Kind;
use crate::macros::with_aliases;
use crate::stage::PipelineFeatures;

with_aliases! {
    pub use self::options::{
        DisableFlags = "mjtDisableBit",
        EnableFlags = "mjtEnableBit",
        Options = "mjOption",
        Statistics = "mjStatistic",
        Visual = "mjVisual" "mj_defaultVisual",
    };
    pub use self::schema::{
        schema = "mj_printSchema",
        schema_html = "mj_printSchema",
    };
    pub use crate::data::length_range::{
        LengthRangeMode = "mjtLRMode",
        LengthRangeOptions = "mjLROpt" "mj_defaultLROpt",
    };
}

/// A compiled model.
///
/// A model is constant once it is shared: a [`Data`](crate::Data) holds it in an
/// [`Arc`], and any number of threads may use it concurrently.
/// [`edit`](Model::edit) changes a model before it is shared, and
/// [`Data::edit_model`](crate::Data::edit_model) afterwards.
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
/// assert_eq!(model.to_string(), "2 bodies, 1 joint, 1 geom (nq 7, nv 6, nu 0)");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mjModel")]
#[doc(alias = "mj_copyModel")]
#[doc(alias = "mj_deleteModel")]
pub struct Model {
    raw: NonNull<mjModel>,
    lineage: Lineage,
    warnings: Vec<String>,
    /// Elements of the spec from which the model was compiled.
    identities: Option<Arc<Identities>>,
    /// See [`features`](Model::features), without the integrator.
    features: PipelineFeatures,
    /// See [`has_rangefinder_and_height_field`](Model::has_rangefinder_and_height_field).
    has_rangefinder_and_height_field: bool,
    /// `true` for a binary model in which a polygon of a mesh may not be convex and has more than 8
    /// vertices (`find_unsafe_polygons`).
    has_unsafe_polygons: bool,
    /// `true` if the engine computes addresses from writable values
    /// ([`check_addresses`](Model::check_addresses)).
    has_addresses: bool,
    /// `true` if bounds for collision detection are larger than necessary because an edit could
    /// have changed them (`loosen_bounds`).
    has_loose_bounds: bool,
    /// Number that no other model has, and that changes with every edit ([`Model::revision`]).
    revision: u64,
    /// Size `nJmom` of the compiled model ([`reserve_moments`](Model::reserve_moments)).
    #[cfg(engine_since = "3.6.0")]
    compiled_moments: i64,
}

// SAFETY: the engine promises that "all top-level API functions treat mjModel as const", and its
// structures have no thread affinity. This crate writes to a model only through `&mut Model`.
unsafe impl Send for Model {}
// SAFETY: as above: `&Model` only reads.
unsafe impl Sync for Model {}

/// # Copies, comparison and raw access
impl Model {
    /// Takes ownership of a model of the engine.
    ///
    /// # Safety
    ///
    /// `raw` is a model of this engine that nothing else owns, and that the engine compiled or this
    /// crate validated.
    unsafe fn from_raw(raw: NonNull<mjModel>, lineage: Lineage, warnings: Vec<String>) -> Self {
        let mut model = Self {
            raw,
            lineage,
            warnings,
            identities: None,
            features: PipelineFeatures::empty(),
            has_rangefinder_and_height_field: false,
            has_unsafe_polygons: false,
            has_addresses: false,
            has_loose_bounds: false,
            revision: 0,
            #[cfg(engine_since = "3.6.0")]
            compiled_moments: 0,
        };
        model.features = model.find_features();
        model.has_rangefinder_and_height_field = model.find_rangefinder_and_height_field();
        model.has_addresses = model.find_addresses();
        #[cfg(engine_since = "3.6.0")]
        model.reserve_moments();
        model.edit().clear_wrong_simple_bodies();
        model.disable_unsafe_islands();
        model.edit().avoid_wrong_jacobian();
        #[cfg(engine_since = "2.3.3")]
        model.disable_unsafe_midphase();
        model
    }

    /// Returns a copy, or an error if memory is exhausted. [`Clone`] panics in that case.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`](crate::Error::Engine) if the engine cannot allocate it.
    #[doc(alias = "mj_copyModel")]
    pub fn try_clone(&self) -> Result<Self> {
        let mut copy = ptr::null_mut();
        // SAFETY: if the destination is NULL, the engine allocates a new model; `self` is a valid
        // source.
        ffi::check_without_data("mj_copyModel", unsafe {
            guard::mj_copy_model(ptr::null_mut(), self.as_ptr(), &raw mut copy)
        })?;
        let raw = NonNull::new(copy).ok_or(crate::error::Error::OutOfMemory { function: "mj_copyModel" })?;
        // SAFETY: a copy of a valid model, which nothing else owns.
        let mut copy = unsafe { Self::from_raw(raw, self.lineage, self.warnings.clone()) };
        copy.identities.clone_from(&self.identities);
        copy.has_unsafe_polygons = self.has_unsafe_polygons;
        copy.has_loose_bounds = self.has_loose_bounds;
        #[cfg(engine_since = "3.6.0")]
        {
            copy.compiled_moments = self.compiled_moments;
        }
        Ok(copy)
    }

    /// Returns the warnings that the engine's compiler raised when the model was loaded.
    pub fn compile_warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Returns a pointer to the engine's structure, for calls to functions that this crate does not
    /// wrap.
    #[inline]
    pub fn as_ptr(&self) -> *const mjModel {
        self.raw.as_ptr()
    }

    /// Returns `true` if ids and data of one model are valid for the other: they are the same
    /// model, or one is a clone of the other.
    pub fn is_same_structure(&self, other: &Self) -> bool {
        self.lineage == other.lineage
    }

    /// Returns a number that identifies the values of the model in this process: no other model has
    /// it, also no copy, and each edit changes it.
    #[inline]
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// Changes the [`revision`](Self::revision), because an edit begins.
    fn advance_revision(&mut self) {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        self.revision = NEXT.fetch_add(1, Ordering::Relaxed);
    }

    /// Sets the elements of the spec from which the model was compiled.
    pub(crate) fn set_identities(&mut self, identities: Identities) {
        self.identities = Some(Arc::new(identities));
    }

    /// Returns the number of the element of the spec from which an element was compiled.
    pub(crate) fn source_of(&self, kind: Kind, index: usize) -> Option<u32> {
        Some(self.identities.as_deref()?.get(kind, index)?.number)
    }

    #[inline]
    pub(crate) fn lineage(&self) -> Lineage {
        self.lineage
    }

    /// Returns the engine's structure.
    #[inline]
    pub(crate) fn raw(&self) -> &mjModel {
        // SAFETY: valid until `self` is dropped, and written to only through `&mut self`.
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
    /// If memory is exhausted; see [`try_clone`](Self::try_clone).
    fn clone(&self) -> Self {
        self.try_clone().unwrap_or_else(|error| panic!("cannot clone a model: {error}"))
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        // SAFETY: `self` owns the model, and nothing else holds the pointer. The function only
        // frees memory and cannot raise an error.
        unsafe { sys::mj_deleteModel(self.raw.as_ptr()) }
    }
}

/// Numbers of elements.
impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |number: usize, one: &str, many: &str| format!("{number} {}", if number == 1 { one } else { many });
        write!(
            f,
            "{}, {}, {}",
            count(self.nbody(), "body", "bodies"),
            count(self.njnt(), "joint", "joints"),
            count(self.ngeom(), "geom", "geoms")
        )?;
        for (number, one, many) in [
            (self.nactuator(), "actuator", "actuators"),
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

impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Model: {self}")
    }
}

field_docs!(model::Model, "Model", "nv", "number of degrees of freedom = dim(qvel)");
