//! Guarantees of this crate, their limits, and the tests that check them.
//!
#![doc = include_str!("../../docs/promises.md")]
