//! Buffers of the past values of controls and sensors, for delays. A buffer has a reserved number,
//! the index of the newest sample, the times of the samples and their values.

use super::super::invalid::Invalid;
use super::super::layout::{Field, field, size};
use super::super::rule::{is, is_in, size_is};
use super::super::view::View;

/// Largest number of samples, which is the limit of the compiler.
const MOST_SAMPLES: i64 = 1 << 24;

/// Largest order of interpolation: cubic.
const LAST_INTERPOLATION: i64 = 2;

/// Checks the numbers of samples and the addresses of buffers, after the dimensions of sensors. The
/// buffers of actuators are first.
pub(in super::super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let mut next = 0;
    for i in 0..view.size(size::nu) {
        next = buffer(view, [field::actuator_history, field::actuator_historyadr], i, next, 1)?;
    }
    for i in 0..view.size(size::nsensor) {
        let dimension = i64::from(view.get(field::sensor_dim, i));
        next = buffer(view, [field::sensor_history, field::sensor_historyadr], i, next, dimension)?;
    }
    size_is(view, size::nhistory, next as u64, "the sum over actuators and sensors")
}

/// Checks the buffer of an element and returns its end, which is below 2^62: an address is an int,
/// and a buffer has less than 2^56 numbers.
fn buffer(
    view: &View<'_>,
    [history, address]: [Field<i32>; 2],
    i: usize,
    next: i64,
    dimension: i64,
) -> Result<i64, Invalid> {
    is_in(view, history, 2 * i, 0..=MOST_SAMPLES)?;
    is_in(view, history, 2 * i + 1, 0..=LAST_INTERPOLATION)?;
    let samples = i64::from(view.get(history, 2 * i));
    if samples == 0 {
        is(view, address, i, -1, "because it has no samples")?;
        return Ok(next);
    }
    is(view, address, i, next, "the end of the previous buffer")?;
    Ok(next + 2 + samples + samples * dimension)
}
