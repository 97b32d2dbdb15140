//! Tables of the engine's functions, struct fields and element kinds, with the corresponding items of this crate and of MuJoCo.jl.
//! The tables are generated from the engine's own lists, and a test checks that they are complete.

/// Functions of `mujoco.h`.
#[doc = include_str!("../docs/coverage/functions.md")]
pub mod functions {}

/// Fields of the engine's structs.
#[doc = include_str!("../docs/coverage/fields.md")]
pub mod fields {}

/// Kinds of elements, and the fields of each.
#[doc = include_str!("../docs/coverage/kinds.md")]
pub mod kinds {}
