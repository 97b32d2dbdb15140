//! The graphics adapter, opened.
//!
//! | file | what is in it |
//! |---|---|
//! | `open.rs` | which adapter is taken |
//! | `guard.rs` | what the graphics library refuses becomes an error |
//! | `window.rs` | an adapter that can draw to a window |
//! | `own_device.rs` | the caller's own device: outside the promise of stability |

mod guard;
mod open;
pub mod own_device;
#[cfg(feature = "viewer")]
mod window;

use std::fmt;
use std::sync::{Arc, OnceLock};

pub use self::open::{GpuKind, GpuOptions, GpuPreference};
use super::RenderError;

/// A graphics adapter, opened, for any number of [`Renderer`](super::Renderer)s on any number of threads. A clone is the same one.
///
/// It may be a chip, or a program that draws on the processor.
///
/// ```no_run
/// use mujoco_safe::render::{Gpu, GpuOptions, GpuPreference};
///
/// let gpu = Gpu::new()?;
/// println!("{}, {:?}", gpu.name(), gpu.kind());
/// let software = Gpu::with_options(&GpuOptions::preferring(GpuPreference::Software))?;
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
#[derive(Clone)]
pub struct Gpu {
    shared: Arc<Shared>,
}

struct Shared {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    /// What multisampled textures the adapter has: a bit for each number of samples.
    samples: u32,
    /// Why it is lost, once it is.
    lost: Arc<OnceLock<String>>,
    /// What windows need. Nothing for the caller's own device.
    #[allow(dead_code, reason = "windows are the viewer's")]
    origin: Option<Origin>,
}

#[allow(dead_code, reason = "windows are the viewer's")]
struct Origin {
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
}

impl Gpu {
    /// The best adapter that there is.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if there is none, [`RenderError::Open`] if its driver refuses.
    pub fn new() -> Result<Self, RenderError> {
        Self::with_options(&GpuOptions::default())
    }

    /// Its name, as its driver gives it.
    pub fn name(&self) -> &str {
        &self.shared.info.name
    }

    /// What it is.
    pub fn kind(&self) -> GpuKind {
        GpuKind::new(self.shared.info.device_type)
    }

    /// Through which library it is spoken to: `vulkan`, `gl`, `metal` or `dx12`.
    pub fn backend(&self) -> &'static str {
        self.shared.info.backend.to_str()
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.shared.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.shared.queue
    }

    pub(crate) fn limits(&self) -> wgpu::Limits {
        self.shared.device.limits()
    }

    pub(crate) fn has(&self, feature: wgpu::Features) -> bool {
        self.shared.device.features().contains(feature)
    }

    /// What the graphics library keeps.
    #[cfg(test)]
    pub(crate) fn report(&self) -> Option<wgpu::wgc::global::GlobalReport> {
        self.shared.origin.as_ref()?.instance.generate_report()
    }

    /// The number of samples of a pixel that comes nearest, and is not more if there is one.
    pub(crate) fn samples(&self, wanted: u32) -> u32 {
        [8, 4, 2, 1].into_iter().find(|&count| count <= wanted.max(1) && self.shared.samples & count != 0).unwrap_or(1)
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Gpu: {} ({:?}, {})", self.name(), self.kind(), self.backend())
    }
}
