//! LU factorisation in panels: with partial pivoting, and without pivoting for positive definite
//! matrices.

use super::packed::PackedMatrix;
use super::simd::{self, BLOCK, F64x8};
use crate::numerics::InstructionSet;

/// Smallest pivot of a positive definite matrix, relative to the diagonal entry before elimination.
const MIN_RELATIVE_PIVOT: f64 = 1e-14;

/// Factors of a square matrix, `P M = L U`.
#[derive(Clone, Debug, Default)]
pub(crate) struct LuFactors {
    packed: PackedMatrix,
    /// Row that each row was exchanged with, in the order of elimination.
    exchanges: Vec<usize>,
    /// Inverses of the diagonal blocks of `L` and of `U`.
    lower_inverses: Vec<F64x8>,
    upper_inverses: Vec<F64x8>,
    /// Diagonal of the matrix before elimination.
    diagonal: Vec<f64>,
}

impl LuFactors {
    /// Returns the matrix to be filled in before [`factorise`](Self::factorise) or
    /// [`factorise_positive`](Self::factorise_positive), which overwrite it with the factors.
    pub(crate) fn matrix(&mut self) -> &mut PackedMatrix {
        &mut self.packed
    }

    /// Factorises with partial pivoting. Returns `false` if the matrix is singular to working
    /// precision, or not finite.
    pub(crate) fn factorise(&mut self, simd: InstructionSet) -> bool {
        self.eliminate(simd, |panel, from, column| {
            let largest = |best: (usize, f64), (row, vector): (usize, &F64x8)| {
                let size = vector.0[column].abs();
                if size > best.1 { (row, size) } else { best }
            };
            let (row, size) = panel.iter().enumerate().skip(from).fold((from, 0.0), largest);
            (size > 0.0).then_some(row)
        })
    }

    /// Factorises a symmetric matrix without pivoting, so that `U` is `D Lᵀ`. Returns `false`
    /// unless it is positive definite.
    pub(crate) fn factorise_positive(&mut self, simd: InstructionSet) -> bool {
        let mut diagonal = std::mem::take(&mut self.diagonal);
        diagonal.clear();
        diagonal.extend((0..self.packed.rows()).map(|index| self.packed.get(index, index)));
        let positive = self.eliminate(simd, |panel, from, column| {
            let original = diagonal.get(from).copied().unwrap_or(1.0);
            (panel[from].0[column] > MIN_RELATIVE_PIVOT * original).then_some(from)
        });
        self.diagonal = diagonal;
        positive
    }

    /// Eliminates panel by panel. `pivot` selects the row of the next pivot from a panel, the first
    /// remaining row and the column.
    fn eliminate(&mut self, simd: InstructionSet, pivot: impl Fn(&[F64x8], usize, usize) -> Option<usize>) -> bool {
        let (rows, size) = (self.packed.rows(), self.packed.padded_rows());
        self.exchanges.clear();
        self.lower_inverses.clear();
        self.upper_inverses.clear();
        if rows == 0 {
            return true;
        }
        // Extends the matrix by the identity in the padding.
        for index in rows..size {
            self.packed.set(index, index, 1.0);
        }
        let vectors = self.packed.vectors_mut();
        for panel in 0..size / BLOCK {
            let (known, rest) = vectors.split_at_mut(panel * size);
            simd::substitute_forward(simd, known, size, &self.lower_inverses, &mut rest[..size]);
            let mut reciprocals = [0.0; BLOCK];
            for (column, reciprocal) in reciprocals.iter_mut().enumerate() {
                let index = BLOCK * panel + column;
                let Some(row) = pivot(&vectors[panel * size..(panel + 1) * size], index, column) else {
                    return false;
                };
                if row != index {
                    vectors.chunks_exact_mut(size).for_each(|panel| panel.swap(row, index));
                }
                let (above, below) = vectors[panel * size..(panel + 1) * size].split_at_mut(index + 1);
                let inverse = above[index].0[column].recip();
                if !inverse.is_finite() {
                    return false;
                }
                simd::eliminate(simd, column, inverse, &above[index], below);
                self.exchanges.push(row);
                *reciprocal = inverse;
            }
            let block =
                vectors[panel * size + BLOCK * panel..].first_chunk().expect("Bug: no diagonal block in a panel");
            self.lower_inverses.extend(simd::invert_lower(block));
            self.upper_inverses.extend(simd::invert_upper(block, &reciprocals));
        }
        true
    }

    /// Replaces `right` by the solution `X` of `M X = right`.
    pub(crate) fn solve(&self, simd: InstructionSet, right: &mut PackedMatrix) {
        let size = self.packed.padded_rows();
        debug_assert_eq!(right.padded_rows(), size);
        if size == 0 {
            return;
        }
        for panel in right.vectors_mut().chunks_exact_mut(size) {
            for (index, &row) in self.exchanges.iter().enumerate() {
                panel.swap(index, row);
            }
        }
        let packed = self.packed.vectors();
        simd::substitute_forward(simd, packed, size, &self.lower_inverses, right.vectors_mut());
        simd::substitute_backward(simd, packed, size, &self.upper_inverses, right.vectors_mut());
    }
}
