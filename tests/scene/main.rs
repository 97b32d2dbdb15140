//! The abstract picture is the engine's own: each call beside the same call in C, bit for bit. `geoms.rs` makes whole scenes of
//! every model under all labels, frames and flags, `camera.rs` moves cameras and models, `perturbation.rs` pulls bodies,
//! `select.rs` looks for what is seen at a place of the window and compares it with rays too.

#[path = "../against_c/twins.rs"]
#[allow(dead_code, reason = "its other users need the rest")]
mod twins;

mod camera;
mod geoms;
mod hostile;
mod perturbation;
mod raw;
mod select;
