//! What the library returns is what the engine returns: each call beside the same call in C, made through the raw bindings on
//! a simulation of its own, and compared bit for bit.
//!
//! The models are the two that come with the crate, one that has most kinds of element (`tests/models/zoo.xml`), and those of
//! the engine's package where that is installed. Controls, forces and velocities are pseudo-random and the same in every run.
//! `trajectories.rs` steps, `functions.rs`, `forces.rs`, `ranges.rs` and `rays.rs` call what computes something from a state,
//! `views` reads every field of every kind of element at the address where the engine keeps it, `fields.rs` every array and
//! number of model and data, and `settings.rs` the options, the settings of the visualiser and the statistics.

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
