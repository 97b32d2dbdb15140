//! Factorisation of a matrix of low rank into two thin matrices.

use super::packed::PackedMatrix;
use super::simd::{self, BLOCK, F64x8};
use crate::numerics::InstructionSet;

/// Relative remainder above which the factorisation stops after an eighth of the columns. Stopping
/// early only saves time.
const MAX_EARLY_REMAINDER: f64 = 1e-2;

/// Factors `U` and `W` of a matrix `U Wᵀ`, where `U` has orthonormal columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct LowRank {
    /// Columns of `U` and of `W`, one after another.
    u: Vec<F64x8>,
    w: Vec<F64x8>,
    /// Remainder of the matrix.
    remainder: PackedMatrix,
    direction: Vec<F64x8>,
    /// Entries of `direction`.
    factors: Vec<f64>,
    /// Sums of squares of the columns of the remainder.
    squares: Vec<F64x8>,
    rank: usize,
}

impl LowRank {
    /// Factorises a square matrix up to rounding by Gram–Schmidt orthogonalisation with column
    /// pivoting. Returns `false` if its rank is zero or more than half its size.
    pub(crate) fn factorise(&mut self, simd: InstructionSet, matrix: &PackedMatrix) -> bool {
        let (size, max_rank) = (matrix.padded_rows(), matrix.columns() / 2);
        let width = size / BLOCK;
        let norm = matrix.norm();
        self.remainder.copy_from(matrix);
        for buffer in [&mut self.u, &mut self.w] {
            buffer.clear();
            buffer.resize(max_rank * width, F64x8::ZERO);
        }
        self.direction.resize(width, F64x8::ZERO);
        self.squares.clear();
        self.squares.resize(width, F64x8::ZERO);
        for (squares, panel) in self.squares.iter_mut().zip(matrix.vectors().chunks_exact(size)) {
            for row in panel {
                squares.0.iter_mut().zip(row.0).for_each(|(sum, entry)| *sum += entry * entry);
            }
        }
        for rank in 0..=max_rank {
            self.rank = rank;
            let squares = self.squares.iter().flat_map(|vector| vector.0).enumerate();
            let (pivot, largest) = squares.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
            let remaining = self.squares.iter().map(F64x8::sum).sum::<f64>().sqrt();
            if remaining <= f64::EPSILON * norm {
                return rank > 0;
            }
            if rank == max_rank || (rank == matrix.columns() / 8 && remaining > MAX_EARLY_REMAINDER * norm) {
                return false;
            }
            let panel = &self.remainder.vectors()[pivot / BLOCK * size..][..size];
            let length = 1.0 / largest.sqrt();
            for (row, entry) in self.direction.iter_mut().flat_map(|vector| &mut vector.0).enumerate() {
                *entry = panel[row].0[pivot % BLOCK] * length;
            }
            // Orthogonalises again: rounding leaves components of earlier directions, which matter
            // once the remainder is small.
            for earlier in self.u[..rank * width].chunks_exact(width) {
                let overlap = dot(earlier, &self.direction);
                for (entry, earlier) in self.direction.iter_mut().zip(earlier) {
                    entry.0.iter_mut().zip(earlier.0).for_each(|(entry, earlier)| *entry -= overlap * earlier);
                }
            }
            let length = 1.0 / dot(&self.direction, &self.direction).sqrt();
            self.direction.iter_mut().flat_map(|vector| &mut vector.0).for_each(|entry| *entry *= length);
            self.u[rank * width..][..width].copy_from_slice(&self.direction);

            self.factors.clear();
            self.factors.extend(self.direction.iter().flat_map(|vector| vector.0));
            let factors = &self.factors;
            let coefficients = &mut self.w[rank * width..][..width];
            for ((panel, coefficients), squares) in
                self.remainder.vectors_mut().chunks_exact_mut(size).zip(coefficients).zip(&mut self.squares)
            {
                *squares = F64x8::ZERO;
                simd::add_rows(simd, factors, panel, coefficients);
                simd::subtract_rows(simd, factors, coefficients, panel, squares);
            }
        }
        false
    }

    /// Writes the factors, with `rows` rows.
    pub(crate) fn write_to(&self, rows: usize, u: &mut PackedMatrix, w: &mut PackedMatrix) {
        let width = rows.div_ceil(BLOCK);
        for (columns, panels) in [(&self.u, u), (&self.w, w)] {
            panels.fill(rows, self.rank, |row, column| columns[column * width + row / BLOCK].0[row % BLOCK]);
        }
    }
}

/// Returns the scalar product.
fn dot(left: &[F64x8], right: &[F64x8]) -> f64 {
    let mut sums = F64x8::ZERO;
    for (left, right) in left.iter().zip(right) {
        for lane in 0..BLOCK {
            sums.0[lane] += left.0[lane] * right.0[lane];
        }
    }
    sums.sum()
}
