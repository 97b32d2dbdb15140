//! Ctrl-C in the terminal closes the windows in order, so that a recording is finished and the program goes on after them.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, Once, PoisonError};

use winit::event_loop::EventLoopProxy;

use super::wake::Wake;

/// How a shell tells that a program was ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

static WINDOWS: AtomicUsize = AtomicUsize::new(0);
static PROXY: Mutex<Option<EventLoopProxy<Wake>>> = Mutex::new(None);
static ONCE: Once = Once::new();

/// While it lives, Ctrl-C closes the windows. Where there are none, it ends the program, as it does without this.
pub(super) struct Guard(());

impl Guard {
    pub fn new(proxy: &EventLoopProxy<Wake>) -> Self {
        *PROXY.lock().unwrap_or_else(PoisonError::into_inner) = Some(proxy.clone());
        WINDOWS.fetch_add(1, Ordering::AcqRel);
        ONCE.call_once(|| {
            if let Err(error) = ctrlc::try_set_handler(interrupted) {
                // The program has one of its own.
                log::debug!("Ctrl-C is left as it is: {error}");
            }
        });
        Self(())
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        WINDOWS.fetch_sub(1, Ordering::AcqRel);
    }
}

fn interrupted() {
    if WINDOWS.load(Ordering::Acquire) == 0 {
        std::process::exit(INTERRUPTED);
    }
    if let Some(proxy) = &*PROXY.lock().unwrap_or_else(PoisonError::into_inner) {
        let _ = proxy.send_event(Wake::CloseAll);
    }
}
