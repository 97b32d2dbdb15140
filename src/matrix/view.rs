//! Views of row-major matrices, and the conversions for parameters of type `impl Into<MatrixView>`
//! or `impl Into<MatrixViewMut>`.

use std::fmt;
use std::ops::{Index, IndexMut};

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut};

use super::{Matrix, check_count};
use crate::ffi;

/// Borrowed row-major matrix: an array of the engine, or a [`Matrix`].
#[derive(Clone, Copy, PartialEq)]
pub struct MatrixView<'a> {
    pub(super) nrows: usize,
    pub(super) ncols: usize,
    pub(super) values: &'a [f64],
}

impl<'a> MatrixView<'a> {
    /// Creates a view of an array of the engine.
    ///
    /// # Safety
    ///
    /// As for [`ffi::array`], with `nrows * ncols` values.
    #[inline]
    pub(crate) unsafe fn from_raw(array: *const f64, nrows: usize, ncols: usize) -> Self {
        // SAFETY: the caller's promise. An array that the engine has not allocated is NULL and has
        // no rows here.
        let values = unsafe { ffi::array(array, nrows * ncols) };
        Self { nrows, ncols, values }
    }

    /// Creates a view of values in row-major order.
    ///
    /// # Panics
    ///
    /// If the number of values is not `nrows * ncols`.
    pub fn from_row_major(nrows: usize, ncols: usize, values: &'a [f64]) -> Self {
        check_count(nrows, ncols, values.len());
        Self { nrows, ncols, values }
    }

    /// Returns the number of rows.
    #[inline]
    pub fn nrows(&self) -> usize {
        self.nrows
    }

    /// Returns the number of columns.
    #[inline]
    pub fn ncols(&self) -> usize {
        self.ncols
    }

    /// Returns the numbers of rows and columns.
    #[inline]
    pub fn shape(&self) -> (usize, usize) {
        (self.nrows, self.ncols)
    }

    /// Returns all values in row-major order.
    #[inline]
    pub fn as_slice(&self) -> &'a [f64] {
        self.values
    }

    /// Returns one row.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    #[inline]
    pub fn row(&self, row: usize) -> &'a [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &self.values[row * self.ncols..][..self.ncols]
    }

    /// Returns an iterator over the rows.
    pub fn rows(self) -> impl DoubleEndedIterator<Item = &'a [f64]> + ExactSizeIterator {
        (0..self.nrows).map(move |row| self.row(row))
    }

    /// Returns the transpose as a nalgebra view of the same memory.
    #[inline]
    pub fn transposed(&self) -> DMatrixView<'a, f64> {
        DMatrixView::from_slice(self.values, self.ncols, self.nrows)
    }

    /// Returns a copy as a nalgebra matrix, in column-major order.
    pub fn to_nalgebra(&self) -> DMatrix<f64> {
        self.transposed().transpose()
    }

    /// Rounds all values to single precision, in row-major order, as most neural networks expect
    /// them.
    ///
    /// ```
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let batch = Batch::new(sample::cartpole(), 8)?;
    /// let observations = batch.observations();
    /// let mut inputs = vec![0.0_f32; observations.as_slice().len()];
    /// observations.to_f32_into(&mut inputs);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If the number of values differs.
    pub fn to_f32_into(&self, values: &mut [f32]) {
        check_count(self.nrows, self.ncols, values.len());
        for (to, from) in values.iter_mut().zip(self.values) {
            *to = *from as f32;
        }
    }

    /// Returns a row-major copy.
    pub fn to_matrix(&self) -> Matrix {
        Matrix { nrows: self.nrows, ncols: self.ncols, values: self.values.to_vec() }
    }
}

impl Index<(usize, usize)> for MatrixView<'_> {
    type Output = f64;

    /// # Panics
    ///
    /// If an index is out of bounds.
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.row(row)[column]
    }
}

impl Index<(usize, usize)> for MatrixViewMut<'_> {
    type Output = f64;

    /// # Panics
    ///
    /// If an index is out of bounds.
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.row(row)[column]
    }
}

impl IndexMut<(usize, usize)> for MatrixViewMut<'_> {
    /// # Panics
    ///
    /// If an index is out of bounds.
    #[inline]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.row_mut(row)[column]
    }
}

impl fmt::Debug for MatrixView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.rows()).finish()
    }
}

impl fmt::Display for MatrixView<'_> {
    /// Writes one line per row. The precision defaults to eight digits after the point, as in
    /// `mju_printMat`. A width aligns the columns.
    ///
    /// ```
    /// use mujoco_safe::Matrix;
    ///
    /// let m = Matrix::from_rows(&[[1.0, -2.5], [10.0, 0.0]]);
    /// assert_eq!(format!("{m:6.2}"), "  1.00  -2.50\n 10.00   0.00\n");
    /// assert_eq!(m.to_string(), "1.00000000 -2.50000000\n10.00000000 0.00000000\n");
    /// ```
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, precision) = (f.width().unwrap_or(0), f.precision().unwrap_or(8));
        for row in self.rows() {
            for (column, value) in row.iter().enumerate() {
                let separator = if column == 0 { "" } else { " " };
                write!(f, "{separator}{value:width$.precision$}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Mutably borrowed row-major matrix.
///
/// ```
/// use mujoco_safe::matrix::MatrixViewMut;
///
/// let mut values = [0.0; 6];
/// let mut m = MatrixViewMut::from_row_major(2, 3, &mut values);
/// m[(1, 2)] = 5.0;
/// m.row_mut(0).fill(1.0);
/// assert_eq!((m.nrows(), m[(0, 1)], m.row(1)), (2, 1.0, &[0.0, 0.0, 5.0][..]));
/// ```
#[derive(Debug)]
pub struct MatrixViewMut<'a> {
    nrows: usize,
    ncols: usize,
    values: &'a mut [f64],
}

impl<'a> MatrixViewMut<'a> {
    /// Creates a mutable view of an array of the engine.
    ///
    /// # Safety
    ///
    /// As for [`ffi::array_mut`], with `nrows * ncols` values.
    #[inline]
    pub(crate) unsafe fn from_raw(array: *mut f64, nrows: usize, ncols: usize) -> Self {
        // SAFETY: the caller's promise.
        let values = unsafe { ffi::array_mut(array, nrows * ncols) };
        Self { nrows, ncols, values }
    }

    /// Creates a view of values in row-major order.
    ///
    /// # Panics
    ///
    /// If the number of values is not `nrows * ncols`.
    pub fn from_row_major(nrows: usize, ncols: usize, values: &'a mut [f64]) -> Self {
        check_count(nrows, ncols, values.len());
        Self { nrows, ncols, values }
    }

    /// Returns the number of rows.
    #[inline]
    pub fn nrows(&self) -> usize {
        self.nrows
    }

    /// Returns the number of columns.
    #[inline]
    pub fn ncols(&self) -> usize {
        self.ncols
    }

    /// Returns the numbers of rows and columns.
    #[inline]
    pub fn shape(&self) -> (usize, usize) {
        (self.nrows, self.ncols)
    }

    /// Returns an immutable view of the same values.
    #[inline]
    pub fn view(&self) -> MatrixView<'_> {
        MatrixView { nrows: self.nrows, ncols: self.ncols, values: self.values }
    }

    /// Returns one row.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    #[inline]
    pub fn row(&self, row: usize) -> &[f64] {
        self.view().row(row)
    }

    /// Returns one row, mutably.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        MatrixViewMut::from(self).into_row(row)
    }

    /// Returns one row, mutably, with the lifetime of the matrix.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    #[inline]
    pub fn into_row(self, row: usize) -> &'a mut [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &mut self.values[row * self.ncols..][..self.ncols]
    }

    /// Splits off the first rows from the others.
    ///
    /// # Panics
    ///
    /// If there are fewer rows.
    pub(crate) fn split_rows(self, first: usize) -> (Self, Self) {
        let Self { nrows, ncols, values } = self;
        let (values, others) = values.split_at_mut(first * ncols);
        (Self { nrows: first, ncols, values }, Self { nrows: nrows - first, ncols, values: others })
    }

    /// Returns all values in row-major order, mutably.
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        self.values
    }

    /// Returns the transpose as a mutable nalgebra view of the same memory.
    #[inline]
    pub fn transposed_mut(&mut self) -> DMatrixViewMut<'_, f64> {
        DMatrixViewMut::from_slice(self.values, self.ncols, self.nrows)
    }
}

impl<'a> From<&'a Matrix> for MatrixView<'a> {
    #[inline]
    fn from(matrix: &'a Matrix) -> Self {
        matrix.view()
    }
}

impl<'a> From<&'a MatrixViewMut<'_>> for MatrixView<'a> {
    #[inline]
    fn from(matrix: &'a MatrixViewMut<'_>) -> Self {
        matrix.view()
    }
}

impl<'a, const N: usize> From<&'a [[f64; N]]> for MatrixView<'a> {
    /// Converts an array of the engine with a fixed number of columns, such as `data.cdof()`.
    #[inline]
    fn from(rows: &'a [[f64; N]]) -> Self {
        Self { nrows: rows.len(), ncols: N, values: rows.as_flattened() }
    }
}

impl<'a, const R: usize, const N: usize> From<&'a [[f64; N]; R]> for MatrixView<'a> {
    #[inline]
    fn from(rows: &'a [[f64; N]; R]) -> Self {
        Self::from(rows.as_slice())
    }
}

impl<'a> From<&'a mut Matrix> for MatrixViewMut<'a> {
    #[inline]
    fn from(matrix: &'a mut Matrix) -> Self {
        Self { nrows: matrix.nrows, ncols: matrix.ncols, values: &mut matrix.values }
    }
}

impl<'a> From<&'a mut MatrixViewMut<'_>> for MatrixViewMut<'a> {
    /// Reborrows the view.
    #[inline]
    fn from(matrix: &'a mut MatrixViewMut<'_>) -> Self {
        Self { nrows: matrix.nrows, ncols: matrix.ncols, values: matrix.values }
    }
}

impl<'a, const N: usize> From<&'a mut [[f64; N]]> for MatrixViewMut<'a> {
    #[inline]
    fn from(rows: &'a mut [[f64; N]]) -> Self {
        Self { nrows: rows.len(), ncols: N, values: rows.as_flattened_mut() }
    }
}

impl<'a, const R: usize, const N: usize> From<&'a mut [[f64; N]; R]> for MatrixViewMut<'a> {
    #[inline]
    fn from(rows: &'a mut [[f64; N]; R]) -> Self {
        Self::from(rows.as_mut_slice())
    }
}
