//! What the library returns is what the engine returns: each call beside the same call in C, made through the raw bindings on
//! a simulation of its own, and compared bit for bit.
//!
//! The models are the two that come with the crate, one that has an element of every kind (`tests/models/zoo.xml`), and those of
//! the engine's package where that is installed. Controls, forces and velocities are pseudo-random and the same in every run.
//! `trajectories.rs` steps, `functions.rs`, `forces.rs`, `ranges.rs` and `rays.rs` call what computes something from a state, `views.rs`
//! reads every field of every kind of element at the address where the engine keeps it.

mod forces;
mod functions;
mod ranges;
mod rays;
mod trajectories;
mod twins;
mod views;
