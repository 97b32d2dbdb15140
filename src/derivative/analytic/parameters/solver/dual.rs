//! Numbers with their derivatives: forward differentiation.

use std::array;
use std::ops::{Add, Div, Mul, Sub};

/// Number with its derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) change: f64,
}

impl Dual {
    pub(super) fn constant(value: f64) -> Self {
        Self { value, change: 0.0 }
    }

    /// Returns numbers, of which those that `is_varied` selects have the derivative one.
    pub(super) fn numbers<const N: usize>(values: [f64; N], is_varied: impl Fn(usize) -> bool) -> [Self; N] {
        array::from_fn(|at| Self { value: values[at], change: if is_varied(at) { 1.0 } else { 0.0 } })
    }

    /// Returns the number in a range, with the derivative inside.
    pub(super) fn clamped(self, low: f64, high: f64) -> Self {
        if self.value < low {
            Self::constant(low)
        } else if self.value > high {
            Self::constant(high)
        } else {
            self
        }
    }

    pub(super) fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self { value: root, change: 0.5 * self.change / root }
    }

    /// Returns a power of a positive number.
    pub(super) fn power(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        let rate = exponent.value * self.change / self.value + exponent.change * self.value.ln();
        Self { value, change: value * rate }
    }

    /// Returns a number with a value that is proportional to this one.
    pub(super) fn scaled_to(self, value: f64) -> Self {
        Self { value, change: value * self.change / self.value }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, change: self.change + other.change }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, change: self.change - other.change }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, change: self.change * other.value + self.value * other.change }
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        Dual { value: self * other.value, change: self * other.change }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, change: (self.change - value * other.change) / other.value }
    }
}
