//! From the beginning to the end: what comes of a change of controls.

use std::sync::Arc;

use super::backward::Plan;
use super::cost::TrajectoryCost;
use crate::control::feedback::{Feedback, clamp};
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::derivative;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::rollout::{Rollout, RolloutBuffers, RolloutError, Workers};

/// A trajectory, and what it costs.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    /// `(N + 1, nq + nv + na)`
    pub(super) states: Matrix,
    /// `(N, nu)`
    pub(super) controls: Matrix,
    pub(super) cost: f64,
}

/// Simulations in which trajectories are tried.
#[derive(Debug)]
pub(super) struct Forward {
    workers: Workers,
    begin: Vec<f64>,
}

impl Forward {
    pub(super) fn new(model: Arc<Model>) -> Self {
        let begin = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        Self { workers: Workers::new(model), begin }
    }

    /// The trajectory under these controls, as far as they are within their ranges.
    pub(super) fn nominal(&mut self, data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> Result<Trial> {
        if !data.model().is_same_structure(self.workers.model()) {
            return Err(Error::OtherModel { what: "the data that a trajectory begins in" });
        }
        if !Arc::ptr_eq(data.model(), self.workers.model()) {
            // A copy that was edited since, perhaps.
            self.workers = Workers::new(data.model().clone());
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.begin)?;
        let policy = |_| Policy { controls, change: None, step: 0 };
        let mut trials = self.run(1, controls.nrows(), policy, cost)?;
        let trial = trials.swap_remove(0)?;
        if trial.cost.is_finite() {
            Ok(trial)
        } else {
            Err(Error::invalid("the cost of the trajectory that Ilqr::solve begins with", trial.cost, "finite"))
        }
    }

    /// The best of the trajectories that come of parts of a change, if there is any that costs a finite amount.
    pub(super) fn best(
        &self,
        data: &Data,
        nominal: &Trial,
        plan: &Plan,
        parts: &[f64],
        cost: &dyn TrajectoryCost,
    ) -> Result<Option<Trial>> {
        let (nx, ..) = derivative::sizes(data.model());
        let policy = |index: usize| Policy {
            controls: &nominal.controls,
            change: Some(Change { part: parts[index], plan, states: &nominal.states, feedback: Feedback::new(nx) }),
            step: 0,
        };
        // One that has become unstable is none to be considered.
        let trials = self.run(parts.len(), nominal.controls.nrows(), policy, cost)?.into_iter().filter_map(Result::ok);
        Ok(trials.filter(|trial| trial.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost)))
    }

    fn run<'p>(
        &self,
        count: usize,
        steps: usize,
        policy: impl Fn(usize) -> Policy<'p> + Send + Sync,
        cost: &dyn TrajectoryCost,
    ) -> Result<Vec<Result<Trial>>> {
        let model = self.workers.model();
        let (nu, width) = (model.nu(), model.state_size(StateSpec::PHYSICS));
        let (mut states, mut controls) = (vec![0.0; count * (steps + 1) * width], vec![0.0; count * steps * nu]);
        let buffers = RolloutBuffers { states: Some(&mut states), outputs: Some(&mut controls), ..Default::default() };
        let outcomes = Rollout::on(&self.workers, count, steps)
            .initial_state(StateSpec::INTEGRATION, &self.begin)
            .controllers(policy)
            .outputs(nu, |data, row| row.copy_from_slice(data.ctrl()))
            .run_into(buffers)?;
        let block = |values: &[f64], index: usize, rows: usize, columns: usize| {
            let length = rows * columns;
            Matrix::from_row_major(rows, columns, values[index * length..][..length].to_vec())
        };
        let trials = outcomes.into_iter().enumerate().map(|(index, outcome)| match outcome {
            Ok(()) => Ok(Trial::new(block(&states, index, steps + 1, width), block(&controls, index, steps, nu), cost)),
            Err(RolloutError::Failed { error, .. }) => Err(error),
            Err(RolloutError::Cancelled { .. }) => unreachable!("Bug: nobody cancels"),
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

/// The controls of a trial.
struct Policy<'p> {
    controls: &'p Matrix,
    change: Option<Change<'p>>,
    step: usize,
}

struct Change<'p> {
    part: f64,
    plan: &'p Plan,
    states: &'p Matrix,
    feedback: Feedback,
}

impl Controller for Policy<'_> {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut().copy_from_slice(self.controls.row(self.step));
        if let Some(Change { part, plan, states, feedback }) = &mut self.change {
            let (nq, nv) = (data.model().nq(), data.model().nv());
            let state = states.row(self.step);
            feedback.measure(data, &state[..nq], Some(&state[nq..nq + nv]), &state[nq + nv..])?;
            for (ctrl, change) in data.ctrl_mut().iter_mut().zip(plan.feedforward.row(self.step)) {
                *ctrl += *part * change;
            }
            feedback.subtract(&plan.gains[self.step], data.ctrl_mut());
        }
        clamp(data);
        self.step += 1;
        Ok(())
    }
}
