//! Open windows of the process, which signals and the end of the process close.

use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use winit::event_loop::EventLoopProxy;

use super::wake::Wake;
use crate::render::DriverUse;
use crate::viewer::error::ViewerError;

/// Exit status of a program that a signal has ended. The number means SIGINT by the convention of
/// shells, because the handler does not receive the signal.
const INTERRUPTED: i32 = 130;

struct OpenWindows {
    number: usize,
    /// Proxy of the event loop of the last window.
    proxy: Option<EventLoopProxy<Wake>>,
}

static OPEN: Mutex<OpenWindows> = Mutex::new(OpenWindows { number: 0, proxy: None });
static SIGNALS: Once = Once::new();

fn open() -> MutexGuard<'static, OpenWindows> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

impl OpenWindows {
    fn close_all(&self) {
        if let Some(proxy) = &self.proxy {
            let _ = proxy.send_event(Wake::CloseAll);
        }
    }
}

/// Registration of an open window, created before its graphics resources and dropped after them.
/// While a registration exists, Ctrl-C, SIGTERM and SIGHUP close the windows, so that a running
/// recording is finished and the program continues. Without windows, these signals end the program.
/// The end of the process closes the windows, too, and waits until they are destroyed.
pub(super) struct OpenWindow {
    /// Makes the end of the process wait.
    _driver_use: DriverUse,
}

impl OpenWindow {
    /// Registers a window of the calling thread.
    pub fn register(proxy: &EventLoopProxy<Wake>) -> Result<Self, ViewerError> {
        let driver_use = DriverUse::begin_long(|| open().close_all())
            .ok_or_else(|| ViewerError::Window("the process is ending".to_owned()))?;
        let mut open = open();
        open.number += 1;
        open.proxy = Some(proxy.clone());
        drop(open);
        SIGNALS.call_once(|| {
            if let Err(error) = ctrlc::try_set_handler(handle_interrupt) {
                // The program handles one of the signals itself, or ignores it as under `nohup`.
                log::debug!("the viewer does not handle Ctrl-C, SIGTERM and SIGHUP: {error}");
            }
        });
        Ok(Self { _driver_use: driver_use })
    }
}

impl Drop for OpenWindow {
    fn drop(&mut self) {
        open().number -= 1;
    }
}

fn handle_interrupt() {
    let open = open();
    if open.number == 0 {
        drop(open);
        std::process::exit(INTERRUPTED);
    }
    open.close_all();
}
