//! Linear systems of steps, and derivatives of inverse dynamics.

mod inverse_fd;
mod transition;
