//! Checks of arguments.

use std::fmt;

use super::{Error, Result};

impl Error {
    /// Checks that a value is in its range. The texts are formatted only if it is not.
    pub(crate) fn check_range(
        is_valid: bool,
        what: impl fmt::Display,
        value: impl fmt::Display,
        expected: impl fmt::Display,
    ) -> Result<()> {
        if is_valid { Ok(()) } else { Err(Self::out_of_range(what.to_string(), value, expected.to_string())) }
    }

    /// Checks that a number is finite and not negative.
    pub(crate) fn check_not_negative(what: impl fmt::Display, value: f64) -> Result<()> {
        Self::check_range(value >= 0.0 && value.is_finite(), what, value, "finite and not negative")
    }

    /// Checks that all numbers are finite. `what` describes the number with an index.
    pub(crate) fn check_finite(values: &[f64], what: impl Fn(usize) -> String) -> Result<()> {
        let found = values.iter().position(|value| !value.is_finite());
        found.map_or(Ok(()), |index| Err(Self::not_finite(what(index), values[index])))
    }

    /// Checks the length of a vector.
    #[inline]
    pub(crate) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<()> {
        Self::check_shape(what, (found, 1), (expected, 1))
    }

    /// Checks the shape of a matrix.
    #[inline]
    pub(crate) fn check_shape(what: &'static str, found: (usize, usize), expected: (usize, usize)) -> Result<()> {
        if found == expected { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }
}
