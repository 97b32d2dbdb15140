//! The window: its events, its surface, and when it is drawn. The only place that knows of winit.
//!
//! | file | what is in it |
//! |---|---|
//! | `event_loop.rs` | the one event loop of the process, and whose it is |
//! | `app.rs` | the windows that are open |
//! | `wake.rs` | what other threads tell the thread of the windows |
//! | `session.rs` | one window: events in, frames out |
//! | `input.rs` | a session's keys, mouse and files |
//! | `frame.rs` | a session's frames |
//! | `output.rs` | a session's pictures and recordings |
//! | `translate.rs` | winit's keys and buttons as the viewer's |
//! | `screen.rs` | the surface and its device |
//! | `canvas.rs` | the picture of the scene |
//! | `overlay.rs` | the layer of the panels |
//! | `recording.rs` | the clip of a session, as long as the simulation that it shows |
//! | `pace.rs` | when a frame is due |
//! | `interrupt.rs` | Ctrl-C |
//! | `file_name.rs` | names of files that are not there yet |

mod app;
mod canvas;
mod event_loop;
mod file_name;
mod frame;
mod input;
mod interrupt;
mod output;
mod overlay;
mod pace;
mod recording;
mod screen;
mod session;
mod translate;
mod wake;

use std::sync::mpsc;

use super::launch::ViewerOptions;
use super::link::{Back, Front, link};
use crate::viewer::error::ViewerError;
use wake::{Token, Wake, Waker};
use winit::event_loop::{EventLoop, EventLoopProxy};

use crate::engine::enable_timers;

/// A window that is to be opened.
struct Opening {
    waker: Waker,
    front: Front,
    options: ViewerOptions,
    /// Told whether it was.
    opened: mpsc::Sender<Result<(), ViewerError>>,
}

/// A window that was asked for.
pub(super) struct Asked {
    here: Option<Here>,
    opened: Opened,
}

/// This thread's event loop, which has to be run for a window to come. It is kept for the next window when it is not.
pub(super) struct Here {
    event_loop: Option<Box<EventLoop<Wake>>>,
    token: Token,
}

/// Tells whether a window came.
pub(super) struct Opened(mpsc::Receiver<Result<(), ViewerError>>);

impl Asked {
    /// Asks for a window of this thread's.
    pub fn here(options: ViewerOptions) -> Result<(Self, Back), ViewerError> {
        let token = Token::next();
        Ok(match event_loop::place()? {
            event_loop::Place::Hosted(proxy) => Self::of(&proxy, token, options, None),
            event_loop::Place::Here(event_loop) => {
                let proxy = event_loop.create_proxy();
                Self::of(&proxy, token, options, Some(Here { event_loop: Some(event_loop), token }))
            }
        })
    }

    /// Asks for a window that is shown while this thread goes on.
    #[cfg(not(target_os = "macos"))]
    pub fn elsewhere(options: ViewerOptions) -> Result<(Self, Back), ViewerError> {
        Ok(Self::of(&event_loop::host()?, Token::next(), options, None))
    }

    fn of(proxy: &EventLoopProxy<Wake>, token: Token, options: ViewerOptions, here: Option<Here>) -> (Self, Back) {
        let waker = Waker::new(proxy.clone(), token);
        let told = waker.clone();
        let (front, back) = link(move || told.look());
        // For the plots. Nothing of the window's is simulated yet.
        enable_timers();
        let (sender, opened) = mpsc::channel();
        let opening = Opening { waker, front, options, opened: sender };
        // If the loop has ended, the opening is dropped, and with it what would tell that the window came.
        let _ = proxy.send_event(Wake::Open(Box::new(opening)));
        (Self { here, opened: Opened(opened) }, back)
    }

    /// What is to be done for the window to come, if it is this thread's, and what tells whether it came.
    pub fn split(self) -> (Option<Here>, Opened) {
        (self.here, self.opened)
    }
}

impl Here {
    /// Shows the window until it is closed.
    pub fn show(mut self) -> Result<(), ViewerError> {
        self.event_loop.take().map_or(Ok(()), |event_loop| event_loop::run_here(event_loop, self.token))
    }
}

impl Drop for Here {
    fn drop(&mut self) {
        if let Some(event_loop) = self.event_loop.take() {
            event_loop::rest(event_loop);
        }
    }
}

impl Opened {
    /// Waits until the window came or did not.
    pub fn wait(self) -> Result<(), ViewerError> {
        self.0.recv().map_err(|_| ViewerError::Window("the thread of the windows has ended".to_owned()))?
    }
}
