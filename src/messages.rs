//! Warnings of the engine: collected while a call runs, and logged after it.
//!
//! A logger is code of the application, which may call the engine, wait for a lock or panic. While
//! an engine since 3.10 calls the handler of a warning, it drops each error of the thread and goes
//! on, so a call by the logger could access memory out of bounds. A model that the logger loads
//! would wait for the lock of a load in progress.

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char};
use std::mem;
use std::sync::{Mutex, PoisonError};

use mujoco_sys::guard;

use crate::error::catch_panic;

/// Log target of the engine's messages.
pub(crate) const LOG_TARGET: &str = "mujoco";

thread_local! {
    /// `true` if the thread has warnings to log.
    static HAS_WARNINGS: Cell<bool> = const { Cell::new(false) };
    /// Number of reasons in this thread for not logging now.
    static HOLDERS: Cell<usize> = const { Cell::new(0) };
    /// Warnings of this thread that are not logged yet.
    static WARNINGS: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Warnings of the threads in which the compiler processes meshes, and of threads that are ending.
static OF_OTHER_THREADS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Handles a warning of the engine. The default handler would print it and write `MUJOCO_LOG.TXT`
/// to the working directory.
pub(crate) unsafe extern "C" fn on_warning(message: *const c_char) {
    // A panic, for lack of memory, must not unwind through C frames.
    let _ = catch_panic(|| {
        // SAFETY: the engine passes a NUL-terminated string.
        let mut message = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
        // SAFETY: takes no arguments.
        if unsafe { guard::is_guarded() } != 0 {
            // The access fails only in a thread that is ending.
            let keep = |warnings: &RefCell<Vec<String>>| warnings.borrow_mut().push(mem::take(&mut message));
            if WARNINGS.try_with(keep).is_ok() {
                return HAS_WARNINGS.set(true);
            }
        }
        OF_OTHER_THREADS.lock().unwrap_or_else(PoisonError::into_inner).push(message);
    });
}

/// Logs a warning that a simulation has counted, unless warnings are held back or collected.
#[cold]
pub(crate) fn warn(message: &str) {
    let keep = |warnings: &RefCell<Vec<String>>| warnings.borrow_mut().push(message.to_owned());
    if HOLDERS.get() > 0 && WARNINGS.try_with(keep).is_ok() {
        HAS_WARNINGS.set(true);
    } else {
        log::warn!(target: LOG_TARGET, "{message}");
    }
}

/// Logs the warnings of the call that has just returned. Costs the reading of a flag if there are
/// none.
#[inline]
pub(crate) fn log_after_call() {
    if HAS_WARNINGS.get() {
        log();
    }
}

#[cold]
fn log() {
    if HOLDERS.get() > 0 {
        return;
    }
    HAS_WARNINGS.set(false);
    for message in WARNINGS.try_with(RefCell::take).unwrap_or_default() {
        // The caller has not recorded the result of the call yet, so a panic of the logger ends
        // here.
        let _ = catch_panic(|| log::warn!(target: LOG_TARGET, "{message}"));
    }
}

/// Delays the logging in this thread until the value is dropped, because the thread has a lock.
#[derive(Debug)]
pub(crate) struct HeldBack(());

impl HeldBack {
    pub(crate) fn new() -> Self {
        HOLDERS.set(HOLDERS.get() + 1);
        Self(())
    }
}

impl Drop for HeldBack {
    fn drop(&mut self) {
        HOLDERS.set(HOLDERS.get() - 1);
        log_after_call();
    }
}

/// Calls a function, and returns the warnings of its calls of the engine instead of logging them.
pub(crate) fn collecting_warnings<T>(call: impl FnOnce() -> T) -> (T, Vec<String>) {
    let held = HeldBack::new();
    // A destructor of a thread-local may load a model after this thread-local was destroyed.
    let outer = WARNINGS.try_with(RefCell::take).unwrap_or_default();
    let result = call();
    HAS_WARNINGS.set(!outer.is_empty());
    let warnings = WARNINGS.try_with(|warnings| warnings.replace(outer)).unwrap_or_default();
    drop(held);
    (result, warnings)
}

/// Returns the warnings of the compiler's threads. The caller has the lock of loads.
pub(crate) fn of_other_threads() -> Vec<String> {
    mem::take(&mut OF_OTHER_THREADS.lock().unwrap_or_else(PoisonError::into_inner))
}
