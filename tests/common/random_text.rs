//! Random attributes of texts.

#![allow(dead_code, reason = "each program uses only some of the functions")]

use rand::RngExt;

/// Choices of a generator of random numbers.
pub(crate) trait RandomText: RngExt + Sized {
    fn one_of<'a>(&mut self, values: &[&'a str]) -> &'a str {
        values[self.random_range(0..values.len())]
    }

    fn number(&mut self, low: f64, high: f64) -> String {
        format!("{:.3}", self.random_range(low..high))
    }

    fn numbers<const N: usize>(&mut self, low: f64, high: f64) -> String {
        [0; N].map(|_| self.number(low, high)).join(" ")
    }

    /// Returns the attribute with this probability, else nothing.
    fn maybe(&mut self, probability: f64, name: &str, value: impl FnOnce(&mut Self) -> String) -> String {
        if self.random_bool(probability) { format!(" {name}='{}'", value(self)) } else { String::new() }
    }
}

impl<R: RngExt> RandomText for R {}
