//! Read-back of images: buffers of a renderer, and conversion of their rows.

use super::Renderer;
use crate::render::gpu::buffer::ReadBackBuffer;
use crate::render::{DepthImage, RenderError, RgbImage, SegmentationImage};
use crate::scene::Scene;

/// Read-back buffers of a renderer. Each has the size of the images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadBack {
    /// Colours, four bytes per pixel.
    Color,
    /// Geom ids and depths, eight bytes per pixel.
    Aux,
    /// Geom ids and depths of the opaque geoms.
    Opaque,
}

impl ReadBack {
    /// Number of buffers.
    pub const COUNT: usize = 3;

    fn bytes_per_pixel(self) -> u32 {
        match self {
            Self::Color => 4,
            Self::Aux | Self::Opaque => 8,
        }
    }
}

impl Renderer {
    /// Returns a read-back buffer, which is recreated after a change of the size.
    pub(super) fn read_back_buffer(&mut self, wanted: ReadBack) -> Result<&ReadBackBuffer, RenderError> {
        let buffer = &mut self.read_back[wanted as usize];
        if !buffer.as_ref().is_some_and(|buffer| buffer.matches(self.size, wanted.bytes_per_pixel())) {
            *buffer = Some(ReadBackBuffer::new(&self.assets.gpu, self.size, wanted.bytes_per_pixel())?);
        }
        buffer.as_ref().ok_or(RenderError::OutOfMemory)
    }

    /// Waits for the submission with the copy to a read-back buffer, and passes the rows to `each`,
    /// first row first.
    pub(super) fn read_rows(
        &mut self,
        from: ReadBack,
        submission: wgpu::SubmissionIndex,
        each: impl FnMut(&[u8]),
    ) -> Result<(), RenderError> {
        let gpu = self.assets.gpu.clone();
        self.read_back_buffer(from)?.rows(&gpu, submission, each)
    }
}

/// Returns a function that writes the next row of an image, which has this size.
pub(super) fn rgb_rows(picture: &mut RgbImage, size: [u32; 2]) -> impl FnMut(&[u8]) {
    let [width, height] = size.map(|length| length as usize);
    let mut rows = picture.resize(width, height).chunks_exact_mut(3 * width);
    move |row| drop_alpha(row, rows.next().unwrap_or_default())
}

/// Copies the red, green and blue of pixels with alpha, in words of two pixels.
pub(super) fn drop_alpha(rgba: &[u8], rgb: &mut [u8]) {
    let (two_rgba, last_rgba) = rgba.as_chunks::<8>();
    let (two_rgb, last_rgb) = rgb.as_chunks_mut::<6>();
    for (to, from) in two_rgb.iter_mut().zip(two_rgba) {
        let from = u64::from_le_bytes(*from);
        let pixels = from & 0xFF_FFFF | from >> 8 & 0xFFFF_FF00_0000;
        to.copy_from_slice(&pixels.to_le_bytes()[..6]);
    }
    for (to, from) in last_rgb.as_chunks_mut::<3>().0.iter_mut().zip(last_rgba.as_chunks::<4>().0) {
        *to = [from[0], from[1], from[2]];
    }
}

/// Returns a function that writes the next row of an image, which has this size.
pub(super) fn depth_rows(picture: &mut DepthImage, size: [u32; 2]) -> impl FnMut(&[u8]) {
    let [width, height] = size.map(|length| length as usize);
    let mut rows = picture.resize(width, height).chunks_exact_mut(width);
    move |row| {
        for (to, from) in rows.next().unwrap_or_default().iter_mut().zip(row.as_chunks::<8>().0) {
            let [id, depth]: [u32; 2] = bytemuck::pod_read_unaligned(from);
            *to = if id == 0 { f32::INFINITY } else { f32::from_bits(depth) };
        }
    }
}

/// Returns a function that writes the next row of an image of a scene, which has this size.
pub(super) fn id_rows(picture: &mut SegmentationImage, size: [u32; 2], scene: &Scene) -> impl FnMut(&[u8]) {
    let [width, height] = size.map(|length| length as usize);
    let mut rows = picture.resize(width, height, scene).chunks_exact_mut(width);
    move |row| {
        for (to, from) in rows.next().unwrap_or_default().iter_mut().zip(row.as_chunks::<8>().0) {
            let [id, _]: [u32; 2] = bytemuck::pod_read_unaligned(from);
            *to = id;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::drop_alpha;

    #[test]
    fn every_pixel_keeps_its_red_green_and_blue() {
        for pixels in 0..11 {
            let rgba: Vec<u8> = (0..4 * pixels).map(|index| (17 * index + 3) as u8).collect();
            let mut rgb = vec![0; 3 * pixels];
            drop_alpha(&rgba, &mut rgb);
            let expected: Vec<u8> = rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
            assert_eq!(rgb, expected);
        }
    }
}
