//! Results of rollouts, and the buffers that hold them.

use crate::error::{Error, Result, debug_as_display};
use crate::matrix::MatrixView;
use crate::memory::no_room;

/// Reason why a rollout did not take all of its steps.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum RolloutError {
    /// A step, its controller, the call of [`forward`](crate::Data::forward) after the previous
    /// step, or the edit of the model before the first step failed. Other rollouts continue.
    #[error("step {step}: {error}")]
    Failed {
        /// Index of the failed step, counted from 0. This is also the number of steps taken.
        /// `nstep` if `forward` failed after the last step.
        step: usize,
        /// The error.
        #[source]
        error: Error,
    },

    /// The progress hook ended the run before or during this rollout.
    #[error("cancelled after {step} steps")]
    Cancelled {
        /// Number of steps taken.
        step: usize,
    },
}

debug_as_display!(RolloutError);

impl RolloutError {
    /// Returns the number of steps taken.
    pub fn step(&self) -> usize {
        match self {
            Self::Failed { step, .. } | Self::Cancelled { step } => *step,
        }
    }
}

/// Outputs of [`Rollout::run_into`](super::Rollout::run_into). Buffers that are `None` are not
/// recorded.
///
/// Values are row-major: a rollout is a block, and a step is a row of the block. If a rollout
/// fails, its remaining rows are NaN.
#[derive(Debug, Default)]
pub struct RolloutBuffers<'b> {
    /// `(nroll, nstep + 1, nstate)`: row 0 is the initial state, row `k` the state after `k` steps.
    pub states: Option<&'b mut [f64]>,
    /// `(nroll, nstep, nsensordata)`: row `k` is read in step `k`, in the state of row `k`.
    pub sensordata: Option<&'b mut [f64]>,
    /// `(nroll, nstep, noutput)`: row `k` is the output of the closure after step `k`.
    pub outputs: Option<&'b mut [f64]>,
}

/// Recorded states, sensor readings and outputs of all rollouts. If a rollout fails, its remaining
/// rows are NaN.
#[derive(Debug)]
pub struct RolloutResult {
    pub(super) sizes: Sizes,
    pub(super) states: Vec<f64>,
    pub(super) sensordata: Vec<f64>,
    pub(super) outputs: Vec<f64>,
    pub(super) outcomes: Vec<Result<(), RolloutError>>,
}

impl RolloutResult {
    /// Returns the number of rollouts, `nroll`.
    pub fn len(&self) -> usize {
        self.sizes.count
    }

    /// Returns `true` if there are no rollouts.
    pub fn is_empty(&self) -> bool {
        self.sizes.count == 0
    }

    /// Returns the number of steps, `nstep`.
    pub fn steps(&self) -> usize {
        self.sizes.steps
    }

    /// Returns the outcome of each rollout.
    pub fn outcomes(&self) -> &[Result<(), RolloutError>] {
        &self.outcomes
    }

    /// Returns the index and the error of the first rollout that did not take all of its steps.
    pub fn first_failure(&self) -> Option<(usize, &RolloutError)> {
        self.outcomes.iter().enumerate().find_map(|(rollout, outcome)| Some((rollout, outcome.as_ref().err()?)))
    }

    /// Returns all states `(nroll, nstep + 1, nstate)`: row 0 of a rollout is its initial state,
    /// row `k` the state after `k` steps.
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    /// Returns all sensor readings `(nroll, nstep, nsensordata)`: row `k` of a rollout is read in
    /// step `k`, in the state of row `k`.
    pub fn sensordata(&self) -> &[f64] {
        &self.sensordata
    }

    /// Returns all values of the [`with_outputs`](super::Rollout::with_outputs) closure
    /// `(nroll, nstep, noutput)`.
    pub fn outputs(&self) -> &[f64] {
        &self.outputs
    }

    /// Returns the states of one rollout `(nstep + 1, nstate)`.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn states_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.states, rollout, self.sizes.steps + 1, self.sizes.state)
    }

    /// Returns the sensor readings of one rollout `(nstep, nsensordata)`.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn sensordata_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.sensordata, rollout, self.sizes.steps, self.sizes.sensordata)
    }

    /// Returns the values of the [`with_outputs`](super::Rollout::with_outputs) closure in one
    /// rollout `(nstep, noutput)`.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn outputs_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.outputs, rollout, self.sizes.steps, self.sizes.output)
    }

    /// Returns the state of a rollout after `step` steps.
    ///
    /// # Panics
    ///
    /// If the rollout or the step is out of range.
    pub fn state(&self, rollout: usize, step: usize) -> &[f64] {
        self.states_of(rollout).row(step)
    }

    fn block<'s>(&self, values: &'s [f64], rollout: usize, rows: usize, columns: usize) -> MatrixView<'s> {
        assert!(rollout < self.len(), "there is no rollout {rollout}, only {}", self.len());
        MatrixView::from_row_major(rows, columns, &values[rollout * rows * columns..][..rows * columns])
    }
}

/// Dimensions of the recorded values. Products saturate, because no buffer can be that long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    pub(super) count: usize,
    pub(super) steps: usize,
    pub(super) state: usize,
    pub(super) sensordata: usize,
    pub(super) output: usize,
}

impl Sizes {
    /// Returns the number of state values of one rollout.
    pub(super) fn states_of_one(self) -> usize {
        self.steps.saturating_add(1).saturating_mul(self.state)
    }

    pub(super) fn sensordata_of_one(self) -> usize {
        self.steps.saturating_mul(self.sensordata)
    }

    pub(super) fn outputs_of_one(self) -> usize {
        self.steps.saturating_mul(self.output)
    }

    pub(super) fn states(self) -> usize {
        self.count.saturating_mul(self.states_of_one())
    }

    pub(super) fn sensordata(self) -> usize {
        self.count.saturating_mul(self.sensordata_of_one())
    }

    pub(super) fn outputs(self) -> usize {
        self.count.saturating_mul(self.outputs_of_one())
    }
}

/// Allocates the outcomes of rollouts that have not started.
pub(super) fn reserve_outcomes(count: usize) -> Result<Vec<Result<(), RolloutError>>> {
    let mut outcomes = Vec::new();
    outcomes.try_reserve_exact(count).map_err(|_| no_room("rollouts", count))?;
    outcomes.extend((0..count).map(|_| Err(RolloutError::Cancelled { step: 0 })));
    Ok(outcomes)
}
