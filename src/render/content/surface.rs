//! One shape, kept by the graphics card.

use std::ops::Range;

use wgpu::util::DeviceExt;

use crate::render::shape::{Triangles, Vertex, plane};
use crate::render::{Gpu, RenderError};

/// Corners and triangles, kept by the graphics card. Nothing is drawn of one without triangles.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) count: u32,
    /// The pieces of a large plane. None for others, which are drawn whole.
    pub(crate) tiles: Vec<Tile>,
}

/// A piece of a plane: those that are out of sight are not drawn.
#[derive(Debug, Clone)]
pub(crate) struct Tile {
    pub(crate) indices: Range<u32>,
    /// Its lowest and its highest corner, in the frame of the shape.
    pub(crate) corners: [[f32; 2]; 2],
}

/// So many cells along each edge of a tile.
const TILE: u32 = 20;

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
            tiles: Vec::new(),
        })
    }

    /// The square from -1 to 1 of so many cells along each edge, in tiles if there are many.
    pub(crate) fn tiled(gpu: &Gpu, cells: u32) -> Result<Self, RenderError> {
        let mut square = plane(cells);
        let mut tiles = Vec::new();
        if cells > TILE {
            let rows = std::mem::take(&mut square.indices);
            let coordinate = |cell: u32| 2.0 * cell as f32 / cells as f32 - 1.0;
            let steps = || (0..cells).step_by(TILE as usize).map(|first| (first, (first + TILE).min(cells)));
            for ((bottom, top), (left, right)) in steps().flat_map(|rows| steps().map(move |columns| (rows, columns))) {
                let first = square.indices.len() as u32;
                for row in bottom..top {
                    // Six corners for each cell, row by row.
                    let range = [left, right].map(|column| 6 * (row * cells + column) as usize);
                    square.indices.extend_from_slice(&rows[range[0]..range[1]]);
                }
                let corners = [[coordinate(left), coordinate(bottom)], [coordinate(right), coordinate(top)]];
                tiles.push(Tile { indices: first..square.indices.len() as u32, corners });
            }
        }
        Ok(Self { tiles, ..Self::new(gpu, &square)? })
    }
}
