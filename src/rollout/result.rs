//! What comes out of rollouts.

use super::Sizes;
use crate::error::Error;
use crate::matrix::MatrixView;

/// Why a rollout did not take all of its steps.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RolloutError {
    /// A step failed, or its controller or the edit of the model before the first step did. The others go on.
    #[error("step {step}: {error}")]
    Failed {
        /// The step that failed, counted from 0: so many were taken before.
        step: usize,
        /// What happened.
        #[source]
        error: Error,
    },

    /// The run was ended by its progress hook before or while this one was simulated.
    #[error("cancelled after {step} steps")]
    Cancelled {
        /// How many steps were taken.
        step: usize,
    },
}

impl RolloutError {
    /// How many steps were taken.
    pub fn step(&self) -> usize {
        match self {
            Self::Failed { step, .. } | Self::Cancelled { step } => *step,
        }
    }
}

/// Where [`Rollout::run_into`](super::Rollout::run_into) writes to. What is `None` is not recorded. The values are row-major:
/// those of a rollout are one block, those of a step one row of it.
///
/// The rows that a rollout with an error did not come to are NaN.
#[derive(Debug, Default)]
pub struct RolloutBuffers<'b> {
    /// `(nroll, nstep + 1, nstate)`: row 0 is the initial state, row `k` the state after `k` steps.
    pub states: Option<&'b mut [f64]>,
    /// `(nroll, nstep, nsensordata)`: row `k` is read in step `k`, in the state of row `k`.
    pub sensordata: Option<&'b mut [f64]>,
    /// `(nroll, nstep, noutput)`: row `k` is what the closure made of the simulation after step `k`.
    pub outputs: Option<&'b mut [f64]>,
}

/// What all rollouts went through.
///
/// The rows that a rollout with an error did not come to are NaN.
#[derive(Debug)]
pub struct RolloutResult {
    pub(super) sizes: Sizes,
    pub(super) states: Vec<f64>,
    pub(super) sensordata: Vec<f64>,
    pub(super) outputs: Vec<f64>,
    pub(super) outcomes: Vec<Result<(), RolloutError>>,
}

impl RolloutResult {
    /// The number of rollouts, `nroll`.
    pub fn len(&self) -> usize {
        self.sizes.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.sizes.count == 0
    }

    /// The number of steps, `nstep`.
    pub fn steps(&self) -> usize {
        self.sizes.steps
    }

    /// How each rollout ended.
    pub fn outcomes(&self) -> &[Result<(), RolloutError>] {
        &self.outcomes
    }

    /// All states `(nroll, nstep + 1, nstate)`: row 0 of a rollout is its initial state, row `k` the state after `k` steps.
    pub fn states(&self) -> &[f64] {
        &self.states
    }

    /// All sensor readings `(nroll, nstep, nsensordata)`: row `k` of a rollout is read in step `k`, in the state of row `k`.
    pub fn sensordata(&self) -> &[f64] {
        &self.sensordata
    }

    /// All values of the [`outputs`](super::Rollout::outputs) closure `(nroll, nstep, noutput)`.
    pub fn outputs(&self) -> &[f64] {
        &self.outputs
    }

    /// The states of one rollout `(nstep + 1, nstate)`.
    ///
    /// # Panics
    ///
    /// If there is no such rollout.
    pub fn states_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.states, rollout, self.sizes.steps + 1, self.sizes.state)
    }

    /// The sensor readings of one rollout `(nstep, nsensordata)`.
    ///
    /// # Panics
    ///
    /// If there is no such rollout.
    pub fn sensordata_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.sensordata, rollout, self.sizes.steps, self.sizes.sensordata)
    }

    /// The values of the [`outputs`](super::Rollout::outputs) closure in one rollout `(nstep, noutput)`.
    ///
    /// # Panics
    ///
    /// If there is no such rollout.
    pub fn outputs_of(&self, rollout: usize) -> MatrixView<'_> {
        self.block(&self.outputs, rollout, self.sizes.steps, self.sizes.output)
    }

    /// The state of a rollout after so many steps.
    ///
    /// # Panics
    ///
    /// If there is no such rollout or step.
    pub fn state(&self, rollout: usize, step: usize) -> &[f64] {
        self.states_of(rollout).row(step)
    }

    fn block<'s>(&self, values: &'s [f64], rollout: usize, rows: usize, columns: usize) -> MatrixView<'s> {
        assert!(rollout < self.len(), "rollout {rollout} of {}", self.len());
        MatrixView::from_row_major(rows, columns, &values[rollout * rows * columns..][..rows * columns])
    }
}
