//! Images of a simulation without a scene of the caller.

use std::fmt;
use std::sync::Arc;

use super::Renderer;
use crate::data::Data;
use crate::error::Error;
use crate::render::{DepthImage, Images, RenderError, RgbImage, SegmentationImage};
use crate::scene::{CameraSource, PinholeCamera, Scene, SceneOptions};

/// State of a simulation, seen by one camera: a source of colour, depth and segmentation images,
/// which all show the same scene.
///
/// [`Renderer::snapshot`] creates it. Later changes of the simulation do not change it.
///
/// ```no_run
/// use mujoco_safe::render::Renderer;
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let mut renderer = Renderer::new(data.model(), 640, 480)?;
/// let mut snapshot = renderer.snapshot(&mut data, "side")?;
/// let colours = snapshot.rgb()?;
/// let depth = snapshot.depth()?;
///
/// // A coloured point cloud in the world frame.
/// let camera = snapshot.pinhole_camera()?;
/// for ([x, y], point) in depth.points(&camera) {
///     println!("{point:?} {:?}", colours.pixel(x, y));
/// }
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
pub struct Snapshot<'r> {
    renderer: &'r mut Renderer,
}

impl Renderer {
    /// Takes a snapshot of a simulation from a camera, from which colour, depth and segmentation
    /// images are rendered.
    ///
    /// `camera` is the name, index or id of a camera of the model, or a `&mut`
    /// [`Camera`](crate::scene::Camera): see [`CameraSource`]. All geoms of the model's visible
    /// groups are shown, with the default [`SceneOptions`]. The renderer owns the scene and reuses
    /// it. A snapshot allocates only if the scene must grow to hold all geoms, and for the lookup
    /// of a name.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] if positions have not been computed: call [`Data::forward`] or
    /// [`Data::step`] first. [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for a camera that does
    /// not exist, [`Error::OtherModel`] for data of another model, [`Error::Invalid`] if the camera
    /// contains a value that is not finite, [`Error::SceneFull`] for more than 100 lights,
    /// [`Error::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::scene::Camera;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut renderer = Renderer::new(data.model(), 640, 480)?;
    /// renderer.snapshot(&mut data, "side")?.rgb()?.save_png("side.png")?;
    ///
    /// let mut free = Camera::free(data.model());
    /// renderer.snapshot(&mut data, &mut free)?.depth()?.save_png("depth.png")?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    #[track_caller]
    #[doc(alias = "update_scene")]
    pub fn snapshot(&mut self, data: &mut Data, camera: impl CameraSource) -> Result<Snapshot<'_>, RenderError> {
        self.snapshot_with(data, camera, &SceneOptions::default())
    }

    /// Takes a snapshot as [`snapshot`](Self::snapshot) does, with options: visible groups, labels,
    /// frames, contacts, …
    ///
    /// # Errors
    ///
    /// As for [`snapshot`](Self::snapshot), and [`Error::NotComputed`] if contacts or constraints
    /// are shown but forces have not been computed.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::scene::{SceneOptions, VisualFlags};
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut renderer = Renderer::new(data.model(), 640, 480)?;
    /// let contacts = SceneOptions::default().with_flags(VisualFlags::CONTACTPOINT | VisualFlags::CONTACTFORCE);
    /// renderer.snapshot_with(&mut data, "side", &contacts)?.rgb()?.save_png("contacts.png")?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    #[track_caller]
    pub fn snapshot_with(
        &mut self,
        data: &mut Data,
        camera: impl CameraSource,
        options: &SceneOptions,
    ) -> Result<Snapshot<'_>, RenderError> {
        let model = data.model().clone();
        if model.lineage() != self.assets.lineage {
            return Err(Error::OtherModel { what: "the data to show" }.into());
        }
        let mut snapshot = Snapshot { renderer: self };
        let scene = snapshot.scene_mut();
        camera.with_camera(&model, |camera| scene.update_and_grow(data, options, camera))?;
        Ok(snapshot)
    }
}

impl Snapshot<'_> {
    /// Renders a colour image.
    ///
    /// # Errors
    ///
    /// [`RenderError::OutOfMemory`] and [`RenderError::Lost`]; [`Error::Invalid`] for a camera with
    /// the mode [`CameraView::User`](crate::scene::CameraView::User) in the first snapshot of a
    /// renderer, which has no viewpoints.
    #[doc(alias = "read_pixels")]
    pub fn rgb(&mut self) -> Result<RgbImage, RenderError> {
        self.renderer.rgb(&self.shared_scene())
    }

    /// Renders a colour image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn rgb_into(&mut self, picture: &mut RgbImage) -> Result<(), RenderError> {
        self.renderer.rgb_into(&self.shared_scene(), picture)
    }

    /// Renders a depth image: distances along the optical axis, m. See [`Renderer::depth`] for its
    /// precision.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    #[doc(alias = "enable_depth_rendering")]
    pub fn depth(&mut self) -> Result<DepthImage, RenderError> {
        self.renderer.depth(&self.shared_scene())
    }

    /// Renders a depth image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth_into(&mut self, picture: &mut DepthImage) -> Result<(), RenderError> {
        self.renderer.depth_into(&self.shared_scene(), picture)
    }

    /// Renders a segmentation image: the visible geom at each pixel.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    #[doc(alias = "enable_segmentation_rendering")]
    pub fn segmentation(&mut self) -> Result<SegmentationImage, RenderError> {
        self.renderer.segmentation(&self.shared_scene())
    }

    /// Renders a segmentation image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation_into(&mut self, picture: &mut SegmentationImage) -> Result<(), RenderError> {
        self.renderer.segmentation_into(&self.shared_scene(), picture)
    }

    /// Renders a colour, a depth and a segmentation image together: see [`Renderer::images`].
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn images(&mut self) -> Result<Images, RenderError> {
        self.renderer.images(&self.shared_scene())
    }

    /// Renders as [`images`](Self::images) does into existing images, which are resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn images_into(&mut self, images: &mut Images) -> Result<(), RenderError> {
        self.renderer.images_into(&self.shared_scene(), images)
    }

    /// Returns the pinhole model of the camera: focal lengths and principal point in pixels of
    /// these images, position and rotation.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] as for [`rgb`](Self::rgb), and for a scene with a
    /// [`transform`](Scene::transform), which only [`scene_mut`](Self::scene_mut) can set.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut renderer = Renderer::new(data.model(), 640, 480)?;
    /// let camera = renderer.snapshot(&mut data, "side")?.pinhole_camera()?;
    /// assert_eq!((camera.cx, camera.cy), (320.0, 240.0));
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    pub fn pinhole_camera(&self) -> Result<PinholeCamera, RenderError> {
        let [width, height] = self.renderer.size.map(|length| length as usize);
        Ok(self.scene().pinhole_camera(width, height)?)
    }

    /// Returns the scene, for example to look up the geoms of a segmentation image.
    pub fn scene(&self) -> &Scene {
        &self.renderer.snapshot_scene
    }

    /// Returns the scene for changes: additional geoms, rendering effects, other viewpoints. The
    /// next snapshot removes additional geoms. Rendering effects stay enabled in later snapshots of
    /// the renderer.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::scene::NewGeom;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let mut renderer = Renderer::new(data.model(), 640, 480)?;
    /// let mut snapshot = renderer.snapshot(&mut data, "side")?;
    /// snapshot.scene_mut().add_geom(&NewGeom::sphere(0.1).with_pos([0.0, 0.0, 2.0]))?;
    /// snapshot.rgb()?.save_png("marked.png")?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    pub fn scene_mut(&mut self) -> &mut Scene {
        Arc::get_mut(&mut self.renderer.snapshot_scene).expect("Bug: the scene of snapshots is shared")
    }

    /// Returns the scene as an argument for the renderer that owns it.
    fn shared_scene(&self) -> Arc<Scene> {
        self.renderer.snapshot_scene.clone()
    }
}

impl fmt::Debug for Snapshot<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.renderer.size;
        write!(f, "Snapshot: {width} x {height} pixels of {:?}", self.scene())
    }
}
