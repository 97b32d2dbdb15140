//! Checks of memory before large allocations, because a failed allocation aborts the process.

use crate::error::{Error, Result};

/// Creates the error for a number of elements that do not fit in memory.
pub(crate) fn no_room(what: &str, count: usize) -> Error {
    Error::out_of_range(format!("the number of {what}"), count, "as many as there is memory for")
}

/// Checks that there is enough memory for elements of a size in bytes, before many allocations for
/// single elements.
pub(crate) fn check(what: &str, count: usize, bytes_each: usize) -> Result<()> {
    let fits = bytes_each.checked_mul(count).is_some_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if fits { Ok(()) } else { Err(no_room(what, count)) }
}

/// Allocates a buffer of zeros, or returns an error if memory does not suffice.
pub(crate) fn zeros(what: &str, length: usize) -> Result<Vec<f64>> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(length).map_err(|_| no_room(what, length))?;
    buffer.resize(length, 0.0);
    Ok(buffer)
}
