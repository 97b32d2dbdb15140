//! Rebuilding the contents of a scene from a simulation.

use std::ffi::c_int;
use std::ops::Range;
use std::ptr;

use mujoco_sys::{adapted, guard, mjMAXLIGHT};

use super::{Camera, Categories, Perturbation, Scene, SceneOptions};
use crate::data::{Data, Warning};
use crate::error::{Error, Result};

impl Scene {
    /// Rebuilds the scene: geoms, lights, skins and viewpoints. Removes geoms that were added with
    /// [`add_geom`](Self::add_geom).
    ///
    /// `camera` is the camera to view the scene from; a tracking camera moves with its body.
    /// `perturbation` is drawn if `options` enable it. `categories` restricts the geoms;
    /// [`Categories::all`] includes everything.
    ///
    /// The quantities that the scene shows must have been computed. [`Data::forward`] computes all
    /// of them, and [`Data::step`] leaves those of the previous state, which are sufficient. If
    /// neither contacts nor constraints are shown, these calls are sufficient, too:
    ///
    /// - [`kinematics`](Data::kinematics), [`com_pos`](Data::com_pos) and
    ///   [`camlight`](Data::camlight), which take a fraction of the time,
    /// - [`fwd_position`](Data::fwd_position) for a model with tendons or plugins, or if joints or
    ///   bounding volumes are shown,
    /// - and after it [`sensor_pos`](Data::sensor_pos) for the rays of rangefinders.
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`] if the capacity is too small for all geoms, or if there are more than
    /// 100 lights. The scene then contains as many as fit, and lights, skins and viewpoints are up
    /// to date, so a viewer can continue.
    ///
    /// [`Error::NotComputed`] if a required result is missing, [`Error::OtherModel`] for data of
    /// another model, [`Error::Invalid`] if the camera or the perturbation contains a value that is
    /// not finite, [`Error::Unsupported`] for labels that the engine lacks. The scene is then
    /// unchanged. None of these errors poisons the data.
    ///
    /// # Panics
    ///
    /// If an id in the camera or the perturbation belongs to another model.
    #[doc(alias = "mjv_updateScene")]
    pub fn update(
        &mut self,
        data: &mut Data,
        options: &SceneOptions,
        perturbation: Option<&Perturbation>,
        camera: &mut Camera,
        categories: Categories,
    ) -> Result<()> {
        self.check_data("Scene::update", data, options, categories)?;
        let perturbation = perturbation.map(|perturbation| perturbation.raw(data.model())).transpose()?;
        let mut raw_camera = camera.raw(data.model())?;
        let pert = perturbation.as_ref().map_or(ptr::null(), ptr::from_ref);
        let (opt, catmask) = (options.raw(), categories.bits() as c_int);
        let scene = self.raw_mut();
        let is_full = data.call_mut_with_warning(Warning::VisualGeomFull, "mjv_updateScene", |m, d| {
            // SAFETY: the model, the data and the scene belong together, the ids are valid, and
            // every array that the function reads was computed.
            unsafe { guard::mjv_update_scene(m, d, &raw const opt, pert, &raw mut raw_camera, catmask, scene) }
        })?;
        camera.take(&raw_camera);
        self.read_materials(data.model());
        if is_full || self.is_full() {
            return Err(self.geoms_full());
        }
        let lights = usize::from(data.model().raw().vis.headlight.active != 0)
            + data.model().light_active().iter().filter(|&&active| active != 0).count();
        let capacity = mjMAXLIGHT as usize;
        if lights > capacity { Err(Error::SceneFull { what: "lights", capacity }) } else { Ok(()) }
    }

    /// Rebuilds the scene as [`update`](Self::update) does, but independently of the previous
    /// viewpoints, and with all geoms: a larger scene replaces a full one, and the data keeps no
    /// warning of it.
    #[cfg(any(feature = "renderer", feature = "html", feature = "gltf", feature = "mcap"))]
    pub(crate) fn update_and_grow(
        &mut self,
        data: &mut Data,
        options: &SceneOptions,
        camera: &mut Camera,
    ) -> Result<()> {
        let start = *camera;
        self.check_data("Renderer::snapshot", data, options, Categories::all())?;
        self.update_camera(data, &mut camera.clone())?;
        let before = data.raw().warning;
        loop {
            let result = self.update(data, options, None, camera, Categories::all());
            let Err(Error::SceneFull { what: "geoms", capacity }) = result else { return result };
            data.raw_mut().warning = before;
            let mut larger = Self::new(data.model(), 2 * capacity.max(1))?;
            larger.raw_mut().flags = self.raw().flags;
            larger.raw_mut().camera = self.raw().camera;
            *self = larger;
            // Each update moves a tracking camera.
            *camera = start;
        }
    }

    /// Appends the geoms of a simulation to the scene and returns their indices. The state may
    /// differ from the state of the last [`update`](Self::update), so one image can show several
    /// poses.
    ///
    /// # Errors
    ///
    /// As for [`update`](Self::update). A full scene keeps the geoms that fit.
    ///
    /// # Panics
    ///
    /// If an id in the perturbation belongs to another model.
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
    /// let ghost = scene.add_geoms(&mut data, &options, None, Categories::DYNAMIC)?;
    /// for mut geom in scene.geoms_mut().skip(ghost.start) {
    ///     let [r, g, b, _] = geom.view().rgba();
    ///     geom.set_rgba([r, g, b, 0.3]);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjv_addGeoms")]
    pub fn add_geoms(
        &mut self,
        data: &mut Data,
        options: &SceneOptions,
        perturbation: Option<&Perturbation>,
        categories: Categories,
    ) -> Result<Range<usize>> {
        self.check_data("Scene::add_geoms", data, options, categories)?;
        let perturbation = perturbation.map(|perturbation| perturbation.raw(data.model())).transpose()?;
        let pert = perturbation.as_ref().map_or(ptr::null(), ptr::from_ref);
        let (opt, catmask) = (options.raw(), categories.bits() as c_int);
        let start = self.ngeom();
        let scene = self.raw_mut();
        let is_full = data.call_mut_with_warning(Warning::VisualGeomFull, "mjv_addGeoms", |m, d| {
            // SAFETY: as in `update`.
            unsafe { guard::mjv_add_geoms(m, d, &raw const opt, pert, catmask, scene) }
        })?;
        self.read_materials(data.model());
        if is_full || self.is_full() { Err(self.geoms_full()) } else { Ok(start..self.ngeom()) }
    }

    /// Returns an error unless the data belongs to the model and contains every result that the
    /// engine reads.
    fn check_data(
        &self,
        call: &'static str,
        data: &Data,
        options: &SceneOptions,
        categories: Categories,
    ) -> Result<()> {
        let model = data.model();
        self.check_model(model, "the data to show")?;
        options.label.check_supported()?;
        // The engine does not clamp the groups of skins. Loading a model rejects groups out of
        // range.
        options.check_computed(call, data, categories)
    }

    /// Returns `true` if the engine reports a full scene in the scene itself, as newer engines do.
    fn is_full(&self) -> bool {
        // SAFETY: a valid scene, of which the function reads a number.
        unsafe { adapted::scene_is_full(self.as_ptr()) != 0 }
    }

    #[cold]
    pub(super) fn geoms_full(&self) -> Error {
        Error::SceneFull { what: "geoms", capacity: self.max_geoms() }
    }
}
