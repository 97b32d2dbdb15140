//! Ranges that several settings share.

use std::fmt::Display;

use crate::error::{Error, Result};

/// Checks of the fields of one struct, with what stands before a field's name in errors.
pub(super) struct Checks(pub(super) &'static str);

impl Checks {
    /// Refuses a value that is not as `expected` says.
    pub(super) fn require(&self, holds: bool, name: &str, value: impl Display, expected: impl Display) -> Result<()> {
        if holds {
            return Ok(());
        }
        Err(Error::invalid(format!("{}{name}", self.0), value, expected.to_string()))
    }

    pub(super) fn positive(&self, name: &str, value: impl Into<f64> + Display + Copy) -> Result<()> {
        let number = value.into();
        self.require(number.is_finite() && number > 0.0, name, value, "positive and finite")
    }

    pub(super) fn not_negative(&self, name: &str, value: impl Into<f64> + Display + Copy) -> Result<()> {
        let number = value.into();
        self.require(number.is_finite() && number >= 0.0, name, value, "finite and not negative")
    }

    pub(super) fn finite<T: Into<f64> + std::fmt::Debug + Copy>(&self, name: &str, values: &[T]) -> Result<()> {
        let finite = values.iter().all(|&value| value.into().is_finite());
        self.require(finite, name, format_args!("{values:?}"), "finite")
    }
}
