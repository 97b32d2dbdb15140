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
mod screen;
mod session;
mod translate;
mod wake;

use std::sync::mpsc;

use crate::viewer::error::ViewerError;
use super::launch::ViewerOptions;
use super::link::{Back, Front, link};
use wake::{Token, Wake, Waker};
use winit::event_loop::{EventLoop, EventLoopProxy};

/// A window that is to be opened.
struct Opening {
    waker: Waker,
    front: Front,
    options: ViewerOptions,
    /// Told whether it was.
    opened: mpsc::Sender<Result<(), ViewerError>>,
}

/// A window that is asked for, and what tells whether it came.
pub(super) struct Asked {
    place: Option<EventLoop<Wake>>,
    opened: mpsc::Receiver<Result<(), ViewerError>>,
}

impl Asked {
    /// Asks for a window of this thread's. [`wait`](Self::wait) shows it.
    pub fn here(options: ViewerOptions) -> Result<(Self, Back), ViewerError> {
        Ok(match event_loop::place()? {
            event_loop::Place::Hosted(proxy) => Self::of(&proxy, options, None),
            event_loop::Place::Here(place) => Self::of(&place.create_proxy(), options, Some(place)),
        })
    }

    /// Asks for a window that is shown while this thread goes on.
    #[cfg(not(target_os = "macos"))]
    pub fn elsewhere(options: ViewerOptions) -> Result<(Self, Back), ViewerError> {
        Ok(Self::of(&event_loop::host()?, options, None))
    }

    fn of(proxy: &EventLoopProxy<Wake>, options: ViewerOptions, place: Option<EventLoop<Wake>>) -> (Self, Back) {
        let waker = Waker::new(proxy.clone(), Token::next());
        let told = waker.clone();
        let (front, back) = link(move || told.look());
        let (sender, opened) = mpsc::channel();
        let opening = Opening { waker, front, options, opened: sender };
        // If the loop has ended, the opening is dropped, and with it what would tell that the window came.
        let _ = proxy.send_event(Wake::Open(Box::new(opening)));
        (Self { place, opened }, back)
    }

    /// Whether the loop is this thread's, so that it has to be run for the window to come.
    pub fn is_here(&self) -> bool {
        self.place.is_some()
    }

    /// Shows the window until it is closed, if it is this thread's. Otherwise waits until it has come.
    pub fn wait(self) -> Result<(), ViewerError> {
        if let Some(place) = self.place {
            event_loop::run_here(place)?;
        }
        self.opened.recv().map_err(|_| ViewerError::Window("the thread of the windows has ended".to_owned()))?
    }
}
