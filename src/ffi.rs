//! Conversion between C and Rust: arrays that may be NULL, strings, sizes, the status of a guarded
//! call, and exit handlers. This is the only file that calls `from_raw_parts`.

#![allow(clippy::disallowed_methods, reason = "the lint confines `from_raw_parts` and `check` to a few files")]

use std::ffi::{CStr, CString, c_char, c_int};

use mujoco_sys::guard;

use crate::error::{Error, InvalidKind, Result};
use crate::messages;

/// Integer type of a size in some version of the engine.
pub(crate) trait Size {
    fn to_usize(self) -> usize;
}

macro_rules! sizes {
    ($($integer:ty)*) => { $(
        impl Size for $integer {
            #[inline]
            fn to_usize(self) -> usize {
                self as usize
            }
        }
    )* };
}
sizes! { u8 c_int u64 usize }

impl Size for i64 {
    /// Since 2.3 the limits of contacts and constraints are -1 if there is none.
    #[inline]
    fn to_usize(self) -> usize {
        usize::try_from(self).unwrap_or(0)
    }
}

/// Converts a C size. The engine has no negative sizes.
#[inline]
pub(crate) fn size(size: impl Size) -> usize {
    size.to_usize()
}

/// Converts the limit on contacts or constraints, which is -1 since 2.3 if there is none.
#[inline]
pub(crate) fn limit(limit: impl TryInto<usize>) -> usize {
    limit.try_into().unwrap_or(0)
}

/// Registers a function that is called while the process ends, before all functions that were
/// registered earlier. A failed registration has no effect.
#[cfg(feature = "renderer")]
pub(crate) fn at_exit(function: extern "C" fn()) {
    unsafe extern "C" {
        fn atexit(function: extern "C" fn()) -> c_int;
    }
    // SAFETY: a function of the C library that stores a pointer at a function, and calls it before
    // the code of the function is unloaded.
    unsafe { atexit(function) };
}

/// Returns the array at `array` as a slice, which is empty for NULL. The engine stores NULL for
/// empty arrays.
///
/// # Safety
///
/// `array` is NULL or points at `length` initialised values that nothing writes to during `'a`.
#[inline]
pub(crate) unsafe fn array<'a, T>(array: *const T, length: usize) -> &'a [T] {
    if array.is_null() || length == 0 {
        return &[];
    }
    // SAFETY: not NULL; the caller guarantees the rest.
    unsafe { std::slice::from_raw_parts(array, length) }
}

/// Returns `true` if `predicate` holds for all values of an array. Runs in every step of a
/// simulation: building the slice of [`array`] takes longer than testing the few numbers of a small
/// model.
///
/// # Safety
///
/// As for [`array`], and `array` is not NULL unless `length` is zero.
#[inline]
pub(crate) unsafe fn all<T: Copy>(array: *const T, length: usize, predicate: impl Fn(T) -> bool) -> bool {
    // SAFETY: the index is below `length`, so `length` is not zero and `array` is not NULL.
    (0..length).all(|index| predicate(unsafe { *array.add(index) }))
}

/// Returns the array at `array` as a mutable slice, which is empty for NULL.
///
/// # Safety
///
/// As for [`array`], and nothing else reads or writes the values during `'a`.
#[inline]
pub(crate) unsafe fn array_mut<'a, T>(array: *mut T, length: usize) -> &'a mut [T] {
    if array.is_null() || length == 0 {
        return &mut [];
    }
    // SAFETY: not NULL; the caller guarantees the rest.
    unsafe { std::slice::from_raw_parts_mut(array, length) }
}

/// Returns the array at `values` as rows of `N` values.
///
/// # Safety
///
/// As for [`array`], with `rows * N` values.
#[inline]
pub(crate) unsafe fn rows<'a, T, const N: usize>(values: *const T, rows: usize) -> &'a [[T; N]] {
    // SAFETY: `[T; N]` has the alignment of `T` and the size of `N` of them; the caller guarantees
    // the rest.
    unsafe { array(values.cast::<[T; N]>(), rows) }
}

/// Returns the array at `values` as mutable rows of `N` values.
///
/// # Safety
///
/// As for [`array_mut`], with `rows * N` values.
#[inline]
pub(crate) unsafe fn rows_mut<'a, T, const N: usize>(values: *mut T, rows: usize) -> &'a mut [[T; N]] {
    // SAFETY: as in `rows`.
    unsafe { array_mut(values.cast::<[T; N]>(), rows) }
}

/// Returns a structure that `make` initialises.
///
/// # Safety
///
/// `make` writes a valid structure.
#[inline]
pub(crate) unsafe fn made_by<T>(make: impl FnOnce(*mut T)) -> T {
    let mut made = std::mem::MaybeUninit::uninit();
    make(made.as_mut_ptr());
    // SAFETY: the caller's promise.
    unsafe { made.assume_init() }
}

/// Copies a C string. Bytes that are not UTF-8 become replacement characters; NULL becomes an empty
/// string.
///
/// # Safety
///
/// `text` is NULL or a NUL-terminated string.
pub(crate) unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller guarantees a NUL-terminated string.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// Converts text to a C string. A NUL byte inside would truncate the string in C, so it is an
/// error.
pub(crate) fn c_string(what: &'static str, text: impl Into<Vec<u8>>) -> Result<CString> {
    CString::new(text).map_err(|error| {
        Error::invalid(
            InvalidKind::Text,
            what,
            format!("text with a NUL byte at position {}", error.nul_position()),
            "text without NUL bytes",
        )
    })
}

/// Converts the status of a guarded call without a simulation, or on one that is dropped after an
/// error, to a result. Such a call has no data to poison. Calls on a [`Data`](crate::Data) go
/// through its methods in `data/call.rs`.
#[inline]
pub(crate) fn check_without_data(function: &'static str, status: c_int) -> Result<()> {
    check(function, status)
}

/// Converts the status of a guarded call to a result. Only for the functions that decide about
/// poisoning: `data/call.rs` and [`check_without_data`].
#[inline]
pub(crate) fn check(function: &'static str, status: c_int) -> Result<()> {
    let result = if status == guard::OK { Ok(()) } else { Err(engine_error(function, status)) };
    messages::log_after_call();
    result
}

/// Returns the error that this thread's last guarded call caught.
#[cold]
fn engine_error(function: &'static str, status: c_int) -> Error {
    if status == guard::OUT_OF_MEMORY {
        return Error::OutOfMemory { function };
    }
    // SAFETY: the pointer is a NUL-terminated buffer of this thread, which only the next caught
    // error of this thread changes.
    let message = unsafe { text(guard::message()) };
    Error::Engine { function, message }
}
