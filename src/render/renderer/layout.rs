//! Layout of the images of a submission in one texture.

use super::assets::Assets;
use crate::render::GpuKind;
use crate::render::view::Place;

/// Largest number of images in a submission to a software rasteriser that are not drawn together.
/// With 16, depth images took longer than with single calls.
const MAX_IMAGES_SOFTWARE: usize = 4;

/// Largest number of images in any other submission.
const MAX_IMAGES: usize = 64;

/// Largest number of pixels in a submission, unless one image has more.
const MAX_PIXELS: usize = 1 << 19;

/// Layout of the tiles in the texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles {
    /// Width and height of a tile, pixels.
    pub(super) tile: [u32; 2],
    pub(super) columns: u32,
    /// Number of tiles.
    pub(super) count: u32,
}

impl Tiles {
    /// Computes the layout for a number of images.
    pub(super) fn new(assets: &Assets, tile: [u32; 2], images: usize) -> Self {
        let gpu = &assets.gpu;
        let pixels = tile[0] as usize * tile[1] as usize;
        let is_slow = gpu.kind() == GpuKind::Software && !assets.merges;
        let most = if is_slow { MAX_IMAGES_SOFTWARE } else { MAX_IMAGES };
        let count = images.min(most).min(MAX_PIXELS / pixels).max(1) as u32;
        let [most_columns, most_rows] = tile.map(|length| (gpu.limits().max_texture_dimension_2d / length).max(1));
        let columns = (f64::from(count).sqrt().ceil() as u32).min(most_columns);
        Self { tile, columns, count: count.min(columns.saturating_mul(most_rows)) }
    }

    /// Returns the width and height of the texture, pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.columns * self.tile[0], self.count.div_ceil(self.columns) * self.tile[1]]
    }

    /// Returns the first pixel of a tile.
    pub(super) fn origin(&self, index: usize) -> [u32; 2] {
        let index = index as u32;
        [index % self.columns * self.tile[0], index / self.columns * self.tile[1]]
    }

    /// Returns the place of a tile in the texture.
    pub(super) fn place(&self, index: usize) -> Place {
        Place::new(self.origin(index), self.tile, self.size())
    }

    /// Limits a pass to a tile.
    pub(super) fn select(&self, pass: &mut wgpu::RenderPass<'_>, index: usize) {
        let ([x, y], [width, height]) = (self.origin(index), self.tile);
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(x, y, width, height);
    }
}
