//! The forward pass: simulations under the policy of the backward pass, with several step sizes.

use std::sync::Arc;

use super::backward::AffinePolicy;
use super::cost::TrajectoryCost;
use crate::control::feedback::{Feedback, clamp};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::derivative::{self, for_each_item};
use crate::error::{Error, Result};
use crate::matrix::{Matrix, MatrixView};
use crate::model::Model;
use crate::rollout::{Rollout, RolloutBuffers, RolloutError, Workers};

/// Trajectory with its cost.
#[derive(Clone, Debug)]
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
    workers: Workers,
    /// Values of [`StateSpec::INTEGRATION`] at the start.
    start: Vec<f64>,
    /// States and controls of all trials of a run, one after another.
    states: Vec<f64>,
    controls: Vec<f64>,
    /// Costs of the trials, or the errors of their simulations.
    costs: Vec<Result<f64>>,
}

impl Forward {
    pub(in crate::control) fn new(model: Arc<Model>) -> Self {
        let start = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        Self { workers: Workers::new(model), start, states: Vec::new(), controls: Vec::new(), costs: Vec::new() }
    }

    /// Sets the start of all trajectories to the present state and the inputs of a simulation.
    pub(in crate::control) fn start(&mut self, data: &Data, cost: &dyn TrajectoryCost) -> Result<()> {
        if !data.model().is_same_structure(self.workers.model()) {
            return Err(Error::OtherModel { what: "the initial data of a trajectory" });
        }
        if !Arc::ptr_eq(data.model(), self.workers.model()) {
            // The model may have been edited since.
            self.workers = Workers::new(data.model().clone());
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.start)?;
        cost.begin(data)
    }

    /// Simulates the trajectory under these controls, clamped to their ranges.
    pub(super) fn nominal(&mut self, controls: &Matrix, cost: &dyn TrajectoryCost, trial: &mut Trial) -> Result<()> {
        self.run(1, controls.nrows(), |_| PolicyController { controls, update: None, step: 0 }, cost)?;
        let value = self.costs.swap_remove(0)?;
        if !value.is_finite() {
            return Err(Error::invalid("the cost of the initial trajectory of iLQR", value, "finite"));
        }
        self.copy_to(0, value, trial);
        Ok(())
    }

    /// Simulates the nominal controls with and without the feedback of the policy, and replaces the nominal trajectory by the better
    /// of both. If both fail, returns the error of the first one.
    pub(super) fn restart(
        &mut self,
        policy: &AffinePolicy,
        cost: &dyn TrajectoryCost,
        nominal: &mut Trial,
    ) -> Result<()> {
        let (nx, ..) = derivative::sizes(self.workers.model());
        let controller = |index: usize| PolicyController {
            controls: &nominal.controls,
            update: (index == 0).then(|| Update {
                step_size: 0.0,
                policy,
                states: &nominal.states,
                feedback: Feedback::new(nx),
            }),
            step: 0,
        };
        self.run(2, nominal.controls.nrows(), controller, cost)?;
        let Some((index, value)) = self.best() else {
            let value = self.costs.swap_remove(0)?;
            return Err(Error::invalid("the cost of the initial trajectory of a plan", value, "finite"));
        };
        self.copy_to(index, value, nominal);
        Ok(())
    }

    /// Returns the trajectory of minimal cost of the last run, with its cost. Discards unstable simulations.
    fn best(&self) -> Option<(usize, f64)> {
        let costs = self.costs.iter().enumerate().filter_map(|(index, cost)| Some((index, *cost.as_ref().ok()?)));
        costs.filter(|(_, cost)| cost.is_finite()).min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// Simulates the policy with each step size. If the trajectory of minimal cost improves the nominal one, replaces it and returns
    /// true.
    pub(super) fn improve(
        &mut self,
        policy: &AffinePolicy,
        step_sizes: &[f64],
        cost: &dyn TrajectoryCost,
        nominal: &mut Trial,
    ) -> Result<bool> {
        let (nx, ..) = derivative::sizes(self.workers.model());
        let controller = |index: usize| PolicyController {
            controls: &nominal.controls,
            update: Some(Update {
                step_size: step_sizes[index],
                policy,
                states: &nominal.states,
                feedback: Feedback::new(nx),
            }),
            step: 0,
        };
        self.run(step_sizes.len(), nominal.controls.nrows(), controller, cost)?;
        let Some((index, value)) = self.best().filter(|&(_, value)| value < nominal.cost) else { return Ok(false) };
        self.copy_to(index, value, nominal);
        Ok(true)
    }

    /// Copies a trajectory of the last run.
    fn copy_to(&self, index: usize, cost: f64, trial: &mut Trial) {
        let block = |values: &[f64], output: &mut Matrix| {
            let length = output.as_slice().len();
            output.as_mut_slice().copy_from_slice(&values[index * length..][..length]);
        };
        block(&self.states, &mut trial.states);
        block(&self.controls, &mut trial.controls);
        trial.cost = cost;
    }

    /// Simulates trajectories, and evaluates their costs.
    fn run<'p>(
        &mut self,
        count: usize,
        steps: usize,
        controller: impl Fn(usize) -> PolicyController<'p> + Send + Sync,
        cost: &dyn TrajectoryCost,
    ) -> Result<()> {
        let Self { workers, start, states, controls, costs } = self;
        let (nu, width) = (workers.model().nu(), workers.model().state_size(StateSpec::PHYSICS));
        let (of_states, of_controls) = ((steps + 1) * width, steps * nu);
        states.resize(count * of_states, 0.0);
        controls.resize(count * of_controls, 0.0);
        let buffers = RolloutBuffers { states: Some(states), outputs: Some(controls), ..Default::default() };
        let outcomes = Rollout::on(workers, count, steps)
            .initial_state(StateSpec::INTEGRATION, start)
            .controllers(controller)
            .outputs(nu, |data, row| row.copy_from_slice(data.ctrl()))
            .run_into(buffers)?;
        costs.clear();
        costs.extend(outcomes.into_iter().map(|outcome| match outcome {
            Ok(()) => Ok(0.0),
            Err(RolloutError::Failed { error, .. }) => Err(error),
            Err(RolloutError::Cancelled { .. }) => unreachable!("Bug: a run without a progress hook was cancelled"),
        }));
        for_each_item(&mut vec![(); rayon::current_num_threads()], costs, |(), index, value| {
            if value.is_ok() {
                let states = MatrixView::from_row_major(steps + 1, width, &states[index * of_states..][..of_states]);
                let controls = MatrixView::from_row_major(steps, nu, &controls[index * of_controls..][..of_controls]);
                *value = cost.total(states, controls);
            }
            Ok(())
        })
    }
}

impl Trial {
    /// Creates a trajectory of zeros.
    pub(super) fn zeros(model: &Model, steps: usize) -> Self {
        let states = Matrix::zeros(steps + 1, model.state_size(StateSpec::PHYSICS));
        Self { states, controls: Matrix::zeros(steps, model.nu()), cost: 0.0 }
    }
}

/// Controller of a trial: the nominal controls, with or without the update by a policy.
struct PolicyController<'p> {
    controls: &'p Matrix,
    update: Option<Update<'p>>,
    step: usize,
}

struct Update<'p> {
    step_size: f64,
    policy: &'p AffinePolicy,
    /// Nominal states, which the feedback refers to.
    states: &'p Matrix,
    feedback: Feedback,
}

impl Controller for PolicyController<'_> {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut().copy_from_slice(self.controls.row(self.step));
        if let Some(Update { step_size, policy, states, feedback }) = &mut self.update {
            let (nq, nv) = (data.model().nq(), data.model().nv());
            let state = states.row(self.step);
            feedback.measure(data, &state[..nq], Some(&state[nq..nq + nv]), &state[nq + nv..])?;
            for (ctrl, change) in data.ctrl_mut().iter_mut().zip(policy.feedforward.row(self.step)) {
                *ctrl += *step_size * change;
            }
            feedback.subtract(&policy.gains[self.step], data.ctrl_mut());
        }
        clamp(data);
        self.step += 1;
        Ok(())
    }
}
