//! Windows: event loop, input, frames and output. The only module that uses winit.

mod app;
mod canvas;
mod capture;
mod event_loop;
mod file_watch;
mod frame;
mod input;
mod model_loader;
mod open_windows;
mod output;
mod overlay;
mod panes;
mod pixel_rect;
mod scene_renderer;
mod scheduler;
mod session;
mod shape_changes;
mod surface;
mod wake;

use std::sync::mpsc;

use winit::event_loop::{EventLoop, EventLoopProxy};

use self::event_loop::EventLoopAccess;
pub(super) use self::panes::PaneImage;
use self::wake::{Wake, Waker, WindowToken};
use super::error::ViewerError;
use super::link::{PhysicsEnd, WindowEnd, link};
use super::options::ViewerOptions;
use crate::engine::enable_timers;

/// Message that opens a window.
struct Opening {
    waker: Waker,
    link: WindowEnd,
    options: ViewerOptions,
    /// Receives the result of the opening, and then the error that ends the window, if there is
    /// one.
    result: mpsc::Sender<Result<(), ViewerError>>,
}

/// Requested window.
pub(super) struct WindowRequest {
    event_loop: Option<LocalEventLoop>,
    opened: OpeningResult,
}

/// Event loop of the calling thread, which must run to open the window. Stored for the next window
/// when it is dropped.
pub(super) struct LocalEventLoop {
    event_loop: Option<Box<EventLoop<Wake>>>,
    token: WindowToken,
}

/// Pending result of opening a window.
pub(super) struct OpeningResult(mpsc::Receiver<Result<(), ViewerError>>);

impl WindowRequest {
    /// Requests a window on the calling thread, or on the background thread if that was started
    /// before.
    pub fn on_this_thread(options: ViewerOptions) -> Result<(Self, PhysicsEnd), ViewerError> {
        options.check()?;
        let token = WindowToken::next();
        let (access, _lock) = event_loop::acquire()?;
        Ok(match access {
            EventLoopAccess::WindowThread(proxy) => Self::new(&proxy, token, options, None),
            EventLoopAccess::ThisThread(event_loop) => {
                let proxy = event_loop.create_proxy();
                Self::new(&proxy, token, options, Some(LocalEventLoop { event_loop: Some(event_loop), token }))
            }
        })
    }

    /// Requests a window on the background thread.
    #[cfg(not(target_os = "macos"))]
    pub fn on_window_thread(options: ViewerOptions) -> Result<(Self, PhysicsEnd), ViewerError> {
        options.check()?;
        let (proxy, _lock) = event_loop::window_thread()?;
        Ok(Self::new(&proxy, WindowToken::next(), options, None))
    }

    fn new(
        proxy: &EventLoopProxy<Wake>,
        token: WindowToken,
        options: ViewerOptions,
        event_loop: Option<LocalEventLoop>,
    ) -> (Self, PhysicsEnd) {
        let waker = Waker::new(proxy.clone(), token);
        let wake = waker.clone();
        let (window, physics) = link(move || wake.wake());
        // The plot of computing times requires the timers.
        enable_timers();
        let (sender, receiver) = mpsc::channel();
        let opening = Opening { waker, link: window, options, result: sender };
        // If the loop has ended, dropping the opening disconnects the channel, and
        // `OpeningResult::wait` returns an error.
        let _ = proxy.send_event(Wake::Open(Box::new(opening)));
        (Self { event_loop, opened: OpeningResult(receiver) }, physics)
    }

    /// Returns the event loop that the calling thread must run, if any, and the pending result.
    pub fn split(self) -> (Option<LocalEventLoop>, OpeningResult) {
        (self.event_loop, self.opened)
    }
}

impl LocalEventLoop {
    /// Runs the event loop until the window is closed.
    pub fn run(mut self) -> Result<(), ViewerError> {
        self.event_loop.take().map_or(Ok(()), |event_loop| event_loop::run_on_this_thread(event_loop, self.token))
    }
}

impl Drop for LocalEventLoop {
    fn drop(&mut self) {
        if let Some(event_loop) = self.event_loop.take() {
            event_loop::store(event_loop);
        }
    }
}

impl OpeningResult {
    /// Waits until the window is open or could not be opened.
    pub fn wait(&self) -> Result<(), ViewerError> {
        self.0.recv().map_err(|_| ViewerError::Window("the window thread has ended".to_owned()))?
    }

    /// Returns the error that has ended the open window, if there was one. Call it once, after the
    /// window was closed.
    pub fn end(&self) -> Result<(), ViewerError> {
        self.0.try_recv().unwrap_or(Ok(()))
    }
}
