//! An adapter that can draw to a window.

#![allow(clippy::trivially_copy_pass_by_ref, reason = "there will be more options")]

use super::open::{choose, descriptor, no_adapter, open, quietly};
use super::{Gpu, GpuOptions};
use crate::render::RenderError;

impl Gpu {
    /// An adapter that can draw to a window, and the window's surface. An `Arc` of the window is a target.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if there is none that can, [`RenderError::Open`] if its driver refuses.
    pub(crate) fn for_window<W>(window: &W, options: &GpuOptions) -> Result<(Self, wgpu::Surface<'static>), RenderError>
    where
        W: Clone + Into<wgpu::SurfaceTarget<'static>>,
    {
        quietly(|| {
            let mut found = Vec::new();
            for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::GL] {
                let instance = wgpu::Instance::new(descriptor(backends));
                let Ok(surface) = instance.create_surface(window.clone()) else { continue };
                if let Some(adapter) = choose(&instance, options, Some(&surface), &mut found) {
                    return Ok((open(instance, adapter)?, surface));
                }
            }
            Err(no_adapter(options, &found))
        })
    }

    /// The surface of another window, to be drawn to with this adapter.
    ///
    /// # Errors
    ///
    /// [`RenderError::Refused`] if the adapter cannot draw to this window.
    pub(crate) fn surface(
        &self,
        window: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<wgpu::Surface<'static>, RenderError> {
        let refused = |message: String| RenderError::Refused { message };
        let Some(origin) = &self.shared.origin else {
            return Err(refused("the caller's own device makes no windows".to_owned()));
        };
        let surface = origin.instance.create_surface(window).map_err(|error| refused(error.to_string()))?;
        if origin.adapter.is_surface_supported(&surface) {
            Ok(surface)
        } else {
            Err(refused(format!("{} cannot draw to this window", self.name())))
        }
    }

    /// How to set up a surface: colours as they are, without a curve, in a format that [`Renderer`](crate::render::Renderer)
    /// draws to. Nothing if the adapter cannot draw to it.
    pub(crate) fn surface_configuration(
        &self,
        surface: &wgpu::Surface<'_>,
        [width, height]: [u32; 2],
    ) -> Option<wgpu::SurfaceConfiguration> {
        let origin = self.shared.origin.as_ref()?;
        let mut configuration = surface.get_default_config(&origin.adapter, width.max(1), height.max(1))?;
        let formats = surface.get_capabilities(&origin.adapter).formats;
        let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
        configuration.format = plain.into_iter().find(|format| formats.contains(format))?;
        Some(configuration)
    }
}
