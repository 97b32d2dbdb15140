//! Simulation of one push, under the regulator and under the planner.

use std::time::{Duration, Instant};

use mujoco_safe::{Data, Result};

use crate::planner::Planner;
use crate::robot::Robot;
use crate::simulate::{Disturbance, Push, Run, simulate};

/// Outcome of one push.
pub struct Attempt {
    pub seed: u64,
    pub regulated: Run,
    pub planned: Run,
    /// Time of each decision, s, and the predicted cost of the selected rollout.
    pub decisions: Vec<(f64, f64)>,
    /// Wall-clock time of the simulation with the planner, including planning.
    pub took: Duration,
}

impl Attempt {
    /// Returns `true` if the robot fell under the regulator alone, and stood under the planner.
    pub fn succeeded(&self) -> bool {
        !self.regulated.upright() && self.planned.upright()
    }

    /// Returns the ratio of simulated time to wall-clock time.
    pub fn real_time_factor(&self) -> f64 {
        self.planned.trajectory.times().last().copied().unwrap_or(0.0) / self.took.as_secs_f64()
    }
}

/// Simulates a push, until the time is over or the robot has fallen. The seed is that of the
/// planner.
pub fn attempt(robot: &Robot, push: Push, seed: u64, seconds: f64) -> Result<Attempt> {
    let disturbance = Disturbance { push: Some(push), ..Disturbance::default() };
    let torso = robot.model.body("torso")?;
    let mut data = Data::new(robot.model.clone())?;
    let regulated = simulate(&mut data, &mut robot.lqr.clone(), &robot.set_point, torso, seconds, disturbance)?;
    let mut planner = Planner::new(robot, seed)?;
    let start = Instant::now();
    let planned = simulate(&mut data, &mut planner, &robot.set_point, torso, seconds, disturbance)?;
    Ok(Attempt { seed, regulated, planned, decisions: planner.decisions, took: start.elapsed() })
}
