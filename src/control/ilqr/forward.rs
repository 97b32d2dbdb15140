//! The forward pass: simulations under the policy of the backward pass, with several step sizes.

use std::sync::Arc;

use super::backward::AffinePolicy;
use super::cost::TrajectoryCost;
use crate::control::feedback::{Feedback, clamp};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::derivative;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::rollout::{Rollout, RolloutBuffers, RolloutError, Workers};

/// Trajectory with its cost.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    /// `(N + 1, nq + nv + na)`
    pub(super) states: Matrix,
    /// `(N, nu)`
    pub(super) controls: Matrix,
    pub(super) cost: f64,
}

/// The forward pass, with its simulations.
#[derive(Debug)]
pub(super) struct Forward {
    workers: Workers,
    /// Values of [`StateSpec::INTEGRATION`] at the start.
    start: Vec<f64>,
}

impl Forward {
    pub(super) fn new(model: Arc<Model>) -> Self {
        let start = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        Self { workers: Workers::new(model), start }
    }

    /// Simulates the trajectory under these controls, clamped to their ranges.
    pub(super) fn nominal(&mut self, data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> Result<Trial> {
        if !data.model().is_same_structure(self.workers.model()) {
            return Err(Error::OtherModel { what: "the initial data of a trajectory" });
        }
        if !Arc::ptr_eq(data.model(), self.workers.model()) {
            // The model may have been edited since.
            self.workers = Workers::new(data.model().clone());
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.start)?;
        let controller = |_| PolicyController { controls, update: None, step: 0 };
        let mut trials = self.run(1, controls.nrows(), controller, cost)?;
        let trial = trials.swap_remove(0)?;
        if trial.cost.is_finite() {
            Ok(trial)
        } else {
            Err(Error::invalid("the cost of the initial trajectory of Ilqr::solve", trial.cost, "finite"))
        }
    }

    /// Simulates the policy with each step size, and returns the trajectory of minimal cost, if any has a finite cost.
    pub(super) fn best(
        &self,
        data: &Data,
        nominal: &Trial,
        policy: &AffinePolicy,
        step_sizes: &[f64],
        cost: &dyn TrajectoryCost,
    ) -> Result<Option<Trial>> {
        let (nx, ..) = derivative::sizes(data.model());
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
        // Discards unstable simulations.
        let trials = self.run(step_sizes.len(), nominal.controls.nrows(), controller, cost)?;
        let trials = trials.into_iter().filter_map(Result::ok);
        Ok(trials.filter(|trial| trial.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost)))
    }

    fn run<'p>(
        &self,
        count: usize,
        steps: usize,
        controller: impl Fn(usize) -> PolicyController<'p> + Send + Sync,
        cost: &dyn TrajectoryCost,
    ) -> Result<Vec<Result<Trial>>> {
        let model = self.workers.model();
        let (nu, width) = (model.nu(), model.state_size(StateSpec::PHYSICS));
        let (mut states, mut controls) = (vec![0.0; count * (steps + 1) * width], vec![0.0; count * steps * nu]);
        let buffers = RolloutBuffers { states: Some(&mut states), outputs: Some(&mut controls), ..Default::default() };
        let outcomes = Rollout::on(&self.workers, count, steps)
            .initial_state(StateSpec::INTEGRATION, &self.start)
            .controllers(controller)
            .outputs(nu, |data, row| row.copy_from_slice(data.ctrl()))
            .run_into(buffers)?;
        let block = |values: &[f64], index: usize, rows: usize, columns: usize| {
            let length = rows * columns;
            Matrix::from_row_major(rows, columns, values[index * length..][..length].to_vec())
        };
        let trials = outcomes.into_iter().enumerate().map(|(index, outcome)| match outcome {
            Ok(()) => Ok(Trial::new(block(&states, index, steps + 1, width), block(&controls, index, steps, nu), cost)),
            Err(RolloutError::Failed { error, .. }) => Err(error),
            Err(RolloutError::Cancelled { .. }) => unreachable!("Bug: a run without a progress hook was cancelled"),
        });
        Ok(trials.collect())
    }
}

impl Trial {
    fn new(states: Matrix, controls: Matrix, cost: &dyn TrajectoryCost) -> Self {
        let steps = controls.nrows();
        let running = (0..steps).map(|step| cost.value(step, states.row(step), Some(controls.row(step)))).sum::<f64>();
        let cost = running + cost.value(steps, states.row(steps), None);
        Self { states, controls, cost }
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
