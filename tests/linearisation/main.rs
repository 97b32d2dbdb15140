//! Linear systems of steps, and derivatives of inverse dynamics.

#[path = "../common/cases.rs"]
mod cases;
#[macro_use]
#[path = "../common/fields.rs"]
mod fields;

mod differential;
mod inverse_fd;
mod parameters;
#[path = "../common/schema_models/mod.rs"]
mod schema_models;
mod support;
mod transition;
