//! Images of many simulations, several per submission.

use std::sync::Arc;

use super::Renderer;
use super::assets::Assets;
use super::layout::Tiles;
use super::read_back::drop_alpha;
use super::tiled::{ImageBytes, TiledImages};
use crate::error::{Error, Result};
use crate::render::RenderError;
use crate::render::draw_list::AuxOutput;
use crate::scene::Scene;

impl Renderer {
    /// Renders a colour image of each of many simulations, several per submission, into one array
    /// `(image, height, width, 3)`, row-major from the upper left. The number of images follows
    /// from the length of `rgb`.
    ///
    /// `update` is called for each image, in order, and updates the scene to the simulation of this
    /// index. The scene initially is the scene of the previous image.
    ///
    /// The images equal the results of [`rgb`](Self::rgb) up to rounding, which can change single
    /// pixels at edges.
    ///
    /// With a graphics card and Vulkan or Metal, up to 64 images are drawn together while the next
    /// ones are prepared: opaque geoms of the same shape, texture and visibility share a draw call,
    /// and the card converts the images to the array. Cameras, lights, colours and additional geoms
    /// may differ from image to image. Images are drawn one by one if they have skins or flexes or
    /// are wireframes or images of segments, if their shadow maps are too large for one texture,
    /// and if one of the 64 has labels or differs from the others in the number or the types of its
    /// lights, the lights with shadows, the flags for effects, or in having a mirror. The guide has
    /// [figures](crate::guide::performance#rendering).
    ///
    /// With a software rasteriser, rasterising dominates the cost, and a submission for several
    /// images saves nothing: the images take about as much processor time as with single calls, 0.8
    /// to 1.2 of it at 84 × 84 and 64 × 64 pixels. The benchmark `render`, argument `batch`, prints
    /// the ratio. Fewer samples and smaller shadow maps save more
    /// ([`RendererOptions`](crate::render::RendererOptions)).
    ///
    /// # Errors
    ///
    /// As for [`rgb`](Self::rgb), [`Error::Shape`] unless `rgb` has a multiple of
    /// `3 * width * height` bytes, and the errors of `update`.
    ///
    /// ```no_run
    /// use mujoco_safe::render::Renderer;
    /// use mujoco_safe::scene::{Camera, Categories, SceneOptions};
    /// use mujoco_safe::{Batch, Data, sample};
    ///
    /// let batch = Batch::new(sample::humanoid(), 256)?;
    /// let mut data = Data::new(batch.model())?;
    /// let mut camera = Camera::fixed(batch.model(), "side")?;
    /// let mut renderer = Renderer::new(batch.model(), 84, 84)?;
    /// let mut rgb = vec![0; batch.len() * 84 * 84 * 3];
    /// let options = SceneOptions::default();
    /// renderer.rgb_batch_into(
    ///     |index, scene| {
    ///         batch.load(index, &mut data)?;
    ///         data.kinematics()?;
    ///         data.com_pos()?;
    ///         data.camlight()?;
    ///         scene.update(&mut data, &options, None, &mut camera, Categories::all())
    ///     },
    ///     &mut rgb,
    /// )?;
    /// # Ok::<(), mujoco_safe::render::RenderError>(())
    /// ```
    #[doc(alias = "batch_render")]
    pub fn rgb_batch_into(
        &mut self,
        update: impl FnMut(usize, &mut Scene) -> Result<()>,
        rgb: &mut [u8],
    ) -> Result<(), RenderError> {
        self.batch_into(None, update, ("rgb", 3), rgb, drop_alpha)
    }

    /// Renders a depth image of each of many simulations, as
    /// [`rgb_batch_into`](Self::rgb_batch_into) does for colours, into one array
    /// `(image, height, width)`, m. See [`depth`](Self::depth).
    ///
    /// # Errors
    ///
    /// As for [`rgb_batch_into`](Self::rgb_batch_into), for a multiple of `width * height` numbers.
    pub fn depth_batch_into(
        &mut self,
        update: impl FnMut(usize, &mut Scene) -> Result<()>,
        metres: &mut [f32],
    ) -> Result<(), RenderError> {
        self.batch_into(Some(AuxOutput::Depth), update, ("metres", 1), metres, |row, out| {
            for (to, from) in out.iter_mut().zip(row.as_chunks::<8>().0) {
                let [id, depth]: [u32; 2] = bytemuck::pod_read_unaligned(from);
                *to = if id == 0 { f32::INFINITY } else { f32::from_bits(depth) };
            }
        })
    }

    /// Renders a segmentation image of each of many simulations, as
    /// [`rgb_batch_into`](Self::rgb_batch_into) does for colours, into one array
    /// `(image, height, width)`: 0 for the background, or the index of the visible geom in its
    /// scene plus 1. The geoms of a model come first in each scene and have the same indices in all
    /// scenes with equal [`SceneOptions`](crate::scene::SceneOptions).
    ///
    /// # Errors
    ///
    /// As for [`rgb_batch_into`](Self::rgb_batch_into), for a multiple of `width * height` numbers.
    pub fn segmentation_batch_into(
        &mut self,
        update: impl FnMut(usize, &mut Scene) -> Result<()>,
        ids: &mut [u32],
    ) -> Result<(), RenderError> {
        self.batch_into(Some(AuxOutput::Ids), update, ("ids", 1), ids, |row, out| {
            for (to, from) in out.iter_mut().zip(row.as_chunks::<8>().0) {
                let [id, _]: [u32; 2] = bytemuck::pod_read_unaligned(from);
                *to = id;
            }
        })
    }

    /// Renders images of many simulations. `convert` converts a row of the texture to a row of the
    /// array, which has `channels` numbers per pixel. `aux` is `None` for colours.
    fn batch_into<T: bytemuck::Pod>(
        &mut self,
        aux: Option<AuxOutput>,
        mut update: impl FnMut(usize, &mut Scene) -> Result<()>,
        (name, channels): (&'static str, usize),
        array: &mut [T],
        convert: impl Fn(&[u8], &mut [T]),
    ) -> Result<(), RenderError> {
        let Self { assets, tiled, snapshot_scene, size, samples, shadow_size, .. } = self;
        let [width, height] = size.map(|length| length as usize);
        let (row, image) = (channels * width, channels * width * height);
        let count = array.len() / image;
        Error::check_length(name, array.len(), count * image)?;
        let scene = Arc::get_mut(snapshot_scene).expect("Bug: the scene of snapshots is shared");
        let gpu = assets.gpu.clone();
        let tiles = Tiles::new(assets, *size, count);
        let mut images = array.chunks_exact_mut(image);
        let mut read = |bytes: ImageBytes<'_>| {
            let image = images.next().unwrap_or_default();
            match bytes {
                ImageBytes::Rows(rows) => {
                    rows.zip(image.chunks_exact_mut(row)).for_each(|(from, to)| convert(from, to));
                }
                ImageBytes::Packed(bytes) => bytemuck::cast_slice_mut(image).copy_from_slice(bytes),
            }
        };
        // While the images of one submission are rendered, the next ones are prepared.
        let [next, previous] = tiled.each_mut();
        next.discard();
        previous.discard();
        let mut submit = |assets: &Assets, next: &mut TiledImages, previous: &mut TiledImages| {
            next.submit(assets, &tiles, aux)?;
            previous.finish(&gpu, &tiles, &mut read)?;
            std::mem::swap(next, previous);
            Ok::<(), RenderError>(())
        };
        for index in 0..count {
            update(index, scene)?;
            gpu.guarded(|| {
                let inputs = (aux, *samples, *shadow_size);
                if !next.add(assets, scene, &tiles, inputs)? {
                    submit(assets, next, previous)?;
                    next.add(assets, scene, &tiles, inputs)?;
                }
                if next.is_full(&tiles, scene) || index + 1 == count {
                    submit(assets, next, previous)?;
                }
                Ok(())
            })
            // Textures and buffers may be invalid, for example for lack of memory.
            .inspect_err(|_| (*next, *previous) = Default::default())?;
        }
        gpu.guarded(|| previous.finish(&gpu, &tiles, &mut read))
    }
}
