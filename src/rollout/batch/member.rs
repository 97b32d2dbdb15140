//! Rows of a batch: their division among threads, and the work on one of them.

use super::worker::{Loaded, Own, Pool, Results, Worker, check_model, continue_from};
use crate::data::{Data, StateSpec, WarningCounters};
use crate::error::{Error, Result};
use crate::parallel::{Split, split_rows};
use crate::rollout::workers::restart;
use crate::rollout::{Parameters, Read};

/// Record of a simulation, apart from its numbers.
pub(super) struct Row {
    /// Error that stopped the simulation, if any.
    pub(super) failure: Option<Error>,
    /// Number of resets.
    pub(super) episode: u64,
    /// Warnings of the engine since the reset.
    pub(super) warnings: WarningCounters,
    /// Model and callbacks, if they differ from a new simulation's.
    pub(super) own: Option<Box<Own>>,
}

impl Row {
    pub(super) fn new(warnings: WarningCounters) -> Self {
        Self { failure: None, episode: 0, warnings, own: None }
    }
}

/// Properties that all simulations of a batch have in common.
#[derive(Clone, Copy)]
pub(super) struct Common<'b> {
    pub(super) pool: &'b Pool,
    pub(super) read: &'b Read<'b>,
    /// `true` if forward dynamics is computed before an observation.
    pub(super) forward: bool,
    /// Index of the first control in a state.
    pub(super) first_control: usize,
    pub(super) parameters: &'b Parameters,
}

/// Start of the work on a simulation.
#[derive(Clone, Copy)]
enum Source {
    /// Its state, in a worker with at most these results.
    State(Results),
    Reset,
}

/// Simulation of a batch.
pub(super) struct Member<'m> {
    pub(super) common: Common<'m>,
    pub(super) row: &'m mut Row,
    state: &'m mut [f64],
    controls: &'m mut [f64],
    observations: &'m mut [f64],
    /// Values of the parameters.
    values: &'m mut [f64],
}

impl Member<'_> {
    /// Steps the simulation, unless it has failed.
    pub(super) fn step(&mut self, slot: &mut Option<Worker>, substeps: usize) {
        if self.row.failure.is_some() {
            return;
        }
        self.state[self.common.first_control..][..self.controls.len()].copy_from_slice(self.controls);
        // Without a step, the results of another simulation would remain.
        let allowed = if substeps == 0 { Results::None } else { Results::Steps };
        let result = self.work(slot, Source::State(allowed), Results::Steps, |data| data.step_n(substeps));
        if let Err(error) = result {
            self.fail(error);
        }
    }

    /// Starts the next episode.
    pub(super) fn reset(
        &mut self,
        slot: &mut Option<Worker>,
        start: impl FnOnce(u64, &mut Data) -> Result<()>,
    ) -> Result<()> {
        self.row.episode += 1;
        self.row.failure = None;
        let episode = self.row.episode;
        let result = self.work(slot, Source::Reset, Results::Any, |data| start(episode, data));
        result.inspect_err(|error| self.fail(Error::Poisoned { failure: error.to_string() }))
    }

    /// Calls `edit`, unless the simulation has failed.
    pub(super) fn edit(&mut self, slot: &mut Option<Worker>, edit: impl FnOnce(&mut Data) -> Result<()>) -> Result<()> {
        if self.row.failure.is_some() {
            return Ok(());
        }
        let result = self.work(slot, Source::State(Results::None), Results::Any, edit);
        result.inspect_err(|error| self.fail(Error::Poisoned { failure: error.to_string() }))
    }

    /// Sets the values of the parameters, which must be valid, and observes the simulation if they
    /// change.
    pub(super) fn set_parameters(&mut self, slot: &mut Option<Worker>, values: &[f64]) -> Result<()> {
        if bits_equal(self.values, values) {
            return Ok(());
        }
        let Common { pool, parameters, .. } = self.common;
        let (model, present) = (pool.model(), &*self.values);
        let worker = pool.fill(slot)?;
        worker.edit_model(&mut self.row.own, model, |copy| parameters.write(present, values, model, copy))?;
        self.values.copy_from_slice(values);
        self.observe(slot);
        Ok(())
    }

    /// Observes the simulation, or writes NaN if it has failed.
    pub(super) fn observe(&mut self, slot: &mut Option<Worker>) {
        if self.row.failure.is_some() {
            return self.observations.fill(f64::NAN);
        }
        let leaves = if self.common.forward { Results::Steps } else { Results::None };
        let result = self.work(slot, Source::State(Results::None), leaves, |_| Ok(()));
        if let Err(error) = result {
            self.fail(error);
        }
    }

    fn fail(&mut self, error: Error) {
        self.row.failure = Some(error);
        self.observations.fill(f64::NAN);
    }

    /// Loads the simulation into a worker, calls `work`, stores the new state, and observes it. If
    /// `work` fails, the state is unchanged. `leaves` are the results that the worker has
    /// afterwards.
    fn work(
        &mut self,
        slot: &mut Option<Worker>,
        source: Source,
        leaves: Results,
        work: impl FnOnce(&mut Data) -> Result<()>,
    ) -> Result<()> {
        let Self { common, row, state, controls, observations, .. } = self;
        let worker = common.pool.fill(slot)?;
        let allowed = if let Source::State(results) = source { results } else { Results::Any };
        let mut loaded = Loaded::new(worker, &mut row.own, common.pool.model(), allowed)?;
        let data = loaded.data();
        match source {
            Source::State(_) => continue_from(data, state, &row.warnings)?,
            Source::Reset => restart(data)?,
        }
        work(data)?;
        if leaves == Results::Any {
            check_model(data, common.pool.model())?;
            data.check_usable()?;
        }
        data.state_into(StateSpec::INTEGRATION, state)?;
        controls.copy_from_slice(&state[common.first_control..][..controls.len()]);
        if common.forward {
            data.forward()?;
            // `forward` overwrites the initial guess of the constraint solver and normalises
            // quaternions.
            data.set_state(StateSpec::INTEGRATION, state)?;
        }
        row.warnings = data.warnings();
        observations.fill(0.0);
        (common.read)(data, observations);
        loaded.finish(leaves);
        Ok(())
    }
}

/// Returns `true` if the numbers are identical. Zero differs from negative zero.
fn bits_equal(left: &[f64], right: &[f64]) -> bool {
    left.iter().zip(right).all(|(left, right)| left.to_bits() == right.to_bits())
}

/// Part of the simulations.
pub(super) struct Members<'b> {
    pub(super) common: Common<'b>,
    pub(super) rows: &'b mut [Row],
    pub(super) states: &'b mut [f64],
    pub(super) controls: &'b mut [f64],
    pub(super) observations: &'b mut [f64],
    pub(super) values: &'b mut [f64],
    pub(super) widths: Widths,
}

/// Numbers of values per simulation.
#[derive(Clone, Copy)]
pub(super) struct Widths {
    pub(super) state: usize,
    pub(super) controls: usize,
    pub(super) observations: usize,
    pub(super) values: usize,
}

impl Members<'_> {
    /// Calls `work` for the simulations in turn while it returns `true`.
    pub(super) fn each(self, mut work: impl FnMut(usize, &mut Member<'_>) -> bool) {
        let Self { common, rows, states, controls, observations, values, widths } = self;
        for (index, row) in rows.iter_mut().enumerate() {
            let mut member = Member {
                common,
                row,
                state: &mut states[index * widths.state..][..widths.state],
                controls: &mut controls[index * widths.controls..][..widths.controls],
                observations: &mut observations[index * widths.observations..][..widths.observations],
                values: &mut values[index * widths.values..][..widths.values],
            };
            if !work(index, &mut member) {
                break;
            }
        }
    }
}

impl Split for Members<'_> {
    fn count(&self) -> usize {
        self.rows.len()
    }

    fn split(self, first: usize) -> (Self, Self) {
        let Self { common, widths, .. } = self;
        let (rows, other_rows) = self.rows.split_at_mut(first);
        let (states, other_states) = split_rows(self.states, first, widths.state);
        let (controls, other_controls) = split_rows(self.controls, first, widths.controls);
        let (observations, other_observations) = split_rows(self.observations, first, widths.observations);
        let (values, other_values) = split_rows(self.values, first, widths.values);
        (
            Self { common, rows, states, controls, observations, values, widths },
            Self {
                common,
                rows: other_rows,
                states: other_states,
                controls: other_controls,
                observations: other_observations,
                values: other_values,
                widths,
            },
        )
    }
}
