//! Trajectory optimisation: the iterative linear-quadratic regulator (iLQR) with control limits.
//!
//! Among the trajectories of `N` steps from a given state, [`Ilqr::solve`] finds a local minimum of
//! a cost, starting from given controls. Each iteration
//!
//! 1. linearises each step, several in parallel ([`Lineariser::along`]), and expands the cost to
//!    second order;
//! 2. computes the optimal change of the controls in a backward pass: in each step it solves a
//!    quadratic program whose box constraints are the control ranges, which yields a feedforward
//!    and a gain;
//! 3. simulates the new controls with several step sizes in parallel, and accepts the best
//!    trajectory if its cost is lower. Otherwise it repeats the backward pass with a larger
//!    regularisation.
//!
//! The result is a trajectory and a table of gains for a controller that follows it:
//! [`IlqrSolution::controller`].
//!
//! The method is differential dynamic programming without the second derivatives of the dynamics.
//!
//! # Sources
//!
//! * W. Li, E. Todorov, *Iterative linear quadratic regulator design for nonlinear biological
//!   movement systems*, ICINCO 2004.
//! * Y. Tassa, T. Erez, E. Todorov, *Synthesis and stabilization of complex behaviors through
//!   online trajectory optimization*, IROS 2012: the regularisation of the states, and its
//!   schedule.
//! * Y. Tassa, N. Mansard, E. Todorov, *Control-limited differential dynamic programming*, ICRA
//!   2014: the control limits.

mod backward;
mod cost;
mod forward;
mod policy;
mod quadratic;
mod search;

use std::fmt;

pub use self::cost::{CostExpansion, TrajectoryCost};
pub(super) use self::forward::{ControlLaw, Forward, Trial};
pub use self::quadratic::QuadraticCost;
pub use self::search::IlqrTimes;
pub(super) use self::search::Search;
use super::TimeVaryingLqr;
use crate::data::Data;
use crate::derivative::{Lineariser, TransitionOptions};
use crate::error::{Error, Result};
use crate::macros::with_methods;
use crate::matrix::Matrix;
use crate::model::IntoModel;

/// Options of [`Ilqr`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IlqrOptions {
    /// Maximum number of iterations; 200 by default.
    pub iterations: usize,
    /// Relative decrease of the cost, achieved or predicted, below which the search has converged;
    /// 1e-8 by default.
    pub tolerance: f64,
    /// Maximum number of steps that are linearised at the same time, as in
    /// [`TransitionOptions::threads`]; 1 by default. An
    /// [`IlqrPlanner`](super::predictive::IlqrPlanner) also simulates that many trajectories at the
    /// same time, while [`Ilqr::solve`] simulates in all threads of rayon's pool. The result does
    /// not depend on it.
    pub threads: usize,
    /// Step sizes of the line search, as fractions of the feedforward, in the order of the search.
    /// By default eleven values from 1 to 0.001.
    pub step_sizes: Vec<f64>,
    /// Fraction of the predicted decrease of the cost that ends a line search. The step sizes are
    /// then simulated two at a time. By default infinite: all step sizes are simulated, and the
    /// best is accepted. A finite value such as 0.3 shortens the plans of predictive control.
    pub sufficient_decrease: f64,
}

impl Default for IlqrOptions {
    fn default() -> Self {
        let step_sizes = (0..11).map(|index| 10.0_f64.powf(-0.3 * f64::from(index))).collect();
        Self { iterations: 200, tolerance: 1e-8, threads: 1, step_sizes, sufficient_decrease: f64::INFINITY }
    }
}

impl IlqrOptions {
    /// Checks the tolerance and the options of the line search.
    pub(super) fn check(&self) -> Result<()> {
        if self.tolerance.is_nan() || self.tolerance < 0.0 {
            return Err(Error::out_of_range("tolerance of IlqrOptions", self.tolerance, "zero or more"));
        }
        if self.step_sizes.is_empty() {
            return Err(Error::out_of_range("the number of step_sizes of IlqrOptions", 0, "at least 1"));
        }
        if let Some(size) = self.step_sizes.iter().find(|&&size| !(size > 0.0 && size <= 1.0)) {
            return Err(Error::out_of_range("a step size of IlqrOptions", size, "above 0 and at most 1"));
        }
        if self.sufficient_decrease.is_nan() || self.sufficient_decrease <= 0.0 {
            let found = self.sufficient_decrease;
            return Err(Error::out_of_range("sufficient_decrease of IlqrOptions", found, "above 0"));
        }
        Ok(())
    }
}

with_methods!(IlqrOptions {
    with_iterations(iterations: usize),
    with_tolerance(tolerance: f64),
    with_threads(threads: usize),
    with_step_sizes(step_sizes: impl Into<Vec<f64>>) = step_sizes.into(),
    with_sufficient_decrease(sufficient_decrease: f64),
});

/// Reason for the end of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum IlqrStatus {
    /// The trajectory is a local minimum of the cost, within the tolerance.
    Converged,
    /// No step size lowers the cost at any regularisation: the derivatives do not predict the
    /// simulation, for example because of contacts. The trajectory is the best one found.
    NoDescent,
    /// The search reached the maximum number of iterations. The trajectory is the best one found.
    IterationLimit,
}

impl fmt::Display for IlqrStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::NoDescent => "no step size lowers the cost",
            Self::IterationLimit => "reached the maximum number of iterations",
        })
    }
}

/// Optimised trajectory, with its gains.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct IlqrSolution {
    /// States `(N + 1, nq + nv + na)`, each `[qpos; qvel; act]`.
    pub states: Matrix,
    /// Controls `(N, nu)`, within their ranges.
    pub controls: Matrix,
    /// Feedback gains along the trajectory: `N` matrices, each `(nu, 2 nv + na)`. The rows of
    /// controls at a limit of their range are zero.
    pub gains: Vec<Matrix>,
    /// Cost before the first iteration and after each successful one, in decreasing order.
    pub costs: Vec<f64>,
    /// Reason for the end of the search.
    pub status: IlqrStatus,
}

impl IlqrSolution {
    /// Returns the number of iterations that lowered the cost.
    pub fn iterations(&self) -> usize {
        self.costs.len() - 1
    }
}

impl IlqrSolution {
    /// Returns the cost of the trajectory.
    pub fn cost(&self) -> f64 {
        self.costs[self.costs.len() - 1]
    }

    /// Creates a regulator that follows the trajectory, starting at the present time of a
    /// simulation.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the simulation's model has other sizes.
    pub fn controller(&self, data: &Data) -> Result<TimeVaryingLqr> {
        TimeVaryingLqr::with_gains(data, self.states.clone(), self.controls.clone(), self.gains.clone())
    }
}

/// Trajectory optimiser, with its simulations.
///
/// ```
/// use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, IlqrStatus, QuadraticCost};
/// use mujoco_safe::{Data, LqrWeights, Matrix, sample};
///
/// // Move the cart to 0.5 m in a second, with the pole upright and both at rest.
/// let data = Data::new(sample::cartpole())?;
/// let weights = LqrWeights::diagonal(&[0.1, 0.1, 0.0, 0.0], &[0.01]);
/// let terminal = Matrix::from_diagonal(&[100.0; 4]);
/// let cost = QuadraticCost::new(data.model().clone(), &[0.5, 0.0, 0.0, 0.0], weights, terminal)?;
/// let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default())?;
/// let solution = solver.solve(&data, &Matrix::zeros(100, 1), &cost)?;
/// assert_eq!(solution.status, IlqrStatus::Converged);
/// assert!((solution.states[(100, 0)] - 0.5).abs() < 0.01);
/// assert!(solution.controls.as_slice().iter().all(|ctrl| ctrl.abs() <= 1.0));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct Ilqr {
    options: IlqrOptions,
    lineariser: Lineariser,
    forward: Forward,
}

impl Ilqr {
    /// Creates an optimiser for simulations of this model. Takes a [`Model`](crate::Model), an
    /// `Arc<Model>` or an `&Arc<Model>`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless there is at least one thread and one step size, all step sizes are
    /// above 0 and at most 1, the tolerance is not negative, and the sufficient decrease is above
    /// 0; [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate the
    /// simulations.
    pub fn new(model: impl IntoModel, options: IlqrOptions) -> Result<Self> {
        let model = model.into_model();
        options.check()?;
        let lineariser =
            Lineariser::new(model.clone(), TransitionOptions { threads: options.threads, ..Default::default() })?;
        let forward = Forward::new(model, rayon::current_num_threads());
        Ok(Self { options, lineariser, forward })
    }

    /// Returns the options that the optimiser was created with.
    pub fn options(&self) -> &IlqrOptions {
        &self.options
    }

    /// Minimises the cost of a trajectory of `N` steps from the present state of `data`. The search
    /// starts from the given controls, `(N, nu)`, clamped to their ranges. Applied forces, mocap
    /// poses and user data are the same as in `data` in all steps.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for controls of a wrong shape, [`Error::Invalid`] if there is no step or if
    /// a cost or a derivative of it is not finite, [`Error::OtherModel`] for a simulation of a
    /// model that was loaded separately, the errors of [`Data::step`] for the trajectory of the
    /// given controls, the errors of the cost, for example of a [`QuadraticCost`] for a model with
    /// other sizes, and the errors of [`Lineariser::along`].
    ///
    /// # Panics
    ///
    /// If the cost panics.
    pub fn solve(&mut self, data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> Result<IlqrSolution> {
        let model = data.model();
        let steps = controls.nrows();
        if steps == 0 {
            return Err(Error::out_of_range("the number of steps of a trajectory", 0, "at least 1"));
        }
        Error::check_shape("the controls of Ilqr::solve", controls.shape(), (steps, model.nu()))?;
        let mut search = Search::new(model, steps, self.lineariser.options().method)?;
        self.forward.start(data, cost)?;
        self.forward.nominal(controls, cost, &mut search.nominal)?;
        let mut costs = vec![search.nominal.cost];
        let mut status = IlqrStatus::IterationLimit;
        for _ in 0..self.options.iterations {
            search.expand(data, cost, &mut self.lineariser)?;
            let end = search.iterate(cost, &mut self.forward, &self.options, usize::MAX)?;
            if search.nominal.cost < costs[costs.len() - 1] {
                costs.push(search.nominal.cost);
            }
            if let Some(end) = end {
                status = end;
                break;
            }
        }
        search.finish(data, cost, &mut self.lineariser)?;
        let Search { nominal: Trial { states, controls, .. }, policy, .. } = search;
        Ok(IlqrSolution { states, controls, gains: policy.gains, costs, status })
    }
}
