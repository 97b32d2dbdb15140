//! Predictive control: a planner optimises a trajectory from the present state at intervals, and a
//! regulator follows it.
//!
//! A [`Planner`] improves a plan of a fixed number of steps, the horizon, from the present state of
//! a simulation. The plan is a [`TimeVaryingLqr`], whose gains correct deviations until the next
//! plan. There are two planners:
//!
//! - [`IlqrPlanner`] iterates [iLQR](super::ilqr). It needs derivatives, and finds the gains.
//! - [`SamplingPlanner`] simulates random variations of the previous plan: predictive sampling, or
//!   MPPI. It needs the values of the cost only, which need not be smooth.
//!
//! Two controllers plan and apply the plan in between; they are [`Controller`](crate::Controller)s,
//! so recordings and the viewer accept them:
//!
//! - [`PredictiveController`] plans at intervals in the thread of the simulation, which waits for
//!   the planner. A run is reproducible.
//! - [`ThreadedPredictiveController`] plans in a second thread, for simulations and robots that run
//!   in real time.
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
mod observation;
mod sampling;
mod threaded;

pub use self::controller::PredictiveController;
pub use self::ilqr_planner::IlqrPlanner;
pub use self::sampling::{Interpolation, SamplingOptions};
pub use self::threaded::ThreadedPredictiveController;
use super::TimeVaryingLqr;
use super::ilqr::TrajectoryCost;
use crate::data::Data;
use crate::error::Result;
use crate::macros::with_aliases;

with_aliases! {
    pub use self::sampling::{SamplingPlanner = "MPPI" "predictive sampling"};
}

/// Cost of a plan, before and after its improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanReport {
    /// Cost of the initial trajectory: the trajectory of the previous plan, from the present state.
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

    /// Plans from the present state of a simulation and writes the plan to `policy`, whose table
    /// starts at the present time. The search starts from the previous plan, moved forward to the
    /// present time. The state includes the time and the inputs; results such as poses may be
    /// missing.
    ///
    /// # Errors
    ///
    /// The errors of the cost, and [`Error::Unstable`](crate::Error::Unstable) if all initial
    /// trajectories are unstable. The plan and the policy are then unchanged, or incomplete;
    /// [`reset`](Self::reset) makes the planner usable.
    fn plan(&mut self, data: &Data, cost: &dyn TrajectoryCost, policy: &mut TimeVaryingLqr) -> Result<PlanReport>;

    /// Discards the previous plan. The next search starts from the initial controls.
    fn reset(&mut self);
}
