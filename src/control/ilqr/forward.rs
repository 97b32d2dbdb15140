//! The forward pass: parallel simulations from one state, each under its own control law. iLQR
//! simulates the policy of the backward pass with several step sizes, and a planner by sampling its
//! candidates.

use std::sync::Arc;

use super::IlqrOptions;
use super::cost::TrajectoryCost;
use super::policy::{AffinePolicy, PredictedDecrease};
use crate::control::feedback::{Feedback, clamp};
use crate::data::{Data, StateSpec};
use crate::derivative;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::parallel::{for_each_item, is_edited};
use crate::rollout::restart;

/// Number of step sizes that a line search with a sufficient decrease simulates at the same time.
/// The result must not depend on the number of threads, so this is a constant. Most of these
/// searches end after the first two step sizes.
const STEP_SIZES_AT_ONCE: usize = 2;

/// Trajectory with its cost.
#[derive(Clone, Debug, Default)]
pub(in crate::control) struct Trial {
    /// `(N + 1, nq + nv + na)`
    pub(in crate::control) states: Matrix,
    /// `(N, nu)`
    pub(in crate::control) controls: Matrix,
    pub(in crate::control) cost: f64,
}

/// The forward pass, with its simulations and buffers.
#[derive(Debug)]
pub(in crate::control) struct Forward {
    model: Arc<Model>,
    threads: usize,
    /// Simulations, one for each thread, created on demand.
    simulations: Vec<Simulation>,
    /// Values of [`StateSpec::INTEGRATION`] at the start.
    start: Vec<f64>,
    /// Trajectories of the last run, or their errors.
    trials: Vec<(Trial, Result<()>)>,
    /// Best trajectory of a line search.
    best: Trial,
}

impl Forward {
    /// Creates a forward pass that simulates in up to `threads` threads.
    pub(in crate::control) fn new(model: Arc<Model>, threads: usize) -> Self {
        let start = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        Self { model, threads, simulations: Vec::new(), start, trials: Vec::new(), best: Trial::default() }
    }

    /// Sets the start of all trajectories to the present state and the inputs of a simulation.
    pub(in crate::control) fn start(&mut self, data: &Data, cost: &dyn TrajectoryCost) -> Result<()> {
        if is_edited(&self.model, data, "the initial data of a trajectory")? {
            self.model = data.model().clone();
            self.simulations.clear();
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.start)?;
        cost.begin(data)
    }

    /// Simulates the trajectory under these controls, clamped to their ranges.
    pub(super) fn nominal(&mut self, controls: &Matrix, cost: &dyn TrajectoryCost, trial: &mut Trial) -> Result<()> {
        self.run(1, controls.nrows(), |_| Law { controls, update: None }, cost)?;
        self.check_first("the cost of the initial trajectory of iLQR")?;
        std::mem::swap(&mut self.trials[0].0, trial);
        Ok(())
    }

    /// Simulates the nominal controls with and without the feedback of the policy, and replaces the
    /// nominal trajectory by the better of both. If both fail, returns the error of the first one.
    pub(super) fn restart(
        &mut self,
        policy: &AffinePolicy,
        cost: &dyn TrajectoryCost,
        nominal: &mut Trial,
    ) -> Result<()> {
        let law = |index: usize| Law {
            controls: &nominal.controls,
            update: (index == 0).then_some(Update { step_size: 0.0, policy, states: &nominal.states }),
        };
        self.run(2, nominal.controls.nrows(), law, cost)?;
        let Some(index) = self.cheapest() else {
            return self.check_first("the cost of the initial trajectory of a plan");
        };
        std::mem::swap(&mut self.trials[index].0, nominal);
        Ok(())
    }

    /// Simulates the policy with each step size, until the cost decreases sufficiently. If the
    /// trajectory of minimal cost improves the nominal one, replaces it and returns `true`.
    pub(super) fn improve(
        &mut self,
        policy: &AffinePolicy,
        decrease: PredictedDecrease,
        options: &IlqrOptions,
        cost: &dyn TrajectoryCost,
        nominal: &mut Trial,
    ) -> Result<bool> {
        let mut least = nominal.cost;
        let IlqrOptions { step_sizes, sufficient_decrease, .. } = options;
        let at_once = if sufficient_decrease.is_finite() { STEP_SIZES_AT_ONCE } else { step_sizes.len() };
        for sizes in step_sizes.chunks(at_once) {
            let law = |index: usize| Law {
                controls: &nominal.controls,
                update: Some(Update { step_size: sizes[index], policy, states: &nominal.states }),
            };
            self.run(sizes.len(), nominal.controls.nrows(), law, cost)?;
            let Some(index) = self.cheapest().filter(|&index| self.trials[index].0.cost < least) else { continue };
            std::mem::swap(&mut self.trials[index].0, &mut self.best);
            least = self.best.cost;
            if nominal.cost - least >= sufficient_decrease * decrease.at(sizes[index]) {
                break;
            }
        }
        let improved = least < nominal.cost;
        if improved {
            std::mem::swap(&mut self.best, nominal);
        }
        Ok(improved)
    }

    /// Returns the trajectories of the last run, or their errors. If the run had fewer trajectories
    /// than an earlier one, infinite costs follow.
    pub(in crate::control) fn trials(&mut self) -> &mut [(Trial, Result<()>)] {
        &mut self.trials
    }

    /// Returns the index of the trajectory of minimal cost of the last run. Discards unstable
    /// simulations.
    pub(in crate::control) fn cheapest(&self) -> Option<usize> {
        let stable =
            self.trials.iter().enumerate().filter(|(_, (trial, result))| result.is_ok() && trial.cost.is_finite());
        stable.min_by(|(_, (a, _)), (_, (b, _))| a.cost.total_cmp(&b.cost)).map(|(index, _)| index)
    }

    /// Returns the error of the first trajectory of the last run, if it failed or if its cost is
    /// not finite.
    pub(in crate::control) fn check_first(&mut self, what: &str) -> Result<()> {
        let (trial, result) = &mut self.trials[0];
        std::mem::replace(result, Ok(()))?;
        if trial.cost.is_finite() { Ok(()) } else { Err(Error::not_finite(what, trial.cost)) }
    }

    /// Simulates `count` trajectories, and evaluates their costs.
    pub(in crate::control) fn run<L: ControlLaw>(
        &mut self,
        count: usize,
        steps: usize,
        law: impl Fn(usize) -> L + Sync,
        cost: &dyn TrajectoryCost,
    ) -> Result<()> {
        let Self { model, threads, simulations, start, trials, best } = self;
        while simulations.len() < count.min(*threads) {
            simulations.push(Simulation::new(model.clone())?);
        }
        if trials.len() < count {
            trials.resize_with(count, || (Trial::default(), Ok(())));
        }
        for trial in trials.iter_mut().map(|(trial, _)| trial).chain([best]) {
            if trial.controls.nrows() != steps {
                *trial = Trial::zeros(model, steps);
            }
        }
        let (trials, unused) = trials.split_at_mut(count);
        for (trial, _) in unused {
            trial.cost = f64::INFINITY;
        }
        let threads = simulations.len().min(count);
        for_each_item(&mut simulations[..threads], trials, |simulation, index, (trial, result)| {
            *result = simulation.run(start, &law(index), cost, trial);
            Ok(())
        })
    }
}

impl Trial {
    /// Creates a trajectory of zeros.
    pub(in crate::control) fn zeros(model: &Model, steps: usize) -> Self {
        let states = Matrix::zeros(steps + 1, model.state_size(StateSpec::PHYSICS));
        Self { states, controls: Matrix::zeros(steps, model.nu()), cost: 0.0 }
    }
}

/// Simulation that trajectories run in, one after another.
#[derive(Debug)]
struct Simulation {
    data: Data,
    feedback: Feedback,
}

impl Simulation {
    fn new(model: Arc<Model>) -> Result<Self> {
        let (nx, ..) = derivative::sizes(&model);
        Ok(Self { data: Data::new(model)?, feedback: Feedback::new(nx) })
    }

    /// Simulates a trajectory, and evaluates its cost.
    fn run(
        &mut self,
        start: &[f64],
        law: &impl ControlLaw,
        cost: &dyn TrajectoryCost,
        trial: &mut Trial,
    ) -> Result<()> {
        let Self { data, feedback } = self;
        // The result must not depend on the earlier use of the simulation, which may have become
        // unstable.
        restart(data)?;
        data.set_state(StateSpec::INTEGRATION, start)?;
        data.physics_state_into(trial.states.row_mut(0))?;
        for step in 0..trial.controls.nrows() {
            law.apply(step, data, feedback)?;
            data.step()?;
            trial.controls.row_mut(step).copy_from_slice(data.ctrl());
            data.physics_state_into(trial.states.row_mut(step + 1))?;
        }
        trial.cost = cost.total(trial.states.view(), trial.controls.view())?;
        Ok(())
    }
}

/// Control law of a trajectory.
pub(in crate::control) trait ControlLaw {
    /// Sets the controls of a step, within their ranges. `feedback` is a buffer.
    fn apply(&self, step: usize, data: &mut Data, feedback: &mut Feedback) -> Result<()>;
}

/// Nominal controls, with or without the update by a policy.
struct Law<'p> {
    controls: &'p Matrix,
    update: Option<Update<'p>>,
}

struct Update<'p> {
    step_size: f64,
    policy: &'p AffinePolicy,
    /// Nominal states, which the feedback refers to.
    states: &'p Matrix,
}

impl ControlLaw for Law<'_> {
    fn apply(&self, step: usize, data: &mut Data, feedback: &mut Feedback) -> Result<()> {
        data.ctrl_mut().copy_from_slice(self.controls.row(step));
        if let Some(Update { step_size, policy, states }) = &self.update {
            let (nq, nv) = (data.model().nq(), data.model().nv());
            let state = states.row(step);
            feedback.measure(data, &state[..nq], Some(&state[nq..nq + nv]), &state[nq + nv..])?;
            for (ctrl, change) in data.ctrl_mut().iter_mut().zip(policy.feedforward.row(step)) {
                *ctrl += step_size * change;
            }
            feedback.subtract(&policy.gains[step], data.ctrl_mut());
        }
        clamp(data);
        Ok(())
    }
}
