//! Dense matrices, row-major.
//!
//! What is read may be a [`Matrix`](crate::Matrix), a [`MatrixView`], or rows of a fixed length, such as `data.cdof()`; what is
//! written may be a `&mut Matrix` or a [`MatrixViewMut`]. The result is written over, not added to.

use mujoco_sys as sys;

use super::entries;
use super::vector::dot_of_equals;
use crate::error::{Error, Result};
use crate::matrix::{MatrixView, MatrixViewMut};

/// `res = mat vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless `vec` has as many numbers as `mat` has columns, and `res` as many as it has rows.
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
#[doc(alias = "mju_mulMatVec")]
pub fn mul_mat_vec<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    Error::check_length("the result of mul_mat_vec", res.len(), mat.nrows())?;
    Error::check_length("vec of mul_mat_vec", vec.len(), mat.ncols())?;
    let (nr, nc) = entries("mat of mul_mat_vec", mat.shape())?;
    // SAFETY: the matrix has nr × nc numbers, the result nr, the vector nc.
    unsafe { sys::mju_mulMatVec(res.as_mut_ptr(), mat.as_slice().as_ptr(), vec.as_ptr(), nr, nc) };
    Ok(())
}

/// `res = matᵀ vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless `vec` has as many numbers as `mat` has rows, and `res` as many as it has columns.
#[doc(alias = "mju_mulMatTVec")]
pub fn mul_mat_t_vec<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, vec: &[f64]) -> Result<()> {
    let mat = mat.into();
    Error::check_length("the result of mul_mat_t_vec", res.len(), mat.ncols())?;
    Error::check_length("vec of mul_mat_t_vec", vec.len(), mat.nrows())?;
    let (nr, nc) = entries("mat of mul_mat_t_vec", mat.shape())?;
    // SAFETY: the matrix has nr × nc numbers, the result nc, the vector nr.
    unsafe { sys::mju_mulMatTVec(res.as_mut_ptr(), mat.as_slice().as_ptr(), vec.as_ptr(), nr, nc) };
    Ok(())
}

/// The number `vec1ᵀ mat vec2`, with a square matrix. (Newer engines have it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless both vectors have as many numbers as `mat` has rows, and columns.
#[doc(alias = "mju_mulVecMatVec")]
pub fn mul_vec_mat_vec<'a>(vec1: &[f64], mat: impl Into<MatrixView<'a>>, vec2: &[f64]) -> Result<f64> {
    let mat = mat.into();
    Error::check_length("vec2 of mul_vec_mat_vec", vec2.len(), vec1.len())?;
    Error::check_shape("mat of mul_vec_mat_vec", mat.shape(), (vec1.len(), vec1.len()))?;
    Ok(vec1.iter().zip(mat.rows()).fold(0.0, |sum, (value, row)| sum + value * dot_of_equals(row, vec2)))
}

/// `res = matᵀ`.
///
/// # Errors
///
/// [`Error::Shape`] unless `res` has as many rows as `mat` has columns, and as many columns as it has rows.
#[doc(alias = "mju_transpose")]
pub fn transpose<'a, 'b>(res: impl Into<MatrixViewMut<'a>>, mat: impl Into<MatrixView<'b>>) -> Result<()> {
    let (mut res, mat) = (res.into(), mat.into());
    Error::check_shape("the result of transpose", res.shape(), (mat.ncols(), mat.nrows()))?;
    let (nr, nc) = entries("mat of transpose", mat.shape())?;
    // SAFETY: both have nr × nc numbers, and no number is in both.
    unsafe { sys::mju_transpose(res.as_mut_slice().as_mut_ptr(), mat.as_slice().as_ptr(), nr, nc) };
    Ok(())
}

/// `res = (mat + matᵀ) / 2`. (Newer engines have it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square, and `res` of the same shape.
#[doc(alias = "mju_symmetrize")]
pub fn symmetrize<'a, 'b>(res: impl Into<MatrixViewMut<'a>>, mat: impl Into<MatrixView<'b>>) -> Result<()> {
    let (mut res, mat) = (res.into(), mat.into());
    check_square("mat of symmetrize", mat.shape())?;
    Error::check_shape("the result of symmetrize", res.shape(), mat.shape())?;
    res.as_mut_slice().copy_from_slice(mat.as_slice());
    symmetrize_in_place(res)
}

/// `mat = (mat + matᵀ) / 2`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square.
#[doc(alias = "mju_symmetrize")]
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

/// `mat = I`. (Newer engines have it in C.)
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` is square.
#[doc(alias = "mju_eye")]
pub fn eye<'a>(mat: impl Into<MatrixViewMut<'a>>) -> Result<()> {
    let mut mat = mat.into();
    check_square("mat of eye", mat.shape())?;
    let (n, values) = (mat.shape().0, mat.as_mut_slice());
    values.fill(0.0);
    values.iter_mut().step_by(n + 1).for_each(|value| *value = 1.0);
    Ok(())
}

/// `res = mat1 mat2`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat2` has as many rows as `mat1` has columns, and `res` the rows of `mat1` and the columns of
/// `mat2`.
#[doc(alias = "mju_mulMatMat")]
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
    // SAFETY: the result has r1 × c2 numbers, the matrices r1 × c1 and c1 × c2, and no number of the result is in them.
    unsafe { sys::mju_mulMatMat(res, mat1, mat2, r1, c1, c2) };
    Ok(())
}

/// `res = mat1 mat2ᵀ`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat2` has as many columns as `mat1`, and `res` the rows of `mat1`, and as many columns as `mat2`
/// has rows.
#[doc(alias = "mju_mulMatMatT")]
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
    // SAFETY: the result has r1 × r2 numbers, the matrices r1 × c1 and r2 × c1, and no number of the result is in them.
    unsafe { sys::mju_mulMatMatT(res, mat1, mat2, r1, c1, r2) };
    Ok(())
}

/// `res = mat1ᵀ mat2`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat2` has as many rows as `mat1`, and `res` as many rows as `mat1` has columns, and the columns of
/// `mat2`.
#[doc(alias = "mju_mulMatTMat")]
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
    // SAFETY: the result has c1 × c2 numbers, the matrices r1 × c1 and r1 × c2, and no number of the result is in them.
    unsafe { sys::mju_mulMatTMat(res, mat1, mat2, r1, c1, c2) };
    Ok(())
}

/// `res = matᵀ diag(diag) mat`, or `matᵀ mat` without a diagonal. The result is symmetric to the last bit.
///
/// # Errors
///
/// [`Error::Shape`] unless `res` is square with as many columns as `mat`, and `diag` has as many numbers as `mat` has rows.
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
#[doc(alias = "mju_sqrMatTD")]
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
    // SAFETY: the result has nc × nc numbers, the matrix nr × nc, the diagonal is NULL or has nr.
    unsafe { sys::mju_sqrMatTD(res.as_mut_slice().as_mut_ptr(), mat.as_slice().as_ptr(), diag, nr, nc) };
    Ok(())
}

/// Refuses a matrix that is not square.
pub(super) fn check_square(what: &'static str, (nrows, ncols): (usize, usize)) -> Result<()> {
    Error::check_shape(what, (nrows, ncols), (nrows, nrows))
}
