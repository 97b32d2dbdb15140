//! Batches, drawn.

use super::{Key, Pipelines};
use crate::render::Gpu;
use crate::render::content::{Shapes, Textures};
use crate::render::list::Batch;

/// What every batch is drawn with.
pub(crate) struct Draw<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pipelines: &'a mut Pipelines,
    pub(crate) shapes: &'a Shapes,
    pub(crate) textures: &'a Textures,
    pub(crate) instances: &'a wgpu::Buffer,
}

impl Draw<'_> {
    /// Draws a batch, with the pipeline that its kind needs.
    pub(crate) fn batch(&mut self, pass: &mut wgpu::RenderPass<'_>, batch: &Batch, key: &Key) {
        let surface = self.shapes.surface(batch.kind.shape);
        if surface.count == 0 {
            return;
        }
        // A picture that only colours have.
        let coat = if key.coat == crate::render::shader::Coat::Plain { key.coat } else { batch.kind.coat };
        let key = Key { coat, line: batch.kind.line, back: batch.kind.back, ..*key };
        pass.set_pipeline(self.pipelines.get(self.gpu, key));
        if coat != crate::render::shader::Coat::Plain
            && let Some(picture) = self.textures.get(batch.kind.texture)
        {
            pass.set_bind_group(1, picture, &[]);
        }
        pass.set_vertex_buffer(0, surface.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(surface.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..surface.count, 0, batch.instances.clone());
    }
}
