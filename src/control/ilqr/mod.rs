//! Trajectories of least cost: the iterative linear-quadratic regulator, with controls that stay within their ranges.
//!
//! Of all trajectories of `N` steps that begin in a given state, [`Ilqr::solve`] looks for one that costs the least, near the one
//! that it is given controls for. In each iteration
//!
//! 1. each step is linearised, several at a time in parallel ([`Lineariser::along`]), and the cost is expanded to second order;
//! 2. from the end to the beginning, the change of the controls that costs the least is found: in each step a quadratic
//!    programme in the box that the ranges of the controls make, whose solution is a feedforward and a gain;
//! 3. the new controls are tried with several step sizes at a time, as one batch of [rollouts](crate::rollout), and the
//!    best is taken, if it is better than what there was. If none is, the changes are made more costly (regularisation).
//!
//! What comes out is a trajectory and a table of gains that keeps a simulation on it: [`IlqrSolution::controller`].
//!
//! This is differential dynamic programming without the second derivatives of the dynamics.
//!
//! # Sources
//!
//! * W. Li, E. Todorov, *Iterative linear quadratic regulator design for nonlinear biological movement systems*, ICINCO 2004.
//! * Y. Tassa, T. Erez, E. Todorov, *Synthesis and stabilization of complex behaviors through online trajectory optimization*,
//!   IROS 2012: the regularisation of the states, and its schedule.
//! * Y. Tassa, N. Mansard, E. Todorov, *Control-limited differential dynamic programming*, ICRA 2014: the box.
//!
//! | file | what is in it |
//! |---|---|
//! | `cost.rs` | what a trajectory costs |
//! | `backward.rs` | how to change the controls |
//! | `forward.rs` | what comes of it |

mod backward;
mod cost;
mod forward;

use std::fmt;
use std::sync::Arc;

use self::backward::{Backward, Plan};
pub use self::cost::{CostExpansion, QuadraticCost, TrajectoryCost};
use self::forward::{Forward, Trial};
use super::TimeVaryingLqr;
use crate::data::{Data, StateSpec};
use crate::derivative::{LinearisationReport, Lineariser, StateSpace, TransitionOptions};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// The regularisation that is tried first, when one is needed at all; how fast it grows and shrinks; and where it ends.
const LEAST_REGULARISATION: f64 = 1e-6;
const MOST_REGULARISATION: f64 = 1e10;
const REGULARISATION_FACTOR: f64 = 1.6;

/// How [`Ilqr`] looks for a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct IlqrOptions {
    /// How many iterations there are at most: 200 unless it is changed.
    pub iterations: usize,
    /// The search has converged when an iteration lowers the cost by less than this part of it, or when nothing more than that
    /// is promised: 1e-8 unless it is changed.
    pub tolerance: f64,
    /// How many steps are linearised at the same time, at most, as in [`TransitionOptions::threads`]. The result does not
    /// depend on it.
    pub threads: usize,
    /// The parts of the change of controls that are tried. If nothing is said, eleven numbers from 1 down to 0.001.
    pub step_sizes: Vec<f64>,
}

impl Default for IlqrOptions {
    fn default() -> Self {
        let step_sizes = (0..11).map(|index| 10.0_f64.powf(-0.3 * f64::from(index))).collect();
        Self { iterations: 200, tolerance: 1e-8, threads: 1, step_sizes }
    }
}

/// How the search has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum IlqrStatus {
    /// At a trajectory near which there is none that costs less, as far as the tolerance goes.
    Converged,
    /// No step size gains anything, however costly changes are made: the derivatives do not describe what happens, because of
    /// contacts, say. The trajectory is the best that was found.
    NoDescent,
    /// There were as many iterations as allowed. The trajectory is the best that was found.
    IterationLimit,
}

impl fmt::Display for IlqrStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::NoDescent => "no step size gains anything",
            Self::IterationLimit => "stopped at the limit of iterations",
        })
    }
}

/// A trajectory, and how it was found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct IlqrSolution {
    /// The states `(N + 1, nq + nv + na)`, each `[qpos; qvel; act]`.
    pub states: Matrix,
    /// The controls `(N, nu)`, within their ranges.
    pub controls: Matrix,
    /// The gains of the feedback that keeps a simulation on the trajectory: `N` of them, each `(nu, 2 nv + na)`. Rows of controls
    /// that are at the end of their range are zero.
    pub gains: Vec<Matrix>,
    /// What the trajectory costs, before the first iteration and after each: it only falls.
    pub costs: Vec<f64>,
    /// How the search has ended.
    pub status: IlqrStatus,
}

impl IlqrSolution {
    /// What the trajectory costs.
    pub fn cost(&self) -> f64 {
        self.costs[self.costs.len() - 1]
    }

    /// The regulator that has a simulation follow the trajectory from its present time on.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a simulation of a model of other sizes.
    pub fn controller(&self, data: &Data) -> Result<TimeVaryingLqr> {
        TimeVaryingLqr::with_gains(data, self.states.clone(), self.controls.clone(), self.gains.clone())
    }
}

/// The solver, with the simulations that it works in.
///
/// ```
/// use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, IlqrStatus, QuadraticCost};
/// use mujoco_safe::{Data, LqrWeights, Matrix, sample};
/// use nalgebra::DMatrix;
///
/// // The cart is to be at 0.5 m in a second, with the pole upright and both at rest.
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
    transition: Lineariser,
    forward: Forward,
}

impl Ilqr {
    /// A solver for simulations of this model. Takes a [`Model`] or an `Arc<Model>`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless there is at least one thread and one step size, all step sizes are above 0 and at most 1, and
    /// the tolerance is not negative; [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate the simulations.
    pub fn new(model: impl Into<Arc<Model>>, options: IlqrOptions) -> Result<Self> {
        let model = model.into();
        if options.tolerance.is_nan() || options.tolerance < 0.0 {
            return Err(Error::invalid("tolerance of IlqrOptions", options.tolerance, "zero or more"));
        }
        if options.step_sizes.is_empty() {
            return Err(Error::invalid("the number of step_sizes of IlqrOptions", 0, "at least 1"));
        }
        if let Some(size) = options.step_sizes.iter().find(|&&size| !(size > 0.0 && size <= 1.0)) {
            return Err(Error::invalid("a step size of IlqrOptions", size, "above 0 and at most 1"));
        }
        let transition =
            Lineariser::new(model.clone(), TransitionOptions { threads: options.threads, ..Default::default() })?;
        Ok(Self { options, transition, forward: Forward::new(model) })
    }

    /// What it was made with.
    pub fn options(&self) -> &IlqrOptions {
        &self.options
    }

    /// Looks for the trajectory of `N` steps that begins in the present state of `data` and costs the least. The search begins
    /// with the given controls, `(N, nu)`, cut off at the ends of their ranges. Applied forces, mocap poses and user data are
    /// those of `data` in all steps.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for controls of a wrong shape, [`Error::Invalid`] if there is not one step or if a cost or a derivative of
    /// it is not finite, [`Error::OtherModel`] for a simulation of a model that was loaded separately, the errors of
    /// [`Data::step`] for the trajectory that the given controls make, and those of [`Lineariser::along`].
    ///
    /// # Panics
    ///
    /// If the cost does, as a [`QuadraticCost`] does that was made for a model of other sizes.
    pub fn solve(&mut self, data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> Result<IlqrSolution> {
        let model = data.model();
        let steps = controls.nrows();
        if steps == 0 {
            return Err(Error::invalid("the number of steps of a trajectory", 0, "at least 1"));
        }
        Error::check_shape("the controls of Ilqr::solve", controls.shape(), (steps, model.nu()))?;
        let method = self.transition.options().method;
        let nominal = self.forward.nominal(data, controls, cost)?;
        let mut search = Search {
            data,
            cost,
            costs: vec![nominal.cost],
            nominal,
            backward: Backward::new(model, steps),
            plan: Plan::zeros(model, steps),
            begins: Matrix::zeros(steps, model.state_size(StateSpec::PHYSICS)),
            systems: vec![(StateSpace::zeros(model), LinearisationReport { method, fallback: None }); steps],
            regularisation: Regularisation::default(),
        };
        let mut status = IlqrStatus::IterationLimit;
        for _ in 0..self.options.iterations {
            search.expand(&mut self.transition)?;
            if let Some(end) = search.iterate(&self.forward, &self.options)? {
                status = end;
                break;
            }
        }
        search.finish(&mut self.transition)?;
        let Search { nominal: Trial { states, controls, .. }, plan, costs, .. } = search;
        Ok(IlqrSolution { states, controls, gains: plan.gains, costs, status })
    }
}

/// A search, and how far it has come.
struct Search<'s> {
    data: &'s Data,
    cost: &'s dyn TrajectoryCost,
    nominal: Trial,
    costs: Vec<f64>,
    backward: Backward,
    plan: Plan,
    /// The states in which steps begin.
    begins: Matrix,
    systems: Vec<(StateSpace, LinearisationReport)>,
    regularisation: Regularisation,
}

impl Search<'_> {
    /// Linearises the steps, and expands the cost, along the trajectory.
    fn expand(&mut self, transition: &mut Lineariser) -> Result<()> {
        let values = self.begins.as_mut_slice();
        values.copy_from_slice(&self.nominal.states.as_slice()[..values.len()]);
        transition.along_into(self.data, &self.begins, &self.nominal.controls, &mut self.systems)?;
        self.backward.expand(&self.nominal, self.cost)
    }

    /// Finds a better trajectory, with as much regularisation as that takes, or says why there is an end.
    fn iterate(&mut self, forward: &Forward, options: &IlqrOptions) -> Result<Option<IlqrStatus>> {
        let least = options.tolerance * self.nominal.cost.abs();
        let mut first_promise = None;
        loop {
            let regularisation = self.regularisation.value;
            let plan = self.backward.plan(&self.systems, &self.nominal, regularisation, &mut self.plan)?;
            if let Some(promise) = plan.map(|promise| promise.at(1.0)) {
                let first = *first_promise.get_or_insert(promise);
                if promise <= least && (first <= least || regularisation > LEAST_REGULARISATION) {
                    // Where nothing worth while was promised to begin with, there is nothing to gain.
                    return Ok(Some(if first <= least { IlqrStatus::Converged } else { IlqrStatus::NoDescent }));
                }
                let best = forward.best(self.data, &self.nominal, &self.plan, &options.step_sizes, self.cost)?;
                if let Some(best) = best.filter(|best| best.cost < self.nominal.cost) {
                    let gain = self.nominal.cost - best.cost;
                    self.costs.push(best.cost);
                    self.nominal = best;
                    self.regularisation.lower();
                    let converged = gain <= least && regularisation <= LEAST_REGULARISATION;
                    return Ok(converged.then_some(IlqrStatus::Converged));
                }
            }
            if !self.regularisation.raise() {
                return Ok(Some(IlqrStatus::NoDescent));
            }
        }
    }

    /// Finds the gains along the trajectory that there is in the end, with no more regularisation than that takes.
    fn finish(&mut self, transition: &mut Lineariser) -> Result<()> {
        self.expand(transition)?;
        let mut regularisation = Regularisation::default();
        while self.backward.plan(&self.systems, &self.nominal, regularisation.value, &mut self.plan)?.is_none() {
            if !regularisation.raise() {
                self.plan = Plan::zeros(self.data.model(), self.nominal.controls.nrows());
                break;
            }
        }
        Ok(())
    }
}

/// How much more than they cost changes are made to cost.
#[derive(Default)]
struct Regularisation {
    value: f64,
    factor: f64,
}

impl Regularisation {
    /// False if it is as large as it gets.
    fn raise(&mut self) -> bool {
        self.factor = (self.factor * REGULARISATION_FACTOR).max(REGULARISATION_FACTOR);
        self.value = (self.value * self.factor).max(LEAST_REGULARISATION);
        self.value <= MOST_REGULARISATION
    }

    fn lower(&mut self) {
        self.factor = (self.factor / REGULARISATION_FACTOR).min(1.0 / REGULARISATION_FACTOR);
        self.value *= self.factor;
        if self.value < LEAST_REGULARISATION {
            self.value = 0.0;
        }
    }
}
