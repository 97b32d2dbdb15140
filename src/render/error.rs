//! Errors of rendering.

use crate::error::debug_as_display;

/// An error of the renderer or the graphics adapter.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Another error of this crate: the scene, the model or an argument is invalid.
    #[error(transparent)]
    Other(#[from] crate::error::Error),

    /// No suitable graphics adapter exists.
    #[error(
        "no {wanted} was found{found}. A software adapter is in Debian's packages libvulkan1 and mesa-vulkan-drivers \
         (Vulkan), or libegl1 and libgl1-mesa-dri (OpenGL); on other systems install Mesa's lavapipe or llvmpipe"
    )]
    NoAdapter {
        /// Requested type of adapter.
        wanted: &'static str,
        /// Adapters that were found but do not match the request; may be empty.
        found: String,
    },

    /// The graphics adapter could not be opened.
    #[error(
        "the graphics adapter {adapter} could not be opened: {message}. Is its driver up to date, and is it in use elsewhere?"
    )]
    Open {
        /// Name of the adapter.
        adapter: String,
        /// Message of the driver.
        message: String,
    },

    /// A size exceeds a limit of the graphics adapter.
    #[error("{what} is {size}, but the limit of this graphics adapter is {limit}")]
    TooLarge {
        /// Name and unit of the quantity.
        what: String,
        /// Its value.
        size: u64,
        /// Largest supported value.
        limit: u64,
    },

    /// The graphics adapter is out of memory.
    #[error("the graphics adapter is out of memory: use smaller images, smaller shadow maps or fewer samples")]
    OutOfMemory,

    /// The graphics device is lost: its driver was reset, or the adapter was removed. All objects
    /// created with it are unusable.
    #[error("the graphics device is lost ({message}): open a new one with Gpu::new, and create new renderers with it")]
    Lost {
        /// Message of the driver.
        message: String,
    },

    /// wgpu rejected a call, which is a bug of this crate or of the driver.
    #[error("bug: wgpu rejected a call: {message}")]
    Wgpu {
        /// Message of wgpu.
        message: String,
    },
}

debug_as_display!(RenderError);

impl RenderError {
    /// Converts an error of wgpu.
    pub(crate) fn from_wgpu(error: &wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory,
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => {
                let message = error.to_string();
                // Every call on a lost device fails with a validation error.
                if message.contains("device is lost") || message.contains("Device is lost") {
                    Self::Lost { message }
                } else {
                    Self::Wgpu { message }
                }
            }
        }
    }
}
