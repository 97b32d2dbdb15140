//! Adapter selection, device creation and window surfaces.

#![allow(clippy::trivially_copy_pass_by_ref, reason = "more options are planned")]

use std::sync::{Arc, OnceLock};

use super::{DriverUse, DropUse, Gpu, Origin, Shared};
use crate::macros::with_methods;
use crate::render::RenderError;
use crate::render::assets::DepthLevels;

/// Preference between hardware and software adapters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GpuPreference {
    /// A hardware adapter if available, otherwise a software rasteriser.
    #[default]
    Any,
    /// Hardware adapters only.
    Hardware,
    /// Software rasterisers only. Their images are the same on every computer with the same
    /// version.
    Software,
}

/// Options of [`Gpu::with_options`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GpuOptions {
    /// Preference between hardware and software.
    pub preference: GpuPreference,
    /// Prefer the adapter with the lower power consumption, if several are available.
    pub low_power: bool,
}

with_methods!(GpuOptions { with_preference(preference: GpuPreference), with_low_power(low_power: bool) });

/// Type of a graphics adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GpuKind {
    /// Discrete GPU.
    Discrete,
    /// GPU integrated into the processor.
    Integrated,
    /// Virtual GPU of a virtual machine.
    Virtual,
    /// Software rasteriser on the CPU.
    Software,
    /// Not reported by the driver.
    Unknown,
}

impl GpuKind {
    pub(super) fn new(kind: wgpu::DeviceType) -> Self {
        match kind {
            wgpu::DeviceType::DiscreteGpu => Self::Discrete,
            wgpu::DeviceType::IntegratedGpu => Self::Integrated,
            wgpu::DeviceType::VirtualGpu => Self::Virtual,
            wgpu::DeviceType::Cpu => Self::Software,
            wgpu::DeviceType::Other => Self::Unknown,
        }
    }
}

/// Device features that are enabled if supported. The renderer has a fallback for each.
const OPTIONAL_FEATURES: wgpu::Features = wgpu::Features::POLYGON_MODE_LINE
    .union(wgpu::Features::CLIP_DISTANCES)
    .union(wgpu::Features::DEPTH32FLOAT_STENCIL8)
    .union(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);

/// Backends in the order of attempts. OpenGL is last because its enumeration is slow.
const BACKENDS: [wgpu::Backends; 2] = [wgpu::Backends::PRIMARY, wgpu::Backends::GL];

impl Gpu {
    /// Opens an adapter selected by options.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if no adapter matches, [`RenderError::Open`] if its driver fails
    /// to open a device.
    pub fn with_options(options: GpuOptions) -> Result<Self, RenderError> {
        let _driver_use = DriverUse::begin();
        with_captured_stderr(|| {
            let mut rejected = Vec::new();
            for backends in BACKENDS {
                let instance = wgpu::Instance::new(instance_descriptor(backends));
                if let Some(adapter) = request_adapter(&instance, &options, None, &mut rejected) {
                    return open(instance, adapter);
                }
            }
            Err(no_adapter(&options, &rejected))
        })
    }

    pub(super) fn assemble(
        device: wgpu::Device,
        queue: wgpu::Queue,
        info: wgpu::AdapterInfo,
        samples: u32,
        origin: Option<Origin>,
    ) -> Self {
        let lost = Arc::new(OnceLock::new());
        let pipelines = OnceLock::new();
        let depth_levels = DepthLevels::default();
        let drop_use = DropUse::default();
        let shared = Shared { device, queue, info, samples, pipelines, depth_levels, lost, origin, drop_use };
        let gpu = Self { shared: Arc::new(shared) };
        if gpu.shared.origin.is_some() {
            gpu.install_error_handlers();
        }
        gpu
    }
}

/// Window surfaces.
#[cfg(feature = "viewer")]
impl Gpu {
    /// Opens an adapter that can present to a window, and creates the window's surface. The window
    /// is typically an `Arc`.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if no adapter supports the window, [`RenderError::Open`] if its
    /// driver fails to open a device.
    pub(crate) fn for_window<W>(window: &W, options: &GpuOptions) -> Result<(Self, wgpu::Surface<'static>), RenderError>
    where
        W: Clone + Into<wgpu::SurfaceTarget<'static>>,
    {
        let _driver_use = DriverUse::begin();
        with_captured_stderr(|| {
            let mut rejected = Vec::new();
            for backends in BACKENDS {
                let instance = wgpu::Instance::new(instance_descriptor(backends));
                let Ok(surface) = instance.create_surface(window.clone()) else { continue };
                if let Some(adapter) = request_adapter(&instance, options, Some(&surface), &mut rejected) {
                    return Ok((open(instance, adapter)?, surface));
                }
            }
            Err(no_adapter(options, &rejected))
        })
    }

    /// Creates the surface of a further window.
    ///
    /// # Errors
    ///
    /// [`RenderError::Wgpu`] if the adapter cannot present to this window.
    pub(crate) fn surface(
        &self,
        window: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<wgpu::Surface<'static>, RenderError> {
        let refused = |message: String| RenderError::Wgpu { message };
        let Some(origin) = &self.shared.origin else {
            return Err(refused("a device of the caller cannot create window surfaces".to_owned()));
        };
        let surface = origin.instance.create_surface(window).map_err(|error| refused(error.to_string()))?;
        if origin.adapter.is_surface_supported(&surface) {
            Ok(surface)
        } else {
            Err(refused(format!("{} cannot present to this window", self.name())))
        }
    }

    /// Returns a surface configuration with a linear (non-sRGB) format that
    /// [`Renderer`](crate::render::Renderer) supports, or `None` if the surface supports no such
    /// format. Textures can be copied to the surface, if it supports that.
    pub(crate) fn surface_configuration(
        &self,
        surface: &wgpu::Surface<'_>,
        [width, height]: [u32; 2],
    ) -> Option<wgpu::SurfaceConfiguration> {
        let origin = self.shared.origin.as_ref()?;
        let mut configuration = surface.get_default_config(&origin.adapter, width.max(1), height.max(1))?;
        let capabilities = surface.get_capabilities(&origin.adapter);
        let linear = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
        configuration.format = linear.into_iter().find(|format| capabilities.formats.contains(format))?;
        configuration.usage |= capabilities.usages & wgpu::TextureUsages::COPY_DST;
        Some(configuration)
    }
}

/// Redirects lines that drivers print to standard error to the log. Mesa's Vulkan device selection
/// layer, for example, searches for a Wayland session and prints a warning if `XDG_RUNTIME_DIR` is
/// not set.
fn with_captured_stderr<T>(open: impl FnOnce() -> T) -> T {
    let (result, printed) = mujoco_sys::stderr::captured(open);
    for line in printed.lines() {
        log::debug!("graphics driver: {line}");
    }
    result
}

fn instance_descriptor(backends: wgpu::Backends) -> wgpu::InstanceDescriptor {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // No driver validation layers: they serve driver development only.
    descriptor.flags = wgpu::InstanceFlags::empty();
    descriptor
}

/// Requests an adapter that matches the options. Appends the names of adapters that do not match to
/// `rejected`.
fn request_adapter(
    instance: &wgpu::Instance,
    options: &GpuOptions,
    surface: Option<&wgpu::Surface<'_>>,
    rejected: &mut Vec<String>,
) -> Option<wgpu::Adapter> {
    let power_preference =
        if options.low_power { wgpu::PowerPreference::LowPower } else { wgpu::PowerPreference::HighPerformance };
    let request = wgpu::RequestAdapterOptions {
        power_preference,
        force_fallback_adapter: options.preference == GpuPreference::Software,
        compatible_surface: surface,
        ..Default::default()
    };
    let adapter = pollster::block_on(instance.request_adapter(&request)).ok()?;
    let info = adapter.get_info();
    let is_software = info.device_type == wgpu::DeviceType::Cpu;
    let is_rejected = match options.preference {
        GpuPreference::Any => false,
        GpuPreference::Hardware => is_software,
        GpuPreference::Software => !is_software,
    };
    if is_rejected {
        rejected.push(info.name);
        return None;
    }
    Some(adapter)
}

fn no_adapter(options: &GpuOptions, rejected: &[String]) -> RenderError {
    let wanted = match options.preference {
        GpuPreference::Any => "graphics adapter",
        GpuPreference::Hardware => "hardware graphics adapter",
        GpuPreference::Software => "software graphics adapter",
    };
    let found = if rejected.is_empty() { String::new() } else { format!(" (only {})", rejected.join(", ")) };
    RenderError::NoAdapter { wanted, found }
}

/// Opens a device with all limits of the adapter.
fn open(instance: wgpu::Instance, adapter: wgpu::Adapter) -> Result<Gpu, RenderError> {
    let info = adapter.get_info();
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("mujoco-safe"),
        required_features: adapter.features() & OPTIONAL_FEATURES,
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
        .map_err(|error| RenderError::Open { adapter: info.name.clone(), message: error.to_string() })?;
    if GpuKind::new(info.device_type) == GpuKind::Software {
        keep_freed_memory();
    }
    let samples = sample_counts(&adapter, device.features());
    let gpu = Gpu::assemble(device, queue, info, samples, Some(Origin { instance, adapter }));
    gpu.load_shader_compiler()?;
    Ok(gpu)
}

/// Makes the C library keep memory that the driver frees, up to 64 MiB for each thread that
/// allocates.
///
/// A software rasteriser allocates the triangles of each frame with `malloc` and frees them
/// afterwards. By default, glibc returns memory above 128 KiB to the system at once, so that each
/// frame would fault in all of its pages again. glibc raises this threshold to twice the size of
/// the largest block of up to 32 MiB that was mapped and freed, unless the program or its user has
/// set the threshold.
fn keep_freed_memory() {
    /// Largest size that glibc considers, without the header of the block and its alignment.
    const BLOCK: usize = (32 << 20) - (64 << 10);
    // The optimiser must not remove the allocation. Its pages are never touched.
    drop(std::hint::black_box(Vec::<u8>::with_capacity(BLOCK)));
}

/// Returns the format of the depth buffer with a stencil component, for the features of a device or
/// an adapter.
pub(super) fn stencil_format(features: wgpu::Features) -> wgpu::TextureFormat {
    if features.contains(wgpu::Features::DEPTH32FLOAT_STENCIL8) {
        wgpu::TextureFormat::Depth32FloatStencil8
    } else {
        wgpu::TextureFormat::Depth24PlusStencil8
    }
}

/// Sample counts, as a bitwise OR, that wgpu guarantees on every device.
pub(super) const GUARANTEED_SAMPLES: u32 = 1 | 4;

/// Returns the bitwise OR of the sample counts that a device with these features supports for every
/// format of colours and depths.
fn sample_counts(adapter: &wgpu::Adapter, features: wgpu::Features) -> u32 {
    // Without this feature a device allows only what wgpu guarantees, whatever the adapter can do.
    if !features.contains(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES) {
        return GUARANTEED_SAMPLES;
    }
    let colors = [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Bgra8Unorm];
    let depths = [wgpu::TextureFormat::Depth32Float, stencil_format(features)];
    let supported = [2, 8].into_iter().filter(|&count| {
        colors
            .iter()
            .chain(&depths)
            .all(|&format| adapter.get_texture_format_features(format).flags.sample_count_supported(count))
    });
    supported.fold(GUARANTEED_SAMPLES, |samples, count| samples | count)
}
