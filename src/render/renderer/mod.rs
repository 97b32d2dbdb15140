//! Renderer of the scenes of one model.

mod adopt;
mod assets;
mod batch;
mod batch_camera;
mod encode;
mod frame;
mod images;
mod layout;
mod merged;
mod read_back;
mod snapshot;
mod tiled;

use std::fmt;
use std::sync::Arc;

use self::assets::Assets;
pub use self::batch_camera::BatchCamera;
use self::frame::Frame;
pub use self::images::Images;
use self::read_back::{ReadBack, depth_rows, id_rows, rgb_rows};
pub use self::snapshot::Snapshot;
use self::tiled::TiledImages;
use super::assets::{Shapes, Textures};
use super::bounding_volume::AssetBounds;
use super::draw_list::AuxOutput;
use super::gpu::DropUse;
use super::gpu::buffer::ReadBackBuffer;
use super::pass::{AuxTarget, COLOR_FORMAT, Target, check_size, too_large};
use super::settings::VisualSettings;
use super::support;
use super::{DepthImage, Gpu, GpuKind, RenderError, RendererOptions, RgbImage, SegmentationImage};
use crate::error::Error;
use crate::id::IntoId;
use crate::kind;
use crate::model::Model;
use crate::scene::Scene;

/// Initial capacity of the scene of snapshots, geoms. The scene grows if a model needs more.
const SNAPSHOT_CAPACITY: usize = 10_000;

/// Off-screen renderer of the scenes of one model.
///
/// The renderer copies the model's meshes, textures and visual settings at construction. After
/// edits of the model, call [`update_mesh`](Self::update_mesh),
/// [`update_height_field`](Self::update_height_field) or [`update_texture`](Self::update_texture).
///
/// A renderer can be sent to another thread, and renderers in several threads can share one
/// [`Gpu`]. They also share its compiled shaders, so that a further renderer on the same `Gpu`
/// draws its first image sooner. A process that ends waits for calls in progress in other threads,
/// for at most 10 s; later calls of these threads do not return.
///
/// [`snapshot`](Self::snapshot) shows a simulation from a camera. The functions that take a
/// [`Scene`] draw a scene of the caller.
///
/// ```no_run
/// use mujoco_safe::render::Renderer;
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let mut renderer = Renderer::new(data.model(), 640, 480)?;
/// renderer.snapshot(&mut data, "side")?.rgb()?.save_png("humanoid.png")?;
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
pub struct Renderer {
    assets: Assets,
    samples: u32,
    /// Width and height of full shadow maps, texels.
    shadow_size: u32,
    size: [u32; 2],
    frame: Frame,
    aux_target: Option<AuxTarget>,
    target: Option<Target>,
    color: Option<(wgpu::Texture, wgpu::TextureView)>,
    read_back: [Option<ReadBackBuffer>; ReadBack::COUNT],
    /// One is prepared while the other is rendered.
    tiled: [TiledImages; 2],
    /// Scene of snapshots. Shared only during a call of a snapshot.
    snapshot_scene: Arc<Scene>,
    /// Last, because the drop of the other fields uses the driver.
    drop_use: DropUse,
}

impl Drop for Renderer {
    fn drop(&mut self) {
        self.drop_use.begin();
    }
}

impl Renderer {
    /// Creates a renderer for images of the given size, pixels, on the best available graphics
    /// adapter.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if no adapter is available; [`RenderError::TooLarge`] if the
    /// image, or a mesh or a texture of the model, exceeds a limit of the adapter;
    /// [`RenderError::OutOfMemory`]. [`Error::Invalid`] for an empty image; the errors of
    /// [`Scene::new`] for the scene of snapshots.
    #[doc(alias = "mjr_makeContext")]
    pub fn new(model: &Model, width: usize, height: usize) -> Result<Self, RenderError> {
        Self::with_options(model, width, height, RendererOptions::default())
    }

    /// Creates a renderer as [`new`](Self::new) does, with options.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn with_options(
        model: &Model,
        width: usize,
        height: usize,
        options: RendererOptions,
    ) -> Result<Self, RenderError> {
        Self::on(&Gpu::new()?, model, width, height, options)
    }

    /// Creates a renderer as [`with_options`](Self::with_options) does, on an open adapter, which
    /// renderers can share.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn on(
        gpu: &Gpu,
        model: &Model,
        width: usize,
        height: usize,
        options: RendererOptions,
    ) -> Result<Self, RenderError> {
        gpu.guarded(|| {
            let size = check_size(gpu, [width, height])?;
            support::log(model);
            let quality = model.visual().quality;
            let settings = VisualSettings::new(model);
            let samples = options.samples.unwrap_or(quality.offsamples);
            let shadow_size = shadow_size(gpu, options.shadow_size, quality.shadowsize)?;
            let assets = Assets {
                gpu: gpu.clone(),
                lineage: model.lineage(),
                bounds: AssetBounds::new(model),
                shapes: Shapes::new(gpu, model, &settings, options.lighting)?,
                textures: Textures::new(gpu, model),
                settings,
                options,
                // A software rasteriser takes up to 1.5 times as long to draw images together.
                merges: gpu.can_merge() && gpu.kind() != GpuKind::Software,
            };
            Ok(Self {
                assets,
                samples: gpu.samples(samples),
                shadow_size,
                size,
                frame: Frame::new(gpu, shadow_size),
                aux_target: None,
                target: None,
                color: None,
                read_back: [const { None }; ReadBack::COUNT],
                tiled: Default::default(),
                snapshot_scene: Arc::new(Scene::new(model, SNAPSHOT_CAPACITY)?),
                drop_use: DropUse::default(),
            })
        })
    }

    /// Returns the width and height of the images, pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size.map(|length| length as usize)
    }

    /// Returns the graphics adapter.
    pub fn gpu(&self) -> &Gpu {
        &self.assets.gpu
    }

    /// Returns the requested options. The actual number of samples and size of shadow maps may be
    /// smaller, due to limits of the adapter.
    pub fn options(&self) -> &RendererOptions {
        &self.assets.options
    }

    /// Changes the size of the images, pixels.
    ///
    /// # Errors
    ///
    /// [`RenderError::TooLarge`] if the size exceeds a limit of the adapter, [`Error::Invalid`] if
    /// it is 0. The size is then unchanged.
    pub fn resize(&mut self, width: usize, height: usize) -> Result<(), RenderError> {
        self.size = check_size(&self.assets.gpu, [width, height])?;
        Ok(())
    }

    /// Changes the size of the labels of [`RendererOptions`].
    #[cfg(feature = "viewer")]
    pub(crate) fn set_font_scale(&mut self, scale: f64) {
        self.assets.options.font_scale = scale;
    }

    /// Uploads an edited mesh, which is selected by name, index, id or view.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage, [`Error::NoSuchName`] or
    /// [`Error::NoSuchIndex`] for a name or an index that the model lacks;
    /// [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id or the view belongs to another model.
    #[doc(alias = "mjr_uploadMesh")]
    pub fn update_mesh(&mut self, model: &Model, mesh: impl IntoId<kind::Mesh>) -> Result<(), RenderError> {
        self.check_model(model)?;
        let id = mesh.id_in(model)?;
        let Assets { gpu, shapes, bounds, .. } = &mut self.assets;
        gpu.guarded(|| shapes.update_mesh(gpu, model, id))?;
        *bounds = AssetBounds::new(model);
        Ok(())
    }

    /// Uploads an edited height field, which is selected by name, index, id or view.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage, [`Error::NoSuchName`] or
    /// [`Error::NoSuchIndex`] for a name or an index that the model lacks;
    /// [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id or the view belongs to another model.
    #[doc(alias = "mjr_uploadHField")]
    pub fn update_height_field(
        &mut self,
        model: &Model,
        field: impl IntoId<kind::HeightField>,
    ) -> Result<(), RenderError> {
        self.check_model(model)?;
        let id = field.id_in(model)?;
        let Assets { gpu, shapes, bounds, .. } = &mut self.assets;
        gpu.guarded(|| shapes.update_height_field(gpu, model, id))?;
        bounds.update_height_field(model, id);
        Ok(())
    }

    /// Uploads an edited texture, which is selected by name, index, id or view.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage, [`Error::NoSuchName`] or
    /// [`Error::NoSuchIndex`] for a name or an index that the model lacks;
    /// [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id or the view belongs to another model.
    #[doc(alias = "mjr_uploadTexture")]
    pub fn update_texture(&mut self, model: &Model, texture: impl IntoId<kind::Texture>) -> Result<(), RenderError> {
        self.check_model(model)?;
        let id = texture.id_in(model)?;
        let Assets { gpu, textures, .. } = &mut self.assets;
        gpu.guarded(|| {
            textures.update(gpu, model, id);
            Ok(())
        })
    }

    /// Renders a colour image.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a scene of another model, [`Error::Invalid`] for a scene that was
    /// never updated; [`RenderError::OutOfMemory`] and [`RenderError::Lost`].
    #[doc(alias = "mjr_render")]
    #[doc(alias = "mjr_readPixels")]
    pub fn rgb(&mut self, scene: &Scene) -> Result<RgbImage, RenderError> {
        let mut picture = RgbImage::default();
        self.rgb_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// Renders a colour image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn rgb_into(&mut self, scene: &Scene, picture: &mut RgbImage) -> Result<(), RenderError> {
        self.render_color(scene, rgb_rows(picture, self.size))
    }

    /// Renders a colour image into `rgba`: red, green, blue and 255 for each pixel, row-major from
    /// the upper left.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb), and [`Error::Shape`] unless `rgba` has `4 * width * height`
    /// bytes.
    pub fn rgba_into(&mut self, scene: &Scene, rgba: &mut [u8]) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|length| length as usize);
        Error::check_length("rgba", rgba.len(), 4 * width * height)?;
        let mut rows = rgba.chunks_exact_mut(4 * width);
        self.render_color(scene, |row| {
            for (to, from) in
                rows.next().unwrap_or_default().as_chunks_mut::<4>().0.iter_mut().zip(row.as_chunks::<4>().0)
            {
                *to = [from[0], from[1], from[2], u8::MAX];
            }
        })
    }

    /// Renders a depth image: distances from the plane of the camera, m. Transparent geoms are
    /// skipped. The depth of the background, and of geoms beyond the far plane, is infinite.
    ///
    /// The relative error of a depth is at most 1/3000, which is 1 mm at 3 m, for surfaces at a
    /// viewing angle of 15° or more. The exceptions are round geoms nearer than three times their
    /// radius, whose tessellation is limited to 256 slices.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth(&mut self, scene: &Scene) -> Result<DepthImage, RenderError> {
        let mut picture = DepthImage::default();
        self.depth_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// Renders a depth image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth_into(&mut self, scene: &Scene, picture: &mut DepthImage) -> Result<(), RenderError> {
        self.render_aux(scene, AuxOutput::Depth, depth_rows(picture, self.size))
    }

    /// Renders a segmentation image, which includes transparent geoms.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation(&mut self, scene: &Scene) -> Result<SegmentationImage, RenderError> {
        let mut picture = SegmentationImage::default();
        self.segmentation_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// Renders a segmentation image into an existing image, which is resized.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation_into(&mut self, scene: &Scene, picture: &mut SegmentationImage) -> Result<(), RenderError> {
        self.render_aux(scene, AuxOutput::Ids, id_rows(picture, self.size, scene))
    }

    /// Renders a colour image and passes its rows to `each`: four bytes per pixel.
    fn render_color(&mut self, scene: &Scene, each: impl FnMut(&[u8])) -> Result<(), RenderError> {
        let gpu = self.assets.gpu.clone();
        gpu.guarded(|| {
            let submission = self.submit_color(scene)?;
            self.read_rows(ReadBack::Color, submission, each)
        })
        .inspect_err(|_| self.frame.invalidate())
    }

    /// Renders geom ids and depths, and passes the rows to `each`: eight bytes per pixel.
    fn render_aux(&mut self, scene: &Scene, output: AuxOutput, each: impl FnMut(&[u8])) -> Result<(), RenderError> {
        let gpu = self.assets.gpu.clone();
        gpu.guarded(|| {
            let (submission, _) = self.submit_aux(scene, output)?;
            self.read_rows(ReadBack::Aux, submission, each)
        })
        .inspect_err(|_| self.frame.invalidate())
    }

    /// Renders to a texture of the given size, with one of the formats of window surfaces:
    /// `Bgra8Unorm` or `Rgba8Unorm`. Overwrites the whole texture and submits the commands.
    #[cfg(feature = "viewer")]
    pub(crate) fn draw_to(
        &mut self,
        scene: &Scene,
        target: &wgpu::TextureView,
        size: [u32; 2],
    ) -> Result<(), RenderError> {
        let gpu = self.assets.gpu.clone();
        gpu.guarded(|| {
            let encoder = self.encode(scene, target, target.texture().format(), size, false)?;
            gpu.submit(encoder);
            Ok(())
        })
        .inspect_err(|_| self.frame.invalidate())
    }

    /// Has the images of batches drawn together, or one by one, for tests. By default hardware
    /// draws them together. Returns `false` if the adapter cannot.
    #[doc(hidden)]
    pub fn set_merging(&mut self, merges: bool) -> bool {
        let can_merge = self.assets.gpu.can_merge();
        self.assets.merges = merges && can_merge;
        can_merge
    }

    /// Returns the number of images of batches that were drawn together with others, for tests.
    #[doc(hidden)]
    pub fn images_drawn_together(&self) -> usize {
        self.tiled.iter().map(|images| images.together).sum()
    }

    /// Encodes the commands of [`rgb`](Self::rgb) without submitting them, to measure the time on
    /// the CPU.
    #[doc(hidden)]
    pub fn prepare(&mut self, scene: &Scene) -> Result<(), RenderError> {
        let gpu = self.assets.gpu.clone();
        gpu.guarded(|| {
            let (_, view) = self.color_texture();
            let encoded = self.encode(scene, &view, COLOR_FORMAT, self.size, true);
            self.frame.invalidate();
            encoded.map(drop)
        })
    }

    fn check_model(&self, model: &Model) -> Result<(), RenderError> {
        if model.lineage() == self.assets.lineage {
            Ok(())
        } else {
            Err(Error::OtherModel { what: "the edited model" }.into())
        }
    }
}

/// Returns the size of shadow maps: the requested size, or the size in the model limited by the
/// adapter.
fn shadow_size(gpu: &Gpu, requested: Option<usize>, of_model: usize) -> Result<u32, RenderError> {
    let limit = gpu.limits().max_texture_dimension_2d as usize;
    match requested {
        Some(size) if size > limit => Err(too_large("the size of shadow maps", size, limit)),
        Some(size) => Ok(size as u32),
        None => Ok(of_model.min(limit) as u32),
    }
}

impl fmt::Debug for Renderer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        write!(f, "Renderer: {width} x {height} pixels, {} samples, on {:?}", self.samples, self.assets.gpu)
    }
}

#[cfg(test)]
mod tests {
    use super::{Gpu, Renderer, RendererOptions};
    use crate::data::Data;
    use crate::sample;
    use crate::scene::{Camera, Categories, Scene, SceneOptions};

    /// Returns the numbers of allocated buffers, textures, texture views, bind groups and render
    /// pipelines.
    fn resources(gpu: &Gpu) -> [usize; 5] {
        gpu.wait().unwrap();
        let report = gpu.report().expect("a report of wgpu");
        let hub = report.hub_report();
        [&hub.buffers, &hub.textures, &hub.texture_views, &hub.bind_groups, &hub.render_pipelines]
            .map(|registry| registry.num_allocated)
    }

    #[test]
    fn renderers_and_resizes_leak_no_resources() {
        let gpu = Gpu::new().unwrap();
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 1000).unwrap();
        let mut camera = Camera::free(data.model());
        scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
        let options = RendererOptions::default().with_samples(1).with_shadow_size(64);
        let draw = |count: usize| {
            let mut renderer = Renderer::on(&gpu, data.model(), 8, 8, options).unwrap();
            for frame in 0..count {
                renderer.resize(4 + frame % 7, 4 + frame % 5).unwrap();
                renderer.rgb(&scene).unwrap();
                renderer.depth(&scene).unwrap();
            }
            resources(&gpu)
        };
        draw(1);
        // The pipelines and the round shapes for depth images remain for other renderers.
        let empty = resources(&gpu);
        assert!(empty[4] > 0, "pipelines remain");
        let few = draw(3);
        assert!(few[..4].iter().zip(empty).all(|(few, empty)| *few > empty), "a renderer allocates resources");
        assert_eq!(few[4], empty[4], "the second renderer creates no pipelines");
        assert_eq!(resources(&gpu), empty, "dropping the renderer frees its resources");
        assert_eq!(draw(60), few, "60 frames allocate as many resources as 3");
        assert_eq!(resources(&gpu), empty);
    }
}
