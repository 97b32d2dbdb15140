//! Messages to the thread of the event loop, and the state of its connection.

use std::fmt::Display;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use winit::event_loop::EventLoopProxy;

use super::Opening;

/// Message of the error about a lost connection.
pub(super) const CONNECTION_LOST: &str = "the connection to the X server was lost: the server has ended";

/// Most calls of the windowing library panic after the loss.
#[cfg(target_os = "linux")]
pub(super) use crate::x11::is_lost as connection_is_lost;

/// Returns `true` if the connection to the display server was lost, which does not happen on this
/// platform.
#[cfg(not(target_os = "linux"))]
pub(super) fn connection_is_lost() -> bool {
    false
}

/// Returns the text of an error of the windowing library, without the place in its source code that
/// precedes errors of the system.
pub(super) fn message_of(error: &impl Display) -> String {
    let text = error.to_string();
    match text.strip_prefix("os error at ").and_then(|rest| rest.split_once(": ")) {
        Some((_place, message)) => message.to_owned(),
        None => text,
    }
}

/// Identifier of a window for other threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct WindowToken(u64);

impl WindowToken {
    /// Returns a unique token.
    pub fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// Message to the thread of the event loop.
pub(super) enum Wake {
    /// Opens a window.
    Open(Box<Opening>),
    /// Notifies a window of a new snapshot or event, or of its closing.
    Update(WindowToken),
    /// Closes all windows.
    CloseAll,
    /// Ends all windows after the loss of the connection to the display server.
    #[cfg_attr(not(target_os = "linux"), allow(dead_code, reason = "only Linux has this connection"))]
    ConnectionLost,
}

/// Sender of update messages for one window.
#[derive(Clone)]
pub(super) struct Waker {
    proxy: EventLoopProxy<Wake>,
    token: WindowToken,
    /// A message was sent and has not been acknowledged yet.
    pending: Arc<AtomicBool>,
}

impl Waker {
    pub fn new(proxy: EventLoopProxy<Wake>, token: WindowToken) -> Self {
        Self { proxy, token, pending: Arc::default() }
    }

    /// Sends an update message, unless the last message has not been acknowledged yet.
    pub fn wake(&self) {
        if !self.pending.swap(true, Ordering::SeqCst) {
            let _ = self.proxy.send_event(Wake::Update(self.token));
        }
    }

    pub fn token(&self) -> WindowToken {
        self.token
    }

    pub fn proxy(&self) -> &EventLoopProxy<Wake> {
        &self.proxy
    }

    /// Acknowledges the messages so far. The next update sends a message again.
    pub fn acknowledge(&self) {
        // Not a store, which the processor may delay until after the window has looked for updates:
        // an update between both would be lost.
        self.pending.swap(false, Ordering::SeqCst);
    }
}
