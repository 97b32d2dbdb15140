//! Motion of a trajectory: selected records, and the poses of all frames in them.

use super::frame::{self, Frame, Pose};
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::trajectory::Trajectory;

/// Returns the first record in each period of the frame rate, and the last record.
pub(crate) fn records(times: &[f64], frames_per_second: f64) -> Result<Vec<usize>> {
    if frames_per_second.is_nan() || frames_per_second <= 0.0 {
        return Err(Error::out_of_range("frames_per_second", frames_per_second, "above 0"));
    }
    let Some(&start) = times.first() else {
        return Err(Error::invalid(
            InvalidKind::Unsuitable,
            "a trajectory to replay",
            "empty",
            "of at least one record",
        ));
    };
    let descends = |&record: &usize| times[record].is_nan() || times[record] < times[record - 1];
    if let Some(record) = (1..times.len()).find(descends) {
        let (what, value) = (format!("the time of record {record} to replay"), times[record]);
        return Err(Error::out_of_range(what, value, "at least the time before it"));
    }
    // Times are sums of steps: a tolerance, so that rounding does not delay a frame.
    let period = |time: f64| ((time - start) * frames_per_second + 1e-6).floor();
    let mut due = f64::NEG_INFINITY;
    let mut records: Vec<usize> = (0..times.len())
        .filter(|&record| {
            let period = period(times[record]);
            // The product with an infinite rate is infinite or NaN.
            let is_due = !period.is_finite() || period > due;
            due = if is_due { period } else { due };
            is_due
        })
        .collect();
    if records.last() != Some(&(times.len() - 1)) {
        records.push(times.len() - 1);
    }
    Ok(records)
}

/// Computes the poses of frames in records of a trajectory: for each frame, those of all records.
/// Calls `visit` in each state with the number of the record.
pub(crate) fn poses(
    data: &mut Data,
    frames: &[Frame],
    trajectory: &Trajectory,
    records: &[usize],
    mut visit: impl FnMut(&mut Data, usize) -> Result<()>,
) -> Result<Vec<Vec<Pose>>> {
    let mut poses: Vec<Vec<Pose>> = vec![Vec::with_capacity(records.len()); frames.len()];
    for &record in records {
        trajectory.apply(record, data)?;
        data.forward()?;
        for (poses, frame) in poses.iter_mut().zip(frames) {
            let before = poses.last().map(|pose: &Pose| pose.quat);
            poses.push(frame::pose(data, *frame).near(before));
        }
        visit(data, record)?;
    }
    Ok(poses)
}

#[cfg(test)]
mod tests {
    use super::records;

    #[test]
    fn frames_are_the_first_records_of_their_periods_and_the_last_record() {
        let times: Vec<f64> = (0..12).map(|step| 0.3 + 0.01 * f64::from(step)).collect();
        assert_eq!(records(&times, 50.0).unwrap(), [0, 2, 4, 6, 8, 10, 11]);
        assert_eq!(records(&times, 30.0).unwrap(), [0, 4, 7, 10, 11]);
        assert_eq!(records(&times, f64::INFINITY).unwrap().len(), 12);
        assert_eq!(records(&[2.0, 2.0], 60.0).unwrap(), [0, 1]);
        for (times, rate) in [(&[][..], 60.0), (&[0.0, -1.0], 60.0), (&[0.0, f64::NAN], 60.0), (&[0.0], f64::NAN)] {
            assert!(records(times, rate).is_err(), "{times:?} {rate}");
        }
    }
}
