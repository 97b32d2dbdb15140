//! Vectors of any length, and insertion sort.
//!
//! The engine counts with a C `int`. Longer vectors, of 16 GiB and more, are passed to it in
//! chunks.

use std::ffi::c_int;

use mujoco_sys::{self as sys, mjMINVAL};

use super::count;
use crate::error::{Error, Result};

/// Maximum number of values per call of the engine.
const CHUNK: usize = 1 << 30;

/// Sums the results of an engine function over the chunks of a vector.
#[inline]
fn sum_over_chunks(vec: &[f64], function: unsafe extern "C" fn(*const f64, c_int) -> f64) -> f64 {
    vec.chunks(CHUNK).fold(0.0, |sum, chunk| {
        // SAFETY: the functions passed here read the given number of values, the length of the
        // chunk.
        sum + unsafe { function(chunk.as_ptr(), chunk.len() as c_int) }
    })
}

/// Calls `call(res, vec, n)` for each pair of chunks.
#[inline]
fn for_chunks(res: &mut [f64], vec: &[f64], call: impl Fn(*mut f64, *const f64, c_int)) {
    for (res, vec) in res.chunks_mut(CHUNK).zip(vec.chunks(CHUNK)) {
        call(res.as_mut_ptr(), vec.as_ptr(), res.len() as c_int);
    }
}

/// Calls `call(res, vec1, vec2, n)` for each triple of chunks.
#[inline]
fn for_chunks_of_two(
    res: &mut [f64],
    vec1: &[f64],
    vec2: &[f64],
    call: impl Fn(*mut f64, *const f64, *const f64, c_int),
) {
    for ((res, vec1), vec2) in res.chunks_mut(CHUNK).zip(vec1.chunks(CHUNK)).zip(vec2.chunks(CHUNK)) {
        call(res.as_mut_ptr(), vec1.as_ptr(), vec2.as_ptr(), res.len() as c_int);
    }
}

/// Sets `res = 0`.
#[inline]
pub fn zero(res: &mut [f64]) {
    res.fill(0.0);
}

/// Sets every value: `res = val`. (Newer engines provide it in C.)
#[inline]
pub fn fill(res: &mut [f64], val: f64) {
    res.fill(val);
}

/// Copies `res = data`. The engine's number type is `f64`, so this covers `mju_d2n` and `mju_n2d`
/// too.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
#[inline]
pub fn copy(res: &mut [f64], data: &[f64]) -> Result<()> {
    Error::check_length("the result of copy", res.len(), data.len())?;
    res.copy_from_slice(data);
    Ok(())
}

/// Converts from single precision: `res = vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
pub fn f2n(res: &mut [f64], vec: &[f32]) -> Result<()> {
    Error::check_length("the result of f2n", res.len(), vec.len())?;
    res.iter_mut().zip(vec).for_each(|(res, &value)| *res = f64::from(value));
    Ok(())
}

/// Converts to single precision, rounding to nearest: `res = vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
pub fn n2f(res: &mut [f32], vec: &[f64]) -> Result<()> {
    Error::check_length("the result of n2f", res.len(), vec.len())?;
    res.iter_mut().zip(vec).for_each(|(res, &value)| *res = value as f32);
    Ok(())
}

/// Returns the sum of all values.
#[inline]
pub fn sum(vec: &[f64]) -> f64 {
    sum_over_chunks(vec, sys::mju_sum)
}

/// Returns the L₁ norm: the sum of all absolute values.
#[inline]
pub fn l1(vec: &[f64]) -> f64 {
    sum_over_chunks(vec, sys::mju_L1)
}

/// Returns the Euclidean norm `√(vec · vec)`. It overflows if the squares do.
#[inline]
pub fn norm(vec: &[f64]) -> f64 {
    dot_of_equals(vec, vec).sqrt()
}

/// Returns the dot product `vec1 · vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
///
/// ```
/// use mujoco_safe::math;
///
/// assert_eq!(math::dot(&[1.0, 2.0, 3.0], &[4.0, -5.0, 6.0])?, 12.0);
/// let error = math::dot(&[1.0, 2.0, 3.0], &[4.0]).unwrap_err();
/// assert_eq!(error.to_string(), "vec2 of dot has shape (1), but must have (3)");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[inline]
pub fn dot(vec1: &[f64], vec2: &[f64]) -> Result<f64> {
    Error::check_length("vec2 of dot", vec2.len(), vec1.len())?;
    Ok(dot_of_equals(vec1, vec2))
}

/// Returns the dot product of two vectors of equal length.
#[inline]
pub(super) fn dot_of_equals(vec1: &[f64], vec2: &[f64]) -> f64 {
    vec1.chunks(CHUNK).zip(vec2.chunks(CHUNK)).fold(0.0, |sum, (vec1, vec2)| {
        let n = vec1.len().min(vec2.len()) as c_int;
        // SAFETY: both chunks have n values.
        sum + unsafe { sys::mju_dot(vec1.as_ptr(), vec2.as_ptr(), n) }
    })
}

/// Divides `vec` by its Euclidean norm and returns the original norm. A vector with a norm below
/// `1e-15` becomes `(1, 0, 0, …)`. (An empty vector stays empty; the engine would write out of
/// bounds.)
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

/// Scales a vector: `res = vec · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
#[inline]
pub fn scl(res: &mut [f64], vec: &[f64], scl: f64) -> Result<()> {
    Error::check_length("the result of scl", res.len(), vec.len())?;
    // SAFETY: both chunks have n values.
    for_chunks(res, vec, |res, vec, n| unsafe { sys::mju_scl(res, vec, scl, n) });
    Ok(())
}

/// Scales a vector in place: `res = res · scl`.
#[inline]
pub fn scl_in_place(res: &mut [f64], scl: f64) {
    for value in res {
        *value *= scl;
    }
}

/// Adds two vectors: `res = vec1 + vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless all lengths are equal.
#[inline]
pub fn add(res: &mut [f64], vec1: &[f64], vec2: &[f64]) -> Result<()> {
    Error::check_length("vec1 of add", vec1.len(), res.len())?;
    Error::check_length("vec2 of add", vec2.len(), res.len())?;
    // SAFETY: all three chunks have n values.
    for_chunks_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_add(res, vec1, vec2, n) });
    Ok(())
}

/// Subtracts two vectors: `res = vec1 − vec2`.
///
/// # Errors
///
/// [`Error::Shape`] unless all lengths are equal.
#[inline]
pub fn sub(res: &mut [f64], vec1: &[f64], vec2: &[f64]) -> Result<()> {
    Error::check_length("vec1 of sub", vec1.len(), res.len())?;
    Error::check_length("vec2 of sub", vec2.len(), res.len())?;
    // SAFETY: all three chunks have n values.
    for_chunks_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_sub(res, vec1, vec2, n) });
    Ok(())
}

/// Adds in place: `res = res + vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
#[inline]
pub fn add_to(res: &mut [f64], vec: &[f64]) -> Result<()> {
    Error::check_length("vec of add_to", vec.len(), res.len())?;
    // SAFETY: both chunks have n values.
    for_chunks(res, vec, |res, vec, n| unsafe { sys::mju_addTo(res, vec, n) });
    Ok(())
}

/// Subtracts in place: `res = res − vec`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
#[inline]
pub fn sub_from(res: &mut [f64], vec: &[f64]) -> Result<()> {
    Error::check_length("vec of sub_from", vec.len(), res.len())?;
    // SAFETY: both chunks have n values.
    for_chunks(res, vec, |res, vec, n| unsafe { sys::mju_subFrom(res, vec, n) });
    Ok(())
}

/// Adds a scaled vector in place: `res = res + vec · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless both lengths are equal.
#[inline]
pub fn add_to_scl(res: &mut [f64], vec: &[f64], scl: f64) -> Result<()> {
    Error::check_length("vec of add_to_scl", vec.len(), res.len())?;
    // SAFETY: both chunks have n values.
    for_chunks(res, vec, |res, vec, n| unsafe { sys::mju_addToScl(res, vec, scl, n) });
    Ok(())
}

/// Adds a scaled vector: `res = vec1 + vec2 · scl`.
///
/// # Errors
///
/// [`Error::Shape`] unless all lengths are equal.
#[inline]
pub fn add_scl(res: &mut [f64], vec1: &[f64], vec2: &[f64], scl: f64) -> Result<()> {
    Error::check_length("vec1 of add_scl", vec1.len(), res.len())?;
    Error::check_length("vec2 of add_scl", vec2.len(), res.len())?;
    // SAFETY: all three chunks have n values.
    for_chunks_of_two(res, vec1, vec2, |res, vec1, vec2, n| unsafe { sys::mju_addScl(res, vec1, vec2, scl, n) });
    Ok(())
}

/// Returns `true` if all values are zero, of either sign. An empty vector is zero.
#[inline]
pub fn is_zero(vec: &[f64]) -> bool {
    vec.iter().all(|&value| value == 0.0)
}

/// Returns `true` if the engine treats a value as bad: NaN, or beyond ±10¹⁰.
#[inline]
pub fn is_bad(x: f64) -> bool {
    x.is_nan() || x.abs() > sys::mjMAXVAL
}

/// Sorts in increasing order by insertion. The sort is stable. With a NaN among the values, the
/// order is unspecified.
///
/// Insertion sort is fast for nearly sorted lists and O(n²) otherwise. For longer lists, or lists
/// that may contain NaN, use `sort_by(f64::total_cmp)`.
///
/// # Errors
///
/// [`Error::Unsupported`] for more values than a C `int` counts.
///
/// ```
/// let mut list = [3.0, -1.0, 2.0];
/// mujoco_safe::math::insertion_sort(&mut list)?;
/// assert_eq!(list, [-1.0, 2.0, 3.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn insertion_sort(list: &mut [f64]) -> Result<()> {
    let n = count("insertion_sort", list.len())?;
    // SAFETY: the list has n values. A false comparison, as with NaN, only ends the search for the
    // insertion point.
    unsafe { sys::mju_insertionSort(list.as_mut_ptr(), n) };
    Ok(())
}

/// Sorts integers in increasing order by insertion.
///
/// # Errors
///
/// [`Error::Unsupported`] for more values than a C `int` counts.
pub fn insertion_sort_int(list: &mut [c_int]) -> Result<()> {
    let n = count("insertion_sort_int", list.len())?;
    // SAFETY: the list has n values.
    unsafe { sys::mju_insertionSortInt(list.as_mut_ptr(), n) };
    Ok(())
}
