//! Raw bindings to the [MuJoCo](https://mujoco.org) physics engine, and a C shim that returns the
//! engine's fatal errors as codes ([`guard`]), lets its callbacks fail ([`callback`]) and hides
//! differences between versions ([`adapted`], [`absent`]).
//!
//! Everything except [`stderr`] is `unsafe` or a plain C type; the safe crate is `mujoco-safe`.
//! bindgen generates the bindings. Those of MuJoCo 2.2.2, 3.5.0, 3.17.0 and 4.0.1 are committed
//! (Debian's `libmujoco-dev` is 2.2.2), the build uses those of the installed headers, and this
//! crate's tests compare them with the headers. For another release it uses those
//! of the nearest version whose headers declare the same, which it checks with the C compiler,
//! without functions that the release lacks. The feature `bindgen` generates bindings for other
//! versions.
//!
//! The build uses the engine in `MUJOCO_DIR`; without it, an engine 2.2.2 in the system directories
//! or in the active Python, conda or ROS environment, or else the first engine there whose bindings
//! are committed.
//!
//! # Build script metadata
//!
//! The build script of a crate that depends directly on this one receives `DEP_MUJOCO_VERSION` (222
//! for 2.2.2, 4000001 for 4.0.1), `DEP_MUJOCO_FIELDS` (the file of [`FIELDS`]),
//! `DEP_MUJOCO_DEFAULT_FIELDS` (that of 2.2.2), `DEP_MUJOCO_INCLUDE`, `DEP_MUJOCO_LIBDIR` and, for
//! an engine outside the loader's search path, `DEP_MUJOCO_RPATH`.

pub mod adapted;
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
    reason = "generated from the engine's headers, with their names and comments"
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

pub use bindings::*;

/// Constants of other versions that this engine does not have, so that a program compiles with
/// every version. Their values do not occur in this engine.
#[allow(missing_docs, non_upper_case_globals, clippy::pedantic, reason = "generated, with the names of the engine")]
pub mod absent {
    include!(concat!(env!("OUT_DIR"), "/absent.rs"));
}

pub use absent::*;

/// Table of the fields of `mjModel`, `mjData`, `mjOption`, `mjVisual` and `mjStatistic`, from the
/// headers. Each line after the headings has the struct (without `mj`), kind, C type, name, rows,
/// columns and comment, separated by tabs. The kind is `size`, `scalar`, `vector` (an array within
/// the struct), `array` (behind a pointer) or `arena` (an array in the data's arena). Names in
/// `Visual` are dotted.
pub const FIELDS: &str = include_str!(concat!(env!("OUT_DIR"), "/fields.tsv"));
