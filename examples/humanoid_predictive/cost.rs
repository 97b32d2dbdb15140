//! Cost of the planner: low height, imminent fall, tilt, motion and effort.

use mujoco_safe::{Data, Result};

use crate::robot::Robot;

/// Number of outputs per step of a rollout: centre of mass, midpoint of the soles, and the
/// remaining cost.
pub const OUTPUTS: usize = 6;

/// Cost of 1 m below the height of the set-point.
const HEIGHT: f64 = 10.0;
/// Cost of 1 m between the midpoint of the soles and the capture point of the linear inverted
/// pendulum.
const CAPTURE_POINT: f64 = 10.0;
/// Distance below which the cost becomes quadratic, m.
const SMOOTHING: f64 = 0.05;
/// Cost of a horizontal velocity of the centre of mass of 1 m/s.
const DRIFT: f64 = 1.0;
/// Cost of a torso tilted by 90°.
const TILT: f64 = 5.0;
/// Cost of a torso rotating at 1 rad/s.
const SPIN: f64 = 0.02;
/// Cost of a joint 1 rad away from the set-point.
const POSTURE: f64 = 0.05;
/// Cost of a joint moving at 1 rad/s.
const JOINT_VELOCITY: f64 = 0.001;
/// Cost of a motor at its limit.
const EFFORT: f64 = 0.01;

pub struct Cost {
    torso: usize,
    soles: [usize; 2],
    /// Joint positions at the set-point.
    joints: Vec<f64>,
    height: f64,
    gravity: f64,
    timestep: f64,
}

// First indices after the free joint, in `qpos` and `qvel`.
const FIRST_JOINT: usize = 7;
const FIRST_DOF: usize = 6;

impl Cost {
    pub fn new(robot: &Robot) -> Result<Self> {
        let model = &robot.model;
        Ok(Self {
            torso: model.body("torso")?.index(),
            soles: [model.site("sole_left")?.index(), model.site("sole_right")?.index()],
            joints: robot.set_point.qpos[FIRST_JOINT..].to_vec(),
            height: robot.height,
            gravity: -model.options().gravity[2],
            timestep: model.timestep(),
        })
    }

    /// Writes the outputs of one step, from which [`mean`](Self::mean) computes the cost.
    pub fn write_outputs(&self, data: &Data, row: &mut [f64]) {
        let [left, right] = self.soles.map(|sole| data.site_xpos()[sole]);
        let up = data.xmat()[self.torso][8];
        let (spin, motion) = (&data.qvel()[3..FIRST_DOF], &data.qvel()[FIRST_DOF..]);
        let posture: f64 =
            data.qpos()[FIRST_JOINT..].iter().zip(&self.joints).map(|(joint, target)| (joint - target).powi(2)).sum();
        row[..3].copy_from_slice(&data.subtree_com()[self.torso]);
        row[3..5].copy_from_slice(&[0.5 * (left[0] + right[0]), 0.5 * (left[1] + right[1])]);
        row[5] = TILT * (1.0 - up)
            + SPIN * sum_of_squares(spin)
            + POSTURE * posture
            + JOINT_VELOCITY * sum_of_squares(motion)
            + EFFORT * sum_of_squares(data.ctrl());
    }

    /// Returns the mean cost of a rollout's steps; infinite for an unstable rollout.
    pub fn mean<'r>(&self, mut rows: impl Iterator<Item = &'r [f64]>) -> f64 {
        let Some(mut before) = rows.next() else { return 0.0 };
        let (mut total, mut count) = (0.0, 0);
        for row in rows {
            total += self.step(before, row);
            count += 1;
            before = row;
        }
        let mean = total / f64::from(count.max(1));
        if mean.is_nan() { f64::INFINITY } else { mean }
    }

    fn step(&self, before: &[f64], row: &[f64]) -> f64 {
        let velocity = [0, 1].map(|axis| (row[axis] - before[axis]) / self.timestep);
        let fall_time = (row[2].max(0.0) / self.gravity).sqrt();
        let capture_error = [0, 1].map(|axis| row[axis] + fall_time * velocity[axis] - row[3 + axis]);
        HEIGHT * smooth(row[2] - self.height)
            + CAPTURE_POINT * smooth(capture_error[0].hypot(capture_error[1]))
            + DRIFT * sum_of_squares(&velocity)
            + row[5]
    }
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Returns the distance, smoothed to a quadratic near zero.
fn smooth(distance: f64) -> f64 {
    distance.hypot(SMOOTHING) - SMOOTHING
}
