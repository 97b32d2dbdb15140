//! Row-major matrices in the engine's layout, and nalgebra views of them.
//!
//! The engine is row-major, nalgebra's own matrices are column-major. Passing the memory of one to
//! the other silently gives a scrambled result. Therefore the engine only writes into a [`Matrix`].
//!
//! Row-major memory of a matrix is column-major memory of its transpose. [`Matrix::transposed`]
//! borrows it as a nalgebra view without a copy, and nalgebra's `tr_mul` multiplies by the
//! transpose of its receiver, so no explicit transposition is needed:
//!
//! ```
//! use mujoco_safe::Matrix;
//! use mujoco_safe::nalgebra::{Vector2, Vector3};
//!
//! let m = Matrix::from_rows(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
//! assert_eq!(m.row(1), &[4.0, 5.0, 6.0]);
//!
//! let product = m.transposed().tr_mul(&Vector3::new(1.0, 0.0, -1.0)); // m · v, no copy
//! assert_eq!(product, Vector2::new(-2.0, -2.0));
//! let gram = m.transposed() * m.to_nalgebra();                    // mᵀ · m, one copy
//! assert_eq!(Matrix::from(&gram)[(0, 1)], 22.0);
//! ```
//!
//! (A view of the matrix itself would need a row stride. Nalgebra up to 0.35 reads and writes out
//! of bounds when it multiplies such a view by a vector:
//! <https://github.com/dimforge/nalgebra/issues/1616>.)
//!
//! Functions of the engine do not accept a column-major matrix as output:
//!
//! ```compile_fail,E0308
//! use mujoco_safe::{Data, sample};
//! use mujoco_safe::nalgebra::DMatrix;
//!
//! let model = std::sync::Arc::new(sample::humanoid());
//! let mut data = Data::new(model.clone())?;
//! data.forward()?;
//! let mut wrong = DMatrix::<f64>::zeros(3, model.nv());
//! data.jac_subtree_com_into(model.body("torso")?, &mut wrong)?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```

#[cfg(feature = "ndarray")]
mod ndarray;
mod strided;
mod view;

use std::fmt;
use std::ops::{Index, IndexMut};

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, Dim, RawStorage};

pub use self::strided::StridedView;
pub use self::view::{MatrixView, MatrixViewMut};

/// Number of values, 128 MiB, beyond which [`Matrix::zeros`] checks the available memory first.
const LARGE: usize = 1 << 24;

/// Returns the number of values. The product must not overflow: nalgebra checks the size of a view
/// with wrapping arithmetic, and would read out of bounds.
#[track_caller]
fn count(nrows: usize, ncols: usize) -> usize {
    nrows.checked_mul(ncols).unwrap_or_else(|| panic!("a matrix of {nrows} rows and {ncols} columns is too large"))
}

/// Panics unless `found` is the number of values of the matrix.
#[track_caller]
fn check_count(nrows: usize, ncols: usize, found: usize) {
    let expected = count(nrows, ncols);
    assert!(found == expected, "a matrix of {nrows} rows and {ncols} columns needs {expected} values, not {found}");
}

/// Row-major matrix that owns its values.
#[derive(Clone, PartialEq, Default)]
#[doc(alias = "mju_printMat")]
pub struct Matrix {
    nrows: usize,
    ncols: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// Creates a matrix of zeros.
    ///
    /// # Panics
    ///
    /// If there is not enough memory.
    #[doc(alias = "mj_zeros")]
    pub fn zeros(nrows: usize, ncols: usize) -> Self {
        let count = count(nrows, ncols);
        // `vec!` aborts the process if memory is exhausted, so large sizes are probed first. `vec!`
        // is kept for the allocation itself, because it gets its zeros from fresh pages, unlike a
        // reserved vector.
        if count > LARGE {
            let probe = Vec::<f64>::new().try_reserve_exact(count);
            assert!(probe.is_ok(), "there is not enough memory for a matrix of {nrows} rows and {ncols} columns");
        }
        Self { nrows, ncols, values: vec![0.0; count] }
    }

    /// Creates the identity of size `n`.
    pub fn identity(n: usize) -> Self {
        Self::from_diagonal(&vec![1.0; n])
    }

    /// Creates a square matrix from its diagonal; the other entries are zero.
    pub fn from_diagonal(diagonal: &[f64]) -> Self {
        let mut matrix = Self::zeros(diagonal.len(), diagonal.len());
        for (index, value) in diagonal.iter().enumerate() {
            matrix[(index, index)] = *value;
        }
        matrix
    }

    /// Creates a matrix from its rows.
    #[doc(alias = "mj_array")]
    pub fn from_rows<const N: usize>(rows: &[[f64; N]]) -> Self {
        Self { nrows: rows.len(), ncols: N, values: rows.concat() }
    }

    /// Creates a matrix from its values in row-major order.
    ///
    /// # Panics
    ///
    /// If the number of values is not `nrows * ncols`.
    pub fn from_row_major(nrows: usize, ncols: usize, values: Vec<f64>) -> Self {
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
    pub fn as_slice(&self) -> &[f64] {
        &self.values
    }

    /// Returns all values in row-major order, mutably.
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.values
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

    /// Returns an iterator over the rows.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = &[f64]> + ExactSizeIterator {
        self.view().rows()
    }

    /// Returns one row, mutably.
    ///
    /// # Panics
    ///
    /// If the index is out of bounds.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        assert!(row < self.nrows, "row {row} of a matrix with {} rows", self.nrows);
        &mut self.values[row * self.ncols..][..self.ncols]
    }

    /// Returns a view of the matrix.
    #[inline]
    pub fn view(&self) -> MatrixView<'_> {
        MatrixView { nrows: self.nrows, ncols: self.ncols, values: &self.values }
    }

    /// Returns the transpose as a nalgebra view of the same memory.
    #[inline]
    pub fn transposed(&self) -> DMatrixView<'_, f64> {
        self.view().transposed()
    }

    /// Returns the transpose as a mutable nalgebra view of the same memory.
    #[inline]
    pub fn transposed_mut(&mut self) -> DMatrixViewMut<'_, f64> {
        DMatrixViewMut::from_slice(&mut self.values, self.ncols, self.nrows)
    }

    /// Creates a matrix from its transpose without a copy.
    pub fn from_transposed(transpose: DMatrix<f64>) -> Self {
        let (ncols, nrows) = transpose.shape();
        Self { nrows, ncols, values: transpose.data.into() }
    }

    /// Converts the matrix into its transpose without a copy.
    pub fn into_transposed(self) -> DMatrix<f64> {
        DMatrix::from_vec(self.ncols, self.nrows, self.values)
    }

    /// Returns a copy as a nalgebra matrix, in column-major order.
    pub fn to_nalgebra(&self) -> DMatrix<f64> {
        self.view().to_nalgebra()
    }

    /// Returns a pointer for the engine's output.
    #[inline]
    pub(crate) fn as_mut_ptr(&mut self) -> *mut f64 {
        self.values.as_mut_ptr()
    }
}

impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> From<&nalgebra::Matrix<f64, R, C, S>> for Matrix {
    /// Copies a matrix or a view of nalgebra into row-major order.
    fn from(matrix: &nalgebra::Matrix<f64, R, C, S>) -> Self {
        let (nrows, ncols) = matrix.shape();
        let mut values = Vec::with_capacity(nrows * ncols);
        for row in 0..nrows {
            values.extend((0..ncols).map(|column| matrix[(row, column)]));
        }
        Self { nrows, ncols, values }
    }
}

impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> From<nalgebra::Matrix<f64, R, C, S>> for Matrix {
    /// Copies a matrix or a view of nalgebra into row-major order.
    fn from(matrix: nalgebra::Matrix<f64, R, C, S>) -> Self {
        Self::from(&matrix)
    }
}

impl fmt::Display for Matrix {
    /// Formats the matrix like [`MatrixView`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.view(), f)
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    /// # Panics
    ///
    /// If an index is out of bounds.
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
