//! What may stand for a view where a function takes `impl Into<MatrixView>` or `impl Into<MatrixViewMut>`.

use super::{Matrix, MatrixView, MatrixViewMut};

impl<'a> From<&'a Matrix> for MatrixView<'a> {
    #[inline]
    fn from(matrix: &'a Matrix) -> Self {
        matrix.view()
    }
}

impl<'a> From<&'a MatrixViewMut<'_>> for MatrixView<'a> {
    #[inline]
    fn from(matrix: &'a MatrixViewMut<'_>) -> Self {
        matrix.as_view()
    }
}

impl<'a, const N: usize> From<&'a [[f64; N]]> for MatrixView<'a> {
    /// An array of the engine that has a fixed number of columns, such as `data.cdof()`.
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
    /// For a shorter time.
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
