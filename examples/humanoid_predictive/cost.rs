//! What the planner pays for: being low, being about to fall over, leaning, and moving more than needed.

use mujoco_safe::{Data, Result};

use crate::robot::Robot;

/// How many numbers a step of a rollout is judged by: the centre of mass, the middle between the soles, and what else it costs.
pub const JUDGED: usize = 6;

/// A metre below the height of the set-point.
const HEIGHT: f64 = 10.0;
/// A metre between the middle of the soles and the point above which the robot would come to rest if it fell like a pendulum.
const CAPTURE: f64 = 10.0;
/// Below this a distance is cheaper than in proportion, m.
const SMALL: f64 = 0.05;
/// The velocity of the centre of mass, 1 m/s along the floor.
const DRIFT: f64 = 1.0;
/// The torso on its side.
const LEAN: f64 = 5.0;
/// The torso turning at 1 rad/s.
const SPIN: f64 = 0.02;
/// A joint 1 rad off the set-point.
const POSTURE: f64 = 0.05;
/// A joint moving at 1 rad/s.
const MOTION: f64 = 0.001;
/// A motor at its limit.
const EFFORT: f64 = 0.01;

pub struct Cost {
    torso: usize,
    soles: [usize; 2],
    /// The joints at the set-point.
    joints: Vec<f64>,
    height: f64,
    gravity: f64,
    timestep: f64,
}

/// Where the joints behind the free joint begin.
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

    /// Writes what a step of a rollout is judged by.
    pub fn judge(&self, data: &Data, row: &mut [f64]) {
        let [left, right] = self.soles.map(|sole| data.site_xpos()[sole]);
        let up = data.xmat()[self.torso][8];
        let (spin, motion) = (&data.qvel()[3..FIRST_DOF], &data.qvel()[FIRST_DOF..]);
        let posture: f64 =
            data.qpos()[FIRST_JOINT..].iter().zip(&self.joints).map(|(joint, there)| (joint - there).powi(2)).sum();
        row[..3].copy_from_slice(&data.subtree_com()[self.torso]);
        row[3..5].copy_from_slice(&[0.5 * (left[0] + right[0]), 0.5 * (left[1] + right[1])]);
        row[5] = LEAN * (1.0 - up)
            + SPIN * squares(spin)
            + POSTURE * posture
            + MOTION * squares(motion)
            + EFFORT * squares(data.ctrl());
    }

    /// The mean cost of the steps of a rollout. One that has become unstable is infinitely bad.
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
        let fall = (row[2].max(0.0) / self.gravity).sqrt();
        let off = [0, 1].map(|axis| row[axis] + fall * velocity[axis] - row[3 + axis]);
        HEIGHT * smooth(row[2] - self.height)
            + CAPTURE * smooth(off[0].hypot(off[1]))
            + DRIFT * squares(&velocity)
            + row[5]
    }
}

fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// A distance, but for small ones the square of it.
fn smooth(distance: f64) -> f64 {
    distance.hypot(SMALL) - SMALL
}
