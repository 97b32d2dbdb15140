//! A matrix in panels, as the kernels want it: eight columns side by side, row after row, and then the next eight.
//!
//! What is beyond the last row and column, up to whole blocks, is zero and stays so: sums and products of such matrices are such
//! matrices. So no loop has a remainder.

use nalgebra::{DMatrix, DMatrixView, Dyn};

use super::lanes::{self, BLOCK, Blocks, Lane, Processor, Then};

#[derive(Clone, Debug, Default)]
pub(super) struct Panels {
    rows: usize,
    columns: usize,
    /// Panel after panel, each of `size()` rows.
    lanes: Vec<Lane>,
}

impl Panels {
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// The number of rows in whole blocks.
    pub(super) fn size(&self) -> usize {
        self.rows.next_multiple_of(BLOCK)
    }

    pub(super) fn lanes(&self) -> &[Lane] {
        &self.lanes
    }

    pub(super) fn lanes_mut(&mut self) -> &mut [Lane] {
        &mut self.lanes
    }

    /// Zeros of this shape. Allocates only where it was never as large.
    pub(super) fn clear(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.lanes.clear();
        self.lanes.resize(self.size() * columns.div_ceil(BLOCK), Lane::ZERO);
    }

    /// This shape, with whatever there was before, all of which will be overwritten.
    fn shape(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.lanes.resize(self.size() * columns.div_ceil(BLOCK), Lane::ZERO);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        (self.rows, self.columns) = (other.rows, other.columns);
        self.lanes.clone_from(&other.lanes);
    }

    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.lanes[column / BLOCK * self.size() + row].0[column % BLOCK]
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        let index = column / BLOCK * self.size() + row;
        self.lanes[index].0[column % BLOCK] = value;
    }

    pub(super) fn copy_view(&mut self, view: &DMatrixView<'_, f64, Dyn, Dyn>) {
        self.fill(view.nrows(), view.ncols(), |row, column| view[(row, column)]);
    }

    pub(super) fn fill(&mut self, rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) {
        self.clear(rows, columns);
        let size = self.size();
        if size == 0 {
            return;
        }
        for (panel, lanes) in self.lanes.chunks_exact_mut(size).enumerate() {
            let first = BLOCK * panel;
            for (row, lane) in lanes[..rows].iter_mut().enumerate() {
                for (offset, entry) in lane.0.iter_mut().take(columns - first).enumerate() {
                    *entry = value(row, first + offset);
                }
            }
        }
    }

    /// Writes the entries, each times a factor.
    pub(super) fn write_to(&self, matrix: &mut DMatrix<f64>, factor: impl Fn(usize, usize) -> f64) {
        if matrix.shape() != (self.rows, self.columns) {
            *matrix = DMatrix::zeros(self.rows, self.columns);
        }
        for column in 0..self.columns {
            for (row, entry) in matrix.column_mut(column).iter_mut().enumerate() {
                *entry = self.get(row, column) * factor(row, column);
            }
        }
    }

    pub(super) fn to_matrix(&self, factor: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        DMatrix::from_fn(self.rows, self.columns, |row, column| self.get(row, column) * factor(row, column))
    }

    pub(super) fn transpose_from(&mut self, other: &Self) {
        self.shape(other.columns, other.rows);
        let (size, other_size) = (self.size(), other.size());
        if size == 0 || other_size == 0 {
            return;
        }
        for (panel, lanes) in self.lanes.chunks_exact_mut(size).enumerate() {
            for (lanes, from) in lanes.as_chunks_mut::<BLOCK>().0.iter_mut().zip(other.lanes.chunks_exact(other_size)) {
                let from: &[Lane; BLOCK] = from[BLOCK * panel..].first_chunk().expect("Bug: panels end with a block");
                for (row, lane) in lanes.iter_mut().enumerate() {
                    lane.0.iter_mut().zip(from).for_each(|(to, from)| *to = from.0[row]);
                }
            }
        }
    }

    /// Makes the part above the diagonal the mirror image of the one below.
    fn mirror(&mut self) {
        let size = self.size();
        for panel in 0..size / BLOCK {
            for block in 0..=panel {
                let from: [Lane; BLOCK] =
                    *self.lanes[block * size + BLOCK * panel..].first_chunk().expect("Bug: panels end with a block");
                let to = &mut self.lanes[panel * size + BLOCK * block..][..BLOCK];
                for (row, lane) in to.iter_mut().enumerate() {
                    let first = if block == panel { row + 1 } else { 0 };
                    lane.0.iter_mut().zip(&from).skip(first).for_each(|(to, from)| *to = from.0[row]);
                }
            }
        }
    }

    /// `self = left · right`.
    pub(super) fn product(&mut self, processor: Processor, left: &Self, right: &Self) {
        self.shape(left.rows, right.columns);
        lanes::multiply(processor, self.blocks(Then::Set, false), &left.lanes, &right.lanes);
    }

    /// `self -= left · right`.
    pub(super) fn subtract_product(&mut self, processor: Processor, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.columns), (left.rows, right.columns, right.rows));
        lanes::multiply(processor, self.blocks(Then::Subtract, false), &left.lanes, &right.lanes);
    }

    /// `self = leftᵀ · right`.
    pub(super) fn transposed_product(&mut self, processor: Processor, left: &Self, right: &Self) {
        self.shape(left.columns, right.columns);
        lanes::multiply_transposed(processor, self.blocks(Then::Set, false), &left.lanes, &right.lanes);
    }

    /// `self += left · right`, both of which are symmetric. Half of it is computed.
    pub(super) fn add_symmetric_product(&mut self, processor: Processor, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.columns), (left.rows, right.columns, right.rows));
        lanes::multiply(processor, self.blocks(Then::Add, true), &left.lanes, &right.lanes);
        self.mirror();
    }

    /// `self += leftᵀ · right`, both of which are symmetric. Half of it is computed.
    pub(super) fn add_symmetric_transposed(&mut self, processor: Processor, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.rows), (left.columns, right.columns, right.rows));
        lanes::multiply_transposed(processor, self.blocks(Then::Add, true), &left.lanes, &right.lanes);
        self.mirror();
    }

    fn blocks(&mut self, then: Then, only_lower: bool) -> Blocks<'_> {
        let size = self.size();
        Blocks { lanes: &mut self.lanes, size, then, only_lower }
    }

    /// `self += other`.
    pub(super) fn add(&mut self, other: &Self) {
        for (to, from) in self.lanes.iter_mut().zip(&other.lanes) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to += from);
        }
    }

    /// `self -= other`.
    pub(super) fn subtract(&mut self, other: &Self) {
        for (to, from) in self.lanes.iter_mut().zip(&other.lanes) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to -= from);
        }
    }

    /// `self += sum · I`.
    pub(super) fn add_to_diagonal(&mut self, sum: f64) {
        for index in 0..self.rows {
            let value = self.get(index, index);
            self.set(index, index, value + sum);
        }
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.lanes.iter_mut().flat_map(|lane| &mut lane.0).for_each(|entry| *entry *= factor);
    }

    /// Multiplies each row and each column by a factor.
    pub(super) fn scale_both(&mut self, rows: impl Fn(usize) -> f64, columns: impl Fn(usize) -> f64) {
        let (size, count, width) = (self.size(), self.rows, self.columns);
        if size == 0 {
            return;
        }
        for (panel, lanes) in self.lanes.chunks_exact_mut(size).enumerate() {
            let first = BLOCK * panel;
            let mut factors = [0.0; BLOCK];
            factors
                .iter_mut()
                .enumerate()
                .take(width - first)
                .for_each(|(lane, factor)| *factor = columns(first + lane));
            for (row, lane) in lanes[..count].iter_mut().enumerate() {
                let factor = rows(row);
                lane.0.iter_mut().zip(factors).for_each(|(entry, by)| *entry *= factor * by);
            }
        }
    }

    /// The Frobenius norm.
    pub(super) fn norm(&self) -> f64 {
        let mut sums = [Lane::ZERO; 2];
        for pair in self.lanes.as_chunks::<2>().0 {
            for (sums, lane) in sums.iter_mut().zip(pair) {
                sums.0.iter_mut().zip(lane.0).for_each(|(sum, entry)| *sum += entry * entry);
            }
        }
        (sums[0].sum() + sums[1].sum()).sqrt()
    }

    /// The Frobenius norm with each row and each column times its unit; without units as it is.
    pub(super) fn norm_in(&self, units: &[f64]) -> f64 {
        if units.is_empty() {
            return self.norm();
        }
        let mut sum = 0.0;
        for (panel, columns) in self.lanes.chunks_exact(self.size().max(1)).zip(units.as_chunks::<BLOCK>().0) {
            for (lane, unit) in panel.iter().zip(units) {
                let mut squares = Lane::ZERO;
                for ((square, entry), column) in squares.0.iter_mut().zip(lane.0).zip(columns) {
                    let value = entry * unit * column;
                    *square = value * value;
                }
                sum += squares.sum();
            }
        }
        sum.sqrt()
    }

    pub(super) fn is_zero(&self) -> bool {
        self.lanes.iter().flat_map(|lane| &lane.0).all(|&entry| entry == 0.0)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.lanes.iter().flat_map(|lane| &lane.0).fold(true, |finite, entry| finite & entry.is_finite())
    }
}
