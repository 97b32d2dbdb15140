//! Dense linear algebra of the Riccati solver and recursion: matrix products, LU factorisation and
//! low-rank factorisation.
//!
//! The solver performs some hundred products and factorisations of matrices with about 50 rows per
//! equation. nalgebra passes large products to `matrixmultiply`, which allocates at every call, and
//! solves triangular systems column by column. This module allocates only when a matrix grows, and
//! vectorises all inner loops for the processor at run time.
//!
//! The time of `solve_into` with faer 0.24 in place of these kernels, in alternating runs on an AMD
//! EPYC, was 1.33 times as long for the humanoid (54 states, 21 controls) and 0.78 times as long
//! for the cart-pole (4 states, 14 µs); with nalgebra, 3.1 and 0.62 times as long. faer would add
//! 35 crates, which compile for two minutes.
//!
//! The rest of the solver uses only the items re-exported here, so another implementation replaces
//! this module alone: [`PackedMatrix`] would wrap the other library's matrix, and
//! [`InstructionSet`](super::InstructionSet) its handle for parallelism, if any.

mod low_rank;
mod lu;
mod packed;
mod simd;

pub(crate) use self::low_rank::LowRank;
pub(crate) use self::lu::LuFactors;
pub(crate) use self::packed::PackedMatrix;
