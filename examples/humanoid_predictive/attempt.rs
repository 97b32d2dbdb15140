//! One push, under the regulator and under the planner.

use std::time::{Duration, Instant};

use mujoco_safe::{Data, Result};

use crate::planner::Planner;
use crate::robot::{Robot, push};
use crate::simulate::{Disturbance, Run, simulate};

/// What became of a push.
pub struct Attempt {
    pub seed: u64,
    pub regulated: Run,
    pub planned: Run,
    /// When each decision was made, and what the future costs that it expected.
    pub decisions: Vec<(f64, f64)>,
    /// How long the planned simulation took, planning included.
    pub took: Duration,
}

impl Attempt {
    /// Whether the regulator alone has fallen, and the planner has not.
    pub fn succeeded(&self) -> bool {
        !self.regulated.upright() && self.planned.upright()
    }

    /// How many seconds of the simulation there were in a second.
    pub fn real_time_factor(&self) -> f64 {
        self.planned.trajectory.times().last().copied().unwrap_or(0.0) / self.took.as_secs_f64()
    }
}

/// Pushes the robot after a second, and simulates what comes of it, for so long or until it has fallen.
pub fn attempt(robot: &Robot, newtons: f64, seed: u64, seconds: f64) -> Result<Attempt> {
    let disturbance = Disturbance { push: Some(push(newtons, seed)), ..Disturbance::default() };
    let torso = robot.model.body("torso")?;
    let mut data = Data::new(robot.model.clone())?;
    let regulated = simulate(&mut data, &mut robot.lqr.clone(), &robot.set_point, torso, seconds, disturbance)?;
    let mut planner = Planner::new(robot, seed)?;
    let start = Instant::now();
    let planned = simulate(&mut data, &mut planner, &robot.set_point, torso, seconds, disturbance)?;
    Ok(Attempt { seed, regulated, planned, decisions: planner.decisions, took: start.elapsed() })
}
