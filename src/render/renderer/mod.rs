//! Draws scenes of one model.

mod draw;

use std::fmt;

use super::bound::Bounds;
use super::content::{Shapes, Textures};
use super::list::{List, Numbers};
use super::pass::{COLOR, Ids, Labels, Memory, Pipelines, Scenes, Shadows, Sky, Target, check_size};
use super::read_back::ReadBack;
use super::settings::Settings;
use super::{DepthPicture, Gpu, Picture, RenderError, RendererOptions, SegmentationPicture};
use crate::error::Error;
use crate::id::{HeightFieldId, Lineage, MeshId, TextureId};
use crate::model::Model;
use crate::scene::Scene;

/// Draws scenes of one model, without a window.
///
/// It keeps the model's meshes, textures and visual settings as they were when it was made: see [`update_mesh`](Self::update_mesh).
/// It may be sent to another thread, and many may draw at once with one [`Gpu`].
///
/// ```no_run
/// use mujoco_safe::render::Renderer;
/// use mujoco_safe::scene::{Camera, Categories, Scene, SceneOptions};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let mut scene = Scene::new(data.model(), 1000)?;
/// let mut camera = Camera::free(data.model());
/// scene.update_camera(&data, &mut camera)?;
/// scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all())?;
///
/// let mut renderer = Renderer::new(data.model(), 640, 480)?;
/// renderer.rgb(&scene)?.save_png("humanoid.png")?;
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
#[doc(alias = "mjrContext")]
pub struct Renderer {
    gpu: Gpu,
    lineage: Lineage,
    settings: Settings,
    options: RendererOptions,
    samples: u32,
    size: [u32; 2],
    bounds: Bounds,
    shapes: Shapes,
    textures: Textures,
    pipelines: Pipelines,
    list: List,
    instances: Memory,
    scenes: Scenes,
    shadows: Shadows,
    sky: Sky,
    labels: Labels,
    /// What a picture of numbers is drawn from.
    numbers: Memory,
    numbers_group: Option<wgpu::BindGroup>,
    target: Option<Target>,
    color: Option<(wgpu::Texture, wgpu::TextureView)>,
    ids: Option<Ids>,
    read_back: Option<ReadBack>,
}

impl Renderer {
    /// Draws pictures of so many pixels, with the best graphics adapter that there is.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if there is none; [`RenderError::TooLarge`] if the picture, or a mesh or a texture of the model,
    /// is larger than it can take; [`RenderError::OutOfMemory`]. [`Error::Invalid`] for a picture without pixels.
    #[doc(alias = "mjr_makeContext")]
    pub fn new(model: &Model, width: u32, height: u32) -> Result<Self, RenderError> {
        Self::with_options(model, width, height, &RendererOptions::default())
    }

    /// As [`new`](Self::new), with options.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn with_options(
        model: &Model,
        width: u32,
        height: u32,
        options: &RendererOptions,
    ) -> Result<Self, RenderError> {
        Self::on(&Gpu::new()?, model, width, height, options)
    }

    /// As [`with_options`](Self::with_options), on an adapter that other renderers may use too.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn on(
        gpu: &Gpu,
        model: &Model,
        width: u32,
        height: u32,
        options: &RendererOptions,
    ) -> Result<Self, RenderError> {
        let size = [width, height];
        gpu.guarded(|| {
            check_size(gpu, size)?;
            let quality = model.visual().quality;
            let settings = Settings::new(model);
            let samples = options.samples.unwrap_or(quality.offsamples.min(8) as u32);
            let shadows = shadow_size(gpu, options.shadow_size, quality.shadowsize)?;
            let pipelines = Pipelines::new(gpu);
            Ok(Self {
                gpu: gpu.clone(),
                lineage: model.lineage(),
                options: *options,
                samples: gpu.samples(samples),
                size,
                bounds: Bounds::new(model),
                shapes: Shapes::new(gpu, model, &settings, options.lighting)?,
                textures: Textures::new(gpu, &pipelines.layouts, model),
                settings,
                pipelines,
                list: List::default(),
                instances: Memory::new(gpu, wgpu::BufferUsages::VERTEX),
                scenes: Scenes::new(gpu),
                shadows: Shadows::new(shadows),
                sky: Sky::new(gpu)?,
                labels: Labels::new(gpu),
                numbers: Memory::new(gpu, wgpu::BufferUsages::UNIFORM),
                numbers_group: None,
                target: None,
                color: None,
                ids: None,
                read_back: None,
            })
        })
    }

    /// Width and height of its pictures, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The adapter that it draws with.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// How it draws. The number of samples and the size of shadow maps may be others, if the adapter has not what was asked for.
    pub fn options(&self) -> &RendererOptions {
        &self.options
    }

    /// Changes the size of its pictures.
    ///
    /// # Errors
    ///
    /// [`RenderError::TooLarge`] for more pixels than the adapter can take, [`Error::Invalid`] for none. The size is as it was then.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), RenderError> {
        check_size(&self.gpu, [width, height])?;
        self.size = [width, height];
        Ok(())
    }

    /// Takes over a mesh that was edited.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage; [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mjr_uploadMesh")]
    pub fn update_mesh(&mut self, model: &Model, id: MeshId) -> Result<(), RenderError> {
        self.check_model(model)?;
        model.check_id(id);
        let Self { gpu, shapes, bounds, .. } = self;
        gpu.guarded(|| shapes.update_mesh(gpu, model, id))?;
        *bounds = Bounds::new(model);
        Ok(())
    }

    /// Takes over a height field that was edited.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage; [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mjr_uploadHField")]
    pub fn update_height_field(&mut self, model: &Model, id: HeightFieldId) -> Result<(), RenderError> {
        self.check_model(model)?;
        model.check_id(id);
        let Self { gpu, shapes, bounds, .. } = self;
        gpu.guarded(|| shapes.update_height_field(gpu, model, id))?;
        bounds.update_height_field(model, id);
        Ok(())
    }

    /// Takes over a texture that was edited.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model of another lineage; [`RenderError::OutOfMemory`].
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mjr_uploadTexture")]
    pub fn update_texture(&mut self, model: &Model, id: TextureId) -> Result<(), RenderError> {
        self.check_model(model)?;
        model.check_id(id);
        let Self { gpu, textures, .. } = self;
        gpu.guarded(|| {
            textures.update(gpu, model, id);
            Ok(())
        })
    }

    /// The colours of a scene.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a scene of another model, [`Error::Invalid`] for one that was not updated;
    /// [`RenderError::OutOfMemory`] and [`RenderError::Lost`].
    #[doc(alias = "mjr_render")]
    #[doc(alias = "mjr_readPixels")]
    pub fn rgb(&mut self, scene: &Scene) -> Result<Picture, RenderError> {
        let mut picture = Picture::default();
        self.rgb_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// As [`rgb`](Self::rgb), into a picture that there is, which is given the size.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn rgb_into(&mut self, scene: &Scene, picture: &mut Picture) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|length| length as usize);
        let mut rows = picture.resize(width, height).chunks_exact_mut(3 * width);
        self.colors(scene, |row| {
            let rgb = rows.next().unwrap_or_default().as_chunks_mut::<3>().0;
            for (to, from) in rgb.iter_mut().zip(row.as_chunks::<4>().0) {
                *to = [from[0], from[1], from[2]];
            }
        })
    }

    /// Red, green, blue and 255 for each pixel from the upper left, row by row, into `rgba`.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb), and [`Error::Shape`] unless there are `4 * width * height` bytes.
    pub fn rgba_into(&mut self, scene: &Scene, rgba: &mut [u8]) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|length| length as usize);
        Error::check_length("rgba", rgba.len(), 4 * width * height)?;
        let mut rows = rgba.chunks_exact_mut(4 * width);
        self.colors(scene, |row| {
            for (to, from) in
                rows.next().unwrap_or_default().as_chunks_mut::<4>().0.iter_mut().zip(row.as_chunks::<4>().0)
            {
                *to = [from[0], from[1], from[2], u8::MAX];
            }
        })
    }

    /// The depths of a scene, m: how far what is seen is from the plane through the eye. What is transparent has none, and so has
    /// what is beyond the far side of the frustum: infinity.
    ///
    /// A depth is right within 1/3000 of it, 1 mm at 3 m, where a surface is seen under 15° or more. The exceptions are round geoms
    /// that are nearer than three times their radius, which are cut into 256 slices at most.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth(&mut self, scene: &Scene) -> Result<DepthPicture, RenderError> {
        let mut picture = DepthPicture::default();
        self.depth_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// As [`depth`](Self::depth), into a picture that there is, which is given the size.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn depth_into(&mut self, scene: &Scene, picture: &mut DepthPicture) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|length| length as usize);
        let mut rows = picture.resize(width, height).chunks_exact_mut(width);
        self.ids(scene, Numbers::Depths, |row| {
            for (to, from) in rows.next().unwrap_or_default().iter_mut().zip(row.as_chunks::<8>().0) {
                let [number, depth]: [u32; 2] = bytemuck::pod_read_unaligned(from);
                *to = if number == 0 { f32::INFINITY } else { f32::from_bits(depth) };
            }
        })
    }

    /// Which geom is seen where. What is transparent is seen too.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation(&mut self, scene: &Scene) -> Result<SegmentationPicture, RenderError> {
        let mut picture = SegmentationPicture::default();
        self.segmentation_into(scene, &mut picture)?;
        Ok(picture)
    }

    /// As [`segmentation`](Self::segmentation), into a picture that there is, which is given the size.
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb).
    pub fn segmentation_into(&mut self, scene: &Scene, picture: &mut SegmentationPicture) -> Result<(), RenderError> {
        let [width, height] = self.size.map(|length| length as usize);
        let mut rows = picture.resize(width, height, scene).chunks_exact_mut(width);
        self.ids(scene, Numbers::Ids, |row| {
            for (to, from) in rows.next().unwrap_or_default().iter_mut().zip(row.as_chunks::<8>().0) {
                let [number, _]: [u32; 2] = bytemuck::pod_read_unaligned(from);
                *to = number;
            }
        })
    }

    /// Draws to a texture of the size and of one of the formats of a window's surface: `Bgra8Unorm` or `Rgba8Unorm`. Everything
    /// in it is overwritten. The commands are submitted.
    #[cfg(feature = "viewer")]
    pub(crate) fn draw_to(
        &mut self,
        scene: &Scene,
        target: &wgpu::TextureView,
        size: [u32; 2],
    ) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| {
            let encoder = self.encode(scene, target, target.texture().format(), size, false)?;
            gpu.queue().submit([encoder.finish()]);
            Ok(())
        })
        .inspect_err(|_| self.shadows.forget())
    }

    /// Does what the processor does for [`rgb`](Self::rgb), and has nothing drawn: for measurements.
    #[doc(hidden)]
    pub fn prepare(&mut self, scene: &Scene) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        gpu.guarded(|| {
            let (_, view) = self.color();
            let encoded = self.encode(scene, &view, COLOR, self.size, true);
            self.shadows.forget();
            encoded.map(drop)
        })
    }

    fn check_model(&self, model: &Model) -> Result<(), RenderError> {
        if model.lineage() == self.lineage {
            Ok(())
        } else {
            Err(Error::OtherModel { what: "the edited model" }.into())
        }
    }
}

/// The size of shadow maps: what was asked for, or what the model has if the adapter can take that.
fn shadow_size(gpu: &Gpu, asked: Option<u32>, of_model: usize) -> Result<u32, RenderError> {
    let limit = gpu.limits().max_texture_dimension_2d;
    match asked {
        Some(size) if size > limit => {
            let what = "the size of shadow maps, pixels,".to_owned();
            Err(RenderError::TooLarge { what, size: size.into(), limit: limit.into() })
        }
        Some(size) => Ok(size),
        None => Ok(of_model.min(limit as usize) as u32),
    }
}

impl fmt::Debug for Renderer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        write!(f, "Renderer: {width} x {height} pixels, {} samples, on {:?}", self.samples, self.gpu)
    }
}
