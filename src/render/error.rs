//! What can go wrong when a picture is drawn.

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Something is wrong with the scene, with the model or with a number.
    #[error(transparent)]
    Engine(#[from] crate::Error),

    /// Nothing on this computer can draw.
    #[error(
        "no {wanted} was found to draw with{found}. One in software is in Debian's packages libvulkan1 and mesa-vulkan-drivers \
         (Vulkan), or libegl1 and libgl1-mesa-dri (OpenGL); on other systems look for Mesa's lavapipe or llvmpipe"
    )]
    NoAdapter {
        /// What was looked for.
        wanted: &'static str,
        /// What was found instead, and why it was not taken: a text that may be empty.
        found: String,
    },

    /// The graphics adapter could not be opened.
    #[error(
        "the graphics adapter {adapter} could not be opened: {message}. Is its driver up to date, and is it in use elsewhere?"
    )]
    Open {
        /// Its name.
        adapter: String,
        /// What its driver says.
        message: String,
    },

    /// Something is larger than the graphics adapter can take.
    #[error("{what} is {size}, and this graphics adapter can take {limit} at most: make it smaller")]
    TooLarge {
        /// What it is.
        what: String,
        /// How large it is.
        size: u64,
        /// How large it may be.
        limit: u64,
    },

    /// The graphics adapter has no memory left.
    #[error("the graphics adapter is out of memory: draw smaller pictures, with smaller shadow maps or fewer samples")]
    OutOfMemory,

    /// The graphics adapter is gone: its driver was reset, or it was taken out. What was made with it is of no use any more.
    #[error("the graphics adapter is lost ({message}): open it anew with Gpu::new, and make new renderers with it")]
    Lost {
        /// What its driver says.
        message: String,
    },

    /// The graphics library refused what it was told to do, which is a mistake in this crate or in the driver.
    #[error("bug: the graphics library refused a call: {message}")]
    Refused {
        /// Its words.
        message: String,
    },
}

impl RenderError {
    /// What the graphics library says, in our words.
    pub(crate) fn from_wgpu(error: &wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory,
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => {
                let message = error.to_string();
                // A lost device reports itself through every call that is made after.
                if message.contains("device is lost") || message.contains("Device is lost") {
                    Self::Lost { message }
                } else {
                    Self::Refused { message }
                }
            }
        }
    }
}
