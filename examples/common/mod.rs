//! What the examples share: their plots and the parsing of numbers.

pub mod chart;
pub mod option;
