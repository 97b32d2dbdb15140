//! Borrowed matrices in any memory layout.

use std::fmt;
use std::ops::Index;

use nalgebra::{DMatrixView, Dim, Dyn, RawStorage};

use super::{Matrix, MatrixView};

/// Borrowed matrix in any memory layout. Functions that only read a matrix take `impl
/// Into<StridedView>`: a reference to a [`Matrix`] or to a matrix or view of nalgebra, or a
/// [`MatrixView`], without a copy.
///
/// ```
/// use mujoco_safe::Matrix;
/// use mujoco_safe::matrix::StridedView;
/// use mujoco_safe::nalgebra::Matrix2x3;
///
/// let rows = Matrix::from_rows(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
/// let columns = Matrix2x3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
/// for view in [StridedView::from(&rows), StridedView::from(&columns)] {
///     assert_eq!((view.shape(), view[(1, 2)]), ((2, 3), 6.0));
/// }
/// ```
// The view of nalgebra is private, because safe code could multiply it: see the module `matrix`.
#[derive(Clone, Copy)]
pub struct StridedView<'a>(DMatrixView<'a, f64, Dyn, Dyn>);

impl<'a> StridedView<'a> {
    /// Returns the numbers of rows and columns.
    pub fn shape(&self) -> (usize, usize) {
        self.0.shape()
    }

    /// Returns a row-major copy.
    pub fn to_matrix(&self) -> Matrix {
        Matrix::from(&self.0)
    }

    /// Returns the entries of one column after another.
    pub(crate) fn columns(&self) -> impl Iterator<Item = impl Iterator<Item = f64> + 'a> + 'a {
        let view = self.0;
        let (nrows, ncols) = view.shape();
        (0..ncols).map(move |column| (0..nrows).map(move |row| view[(row, column)]))
    }
}

impl Index<(usize, usize)> for StridedView<'_> {
    type Output = f64;

    /// # Panics
    ///
    /// If an index is out of bounds.
    fn index(&self, index: (usize, usize)) -> &f64 {
        &self.0[index]
    }
}

impl fmt::Debug for StridedView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.to_matrix(), f)
    }
}

impl<'a> From<MatrixView<'a>> for StridedView<'a> {
    fn from(matrix: MatrixView<'a>) -> Self {
        let (nrows, ncols) = matrix.shape();
        Self(DMatrixView::from_slice_with_strides(matrix.as_slice(), nrows, ncols, ncols, 1))
    }
}

impl<'a> From<&'a Matrix> for StridedView<'a> {
    fn from(matrix: &'a Matrix) -> Self {
        matrix.view().into()
    }
}

impl<'a> From<DMatrixView<'a, f64, Dyn, Dyn>> for StridedView<'a> {
    fn from(matrix: DMatrixView<'a, f64, Dyn, Dyn>) -> Self {
        Self(matrix)
    }
}

impl<'a, R: Dim, C: Dim, S: RawStorage<f64, R, C>> From<&'a nalgebra::Matrix<f64, R, C, S>> for StridedView<'a>
where
    DMatrixView<'a, f64, Dyn, Dyn>: From<&'a nalgebra::Matrix<f64, R, C, S>>,
{
    fn from(matrix: &'a nalgebra::Matrix<f64, R, C, S>) -> Self {
        Self(matrix.into())
    }
}
