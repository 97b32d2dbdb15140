//! A matrix packed for the kernels: panels of eight columns, each stored row by row.
//!
//! Rows and columns are padded with zeros to whole blocks. Sums and products of padded matrices are
//! padded matrices, so no loop has a remainder.

use nalgebra::DMatrix;

use super::simd::{self, BLOCK, Blocks, F64x8, Update};
use crate::matrix::{Matrix, StridedView};
use crate::numerics::InstructionSet;

/// Matrix in padded panels of eight columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct PackedMatrix {
    rows: usize,
    columns: usize,
    /// Panels one after another, each of [`padded_rows`](Self::padded_rows) rows.
    vectors: Vec<F64x8>,
}

impl PackedMatrix {
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the number of rows, padded to whole blocks.
    pub(crate) fn padded_rows(&self) -> usize {
        self.rows.next_multiple_of(BLOCK)
    }

    pub(super) fn vectors(&self) -> &[F64x8] {
        &self.vectors
    }

    pub(super) fn vectors_mut(&mut self) -> &mut [F64x8] {
        &mut self.vectors
    }

    /// Resizes the matrix and sets it to zero. Allocates only if the matrix was never as large
    /// before.
    pub(crate) fn clear(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.vectors.clear();
        self.vectors.resize(self.padded_rows() * columns.div_ceil(BLOCK), F64x8::ZERO);
    }

    /// Resizes the matrix and leaves the entries unspecified. The caller overwrites all of them.
    fn resize(&mut self, rows: usize, columns: usize) {
        (self.rows, self.columns) = (rows, columns);
        self.vectors.resize(self.padded_rows() * columns.div_ceil(BLOCK), F64x8::ZERO);
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        (self.rows, self.columns) = (other.rows, other.columns);
        self.vectors.clone_from(&other.vectors);
    }

    pub(crate) fn get(&self, row: usize, column: usize) -> f64 {
        self.vectors[column / BLOCK * self.padded_rows() + row].0[column % BLOCK]
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        let index = column / BLOCK * self.padded_rows() + row;
        self.vectors[index].0[column % BLOCK] = value;
    }

    /// Copies a matrix whose rows are one after another in memory.
    pub(crate) fn copy_rows(&mut self, rows: usize, columns: usize, values: &[f64]) {
        debug_assert_eq!(values.len(), rows * columns);
        self.resize(rows, columns);
        let size = self.padded_rows();
        if values.is_empty() {
            return;
        }
        for (panel, vectors) in self.vectors.chunks_exact_mut(size).enumerate() {
            let (used, padding) = vectors.split_at_mut(rows);
            for (vector, row) in used.iter_mut().zip(values.chunks_exact(columns)) {
                let row = &row[BLOCK * panel..];
                // A copy of constant length compiles to a few instructions instead of a function
                // call.
                vector.0 = row.first_chunk().copied().unwrap_or_else(|| {
                    let mut block = [0.0; BLOCK];
                    block.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
                    block
                });
            }
            padding.fill(F64x8::ZERO);
        }
    }

    /// Copies the symmetric part `(M + Mᵀ) / 2` of a square matrix.
    pub(crate) fn copy_symmetric_part(&mut self, matrix: &Matrix) {
        self.copy_rows(matrix.nrows(), matrix.ncols(), matrix.as_slice());
        self.symmetrise();
    }

    /// Writes a row to a slice with an entry for each column.
    pub(crate) fn row_into(&self, row: usize, output: &mut [f64]) {
        let size = self.padded_rows();
        for (output, panel) in output.chunks_mut(BLOCK).zip(self.vectors.chunks_exact(size)) {
            output.copy_from_slice(&panel[row].0[..output.len()]);
        }
    }

    pub(crate) fn copy_view(&mut self, view: &StridedView<'_>) {
        let (rows, columns) = view.shape();
        self.fill(rows, columns, |row, column| view[(row, column)]);
    }

    pub(crate) fn fill(&mut self, rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) {
        self.clear(rows, columns);
        let size = self.padded_rows();
        if size == 0 {
            return;
        }
        for (panel, vectors) in self.vectors.chunks_exact_mut(size).enumerate() {
            let first = BLOCK * panel;
            for (row, vector) in vectors[..rows].iter_mut().enumerate() {
                for (offset, entry) in vector.0.iter_mut().take(columns - first).enumerate() {
                    *entry = value(row, first + offset);
                }
            }
        }
    }

    /// Writes the entries, each multiplied by a factor.
    pub(crate) fn write_to(&self, matrix: &mut Matrix, factor: impl Fn(usize, usize) -> f64) {
        if matrix.shape() != (self.rows, self.columns) {
            *matrix = Matrix::zeros(self.rows, self.columns);
        }
        for row in 0..self.rows {
            for (column, entry) in matrix.row_mut(row).iter_mut().enumerate() {
                *entry = self.get(row, column) * factor(row, column);
            }
        }
    }

    pub(crate) fn to_matrix(&self, factor: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        DMatrix::from_fn(self.rows, self.columns, |row, column| self.get(row, column) * factor(row, column))
    }

    pub(crate) fn transpose_from(&mut self, other: &Self) {
        self.resize(other.columns, other.rows);
        let (size, other_size) = (self.padded_rows(), other.padded_rows());
        if size == 0 || other_size == 0 {
            return;
        }
        for (panel, vectors) in self.vectors.chunks_exact_mut(size).enumerate() {
            for (vectors, from) in
                vectors.as_chunks_mut::<BLOCK>().0.iter_mut().zip(other.vectors.chunks_exact(other_size))
            {
                let from: &[F64x8; BLOCK] = from[BLOCK * panel..].first_chunk().expect("Bug: panels end with a block");
                for (row, vector) in vectors.iter_mut().enumerate() {
                    vector.0.iter_mut().zip(from).for_each(|(to, from)| *to = from.0[row]);
                }
            }
        }
    }

    /// Copies the lower triangle to the upper one.
    fn mirror(&mut self) {
        let size = self.padded_rows();
        for panel in 0..size / BLOCK {
            for block in 0..=panel {
                let from: [F64x8; BLOCK] =
                    *self.vectors[block * size + BLOCK * panel..].first_chunk().expect("Bug: panels end with a block");
                let to = &mut self.vectors[panel * size + BLOCK * block..][..BLOCK];
                for (row, vector) in to.iter_mut().enumerate() {
                    let first = if block == panel { row + 1 } else { 0 };
                    vector.0.iter_mut().zip(&from).skip(first).for_each(|(to, from)| *to = from.0[row]);
                }
            }
        }
    }

    /// Replaces a square matrix by its symmetric part.
    pub(crate) fn symmetrise(&mut self) {
        let size = self.padded_rows();
        for panel in 0..size / BLOCK {
            for block in 0..=panel {
                let [lower, upper] = [block * size + BLOCK * panel, panel * size + BLOCK * block];
                for row in 0..BLOCK {
                    let first = if block == panel { row + 1 } else { 0 };
                    for lane in first..BLOCK {
                        let mean = 0.5 * (self.vectors[lower + lane].0[row] + self.vectors[upper + row].0[lane]);
                        self.vectors[lower + lane].0[row] = mean;
                        self.vectors[upper + row].0[lane] = mean;
                    }
                }
            }
        }
    }

    /// Computes `self = left · right`.
    pub(crate) fn product(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        self.resize(left.rows, right.columns);
        simd::multiply(simd, self.blocks(Update::Set, false), &left.vectors, &right.vectors);
    }

    /// Computes `self -= left · right`.
    pub(crate) fn subtract_product(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.columns), (left.rows, right.columns, right.rows));
        simd::multiply(simd, self.blocks(Update::Subtract, false), &left.vectors, &right.vectors);
    }

    /// Computes `self = leftᵀ · right`.
    pub(crate) fn transposed_product(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        self.resize(left.columns, right.columns);
        simd::multiply_transposed(simd, self.blocks(Update::Set, false), &left.vectors, &right.vectors);
    }

    /// Computes `self += leftᵀ · right`.
    pub(crate) fn add_transposed_product(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.rows), (left.columns, right.columns, right.rows));
        simd::multiply_transposed(simd, self.blocks(Update::Add, false), &left.vectors, &right.vectors);
    }

    /// Computes `sums += selfᵀ · vector`.
    pub(crate) fn add_transposed_times(&self, simd: InstructionSet, vector: &[f64], sums: &mut [f64]) {
        debug_assert_eq!((self.rows, self.columns), (vector.len(), sums.len()));
        if vector.is_empty() {
            return;
        }
        for (sums, panel) in sums.chunks_mut(BLOCK).zip(self.vectors.chunks_exact(self.padded_rows())) {
            let mut block = F64x8::ZERO;
            block.0[..sums.len()].copy_from_slice(sums);
            simd::add_rows(simd, vector, panel, &mut block);
            sums.copy_from_slice(&block.0[..sums.len()]);
        }
    }

    /// Computes `self += left · right` for a symmetric product and a symmetric `self`. Computes
    /// only the lower triangle.
    pub(crate) fn add_symmetric_product(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.columns), (left.rows, right.columns, right.rows));
        simd::multiply(simd, self.blocks(Update::Add, true), &left.vectors, &right.vectors);
        self.mirror();
    }

    /// Computes `self += leftᵀ · right` for a symmetric product and a symmetric `self`. Computes
    /// only the lower triangle.
    pub(crate) fn add_symmetric_transposed(&mut self, simd: InstructionSet, left: &Self, right: &Self) {
        debug_assert_eq!((self.rows, self.columns, left.rows), (left.columns, right.columns, right.rows));
        simd::multiply_transposed(simd, self.blocks(Update::Add, true), &left.vectors, &right.vectors);
        self.mirror();
    }

    fn blocks(&mut self, update: Update, only_lower: bool) -> Blocks<'_> {
        let size = self.padded_rows();
        Blocks { vectors: &mut self.vectors, size, update, only_lower }
    }

    /// Computes `self += other`.
    pub(crate) fn add(&mut self, other: &Self) {
        for (to, from) in self.vectors.iter_mut().zip(&other.vectors) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to += from);
        }
    }

    /// Computes `self += factor · other`.
    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f64) {
        for (to, from) in self.vectors.iter_mut().zip(&other.vectors) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to += factor * from);
        }
    }

    /// Computes `self -= other`.
    pub(crate) fn subtract(&mut self, other: &Self) {
        for (to, from) in self.vectors.iter_mut().zip(&other.vectors) {
            to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to -= from);
        }
    }

    /// Computes `self += sum · I`.
    pub(crate) fn add_to_diagonal(&mut self, sum: f64) {
        for index in 0..self.rows {
            let value = self.get(index, index);
            self.set(index, index, value + sum);
        }
    }

    pub(crate) fn scale(&mut self, factor: f64) {
        self.vectors.iter_mut().flat_map(|vector| &mut vector.0).for_each(|entry| *entry *= factor);
    }

    /// Multiplies each row and each column by a factor.
    pub(crate) fn scale_both(&mut self, rows: impl Fn(usize) -> f64, columns: impl Fn(usize) -> f64) {
        let (size, count, width) = (self.padded_rows(), self.rows, self.columns);
        if size == 0 {
            return;
        }
        for (panel, vectors) in self.vectors.chunks_exact_mut(size).enumerate() {
            let first = BLOCK * panel;
            let mut factors = [0.0; BLOCK];
            factors
                .iter_mut()
                .enumerate()
                .take(width - first)
                .for_each(|(offset, factor)| *factor = columns(first + offset));
            for (row, vector) in vectors[..count].iter_mut().enumerate() {
                let factor = rows(row);
                vector.0.iter_mut().zip(factors).for_each(|(entry, by)| *entry *= factor * by);
            }
        }
    }

    /// Returns the Frobenius norm.
    pub(crate) fn norm(&self) -> f64 {
        let mut sums = [F64x8::ZERO; 2];
        for pair in self.vectors.as_chunks::<2>().0 {
            for (sums, vector) in sums.iter_mut().zip(pair) {
                sums.0.iter_mut().zip(vector.0).for_each(|(sum, entry)| *sum += entry * entry);
            }
        }
        (sums[0].sum() + sums[1].sum()).sqrt()
    }

    /// Returns the Frobenius norm after multiplying each row and each column by its unit. With an
    /// empty slice, all units are 1. The slice must be padded to
    /// [`padded_rows`](Self::padded_rows).
    pub(crate) fn norm_in(&self, units: &[f64]) -> f64 {
        if units.is_empty() {
            return self.norm();
        }
        let mut sum = 0.0;
        for (panel, columns) in self.vectors.chunks_exact(self.padded_rows().max(1)).zip(units.as_chunks::<BLOCK>().0) {
            for (vector, unit) in panel.iter().zip(units) {
                let mut squares = F64x8::ZERO;
                for ((square, entry), column) in squares.0.iter_mut().zip(vector.0).zip(columns) {
                    let value = entry * unit * column;
                    *square = value * value;
                }
                sum += squares.sum();
            }
        }
        sum.sqrt()
    }

    /// Returns the sum of the weighted squares of a row of a square matrix. The weights must be
    /// padded to [`padded_rows`](Self::padded_rows).
    pub(crate) fn weighted_row_square_sum(&self, row: usize, weights: &[f64]) -> f64 {
        let panels = self.vectors.chunks_exact(self.padded_rows()).zip(weights.as_chunks::<BLOCK>().0);
        let mut sums = [0.0; BLOCK];
        for (panel, weights) in panels {
            for ((sum, entry), weight) in sums.iter_mut().zip(panel[row].0).zip(weights) {
                *sum += entry * entry * weight;
            }
        }
        sums.iter().sum()
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.vectors.iter().flat_map(|vector| &vector.0).all(|&entry| entry == 0.0)
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.vectors.iter().flat_map(|vector| &vector.0).fold(true, |finite, entry| finite & entry.is_finite())
    }
}
