//! Pictures.

mod content;
mod hostile;
mod optics;
mod quiet;
mod rays;
mod stage;
