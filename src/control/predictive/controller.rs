//! The controller that plans at intervals and follows the plan in between.

use super::{PlanReport, Planner};
use crate::control::TimeVaryingLqr;
use crate::control::ilqr::TrajectoryCost;
use crate::controller::Controller;
use crate::data::Data;
use crate::error::{Error, Result};

/// Controller that plans every few steps, in the thread of the simulation, and follows the plan
/// with its gains in between. The simulation waits for the planner, so a run is reproducible.
///
/// The [module](crate::control::predictive) has an example.
#[derive(Debug)]
pub struct PredictiveController<P, C> {
    planner: P,
    cost: C,
    policy: TimeVaryingLqr,
    interval: usize,
    /// Number of steps before the next plan.
    steps_left: usize,
    /// Time of the last step, s.
    time: f64,
    report: Option<PlanReport>,
}

impl<P: Planner, C: TrajectoryCost> PredictiveController<P, C> {
    /// Creates a controller that plans every `interval` steps, beginning with the first.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the interval is from 1 to the horizon of the planner.
    pub fn new(data: &Data, planner: P, cost: C, interval: usize) -> Result<Self> {
        if !(1..=planner.horizon()).contains(&interval) {
            let expected = format!("from 1 to the horizon, {}", planner.horizon());
            return Err(Error::out_of_range("the interval of a PredictiveController", interval, expected));
        }
        let policy = TimeVaryingLqr::hold_controls(data, planner.horizon())?;
        Ok(Self { planner, cost, policy, interval, steps_left: 0, time: data.time(), report: None })
    }

    /// Returns the present plan. Before the first one, it holds the controls of the simulation that
    /// the controller was created with.
    pub fn policy(&self) -> &TimeVaryingLqr {
        &self.policy
    }

    /// Returns the cost of the present plan, or `None` before the first one.
    pub fn report(&self) -> Option<PlanReport> {
        self.report
    }

    /// Returns the cost.
    pub fn cost(&self) -> &C {
        &self.cost
    }

    /// Returns the cost, to change weights and targets. The next plan uses them.
    pub fn cost_mut(&mut self) -> &mut C {
        &mut self.cost
    }

    /// Returns the planner.
    pub fn planner(&self) -> &P {
        &self.planner
    }

    /// Returns the planner, to change it.
    pub fn planner_mut(&mut self) -> &mut P {
        &mut self.planner
    }

    /// Discards the plan. The next step plans from the initial controls of the planner.
    pub fn reset(&mut self) {
        self.planner.reset();
        self.steps_left = 0;
    }
}

impl<P: Planner, C: TrajectoryCost> Controller for PredictiveController<P, C> {
    /// Plans if it is time, and sets the controls. If the time of the simulation went back, because
    /// of a reset, discards the plan first.
    fn control(&mut self, data: &mut Data) -> Result<()> {
        if data.time() < self.time {
            self.reset();
        }
        self.time = data.time();
        if self.steps_left == 0 {
            self.report = Some(self.planner.plan(data, &self.cost, &mut self.policy)?);
            self.steps_left = self.interval;
        }
        self.steps_left -= 1;
        self.policy.control(data)
    }
}
