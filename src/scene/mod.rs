//! Abstract visualisation: the geoms, lights, skins and cameras of a simulation as a list that a
//! renderer can draw.
//!
//! A [`Scene`] holds no graphics resources. The `render` module draws it; any other renderer can
//! read it through the accessors.
//!
//! ```
//! use mujoco_safe::element::Object;
//! use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions, VisualFlags};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.forward()?;
//! let mut scene = Scene::new(data.model(), 10_000)?;
//! let mut camera = Camera::free(data.model());
//! let mut options = SceneOptions::default();
//! options.flags |= VisualFlags::JOINT;
//! scene.update(&mut data, &options, None, &mut camera, Categories::all())?;
//!
//! for geom in scene.geoms() {
//!     // Draw geom.geom_type() with geom.size(), geom.pos(), geom.mat() and geom.rgba().
//!     if let Some(Object::Joint(joint)) = geom.object() {
//!         assert!(data.joint(joint).name().is_some());
//!     }
//! }
//! let viewpoint = scene.viewpoint();
//! assert!(viewpoint.frustum_near > 0.0 && viewpoint.frustum_far > viewpoint.frustum_near);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Models
//!
//! A scene belongs to the model that it was created for, to clones of that model and to every
//! [`Data`](crate::Data) created from them. Data of another model causes [`Error::OtherModel`]; an
//! id of another model causes a panic, as everywhere in this crate.
//!
//! # Quirks of the engine
//!
//! The engine centres an infinite plane near the viewpoints of the previous update: see
//! [`Scene::update_camera`]. The engine draws a string between two meaningless points for a limited
//! fixed tendon that couples two joints, has a lower limit of zero, and has neither stiffness nor
//! damping.

mod camera;
#[cfg(feature = "renderer")]
mod camera_source;
#[cfg(any(feature = "html", feature = "mcap", feature = "gltf"))]
#[cfg_attr(not(all(feature = "html", feature = "mcap", feature = "gltf")), allow(dead_code))] // each uses a part
mod deformable;
mod flex;
mod geom;
mod light;
mod needs;
mod new_geom;
mod options;
mod perturbation;
mod pinhole;
mod selection;
mod update;
mod viewpoint;

use std::alloc::{Layout, alloc_zeroed, dealloc};
use std::ffi::c_int;
use std::fmt;
use std::mem::MaybeUninit;
use std::ptr::{self, NonNull};

use mujoco_sys::{self as sys, guard, mjvGeom, mjvScene};

#[cfg(feature = "renderer")]
pub use self::camera_source::CameraSource;
#[cfg(any(feature = "html", feature = "mcap", feature = "gltf"))]
#[cfg_attr(not(feature = "gltf"), allow(unused_imports))] // the others have no name for it
pub(crate) use self::deformable::{Deformable, DeformableId};
pub use self::flex::SceneFlex;
use self::geom::MaterialTexture;
pub use self::geom::{SceneGeomMut, SceneSkin};
#[cfg(feature = "live")]
pub(crate) use self::needs::compute_poses;
pub use self::new_geom::{Connector, TextureRepeat};
pub use self::selection::Selection;
pub use self::viewpoint::{Head, Transform};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::Lineage;
use crate::macros::with_aliases;
use crate::model::Model;

with_aliases! {
    pub use self::camera::{
        Camera = "mjvCamera",
        CameraView = "mjtCamera",
        MouseAction = "mjtMouse",
    };
    pub use self::geom::{
        SceneGeom = "mjvGeom",
        SceneGeomType = "mjtGeom",
    };
    pub use self::light::{SceneLight = "mjvLight"};
    pub use self::new_geom::{NewGeom = "mjv_initGeom"};
    pub use self::options::{
        Categories = "mjtCatBit",
        FrameMode = "mjtFrame",
        LabelMode = "mjtLabel",
        RenderFlags = "mjtRndFlag",
        SceneOptions = "mjvOption",
        VisualFlags = "mjtVisFlag",
    };
    pub use self::perturbation::{
        MovableBodies = "flg_paused",
        Perturbation = "mjvPerturb",
        PerturbationFlags = "mjtPertBit",
    };
    pub use self::pinhole::{PinholeCamera = "intrinsics" "extrinsics"};
    pub use self::viewpoint::{
        Viewpoint = "mjvGLCamera",
        align_to_camera = "mjv_alignToCamera",
    };
}

/// Abstract scene with a fixed capacity of geoms. See the [module](self).
#[doc(alias = "mjvScene")]
#[doc(alias = "mjv_freeScene")]
pub struct Scene {
    raw: Box<mjvScene>,
    lineage: Lineage,
    /// Storage of `raw.geoms` and `raw.geomorder`.
    buffers: (Buffer<mjvGeom>, Buffer<c_int>),
    skin_vertices: usize,
    /// One entry per mesh: `true` if the compiler built its convex hull.
    has_convex_hull: Box<[bool]>,
    /// Textures of the model's materials at the last update.
    materials: Box<[MaterialTexture]>,
}

// SAFETY: the engine's structure is plain memory without thread affinity, and the scene owns all of
// it.
unsafe impl Send for Scene {}
// SAFETY: as above; only `&mut Scene` writes to it.
unsafe impl Sync for Scene {}

impl Scene {
    /// Creates an empty scene for a model, with capacity for `max_geoms` geoms. The operating
    /// system commits the memory on first use.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if `max_geoms` exceeds the range of a C `int`, [`Error::OutOfMemory`] or
    /// [`Error::Engine`] if memory is exhausted.
    ///
    /// ```
    /// use mujoco_safe::{Error, Scene, sample};
    ///
    /// let model = sample::humanoid();
    /// let scene = Scene::new(&model, 1000)?;
    /// assert_eq!((scene.ngeom(), scene.max_geoms()), (0, 1000));
    /// assert!(matches!(Scene::new(&model, usize::MAX), Err(Error::Invalid { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mjv_makeScene")]
    #[doc(alias = "mjv_defaultScene")]
    pub fn new(model: &Model, max_geoms: usize) -> Result<Self> {
        let Ok(maxgeom) = c_int::try_from(max_geoms) else {
            return Err(Error::out_of_range(
                "the capacity of a scene",
                format!("{max_geoms} geoms"),
                format!("at most {}", c_int::MAX),
            ));
        };
        let skin_vertices: usize = model.skin_vertnum().iter().map(|&count| ffi::size(count)).sum();
        if c_int::try_from(3 * skin_vertices).is_err() {
            return Err(Error::Unsupported(format!(
                "{skin_vertices} skin vertices exceed the range of the engine's indices"
            )));
        }
        let no_memory = || Error::OutOfMemory { function: "mjv_makeScene" };
        let buffers =
            (Buffer::zeroed(max_geoms).ok_or_else(no_memory)?, Buffer::zeroed(max_geoms).ok_or_else(no_memory)?);
        let mut raw = Box::<MaybeUninit<mjvScene>>::new(MaybeUninit::uninit());
        // SAFETY: a valid place for the structure, which the function fills with zeros.
        unsafe { sys::mjv_defaultScene(raw.as_mut_ptr()) };
        // SAFETY: initialised above; all-zero bytes are valid numbers and null pointers.
        let raw = unsafe { Box::from_raw(Box::into_raw(raw).cast::<mjvScene>()) };
        let has_convex_hull = model.mesh_graphadr().iter().map(|&address| address >= 0).collect();
        let materials = vec![MaterialTexture::default(); model.nmat()].into();
        let mut scene = Self { raw, lineage: model.lineage(), buffers, skin_vertices, has_convex_hull, materials };
        // SAFETY: a valid model and an empty scene. If the engine raises an error, dropping the
        // scene frees what it allocated.
        let status = unsafe { guard::mjv_make_scene(model.as_ptr(), &raw mut *scene.raw, 0) };
        ffi::check_without_data("mjv_makeScene", status)?;
        let raw = &mut *scene.raw;
        if skin_vertices > 0 {
            // SAFETY: both arrays have three numbers per vertex. The engine leaves them
            // uninitialised until the first update.
            unsafe {
                ptr::write_bytes(raw.skinvert, 0, 3 * skin_vertices);
                ptr::write_bytes(raw.skinnormal, 0, 3 * skin_vertices);
            }
        }
        // SAFETY: the scene was made for the model.
        unsafe { sys::adapted::clear_scene_flexes(model.as_ptr(), raw) };
        (raw.maxgeom, raw.geoms, raw.geomorder) = (maxgeom, scene.buffers.0.as_ptr(), scene.buffers.1.as_ptr());
        Ok(scene)
    }

    /// Returns the capacity: the maximum number of geoms.
    pub fn max_geoms(&self) -> usize {
        ffi::size(self.raw().maxgeom)
    }

    /// Removes all geoms.
    pub fn clear(&mut self) {
        self.raw_mut().ngeom = 0;
    }

    /// Returns the rendering effects that are enabled.
    pub fn render_flags(&self) -> RenderFlags {
        RenderFlags::from_bits_truncate(options::bits(&self.raw().flags))
    }

    /// Enables exactly these rendering effects. Effects that only newer engines have, for their own
    /// renderer, are unchanged.
    pub fn set_render_flags(&mut self, flags: RenderFlags) {
        options::set_flags(&mut self.raw_mut().flags, flags.bits(), RenderFlags::all().bits());
    }

    /// Returns the engine's structure, for direct calls of the C functions. Those must not create
    /// or free the scene.
    #[inline]
    pub fn as_ptr(&self) -> *const mjvScene {
        &raw const *self.raw
    }

    #[inline]
    fn raw(&self) -> &mjvScene {
        &self.raw
    }

    #[inline]
    fn raw_mut(&mut self) -> &mut mjvScene {
        &mut self.raw
    }

    /// Returns the identity of the model family that the scene belongs to.
    #[cfg(feature = "renderer")]
    pub(crate) fn lineage(&self) -> Lineage {
        self.lineage
    }

    fn check_model(&self, model: &Model, what: &'static str) -> Result<()> {
        if model.lineage() == self.lineage { Ok(()) } else { Err(Error::OtherModel { what }) }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // This crate allocated these two arrays, and frees them itself.
        (self.raw.geoms, self.raw.geomorder) = (ptr::null_mut(), ptr::null_mut());
        // SAFETY: every other pointer was allocated by the engine or is NULL, and the function only
        // frees them.
        unsafe { sys::mjv_freeScene(&raw mut *self.raw) };
    }
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Scene: {} of at most {} geoms, {} lights, {} skins",
            self.ngeom(),
            self.max_geoms(),
            self.raw().nlight,
            self.raw().nskin
        )
    }
}

/// Types for which all-zero bytes are a valid value, and which need no drop.
///
/// # Safety
///
/// Both conditions must hold for the implementing type.
unsafe trait Plain {}

// SAFETY: a structure of numbers and arrays of numbers.
unsafe impl Plain for mjvGeom {}
// SAFETY: an integer.
unsafe impl Plain for c_int {}

/// Zero-initialised array.
///
/// The engine allocates this array with `malloc` and does not initialise it. It then writes labels
/// without a terminator and never sets the fields that only its renderer uses. Zeroed pages are
/// committed on first use, so a large capacity is cheap.
struct Buffer<T: Plain> {
    start: NonNull<T>,
    layout: Layout,
}

impl<T: Plain> Buffer<T> {
    /// Allocates an array of this length; `None` if memory is exhausted.
    fn zeroed(length: usize) -> Option<Self> {
        let layout = Layout::array::<T>(length).ok()?;
        if layout.size() == 0 {
            return Some(Self { start: NonNull::dangling(), layout });
        }
        // SAFETY: the size of the layout is not zero.
        let start = unsafe { alloc_zeroed(layout) };
        Some(Self { start: NonNull::new(start.cast())?, layout })
    }

    /// Returns the start of the array in the engine's convention: NULL if it is empty.
    fn as_ptr(&self) -> *mut T {
        if self.layout.size() == 0 { ptr::null_mut() } else { self.start.as_ptr() }
    }
}

impl<T: Plain> Drop for Buffer<T> {
    fn drop(&mut self) {
        if self.layout.size() > 0 {
            // SAFETY: allocated with this layout, and freed only here.

            unsafe { dealloc(self.start.as_ptr().cast(), self.layout) };
        }
    }
}
