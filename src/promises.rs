//! Guarantees of this crate and the tests that verify them.
//!
#![doc = include_str!("../docs/promises.md")]
