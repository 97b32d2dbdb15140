//! Open windows of the process, which signals and the end of the process close.
//!
//! A graphics driver frees its static data while the process ends. A thread that still draws, or that still unloads the driver, would
//! then read freed memory. The end of the process therefore waits until the windows are destroyed.

use std::cell::Cell;
use std::sync::{Condvar, Mutex, MutexGuard, Once, PoisonError};
use std::time::Duration;

use winit::event_loop::EventLoopProxy;

use super::event_loop::Wake;
use crate::ffi::at_exit;
use crate::viewer::error::ViewerError;

/// Exit status of a program that a signal has ended. The number is that of SIGINT by the convention of shells, because the handler does
/// not receive the signal.
const INTERRUPTED: i32 = 130;

/// Longest time for which the end of the process waits for the windows: several frames of a slow driver.
const EXIT_TIMEOUT: Duration = Duration::from_secs(10);

struct OpenWindows {
    number: usize,
    /// Proxy of the event loop of the last window.
    proxy: Option<EventLoopProxy<Wake>>,
    /// The process ends, so no window opens.
    exiting: bool,
}

static OPEN: Mutex<OpenWindows> = Mutex::new(OpenWindows { number: 0, proxy: None, exiting: false });
/// Notified when a window was destroyed.
static DESTROYED: Condvar = Condvar::new();
static SIGNALS: Once = Once::new();

thread_local! {
    /// This thread has opened a window, so it runs the event loop.
    static RUNS_EVENT_LOOP: Cell<bool> = const { Cell::new(false) };
}

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

/// Registration of an open window, created before its graphics resources and dropped after them. While a registration exists, Ctrl-C,
/// SIGTERM and SIGHUP close the windows, so that a running recording is finished and the program continues. Without windows, these
/// signals end the program.
pub(super) struct OpenWindow {
    frames: u64,
}

impl OpenWindow {
    /// Registers a window of the calling thread.
    pub fn register(proxy: &EventLoopProxy<Wake>) -> Result<Self, ViewerError> {
        RUNS_EVENT_LOOP.set(true);
        let mut open = open();
        if open.exiting {
            return Err(ViewerError::Window("the process is ending".to_owned()));
        }
        open.number += 1;
        open.proxy = Some(proxy.clone());
        drop(open);
        SIGNALS.call_once(|| {
            if let Err(error) = ctrlc::try_set_handler(handle_interrupt) {
                // The program handles one of the signals itself, or ignores it as under `nohup`.
                log::debug!("the viewer does not handle Ctrl-C, SIGTERM and SIGHUP: {error}");
            }
        });
        Ok(Self { frames: 0 })
    }

    /// Counts a frame. The shader compiler registers further handlers when it first needs them, so the handler is registered again at
    /// intervals that grow.
    pub fn frame_finished(&mut self) {
        self.frames += 1;
        if self.frames.is_power_of_two() {
            delay_exit();
        }
    }
}

impl Drop for OpenWindow {
    fn drop(&mut self) {
        open().number -= 1;
        DESTROYED.notify_all();
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

/// Makes the end of the process wait for the windows. Exit handlers run in reverse order, so this is called after the driver and its shader
/// compiler have registered theirs.
pub(super) fn delay_exit() {
    at_exit(close_at_exit);
}

/// Closes all windows, and waits until they are destroyed.
extern "C" fn close_at_exit() {
    let mut open = open();
    open.exiting = true;
    // The thread of the event loop cannot wait for itself.
    if open.number > 0 && !RUNS_EVENT_LOOP.get() {
        open.close_all();
        let _ = DESTROYED.wait_timeout_while(open, EXIT_TIMEOUT, |open| open.number > 0);
    }
}
