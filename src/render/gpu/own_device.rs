//! The caller's own device.
//!
//! **Outside the promise of stability.** Everything here follows [`wgpu`], which makes a new major version several times a year:
//! what is here changes with it, in any version of this crate. Nothing else of this crate mentions a type of wgpu's.

pub use wgpu;

use super::{Gpu, Shared};
use crate::render::RenderError;

impl Gpu {
    /// Draws with a device and a queue of the caller's, so that pictures of both are made side by side. Errors that the device
    /// reports outside calls of this crate stay the caller's to catch.
    ///
    /// **Outside the promise of stability**: see the [module](self).
    ///
    /// # Errors
    ///
    /// [`RenderError::TooLarge`] if the device was opened with limits that are below wgpu's defaults for older adapters.
    pub fn from_wgpu(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, RenderError> {
        let least = wgpu::Limits::downlevel_defaults();
        let limits = device.limits();
        for (what, has, needs) in [
            (
                "the buffer of uniforms that is needed",
                limits.max_uniform_buffer_binding_size,
                least.max_uniform_buffer_binding_size,
            ),
            (
                "the number of vertex attributes that is needed",
                limits.max_vertex_attributes.into(),
                least.max_vertex_attributes.into(),
            ),
            ("the number of textures that is needed", limits.max_sampled_textures_per_shader_stage.into(), 16),
        ] {
            if has < needs {
                return Err(RenderError::TooLarge { what: what.to_owned(), size: needs, limit: has });
            }
        }
        let info = device.adapter_info();
        // Every adapter has four samples.
        Ok(Self::assemble(device, queue, info, 1 | 4, None))
    }

    /// The device and the queue, to draw other things with. Do not destroy the device.
    ///
    /// **Outside the promise of stability**: see the [module](self).
    pub fn wgpu(&self) -> (&wgpu::Device, &wgpu::Queue) {
        let Shared { device, queue, .. } = &*self.shared;
        (device, queue)
    }
}
