//! Pictures.

mod content;
mod hostile;
mod optics;
mod rays;
mod stage;
