//! Images of all simulations of a batch: observations of policies that learn from images.

use std::fmt;

use super::Renderer;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::IntoModel;
use crate::render::RenderError;
use crate::rollout::Batch;
use crate::scene::{Camera, CameraSource, Categories, Scene, SceneOptions};

/// Changes a simulation before its image is drawn.
type Edit = dyn FnMut(usize, &mut Data) -> Result<()> + Send;

/// Camera that sees each simulation of a [`Batch`] in one image, also those of a
/// [`VectorEnvironment`](crate::environment::VectorEnvironment): observations for policies that
/// learn from images.
///
/// The images are one contiguous row-major array `(n, height, width, channels)`. The camera keeps
/// its memory, so that no call copies it.
///
/// ```no_run
/// use mujoco_safe::environment::{Hopper, VectorEnvironment};
/// use mujoco_safe::render::{BatchCamera, Renderer};
/// use mujoco_safe::scene::Camera;
///
/// let mut hoppers = VectorEnvironment::new(Hopper::model(), Hopper, 64, 42)?;
/// let model = hoppers.batch().model().clone();
/// let mut camera = BatchCamera::new(Renderer::new(&model, 84, 84)?, &model, &mut Camera::free(&model))?;
/// hoppers.step(&[0.0; 64 * 3])?;
/// let images: &[u8] = camera.rgb(hoppers.batch())?; // (64, 84, 84, 3)
/// assert_eq!(images.len(), 64 * 84 * 84 * 3);
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
#[doc(alias = "pixels")]
#[doc(alias = "image_observations")]
pub struct BatchCamera {
    renderer: Renderer,
    /// Receives each simulation in turn.
    data: Data,
    camera: Camera,
    options: SceneOptions,
    edit: Option<Box<Edit>>,
    rgb: Vec<u8>,
    metres: Vec<f32>,
    ids: Vec<u32>,
}

impl BatchCamera {
    /// Creates a camera that draws with a renderer, in images of its size. `camera` is the name,
    /// index or id of a camera of the model, or a `&mut` [`Camera`], which is copied: see
    /// [`CameraSource`]. Takes a [`Model`](crate::Model), an `Arc<Model>` or an `&Arc<Model>`: that
    /// of the batches.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a renderer of another model,
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for a camera that the model lacks; the
    /// errors of [`Data::new`].
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    #[track_caller]
    pub fn new(renderer: Renderer, model: impl IntoModel, camera: impl CameraSource) -> Result<Self, RenderError> {
        let data = Data::new(model)?;
        if data.model().lineage() != renderer.assets.lineage {
            return Err(Error::OtherModel { what: "the renderer" }.into());
        }
        let camera = camera.with_camera(data.model(), |camera| Ok(*camera))?;
        let (rgb, metres, ids) = Default::default();
        Ok(Self { renderer, data, camera, options: SceneOptions::default(), edit: None, rgb, metres, ids })
    }

    /// Sets what the images show: visible groups, frames, contacts, … The camera computes only what
    /// they show: for contacts and constraints [`Data::forward`] of each simulation, for tendons,
    /// joints and rangefinders the position stage, and otherwise the poses alone.
    #[must_use]
    pub fn with_scene_options(mut self, options: SceneOptions) -> Self {
        self.options = options;
        self
    }

    /// Calls `edit` with each simulation before it is drawn, in the order of their indices. Edits
    /// of its model randomise colours, lights, cameras and, by
    /// [`set_material`](crate::element::GeomMut::set_material), textures; they last for this image,
    /// and do not change the batch. Edits of the pixels of textures, of meshes, height fields and
    /// visual settings (`vis`) have no effect, because the renderer has its own copies of them.
    ///
    /// ```no_run
    /// use mujoco_safe::render::{BatchCamera, Renderer};
    /// use mujoco_safe::rollout::Random;
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let batch = Batch::new(sample::humanoid(), 32)?;
    /// let model = batch.model().clone();
    /// let mut camera = BatchCamera::new(Renderer::new(&model, 84, 84)?, &model, "side")?.with_edits(|index, data| {
    ///     let mut random = Random::new(1, index, 0);
    ///     data.edit_model(|model| {
    ///         for rgba in model.geom_rgba_mut() {
    ///             rgba[0] = random.uniform(0.0, 1.0) as f32;
    ///         }
    ///         model.light_diffuse_mut()[0] = [random.uniform(0.3, 1.0) as f32; 3];
    ///     })
    /// });
    /// let images = camera.rgb(&batch)?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    #[must_use]
    pub fn with_edits(mut self, edit: impl FnMut(usize, &mut Data) -> Result<()> + Send + 'static) -> Self {
        self.edit = Some(Box::new(edit));
        self
    }

    /// Renders the colours of each simulation: `(n, height, width, 3)`. See
    /// [`Renderer::rgb_batch_into`].
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a batch of another model; the errors of
    /// the edits, of [`Renderer::snapshot`] and of [`Data::fwd_position`].
    pub fn rgb(&mut self, batch: &Batch<'_>) -> Result<&[u8], RenderError> {
        let Self { renderer, data, camera, options, edit, rgb, .. } = self;
        rgb.resize(3 * batch.len() * pixels(renderer), 0);
        renderer.rgb_batch_into(update(batch, data, camera, options, edit), rgb)?;
        Ok(rgb)
    }

    /// Renders the depths of each simulation, m: `(n, height, width)`. See
    /// [`Renderer::depth_batch_into`].
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth(&mut self, batch: &Batch<'_>) -> Result<&[f32], RenderError> {
        let Self { renderer, data, camera, options, edit, metres, .. } = self;
        metres.resize(batch.len() * pixels(renderer), 0.0);
        renderer.depth_batch_into(update(batch, data, camera, options, edit), metres)?;
        Ok(metres)
    }

    /// Renders the segments of each simulation: `(n, height, width)`. See
    /// [`Renderer::segmentation_batch_into`].
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation(&mut self, batch: &Batch<'_>) -> Result<&[u32], RenderError> {
        let Self { renderer, data, camera, options, edit, ids, .. } = self;
        ids.resize(batch.len() * pixels(renderer), 0);
        renderer.segmentation_batch_into(update(batch, data, camera, options, edit), ids)?;
        Ok(ids)
    }

    /// Makes this the camera of the batches of another model, such as an edited one that a batch
    /// has [adopted](Batch::adopt). `camera` is one of the new model, as for [`new`](Self::new),
    /// because ids belong to a model. The size of the images, the scene options and the edits stay;
    /// edits receive simulations of the new model.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new) and [`Renderer::adopt`]. The camera is unchanged then.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    ///
    /// ```no_run
    /// use mujoco_safe::render::{BatchCamera, Renderer};
    /// use mujoco_safe::spec::Spec;
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let mut batch = Batch::new(sample::humanoid(), 32)?;
    /// let model = batch.model().clone();
    /// let mut camera = BatchCamera::new(Renderer::new(&model, 84, 84)?, &model, "side")?;
    /// batch.adopt(Spec::from_xml_path("edited.xml")?.compile()?)?;
    /// camera.adopt(batch.model(), "side")?;
    /// let images = camera.rgb(&batch)?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    #[track_caller]
    pub fn adopt(&mut self, model: impl IntoModel, camera: impl CameraSource) -> Result<(), RenderError> {
        let data = Data::new(model)?;
        let camera = camera.with_camera(data.model(), |camera| Ok(*camera))?;
        self.renderer.adopt(data.model())?;
        (self.data, self.camera) = (data, camera);
        Ok(())
    }

    /// Returns the renderer.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }
}

fn pixels(renderer: &Renderer) -> usize {
    let [width, height] = renderer.size();
    width * height
}

/// Returns the function that updates the scene to a simulation.
fn update<'c>(
    batch: &'c Batch<'_>,
    data: &'c mut Data,
    camera: &'c Camera,
    options: &'c SceneOptions,
    edit: &'c mut Option<Box<Edit>>,
) -> impl FnMut(usize, &mut Scene) -> Result<()> + 'c {
    move |index, scene| {
        batch.load(index, data)?;
        if let Some(edit) = edit {
            edit(index, data)?;
        }
        options.compute(data, Categories::all())?;
        // A tracking camera moves with each update.
        scene.update_and_grow(data, options, &mut camera.clone())
    }
}

impl fmt::Debug for BatchCamera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BatchCamera: {:?}, {:?}", self.camera, self.renderer)
    }
}
