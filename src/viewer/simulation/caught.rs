//! A panic as an error.

use crate::error::{Result, catch_panic};

/// Runs what may fail or panic; both become a text. What it has changed must be put right by the caller.
pub(super) fn caught<T>(what: &str, run: impl FnOnce() -> Result<T>) -> Result<T, String> {
    match catch_panic(run) {
        Ok(result) => result.map_err(|error| error.to_string()),
        Err(message) => Err(format!("{what} panicked: {message}")),
    }
}
