//! Each call of the library against the same call in C, made through the raw bindings on a separate
//! simulation, bit for bit.
//!
//! The models are the two bundled ones, `tests/models/zoo.xml`, which has most kinds of element,
//! and those of the engine's package where installed. Controls, forces and velocities are
//! pseudo-random with fixed seeds.

#[macro_use]
#[path = "../../common/fields.rs"]
mod lists;

mod fields;
mod forces;
mod functions;
mod ranges;
mod rays;
mod settings;
mod trajectories;
mod views;
