//! Graphics adapters and devices.

mod adapter;
pub(crate) mod buffer;
mod driver_use;
pub mod own_device;
mod shader_compiler;

use std::fmt;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

pub use self::adapter::{GpuKind, GpuOptions, GpuPreference};
pub(crate) use self::driver_use::{DriverUse, DropUse};
use super::RenderError;
use super::assets::DepthLevels;
use super::pass::Pipelines;

/// An open graphics adapter, shared by any number of [`Renderer`](super::Renderer)s on any number
/// of threads. Clones refer to the same device.
///
/// The adapter is hardware or a software rasteriser.
///
/// ```no_run
/// use mujoco_safe::render::{Gpu, GpuOptions, GpuPreference};
///
/// let gpu = Gpu::new()?;
/// println!("{}, {:?}", gpu.name(), gpu.kind());
/// let software = Gpu::with_options(GpuOptions::default().with_preference(GpuPreference::Software))?;
/// # Ok::<(), mujoco_safe::render::RenderError>(())
/// ```
#[derive(Clone)]
pub struct Gpu {
    shared: Arc<Shared>,
}

/// Time for which a thread waits for hardware without blocking.
const SHORT_WAIT: Duration = Duration::from_millis(1);
/// Time between two looks at a long submission.
const NAP: Duration = Duration::from_micros(100);

/// Length of a submission, from which follows how a thread waits for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Length {
    /// One image, which hardware renders in less than [`SHORT_WAIT`].
    Short,
    /// Many images.
    Long,
}

struct Shared {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    /// Bitwise OR of the supported MSAA sample counts.
    samples: u32,
    /// Created by the first renderer.
    pipelines: OnceLock<Pipelines>,
    depth_levels: DepthLevels,
    /// Reason of the device loss, if the device is lost.
    lost: Arc<OnceLock<String>>,
    /// Instance and adapter, required to create window surfaces. `None` for a device of the caller.
    #[allow(dead_code, reason = "only the viewer opens windows")]
    origin: Option<Origin>,
    /// Last, because the drop of the other fields uses the driver.
    drop_use: DropUse,
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.drop_use.begin();
    }
}

#[allow(dead_code, reason = "only the viewer opens windows")]
struct Origin {
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
}

impl Gpu {
    /// Opens the best available adapter.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if no adapter is available, [`RenderError::Open`] if its driver
    /// fails to open a device.
    pub fn new() -> Result<Self, RenderError> {
        Self::with_options(GpuOptions::default())
    }

    /// Returns the name of the adapter, as reported by its driver.
    pub fn name(&self) -> &str {
        &self.shared.info.name
    }

    /// Returns the type of the adapter.
    pub fn kind(&self) -> GpuKind {
        GpuKind::new(self.shared.info.device_type)
    }

    /// Returns the name of the graphics API: `vulkan`, `gl`, `metal` or `dx12`.
    pub fn backend(&self) -> &'static str {
        self.shared.info.backend.to_str()
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.shared.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.shared.queue
    }

    /// Returns the pipelines of all renderers.
    pub(crate) fn pipelines(&self) -> &Pipelines {
        self.shared.pipelines.get_or_init(|| Pipelines::new(self))
    }

    /// Returns the round shapes for depth and segmentation images of all renderers.
    pub(crate) fn depth_levels(&self) -> &DepthLevels {
        &self.shared.depth_levels
    }

    pub(crate) fn limits(&self) -> wgpu::Limits {
        self.shared.device.limits()
    }

    pub(crate) fn has(&self, feature: wgpu::Features) -> bool {
        self.shared.device.features().contains(feature)
    }

    /// Returns `true` if several images can be drawn together, each to its part of a texture.
    pub(crate) fn can_merge(&self) -> bool {
        let limits = self.limits();
        // OpenGL may have storage buffers in fragment shaders only.
        self.shared.info.backend != wgpu::Backend::Gl
            && self.has(wgpu::Features::CLIP_DISTANCES)
            && limits.max_storage_buffers_per_shader_stage > 0
            // Locations up to 15, and one more for the four clip distances.
            && limits.max_inter_stage_shader_variables > 16
            && limits.max_compute_invocations_per_workgroup >= 64
            && limits.max_compute_workgroups_per_dimension >= 1 << 13
    }

    /// Returns the format of the depth buffer with a stencil component.
    pub(crate) fn stencil_format(&self) -> wgpu::TextureFormat {
        adapter::stencil_format(self.shared.device.features())
    }

    /// Returns wgpu's counts of allocated resources.
    #[cfg(test)]
    pub(crate) fn report(&self) -> Option<wgpu::wgc::global::GlobalReport> {
        self.shared.origin.as_ref()?.instance.generate_report()
    }

    /// Returns the largest supported MSAA sample count that does not exceed `wanted`.
    pub(crate) fn samples(&self, wanted: usize) -> u32 {
        [8, 4, 2, 1]
            .into_iter()
            .find(|&count| count as usize <= wanted.max(1) && self.shared.samples & count != 0)
            .unwrap_or(1)
    }
}

/// Error handling. Without it wgpu panics on validation errors.
impl Gpu {
    /// Installs handlers that log errors outside of [`guarded`](Self::guarded) calls and record the
    /// reason of a device loss.
    fn install_error_handlers(&self) {
        let device = self.device();
        device.on_uncaptured_error(Arc::new(|error| log::error!("wgpu: {error}")));
        let lost = Arc::clone(&self.shared.lost);
        device.set_device_lost_callback(move |reason, message| {
            // Dropping the device invokes this callback, too.
            if reason != wgpu::DeviceLostReason::Destroyed {
                let _ = lost.set(message);
            }
        });
    }

    /// Runs calls of wgpu and converts the first error that wgpu reports.
    ///
    /// Error scopes are per thread, so threads that share an adapter do not receive each other's
    /// errors.
    pub(crate) fn guarded<T>(&self, calls: impl FnOnce() -> Result<T, RenderError>) -> Result<T, RenderError> {
        let _driver_use = DriverUse::begin();
        self.check_lost()?;
        let device = self.device();
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let result = calls();
        let memory = pollster::block_on(memory.pop());
        let internal = pollster::block_on(internal.pop());
        let validation = pollster::block_on(validation.pop());
        self.check_lost()?;
        match memory.or(internal).or(validation) {
            Some(error) => {
                if let Some(pipelines) = self.shared.pipelines.get() {
                    pipelines.clear();
                }
                self.shared.depth_levels.clear();
                Err(RenderError::from_wgpu(&error))
            }
            None => result,
        }
    }

    pub(crate) fn check_lost(&self) -> Result<(), RenderError> {
        match self.shared.lost.get() {
            Some(message) => Err(RenderError::Lost { message: message.clone() }),
            None => Ok(()),
        }
    }

    /// Submits commands.
    pub(crate) fn submit(&self, commands: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        self.queue().submit([commands.finish()])
    }

    /// Blocks until a submission is complete and `is_done` returns `true`, which a callback of wgpu
    /// brings about.
    ///
    /// While wgpu blocks, it holds locks that stop the submissions of other threads: threads that
    /// share the device would take turns. For a short submission this asks hardware again and
    /// again, and for a long one it sleeps in between, which leaves the processor to others. A
    /// software rasteriser needs the processor itself.
    pub(crate) fn wait_for(
        &self,
        (submission, length): (wgpu::SubmissionIndex, Length),
        is_done: impl Fn() -> bool,
    ) -> Result<(), RenderError> {
        let start = Instant::now();
        while self.kind() != GpuKind::Software && (length == Length::Long || start.elapsed() < SHORT_WAIT) {
            self.poll(wgpu::PollType::Poll)?;
            if is_done() {
                return Ok(());
            }
            match length {
                Length::Short => std::thread::yield_now(),
                Length::Long => std::thread::sleep(NAP),
            }
        }
        self.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None })?;
        // Another thread may have taken the callback and be about to call it.
        while !is_done() {
            self.poll(wgpu::PollType::Poll)?;
            std::thread::yield_now();
        }
        Ok(())
    }

    /// Blocks until all submitted work is complete.
    pub(crate) fn wait(&self) -> Result<(), RenderError> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    fn poll(&self, how: wgpu::PollType) -> Result<(), RenderError> {
        match self.device().poll(how) {
            Ok(_) => self.check_lost(),
            Err(error) => Err(RenderError::Lost { message: error.to_string() }),
        }
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Gpu: {} ({:?}, {})", self.name(), self.kind(), self.backend())
    }
}
