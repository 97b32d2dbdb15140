//! Why there is no window.

use crate::error::Error;
use crate::render::RenderError;

/// Why a viewer could not be shown, or has ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// There is no display: nothing to open a window on.
    #[error(
        "there is no display to open a window on ({0}). On Linux, DISPLAY has to name an X server; where there is no screen, \
         xvfb-run makes one that is not seen, and the renderer draws pictures without a window"
    )]
    NoDisplay(String),

    /// Another thread of this process shows viewers. An event loop cannot be handed from thread to thread.
    #[error(
        "another thread of this program shows viewers, and it alone can: the windowing system gives a program one event loop. \
         Open all viewers from that thread, or all of them with viewer::launch"
    )]
    OtherThread,

    /// This thread waits for a viewer to be closed, and cannot show another meanwhile.
    #[error("this thread shows a viewer already, or has panicked while it did")]
    Nested,

    /// The program uses the windowing library itself.
    #[error("this program has made an event loop of its own, besides which there can be no viewer: a process has one")]
    EventLoopTaken,

    /// Nothing can draw to the window.
    #[error(transparent)]
    Render(#[from] RenderError),

    /// The windowing system has failed.
    #[error("the window failed: {0}")]
    Window(String),

    /// A thread could not be started.
    #[error("a thread could not be started: {0}")]
    Thread(#[source] std::io::Error),

    /// What was asked for is not possible.
    #[error(transparent)]
    Engine(#[from] Error),
}
