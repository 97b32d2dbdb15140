//! What is wrong with a file.

use std::fmt;

/// Why a binary model was refused: what was found, where, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Invalid(String);

impl Invalid {
    /// Something about the file as a whole, in a sentence without a full stop.
    pub(super) fn file(message: impl Into<String>) -> Self {
        Self(message.into())
    }

    /// A size or another single number: "njmax is 9; it must be …".
    pub(super) fn scalar(name: &str, value: impl fmt::Display, wanted: impl fmt::Display) -> Self {
        Self(format!("{name} is {value}; {wanted}"))
    }

    /// One element of an array: "geom_type[3] is 70; it must be …".
    pub(super) fn element(name: &str, index: usize, value: impl fmt::Display, wanted: impl fmt::Display) -> Self {
        Self(format!("{name}[{index}] is {value}; {wanted}"))
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Invalid {}
