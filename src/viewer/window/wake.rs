//! What other threads tell the thread of the windows.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use winit::event_loop::EventLoopProxy;

use super::Opening;

/// A window as other threads name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Token(u64);

impl Token {
    /// One that no window had before.
    pub fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// A message to the thread of the windows.
pub(super) enum Wake {
    /// A window is to be opened.
    Open(Box<Opening>),
    /// There is something new to be seen in a window.
    Look(Token),
    /// All windows are to be closed.
    CloseAll,
}

/// Wakes the thread of the windows for one of them.
#[derive(Clone)]
pub(super) struct Waker {
    proxy: EventLoopProxy<Wake>,
    token: Token,
    /// Whether it has been told and has not looked yet.
    told: Arc<AtomicBool>,
}

impl Waker {
    pub fn new(proxy: EventLoopProxy<Wake>, token: Token) -> Self {
        Self { proxy, token, told: Arc::default() }
    }

    /// There is something new to be seen. Cheap where nobody has looked since it was said last.
    pub fn look(&self) {
        if !self.told.swap(true, Ordering::AcqRel) {
            let _ = self.proxy.send_event(Wake::Look(self.token));
        }
    }

    pub fn token(&self) -> Token {
        self.token
    }

    pub fn proxy(&self) -> &EventLoopProxy<Wake> {
        &self.proxy
    }

    /// The window looks now; what comes after is told again.
    pub fn looked(&self) {
        self.told.store(false, Ordering::Release);
    }
}
