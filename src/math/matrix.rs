//! Dense row-major matrices, and their Cholesky factorisation `A = L Lᵀ` with L in the lower
//! triangle.
//!
//! An input is a [`Matrix`](crate::Matrix), a [`MatrixView`], or rows of a fixed length, such as
//! `data.cdof()`. An output is a `&mut Matrix` or a [`MatrixViewMut`], and is overwritten.

use mujoco_sys as sys;

use super::entries;
use super::vector::dot_of_equals;
use crate::error::{Error, Result};
use crate::ffi;
use crate::matrix::{MatrixView, MatrixViewMut};

/// Multiplies a matrix by a vector: `res = mat vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `vec` is the number of columns of `mat`, and the length of
/// `res` is its number of rows.
///
/// ```
/// use mujoco_safe::{Matrix, math};
///
/// let mat = Matrix::from_rows(&[[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
/// let mut res = [0.0; 3];
/// math::mul_mat_vec(&mut res, &mat, &[1.0, -1.0])?;
/// assert_eq!(res, [-1.0, -1.0, -1.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn mul_mat_vec<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    Error::check_length("the result of mul_mat_vec", res.len(), mat.nrows())?;
    Error::check_length("vec of mul_mat_vec", vec.len(), mat.ncols())?;
    let (nr, nc) = entries("mat of mul_mat_vec", mat.shape())?;
    // SAFETY: the matrix has nr × nc values, the result nr, the vector nc.
    unsafe { sys::mju_mulMatVec(res.as_mut_ptr(), mat.as_slice().as_ptr(), vec.as_ptr(), nr, nc) };
    Ok(())
}

/// Multiplies a transposed matrix by a vector: `res = matᵀ vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `vec` is the number of rows of `mat`, and the length of
/// `res` is its number of columns.
pub fn mul_mat_t_vec<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    Error::check_length("the result of mul_mat_t_vec", res.len(), mat.ncols())?;
    Error::check_length("vec of mul_mat_t_vec", vec.len(), mat.nrows())?;
    let (nr, nc) = entries("mat of mul_mat_t_vec", mat.shape())?;
    // SAFETY: the matrix has nr × nc values, the result nc, the vector nr.
    unsafe { sys::mju_mulMatTVec(res.as_mut_ptr(), mat.as_slice().as_ptr(), vec.as_ptr(), nr, nc) };
    Ok(())
}

/// Returns the bilinear form `vec1ᵀ mat vec2` of a square matrix. (Newer engines provide it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless the length of both vectors is the number of rows and columns of `mat`.
pub fn mul_vec_mat_vec<'a>(vec1: &[f64], mat: impl Into<MatrixView<'a>>, vec2: &[f64]) -> Result<f64> {
    let mat = mat.into();
    Error::check_length("vec2 of mul_vec_mat_vec", vec2.len(), vec1.len())?;
    Error::check_shape("mat of mul_vec_mat_vec", mat.shape(), (vec1.len(), vec1.len()))?;
    Ok(vec1.iter().zip(mat.rows()).fold(0.0, |sum, (value, row)| sum + value * dot_of_equals(row, vec2)))
}

/// Transposes a matrix: `res = matᵀ`.
///
/// # Errors
///
/// [`Error::Shape`] unless `res` has the shape of `matᵀ`.
pub fn transpose<'a, 'b>(res: impl Into<MatrixViewMut<'a>>, mat: impl Into<MatrixView<'b>>) -> Result<()> {
    let (mut res, mat) = (res.into(), mat.into());
    Error::check_shape("the result of transpose", res.shape(), (mat.ncols(), mat.nrows()))?;
    let (nr, nc) = entries("mat of transpose", mat.shape())?;
    // SAFETY: both have nr × nc values, and they do not overlap.
    unsafe { sys::mju_transpose(res.as_mut_slice().as_mut_ptr(), mat.as_slice().as_ptr(), nr, nc) };
    Ok(())
}

/// Symmetrises a matrix: `res = (mat + matᵀ) / 2`. (Newer engines provide it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square and `res` has the same shape.
pub fn symmetrize<'a, 'b>(res: impl Into<MatrixViewMut<'a>>, mat: impl Into<MatrixView<'b>>) -> Result<()> {
    let (mut res, mat) = (res.into(), mat.into());
    check_square("mat of symmetrize", mat.shape())?;
    Error::check_shape("the result of symmetrize", res.shape(), mat.shape())?;
    res.as_mut_slice().copy_from_slice(mat.as_slice());
    symmetrize_in_place(res)
}

/// Symmetrises a matrix in place: `mat = (mat + matᵀ) / 2`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square.
pub fn symmetrize_in_place<'a>(mat: impl Into<MatrixViewMut<'a>>) -> Result<()> {
    let mut mat = mat.into();
    check_square("mat of symmetrize_in_place", mat.shape())?;
    let (n, values) = (mat.shape().0, mat.as_mut_slice());
    for row in 0..n {
        for column in 0..row {
            let mean = 0.5 * (values[row * n + column] + values[column * n + row]);
            values[row * n + column] = mean;
            values[column * n + row] = mean;
        }
    }
    Ok(())
}

/// Sets the identity matrix: `mat = I`. (Newer engines provide it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square.
pub fn eye<'a>(mat: impl Into<MatrixViewMut<'a>>) -> Result<()> {
    let mut mat = mat.into();
    check_square("mat of eye", mat.shape())?;
    let (n, values) = (mat.shape().0, mat.as_mut_slice());
    values.fill(0.0);
    values.iter_mut().step_by(n + 1).for_each(|value| *value = 1.0);
    Ok(())
}

/// Multiplies two matrices: `res = mat1 mat2`.
///
/// # Errors
///
/// [`Error::Shape`] unless the number of rows of `mat2` is the number of columns of `mat1`, and
/// `res` has the shape of the product.
pub fn mul_mat_mat<'a, 'b, 'c>(
    res: impl Into<MatrixViewMut<'a>>,
    mat1: impl Into<MatrixView<'b>>,
    mat2: impl Into<MatrixView<'c>>,
) -> Result<()> {
    let (mut res, mat1, mat2) = (res.into(), mat1.into(), mat2.into());
    Error::check_shape("mat2 of mul_mat_mat", mat2.shape(), (mat1.ncols(), mat2.ncols()))?;
    Error::check_shape("the result of mul_mat_mat", res.shape(), (mat1.nrows(), mat2.ncols()))?;
    let (r1, c1) = entries("mat1 of mul_mat_mat", mat1.shape())?;
    let (_, c2) = entries("mat2 of mul_mat_mat", mat2.shape())?;
    entries("the result of mul_mat_mat", res.shape())?;
    let (res, mat1, mat2) = (res.as_mut_slice().as_mut_ptr(), mat1.as_slice().as_ptr(), mat2.as_slice().as_ptr());
    // SAFETY: the result has r1 × c2 values, the matrices r1 × c1 and c1 × c2, and the result
    // overlaps neither.
    unsafe { sys::mju_mulMatMat(res, mat1, mat2, r1, c1, c2) };
    Ok(())
}

/// Multiplies a matrix by a transposed matrix: `res = mat1 mat2ᵀ`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat1` and `mat2` have the same number of columns, and `res` has the
/// shape of the product.
pub fn mul_mat_mat_t<'a, 'b, 'c>(
    res: impl Into<MatrixViewMut<'a>>,
    mat1: impl Into<MatrixView<'b>>,
    mat2: impl Into<MatrixView<'c>>,
) -> Result<()> {
    let (mut res, mat1, mat2) = (res.into(), mat1.into(), mat2.into());
    Error::check_shape("mat2 of mul_mat_mat_t", mat2.shape(), (mat2.nrows(), mat1.ncols()))?;
    Error::check_shape("the result of mul_mat_mat_t", res.shape(), (mat1.nrows(), mat2.nrows()))?;
    let (r1, c1) = entries("mat1 of mul_mat_mat_t", mat1.shape())?;
    let (r2, _) = entries("mat2 of mul_mat_mat_t", mat2.shape())?;
    entries("the result of mul_mat_mat_t", res.shape())?;
    let (res, mat1, mat2) = (res.as_mut_slice().as_mut_ptr(), mat1.as_slice().as_ptr(), mat2.as_slice().as_ptr());
    // SAFETY: the result has r1 × r2 values, the matrices r1 × c1 and r2 × c1, and the result
    // overlaps neither.
    unsafe { sys::mju_mulMatMatT(res, mat1, mat2, r1, c1, r2) };
    Ok(())
}

/// Multiplies a transposed matrix by a matrix: `res = mat1ᵀ mat2`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat1` and `mat2` have the same number of rows, and `res` has the shape
/// of the product.
pub fn mul_mat_t_mat<'a, 'b, 'c>(
    res: impl Into<MatrixViewMut<'a>>,
    mat1: impl Into<MatrixView<'b>>,
    mat2: impl Into<MatrixView<'c>>,
) -> Result<()> {
    let (mut res, mat1, mat2) = (res.into(), mat1.into(), mat2.into());
    Error::check_shape("mat2 of mul_mat_t_mat", mat2.shape(), (mat1.nrows(), mat2.ncols()))?;
    Error::check_shape("the result of mul_mat_t_mat", res.shape(), (mat1.ncols(), mat2.ncols()))?;
    let (r1, c1) = entries("mat1 of mul_mat_t_mat", mat1.shape())?;
    let (_, c2) = entries("mat2 of mul_mat_t_mat", mat2.shape())?;
    entries("the result of mul_mat_t_mat", res.shape())?;
    let (res, mat1, mat2) = (res.as_mut_slice().as_mut_ptr(), mat1.as_slice().as_ptr(), mat2.as_slice().as_ptr());
    // SAFETY: the result has c1 × c2 values, the matrices r1 × c1 and r1 × c2, and the result
    // overlaps neither.
    unsafe { sys::mju_mulMatTMat(res, mat1, mat2, r1, c1, c2) };
    Ok(())
}

/// Computes `res = matᵀ diag(diag) mat`, or `matᵀ mat` without a diagonal. The result is exactly
/// symmetric.
///
/// # Errors
///
/// [`Error::Shape`] unless `res` is square with the number of columns of `mat`, and the length of
/// `diag` is the number of rows of `mat`.
///
/// ```
/// use mujoco_safe::{Matrix, math};
///
/// let mat = Matrix::from_rows(&[[1.0, 2.0], [3.0, 4.0]]);
/// let mut res = Matrix::zeros(2, 2);
/// math::sqr_mat_td(&mut res, &mat, Some(&[1.0, 10.0]))?;
/// assert_eq!(res, Matrix::from_rows(&[[91.0, 122.0], [122.0, 164.0]]));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn sqr_mat_td<'a, 'b>(
    res: impl Into<MatrixViewMut<'a>>,
    mat: impl Into<MatrixView<'b>>,
    diag: Option<&[f64]>,
) -> Result<()> {
    let (mut res, mat) = (res.into(), mat.into());
    Error::check_shape("the result of sqr_mat_td", res.shape(), (mat.ncols(), mat.ncols()))?;
    if let Some(diag) = diag {
        Error::check_length("diag of sqr_mat_td", diag.len(), mat.nrows())?;
    }
    let (nr, nc) = entries("mat of sqr_mat_td", mat.shape())?;
    entries("the result of sqr_mat_td", res.shape())?;
    let diag = diag.map_or(std::ptr::null(), <[f64]>::as_ptr);
    // SAFETY: the result has nc × nc values, the matrix nr × nc; the diagonal is NULL or has nr.
    unsafe { sys::mju_sqrMatTD(res.as_mut_slice().as_mut_ptr(), mat.as_slice().as_ptr(), diag, nr, nc) };
    Ok(())
}

/// Returns an error unless the matrix is square.
pub(super) fn check_square(what: &'static str, (nrows, ncols): (usize, usize)) -> Result<()> {
    Error::check_shape(what, (nrows, ncols), (nrows, nrows))
}

/// Computes the Cholesky factor of `mat` in place and returns the rank: the number of pivots of at
/// least `mindiag`. Smaller pivots are replaced by `mindiag`, so that the factor exists (with
/// `mindiag` of 0 or less it may contain infinities or NaN). Since 4.0 pivots that are NaN are
/// replaced too. Only the lower triangle is read and written; the values above the diagonal do not
/// change.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square.
///
/// ```
/// use mujoco_safe::{Matrix, math};
///
/// let mut mat = Matrix::from_rows(&[[4.0, 2.0], [2.0, 5.0]]);
/// assert_eq!(math::chol_factor(&mut mat, 1e-15)?, 2);
/// assert_eq!((mat[(0, 0)], mat[(1, 0)], mat[(1, 1)]), (2.0, 1.0, 2.0));
///
/// let mut res = [0.0; 2];
/// math::chol_solve(&mut res, &mat, &[8.0, 8.0])?;
/// assert_eq!(res, [1.5, 1.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn chol_factor<'a>(mat: impl Into<MatrixViewMut<'a>>, mindiag: f64) -> Result<usize> {
    let mut mat = mat.into();
    check_square("mat of chol_factor", mat.shape())?;
    let (n, _) = entries("mat of chol_factor", mat.shape())?;
    // SAFETY: the matrix has n × n values.
    Ok(ffi::size(unsafe { sys::mju_cholFactor(mat.as_mut_slice().as_mut_ptr(), n, mindiag) }))
}

/// Solves `L Lᵀ res = vec` with the factor from [`chol_factor`].
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square and the length of both vectors is its number of rows.
pub fn chol_solve<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    check_square("mat of chol_solve", mat.shape())?;
    Error::check_length("the result of chol_solve", res.len(), mat.nrows())?;
    Error::check_length("vec of chol_solve", vec.len(), mat.nrows())?;
    res.copy_from_slice(vec);
    chol_solve_in_place(mat, res)
}

/// Solves like [`chol_solve`], and overwrites `vec` with the solution.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square and the length of `vec` is its number of rows.
pub fn chol_solve_in_place<'a>(mat: impl Into<MatrixView<'a>>, vec: &mut [f64]) -> Result<()> {
    let mat = mat.into();
    check_square("mat of chol_solve_in_place", mat.shape())?;
    Error::check_length("vec of chol_solve_in_place", vec.len(), mat.nrows())?;
    let (n, _) = entries("mat of chol_solve_in_place", mat.shape())?;
    let vec = vec.as_mut_ptr();
    // SAFETY: the matrix has n × n values, the vector n. The engine solves in place if both vectors
    // are the same.
    unsafe { sys::mju_cholSolve(vec, mat.as_slice().as_ptr(), vec, n) };
    Ok(())
}

/// Sign of the rank-one update of [`chol_update`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RankOneUpdate {
    /// `A + x xᵀ`
    Add,
    /// `A − x xᵀ`
    Subtract,
}

/// Updates the factor of A to the factor of `A + x xᵀ` or `A − x xᵀ` in O(n²). Returns the rank:
/// the number of pivots that were not raised to `1e-15`. `x` is overwritten.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square and the length of `x` is its number of rows.
pub fn chol_update<'a>(mat: impl Into<MatrixViewMut<'a>>, x: &mut [f64], update: RankOneUpdate) -> Result<usize> {
    let mut mat = mat.into();
    check_square("mat of chol_update", mat.shape())?;
    Error::check_length("x of chol_update", x.len(), mat.shape().0)?;
    let (n, _) = entries("mat of chol_update", mat.shape())?;
    let flag = i32::from(update == RankOneUpdate::Add);
    // SAFETY: the matrix has n × n values, the vector n.
    let rank = unsafe { sys::mju_cholUpdate(mat.as_mut_slice().as_mut_ptr(), x.as_mut_ptr(), n, flag) };
    Ok(ffi::size(rank))
}
