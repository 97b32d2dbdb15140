//! Raw bindings to the [MuJoCo](https://mujoco.org) physics engine, for `mujoco-safe`, and the C shim through which the
//! engine's fatal errors come back as return codes ([`guard`]) and its callbacks may fail ([`callback`]).
//!
//! Everything here but [`stderr`] is `unsafe` or a plain C type; the safe crate is `mujoco-safe`. The bindings are bindgen's. Those of
//! MuJoCo 2.2.2 (Debian's `libmujoco-dev`) are committed and compared with the installed headers by this crate's tests; the
//! feature `bindgen` makes them anew for the headers that are found (`MUJOCO_DIR`, then the system).
//!
//! # What dependants see
//!
//! A crate that depends directly on this one gets, in its build script, `DEP_MUJOCO_VERSION` (222 for 2.2.2),
//! `DEP_MUJOCO_INCLUDE`, `DEP_MUJOCO_LIBDIR` and, for an engine that the loader does not find by itself, `DEP_MUJOCO_RPATH`.

pub mod callback;
pub mod guard;
pub mod stderr;

#[allow(
    missing_docs,
    missing_debug_implementations,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    clippy::all,
    clippy::pedantic,
    clippy::undocumented_unsafe_blocks,
    rustdoc::all,
    reason = "generated from the engine's headers, whose names and comments these are"
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

pub use bindings::*;

/// The fields of `mjModel`, `mjData`, `mjOption`, `mjVisual` and `mjStatistic` as the headers describe them: a line for each,
/// under a line of headings, with struct (without `mj`), kind, C type, name, rows, columns and comment, separated by tabs. The
/// kind is `size`, `scalar`, `vector` (an array within the struct) or `array` (one behind a pointer); `Visual` has dotted names.
pub const FIELDS: &str = include_str!(concat!(env!("OUT_DIR"), "/fields.tsv"));
