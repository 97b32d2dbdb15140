//! Arithmetic without the engine: vectors in space, small dense matrices, and the selection of
//! instructions by the processor. The layers above are `derivative`, `control` and `render`.

pub(crate) mod dense;
pub(crate) mod linear_algebra;
pub(crate) mod processor;
#[cfg_attr(engine_since = "2.3.0", allow(dead_code, reason = "the closed form of 2.2.2 uses the rest"))]
pub(crate) mod spatial;

pub(crate) use self::processor::{InstructionSet, for_processor, vectorised};
