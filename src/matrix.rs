//! Row-major matrices, as the engine lays them out, and nalgebra's view of them.
//!
//! The engine writes rows one behind another; nalgebra's own matrices have columns one behind another. Handing the memory of
//! the one to the other gives a scrambled result and no error. So the engine only ever writes into a [`Matrix`].
//!
//! The rows of a matrix are the columns of its transpose, so the same memory *is* a nalgebra matrix: the transposed one.
//! [`Matrix::transposed`] lends it without a copy, and nalgebra's `tr_mul` multiplies by the transpose of what it is called on,
//! so nothing has to be turned round:
//!
//! ```
//! use mujoco_safe::Matrix;
//! use nalgebra::dvector;
//!
//! let m = Matrix::from_rows(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
//! assert_eq!(m.row(1), &[4.0, 5.0, 6.0]);
//!
//! let product = m.transposed().tr_mul(&dvector![1.0, 0.0, -1.0]); // m · v, no copy
//! assert_eq!(product, dvector![-2.0, -2.0]);
//! let gram = m.transposed() * m.to_nalgebra();                    // mᵀ · m, one copy
//! assert_eq!(Matrix::from(&gram)[(0, 1)], 22.0);
//! ```
//!
//! (A view of the matrix itself would need a row stride, and nalgebra up to 0.35 reads and writes out of bounds when it
//! multiplies such a view with a vector: <https://github.com/dimforge/nalgebra/issues/1616>.)
//!
//! A column-major matrix is not accepted where the engine writes:
//!
//! ```compile_fail,E0308
//! use mujoco_safe::{Data, sample};
//! use nalgebra::DMatrix;
//!
//! let model = std::sync::Arc::new(sample::humanoid());
//! let mut data = Data::new(model.clone())?;
//! data.forward()?;
//! let mut wrong = DMatrix::<f64>::zeros(3, model.nv());
//! data.jac_subtree_com_into(model.body("torso")?, &mut wrong)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```

mod convert;

use std::fmt;
use std::ops::{Index, IndexMut};

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut};

use crate::ffi;

/// Matrices of more values than this, 128 MiB, are worth a look at the memory that there is.
const LARGE: usize = 1 << 24;

/// How many values there are. The product must not wrap round: nalgebra checks the size of what it views with the same
/// arithmetic, and would read beyond the values.
#[track_caller]
fn count(nrows: usize, ncols: usize) -> usize {
    nrows.checked_mul(ncols).unwrap_or_else(|| panic!("a matrix of {nrows} rows and {ncols} columns is too large"))
}

#[track_caller]
fn check_count(nrows: usize, ncols: usize, found: usize) {
    let expected = count(nrows, ncols);
    assert!(found == expected, "a matrix of {nrows} rows and {ncols} columns needs {expected} values, not {found}");
}

/// A matrix that owns its values, row by row.
#[derive(Clone, PartialEq, Default)]
pub struct Matrix {
    nrows: usize,
    ncols: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    ///
    /// # Panics
    ///
    /// If there is no memory for so many.
    #[doc(alias = "mj_zeros")]
    pub fn zeros(nrows: usize, ncols: usize) -> Self {
        let count = count(nrows, ncols);
        // `vec!` ends the process where there is no memory. It takes its zeros from fresh pages, unlike a reserved vector.
        if count > LARGE {
            let probe = Vec::<f64>::new().try_reserve_exact(count);
            assert!(probe.is_ok(), "there is no memory for a matrix of {nrows} rows and {ncols} columns");
        }
        Self { nrows, ncols, values: vec![0.0; count] }
    }

    /// The matrix of these rows.
    #[doc(alias = "mj_array")]
    pub fn from_rows<const N: usize>(rows: &[[f64; N]]) -> Self {
        Self { nrows: rows.len(), ncols: N, values: rows.concat() }
    }

    /// The matrix whose values are given row by row.
    ///
    /// # Panics
    ///
    /// If there are not `nrows * ncols` values.
    pub fn from_row_major(nrows: usize, ncols: usize, values: Vec<f64>) -> Self {
        check_count(nrows, ncols, values.len());
        Self { nrows, ncols, values }
    }

    /// The number of rows.
    #[inline]
    pub fn nrows(&self) -> usize {
        self.nrows
    }

    /// The number of columns.
    #[inline]
    pub fn ncols(&self) -> usize {
        self.ncols
    }

    /// Rows and columns.
    #[inline]
    pub fn shape(&self) -> (usize, usize) {
        (self.nrows, self.ncols)
    }

    /// All values, row by row.
    #[inline]
    pub fn as_slice(&self) -> &[f64] {
        &self.values
    }

    /// All values, row by row, to be written to.
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// One row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> &[f64] {
        self.view().row(row)
    }

    /// All rows, from the first to the last.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.view().rows()
    }

    /// One row, to be written to.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &mut self.values[row * self.ncols..][..self.ncols]
    }

    /// The matrix as a view.
    #[inline]
    pub fn view(&self) -> MatrixView<'_> {
        MatrixView { nrows: self.nrows, ncols: self.ncols, values: &self.values }
    }

    /// The transpose, as a nalgebra view of the same memory.
    #[inline]
    pub fn transposed(&self) -> DMatrixView<'_, f64> {
        self.view().transposed()
    }

    /// The transpose, as a nalgebra view of the same memory, to be written to.
    #[inline]
    pub fn transposed_mut(&mut self) -> DMatrixViewMut<'_, f64> {
        DMatrixViewMut::from_slice(&mut self.values, self.ncols, self.nrows)
    }

    /// The matrix whose transpose is given, in the same memory.
    pub fn from_transposed(transpose: DMatrix<f64>) -> Self {
        let (ncols, nrows) = transpose.shape();
        Self { nrows, ncols, values: transpose.data.into() }
    }

    /// The transpose, in the same memory.
    pub fn into_transposed(self) -> DMatrix<f64> {
        DMatrix::from_vec(self.ncols, self.nrows, self.values)
    }

    /// The matrix as nalgebra keeps it: a copy, column by column.
    pub fn to_nalgebra(&self) -> DMatrix<f64> {
        self.view().to_nalgebra()
    }

    /// For the engine to write to.
    #[inline]
    pub(crate) fn as_mut_ptr(&mut self) -> *mut f64 {
        self.values.as_mut_ptr()
    }
}

impl From<&DMatrix<f64>> for Matrix {
    /// A row-major copy.
    fn from(matrix: &DMatrix<f64>) -> Self {
        Self::from_transposed(matrix.transpose())
    }
}

impl fmt::Display for Matrix {
    /// As that of [`MatrixView`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.view(), f)
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    /// # Panics
    ///
    /// If there is no such row or column.
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.row(row)[column]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.row_mut(row)[column]
    }
}

impl fmt::Debug for Matrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.view(), f)
    }
}

/// A matrix in memory of somebody else's, row by row: an array of the engine, or a [`Matrix`].
#[derive(Clone, Copy, PartialEq)]
pub struct MatrixView<'a> {
    nrows: usize,
    ncols: usize,
    values: &'a [f64],
}

impl<'a> MatrixView<'a> {
    /// # Safety
    ///
    /// As for [`ffi::array`], with `nrows * ncols` values.
    #[inline]
    pub(crate) unsafe fn from_raw(array: *const f64, nrows: usize, ncols: usize) -> Self {
        // SAFETY: the caller's promise. An array that the engine does not have is NULL, and then has no rows here.
        let values = unsafe { ffi::array(array, nrows * ncols) };
        Self { nrows, ncols, values }
    }

    /// The matrix whose values are given row by row.
    ///
    /// # Panics
    ///
    /// If there are not `nrows * ncols` values.
    pub fn from_row_major(nrows: usize, ncols: usize, values: &'a [f64]) -> Self {
        check_count(nrows, ncols, values.len());
        Self { nrows, ncols, values }
    }

    /// The number of rows.
    #[inline]
    pub fn nrows(&self) -> usize {
        self.nrows
    }

    /// The number of columns.
    #[inline]
    pub fn ncols(&self) -> usize {
        self.ncols
    }

    /// Rows and columns.
    #[inline]
    pub fn shape(&self) -> (usize, usize) {
        (self.nrows, self.ncols)
    }

    /// All values, row by row.
    #[inline]
    pub fn as_slice(&self) -> &'a [f64] {
        self.values
    }

    /// One row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> &'a [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &self.values[row * self.ncols..][..self.ncols]
    }

    /// All rows, from the first to the last.
    pub fn rows(self) -> impl ExactSizeIterator<Item = &'a [f64]> {
        (0..self.nrows).map(move |row| self.row(row))
    }

    /// The transpose, as a nalgebra view of the same memory.
    #[inline]
    pub fn transposed(&self) -> DMatrixView<'a, f64> {
        DMatrixView::from_slice(self.values, self.ncols, self.nrows)
    }

    /// The matrix as nalgebra keeps it: a copy, column by column.
    pub fn to_nalgebra(&self) -> DMatrix<f64> {
        self.transposed().transpose()
    }

    /// A row-major copy.
    pub fn to_matrix(&self) -> Matrix {
        Matrix { nrows: self.nrows, ncols: self.ncols, values: self.values.to_vec() }
    }
}

impl Index<(usize, usize)> for MatrixView<'_> {
    type Output = f64;

    /// # Panics
    ///
    /// If there is no such row or column.
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.row(row)[column]
    }
}

impl fmt::Debug for MatrixView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.rows()).finish()
    }
}

impl fmt::Display for MatrixView<'_> {
    /// A line for each row, with eight digits after the point as `mju_printMat` has, or with as many as are asked for. A width
    /// makes columns of it.
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

/// A matrix in memory of somebody else's, row by row, to be written to.
#[derive(Debug)]
pub struct MatrixViewMut<'a> {
    nrows: usize,
    ncols: usize,
    values: &'a mut [f64],
}

impl<'a> MatrixViewMut<'a> {
    /// # Safety
    ///
    /// As for [`ffi::array_mut`], with `nrows * ncols` values.
    #[inline]
    pub(crate) unsafe fn from_raw(array: *mut f64, nrows: usize, ncols: usize) -> Self {
        // SAFETY: the caller's promise.
        let values = unsafe { ffi::array_mut(array, nrows * ncols) };
        Self { nrows, ncols, values }
    }

    /// The matrix whose values are given row by row.
    ///
    /// # Panics
    ///
    /// If there are not `nrows * ncols` values.
    pub fn from_row_major(nrows: usize, ncols: usize, values: &'a mut [f64]) -> Self {
        check_count(nrows, ncols, values.len());
        Self { nrows, ncols, values }
    }

    /// Rows and columns.
    #[inline]
    pub fn shape(&self) -> (usize, usize) {
        (self.nrows, self.ncols)
    }

    /// The same, to be read.
    #[inline]
    pub fn as_view(&self) -> MatrixView<'_> {
        MatrixView { nrows: self.nrows, ncols: self.ncols, values: self.values }
    }

    /// One row, to be written to for as long as the whole matrix could be.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn into_row(self, row: usize) -> &'a mut [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &mut self.values[row * self.ncols..][..self.ncols]
    }

    /// All values, row by row, to be written to.
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        self.values
    }

    /// The transpose, as a nalgebra view of the same memory, to be written to.
    #[inline]
    pub fn transposed_mut(&mut self) -> DMatrixViewMut<'_, f64> {
        DMatrixViewMut::from_slice(self.values, self.ncols, self.nrows)
    }
}
