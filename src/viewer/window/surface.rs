//! Surface of a window.

use std::sync::Arc;

use wgpu::CurrentSurfaceTexture as Acquired;
use winit::window::Window;

use crate::render::{Gpu, GpuOptions, RenderError};

/// Surface of a window and its GPU. The surface is recreated after it is lost, and unused while the
/// window has no size.
pub(super) struct WindowSurface {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    configuration: wgpu::SurfaceConfiguration,
    /// The surface has the current configuration.
    configured: bool,
}

/// Result of acquiring the texture of the next frame.
pub(super) enum SurfaceFrame {
    Ready(wgpu::SurfaceTexture),
    /// The window is hidden or has no size.
    Hidden,
    /// The texture is not available yet. Try again shortly.
    NotReady,
}

impl WindowSurface {
    pub fn new(window: Arc<Window>, vsync: bool) -> Result<Self, RenderError> {
        let (gpu, surface) = Gpu::for_window(&window, &GpuOptions::default())?;
        let configuration = gpu.surface_configuration(&surface, window.inner_size().into());
        let mut configuration = configuration
            .ok_or_else(|| RenderError::Wgpu { message: format!("{} cannot draw to this window", gpu.name()) })?;
        configuration.present_mode = present_mode(vsync);
        Ok(Self { window, surface, gpu, configuration, configured: false })
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub fn format(&self) -> wgpu::TextureFormat {
        self.configuration.format
    }

    /// Returns the width and height of the next frame, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.configuration.width, self.configuration.height]
    }

    /// Adopts the current size of the window.
    pub fn resize(&mut self) {
        let size = self.window.inner_size();
        let max = self.gpu.limits().max_texture_dimension_2d;
        let size = [size.width.min(max), size.height.min(max)];
        if size != self.size() && size[0] > 0 && size[1] > 0 {
            [self.configuration.width, self.configuration.height] = size;
            self.configured = false;
        }
    }

    /// Returns `true` if presentation is synchronised with the screen.
    pub fn has_vsync(&self) -> bool {
        self.configuration.present_mode == wgpu::PresentMode::AutoVsync
    }

    pub fn set_vsync(&mut self, vsync: bool) {
        if vsync != self.has_vsync() {
            self.configuration.present_mode = present_mode(vsync);
            self.configured = false;
        }
    }

    /// Acquires the texture of the next frame.
    ///
    /// # Errors
    ///
    /// If the GPU is lost, or if the surface is lost and cannot be recreated.
    pub fn acquire(&mut self) -> Result<SurfaceFrame, RenderError> {
        self.gpu.check_lost()?;
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 || self.window.is_minimized() == Some(true) {
            return Ok(SurfaceFrame::Hidden);
        }
        self.resize();
        for _ in 0..3 {
            if !self.configured {
                self.gpu.guarded(|| {
                    self.surface.configure(self.gpu.device(), &self.configuration);
                    Ok(())
                })?;
                self.configured = true;
            }
            match self.surface.get_current_texture() {
                Acquired::Success(texture) => return Ok(SurfaceFrame::Ready(texture)),
                // This frame is still drawn; the surface is reconfigured for the next frame.
                Acquired::Suboptimal(texture) => {
                    self.configured = false;
                    return Ok(SurfaceFrame::Ready(texture));
                }
                Acquired::Outdated => self.configured = false,
                Acquired::Lost => self.recreate()?,
                Acquired::Occluded => return Ok(SurfaceFrame::Hidden),
                Acquired::Timeout | Acquired::Validation => return Ok(SurfaceFrame::NotReady),
            }
        }
        Ok(SurfaceFrame::NotReady)
    }

    /// Recreates the surface of the window.
    pub fn recreate(&mut self) -> Result<(), RenderError> {
        self.gpu.check_lost()?;
        self.surface = self.gpu.surface(self.window.clone())?;
        self.configured = false;
        Ok(())
    }

    pub fn present(&self, texture: wgpu::SurfaceTexture) {
        self.window.pre_present_notify();
        self.gpu.queue().present(texture);
    }
}

fn present_mode(vsync: bool) -> wgpu::PresentMode {
    if vsync { wgpu::PresentMode::AutoVsync } else { wgpu::PresentMode::AutoNoVsync }
}
