//! Motion of a trajectory: the moving frames, which are the bodies, and the cameras and lights that
//! do not move with a body, selected records, and the poses of all frames in them.

use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::math::{Pose, mat2quat, quat_z2vec};
use crate::model::Model;
use crate::trajectory::Trajectory;

/// A moving frame, by the index of its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    Body(usize),
    /// Camera that tracks a body or points at one.
    Camera(usize),
    /// Light that tracks a body or points at one. The direction of the light is the z-axis.
    Light(usize),
}

/// The value of `mjCAMLIGHT_FIXED`, for the modes of cameras and lights.
const FIXED: i32 = mujoco_sys::mjCAMLIGHT_FIXED as i32;

/// Returns the frames of a model: first all bodies.
pub(crate) fn all(model: &Model) -> Vec<Frame> {
    let moving = |modes: &[i32]| -> Vec<usize> { (0..modes.len()).filter(|&index| modes[index] != FIXED).collect() };
    let cameras = moving(model.cam_mode()).into_iter().map(Frame::Camera);
    let lights = moving(model.light_mode()).into_iter().map(Frame::Light);
    (0..model.nbody()).map(Frame::Body).chain(cameras).chain(lights).collect()
}

impl Pose {
    /// Returns the position and the quaternion.
    pub(crate) fn numbers(&self) -> [f64; 7] {
        let ([x, y, z], [qw, qx, qy, qz]) = (self.pos, self.quat);
        [x, y, z, qw, qx, qy, qz]
    }

    /// Selects the sign of the quaternion that is nearer to the one before, so that a motion has no
    /// jumps.
    pub(crate) fn near(self, before: Option<&Self>) -> Self {
        let product: f64 = before.iter().flat_map(|pose| pose.quat).zip(self.quat).map(|(a, b)| a * b).sum();
        if product < 0.0 { Self { quat: self.quat.map(|part| -part), ..self } } else { self }
    }
}

/// Returns the pose of a frame in the world, of which the positions have been computed.
pub(crate) fn pose(data: &Data, frame: Frame) -> Pose {
    match frame {
        Frame::Body(index) => Pose { pos: data.xpos()[index], quat: data.xquat()[index] },
        Frame::Camera(index) => Pose { pos: data.cam_xpos()[index], quat: mat2quat(&data.cam_xmat()[index]) },
        Frame::Light(index) => Pose { pos: data.light_xpos()[index], quat: quat_z2vec(&data.light_xdir()[index]) },
    }
}

/// Returns the first record in each period of the frame rate, and the last record.
pub(crate) fn records(times: &[f64], frames_per_second: f64) -> Result<Vec<usize>> {
    Error::check_range(frames_per_second > 0.0, "frames_per_second", frames_per_second, "above 0")?;
    let Some(&start) = times.first() else {
        let what = "a trajectory to replay";
        return Err(Error::invalid(InvalidKind::Unsuitable, what, "empty", "of at least one record"));
    };
    let descends = |&record: &usize| times[record].is_nan() || times[record] < times[record - 1];
    if let Some(record) = (1..times.len()).find(descends) {
        let (what, value) = (format!("the time of record {record} to replay"), times[record]);
        return Err(Error::out_of_range(what, value, "at least the time before it"));
    }
    let (mut records, mut due) = (Vec::new(), f64::NEG_INFINITY);
    for (record, &time) in times.iter().enumerate() {
        // Times are sums of steps: a tolerance, so that rounding does not delay a frame.
        let period = ((time - start) * frames_per_second + 1e-6).floor();
        // The product with an infinite rate is infinite or NaN.
        if !period.is_finite() || period > due || record + 1 == times.len() {
            due = period;
            records.push(record);
        }
    }
    Ok(records)
}

/// Computes the poses of all frames in records of a trajectory: for each frame, those of all
/// records. Calls `visit` in each state with the number of the record.
pub(crate) fn poses(
    data: &mut Data,
    trajectory: &Trajectory,
    records: &[usize],
    mut visit: impl FnMut(&mut Data, usize) -> Result<()>,
) -> Result<Vec<Vec<Pose>>> {
    let frames = all(data.model());
    let mut poses: Vec<Vec<Pose>> = vec![Vec::with_capacity(records.len()); frames.len()];
    for &record in records {
        trajectory.apply(record, data)?;
        data.forward()?;
        for (poses, &frame) in poses.iter_mut().zip(&frames) {
            poses.push(pose(data, frame).near(poses.last()));
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
