//! Buffers that grow.

use crate::render::{Gpu, RenderError};

/// Memory of the graphics card that is written anew for each picture. It grows by half, and does not shrink.
#[derive(Debug)]
pub(crate) struct Memory {
    buffer: wgpu::Buffer,
    usage: wgpu::BufferUsages,
}

impl Memory {
    pub(crate) fn new(gpu: &Gpu, usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self { buffer: buffer(gpu, 256, usage), usage }
    }

    /// Writes it, and tells whether it is another buffer than before.
    pub(crate) fn write(&mut self, gpu: &Gpu, bytes: &[u8]) -> Result<bool, RenderError> {
        let (size, limit) = (bytes.len() as u64, gpu.limits().max_buffer_size);
        if size > limit {
            return Err(RenderError::TooLarge {
                what: "the memory of a scene's geoms, bytes,".to_owned(),
                size,
                limit,
            });
        }
        let grows = size > self.buffer.size();
        if grows {
            let room = (size + size / 2).min(limit).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).min(limit);
            self.buffer = buffer(gpu, room.max(size), self.usage);
        }
        if !bytes.is_empty() {
            gpu.queue().write_buffer(&self.buffer, 0, bytes);
        }
        Ok(grows)
    }

    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

fn buffer(gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device().create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}
