//! Capture of text that C libraries print to `stderr`.

use std::ffi::{CStr, c_char};

unsafe extern "C" {
    fn mujoco_sys_capture_begin() -> usize;
    fn mujoco_sys_capture_end(mark: usize) -> *const c_char;
}

/// Ends the capture on drop, so also if the captured closure panics.
struct Capture(usize);

impl Capture {
    fn end(&self) -> String {
        // SAFETY: the capture began in this thread and ends once. The text is this thread's buffer,
        // is terminated by NUL, and is copied before the next capture ends.
        unsafe { CStr::from_ptr(mujoco_sys_capture_end(self.0)) }.to_string_lossy().into_owned()
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        self.end();
    }
}

/// Runs `call` and returns its result and the first 4095 bytes that this thread printed to the C
/// library's `stderr` during the call. The captured text is not printed. Output of other threads,
/// and of Rust's `eprintln!`, which does not use the C library, is not captured. Meanwhile messages
/// of the convex hull library in threads of the engine's compiler are discarded.
///
/// Requires glibc. With other C libraries the text is printed and the returned text is empty.
///
/// ```
/// let (sum, printed) = mujoco_sys::stderr::captured(|| 1 + 1);
/// assert_eq!((sum, &*printed), (2, ""));
/// ```
pub fn captured<T>(call: impl FnOnce() -> T) -> (T, String) {
    // SAFETY: no precondition.
    let capture = Capture(unsafe { mujoco_sys_capture_begin() });
    let result = call();
    let text = capture.end();
    std::mem::forget(capture);
    (result, text)
}
