//! Rendering of several images to the tiles of one texture: one main pass, one submission and one
//! read-back for all of them.

use super::assets::Assets;
use super::encode::{color_texture, command_encoder, matching_target};
use super::frame::{Frame, TargetNeeds};
use crate::render::draw_list::AuxOutput;
use crate::render::gpu::buffer::ReadBackBuffer;
use crate::render::pass::{AuxLayer, AuxTarget, COLOR_FORMAT, Target, begin_ids, begin_main};
use crate::render::{Gpu, GpuKind, RenderError};
use crate::scene::{Scene, SceneGeomType};

/// Largest number of images in a submission to a software rasteriser. With 16, depth images took
/// longer than with single calls.
const MAX_IMAGES_SOFTWARE: usize = 4;

/// Largest number of images in a submission to hardware.
const MAX_IMAGES_HARDWARE: usize = 64;

/// Largest number of pixels in a submission, unless one image has more.
const MAX_PIXELS: usize = 1 << 19;

/// Number of texels of shadow maps from which a submission takes no further image, to limit the
/// memory.
const MAX_SHADOW_TEXELS: u64 = 1 << 24;

/// Layout of the tiles in the texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles {
    /// Width and height of a tile, pixels.
    tile: [u32; 2],
    columns: u32,
    count: u32,
}

impl Tiles {
    /// Computes the layout for a number of images.
    pub(super) fn new(gpu: &Gpu, tile: [u32; 2], images: usize) -> Self {
        let pixels = tile[0] as usize * tile[1] as usize;
        let most = if gpu.kind() == GpuKind::Software { MAX_IMAGES_SOFTWARE } else { MAX_IMAGES_HARDWARE };
        let count = images.min(most).min(MAX_PIXELS / pixels).max(1) as u32;
        let [most_columns, most_rows] = tile.map(|length| (gpu.limits().max_texture_dimension_2d / length).max(1));
        let columns = (f64::from(count).sqrt().ceil() as u32).min(most_columns);
        Self { tile, columns, count: count.min(columns.saturating_mul(most_rows)) }
    }

    /// Returns the width and height of the texture, pixels.
    fn size(&self) -> [u32; 2] {
        [self.columns * self.tile[0], self.count.div_ceil(self.columns) * self.tile[1]]
    }

    /// Returns the first pixel of a tile.
    fn origin(&self, index: usize) -> [u32; 2] {
        let index = index as u32;
        [index % self.columns * self.tile[0], index / self.columns * self.tile[1]]
    }

    /// Limits a pass to a tile.
    fn select(&self, pass: &mut wgpu::RenderPass<'_>, index: usize) {
        let ([x, y], [width, height]) = (self.origin(index), self.tile);
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(x, y, width, height);
    }
}

/// Frames of the images of a submission, and its render targets.
#[derive(Default)]
pub(super) struct TiledImages {
    frames: Vec<Frame>,
    /// Number of prepared frames, whose images have not been submitted.
    pending: usize,
    /// Properties of the render target of the pending frames.
    needs: Option<TargetNeeds>,
    target: Option<Target>,
    color: Option<(wgpu::Texture, wgpu::TextureView)>,
    aux_target: Option<AuxTarget>,
    read_back: Option<ReadBackBuffer>,
    submitted: Option<Submitted>,
}

/// Images that have been submitted and not been read.
struct Submitted {
    submission: wgpu::SubmissionIndex,
    images: usize,
    bytes_per_pixel: usize,
}

/// Receives the rows of the next image, from the upper left.
type Read<'r> = dyn FnMut(&mut dyn Iterator<Item = &[u8]>) + 'r;

impl TiledImages {
    /// Discards the images of a call that has failed.
    pub(super) fn discard(&mut self) {
        let (pending, submitted) = (std::mem::take(&mut self.pending), self.submitted.take());
        if pending > 0 || submitted.is_some() {
            self.invalidate();
        }
    }

    /// Makes the next preparations upload everything. Required if commands may not have been
    /// executed.
    pub(super) fn invalidate(&mut self) {
        self.frames.iter_mut().for_each(Frame::invalidate);
    }

    /// Prepares the image of a scene. Returns `false`, and leaves the images as they were, if it
    /// needs another render target than the pending images.
    pub(super) fn add(
        &mut self,
        assets: &mut Assets,
        scene: &Scene,
        tiles: &Tiles,
        (aux, samples, shadow_size): (Option<AuxOutput>, u32, u32),
    ) -> Result<bool, RenderError> {
        if self.frames.len() == self.pending {
            self.frames.push(Frame::new(&assets.gpu, shadow_size));
        }
        let frame = &mut self.frames[self.pending];
        match aux {
            None => frame.prepare_color(assets, scene, tiles.tile, true)?,
            Some(_) => frame.prepare_aux(assets, scene, tiles.tile, aux, true)?,
        }
        let needs = Some(frame.target_needs(samples));
        if self.pending > 0 && needs != self.needs {
            return Ok(false);
        }
        self.needs = needs;
        self.pending += 1;
        Ok(true)
    }

    /// Returns `true` if the pending images must be submitted before the next one is prepared.
    pub(super) fn is_full(&self, tiles: &Tiles, scene: &Scene) -> bool {
        let texels: u64 = self.frames[..self.pending].iter().map(Frame::shadow_texels).sum();
        // The vertices of skins and flexes are in buffers that all images share.
        let is_deformed = |geom_type| matches!(geom_type, SceneGeomType::Skin | SceneGeomType::Flex);
        self.pending == tiles.count as usize
            || texels >= MAX_SHADOW_TEXELS
            || scene.geoms().any(|geom| is_deformed(geom.geom_type()))
    }

    /// Submits the commands that render the pending images and copy them to the read-back buffer.
    pub(super) fn submit(&mut self, assets: &Assets, tiles: &Tiles, aux: Option<AuxOutput>) -> Result<(), RenderError> {
        let Self { frames, pending, needs, target, color, aux_target, read_back, submitted } = self;
        let (gpu, size) = (&assets.gpu, tiles.size());
        let Some(needs) = *needs else { return Ok(()) };
        let frames = &mut frames[..*pending];
        let mut encoder = command_encoder(gpu);
        let (texture, bytes_per_pixel) = if aux.is_none() {
            let (texture, view) = color_texture(gpu, color, size);
            let target = matching_target(gpu, target, size, COLOR_FORMAT, needs)?;
            for frame in frames.iter_mut() {
                frame.encode_shadows(&mut encoder, assets);
            }
            let mut pass = begin_main(&mut encoder, target, &view);
            for (index, frame) in frames.iter_mut().enumerate() {
                tiles.select(&mut pass, index);
                frame.draw_color(&mut pass, assets, target);
            }
            (texture, 4)
        } else {
            let existing = aux_target.take().filter(|target| target.size() == size);
            let target = aux_target.insert(existing.unwrap_or_else(|| AuxTarget::new(gpu, size)));
            let mut pass = begin_ids(&mut encoder, target, AuxLayer::Only);
            for (index, frame) in frames.iter().enumerate() {
                tiles.select(&mut pass, index);
                frame.draw_ids(&mut pass, assets, AuxLayer::Only);
            }
            (target.texture.clone(), 8)
        };
        let existing = read_back.take().filter(|buffer| buffer.matches(size, bytes_per_pixel));
        let buffer = match existing {
            Some(buffer) => buffer,
            None => ReadBackBuffer::new(gpu, size, bytes_per_pixel)?,
        };
        read_back.insert(buffer).encode(&mut encoder, &texture);
        let (images, bytes_per_pixel) = (std::mem::take(pending), bytes_per_pixel as usize);
        *submitted = Some(Submitted { submission: gpu.submit(encoder), images, bytes_per_pixel });
        Ok(())
    }

    /// Waits for the submitted images, if there are any, and passes them to `read`.
    pub(super) fn finish(&mut self, gpu: &Gpu, tiles: &Tiles, read: &mut Read<'_>) -> Result<(), RenderError> {
        let (Some(submitted), Some(buffer)) = (self.submitted.take(), &self.read_back) else { return Ok(()) };
        let Submitted { submission, images, bytes_per_pixel } = submitted;
        let [width, height] = tiles.tile.map(|length| length as usize);
        buffer.mapped(gpu, submission, |rows| {
            for index in 0..images {
                let [x, y] = tiles.origin(index).map(|place| place as usize);
                let columns = x * bytes_per_pixel..(x + width) * bytes_per_pixel;
                // Images are rendered upside down.
                read(&mut rows.clone().skip(y).take(height).rev().map(|row| &row[columns.clone()]));
            }
        })
    }
}
