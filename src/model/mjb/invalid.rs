//! The reason for rejecting a binary model.

use std::fmt;

/// The reason for rejecting a binary model: the location, the value found there, and the values
/// that are valid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Invalid {
    message: String,
    is_unsupported: bool,
}

impl Invalid {
    /// Creates an error about the entire file from a sentence without a full stop.
    pub(super) fn file(message: impl Into<String>) -> Self {
        Self { message: message.into(), is_unsupported: false }
    }

    /// Creates an error about a feature that a model from XML may have.
    #[cfg(engine_since = "3.5.0")]
    pub(super) fn unsupported(message: impl Into<String>) -> Self {
        Self { message: message.into(), is_unsupported: true }
    }

    /// Returns `true` if the model may be valid, but has a feature for which there are no rules.
    pub(crate) fn is_unsupported(&self) -> bool {
        self.is_unsupported
    }

    /// Creates an error about a size or another single number: "njmax is 9; it must be …".
    pub(super) fn scalar(name: &str, value: impl fmt::Display, expected: impl fmt::Display) -> Self {
        Self::file(format!("{name} is {value}; {expected}"))
    }

    /// Creates an error about one element of an array: "geom_type[3] is 70; it must be …".
    pub(super) fn element(name: &str, index: usize, value: impl fmt::Display, expected: impl fmt::Display) -> Self {
        Self::file(format!("{name}[{index}] is {value}; {expected}"))
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Invalid {}
