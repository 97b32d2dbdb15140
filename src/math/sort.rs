//! Sorting by insertion, which is quick where little is out of order, and takes a time of the order of n² otherwise. For
//! anything longer, and for numbers that may not be numbers, use `sort_by(f64::total_cmp)`.

use std::ffi::c_int;

use mujoco_sys as sys;

use super::count;
use crate::error::Result;

/// Sorts in increasing order; equal numbers keep theirs. With a NaN among them the order is of no use.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more numbers than a C int counts.
///
/// ```
/// let mut list = [3.0, -1.0, 2.0];
/// mujoco_safe::math::insertion_sort(&mut list)?;
/// assert_eq!(list, [-1.0, 2.0, 3.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_insertionSort")]
pub fn insertion_sort(list: &mut [f64]) -> Result<()> {
    let n = count("insertion_sort", list.len())?;
    // SAFETY: there are n numbers, and a comparison that is false, as with NaN, only ends the search for a place.
    unsafe { sys::mju_insertionSort(list.as_mut_ptr(), n) };
    Ok(())
}

/// Sorts integers in increasing order.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more numbers than a C int counts.
#[doc(alias = "mju_insertionSortInt")]
pub fn insertion_sort_int(list: &mut [c_int]) -> Result<()> {
    let n = count("insertion_sort_int", list.len())?;
    // SAFETY: there are n numbers.
    unsafe { sys::mju_insertionSortInt(list.as_mut_ptr(), n) };
    Ok(())
}
