//! Linear systems of steps, and derivatives of inverse dynamics.

#[macro_use]
#[path = "../common/fields.rs"]
mod fields;

mod differential;
mod inverse_fd;
mod support;
mod transition;
