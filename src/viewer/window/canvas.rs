//! The picture of the scene: the renderer of the model that is shown.

use crate::render::{Gpu, Picture, RenderError, Renderer, RendererOptions};
use crate::viewer::event::Asset;
use crate::viewer::snapshot::Snapshot;

/// What a window is cleared with while there is nothing to be seen.
const EMPTY: wgpu::Color = wgpu::Color { r: 0.1, g: 0.11, b: 0.13, a: 1.0 };

/// A renderer for the model of the moment.
#[derive(Default)]
pub(super) struct Canvas {
    renderer: Option<(u64, Renderer)>,
    picture: Picture,
}

impl Canvas {
    /// Forgets what belongs to an adapter.
    pub fn clear(&mut self) {
        self.renderer = None;
    }

    fn renderer(
        &mut self,
        gpu: &Gpu,
        snapshot: &Snapshot,
        [width, height]: [u32; 2],
    ) -> Result<&mut Renderer, RenderError> {
        let kept = self.renderer.take().filter(|(generation, _)| *generation == snapshot.generation);
        let renderer = match kept {
            Some((_, renderer)) => renderer,
            None => Renderer::on(gpu, &snapshot.model, width, height, &RendererOptions::default())?,
        };
        Ok(&mut self.renderer.insert((snapshot.generation, renderer)).1)
    }

    /// Takes over what the program has changed of the model. A renderer that is made later has it anyway.
    pub fn update(&mut self, snapshot: &Snapshot, asset: Asset) -> Result<(), RenderError> {
        let Some((generation, renderer)) = &mut self.renderer else { return Ok(()) };
        if *generation != snapshot.generation {
            return Ok(());
        }
        match asset {
            Asset::Texture(id) => renderer.update_texture(&snapshot.model, id),
            Asset::Mesh(id) => renderer.update_mesh(&snapshot.model, id),
            Asset::HeightField(id) => renderer.update_height_field(&snapshot.model, id),
        }
    }

    /// Draws a snapshot to the window.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        snapshot: &Snapshot,
        to: &wgpu::TextureView,
        size: [u32; 2],
    ) -> Result<(), RenderError> {
        self.renderer(gpu, snapshot, size)?.draw_to(&snapshot.scene, to, size)
    }

    /// What a window shows before there is something to be shown.
    pub fn draw_nothing(gpu: &Gpu, to: &wgpu::TextureView) {
        let mut encoder =
            gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("nothing") });
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("nothing"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: to,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(EMPTY), store: wgpu::StoreOp::Store },
            })],
            ..wgpu::RenderPassDescriptor::default()
        }));
        gpu.queue().submit([encoder.finish()]);
    }

    /// A picture of a snapshot, without the panels.
    pub fn picture(&mut self, gpu: &Gpu, snapshot: &Snapshot, size: [u32; 2]) -> Result<&Picture, RenderError> {
        // Its memory is used again: a recording takes many.
        let mut picture = std::mem::take(&mut self.picture);
        let renderer = self.renderer(gpu, snapshot, size)?;
        if renderer.size() != size {
            renderer.resize(size[0], size[1])?;
        }
        let drawn = renderer.rgb_into(&snapshot.scene, &mut picture);
        self.picture = picture;
        drawn.map(|()| &self.picture)
    }
}
