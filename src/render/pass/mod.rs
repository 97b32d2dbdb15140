//! Render passes: shadow maps, the main pass, and auxiliary output; and the draw calls of batches.

mod aux_pass;
mod label;
mod main_pass;
mod pipeline;
mod pipeline_state;
mod screen_pipeline;
mod shadow_map;
mod sky;
mod target;

use std::ops::Range;

pub(crate) use self::aux_pass::{AuxLayer, AuxTarget, begin_ids, draw_ids, draw_segment_colors};
pub(crate) use self::label::Labels;
pub(crate) use self::main_pass::{FrameInputs, MainPass, begin_main};
pub(crate) use self::pipeline::{PassKind, PipelineKey, Pipelines};
pub(crate) use self::screen_pipeline::screen_pipeline;
pub(crate) use self::shadow_map::ShadowMaps;
pub(crate) use self::sky::Sky;
pub(crate) use self::target::{COLOR_FORMAT, Target, check_size, create_texture, default_view};
use super::Gpu;
use super::assets::{Shapes, Textures, Tile};
use super::bounding_volume::signed_distance;
use super::draw_list::{Batch, Instance};
use super::shader::TextureKind;

/// Resources of all draw calls.
#[derive(Clone, Copy)]
pub(crate) struct DrawContext<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) instances: &'a wgpu::Buffer,
    /// Frustum planes and instances to cull the tiles of large planes; `None` disables tile culling.
    pub(crate) tile_culling: Option<(&'a [[f32; 4]; 6], &'a [Instance])>,
}

impl DrawContext<'_> {
    /// Draws a batch with the pipeline of its key.
    pub(crate) fn batch(&self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, key: &PipelineKey) {
        let shape = self.shapes.buffers(batch.key.shape);
        if shape.index_count == 0 {
            return;
        }
        // Passes without textures override the texture of the batch.
        let texture_kind =
            if key.texture_kind == TextureKind::None { TextureKind::None } else { batch.key.texture_kind };
        let key = PipelineKey { texture_kind, line: batch.key.line, back_faces: batch.key.back_faces, ..*key };
        pass.set_pipeline(&self.gpu.pipelines().get(self.gpu, key));
        if texture_kind != TextureKind::None
            && let Some(texture) = self.textures.get(batch.key.texture)
        {
            pass.set_bind_group(1, texture, &[]);
        }
        pass.set_vertex_buffer(0, shape.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(shape.indices.slice(..), wgpu::IndexFormat::Uint32);
        match self.tile_culling {
            Some((planes, instances)) if !shape.tiles.is_empty() && batch.instances.len() == 1 => {
                let instance = &instances[batch.instances.start as usize];
                for range in visible_ranges(&shape.tiles, planes, instance) {
                    pass.draw_indexed(range, 0, batch.instances.clone());
                }
            }
            _ => pass.draw_indexed(0..shape.index_count, 0, batch.instances.clone()),
        }
    }
}

/// Returns the index ranges of the tiles inside the frustum, with adjacent ranges merged.
fn visible_ranges(tiles: &[Tile], planes: &[[f32; 4]; 6], instance: &Instance) -> Vec<Range<u32>> {
    let is_outside = |tile: &Tile| {
        let [low, high] = tile.bounds;
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]]
            .map(|[x, y]| instance.rows.map(|row| row[0] * x + row[1] * y + row[3]));
        planes.iter().any(|plane| corners.iter().all(|&corner| signed_distance(corner, plane) < 0.0))
    };
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for tile in tiles.iter().filter(|tile| !is_outside(tile)) {
        match ranges.last_mut() {
            Some(last) if last.end == tile.indices.start => last.end = tile.indices.end,
            _ => ranges.push(tile.indices.clone()),
        }
    }
    ranges
}
