//! The humanoid on its left leg, its controllers, and one push.

use std::f64::consts::TAU;
use std::sync::Arc;

use mujoco_safe::control::ilqr::IlqrOptions;
use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
use mujoco_safe::control::residual::ResidualCost;
use mujoco_safe::rollout::Random;
use mujoco_safe::{Controller, Data, Lqr, Matrix, Model, Result};

use super::Outcome;
use crate::common::balance;
use crate::common::balance::set_point::SetPoint;
use crate::common::standing::Standing;
use crate::simulate::{Disturbance, Push, Run, simulate};

/// Number of steps of a plan, and between two plans.
pub const HORIZON: usize = 100;
pub const INTERVAL: usize = 4;
/// Start and duration of a push, s.
pub const PUSH_AT: f64 = 0.2;
pub const PUSH_DURATION: f64 = 0.1;

pub struct Scenario {
    pub model: Arc<Model>,
    pub set_point: SetPoint,
    lqr: Lqr,
}

impl Scenario {
    pub fn new() -> Result<Self> {
        let (data, set_point, lqr) = balance::humanoid()?;
        Ok(Self { model: data.model().clone(), set_point, lqr })
    }

    /// Returns the cost of standing at the set-point.
    fn cost(&self, data: &Data) -> Result<ResidualCost> {
        let centre = data.subtree_com()[self.model.body("torso")?.index()];
        let SetPoint { qpos, ctrl, .. } = &self.set_point;
        Standing { centre, qpos, ctrl, momentum: 0.5, posture: 0.2 }.cost(&self.model)
    }

    /// Creates the predictive controller. Its planner starts from the controls of the set-point.
    pub fn controller(&self, start: &Data, threads: usize) -> Result<PredictiveController<IlqrPlanner, ResidualCost>> {
        let options = IlqrOptions::default()
            .with_iterations(1)
            .with_threads(threads)
            .with_step_sizes([1.0, 0.5, 0.2, 0.05])
            .with_sufficient_decrease(0.3);
        let held = Matrix::from_row_major(HORIZON, self.model.nu(), self.set_point.ctrl.repeat(HORIZON));
        let planner = IlqrPlanner::new(&self.model, HORIZON, options)?.with_initial_controls(held)?;
        PredictiveController::new(start, planner, self.cost(start)?, INTERVAL)
    }

    /// Simulates a push under each controller.
    pub fn push(&self, newtons: f64, seed: u64, seconds: f64) -> Result<Outcome> {
        let angle = Random::new(seed, 0, 0).uniform(0.0, TAU);
        let force = [newtons * angle.cos(), newtons * angle.sin()];
        let push = Push { force, start: PUSH_AT, duration: PUSH_DURATION };
        let disturbance = Disturbance { push: Some(push), ..Disturbance::default() };
        let torso = self.model.body("torso")?;
        let mut data = Data::new(self.model.clone())?;
        let mut run = |controller: &mut dyn Controller| -> Result<Run> {
            simulate(&mut data, controller, &self.set_point, torso, seconds, disturbance)
        };
        let regulated = run(&mut self.lqr.clone())?;

        let mut start = Data::new(self.model.clone())?;
        self.set_point.apply(&mut start)?;
        let planned = run(&mut self.controller(&start, 1)?)?;
        Ok(Outcome { seed, angle, regulated, planned })
    }
}
