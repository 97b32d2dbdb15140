//! A matrix of low rank as a product of two thin ones.

use super::lanes::{self, BLOCK, Lane, Processor};
use super::panels::Panels;

/// After an eighth of the columns, what is left of a matrix of low rank is at most this much of it. It only saves time.
const PROMISING: f64 = 1e-2;

/// Room for factors `U` and `W` of a matrix `U Wᵀ`, the columns of `U` orthonormal.
#[derive(Clone, Debug, Default)]
pub(super) struct LowRank {
    /// The columns of `U`, and those of `W`, one after another.
    u: Vec<Lane>,
    w: Vec<Lane>,
    rest: Panels,
    direction: Vec<Lane>,
    /// The same, as numbers.
    factors: Vec<f64>,
    squares: Vec<Lane>,
    rank: usize,
}

impl LowRank {
    /// Factorises a square matrix up to rounding if at most half as many columns as it has are enough: Gram–Schmidt
    /// orthogonalisation that always takes the column of which most is left.
    pub(super) fn factorise(&mut self, processor: Processor, matrix: &Panels) -> bool {
        let (size, most) = (matrix.size(), matrix.columns() / 2);
        let width = size / BLOCK;
        let norm = matrix.norm();
        self.rest.copy_from(matrix);
        for room in [&mut self.u, &mut self.w] {
            room.clear();
            room.resize(most * width, Lane::ZERO);
        }
        self.direction.resize(width, Lane::ZERO);
        self.squares.clear();
        self.squares.resize(width, Lane::ZERO);
        for (squares, panel) in self.squares.iter_mut().zip(matrix.lanes().chunks_exact(size)) {
            for row in panel {
                squares.0.iter_mut().zip(row.0).for_each(|(sum, entry)| *sum += entry * entry);
            }
        }
        for rank in 0..=most {
            self.rank = rank;
            let squares = self.squares.iter().flat_map(|lane| lane.0).enumerate();
            let (pivot, largest) = squares.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
            let left = self.squares.iter().map(Lane::sum).sum::<f64>().sqrt();
            if left <= f64::EPSILON * norm {
                return rank > 0;
            }
            if rank == most || (rank == matrix.columns() / 8 && left > PROMISING * norm) {
                return false;
            }
            let panel = &self.rest.lanes()[pivot / BLOCK * size..][..size];
            let length = 1.0 / largest.sqrt();
            for (row, entry) in self.direction.iter_mut().flat_map(|lane| &mut lane.0).enumerate() {
                *entry = panel[row].0[pivot % BLOCK] * length;
            }
            // What rounding has left of the earlier directions in the rest would show once the rest is small.
            for earlier in self.u[..rank * width].chunks_exact(width) {
                let overlap = dot(earlier, &self.direction);
                for (entry, earlier) in self.direction.iter_mut().zip(earlier) {
                    entry.0.iter_mut().zip(earlier.0).for_each(|(entry, earlier)| *entry -= overlap * earlier);
                }
            }
            let length = 1.0 / dot(&self.direction, &self.direction).sqrt();
            self.direction.iter_mut().flat_map(|lane| &mut lane.0).for_each(|entry| *entry *= length);
            self.u[rank * width..][..width].copy_from_slice(&self.direction);

            self.factors.clear();
            self.factors.extend(self.direction.iter().flat_map(|lane| lane.0));
            let factors = &self.factors;
            let coefficients = &mut self.w[rank * width..][..width];
            for ((panel, coefficients), squares) in
                self.rest.lanes_mut().chunks_exact_mut(size).zip(coefficients).zip(&mut self.squares)
            {
                *squares = Lane::ZERO;
                lanes::add_rows(processor, factors, panel, coefficients);
                lanes::subtract_rows(processor, factors, coefficients, panel, squares);
            }
        }
        false
    }

    /// Writes the factors.
    pub(super) fn write_to(&self, rows: usize, u: &mut Panels, w: &mut Panels) {
        let width = rows.div_ceil(BLOCK);
        for (columns, panels) in [(&self.u, u), (&self.w, w)] {
            panels.fill(rows, self.rank, |row, column| columns[column * width + row / BLOCK].0[row % BLOCK]);
        }
    }
}

/// The scalar product.
fn dot(left: &[Lane], right: &[Lane]) -> f64 {
    let mut sums = Lane::ZERO;
    for (left, right) in left.iter().zip(right) {
        for lane in 0..BLOCK {
            sums.0[lane] += left.0[lane] * right.0[lane];
        }
    }
    sums.sum()
}
