//! A panic as an error.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::Result;

/// Runs what may fail or panic; both become a text. What it has changed must be put right by the caller.
pub(super) fn caught<T>(what: &str, run: impl FnOnce() -> Result<T>) -> Result<T, String> {
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(error.to_string()),
        Err(payload) => {
            let text = message(&*payload).to_owned();
            // What was thrown is the user's type, and dropping it may panic again.
            std::mem::forget(payload);
            Err(format!("{what} panicked: {text}"))
        }
    }
}

/// What a panic said.
fn message(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("(without a message)")
}
