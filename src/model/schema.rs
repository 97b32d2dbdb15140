//! The schema of MJCF.

use std::ffi::{c_char, c_int};
use std::ptr;

use mujoco_sys::guard;

use super::load::XmlState;
use crate::engine;
use crate::error::{Error, Result};
use crate::ffi;

/// Returns the elements and attributes of MJCF that the engine's compiler supports, as indented
/// text. Each element has its attributes and the number of times that it may occur: `!` once, `?`
/// at most once, `*` any number of times, `R` any number of times and recursively.
///
/// # Errors
///
/// [`Error::LoaderLocked`] if the compiler is locked by an earlier error, [`Error::OutOfMemory`].
///
/// ```
/// let schema = mujoco_safe::model::schema()?;
/// assert!(schema.lines().any(|line| line.trim_start().starts_with("freejoint (*)")));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn schema() -> Result<String> {
    print(false)
}

/// Returns the schema of MJCF as an HTML table. Otherwise the same as [`schema`].
///
/// # Errors
///
/// As for [`schema`].
///
/// ```
/// assert!(mujoco_safe::model::schema_html()?.starts_with("<table"));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn schema_html() -> Result<String> {
    print(true)
}

fn print(html: bool) -> Result<String> {
    engine::ready()?;
    let mut xml = XmlState::enter()?;
    let mut call = |buffer: *mut c_char, size: c_int| {
        let mut length = 0;
        // SAFETY: no file, NULL or a buffer of the given size, and a pointer for the result.
        let status = unsafe {
            guard::mj_print_schema(ptr::null(), buffer, size, c_int::from(html), c_int::from(true), &raw mut length)
        };
        xml.leave("mj_printSchema", status).map(|()| length)
    };
    // Without a buffer, the engine only returns the length.
    let size = call(ptr::null_mut(), 0)?
        .checked_add(1)
        .ok_or_else(|| Error::Unsupported("a schema of more than 2 GiB".to_owned()))?;
    let mut buffer = vec![0; ffi::size(size)];
    call(buffer.as_mut_ptr(), size)?;
    // SAFETY: the engine terminates the text with NUL inside the buffer.
    Ok(unsafe { ffi::text(buffer.as_ptr()) })
}
