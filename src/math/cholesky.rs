//! Cholesky's factorisation `A = L Lᵀ` of a symmetric matrix that is positive definite, L in the lower triangle.

use mujoco_sys as sys;

use super::entries;
use super::matrix::check_square;
use crate::error::{Error, Result};
use crate::ffi;
use crate::matrix::{MatrixView, MatrixViewMut};

/// Factorises `mat` in place, and returns its rank: how many pivots were at least `mindiag`. The others are replaced by
/// `mindiag`, so that the factor exists (with `mindiag` of 0 or less it may hold infinities or NaN). Only the lower triangle is
/// read and written; above the diagonal stays what was there.
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
#[doc(alias = "mju_cholFactor")]
pub fn chol_factor<'a>(mat: impl Into<MatrixViewMut<'a>>, mindiag: f64) -> Result<usize> {
    let mut mat = mat.into();
    check_square("mat of chol_factor", mat.shape())?;
    let (n, _) = entries("mat of chol_factor", mat.shape())?;
    // SAFETY: the matrix has n × n numbers.
    Ok(ffi::size(unsafe { sys::mju_cholFactor(mat.as_mut_slice().as_mut_ptr(), n, mindiag) }))
}

/// Solves `L Lᵀ res = vec`, with the factor that [`chol_factor`] made of a matrix.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square, and both vectors have as many numbers as it has rows.
#[doc(alias = "mju_cholSolve")]
pub fn chol_solve<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    check_square("mat of chol_solve", mat.shape())?;
    Error::check_length("the result of chol_solve", res.len(), mat.nrows())?;
    Error::check_length("vec of chol_solve", vec.len(), mat.nrows())?;
    res.copy_from_slice(vec);
    chol_solve_in_place(mat, res)
}

/// As [`chol_solve`], with the solution in the place of `vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square, and `vec` has as many numbers as it has rows.
#[doc(alias = "mju_cholSolve")]
pub fn chol_solve_in_place<'a>(mat: impl Into<MatrixView<'a>>, vec: &mut [f64]) -> Result<()> {
    let mat = mat.into();
    check_square("mat of chol_solve_in_place", mat.shape())?;
    Error::check_length("vec of chol_solve_in_place", vec.len(), mat.nrows())?;
    let (n, _) = entries("mat of chol_solve_in_place", mat.shape())?;
    let vec = vec.as_mut_ptr();
    // SAFETY: the matrix has n × n numbers, the vector n. The engine solves in place where both vectors are the same.
    unsafe { sys::mju_cholSolve(vec, mat.as_slice().as_ptr(), vec, n) };
    Ok(())
}

/// Makes of the factor of A that of `A + x xᵀ` where `flg_plus` is true, and of `A − x xᵀ` otherwise, in a time of the order of
/// n². Returns the rank: how many pivots did not have to be raised to `1e-15`. `x` is used up.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square, and `x` has as many numbers as it has rows.
#[doc(alias = "mju_cholUpdate")]
pub fn chol_update<'a>(mat: impl Into<MatrixViewMut<'a>>, x: &mut [f64], flg_plus: bool) -> Result<usize> {
    let mut mat = mat.into();
    check_square("mat of chol_update", mat.shape())?;
    Error::check_length("x of chol_update", x.len(), mat.shape().0)?;
    let (n, _) = entries("mat of chol_update", mat.shape())?;
    // SAFETY: the matrix has n × n numbers, the vector n.
    let rank = unsafe { sys::mju_cholUpdate(mat.as_mut_slice().as_mut_ptr(), x.as_mut_ptr(), n, i32::from(flg_plus)) };
    Ok(ffi::size(rank))
}
