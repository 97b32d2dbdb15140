//! Symmetric matrices whose numbers lie in a band along the diagonal, except for the last rows, which are dense. Such is the
//! Hessian of a problem over time with some parameters that hold for all of it.
//!
//! With `ntotal` rows, of which the last `ndense` are dense, only what is left of the diagonal is kept, and the diagonal: of each
//! of the first rows the `nband` numbers that end with the diagonal, then the dense rows in full length. Places before the first
//! column and, in dense rows, behind the diagonal are there but not used.
//!
//! ```text
//!  ntotal = 5, nband = 2, ndense = 1            kept as
//!   a                                            · a
//!   b c              (symmetric)                 b c
//!     d e                                        d e
//!       f g                                      f g
//!   h i j k l                                    h i j k l
//! ```
//!
//! The engine has these functions from version 2.3.6 on, and they are its functions; here they are written in Rust.

use mujoco_sys::mjMINVAL;

use crate::error::{Error, Result};
use crate::matrix::{MatrixView, MatrixViewMut};

/// The shape of a band matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BandShape {
    ntotal: usize,
    nband: usize,
    ndense: usize,
}

impl BandShape {
    /// `ntotal` rows, the last `ndense` of them dense, the others with `nband` numbers up to and with the diagonal.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if there are more dense rows than rows, if the band has no room for the diagonal, or if the size is
    /// beyond what can be counted.
    pub fn new(ntotal: usize, nband: usize, ndense: usize) -> Result<Self> {
        let invalid = |what: &str, value: usize, expected: String| {
            Err(Error::Invalid { what: format!("{what} of a band matrix"), value: value.to_string(), expected })
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
            return invalid("ntotal", ntotal, "less, for its numbers to be counted".to_owned());
        }
        Ok(Self { ntotal, nband, ndense })
    }

    /// The number of rows.
    #[inline]
    pub fn ntotal(&self) -> usize {
        self.ntotal
    }

    /// How many numbers a row has that is not dense, the diagonal included.
    #[inline]
    pub fn nband(&self) -> usize {
        self.nband
    }

    /// How many rows are dense.
    #[inline]
    pub fn ndense(&self) -> usize {
        self.ndense
    }

    /// How many numbers are kept: `(ntotal − ndense) nband + ndense ntotal`.
    #[inline]
    pub fn len(&self) -> usize {
        self.nsparse() * self.nband + self.ndense * self.ntotal
    }

    /// Whether there are no numbers.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where the number on the diagonal of row `i` is.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[doc(alias = "mju_bandDiag")]
    #[inline]
    pub fn band_diag(&self, i: usize) -> usize {
        assert!(i < self.ntotal, "row {i} of a band matrix of {} rows", self.ntotal);
        let (first, start) = self.row(i);
        start + i - first
    }

    #[inline]
    fn nsparse(&self) -> usize {
        self.ntotal - self.ndense
    }

    /// The first column of a row that is kept, and where its number is. Up to the diagonal the others follow.
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

/// Cholesky's factorisation in place of `A + diagadd I + diagmul diag(A)`. Returns the smallest pivot (the square of a number on
/// the factor's diagonal), or `None` if the matrix is not positive definite: a pivot was below `1e-15` or not a number. Then
/// `mat` is half factorised. (The engine returns 0 for it. Version 4 returns the root of the pivot.)
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` has the numbers of the shape.
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
#[doc(alias = "mju_cholFactorBand")]
pub fn chol_factor_band(mat: &mut [f64], shape: BandShape, diagadd: f64, diagmul: f64) -> Result<Option<f64>> {
    shape.check_matrix("mat of chol_factor_band", mat)?;
    let mut smallest = f64::INFINITY;
    for i in 0..shape.ntotal {
        let (first_i, start_i) = shape.row(i);
        let (above, below) = mat.split_at_mut(start_i);
        let row_i = &mut below[..=i - first_i];
        // Row i of L Lᵀ = A, from left to right: each number by those before it, and by the rows above.
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

/// Solves `L Lᵀ res = vec`, with the factor that [`chol_factor_band`] made.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` has the numbers of the shape, and both vectors `ntotal`.
#[doc(alias = "mju_cholSolveBand")]
pub fn chol_solve_band(res: &mut [f64], mat: &[f64], vec: &[f64], shape: BandShape) -> Result<()> {
    Error::check_length("the result of chol_solve_band", res.len(), shape.ntotal)?;
    Error::check_length("vec of chol_solve_band", vec.len(), shape.ntotal)?;
    shape.check_matrix("mat of chol_solve_band", mat)?;
    res.copy_from_slice(vec);
    chol_solve_band_in_place(mat, res, shape)
}

/// As [`chol_solve_band`], with the solution in the place of `vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` has the numbers of the shape, and `vec` has `ntotal`.
#[doc(alias = "mju_cholSolveBand")]
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

/// `res = mat`, as a dense matrix `(ntotal, ntotal)`: symmetric where `flg_sym` is true, and otherwise with zeros above the
/// diagonal, as is right for a factor.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` has the numbers of the shape, and `res` is of the shape `(ntotal, ntotal)`.
#[doc(alias = "mju_band2Dense")]
pub fn band2dense<'a>(res: impl Into<MatrixViewMut<'a>>, mat: &[f64], shape: BandShape, flg_sym: bool) -> Result<()> {
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
            if flg_sym {
                res[j * n + i] = value;
            }
        }
    }
    Ok(())
}

/// `res = mat`, from the lower triangle of a dense matrix `(ntotal, ntotal)`. What is outside of the band is left out, and the
/// places of `res` that are not used stay as they are.
///
/// # Errors
///
/// [`Error::Shape`] unless `res` has the numbers of the shape, and `mat` is of the shape `(ntotal, ntotal)`.
#[doc(alias = "mju_dense2Band")]
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

/// Multiplies vectors by a band matrix, symmetric where `flg_sym` is true, and otherwise lower triangular: each row of `res` is
/// the matrix times that row of `vec`. Both are of the shape `(nvec, ntotal)`, one vector behind another as in the engine.
///
/// # Errors
///
/// [`Error::Shape`] unless `mat` has the numbers of the shape, the rows of `vec` have `ntotal`, and `res` is of the shape of
/// `vec`.
#[doc(alias = "mju_bandMulMatVec")]
pub fn band_mul_mat_vec<'a, 'b>(
    res: impl Into<MatrixViewMut<'a>>,
    mat: &[f64],
    vec: impl Into<MatrixView<'b>>,
    shape: BandShape,
    flg_sym: bool,
) -> Result<()> {
    let (mut res, vec) = (res.into(), vec.into());
    shape.check_matrix("mat of band_mul_mat_vec", mat)?;
    Error::check_shape("vec of band_mul_mat_vec", vec.shape(), (vec.nrows(), shape.ntotal))?;
    Error::check_shape("the result of band_mul_mat_vec", res.shape(), vec.shape())?;
    // Without columns there is nothing to compute, and a slice cannot be cut into rows of no length.
    for (res, vec) in res.as_mut_slice().chunks_exact_mut(shape.ntotal.max(1)).zip(vec.rows()) {
        for i in 0..shape.ntotal {
            let (first, start) = shape.row(i);
            let row = &mat[start..=start + i - first];
            res[i] = dot(row, &vec[first..=i]);
            if flg_sym {
                res[first..i].iter_mut().zip(row).for_each(|(res, value)| *res += value * vec[i]);
            }
        }
    }
    Ok(())
}
