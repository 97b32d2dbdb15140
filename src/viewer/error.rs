//! Errors of the viewer.

use crate::error::{Error, debug_as_display};
use crate::render::RenderError;

/// Reason why a window could not be shown or has ended early.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// No display is available.
    #[error(
        "no display is available for a window ({0}). On Linux, DISPLAY must name an X server, and the libraries of X must be \
         installed (Debian's packages libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0); on a machine \
         without a screen, xvfb-run provides a virtual display, and the renderer needs no window"
    )]
    NoDisplay(String),

    /// Another thread of this process shows viewers. An event loop cannot move between threads.
    #[error(
        "another thread of this program shows viewers: the windowing system allows one event loop per program, which cannot move \
         between threads. Open all viewers from that thread, or all of them with viewer::launch"
    )]
    OtherThread,

    /// This thread waits for another viewer to be closed.
    #[error("this thread already shows a viewer, or has panicked while it did")]
    Nested,

    /// The program has created an event loop of the windowing library itself.
    #[error("this program has created an event loop itself, but a process can have only one, which the viewer needs")]
    EventLoopTaken,

    /// The window cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),

    /// The windowing system has failed.
    #[error("the window failed: {0}")]
    Window(String),

    /// A thread could not be started.
    #[error("a thread could not be started: {0}")]
    Thread(#[source] std::io::Error),

    /// Another error of this crate.
    #[error(transparent)]
    Other(#[from] Error),
}

debug_as_display!(ViewerError);
