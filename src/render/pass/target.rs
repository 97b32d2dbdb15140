//! Render targets.

use crate::render::{Gpu, RenderError};

/// Format of colour images that are read back.
pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Depth buffer and multisampled colour buffer that accompany a colour texture.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) size: [u32; 2],
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) samples: u32,
    /// The depth buffer has a stencil component.
    pub(crate) stencil: bool,
    /// Multisampled colour buffer; `None` without multisampling.
    pub(crate) multisampled: Option<wgpu::TextureView>,
    pub(crate) depth: wgpu::TextureView,
}

impl Target {
    pub(crate) fn new(
        gpu: &Gpu,
        size: [u32; 2],
        format: wgpu::TextureFormat,
        samples: u32,
        stencil: bool,
    ) -> Result<Self, RenderError> {
        check_size(gpu, size.map(|length| length as usize))?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let multisampled = (samples > 1)
            .then(|| default_view(&create_texture(gpu, "samples of an image", size, format, samples, usage)));
        let depth =
            default_view(&create_texture(gpu, "depths of an image", size, depth_format(gpu, stencil), samples, usage));
        Ok(Self { size, format, samples, stencil, multisampled, depth })
    }

    pub(crate) fn matches(&self, size: [u32; 2], format: wgpu::TextureFormat, samples: u32, stencil: bool) -> bool {
        (self.size, self.format, self.samples, self.stencil) == (size, format, samples, stencil)
    }
}

/// Returns the format of the depth buffer.
pub(crate) fn depth_format(gpu: &Gpu, stencil: bool) -> wgpu::TextureFormat {
    if stencil { gpu.stencil_format() } else { wgpu::TextureFormat::Depth32Float }
}

/// Returns an error for an empty image or an image that exceeds the limits of the adapter.
/// Converts the size of any other image.
pub(crate) fn check_size(gpu: &Gpu, [width, height]: [usize; 2]) -> Result<[u32; 2], RenderError> {
    let limit = gpu.limits().max_texture_dimension_2d as usize;
    for (what, length) in [("the width of an image", width), ("the height of an image", height)] {
        if length == 0 {
            return Err(crate::error::Error::out_of_range(what, "0 pixels", "at least one pixel").into());
        }
        if length > limit {
            return Err(too_large(what, length, limit));
        }
    }
    Ok([width, height].map(|length| length as u32))
}

/// Returns the error about a length in pixels that exceeds a limit of the adapter.
pub(crate) fn too_large(what: &str, length: usize, limit: usize) -> RenderError {
    RenderError::TooLarge { what: format!("{what}, pixels,"), size: length as u64, limit: limit as u64 }
}

/// Creates a 2D texture without mip maps. Errors of wgpu and graphics debuggers show the label.
pub(crate) fn create_texture(
    gpu: &Gpu,
    label: &'static str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    samples: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

pub(crate) fn default_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
