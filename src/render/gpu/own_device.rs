//! Rendering with the caller's own wgpu device.
//!
//! **Excluded from the stability guarantee.** This module follows [`wgpu`], which releases a new
//! major version several times a year, and may change with it in any version of this crate. No
//! other public item of this crate exposes a type of wgpu.

pub use wgpu;

use super::adapter::GUARANTEED_SAMPLES;
use super::{Gpu, Shared};
use crate::render::RenderError;

impl Gpu {
    /// Creates a `Gpu` from the caller's device and queue, to render alongside the caller's own
    /// commands. The caller remains responsible for errors that the device reports outside of calls
    /// of this crate.
    ///
    /// **Excluded from the stability guarantee**: see the [module](self).
    ///
    /// # Errors
    ///
    /// [`RenderError::TooLarge`] if the device was opened with limits below
    /// `wgpu::Limits::downlevel_defaults`.
    pub fn from_wgpu(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, RenderError> {
        let least = wgpu::Limits::downlevel_defaults();
        let limits = device.limits();
        for (what, has, needs) in [
            (
                "the required size of a uniform buffer binding, bytes,",
                limits.max_uniform_buffer_binding_size,
                least.max_uniform_buffer_binding_size,
            ),
            (
                "the required number of vertex attributes",
                limits.max_vertex_attributes.into(),
                least.max_vertex_attributes.into(),
            ),
            (
                "the required number of sampled textures per shader stage",
                limits.max_sampled_textures_per_shader_stage.into(),
                16,
            ),
        ] {
            if has < needs {
                return Err(RenderError::TooLarge { what: what.to_owned(), size: needs, limit: has });
            }
        }
        let info = device.adapter_info();
        // The device does not tell which other counts its adapter supports.
        Ok(Self::assemble(device, queue, info, GUARANTEED_SAMPLES, None))
    }

    /// Returns the device and the queue, for the caller's own commands. Do not destroy the device.
    ///
    /// **Excluded from the stability guarantee**: see the [module](self).
    pub fn wgpu(&self) -> (&wgpu::Device, &wgpu::Queue) {
        let Shared { device, queue, .. } = &*self.shared;
        (device, queue)
    }
}
