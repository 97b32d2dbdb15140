//! The textures that are drawn to.

use crate::render::{Gpu, RenderError};

/// The format of colours that are read back.
pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A texture that is drawn to, and what is beside it: depths, and the samples of its pixels.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) size: [u32; 2],
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) samples: u32,
    /// Whether there are stencils beside the depths.
    pub(crate) stencil: bool,
    /// Where the samples are, if there are several.
    pub(crate) many: Option<wgpu::TextureView>,
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
        check_size(gpu, size)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let many = (samples > 1).then(|| view(&texture(gpu, size, format, samples, usage)));
        let depth = view(&texture(gpu, size, depth_format(stencil), samples, usage));
        Ok(Self { size, format, samples, stencil, many, depth })
    }

    /// Whether it is such a one.
    pub(crate) fn is(&self, size: [u32; 2], format: wgpu::TextureFormat, samples: u32, stencil: bool) -> bool {
        (self.size, self.format, self.samples, self.stencil) == (size, format, samples, stencil)
    }
}

/// The format of depths.
pub(crate) fn depth_format(stencil: bool) -> wgpu::TextureFormat {
    if stencil { wgpu::TextureFormat::Depth24PlusStencil8 } else { wgpu::TextureFormat::Depth32Float }
}

/// Refuses a picture without pixels, or with too many.
pub(crate) fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), RenderError> {
    let limit = gpu.limits().max_texture_dimension_2d;
    for (what, length) in [("the width of a picture", width), ("the height of a picture", height)] {
        if length == 0 {
            return Err(crate::Error::invalid(what, "0 pixels", "at least one pixel").into());
        }
        if length > limit {
            let what = format!("{what}, pixels,");
            return Err(RenderError::TooLarge { what, size: length.into(), limit: limit.into() });
        }
    }
    Ok(())
}

pub(crate) fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    samples: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

pub(crate) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
