//! Vectors of any length.
//!
//! The engine counts with a C int. A longer vector, of 16 GiB and more, goes to it in pieces.

use std::ffi::c_int;

use mujoco_sys::{self as sys, mjMINVAL};

use crate::error::{Error, Result};

/// The longest piece that the engine is given.
const PIECE: usize = 1 << 30;

/// A number from one vector, the sum of the numbers from its pieces.
#[inline]
fn sum_of_pieces(vec: &[f64], of_piece: unsafe extern "C" fn(*const f64, c_int) -> f64) -> f64 {
    vec.chunks(PIECE).fold(0.0, |sum, piece| {
        // SAFETY: the functions given here read as many numbers as they are told to, which the piece has.
        sum + unsafe { of_piece(piece.as_ptr(), piece.len() as c_int) }
    })
}

/// `call(res, vec, n)` for each pair of pieces.
#[inline]
fn for_pieces(res: &mut [f64], vec: &[f64], call: impl Fn(*mut f64, *const f64, c_int)) {
    for (res, vec) in res.chunks_mut(PIECE).zip(vec.chunks(PIECE)) {
        call(res.as_mut_ptr(), vec.as_ptr(), res.len() as c_int);
    }
}

/// `call(res, vec1, vec2, n)` for each three pieces.
#[inline]
fn for_pieces_of_two(
    res: &mut [f64],
    vec1: &[f64],
    vec2: &[f64],
    call: impl Fn(*mut f64, *const f64, *const f64, c_int),
) {
    for ((res, vec1), vec2) in res.chunks_mut(PIECE).zip(vec1.chunks(PIECE)).zip(vec2.chunks(PIECE)) {
        call(res.as_mut_ptr(), vec1.as_ptr(), vec2.as_ptr(), res.len() as c_int);
    }
}

/// `res = 0`.
#[doc(alias = "mju_zero")]
#[inline]
pub fn zero(res: &mut [f64]) {
    res.fill(0.0);
}

/// `res = val`, in each place. (Newer engines have it in C.)
#[doc(alias = "mju_fill")]
#[inline]
pub fn fill(res: &mut [f64], val: f64) {
    res.fill(val);
}

/// `res = data`. The engine's number is `f64`, so this is `mju_d2n` and `mju_n2d` too.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_copy")]
#[doc(alias = "mju_d2n")]
#[doc(alias = "mju_n2d")]
#[inline]
pub fn copy(res: &mut [f64], data: &[f64]) -> Result<()> {
    Error::check_length("the result of copy", res.len(), data.len())?;
    res.copy_from_slice(data);
    Ok(())
}

/// `res = vec`, from single precision.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_f2n")]
pub fn f2n(res: &mut [f64], vec: &[f32]) -> Result<()> {
    Error::check_length("the result of f2n", res.len(), vec.len())?;
    res.iter_mut().zip(vec).for_each(|(res, &value)| *res = f64::from(value));
    Ok(())
}

/// `res = vec`, to single precision, rounded to the nearest.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_n2f")]
pub fn n2f(res: &mut [f32], vec: &[f64]) -> Result<()> {
    Error::check_length("the result of n2f", res.len(), vec.len())?;
    res.iter_mut().zip(vec).for_each(|(res, &value)| *res = value as f32);
    Ok(())
}

/// The sum of all numbers.
#[doc(alias = "mju_sum")]
#[inline]
pub fn sum(vec: &[f64]) -> f64 {
    sum_of_pieces(vec, sys::mju_sum)
}

/// The L₁ norm: the sum of all absolute values.
#[doc(alias = "mju_L1")]
#[inline]
pub fn l1(vec: &[f64]) -> f64 {
    sum_of_pieces(vec, sys::mju_L1)
}

/// The Euclidean length `√(vec · vec)`. It overflows where the squares do.
#[doc(alias = "mju_norm")]
#[doc(alias = "mju_norm3")]
#[inline]
pub fn norm(vec: &[f64]) -> f64 {
    dot_of_equals(vec, vec).sqrt()
}

/// The scalar product `vec1 · vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
///
/// ```
/// use mujoco_safe::math;
///
/// assert_eq!(math::dot(&[1.0, 2.0, 3.0], &[4.0, -5.0, 6.0])?, 12.0);
/// let error = math::dot(&[1.0, 2.0, 3.0], &[4.0]).unwrap_err();
/// assert_eq!(error.to_string(), "vec2 of dot has shape (1), but must have (3)");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_dot")]
#[doc(alias = "mju_dot3")]
#[inline]
pub fn dot(vec1: &[f64], vec2: &[f64]) -> Result<f64> {
    Error::check_length("vec2 of dot", vec2.len(), vec1.len())?;
    Ok(dot_of_equals(vec1, vec2))
}

#[inline]
pub(super) fn dot_of_equals(vec1: &[f64], vec2: &[f64]) -> f64 {
    vec1.chunks(PIECE).zip(vec2.chunks(PIECE)).fold(0.0, |sum, (vec1, vec2)| {
        let n = vec1.len().min(vec2.len()) as c_int;
        // SAFETY: both have n numbers.
        sum + unsafe { sys::mju_dot(vec1.as_ptr(), vec2.as_ptr(), n) }
    })
}

/// Divides `vec` by its Euclidean length, and returns the length that it had. A vector that is shorter than `1e-15` becomes
/// `(1, 0, 0, …)`. (An empty one stays empty; the engine would write beyond it.)
#[doc(alias = "mju_normalize")]
#[doc(alias = "mju_normalize3")]
pub fn normalize(vec: &mut [f64]) -> f64 {
    let length = norm(vec);
    if length < mjMINVAL {
        vec.fill(0.0);
        if let Some(first) = vec.first_mut() {
            *first = 1.0;
        }
    } else {
        let inverse = 1.0 / length;
        scl_in_place(vec, inverse);
    }
    length
}

/// `res = vec · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_scl")]
#[inline]
pub fn scl(res: &mut [f64], vec: &[f64], scl: f64) -> Result<()> {
    Error::check_length("the result of scl", res.len(), vec.len())?;
    // SAFETY: both pieces have n numbers.
    for_pieces(res, vec, |res, vec, n| unsafe { sys::mju_scl(res, vec, scl, n) });
    Ok(())
}

/// `res = res · scl`.
#[doc(alias = "mju_scl")]
#[inline]
pub fn scl_in_place(res: &mut [f64], scl: f64) {
    for value in res {
        *value *= scl;
    }
}

/// `res = vec1 + vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless all have the same length.
#[doc(alias = "mju_add")]
#[inline]
pub fn add(res: &mut [f64], vec1: &[f64], vec2: &[f64]) -> Result<()> {
    Error::check_length("vec1 of add", vec1.len(), res.len())?;
    Error::check_length("vec2 of add", vec2.len(), res.len())?;
    // SAFETY: all three pieces have n numbers.
    for_pieces_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_add(res, vec1, vec2, n) });
    Ok(())
}

/// `res = vec1 − vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless all have the same length.
#[doc(alias = "mju_sub")]
#[inline]
pub fn sub(res: &mut [f64], vec1: &[f64], vec2: &[f64]) -> Result<()> {
    Error::check_length("vec1 of sub", vec1.len(), res.len())?;
    Error::check_length("vec2 of sub", vec2.len(), res.len())?;
    // SAFETY: all three pieces have n numbers.
    for_pieces_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_sub(res, vec1, vec2, n) });
    Ok(())
}

/// `res = res + vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_addTo")]
#[inline]
pub fn add_to(res: &mut [f64], vec: &[f64]) -> Result<()> {
    Error::check_length("vec of add_to", vec.len(), res.len())?;
    // SAFETY: both pieces have n numbers.
    for_pieces(res, vec, |res, vec, n| unsafe { sys::mju_addTo(res, vec, n) });
    Ok(())
}

/// `res = res − vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_subFrom")]
#[inline]
pub fn sub_from(res: &mut [f64], vec: &[f64]) -> Result<()> {
    Error::check_length("vec of sub_from", vec.len(), res.len())?;
    // SAFETY: both pieces have n numbers.
    for_pieces(res, vec, |res, vec, n| unsafe { sys::mju_subFrom(res, vec, n) });
    Ok(())
}

/// `res = res + vec · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless both have the same length.
#[doc(alias = "mju_addToScl")]
#[inline]
pub fn add_to_scl(res: &mut [f64], vec: &[f64], scl: f64) -> Result<()> {
    Error::check_length("vec of add_to_scl", vec.len(), res.len())?;
    // SAFETY: both pieces have n numbers.
    for_pieces(res, vec, |res, vec, n| unsafe { sys::mju_addToScl(res, vec, scl, n) });
    Ok(())
}

/// `res = vec1 + vec2 · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless all have the same length.
#[doc(alias = "mju_addScl")]
#[inline]
pub fn add_scl(res: &mut [f64], vec1: &[f64], vec2: &[f64], scl: f64) -> Result<()> {
    Error::check_length("vec1 of add_scl", vec1.len(), res.len())?;
    Error::check_length("vec2 of add_scl", vec2.len(), res.len())?;
    // SAFETY: all three pieces have n numbers.
    for_pieces_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_addScl(res, vec1, vec2, scl, n) });
    Ok(())
}

/// Whether all numbers are zero, of either sign. A vector without numbers is.
#[doc(alias = "mju_isZero")]
#[inline]
pub fn is_zero(vec: &[f64]) -> bool {
    vec.iter().all(|&value| value == 0.0)
}

/// Whether the engine takes a number for a bad one: not a number, or beyond ±10¹⁰.
#[doc(alias = "mju_isBad")]
#[inline]
pub fn is_bad(x: f64) -> bool {
    x.is_nan() || x.abs() > sys::mjMAXVAL
}
