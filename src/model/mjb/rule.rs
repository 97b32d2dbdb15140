//! Rules that many fields share: a range, an exact value, a flag, and the partition of one array
//! into consecutive pieces.

use std::cmp::Ordering;
use std::ops::RangeInclusive;

use super::invalid::Invalid;
use super::layout::{Element, Field, Size};
use super::view::View;

/// Checks that every element of the field lies in the range.
pub(super) fn all_in(view: &View<'_>, field: Field<i32>, range: RangeInclusive<i64>) -> Result<(), Invalid> {
    (0..view.len(field)).try_for_each(|i| is_in(view, field, i, range.clone()))
}

/// Checks that one element lies in the range.
pub(super) fn is_in(view: &View<'_>, field: Field<i32>, i: usize, range: RangeInclusive<i64>) -> Result<(), Invalid> {
    let value = i64::from(view.get(field, i));
    if range.contains(&value) {
        return Ok(());
    }
    Err(Invalid::element(field.name(), i, value, must_be(&range)))
}

/// Returns "it must be from 0 to 7", or a variant of it for a range with one value or none.
pub(super) fn must_be(range: &RangeInclusive<i64>) -> String {
    let (first, last) = (range.start(), range.end());
    match last.cmp(first) {
        Ordering::Less => "the model has no element that it could refer to".into(),
        Ordering::Equal => format!("it must be {first}"),
        Ordering::Greater => format!("it must be from {first} to {last}"),
    }
}

/// Checks that every element of the field is an id of a kind with `count` elements.
pub(super) fn all_ids(view: &View<'_>, field: Field<i32>, count: usize) -> Result<(), Invalid> {
    all_in(view, field, ids(count))
}

/// Checks that every element of the field is such an id, or -1 for none.
pub(super) fn all_ids_or_none(view: &View<'_>, field: Field<i32>, count: usize) -> Result<(), Invalid> {
    all_in(view, field, -1..=count as i64 - 1)
}

/// Returns the range of valid ids of a kind with `count` elements.
pub(super) fn ids(count: usize) -> RangeInclusive<i64> {
    0..=count as i64 - 1
}

/// Checks that one element has the value that follows from others; `why` names them.
pub(super) fn is<T: Element + Into<f64>>(
    view: &View<'_>,
    field: Field<T>,
    i: usize,
    expected: i64,
    why: &str,
) -> Result<(), Invalid> {
    let value: f64 = view.get(field, i).into();
    #[expect(clippy::float_cmp, reason = "both are integers that a double holds exactly, or it is an error")]
    if value == expected as f64 {
        return Ok(());
    }
    Err(Invalid::element(field.name(), i, value, format!("it must be {expected}, {why}")))
}

/// Checks that every byte of the field is at most `last`: 1 for a flag.
pub(super) fn all_bytes(view: &View<'_>, field: Field<u8>, last: u8) -> Result<(), Invalid> {
    match view.values(field).enumerate().find(|&(_, value)| value > last) {
        None => Ok(()),
        Some((i, value)) => Err(Invalid::element(field.name(), i, value, must_be(&(0..=last.into())))),
    }
}

/// Checks that a size has the value that follows from the rest of the file.
pub(super) fn size_is(view: &View<'_>, size: Size, expected: u64, why: &str) -> Result<(), Invalid> {
    let value = view.size(size);
    if value as u64 == expected {
        return Ok(());
    }
    Err(Invalid::scalar(size.name(), value, format!("it must be {expected}, {why}")))
}

/// Checks that the pieces of the owners follow each other without a gap, have at least `least`
/// elements each, and fill the array of `total` elements.
pub(super) fn partition(
    view: &View<'_>,
    address: Field<i32>,
    number: Field<i32>,
    least: i64,
    total: Size,
) -> Result<(), Invalid> {
    let mut next = 0;
    for i in 0..view.len(number) {
        is_in(view, number, i, least..=view.size(total) as i64)?;
        is(view, address, i, next, "the end of the previous one")?;
        next += i64::from(view.get(number, i));
    }
    size_is(view, total, next as u64, &format!("the sum of {}", number.name()))
}

/// As [`partition`], for an array in which owners with the address -1 have no piece.
pub(super) fn optional_partition(
    view: &View<'_>,
    address: Field<i32>,
    number: Field<i32>,
    total: Size,
) -> Result<(), Invalid> {
    let mut next = 0;
    for i in 0..view.len(address) {
        if view.get(address, i) == -1 {
            continue;
        }
        is(view, address, i, next, "the end of the previous one, or -1 for none")?;
        next += i64::from(view.get(number, i));
    }
    size_is(view, total, next as u64, &format!("the sum of {} where {} is not -1", number.name(), address.name()))
}

/// Returns the range of a piece that [`partition`] has checked.
pub(super) fn piece(view: &View<'_>, address: Field<i32>, number: Field<i32>, i: usize) -> std::ops::Range<usize> {
    let start = view.get(address, i) as usize;
    start..start + view.get(number, i) as usize
}
