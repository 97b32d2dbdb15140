//! Pictures, from the graphics card's memory to ours.

use super::{Gpu, RenderError};

/// Memory that a texture is copied to, to be read.
#[derive(Debug)]
pub(crate) struct ReadBack {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    /// Bytes of a pixel, and of a row with what fills it up.
    pixel: u32,
    row: u32,
}

impl ReadBack {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], pixel: u32) -> Result<Self, RenderError> {
        let row = (size[0] * pixel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let (bytes, limit) = (u64::from(row) * u64::from(size[1]), gpu.limits().max_buffer_size);
        if bytes > limit {
            return Err(RenderError::TooLarge {
                what: "the memory of a picture, bytes,".to_owned(),
                size: bytes,
                limit,
            });
        }
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Ok(Self { buffer, size, pixel, row })
    }

    pub(crate) fn is(&self, size: [u32; 2], pixel: u32) -> bool {
        (self.size, self.pixel) == (size, pixel)
    }

    /// Copies a texture of the size.
    pub(crate) fn encode(&self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) {
        let [width, height] = self.size;
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.row),
                    rows_per_image: Some(height),
                },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }

    /// Waits for the copy, and shows each row of it from the last to the first: pictures are drawn upside down.
    pub(crate) fn rows(&self, gpu: &Gpu, mut each: impl FnMut(&[u8])) -> Result<(), RenderError> {
        let slice = self.buffer.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        gpu.wait()?;
        let mapped = slice.get_mapped_range().map_err(|error| RenderError::Lost { message: error.to_string() })?;
        let used = (self.size[0] * self.pixel) as usize;
        for row in mapped.chunks_exact(self.row as usize).rev() {
            each(&row[..used]);
        }
        drop(mapped);
        self.buffer.unmap();
        Ok(())
    }
}
