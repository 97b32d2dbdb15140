//! Trajectory optimisation: the iterative linear-quadratic regulator (iLQR) with control limits.
//!
//! Among the trajectories of `N` steps from a given state, [`Ilqr::solve`] finds a local minimum of a cost, starting from given
//! controls. Each iteration
//!
//! 1. linearises each step, several in parallel ([`Lineariser::along`]), and expands the cost to second order;
//! 2. computes the optimal change of the controls in a backward pass: in each step it solves a quadratic programme whose box
//!    constraints are the control ranges, which yields a feedforward and a gain;
//! 3. simulates the new controls with several step sizes, as one batch of [rollouts](crate::rollout), and accepts the best
//!    trajectory if its cost is lower. Otherwise it repeats the backward pass with a larger regularisation.
//!
//! The result is a trajectory and a table of gains for a controller that follows it: [`IlqrSolution::controller`].
//!
//! The method is differential dynamic programming without the second derivatives of the dynamics.
//!
//! # Sources
//!
//! * W. Li, E. Todorov, *Iterative linear quadratic regulator design for nonlinear biological movement systems*, ICINCO 2004.
//! * Y. Tassa, T. Erez, E. Todorov, *Synthesis and stabilization of complex behaviors through online trajectory optimization*,
//!   IROS 2012: the regularisation of the states, and its schedule.
//! * Y. Tassa, N. Mansard, E. Todorov, *Control-limited differential dynamic programming*, ICRA 2014: the control limits.

mod backward;
mod cost;
mod forward;

use std::fmt;

use self::backward::{AffinePolicy, Backward};
pub use self::cost::{CostExpansion, QuadraticCost, TrajectoryCost};
use self::forward::{Forward, Trial};
use super::TimeVaryingLqr;
use crate::data::{Data, StateSpec};
use crate::derivative::{LinearisationReport, Lineariser, StateSpace, TransitionOptions};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::IntoModel;
use crate::with_methods::with_methods;

/// Smallest non-zero regularisation.
const MIN_REGULARISATION: f64 = 1e-6;
/// Regularisation above which the search ends.
const MAX_REGULARISATION: f64 = 1e10;
/// Initial factor by which the regularisation grows and shrinks.
const REGULARISATION_FACTOR: f64 = 1.6;

/// Options of [`Ilqr`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IlqrOptions {
    /// Maximum number of iterations; 200 by default.
    pub iterations: usize,
    /// Relative decrease of the cost, achieved or predicted, below which the search has converged; 1e-8 by default.
    pub tolerance: f64,
    /// Maximum number of steps that are linearised at the same time, as in [`TransitionOptions::threads`]. The result does not
    /// depend on it.
    pub threads: usize,
    /// Step sizes of the line search, as fractions of the feedforward. By default eleven values from 1 to 0.001.
    pub step_sizes: Vec<f64>,
}

impl Default for IlqrOptions {
    fn default() -> Self {
        let step_sizes = (0..11).map(|index| 10.0_f64.powf(-0.3 * f64::from(index))).collect();
        Self { iterations: 200, tolerance: 1e-8, threads: 1, step_sizes }
    }
}

with_methods!(IlqrOptions {
    with_iterations(iterations: usize),
    with_tolerance(tolerance: f64),
    with_threads(threads: usize),
    with_step_sizes(step_sizes: impl Into<Vec<f64>>) = step_sizes.into(),
});

/// Reason for the end of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum IlqrStatus {
    /// The trajectory is a local minimum of the cost, within the tolerance.
    Converged,
    /// No step size lowers the cost at any regularisation: the derivatives do not predict the simulation, for example because of
    /// contacts. The trajectory is the best one found.
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
    /// Feedback gains along the trajectory: `N` matrices, each `(nu, 2 nv + na)`. The rows of controls at a limit of their range
    /// are zero.
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

    /// Creates a regulator that follows the trajectory, starting at the present time of a simulation.
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
/// use nalgebra::DMatrix;
///
/// // Move the cart to 0.5 m in a second, with the pole upright and both at rest.
/// let data = Data::new(sample::cartpole())?;
/// let weights = LqrWeights::diagonal(&[0.1, 0.1, 0.0, 0.0], &[0.01]);
/// let terminal = DMatrix::identity(4, 4) * 100.0;
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
    /// Creates an optimiser for simulations of this model. Takes a [`Model`](crate::Model) or an `Arc<Model>`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless there is at least one thread and one step size, all step sizes are above 0 and at most 1, and
    /// the tolerance is not negative; [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate the simulations.
    pub fn new(model: impl IntoModel, options: IlqrOptions) -> Result<Self> {
        let model = model.into_model();
        if options.tolerance.is_nan() || options.tolerance < 0.0 {
            return Err(Error::invalid("tolerance of IlqrOptions", options.tolerance, "zero or more"));
        }
        if options.step_sizes.is_empty() {
            return Err(Error::invalid("the number of step_sizes of IlqrOptions", 0, "at least 1"));
        }
        if let Some(size) = options.step_sizes.iter().find(|&&size| !(size > 0.0 && size <= 1.0)) {
            return Err(Error::invalid("a step size of IlqrOptions", size, "above 0 and at most 1"));
        }
        let lineariser =
            Lineariser::new(model.clone(), TransitionOptions { threads: options.threads, ..Default::default() })?;
        Ok(Self { options, lineariser, forward: Forward::new(model) })
    }

    /// Returns the options that the optimiser was created with.
    pub fn options(&self) -> &IlqrOptions {
        &self.options
    }

    /// Minimises the cost of a trajectory of `N` steps from the present state of `data`. The search starts from the given
    /// controls, `(N, nu)`, clamped to their ranges. Applied forces, mocap poses and user data are those of `data` in all steps.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for controls of a wrong shape, [`Error::Invalid`] if there is no step or if a cost or a derivative of it is
    /// not finite, [`Error::OtherModel`] for a simulation of a model that was loaded separately, the errors of [`Data::step`]
    /// for the trajectory of the given controls, those of the cost, for example of a [`QuadraticCost`] for a model with other sizes,
    /// and those of [`Lineariser::along`].
    ///
    /// # Panics
    ///
    /// If the cost panics.
    pub fn solve(&mut self, data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> Result<IlqrSolution> {
        let model = data.model();
        let steps = controls.nrows();
        if steps == 0 {
            return Err(Error::invalid("the number of steps of a trajectory", 0, "at least 1"));
        }
        Error::check_shape("the controls of Ilqr::solve", controls.shape(), (steps, model.nu()))?;
        let method = self.lineariser.options().method;
        let mut nominal = Trial::zeros(model, steps);
        self.forward.nominal(data, controls, cost, &mut nominal)?;
        let mut search = Search {
            data,
            cost,
            costs: vec![nominal.cost],
            nominal,
            backward: Backward::new(model, steps),
            policy: AffinePolicy::zeros(model, steps),
            starts: Matrix::zeros(steps, model.state_size(StateSpec::PHYSICS)),
            systems: vec![(StateSpace::zeros(model), LinearisationReport::new(method, None)); steps],
            regularisation: Regularisation::default(),
        };
        let mut status = IlqrStatus::IterationLimit;
        for _ in 0..self.options.iterations {
            search.expand(&mut self.lineariser)?;
            if let Some(end) = search.iterate(&mut self.forward, &self.options)? {
                status = end;
                break;
            }
        }
        search.finish(&mut self.lineariser)?;
        let Search { nominal: Trial { states, controls, .. }, policy, costs, .. } = search;
        Ok(IlqrSolution { states, controls, gains: policy.gains, costs, status })
    }
}

/// State of a search.
struct Search<'s> {
    data: &'s Data,
    cost: &'s dyn TrajectoryCost,
    nominal: Trial,
    costs: Vec<f64>,
    backward: Backward,
    policy: AffinePolicy,
    /// States in which the steps start.
    starts: Matrix,
    systems: Vec<(StateSpace, LinearisationReport)>,
    regularisation: Regularisation,
}

impl Search<'_> {
    /// Linearises the steps and expands the cost along the trajectory.
    fn expand(&mut self, lineariser: &mut Lineariser) -> Result<()> {
        let values = self.starts.as_mut_slice();
        values.copy_from_slice(&self.nominal.states.as_slice()[..values.len()]);
        // The cost does not depend on the sensors.
        let (starts, controls) = (&self.starts, &self.nominal.controls);
        lineariser.along_without_sensors_into(self.data, starts, controls, &mut self.systems)?;
        self.backward.expand(&self.nominal, self.cost, lineariser.options().threads)
    }

    /// Finds a better trajectory, and increases the regularisation until it succeeds. If the search ends, returns the reason.
    fn iterate(&mut self, forward: &mut Forward, options: &IlqrOptions) -> Result<Option<IlqrStatus>> {
        let least = options.tolerance * self.nominal.cost.abs();
        let mut first_decrease = None;
        loop {
            let regularisation = self.regularisation.value;
            let decrease = self.backward.solve(&self.systems, &self.nominal, regularisation, &mut self.policy)?;
            if let Some(decrease) = decrease.map(|decrease| decrease.at(1.0)) {
                let first = *first_decrease.get_or_insert(decrease);
                if decrease <= least && (first <= least || regularisation > MIN_REGULARISATION) {
                    // A negligible decrease without additional regularisation means convergence.
                    return Ok(Some(if first <= least { IlqrStatus::Converged } else { IlqrStatus::NoDescent }));
                }
                let before = self.nominal.cost;
                if forward.improve(&self.policy, &options.step_sizes, self.cost, &mut self.nominal)? {
                    let gain = before - self.nominal.cost;
                    self.costs.push(self.nominal.cost);
                    self.regularisation.lower();
                    let converged = gain <= least && regularisation <= MIN_REGULARISATION;
                    return Ok(converged.then_some(IlqrStatus::Converged));
                }
            }
            if !self.regularisation.raise() {
                return Ok(Some(IlqrStatus::NoDescent));
            }
        }
    }

    /// Computes the gains along the final trajectory, with as little regularisation as possible.
    fn finish(&mut self, lineariser: &mut Lineariser) -> Result<()> {
        self.expand(lineariser)?;
        let mut regularisation = Regularisation::default();
        while self.backward.solve(&self.systems, &self.nominal, regularisation.value, &mut self.policy)?.is_none() {
            if !regularisation.raise() {
                self.policy = AffinePolicy::zeros(self.data.model(), self.nominal.controls.nrows());
                break;
            }
        }
        Ok(())
    }
}

/// Regularisation weight with its schedule (Tassa, Erez and Todorov, 2012).
#[derive(Default)]
struct Regularisation {
    value: f64,
    factor: f64,
}

impl Regularisation {
    /// Increases the weight. Returns false above the maximum.
    fn raise(&mut self) -> bool {
        self.factor = (self.factor * REGULARISATION_FACTOR).max(REGULARISATION_FACTOR);
        self.value = (self.value * self.factor).max(MIN_REGULARISATION);
        self.value <= MAX_REGULARISATION
    }

    /// Decreases the weight, to zero below the minimum.
    fn lower(&mut self) {
        self.factor = (self.factor / REGULARISATION_FACTOR).min(1.0 / REGULARISATION_FACTOR);
        self.value *= self.factor;
        if self.value < MIN_REGULARISATION {
            self.value = 0.0;
        }
    }
}
