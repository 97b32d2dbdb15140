//! Pictures.

mod content;
mod rays;
