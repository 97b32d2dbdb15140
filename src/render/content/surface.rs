//! One shape, kept by the graphics card.

use wgpu::util::DeviceExt;

use crate::render::shape::{Triangles, Vertex};
use crate::render::{Gpu, RenderError};

/// Corners and triangles, kept by the graphics card. Nothing is drawn of one without triangles.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) count: u32,
}

impl Surface {
    pub(crate) fn new(gpu: &Gpu, triangles: &Triangles) -> Result<Self, RenderError> {
        Self::of(gpu, bytemuck::cast_slice(&triangles.vertices), &triangles.indices, wgpu::BufferUsages::VERTEX)
    }

    /// One of which the corners are written later, and again.
    pub(crate) fn moving(gpu: &Gpu, vertices: usize, indices: &[u32]) -> Result<Self, RenderError> {
        let zeros = vec![0; vertices * size_of::<Vertex>()];
        Self::of(gpu, &zeros, indices, wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST)
    }

    fn of(gpu: &Gpu, vertices: &[u8], indices: &[u32], usage: wgpu::BufferUsages) -> Result<Self, RenderError> {
        let limit = gpu.limits().max_buffer_size;
        let size = (vertices.len() as u64).max(size_of_val(indices) as u64);
        if size > limit {
            return Err(RenderError::TooLarge { what: "the memory of a shape, bytes,".to_owned(), size, limit });
        }
        let buffer = |contents, usage| {
            gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        Ok(Self {
            vertices: buffer(vertices, usage),
            indices: buffer(bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX),
            count: indices.len() as u32,
        })
    }
}
