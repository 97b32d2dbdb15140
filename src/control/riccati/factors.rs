//! Gaussian elimination in panels: a factorisation that may exchange rows, and one of positive definite matrices.

use super::lanes::{self, BLOCK, Lane, Processor};
use super::panels::Panels;

/// How much of a diagonal entry has to be left for the matrix to count as positive definite.
const LEAST_LEFT: f64 = 1e-14;

/// The factors of a square matrix, `P M = L U`.
#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    packed: Panels,
    /// The row that each row was exchanged with in its turn.
    exchanges: Vec<usize>,
    /// Of the blocks on the diagonal of `L` and of `U`.
    lower_inverses: Vec<Lane>,
    upper_inverses: Vec<Lane>,
    /// Of the matrix.
    diagonal: Vec<f64>,
}

impl Factors {
    /// The matrix to be factorised next: fill it in, then call one of the two.
    pub(super) fn matrix(&mut self) -> &mut Panels {
        &mut self.packed
    }

    /// Factorises with partial pivoting; false if the matrix is singular to working precision, or not finite.
    pub(super) fn factorise(&mut self, processor: Processor) -> bool {
        self.eliminate(processor, |panel, from, column| {
            let largest = |best: (usize, f64), (row, lane): (usize, &Lane)| {
                let size = lane.0[column].abs();
                if size > best.1 { (row, size) } else { best }
            };
            let (row, size) = panel.iter().enumerate().skip(from).fold((from, 0.0), largest);
            (size > 0.0).then_some(row)
        })
    }

    /// Factorises a symmetric matrix; false unless it is positive definite. (Without exchanges `U` is `D Lᵀ`.)
    pub(super) fn factorise_positive(&mut self, processor: Processor) -> bool {
        let mut diagonal = std::mem::take(&mut self.diagonal);
        diagonal.clear();
        diagonal.extend((0..self.packed.rows()).map(|index| self.packed.get(index, index)));
        let positive = self.eliminate(processor, |panel, from, column| {
            let whole = diagonal.get(from).copied().unwrap_or(1.0);
            (panel[from].0[column] > LEAST_LEFT * whole).then_some(from)
        });
        self.diagonal = diagonal;
        positive
    }

    /// Elimination, given how to find the row of the next pivot among the rows of a panel that are left.
    fn eliminate(&mut self, processor: Processor, pivot: impl Fn(&[Lane], usize, usize) -> Option<usize>) -> bool {
        let (rows, size) = (self.packed.rows(), self.packed.size());
        self.exchanges.clear();
        self.lower_inverses.clear();
        self.upper_inverses.clear();
        if rows == 0 {
            return true;
        }
        // Beyond the matrix there is the identity.
        for index in rows..size {
            self.packed.set(index, index, 1.0);
        }
        let lanes = self.packed.lanes_mut();
        for panel in 0..size / BLOCK {
            let (known, rest) = lanes.split_at_mut(panel * size);
            lanes::substitute_forward(processor, known, size, &self.lower_inverses, &mut rest[..size]);
            let mut reciprocals = [0.0; BLOCK];
            for (column, reciprocal) in reciprocals.iter_mut().enumerate() {
                let index = BLOCK * panel + column;
                let Some(row) = pivot(&lanes[panel * size..(panel + 1) * size], index, column) else {
                    return false;
                };
                if row != index {
                    lanes.chunks_exact_mut(size).for_each(|panel| panel.swap(row, index));
                }
                let (above, below) = lanes[panel * size..(panel + 1) * size].split_at_mut(index + 1);
                let inverse = above[index].0[column].recip();
                if !inverse.is_finite() {
                    return false;
                }
                lanes::eliminate(processor, column, inverse, &above[index], below);
                self.exchanges.push(row);
                *reciprocal = inverse;
            }
            let block = lanes[panel * size + BLOCK * panel..].first_chunk().expect("Bug: a block for each panel");
            self.lower_inverses.extend(lanes::invert_lower(block));
            self.upper_inverses.extend(lanes::invert_upper(block, &reciprocals));
        }
        true
    }

    /// Replaces `right` by the solution `X` of `M X = right`.
    pub(super) fn solve(&self, processor: Processor, right: &mut Panels) {
        let size = self.packed.size();
        debug_assert_eq!(right.size(), size);
        if size == 0 {
            return;
        }
        for panel in right.lanes_mut().chunks_exact_mut(size) {
            for (index, &row) in self.exchanges.iter().enumerate() {
                panel.swap(index, row);
            }
        }
        let packed = self.packed.lanes();
        lanes::substitute_forward(processor, packed, size, &self.lower_inverses, right.lanes_mut());
        lanes::substitute_backward(processor, packed, size, &self.upper_inverses, right.lanes_mut());
    }
}
