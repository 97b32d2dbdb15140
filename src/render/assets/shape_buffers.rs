//! Vertex and index buffer of a shape.

use std::ops::Range;

use wgpu::util::DeviceExt;

use crate::render::{Gpu, RenderError};
use crate::shape::{self, Triangles, Vertex};

/// Vertex and index buffer of a shape.
#[derive(Debug)]
pub(crate) struct ShapeBuffers {
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    /// Number of indices; 0 for an empty shape.
    pub(crate) index_count: u32,
    /// Indices of the triangles that face the camera of the frame, if they are known.
    pub(crate) front_faces: Option<Range<u32>>,
    /// The triangles form quadrilaterals, and the vertices have parities.
    pub(crate) has_quads: bool,
    /// Tiles of a large plane, for culling; empty for other shapes.
    pub(crate) tiles: Vec<Tile>,
}

/// Rectangular part of a plane, culled separately and with its own level of detail.
#[derive(Debug, Clone)]
pub(crate) struct Tile {
    /// Indices of all cells.
    pub(crate) cells: Range<u32>,
    /// Indices of fewer triangles, each of which is in a block of cells; see [`shape::blocks`].
    pub(crate) blocks: Range<u32>,
    /// Largest width and height of a block, in the local frame of the shape.
    pub(crate) block: [f32; 2],
    /// Minimum and maximum of x and y, in the local frame of the shape.
    pub(crate) bounds: [[f32; 2]; 2],
}

impl ShapeBuffers {
    /// Returns the indices of all triangles at the full level of detail.
    pub(crate) fn cells(&self) -> Range<u32> {
        0..self.tiles.last().map_or(self.index_count, |tile| tile.cells.end)
    }

    pub(super) fn new(gpu: &Gpu, triangles: &Triangles) -> Result<Self, RenderError> {
        let Triangles { vertices, indices, has_quads } = triangles;
        let buffers = Self::with_usage(gpu, bytemuck::cast_slice(vertices), indices, wgpu::BufferUsages::empty())?;
        Ok(Self { has_quads: *has_quads, ..buffers })
    }

    /// Creates buffers whose vertices are written later, as are the indices of selected triangles,
    /// which follow the indices of all triangles.
    pub(super) fn dynamic(gpu: &Gpu, vertices: usize, indices: &[u32]) -> Result<Self, RenderError> {
        let zeros = vec![0; vertices * size_of::<Vertex>()];
        let buffers = Self::with_usage(gpu, &zeros, &[indices; 2].concat(), wgpu::BufferUsages::COPY_DST)?;
        Ok(Self { index_count: indices.len() as u32, ..buffers })
    }

    fn with_usage(gpu: &Gpu, vertices: &[u8], indices: &[u32], usage: wgpu::BufferUsages) -> Result<Self, RenderError> {
        let limit = gpu.limits().max_buffer_size;
        let size = (vertices.len() as u64).max(size_of_val(indices) as u64);
        if size > limit {
            let what = "the size of the vertex or index buffer of a shape, bytes,".to_owned();
            return Err(RenderError::TooLarge { what, size, limit });
        }
        let buffer = |label, contents, usage| {
            let label = Some(label);
            gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage })
        };
        Ok(Self {
            vertices: buffer("vertices of a shape", vertices, wgpu::BufferUsages::VERTEX | usage),
            indices: buffer("indices of a shape", bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX | usage),
            index_count: indices.len() as u32,
            front_faces: None,
            has_quads: false,
            tiles: Vec::new(),
        })
    }

    /// Creates the square from -1 to 1 with these grid lines in x and y, divided into tiles if it
    /// has many cells.
    pub(super) fn tiled(gpu: &Gpu, lines: [&[f32]; 2]) -> Result<Self, RenderError> {
        /// Cells along each edge of a tile.
        const TILE_CELLS: usize = 10;
        let mut square = shape::plane_with_lines(lines);
        let mut tiles = Vec::new();
        let mut blocks = Vec::new();
        let cells = lines.map(|lines| lines.len() - 1);
        if cells.iter().any(|&cells| cells > TILE_CELLS) {
            let rows = std::mem::take(&mut square.indices);
            let block = lines.map(shape::longest_block);
            let ranges = |cells: usize| {
                (0..cells).step_by(TILE_CELLS).map(move |first| (first, (first + TILE_CELLS).min(cells)))
            };
            for (bottom, top) in ranges(cells[1]) {
                for (left, right) in ranges(cells[0]) {
                    let first = square.indices.len() as u32;
                    for row in bottom..top {
                        // Six indices per cell, row by row.
                        let range = [left, right].map(|column| 6 * (row * cells[0] + column));
                        square.indices.extend_from_slice(&rows[range[0]..range[1]]);
                    }
                    let bounds = [[lines[0][left], lines[1][bottom]], [lines[0][right], lines[1][top]]];
                    let cells = first..square.indices.len() as u32;
                    blocks.push(shape::blocks(left..right, bottom..top, lines[0].len()));
                    tiles.push(Tile { blocks: cells.clone(), cells, block, bounds });
                }
            }
            for (tile, blocks) in tiles.iter_mut().zip(blocks) {
                let Some(blocks) = blocks else { continue };
                let first = square.indices.len() as u32;
                square.indices.extend(blocks);
                tile.blocks = first..square.indices.len() as u32;
            }
        }
        Ok(Self { tiles, ..Self::new(gpu, &square)? })
    }
}
