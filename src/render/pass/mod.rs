//! Render passes: shadow maps, the main pass, and auxiliary output; and the draw calls of batches.

mod aux_pass;
mod label;
mod main_pass;
mod pack;
mod pipeline;
mod pipeline_state;
mod screen_pipeline;
mod shadow_atlas;
mod shadow_map;
mod sky;
mod target;
mod tiles;

pub(crate) use self::aux_pass::{AuxLayer, AuxTarget, begin_ids, draw_ids, draw_segment_colors};
pub(crate) use self::label::Labels;
pub(crate) use self::main_pass::{FrameInputs, MainPass, ShadowTextures, ViewInputs, begin_main};
pub(crate) use self::pack::{Pack, PackedImages, Packing};
pub(crate) use self::pipeline::{PassKind, PipelineKey, Pipelines, Wireframe};
pub(crate) use self::screen_pipeline::screen_pipeline;
pub(crate) use self::shadow_atlas::ShadowAtlas;
pub(crate) use self::shadow_map::ShadowMaps;
pub(crate) use self::sky::Sky;
pub(crate) use self::target::{COLOR_FORMAT, Target, check_size, create_texture, default_view, too_large};
pub(crate) use self::tiles::{TileDetail, TileView};
use super::Gpu;
use super::assets::{Shapes, Textures};
use super::draw_list::{Batch, DrawCalls};
use super::shader::TextureKind;
use crate::scene::RenderFlags;

/// Resources of all draw calls.
#[derive(Clone, Copy)]
pub(crate) struct DrawContext<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) calls: &'a DrawCalls,
    /// Buffer with the instances of `calls`.
    pub(crate) instances: &'a wgpu::Buffer,
    /// Views of the images, to select the tiles of large planes; `None` selects all with all cells.
    pub(crate) tiles: Option<&'a [TileView<'a>]>,
}

impl DrawContext<'_> {
    /// Returns the lines to draw. Without support by the adapter, wireframe mode has no effect.
    pub(crate) fn wireframe(&self, flags: RenderFlags) -> Wireframe {
        if flags.contains(RenderFlags::WIREFRAME) && self.gpu.has(wgpu::Features::POLYGON_MODE_LINE) {
            Wireframe::Triangles
        } else {
            Wireframe::Off
        }
    }

    /// Draws a batch with the pipeline of its key.
    pub(crate) fn batch(&self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, key: &PipelineKey) {
        let shape = self.shapes.buffers(batch.key.shape);
        if shape.index_count == 0 {
            return;
        }
        // Passes without textures override the texture of the batch.
        let texture_kind =
            if key.texture_kind == TextureKind::None { TextureKind::None } else { batch.key.texture_kind };
        let wireframe = match key.wireframe {
            Wireframe::Triangles if shape.has_quads && key.pass_kind != PassKind::Shadow => Wireframe::Quads,
            wireframe => wireframe,
        };
        let key =
            PipelineKey { texture_kind, line: batch.key.line, back_faces: batch.key.back_faces, wireframe, ..*key };
        pass.set_pipeline(&self.gpu.pipelines().get(self.gpu, key));
        if texture_kind != TextureKind::None
            && let Some(texture) = self.textures.get(batch.key.texture)
        {
            pass.set_bind_group(1, texture, &[]);
        }
        pass.set_vertex_buffer(0, shape.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(shape.indices.slice(..), wgpu::IndexFormat::Uint32);
        match self.tiles {
            Some(views) if !shape.tiles.is_empty() => {
                for (ranges, instances) in tiles::draws(views, &shape.tiles, self.calls, batch.instances.clone()) {
                    for range in ranges {
                        pass.draw_indexed(range, 0, instances.clone());
                    }
                }
            }
            _ => {
                let front_faces = shape.front_faces.clone().filter(|_| key.draws_front_faces());
                pass.draw_indexed(front_faces.unwrap_or(shape.cells()), 0, batch.instances.clone());
            }
        }
    }
}
