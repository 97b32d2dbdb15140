//! The rules that many fields share: a range, an exact value, a flag, a partition of one array into consecutive pieces.

use std::cmp::Ordering;
use std::ops::RangeInclusive;

use super::invalid::Invalid;
use super::layout::{Element, Field, Size};
use super::view::View;

/// Every element of the field lies in the range.
pub(super) fn all_in(view: &View<'_>, field: Field<i32>, range: RangeInclusive<i64>) -> Result<(), Invalid> {
    (0..view.len(field)).try_for_each(|i| is_in(view, field, i, range.clone()))
}

/// One element lies in the range.
pub(super) fn is_in(view: &View<'_>, field: Field<i32>, i: usize, range: RangeInclusive<i64>) -> Result<(), Invalid> {
    let value = i64::from(view.get(field, i));
    if range.contains(&value) {
        return Ok(());
    }
    Err(Invalid::element(field.name(), i, value, must_be(&range)))
}

/// "it must be from 0 to 7", and how to say so if there is one value or none.
pub(super) fn must_be(range: &RangeInclusive<i64>) -> String {
    let (first, last) = (range.start(), range.end());
    match last.cmp(first) {
        Ordering::Less => "nothing that it could refer to exists".into(),
        Ordering::Equal => format!("it must be {first}"),
        Ordering::Greater => format!("it must be from {first} to {last}"),
    }
}

/// Every element is the id of an element of a kind, of which there are `count`.
pub(super) fn all_ids(view: &View<'_>, field: Field<i32>, count: usize) -> Result<(), Invalid> {
    all_in(view, field, ids(count))
}

/// Every element is such an id, or -1 for none.
pub(super) fn all_ids_or_none(view: &View<'_>, field: Field<i32>, count: usize) -> Result<(), Invalid> {
    all_in(view, field, -1..=count as i64 - 1)
}

pub(super) fn ids(count: usize) -> RangeInclusive<i64> {
    0..=count as i64 - 1
}

/// One element has the value that follows from others; `why` says from which.
pub(super) fn is<T: Element + Into<f64>>(
    view: &View<'_>,
    field: Field<T>,
    i: usize,
    wanted: i64,
    why: &str,
) -> Result<(), Invalid> {
    let value: f64 = view.get(field, i).into();
    #[expect(clippy::float_cmp, reason = "both are integers that a double holds exactly, or it is an error")]
    if value == wanted as f64 {
        return Ok(());
    }
    Err(Invalid::element(field.name(), i, value, format!("it must be {wanted}, {why}")))
}

/// Every byte of the field is at most `last`: 1 for a flag.
pub(super) fn all_bytes(view: &View<'_>, field: Field<u8>, last: u8) -> Result<(), Invalid> {
    match view.values(field).enumerate().find(|&(_, value)| value > last) {
        None => Ok(()),
        Some((i, value)) => Err(Invalid::element(field.name(), i, value, must_be(&(0..=last.into())))),
    }
}

/// A size has the value that follows from the rest of the file.
pub(super) fn size_is(view: &View<'_>, size: Size, wanted: u64, why: &str) -> Result<(), Invalid> {
    let value = view.size(size);
    if value as u64 == wanted {
        return Ok(());
    }
    Err(Invalid::scalar(size.name(), value, format!("it must be {wanted}, {why}")))
}

/// The owners' pieces follow each other without a gap, each with at least `least` elements, and fill the array of `total`.
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
        is(view, address, i, next, "where the one before ends")?;
        next += i64::from(view.get(number, i));
    }
    size_is(view, total, next as u64, &format!("the sum of {}", number.name()))
}

/// As [`partition`], for an array in which an owner has a piece or, with address -1, has none.
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
        is(view, address, i, next, "where the one before ends, or -1 for none")?;
        next += i64::from(view.get(number, i));
    }
    size_is(view, total, next as u64, &format!("the sum of {} where {} is not -1", number.name(), address.name()))
}

/// The range of a piece that [`partition`] has checked.
pub(super) fn piece(view: &View<'_>, address: Field<i32>, number: Field<i32>, i: usize) -> std::ops::Range<usize> {
    let start = view.get(address, i) as usize;
    start..start + view.get(number, i) as usize
}
