//! What this crate promises.
//!
#![doc = include_str!("../docs/promises.md")]
