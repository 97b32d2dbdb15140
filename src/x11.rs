//! Loss of the connection to the X server, after which Xlib ends the process by default.

use std::ffi::{CStr, c_char, c_int, c_short, c_ulong, c_void};
use std::mem::transmute;
use std::ptr::{NonNull, null_mut};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use winit::raw_window_handle::{DisplayHandle, RawDisplayHandle};

type ErrorHandler = unsafe extern "C" fn(*mut c_void) -> c_int;
type ExitHandler = extern "C" fn(*mut c_void, *mut c_void);

unsafe extern "C" {
    fn dlopen(file: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
    fn poll(descriptors: *mut PollDescriptor, count: c_ulong, timeout: c_int) -> c_int;
}

/// `struct pollfd`.
#[repr(C)]
struct PollDescriptor {
    descriptor: c_int,
    events: c_short,
    found: c_short,
}

const RTLD_LAZY: c_int = 1;
const POLLERR: c_short = 8;
const POLLHUP: c_short = 16;

/// Connection of the windowing library, which has a single one in a process and never closes it.
struct Connection {
    /// Address of the `Display`.
    display: usize,
    descriptor: c_int,
    /// Handler of the errors of other displays.
    previous: OnceLock<ErrorHandler>,
    on_loss: Box<dyn Fn() + Send + Sync>,
}

static CONNECTION: OnceLock<Connection> = OnceLock::new();
static IS_LOST: AtomicBool = AtomicBool::new(false);

/// Makes Xlib call a function in the thread of the connection, instead of ending the process, when
/// it finds that the connection was lost. The calls of Xlib with this display fail from then on.
/// Returns `false` with a version of Xlib before 1.7, which cannot do this, and for the display of
/// another windowing system.
pub(crate) fn watch(display: DisplayHandle<'_>, on_loss: impl Fn() + Send + Sync + 'static) -> bool {
    let RawDisplayHandle::Xlib(handle) = display.as_raw() else { return false };
    let Some(display) = handle.display else { return false };
    let (Some(set_exit_handler), Some(set_error_handler), Some(connection_number)) =
        (symbol(c"XSetIOErrorExitHandler"), symbol(c"XSetIOErrorHandler"), symbol(c"XConnectionNumber"))
    else {
        return false;
    };
    // SAFETY: Xlib declares the function with this signature.
    let set_exit_handler = unsafe {
        transmute::<NonNull<c_void>, unsafe extern "C" fn(*mut c_void, ExitHandler, *mut c_void)>(set_exit_handler)
    };
    // SAFETY: Xlib declares the function with this signature.
    let set_error_handler = unsafe {
        transmute::<NonNull<c_void>, unsafe extern "C" fn(ErrorHandler) -> Option<ErrorHandler>>(set_error_handler)
    };
    // SAFETY: Xlib declares the function with this signature.
    let connection_number =
        unsafe { transmute::<NonNull<c_void>, unsafe extern "C" fn(*mut c_void) -> c_int>(connection_number) };

    let connection = Connection {
        display: display.as_ptr() as usize,
        // SAFETY: a `DisplayHandle` exists only while its display is open.
        descriptor: unsafe { connection_number(display.as_ptr()) },
        previous: OnceLock::new(),
        on_loss: Box::new(on_loss),
    };
    if CONNECTION.set(connection).is_err() {
        return false;
    }
    // SAFETY: as above; the handler does not use the user pointer.
    unsafe { set_exit_handler(display.as_ptr(), handle_exit, null_mut()) };
    // SAFETY: the handler is a function of this library with the expected signature.
    let previous = unsafe { set_error_handler(handle_error) };
    if let (Some(connection), Some(previous)) = (CONNECTION.get(), previous) {
        let _ = connection.previous.set(previous);
    }
    true
}

/// Returns `true` if the connection was lost, even if Xlib has not found this yet.
pub(crate) fn is_lost() -> bool {
    let Some(connection) = CONNECTION.get() else { return false };
    if !IS_LOST.load(Ordering::Acquire) {
        let mut descriptor = PollDescriptor { descriptor: connection.descriptor, events: 0, found: 0 };
        // SAFETY: one descriptor, which lives during the call, which does not wait.
        let number = unsafe { poll(&raw mut descriptor, 1, 0) };
        if number > 0 && descriptor.found & (POLLERR | POLLHUP) != 0 {
            IS_LOST.store(true, Ordering::Release);
        }
    }
    IS_LOST.load(Ordering::Acquire)
}

/// Returns the function of Xlib with this name.
fn symbol(name: &CStr) -> Option<NonNull<c_void>> {
    // SAFETY: the name ends with NUL. The windowing library has loaded Xlib before, so this only
    // finds it. It stays loaded.
    let library = unsafe { dlopen(c"libX11.so.6".as_ptr(), RTLD_LAZY) };
    if library.is_null() {
        return None;
    }
    // SAFETY: the library is loaded and the name ends with NUL.
    NonNull::new(unsafe { dlsym(library, name.as_ptr()) })
}

/// Called by Xlib before the exit handler of the display. The default prints a message and ends the
/// process.
unsafe extern "C" fn handle_error(display: *mut c_void) -> c_int {
    let Some(connection) = CONNECTION.get() else { return 0 };
    if display as usize == connection.display {
        return 0;
    }
    // SAFETY: Xlib has called this function as it would have called the previous handler.
    connection.previous.get().map_or(0, |previous| unsafe { previous(display) })
}

/// Called by Xlib instead of the end of the process.
extern "C" fn handle_exit(_: *mut c_void, _: *mut c_void) {
    IS_LOST.store(true, Ordering::Release);
    if let Some(connection) = CONNECTION.get() {
        (connection.on_loss)();
    }
}
