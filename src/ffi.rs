//! Conversion between C and Rust: arrays that may be NULL, strings, sizes, and the status of a guarded call. The only file with
//! `from_raw_parts`.

#![allow(clippy::disallowed_methods, reason = "the lint keeps `from_raw_parts` and the uses of `check` in few files")]

use std::ffi::{CStr, CString, c_char, c_int};

use mujoco_sys::guard;

use crate::error::{Error, Result};

/// A C size as a Rust one. The engine has no negative sizes.
#[inline]
pub(crate) fn size(size: c_int) -> usize {
    size as usize
}

/// The array at `array`, empty if the engine has none (it keeps NULL for those).
///
/// # Safety
///
/// `array` is NULL or points at `length` initialised values that nothing writes to during `'a`.
#[inline]
pub(crate) unsafe fn array<'a, T>(array: *const T, length: usize) -> &'a [T] {
    if array.is_null() || length == 0 {
        return &[];
    }
    // SAFETY: not NULL, and the rest is the caller's promise.
    unsafe { std::slice::from_raw_parts(array, length) }
}

/// Whether `is` holds for all values of an array. For each step of a simulation: the slice of [`array`] takes longer to make than
/// the few numbers of a small model to look at.
///
/// # Safety
///
/// As for [`array`], and `array` is not NULL unless `length` is zero.
#[inline]
pub(crate) unsafe fn all<T: Copy>(array: *const T, length: usize, is: impl Fn(T) -> bool) -> bool {
    // SAFETY: within the array, which is there since it has a value.
    (0..length).all(|index| is(unsafe { *array.add(index) }))
}

/// As [`array`], to be written to.
///
/// # Safety
///
/// As for [`array`], and nothing else reads or writes the values during `'a`.
#[inline]
pub(crate) unsafe fn array_mut<'a, T>(array: *mut T, length: usize) -> &'a mut [T] {
    if array.is_null() || length == 0 {
        return &mut [];
    }
    // SAFETY: not NULL, and the rest is the caller's promise.
    unsafe { std::slice::from_raw_parts_mut(array, length) }
}

/// As [`array`], in rows of `N` values.
///
/// # Safety
///
/// As for [`array`], with `rows * N` values.
#[inline]
pub(crate) unsafe fn rows<'a, T, const N: usize>(values: *const T, rows: usize) -> &'a [[T; N]] {
    // SAFETY: `[T; N]` has the alignment of `T` and the size of `N` of them; the rest is the caller's promise.
    unsafe { array(values.cast::<[T; N]>(), rows) }
}

/// As [`array_mut`], in rows of `N` values.
///
/// # Safety
///
/// As for [`array_mut`], with `rows * N` values.
#[inline]
pub(crate) unsafe fn rows_mut<'a, T, const N: usize>(values: *mut T, rows: usize) -> &'a mut [[T; N]] {
    // SAFETY: as in `rows`.
    unsafe { array_mut(values.cast::<[T; N]>(), rows) }
}

/// What is behind a C string. Text that is not UTF-8 keeps its shape, with replacement characters.
///
/// # Safety
///
/// `text` is NULL or a NUL-terminated string.
pub(crate) unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// A C string for the engine. A NUL inside would cut it short there, so it is an error.
pub(crate) fn c_string(what: &'static str, text: impl Into<Vec<u8>>) -> Result<CString> {
    CString::new(text).map_err(|error| {
        Error::invalid(
            what,
            format!("text with a NUL byte at position {}", error.nul_position()),
            "text without NUL bytes",
        )
    })
}

/// Turns the status of a guarded call on no simulation, or on one that is dropped after an error, into a result. There is
/// nothing to poison. Calls on a [`Data`](crate::Data) go through its methods in `data/call.rs`.
#[inline]
pub(crate) fn check_without_data(function: &'static str, status: c_int) -> Result<()> {
    check(function, status)
}

/// Turns the status of a guarded call into a result. Only for the functions that decide about poisoning: `data/call.rs` and
/// [`check_without_data`].
#[inline]
pub(crate) fn check(function: &'static str, status: c_int) -> Result<()> {
    if status == guard::OK { Ok(()) } else { Err(caught(function, status)) }
}

#[cold]
fn caught(function: &'static str, status: c_int) -> Error {
    if status == guard::OUT_OF_MEMORY {
        return Error::OutOfMemory { function };
    }
    // SAFETY: the pointer is this thread's own buffer, NUL-terminated and unchanged until the thread's next caught error.
    let message = unsafe { text(guard::message()) };
    Error::Engine { function, message }
}
