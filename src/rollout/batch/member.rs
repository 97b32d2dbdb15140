//! Rows of a batch: their division among threads, and the work on one of them.

use super::worker::{Loaded, Overrides, Results, Worker, continue_from};
use crate::data::{Data, StateSpec, WarningCounters};
use crate::error::{Error, Result};
use crate::matrix::MatrixViewMut;
use crate::model::ModelMut;
use crate::parallel::{Lease, Pool, Split};
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
    pub(super) overrides: Option<Box<Overrides>>,
}

impl Row {
    pub(super) fn new(warnings: WarningCounters) -> Self {
        Self { failure: None, episode: 0, warnings, overrides: None }
    }
}

/// Computations before an observation.
#[derive(Clone, Copy, Default)]
pub(crate) struct Refresh {
    /// `true` if forward dynamics is computed after a step or an edit.
    pub(crate) forward: bool,
    /// `true` if forward dynamics is computed after a reset.
    pub(crate) forward_after_reset: bool,
    /// `true` if accelerations of bodies and forces on them are computed after a step, and after a
    /// reset with forward dynamics.
    pub(crate) body_forces: bool,
}

/// Properties that all simulations of a batch have in common.
pub(super) struct Common<'a> {
    pub(super) pool: Pool<Worker>,
    /// Closure that observes a simulation.
    pub(super) read: Box<Read<'a>>,
    pub(super) refresh: Refresh,
    /// Index of the first control in a state.
    pub(super) first_control: usize,
    pub(super) parameters: Parameters,
}

/// Start of the work on a simulation.
#[derive(Clone, Copy)]
enum Source {
    /// Its state, in a worker without results.
    State,
    /// Its state before a step, in a worker with at most these results.
    BeforeStep(Results),
    Reset,
}

/// Simulation of a batch.
pub(super) struct Member<'m, 'b> {
    common: &'b Common<'b>,
    lease: &'m mut Lease<'b, Worker>,
    row: &'m mut Row,
    state: &'m mut [f64],
    controls: &'m mut [f64],
    observations: &'m mut [f64],
    /// Values of the parameters.
    values: &'m mut [f64],
}

impl<'b> Member<'_, 'b> {
    pub(super) fn common(&self) -> &'b Common<'b> {
        self.common
    }

    /// Steps the simulation and calls `read` with it, unless it has failed.
    pub(super) fn step(&mut self, substeps: usize, read: impl FnOnce(&Data, &mut [f64]) -> Result<()>) {
        if self.row.failure.is_some() {
            return;
        }
        self.state[self.common.first_control..][..self.controls.len()].copy_from_slice(self.controls);
        // Without a step, the results of another simulation would remain.
        let allowed = if substeps == 0 { Results::None } else { Results::Steps };
        let result = self.work(Source::BeforeStep(allowed), Results::Steps, |data| data.step_n(substeps), read);
        if let Err(error) = result {
            self.fail(error);
        }
    }

    /// Starts the next episode, and calls `read` with the simulation.
    pub(super) fn reset(
        &mut self,
        start: impl FnOnce(u64, &mut Data) -> Result<()>,
        read: impl FnOnce(&Data, &mut [f64]) -> Result<()>,
    ) -> Result<()> {
        self.row.episode += 1;
        self.row.failure = None;
        let episode = self.row.episode;
        let result = self.work(Source::Reset, Results::Any, |data| start(episode, data), read);
        result.inspect_err(|error| self.fail(Error::Poisoned { failure: error.to_string() }))
    }

    /// Calls `edit`, unless the simulation has failed.
    pub(super) fn edit(&mut self, edit: impl FnOnce(&mut Data) -> Result<()>) -> Result<()> {
        if self.row.failure.is_some() {
            return Ok(());
        }
        let result = self.work(Source::State, Results::Any, edit, &self.common.read);
        result.inspect_err(|error| self.fail(Error::Poisoned { failure: error.to_string() }))
    }

    /// Sets the values of the parameters, which must be valid, and observes the simulation if they
    /// change.
    pub(super) fn set_parameters(&mut self, values: &[f64]) -> Result<()> {
        if bits_equal(self.values, values) {
            return Ok(());
        }
        let (model, present) = (self.common.pool.model(), &*self.values);
        let write = |copy: &mut ModelMut<'_>| self.common.parameters.write(present, values, model, copy);
        self.lease.get()?.edit_model(&mut self.row.overrides, model, write)?;
        self.values.copy_from_slice(values);
        self.observe();
        Ok(())
    }

    /// Observes the simulation, or writes NaN if it has failed.
    pub(super) fn observe(&mut self) {
        if self.row.failure.is_some() {
            return self.observations.fill(f64::NAN);
        }
        let leaves = if self.common.refresh.forward { Results::Steps } else { Results::None };
        let result = self.work(Source::State, leaves, |_| Ok(()), &self.common.read);
        if let Err(error) = result {
            self.fail(error);
        }
    }

    fn fail(&mut self, error: Error) {
        self.row.failure = Some(error);
        self.observations.fill(f64::NAN);
    }

    /// Loads the simulation into a worker, calls `work`, stores the new state, and calls `read` to
    /// observe it. If `work` fails, the state is unchanged. `leaves` are the results that the
    /// worker has afterwards.
    fn work(
        &mut self,
        source: Source,
        leaves: Results,
        work: impl FnOnce(&mut Data) -> Result<()>,
        read: impl FnOnce(&Data, &mut [f64]) -> Result<()>,
    ) -> Result<()> {
        let Self { common, lease, row, state, controls, observations, .. } = self;
        let (model, refresh) = (common.pool.model(), common.refresh);
        let (allowed, forward) = match source {
            Source::State => (Results::None, refresh.forward),
            Source::BeforeStep(results) => (results, refresh.forward),
            Source::Reset => (Results::Any, refresh.forward_after_reset),
        };
        let mut loaded = Loaded::new(lease.get()?, &mut row.overrides, model, allowed)?;
        let data = loaded.data();
        match source {
            Source::State | Source::BeforeStep(_) => continue_from(data, state, &row.warnings)?,
            Source::Reset => restart(data)?,
        }
        work(data)?;
        if leaves == Results::Any {
            model.relation(data.model()).check("the simulation that a closure has put into a batch")?;
            data.check_usable()?;
        }
        data.state_into(StateSpec::INTEGRATION, state)?;
        controls.copy_from_slice(&state[common.first_control..][..controls.len()]);
        if forward {
            data.forward()?;
        }
        if refresh.body_forces && (forward || matches!(source, Source::BeforeStep(_))) {
            data.rne_post_constraint()?;
        }
        if forward {
            // `forward` overwrites the initial guess of the constraint solver and normalises
            // quaternions.
            data.set_state(StateSpec::INTEGRATION, state)?;
        }
        row.warnings = data.warning_counters();
        observations.fill(0.0);
        read(data, observations)?;
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
    pub(super) common: &'b Common<'b>,
    pub(super) rows: &'b mut [Row],
    pub(super) states: MatrixViewMut<'b>,
    pub(super) controls: MatrixViewMut<'b>,
    pub(super) observations: MatrixViewMut<'b>,
    pub(super) values: MatrixViewMut<'b>,
}

impl Members<'_> {
    /// Calls `work` for the simulations in turn while it returns `true`.
    pub(super) fn each(mut self, mut work: impl FnMut(usize, &mut Member<'_, '_>) -> bool) {
        let mut lease = self.common.pool.lease();
        for (index, row) in self.rows.iter_mut().enumerate() {
            let mut member = Member {
                common: self.common,
                lease: &mut lease,
                row,
                state: self.states.row_mut(index),
                controls: self.controls.row_mut(index),
                observations: self.observations.row_mut(index),
                values: self.values.row_mut(index),
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
        let (rows, other_rows) = self.rows.split_at_mut(first);
        let (states, other_states) = self.states.split_rows(first);
        let (controls, other_controls) = self.controls.split_rows(first);
        let (observations, other_observations) = self.observations.split_rows(first);
        let (values, other_values) = self.values.split_rows(first);
        (
            Self { common: self.common, rows, states, controls, observations, values },
            Self {
                common: self.common,
                rows: other_rows,
                states: other_states,
                controls: other_controls,
                observations: other_observations,
                values: other_values,
            },
        )
    }
}
