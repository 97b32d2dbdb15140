//! Which adapter is taken.

#![allow(clippy::trivially_copy_pass_by_ref, reason = "there will be more options")]

use std::sync::{Arc, OnceLock};

use super::{Gpu, Origin, Shared};
use crate::render::RenderError;

/// What is drawn with, if there is a choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GpuPreference {
    /// A chip, and a program if there is none.
    #[default]
    Any,
    /// A chip, or nothing.
    Hardware,
    /// A program that draws on the processor, or nothing. Its pictures are the same on every computer that has the same version.
    Software,
}

/// How a [`Gpu`] is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GpuOptions {
    /// What is preferred.
    pub preference: GpuPreference,
    /// Whether the adapter that uses less power is preferred, where there are several.
    pub low_power: bool,
}

impl GpuOptions {
    /// The default with another preference.
    pub fn preferring(preference: GpuPreference) -> Self {
        Self { preference, ..Self::default() }
    }
}

/// What a [`Gpu`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GpuKind {
    /// A card of its own.
    Discrete,
    /// Part of the processor's chip.
    Integrated,
    /// Of a virtual machine.
    Virtual,
    /// A program that draws on the processor.
    Software,
    /// Its driver does not say.
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

/// What is used where it is there. Nothing depends on it: there is a slower way for each.
const USED: wgpu::Features = wgpu::Features::POLYGON_MODE_LINE;

impl Gpu {
    /// As [`new`](Self::new), with a choice.
    ///
    /// # Errors
    ///
    /// [`RenderError::NoAdapter`] if there is none, [`RenderError::Open`] if its driver refuses.
    pub fn with_options(options: &GpuOptions) -> Result<Self, RenderError> {
        quietly(|| {
            let mut found = Vec::new();
            // OpenGL is tried only if nothing newer is found, because its search takes a while.
            for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::GL] {
                let instance = wgpu::Instance::new(descriptor(backends));
                if let Some(adapter) = choose(&instance, options, None, &mut found) {
                    return open(instance, adapter);
                }
            }
            Err(no_adapter(options, &found))
        })
    }
}

/// Logs lines that drivers print to standard error, instead of printing them. Mesa's Vulkan layer that selects a device, for
/// example, searches for a Wayland session and complains if `XDG_RUNTIME_DIR` is not set.
pub(super) fn quietly<T>(open: impl FnOnce() -> T) -> T {
    let (result, printed) = mujoco_sys::stderr::captured(open);
    for line in printed.lines() {
        log::debug!("graphics driver: {line}");
    }
    result
}

pub(super) fn descriptor(backends: wgpu::Backends) -> wgpu::InstanceDescriptor {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // The checks of the drivers' own are for who writes drivers.
    descriptor.flags = wgpu::InstanceFlags::empty();
    descriptor
}

/// The adapter that the options ask for, and into `found` the names of those that they refuse.
pub(super) fn choose(
    instance: &wgpu::Instance,
    options: &GpuOptions,
    surface: Option<&wgpu::Surface<'_>>,
    found: &mut Vec<String>,
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
    let refused = match options.preference {
        GpuPreference::Any => false,
        GpuPreference::Hardware => is_software,
        GpuPreference::Software => !is_software,
    };
    if refused {
        found.push(info.name);
        return None;
    }
    Some(adapter)
}

pub(super) fn no_adapter(options: &GpuOptions, found: &[String]) -> RenderError {
    let wanted = match options.preference {
        GpuPreference::Any => "graphics adapter",
        GpuPreference::Hardware => "graphics adapter that is a chip",
        GpuPreference::Software => "graphics adapter in software",
    };
    let found = if found.is_empty() { String::new() } else { format!(" (there is only {})", found.join(", ")) };
    RenderError::NoAdapter { wanted, found }
}

/// Opens an adapter, with all that it can take.
pub(super) fn open(instance: wgpu::Instance, adapter: wgpu::Adapter) -> Result<Gpu, RenderError> {
    let info = adapter.get_info();
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("mujoco-safe"),
        required_features: adapter.features() & USED,
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
        .map_err(|error| RenderError::Open { adapter: info.name.clone(), message: error.to_string() })?;
    let samples = multisampling(&adapter);
    Ok(Gpu::assemble(device, queue, info, samples, Some(Origin { instance, adapter })))
}

/// A bit for each number of samples that colours and depths can have.
fn multisampling(adapter: &wgpu::Adapter) -> u32 {
    let formats = [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Depth24PlusStencil8];
    [1, 2, 4, 8].into_iter().fold(0, |samples, count| {
        let all = formats
            .iter()
            .all(|&format| adapter.get_texture_format_features(format).flags.sample_count_supported(count));
        samples | if all || count == 1 { count } else { 0 }
    })
}

impl Gpu {
    pub(super) fn assemble(
        device: wgpu::Device,
        queue: wgpu::Queue,
        info: wgpu::AdapterInfo,
        samples: u32,
        origin: Option<Origin>,
    ) -> Self {
        let lost = Arc::new(OnceLock::new());
        let shared = Shared { device, queue, info, samples, lost, origin };
        let gpu = Self { shared: Arc::new(shared) };
        if gpu.shared.origin.is_some() {
            gpu.listen();
        }
        gpu
    }
}
