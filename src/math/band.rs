//! Symmetric band matrices whose last rows are dense. The Hessian of a trajectory optimisation
//! problem with some global parameters has this structure.
//!
//! A matrix has `ntotal` rows, and the last `ndense` of them are dense. Only the lower triangle is
//! stored: of each band row the `nband` values up to and including the diagonal, then the dense
//! rows in full length. Storage before the first column and, in dense rows, after the diagonal is
//! allocated but unused.
//!
//! ```text
//!  ntotal = 5, nband = 2, ndense = 1            stored as
//!   a                                            · a
//!   b c              (symmetric)                 b c
//!     d e                                        d e
//!       f g                                      f g
//!   h i j k l                                    h i j k l
//! ```
//!
//! The engine provides these functions since version 2.3.6. This module implements them in Rust.

use mujoco_sys::mjMINVAL;

use crate::error::{Error, Result};
use crate::matrix::{MatrixView, MatrixViewMut};

/// Shape of a band matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BandShape {
    ntotal: usize,
    nband: usize,
    ndense: usize,
}

impl BandShape {
    /// Creates a shape of `ntotal` rows: the last `ndense` rows are dense, the others have `nband`
    /// values up to and including the diagonal.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if `ndense` exceeds `ntotal`, if the band does not contain the diagonal,
    /// or if the size overflows `usize`.
    pub fn new(ntotal: usize, nband: usize, ndense: usize) -> Result<Self> {
        let invalid = |what: &str, value: usize, expected: String| {
            Err(Error::out_of_range(format!("{what} of a band matrix"), value, expected))
        };
        if ndense > ntotal {
            return invalid("ndense", ndense, format!("at most ntotal, which is {ntotal}"));
        }
        let nsparse = ntotal - ndense;
        if nband == 0 && nsparse > 0 {
            return invalid("nband", nband, "at least 1, for the diagonal".to_owned());
        }
        let band = nsparse.checked_mul(nband);
        let dense = ndense.checked_mul(ntotal);
        if band.zip(dense).and_then(|(band, dense)| band.checked_add(dense)).is_none() {
            return invalid("ntotal", ntotal, "small enough for the number of values to fit into usize".to_owned());
        }
        Ok(Self { ntotal, nband, ndense })
    }

    /// Returns the number of rows.
    #[inline]
    pub fn ntotal(&self) -> usize {
        self.ntotal
    }

    /// Returns the number of values of a band row, including the diagonal.
    #[inline]
    pub fn nband(&self) -> usize {
        self.nband
    }

    /// Returns the number of dense rows.
    #[inline]
    pub fn ndense(&self) -> usize {
        self.ndense
    }

    /// Returns the number of stored values: `(ntotal − ndense) nband + ndense ntotal`.
    #[inline]
    pub fn len(&self) -> usize {
        self.nsparse() * self.nband + self.ndense * self.ntotal
    }

    /// Returns `true` if the matrix has no values.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the index of the diagonal value of row `i`.
    ///
    /// # Panics
    ///
    /// If the row is out of bounds.
    #[doc(alias = "mju_bandDiag")]
    #[inline]
    pub fn band_diag(&self, i: usize) -> usize {
        assert!(i < self.ntotal, "row {i} of a band matrix of {} rows", self.ntotal);
        let (first, start) = self.row(i);
        start + (i - first)
    }

    #[inline]
    fn nsparse(&self) -> usize {
        self.ntotal - self.ndense
    }

    /// Returns the first stored column of a row and the index of its value. The values up to the
    /// diagonal follow.
    #[inline]
    fn row(&self, i: usize) -> (usize, usize) {
        match i.checked_sub(self.nsparse()) {
            None => {
                let width = i.min(self.nband - 1);
                (i - width, (i + 1) * self.nband - (width + 1))
            }
            Some(dense) => (0, self.nsparse() * self.nband + dense * self.ntotal),
        }
    }

    fn check_matrix(&self, what: &'static str, mat: &[f64]) -> Result<()> {
        Error::check_length(what, mat.len(), self.len())
    }
}

fn dot(vec1: &[f64], vec2: &[f64]) -> f64 {
    vec1.iter().zip(vec2).map(|(a, b)| a * b).sum::<f64>()
}

/// Computes the Cholesky factor of `A + diagadd I + diagmul diag(A)` in place. Returns the smallest
/// pivot (the square of a diagonal value of the factor), or `None` if the matrix is not positive
/// definite: a pivot is below `1e-15` or NaN. In that case `mat` is partially factorised. (The
/// engine returns 0 instead of `None`. Version 4 returns the square root of the pivot.)
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `mat` is `shape.len()`.
///
/// ```
/// use mujoco_safe::math::{self, BandShape};
///
/// // [[4, 2, 0], [2, 5, 4], [0, 4, 5]]
/// let shape = BandShape::new(3, 2, 0)?;
/// let mut mat = [0.0, 4.0, 2.0, 5.0, 4.0, 5.0];
/// assert_eq!(math::chol_factor_band(&mut mat, shape, 0.0, 0.0)?, Some(1.0));
/// let mut res = [0.0; 3];
/// math::chol_solve_band(&mut res, &mat, &[8.0, 24.0, 23.0], shape)?;
/// assert_eq!(res, [1.0, 2.0, 3.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn chol_factor_band(mat: &mut [f64], shape: BandShape, diagadd: f64, diagmul: f64) -> Result<Option<f64>> {
    shape.check_matrix("mat of chol_factor_band", mat)?;
    let mut smallest = f64::INFINITY;
    for i in 0..shape.ntotal {
        let (first_i, start_i) = shape.row(i);
        let (above, below) = mat.split_at_mut(start_i);
        let row_i = &mut below[..=i - first_i];
        // Row i of L Lᵀ = A, from left to right. Each value follows from the previous ones and the
        // rows above.
        for j in first_i..i {
            let (first_j, start_j) = shape.row(j);
            let row_j = &above[start_j..=start_j + j - first_j];
            let common = first_i.max(first_j);
            let known = dot(&row_i[common - first_i..j - first_i], &row_j[common - first_j..j - first_j]);
            row_i[j - first_i] = (row_i[j - first_i] - known) / row_j[j - first_j];
        }
        let (diagonal, left) = row_i.split_last_mut().expect("Bug: a row without its diagonal");
        let pivot = *diagonal + diagadd + diagmul * *diagonal - dot(left, left);
        if pivot.is_nan() || pivot < mjMINVAL {
            return Ok(None);
        }
        smallest = smallest.min(pivot);
        *diagonal = pivot.sqrt();
    }
    Ok(Some(smallest))
}

/// Solves `L Lᵀ res = vec` with the factor from [`chol_factor_band`].
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `mat` is `shape.len()`, and the length of both vectors is
/// `ntotal`.
pub fn chol_solve_band(res: &mut [f64], mat: &[f64], vec: &[f64], shape: BandShape) -> Result<()> {
    Error::check_length("the result of chol_solve_band", res.len(), shape.ntotal)?;
    Error::check_length("vec of chol_solve_band", vec.len(), shape.ntotal)?;
    shape.check_matrix("mat of chol_solve_band", mat)?;
    res.copy_from_slice(vec);
    chol_solve_band_in_place(mat, res, shape)
}

/// Solves like [`chol_solve_band`], and overwrites `vec` with the solution.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `mat` is `shape.len()`, and the length of `vec` is
/// `ntotal`.
pub fn chol_solve_band_in_place(mat: &[f64], vec: &mut [f64], shape: BandShape) -> Result<()> {
    shape.check_matrix("mat of chol_solve_band_in_place", mat)?;
    Error::check_length("vec of chol_solve_band_in_place", vec.len(), shape.ntotal)?;
    for i in 0..shape.ntotal {
        let (first, start) = shape.row(i);
        let row = &mat[start..start + i - first];
        vec[i] = (vec[i] - dot(row, &vec[first..i])) / mat[start + i - first];
    }
    for i in (0..shape.ntotal).rev() {
        let (first, start) = shape.row(i);
        vec[i] /= mat[start + i - first];
        let (before, rest) = vec.split_at_mut(i);
        before[first..].iter_mut().zip(&mat[start..]).for_each(|(value, factor)| *value -= factor * rest[0]);
    }
    Ok(())
}

/// Matrix that band storage represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BandKind {
    /// Symmetric matrix.
    Symmetric,
    /// Lower triangular matrix, such as a Cholesky factor.
    LowerTriangular,
}

/// Converts to a dense matrix `(ntotal, ntotal)`.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `mat` is `shape.len()`, and `res` has the shape
/// `(ntotal, ntotal)`.
pub fn band2dense<'a>(res: impl Into<MatrixViewMut<'a>>, mat: &[f64], shape: BandShape, kind: BandKind) -> Result<()> {
    let mut res = res.into();
    let n = shape.ntotal;
    shape.check_matrix("mat of band2dense", mat)?;
    Error::check_shape("the result of band2dense", res.shape(), (n, n))?;
    let res = res.as_mut_slice();
    res.fill(0.0);
    for i in 0..n {
        let (first, start) = shape.row(i);
        for (j, &value) in (first..=i).zip(&mat[start..]) {
            res[i * n + j] = value;
            if kind == BandKind::Symmetric {
                res[j * n + i] = value;
            }
        }
    }
    Ok(())
}

/// Converts from the lower triangle of a dense matrix `(ntotal, ntotal)`. Values outside the band
/// are ignored, and the unused storage of `res` does not change.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `res` is `shape.len()`, and `mat` has the shape
/// `(ntotal, ntotal)`.
pub fn dense2band<'a>(res: &mut [f64], mat: impl Into<MatrixView<'a>>, shape: BandShape) -> Result<()> {
    let mat = mat.into();
    shape.check_matrix("the result of dense2band", res)?;
    Error::check_shape("mat of dense2band", mat.shape(), (shape.ntotal, shape.ntotal))?;
    for (i, row) in mat.rows().enumerate() {
        let (first, start) = shape.row(i);
        res[start..=start + i - first].copy_from_slice(&row[first..=i]);
    }
    Ok(())
}

/// Multiplies a band matrix by vectors: each row of `res` is the matrix times the same row of
/// `vec`. `res` and `vec` have the shape `(nvec, ntotal)`, one vector per row.
///
/// # Errors
///
/// [`Error::Shape`] unless the length of `mat` is `shape.len()`, `vec` has `ntotal` columns, and
/// `res` has the shape of `vec`.
pub fn band_mul_mat_vec<'a, 'b>(
    res: impl Into<MatrixViewMut<'a>>,
    mat: &[f64],
    vec: impl Into<MatrixView<'b>>,
    shape: BandShape,
    kind: BandKind,
) -> Result<()> {
    let (mut res, vec) = (res.into(), vec.into());
    shape.check_matrix("mat of band_mul_mat_vec", mat)?;
    Error::check_shape("vec of band_mul_mat_vec", vec.shape(), (vec.nrows(), shape.ntotal))?;
    Error::check_shape("the result of band_mul_mat_vec", res.shape(), vec.shape())?;
    // `chunks_exact_mut` panics for a chunk size of 0; a matrix without columns has no values.
    for (res, vec) in res.as_mut_slice().chunks_exact_mut(shape.ntotal.max(1)).zip(vec.rows()) {
        for i in 0..shape.ntotal {
            let (first, start) = shape.row(i);
            let row = &mat[start..=start + i - first];
            res[i] = dot(row, &vec[first..=i]);
            if kind == BandKind::Symmetric {
                res[first..i].iter_mut().zip(row).for_each(|(res, value)| *res += value * vec[i]);
            }
        }
    }
    Ok(())
}
