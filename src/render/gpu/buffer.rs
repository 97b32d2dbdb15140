//! GPU buffers: a buffer that grows on demand, and a staging buffer for texture read-back.

use std::slice::ChunksExact;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Length;
use crate::render::{Gpu, RenderError};

/// GPU buffer that is written for every frame, unless its contents stay. It grows by half and never
/// shrinks.
#[derive(Debug)]
pub(crate) struct GrowableBuffer {
    label: &'static str,
    buffer: wgpu::Buffer,
    usage: wgpu::BufferUsages,
    /// Last bytes that were written.
    written: Vec<u8>,
}

impl GrowableBuffer {
    pub(crate) fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self { label, buffer: create_buffer(gpu, label, 256, usage), usage, written: Vec::new() }
    }

    /// Writes the bytes. Returns `true` if the buffer was reallocated, which invalidates its bind
    /// groups.
    pub(crate) fn write(&mut self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, RenderError> {
        let (size, limit) = (bytes.len() as u64, gpu.limits().max_buffer_size);
        if size > limit {
            let what = "the size of a buffer of the scene, bytes,".to_owned();
            return Err(RenderError::TooLarge { what, size, limit });
        }
        let grows = size > self.buffer.size();
        if grows {
            let capacity = (size + size / 2).min(limit).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).min(limit);
            self.buffer = create_buffer(gpu, self.label, capacity.max(size), self.usage);
        }
        if !bytes.is_empty() && (grows || self.written != bytes) {
            gpu.queue().write_buffer(&self.buffer, 0, bytes);
            self.written.clear();
            self.written.extend_from_slice(bytes);
        }
        Ok(grows)
    }

    /// Makes the next call write. Required if a write may not have been executed.
    pub(crate) fn invalidate(&mut self) {
        self.written.clear();
    }

    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

/// Staging buffer to read a texture back.
#[derive(Debug)]
pub(crate) struct ReadBackBuffer {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bytes_per_pixel: u32,
    /// Includes the padding that wgpu requires.
    bytes_per_row: u32,
}

impl ReadBackBuffer {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], bytes_per_pixel: u32) -> Result<Self, RenderError> {
        let bytes_per_row = (size[0] * bytes_per_pixel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let (bytes, limit) = (u64::from(bytes_per_row) * u64::from(size[1]), gpu.limits().max_buffer_size);
        if bytes > limit {
            let what = "the size of the read-back buffer of an image, bytes,".to_owned();
            return Err(RenderError::TooLarge { what, size: bytes, limit });
        }
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let buffer = create_buffer(gpu, "image that is read back", bytes, usage);
        Ok(Self { buffer, size, bytes_per_pixel, bytes_per_row })
    }

    pub(crate) fn matches(&self, size: [u32; 2], bytes_per_pixel: u32) -> bool {
        (self.size, self.bytes_per_pixel) == (size, bytes_per_pixel)
    }

    /// Encodes a copy of a texture of the same size.
    pub(crate) fn encode(&self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) {
        let [width, height] = self.size;
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.bytes_per_row),
                    rows_per_image: Some(height),
                },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }

    /// Waits for the submission with the copy and passes each row to `each`, last row first: images
    /// are rendered upside down.
    pub(crate) fn rows(
        &self,
        gpu: &Gpu,
        submission: wgpu::SubmissionIndex,
        mut each: impl FnMut(&[u8]),
    ) -> Result<(), RenderError> {
        let used = (self.size[0] * self.bytes_per_pixel) as usize;
        self.mapped(gpu, (submission, Length::Short), |rows| rows.rev().for_each(|row| each(&row[..used])))
    }

    /// Waits for the submission with the copy and passes the rows, with their padding, to `read`.
    pub(crate) fn mapped(
        &self,
        gpu: &Gpu,
        submission: (wgpu::SubmissionIndex, Length),
        read: impl FnOnce(ChunksExact<'_, u8>),
    ) -> Result<(), RenderError> {
        read_mapped(gpu, &self.buffer, submission, |bytes| read(bytes.chunks_exact(self.bytes_per_row as usize)))
    }
}

/// Waits for the submission that fills a staging buffer and passes the bytes to `read`.
pub(crate) fn read_mapped(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    submission: (wgpu::SubmissionIndex, Length),
    read: impl FnOnce(&[u8]),
) -> Result<(), RenderError> {
    let slice = buffer.slice(..);
    let is_mapped = Arc::new(AtomicBool::new(false));
    let answered = is_mapped.clone();
    // A failure shows in the mapped range.
    slice.map_async(wgpu::MapMode::Read, move |_| answered.store(true, Ordering::Release));
    let waited = gpu.wait_for(submission, || is_mapped.load(Ordering::Acquire));
    let read = waited.and_then(|()| {
        let mapped = slice.get_mapped_range().map_err(|error| RenderError::Lost { message: error.to_string() })?;
        read(&mapped);
        Ok(())
    });
    // Also after a failed submission, without which the buffer would wait for its content.
    buffer.unmap();
    read
}

pub(crate) fn create_buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let label = Some(label);
    gpu.device().create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::pass::{COLOR_FORMAT, create_texture};

    #[test]
    fn a_buffer_is_usable_after_a_failed_submission() {
        let gpu = Gpu::new().unwrap();
        let buffer = ReadBackBuffer::new(&gpu, [8, 4], 4).unwrap();
        let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = |is_destroyed: bool| {
            let texture = create_texture(&gpu, "image", [8, 4], COLOR_FORMAT, 1, usage);
            let mut rows = 0;
            gpu.guarded(|| {
                let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                buffer.encode(&mut encoder, &texture);
                if is_destroyed {
                    texture.destroy();
                }
                buffer.rows(&gpu, gpu.submit(encoder), |_| rows += 1)
            })
            .map(|()| rows)
        };
        assert_eq!(read(false).unwrap(), 4);
        assert!(read(true).is_err());
        assert_eq!(read(false).unwrap(), 4);
    }
}
