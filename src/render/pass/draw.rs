//! Batches, drawn.

use super::{Key, Pipelines};
use crate::render::Gpu;
use std::ops::Range;

use crate::render::content::{Shapes, Textures, Tile};
use crate::render::list::{Batch, Instance};
use crate::render::shader::Coat;

/// What every batch is drawn with.
pub(crate) struct Draw<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pipelines: &'a mut Pipelines,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) instances: &'a wgpu::Buffer,
    /// What is in sight, and the instances, to leave out the pieces of large planes that are not.
    pub(crate) sight: Option<(&'a [[f32; 4]; 6], &'a [Instance])>,
}

impl Draw<'_> {
    /// Draws a batch, with the pipeline that its kind needs.
    pub(crate) fn batch(&mut self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, key: &Key) {
        let surface = self.shapes.surface(batch.kind.shape);
        if surface.count == 0 {
            return;
        }
        // A picture that only colours have.
        let coat = if key.coat == Coat::Plain { key.coat } else { batch.kind.coat };
        let key = Key { coat, line: batch.kind.line, back: batch.kind.back, ..*key };
        pass.set_pipeline(self.pipelines.get(self.gpu, key));
        if coat != Coat::Plain
            && let Some(picture) = self.textures.get(batch.kind.texture)
        {
            pass.set_bind_group(1, picture, &[]);
        }
        pass.set_vertex_buffer(0, surface.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(surface.indices.slice(..), wgpu::IndexFormat::Uint32);
        let tiles = &surface.tiles;
        match self.sight {
            Some((planes, instances)) if !tiles.is_empty() && batch.instances.len() == 1 => {
                let instance = &instances[batch.instances.start as usize];
                for range in seen(tiles, planes, instance) {
                    pass.draw_indexed(range, 0, batch.instances.clone());
                }
            }
            _ => pass.draw_indexed(0..surface.count, 0, batch.instances.clone()),
        }
    }
}

/// The tiles of a plane that are in sight; neighbours are joined.
fn seen(tiles: &[Tile], planes: &[[f32; 4]; 6], instance: &Instance) -> Vec<Range<u32>> {
    let is_hidden = |tile: &Tile| {
        let [low, high] = tile.corners;
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]]
            .map(|[x, y]| instance.rows.map(|row| row[0] * x + row[1] * y + row[3]));
        planes
            .iter()
            .any(|plane| corners.iter().all(|[x, y, z]| plane[0] * x + plane[1] * y + plane[2] * z + plane[3] < 0.0))
    };
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for tile in tiles.iter().filter(|tile| !is_hidden(tile)) {
        match ranges.last_mut() {
            Some(last) if last.end == tile.indices.start => last.end = tile.indices.end,
            _ => ranges.push(tile.indices.clone()),
        }
    }
    ranges
}
