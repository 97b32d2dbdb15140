//! What of the engine is here, and under which name: for who knows its C functions, its structs, or MuJoCo.jl. The tables are
//! made from the engine's own lists, and a test keeps them complete.

/// The functions of `mujoco.h`.
#[doc = include_str!("../docs/coverage/functions.md")]
pub mod functions {}

/// The fields of the engine's structs.
#[doc = include_str!("../docs/coverage/fields.md")]
pub mod fields {}

/// The kinds of element, and the fields of each.
#[doc = include_str!("../docs/coverage/kinds.md")]
pub mod kinds {}
