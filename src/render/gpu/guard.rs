//! What the graphics library refuses becomes an error. Left alone it panics.

use std::sync::Arc;

use super::Gpu;
use crate::render::RenderError;

impl Gpu {
    /// Makes the device tell what happens outside a [`guarded`](Self::guarded) call, and why it is lost.
    pub(super) fn listen(&self) {
        let device = self.device();
        device.on_uncaptured_error(Arc::new(|error| log::error!("the graphics library: {error}")));
        let lost = Arc::clone(&self.shared.lost);
        device.set_device_lost_callback(move |reason, message| {
            // A device that is dropped is lost too.
            if reason != wgpu::DeviceLostReason::Destroyed {
                let _ = lost.set(message);
            }
        });
    }

    /// Makes calls of the graphics library, of which the first that it refuses is an error.
    ///
    /// Scopes of errors belong to the thread, so that threads that share an adapter do not get each other's errors.
    pub(crate) fn guarded<T>(&self, calls: impl FnOnce() -> Result<T, RenderError>) -> Result<T, RenderError> {
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
            Some(error) => Err(RenderError::from_wgpu(&error)),
            None => result,
        }
    }

    pub(crate) fn check_lost(&self) -> Result<(), RenderError> {
        match self.shared.lost.get() {
            Some(message) => Err(RenderError::Lost { message: message.clone() }),
            None => Ok(()),
        }
    }

    /// Waits until everything that was submitted is done.
    pub(crate) fn wait(&self) -> Result<(), RenderError> {
        match self.device().poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => self.check_lost(),
            Err(error) => Err(RenderError::Lost { message: error.to_string() }),
        }
    }
}
