//! What a window shows its pictures with: a surface, and the adapter that draws on it.

use std::sync::Arc;

use wgpu::CurrentSurfaceTexture as Acquired;
use winit::window::Window;

use crate::render::{Gpu, GpuOptions, RenderError};

/// A surface that is made anew when it is lost, and that rests while the window has no size.
pub(super) struct Screen {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    configuration: wgpu::SurfaceConfiguration,
    /// Whether the surface has been told of the configuration.
    configured: bool,
}

/// What came of asking for a place to draw on.
pub(super) enum Place {
    Ready(wgpu::SurfaceTexture),
    /// Not while the window is hidden or has no size.
    Hidden,
    /// Not now, but soon.
    Soon,
}

impl Screen {
    pub fn new(window: Arc<Window>, vsync: bool) -> Result<Self, RenderError> {
        let (gpu, surface) = Gpu::for_window(&window, &GpuOptions::default())?;
        let configuration = Self::configuration(&gpu, &surface, &window, vsync)?;
        Ok(Self { window, surface, gpu, configuration, configured: false })
    }

    fn configuration(
        gpu: &Gpu,
        surface: &wgpu::Surface<'static>,
        window: &Window,
        vsync: bool,
    ) -> Result<wgpu::SurfaceConfiguration, RenderError> {
        let configuration = gpu.surface_configuration(surface, window.inner_size().into());
        let mut configuration = configuration
            .ok_or_else(|| RenderError::Refused { message: format!("{} cannot draw to this window", gpu.name()) })?;
        configuration.present_mode = if vsync { wgpu::PresentMode::AutoVsync } else { wgpu::PresentMode::AutoNoVsync };
        Ok(configuration)
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub fn format(&self) -> wgpu::TextureFormat {
        self.configuration.format
    }

    /// Pixels across and down of the next frame.
    pub fn size(&self) -> [u32; 2] {
        [self.configuration.width, self.configuration.height]
    }

    /// The window has, or may have, another size.
    pub fn resize(&mut self) {
        let size = self.window.inner_size();
        let most = self.gpu.limits().max_texture_dimension_2d;
        let size = [size.width.min(most), size.height.min(most)];
        if size != self.size() && size[0] > 0 && size[1] > 0 {
            [self.configuration.width, self.configuration.height] = size;
            self.configured = false;
        }
    }

    /// Whether frames wait for the screen.
    pub fn has_vsync(&self) -> bool {
        self.configuration.present_mode == wgpu::PresentMode::AutoVsync
    }

    pub fn set_vsync(&mut self, vsync: bool) {
        if vsync != self.has_vsync() {
            self.configuration.present_mode =
                if vsync { wgpu::PresentMode::AutoVsync } else { wgpu::PresentMode::AutoNoVsync };
            self.configured = false;
        }
    }

    /// Where the next frame is drawn.
    ///
    /// # Errors
    ///
    /// If the surface is lost and another cannot be made, or the adapter is.
    pub fn place(&mut self) -> Result<Place, RenderError> {
        self.gpu.check_lost()?;
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 || self.window.is_minimized() == Some(true) {
            return Ok(Place::Hidden);
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
                Acquired::Success(texture) => return Ok(Place::Ready(texture)),
                // Drawn as it is; the next one fits.
                Acquired::Suboptimal(texture) => {
                    self.configured = false;
                    return Ok(Place::Ready(texture));
                }
                Acquired::Outdated => self.configured = false,
                Acquired::Lost => self.remake()?,
                Acquired::Occluded => return Ok(Place::Hidden),
                Acquired::Timeout | Acquired::Validation => return Ok(Place::Soon),
            }
        }
        Ok(Place::Soon)
    }

    /// Forgets the surface and makes another for the same window, as when it is lost.
    pub fn remake(&mut self) -> Result<(), RenderError> {
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
