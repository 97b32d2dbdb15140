//! Predictive control: a planner optimises a trajectory from the present state at intervals, and a regulator follows it.
//!
//! A [`Planner`] improves a plan of a fixed number of steps, the horizon, from the present state of a simulation.
//! [`IlqrPlanner`] does so by iterations of [iLQR](super::ilqr). The plan is a [`TimeVaryingLqr`], whose gains correct deviations until
//! the next plan. Two controllers plan and apply the plan in between; they are [`Controller`](crate::Controller)s, so recordings and the
//! viewer accept them:
//!
//! - [`PredictiveController`] plans at intervals in the thread of the simulation, which waits for the planner. A run is reproducible.
//! - [`ThreadedPredictiveController`] plans in a second thread, for simulations and robots that run in real time.
//!
//! ```
//! use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
//! use mujoco_safe::control::ilqr::IlqrOptions;
//! use mujoco_safe::control::residual::{Controls, JointPosition, JointVelocity, ResidualCost, Term};
//! use mujoco_safe::{Controller, Data, sample};
//!
//! // Hold the cart at 0.5 m and the pole upright, with a horizon of 60 steps and a plan in every second step.
//! let mut data = Data::new(sample::cartpole())?;
//! let model = data.model().clone();
//! let cost = ResidualCost::new(
//!     &model,
//!     [
//!         Term::new("position", JointPosition::all(&model).with_target(&[0.5, 0.0])?).with_terminal_weight(100.0),
//!         Term::new("velocity", JointVelocity::all(&model)).with_weight(0.01).with_terminal_weight(10.0),
//!         Term::new("effort", Controls::new(&model)).with_weight(1e-2),
//!     ],
//! )?;
//! let planner = IlqrPlanner::new(&model, 60, IlqrOptions::default().with_iterations(1))?;
//! let mut controller = PredictiveController::new(&data, planner, cost, 2)?;
//! for _ in 0..300 {
//!     controller.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!((data.qpos()[0] - 0.5).abs() < 0.05);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```

mod controller;
mod ilqr_planner;
mod threaded;

pub use self::controller::PredictiveController;
pub use self::ilqr_planner::IlqrPlanner;
pub use self::threaded::ThreadedPredictiveController;
use super::TimeVaryingLqr;
use super::ilqr::TrajectoryCost;
use crate::data::{Data, StateSpec};
use crate::error::Result;

/// Components of the state that a plan starts from, by default: all except applied forces, which are unknown on a robot.
const FORESEEN: StateSpec = StateSpec::INTEGRATION.difference(StateSpec::QFRC_APPLIED.union(StateSpec::XFRC_APPLIED));

/// Cost of a plan, before and after its improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanReport {
    /// Cost of the initial trajectory: that of the previous plan, from the present state.
    pub initial_cost: f64,
    /// Cost of the plan.
    pub cost: f64,
}

impl PlanReport {
    /// Creates a report, for planners outside of this crate.
    pub fn new(initial_cost: f64, cost: f64) -> Self {
        Self { initial_cost, cost }
    }
}

/// Method of planning over a receding horizon.
pub trait Planner: Send {
    /// Returns the number of steps of a plan, at least one.
    fn horizon(&self) -> usize;

    /// Plans from the present state of a simulation and writes the plan to `policy`, whose table starts at the present time. The
    /// search starts from the previous plan, moved forward to the present time. The state includes the time and the inputs; results such
    /// as poses may be missing.
    ///
    /// # Errors
    ///
    /// The errors of the cost, and [`Error::Unstable`](crate::Error::Unstable) if all initial trajectories are unstable. The plan and the
    /// policy are then unchanged, or incomplete; [`reset`](Self::reset) makes the planner usable.
    fn plan(&mut self, data: &Data, cost: &dyn TrajectoryCost, policy: &mut TimeVaryingLqr) -> Result<PlanReport>;

    /// Discards the previous plan. The next search starts from the initial controls.
    fn reset(&mut self);
}
