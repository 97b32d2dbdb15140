//! The abstract picture of a simulation: shapes, lights and eyes, for a renderer to draw. Nothing here draws.
//!
//! ```
//! use mujoco_safe::scene::{Camera, Categories, Scene, SceneObject, SceneOptions, VisualFlags};
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
//!     // geom.geom_type(), geom.size(), geom.pos(), geom.mat(), geom.rgba() are what to draw.
//!     if let Some(SceneObject::Joint(joint)) = geom.object() {
//!         assert!(data.joint(joint).name().is_some());
//!     }
//! }
//! let eye = scene.viewpoint();
//! assert!(eye.frustum_near > 0.0 && eye.frustum_far > eye.frustum_near);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! | file | what is in it |
//! |---|---|
//! | `options.rs` | what is shown: [`SceneOptions`], [`VisualFlags`], [`Categories`] |
//! | `camera.rs` | [`Camera`]: free, tracking, fixed |
//! | `viewpoint.rs` | the eyes, and the room that the model stands in |
//! | `geom.rs` | the geoms of a scene |
//! | `new_geom.rs` | geoms of the user's |
//! | `light.rs` | lights |
//! | `skin.rs` | skins |
//! | `perturbation.rs` | [`Perturbation`]: a body that is pulled with the mouse |
//! | `select.rs` | what is seen at a place of the window |
//! | `buffer.rs` | memory for the geoms |
//!
//! # Which model
//!
//! A scene belongs to the model that it was made for, to its clones and to every [`Data`] made from them. Another is
//! [`Error::OtherModel`]; ids of another panic, as everywhere.
//!
//! # Quirks of the engine
//!
//! The middle of an infinite plane is put near the eyes of the update before: see [`Scene::update_camera`]. A fixed tendon of
//! two joints that is limited from zero on, without spring and damping, is drawn as a string between two points that mean
//! nothing.

mod buffer;
mod camera;
mod geom;
mod light;
mod new_geom;
mod options;
mod perturbation;
mod select;
mod skin;
mod viewpoint;

use std::ffi::c_int;
use std::fmt;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjData, mjMAXLIGHT, mjModel, mjvGeom, mjvScene};

use self::buffer::Buffer;
pub use self::camera::{Camera, CameraView, MouseAction};
pub use self::geom::{SceneGeom, SceneGeomMut, SceneGeomType, SceneObject};
pub use self::light::SceneLight;
pub use self::new_geom::{Connector, NewGeom};
pub use self::options::{Categories, FrameMode, LabelMode, RenderFlags, SceneOptions, VisualFlags};
pub use self::perturbation::{Perturbation, PerturbationFlags};
pub use self::select::Selection;
pub use self::skin::SceneSkin;
pub use self::viewpoint::{Head, Transform, Viewpoint, align_to_camera};
use crate::data::{Data, Stage, Warning};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::Lineage;
use crate::model::Model;

/// The abstract picture of a simulation, with room for a number of geoms. See the [module](self).
#[doc(alias = "mjvScene")]
#[doc(alias = "mjv_freeScene")]
pub struct Scene {
    raw: Box<mjvScene>,
    lineage: Lineage,
    /// What `raw.geoms` and `raw.geomorder` point at.
    buffers: (Buffer<mjvGeom>, Buffer<c_int>),
    skin_vertices: usize,
    /// For each mesh whether it has a convex hull.
    hulls: Box<[bool]>,
}

// SAFETY: the engine's structure is memory without thread affinity, and all of it belongs to the scene.
unsafe impl Send for Scene {}
// SAFETY: as above; written to through `&mut Scene` only.
unsafe impl Sync for Scene {}

impl Scene {
    /// An empty scene for a model, with room for so many geoms. Memory for them is taken as they are used.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for more geoms than a C `int` can count, [`Error::OutOfMemory`] or [`Error::Engine`] if there is no
    /// memory.
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
            return Err(Error::invalid(
                "the room of a scene",
                format!("{max_geoms} geoms"),
                format!("at most {}", c_int::MAX),
            ));
        };
        let skin_vertices: usize = model.skin_vertnum().iter().map(|&count| ffi::size(count)).sum();
        if c_int::try_from(3 * skin_vertices).is_err() {
            return Err(Error::Unsupported(format!(
                "{skin_vertices} vertices of skins are more than the engine can count"
            )));
        }
        let no_memory = || Error::OutOfMemory { function: "mjv_makeScene" };
        let buffers =
            (Buffer::zeroed(max_geoms).ok_or_else(no_memory)?, Buffer::zeroed(max_geoms).ok_or_else(no_memory)?);
        let mut raw = Box::<MaybeUninit<mjvScene>>::new(MaybeUninit::uninit());
        // SAFETY: a place for the structure, which the function fills with zeros.
        unsafe { sys::mjv_defaultScene(raw.as_mut_ptr()) };
        // SAFETY: initialised above; zeros are numbers and null pointers.
        let raw = unsafe { Box::from_raw(Box::into_raw(raw).cast::<mjvScene>()) };
        let hulls = Self::hulls_of(model);
        let mut scene = Self { raw, lineage: model.lineage(), buffers, skin_vertices, hulls };
        // SAFETY: a model and an empty scene. What it could allocate before an error, the scene's drop frees.
        let status = unsafe { guard::mjv_make_scene(model.as_ptr(), &raw mut *scene.raw, 0) };
        ffi::check_without_data("mjv_makeScene", status)?;
        let raw = &mut *scene.raw;
        if skin_vertices > 0 {
            // SAFETY: allocated for three numbers for each vertex. The engine leaves them as they are until skins are updated.
            unsafe {
                ptr::write_bytes(raw.skinvert, 0, 3 * skin_vertices);
                ptr::write_bytes(raw.skinnormal, 0, 3 * skin_vertices);
            }
        }
        (raw.maxgeom, raw.geoms, raw.geomorder) = (maxgeom, scene.buffers.0.as_ptr(), scene.buffers.1.as_ptr());
        Ok(scene)
    }

    /// How many geoms there is room for.
    pub fn max_geoms(&self) -> usize {
        ffi::size(self.raw().maxgeom)
    }

    /// Rebuilds the scene: geoms, lights, skins and viewpoints. Geoms that the user added are removed.
    ///
    /// `camera` says where it is seen from; a tracking camera moves along. `perturbation` is shown. `categories` is
    /// [`Categories::all`] for everything.
    ///
    /// The quantities must have been computed: positions, and where contacts or constraints are shown everything. Those of the
    /// state before, as a step leaves them, will do.
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`] if there is not enough room for all geoms, or for more than 100 lights. What there is room for is in
    /// the scene then, and lights, skins and eyes are up to date: a viewer may go on.
    ///
    /// [`Error::NotComputed`] as said above, [`Error::OtherModel`] for the data of another model, [`Error::Invalid`] for numbers
    /// of the camera or of the perturbation that are not finite. The scene is as it was then. None of these poisons the data.
    ///
    /// # Panics
    ///
    /// If an id of the camera or of the perturbation is of another model.
    #[doc(alias = "mjv_updateScene")]
    pub fn update(
        &mut self,
        data: &mut Data,
        options: &SceneOptions,
        perturbation: Option<&Perturbation>,
        camera: &mut Camera,
        categories: Categories,
    ) -> Result<()> {
        self.check_data("Scene::update", data, options)?;
        let perturbation = perturbation.map(|perturbation| perturbation.raw(data.model())).transpose()?;
        let mut raw_camera = camera.raw(data.model())?;
        let pert = perturbation.as_ref().map_or(ptr::null(), ptr::from_ref);
        let (opt, catmask) = (options.raw(), categories.bits() as c_int);
        let scene = self.raw_mut();
        let missing = counting(data, "mjv_updateScene", |m, d| {
            // SAFETY: a model, a data and a scene that go together, ids of the model, and all that is read was computed.
            unsafe { guard::mjv_update_scene(m, d, &raw const opt, pert, &raw mut raw_camera, catmask, scene) }
        })?;
        camera.take(&raw_camera);
        if missing {
            return Err(self.geoms_full());
        }
        let lights = usize::from(data.model().raw().vis.headlight.active != 0)
            + data.model().light_active().iter().filter(|&&active| active != 0).count();
        let room = mjMAXLIGHT as usize;
        if lights > room { Err(Error::SceneFull { what: "lights", room }) } else { Ok(()) }
    }

    /// Adds the geoms of a simulation to those that there are, which may be of another state: several poses in one picture. Where
    /// they are is returned.
    ///
    /// # Errors
    ///
    /// As for [`update`](Self::update). In a full scene those that there was room for stay.
    ///
    /// # Panics
    ///
    /// If an id of the perturbation is of another model.
    ///
    /// ```
    /// use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut scene = Scene::new(data.model(), 1000)?;
    /// let options = SceneOptions::default();
    /// let mut camera = Camera::free(data.model());
    /// scene.update(&mut data, &options, None, &mut camera, Categories::all())?;
    /// for _ in 0..10 {
    ///     data.step()?;
    /// }
    /// let ghost = scene.add(&mut data, &options, None, Categories::DYNAMIC)?;
    /// for mut geom in scene.geoms_mut().skip(ghost.start) {
    ///     let [r, g, b, _] = geom.view().rgba();
    ///     geom.set_rgba([r, g, b, 0.3]);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjv_addGeoms")]
    pub fn add(
        &mut self,
        data: &mut Data,
        options: &SceneOptions,
        perturbation: Option<&Perturbation>,
        categories: Categories,
    ) -> Result<Range<usize>> {
        self.check_data("Scene::add", data, options)?;
        let perturbation = perturbation.map(|perturbation| perturbation.raw(data.model())).transpose()?;
        let pert = perturbation.as_ref().map_or(ptr::null(), ptr::from_ref);
        let (opt, catmask) = (options.raw(), categories.bits() as c_int);
        let start = self.ngeom();
        let scene = self.raw_mut();
        let missing = counting(data, "mjv_addGeoms", |m, d| {
            // SAFETY: as in `update`.
            unsafe { guard::mjv_add_geoms(m, d, &raw const opt, pert, catmask, scene) }
        })?;
        if missing { Err(self.geoms_full()) } else { Ok(start..self.ngeom()) }
    }

    /// Brings only the lights up to date.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::OtherModel`] for the data of another model.
    #[doc(alias = "mjv_makeLights")]
    pub fn update_lights(&mut self, data: &Data) -> Result<()> {
        self.check_model(data.model(), "the data to show")?;
        data.check_computed("Scene::update_lights", Stage::Position)?;
        // SAFETY: a model and a data that go together, which the function only reads. It cannot fail.
        unsafe { sys::mjv_makeLights(data.model().as_ptr(), data.as_ptr().cast_mut(), self.raw_mut()) };
        Ok(())
    }

    /// Takes all geoms out of the scene.
    pub fn clear(&mut self) {
        self.raw_mut().ngeom = 0;
    }

    /// Which effects a renderer draws.
    pub fn render_flags(&self) -> RenderFlags {
        RenderFlags::from_bits_truncate(options::bits(&self.raw().flags))
    }

    /// Sets which effects a renderer draws.
    pub fn set_render_flags(&mut self, flags: RenderFlags) {
        self.raw_mut().flags = options::bytes(flags.bits());
    }

    /// The engine's structure, for calls past this crate. Those must not make or free the scene.
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

    /// Which model it is of.
    #[cfg(feature = "renderer")]
    pub(crate) fn lineage(&self) -> Lineage {
        self.lineage
    }

    fn check_model(&self, model: &Model, what: &'static str) -> Result<()> {
        if model.lineage() == self.lineage { Ok(()) } else { Err(Error::OtherModel { what }) }
    }

    /// Refuses a data of which the engine would read what is not there.
    fn check_data(&self, call: &'static str, data: &Data, options: &SceneOptions) -> Result<()> {
        let model = data.model();
        self.check_model(model, "the data to show")?;
        // The engine takes the groups of skins as they are; loading has checked them.
        data.check_computed(call, if options.shows_contacts() { Stage::Acceleration } else { Stage::Position })
    }

    #[cold]
    fn geoms_full(&self) -> Error {
        Error::SceneFull { what: "geoms", room: self.max_geoms() }
    }
}

/// Makes a call that may find the scene full, and returns whether it did. The engine prints the first such warning through a
/// buffer that all threads share, so the counter is not zero during the call.
fn counting(
    data: &mut Data,
    function: &'static str,
    call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
) -> Result<bool> {
    data.call_mut_with_warning(Warning::VisualGeomFull, function, call)
}

impl Drop for Scene {
    fn drop(&mut self) {
        // Ours, not the engine's.
        (self.raw.geoms, self.raw.geomorder) = (ptr::null_mut(), ptr::null_mut());
        // SAFETY: what is left was allocated by the engine, or is NULL; the function only frees it.
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
