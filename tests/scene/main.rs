//! The abstract picture is the engine's own: each call beside the same call in C, bit for bit. `geoms.rs` makes whole scenes of
//! every model under all labels, frames and flags, `camera.rs` moves cameras and models, `perturbation.rs` pulls bodies,
//! `select.rs` looks for what is seen at a place of the window and compares it with rays too.

#[path = "../common/twins.rs"]
#[allow(dead_code, reason = "its other users need the rest")]
mod twins;

mod boundary;
mod camera;
mod extreme_numbers;
mod geoms;
mod perturbation;
mod raw;
mod select;
