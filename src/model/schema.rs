//! What a model text may have in it.

use std::ffi::{c_char, c_int};
use std::ptr;

use mujoco_sys::guard;

use super::load::XmlState;
use crate::engine;
use crate::error::{Error, Result};
use crate::ffi;

/// The elements and attributes of MJCF that the engine's compiler knows, as indented text: each element with how often it may
/// occur (`!` once, `?` at most once, `*` any number of times, `R` any number of times and inside itself) and its attributes.
///
/// # Errors
///
/// [`Error::LoaderLocked`] if the compiler is of no use any more, [`Error::OutOfMemory`].
///
/// ```
/// let schema = mujoco_safe::schema()?;
/// assert!(schema.lines().any(|line| line.trim_start().starts_with("freejoint (*)")));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mj_printSchema")]
pub fn schema() -> Result<String> {
    print(false)
}

/// The same as a table in HTML.
///
/// # Errors
///
/// As for [`schema`].
///
/// ```
/// assert!(mujoco_safe::schema_html()?.starts_with("<table"));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mj_printSchema")]
pub fn schema_html() -> Result<String> {
    print(true)
}

fn print(html: bool) -> Result<String> {
    engine::ready()?;
    let mut xml = XmlState::enter()?;
    let mut call = |buffer: *mut c_char, size: c_int| {
        let mut length = 0;
        // SAFETY: no file, NULL or a buffer of the given size, a place for the result.
        let status = unsafe {
            guard::mj_print_schema(ptr::null(), buffer, size, c_int::from(html), c_int::from(true), &raw mut length)
        };
        xml.leave("mj_printSchema", status).map(|()| length)
    };
    // Without a buffer the engine tells the length only.
    let size = call(ptr::null_mut(), 0)?
        .checked_add(1)
        .ok_or_else(|| Error::Unsupported("a schema of more than 2 GiB".to_owned()))?;
    let mut buffer = vec![0; ffi::size(size)];
    call(buffer.as_mut_ptr(), size)?;
    // SAFETY: the engine ends the text with NUL inside of the buffer.
    Ok(unsafe { ffi::text(buffer.as_ptr()) })
}
