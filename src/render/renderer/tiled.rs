//! Rendering of several images to the tiles of one texture: one main pass, one submission and one
//! read-back for all of them.

use super::assets::Assets;
use super::encode::{color_texture, command_encoder, matching_target};
use super::frame::{Frame, TargetNeeds};
use super::layout::Tiles;
use super::merged::Merged;
use crate::render::draw_list::AuxOutput;
use crate::render::gpu::Length;
use crate::render::gpu::buffer::ReadBackBuffer;
use crate::render::pass::{
    AuxLayer, AuxTarget, COLOR_FORMAT, Pack, PackedImages, Packing, Target, begin_ids, begin_main,
};
use crate::render::{Gpu, RenderError};
use crate::scene::{Scene, SceneGeomType};

/// Number of texels of shadow maps from which a submission takes no further image, to limit the
/// memory.
const MAX_SHADOW_TEXELS: u64 = 1 << 24;

/// Number of images from which a submission takes so long that a thread can sleep meanwhile.
const LONG: usize = 8;

/// Frames of the images of a submission, and its render targets.
#[derive(Default)]
pub(super) struct TiledImages {
    frames: Vec<Frame>,
    /// Resources to draw the images together.
    merged: Option<Box<Merged>>,
    /// Number of prepared frames, whose images have not been submitted.
    pending: usize,
    /// Properties of the render target of the pending frames.
    needs: Option<TargetNeeds>,
    target: Option<Target>,
    color: Option<(wgpu::Texture, wgpu::TextureView)>,
    aux_target: Option<AuxTarget>,
    read_back: Option<ReadBackBuffer>,
    /// One of each packing.
    packs: [Option<Pack>; Packing::COUNT],
    submitted: Option<Submitted>,
    /// Number of images that were drawn together with others so far.
    pub(super) together: usize,
}

/// Images that have been submitted and not been read.
struct Submitted {
    submission: wgpu::SubmissionIndex,
    images: usize,
    content: Content,
}

/// Content of the buffer that is read back.
enum Content {
    /// The texture, whose pixels have this number of bytes.
    Texture { bytes_per_pixel: usize },
    /// The numbers of the images.
    Packed(Packing),
}

/// Bytes of an image.
pub(super) enum ImageBytes<'a> {
    /// Rows of pixels of the texture, from the upper left.
    Rows(&'a mut dyn Iterator<Item = &'a [u8]>),
    /// The numbers of the image.
    Packed(&'a [u8]),
}

/// Receives the next image.
type Read<'r> = dyn FnMut(ImageBytes<'_>) + 'r;

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
        self.merged.iter_mut().for_each(|merged| merged.invalidate());
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
        frame.prepare(assets, scene, tiles.tile, aux, true)?;
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
        let Self { frames, merged, pending, needs, target, color, aux_target, read_back, packs, submitted, together } =
            self;
        let (gpu, size) = (&assets.gpu, tiles.size());
        let Some(needs) = *needs else { return Ok(()) };
        let frames = &mut frames[..*pending];
        let shadow_size = frames.first().map_or(0, |frame| frame.shadow_maps.size());
        let mut merged = (frames.len() > 1 && assets.merges)
            .then(|| merged.get_or_insert_with(|| Box::new(Merged::new(gpu, shadow_size))));
        if let Some(resources) = &mut merged
            && !resources.prepare(assets, frames, tiles)?
        {
            merged = None;
        }
        if merged.is_some() {
            *together += frames.len();
        } else {
            frames.iter_mut().try_for_each(|frame| frame.upload(assets))?;
        }
        let mut encoder = command_encoder(gpu);
        let (texture, bytes_per_pixel) = if aux.is_none() {
            let (texture, view) = color_texture(gpu, color, size);
            let target = matching_target(gpu, target, size, COLOR_FORMAT, needs)?;
            if let Some(merged) = merged {
                merged.encode_shadows(&mut encoder, assets, frames);
                merged.draw_color(&mut begin_main(&mut encoder, target, &view), assets, frames, tiles, target);
            } else {
                for frame in &mut *frames {
                    frame.encode_shadows(&mut encoder, assets);
                }
                let mut pass = begin_main(&mut encoder, target, &view);
                for (index, frame) in frames.iter_mut().enumerate() {
                    tiles.select(&mut pass, index);
                    frame.draw_color(&mut pass, assets, target);
                }
            }
            (texture, 4)
        } else {
            let existing = aux_target.take().filter(|target| target.size() == size);
            let target = aux_target.insert(existing.unwrap_or_else(|| AuxTarget::new(gpu, size)));
            let mut pass = begin_ids(&mut encoder, target, AuxLayer::Only);
            if let Some(merged) = merged {
                merged.draw_ids(&mut pass, assets, frames);
            } else {
                for (index, frame) in frames.iter().enumerate() {
                    tiles.select(&mut pass, index);
                    frame.draw_ids(&mut pass, assets, AuxLayer::Only);
                }
            }
            drop(pass);
            (target.texture.clone(), 8)
        };
        // A single image may need more workgroups than an adapter has in one dimension.
        let content = if let Some(packing) = packing(aux).filter(|_| assets.merges && tiles.count > 1) {
            let images = PackedImages { size: tiles.tile, columns: tiles.columns, count: tiles.count };
            let pack = &mut packs[packing as usize];
            let existing = pack.take().filter(|pack| pack.matches(packing, images, &texture));
            pack.insert(existing.unwrap_or_else(|| Pack::new(gpu, packing, images, &texture))).encode(&mut encoder);
            Content::Packed(packing)
        } else {
            let existing = read_back.take().filter(|buffer| buffer.matches(size, bytes_per_pixel));
            let buffer = match existing {
                Some(buffer) => buffer,
                None => ReadBackBuffer::new(gpu, size, bytes_per_pixel)?,
            };
            read_back.insert(buffer).encode(&mut encoder, &texture);
            Content::Texture { bytes_per_pixel: bytes_per_pixel as usize }
        };
        *submitted = Some(Submitted { submission: gpu.submit(encoder), images: std::mem::take(pending), content });
        Ok(())
    }

    /// Waits for the submitted images, if there are any, and passes them to `read`.
    pub(super) fn finish(&mut self, gpu: &Gpu, tiles: &Tiles, read: &mut Read<'_>) -> Result<(), RenderError> {
        let Some(Submitted { submission, images, content }) = self.submitted.take() else { return Ok(()) };
        let [width, height] = tiles.tile.map(|length| length as usize);
        let submission = (submission, if images < LONG { Length::Short } else { Length::Long });
        match (content, &self.read_back) {
            (Content::Texture { bytes_per_pixel }, Some(buffer)) => buffer.mapped(gpu, submission, |rows| {
                for index in 0..images {
                    let [x, y] = tiles.origin(index).map(|place| place as usize);
                    let columns = x * bytes_per_pixel..(x + width) * bytes_per_pixel;
                    // Images are rendered upside down.
                    let mut rows = rows.clone().skip(y).take(height).rev().map(|row| &row[columns.clone()]);
                    read(ImageBytes::Rows(&mut rows));
                }
            }),
            (Content::Packed(packing), _) => {
                let Some(pack) = &self.packs[packing as usize] else { return Ok(()) };
                pack.mapped(gpu, submission, |bytes| {
                    let image = width * height * packing.bytes_per_pixel() as usize;
                    bytes.chunks_exact(image).take(images).for_each(|bytes| read(ImageBytes::Packed(bytes)));
                })
            }
            (Content::Texture { .. }, None) => Ok(()),
        }
    }
}

/// Returns the numbers of an image with this auxiliary output, or of colours.
fn packing(aux: Option<AuxOutput>) -> Option<Packing> {
    match aux {
        None => Some(Packing::Rgb),
        Some(AuxOutput::Ids) => Some(Packing::Ids),
        Some(AuxOutput::Depth) => Some(Packing::Depths),
        Some(_) => None,
    }
}
