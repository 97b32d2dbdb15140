//! Steps, resets and edits of all simulations of a batch.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Batch;
use super::member::{Member, Members};
use crate::data::Data;
use crate::error::{Error, Outcome, Result};
use crate::matrix::{MatrixView, MatrixViewMut};
use crate::parallel::{FirstError, Split, StopOnPanic, default_chunk, in_chunks};

/// # Steps, resets and edits
impl Batch<'_> {
    /// Calls the policy to set the controls `(n, nu)` from the observations `(n, nobs)`, steps all
    /// simulations, and observes them. The controls keep their values from the previous step unless
    /// the policy changes them; the controls of a simulation that was reset are zero unless its
    /// `start` set them. Allocates nothing except the first [`Data`] of each thread.
    ///
    /// A simulation that fails is not stepped again until it is reset, and its observations are
    /// NaN: see [`failure`](Self::failure).
    ///
    /// # Errors
    ///
    /// The error of the policy, if it returns one. In that case no simulation is stepped.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    pub fn step<O: Outcome<Value = ()>>(
        &mut self,
        policy: impl FnOnce(MatrixView<'_>, &mut MatrixViewMut<'_>) -> O,
    ) -> Result<()> {
        policy(self.observations.view(), &mut MatrixViewMut::from(&mut self.controls)).into_result()?;
        let substeps = self.substeps;
        self.each(|_, member| {
            let read = &member.common().read;
            member.step(substeps, read);
        });
        Ok(())
    }

    /// Resets the simulations whose index satisfies `which`, calls `start` to set their initial
    /// states, and observes them. An edit of the model by [`Data::edit_model`] in `start`, or a
    /// call of [`Data::set_callbacks`], affects that simulation only, and persists. The batch keeps
    /// the values that differ from its model for each simulation with such an edit. Steps of a
    /// simulation with such an edit or with callbacks take about twice as long;
    /// [parameters](Batch::with_parameters) do not have this cost.
    ///
    /// The arguments of `start` are the index, the number of the [`episode`](Self::episode) that
    /// starts, and the simulation. The first reset of a simulation starts its episode 1. Random
    /// numbers from a seed of both numbers depend neither on the threads nor on the order in which
    /// the episodes of different simulations end, like the numbers of
    /// [`Random`](crate::rollout::Random):
    ///
    /// ```
    /// use mujoco_safe::rollout::Random;
    /// use mujoco_safe::{Batch, sample};
    ///
    /// let mut batch = Batch::new(sample::cartpole(), 8)?;
    /// batch.reset_where(
    ///     |_| true,
    ///     |index, episode, data| data.qpos_mut()[1] = Random::new(42, index, episode).uniform(-0.1, 0.1),
    /// )?;
    /// assert_eq!(batch.episode(3), 1);
    /// assert_ne!(batch.data(3)?.qpos()[1], batch.data(4)?.qpos()[1]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The error of the reset, of `start` or of
    /// [`with_forward_after_step`](Self::with_forward_after_step) with the smallest index, and
    /// [`Error::OtherModel`](crate::Error::OtherModel) if `start` replaces the simulation by one of
    /// a model that was loaded separately. All simulations with an error count as failed.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    pub fn reset_where<O: Outcome<Value = ()>>(
        &mut self,
        which: impl Fn(usize) -> bool + Sync,
        start: impl Fn(usize, u64, &mut Data) -> O + Sync,
    ) -> Result<()> {
        self.try_each(|index, member| {
            if !which(index) {
                return Ok(());
            }
            let read = &member.common().read;
            member.reset(|episode, data| start(index, episode, data).into_result(), read)
        })
    }

    /// Calls `edit` for the simulations whose index satisfies `which`, and observes them. Its
    /// arguments are the index and the simulation, whose computed quantities are not available.
    /// Failed simulations are skipped.
    ///
    /// The closure may change everything that the closure of [`reset_where`](Self::reset_where)
    /// may.
    ///
    /// # Errors
    ///
    /// The error of `edit` with the smallest index, as for [`reset_where`](Self::reset_where). All
    /// simulations with an error count as failed.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    ///
    /// ```
    /// use mujoco_safe::{Batch, sample};
    ///
    /// // Push every other cart for one step.
    /// let mut batch = Batch::new(sample::cartpole(), 8)?;
    /// batch.edit_where(|index| index % 2 == 1, |_, data| data.qfrc_applied_mut()[0] = 5.0)?;
    /// batch.step(|_, _| ())?;
    /// batch.edit_where(|_| true, |_, data| data.qfrc_applied_mut().fill(0.0))?;
    /// assert_eq!(batch.observations()[(0, 0)], 0.0);
    /// assert!(batch.observations()[(1, 0)] > 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn edit_where<O: Outcome<Value = ()>>(
        &mut self,
        which: impl Fn(usize) -> bool + Sync,
        edit: impl Fn(usize, &mut Data) -> O + Sync,
    ) -> Result<()> {
        self.try_each(|index, member| {
            if !which(index) {
                return Ok(());
            }
            member.edit(|data| edit(index, data).into_result())
        })
    }

    /// Resets one simulation to the reference position, and observes it.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`](crate::Error::Engine) or [`Error::OutOfMemory`](crate::Error::OutOfMemory)
    /// if the engine fails, which occurs for a loaded model only if memory is exhausted.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn reset(&mut self, index: usize) -> Result<()> {
        assert!(index < self.len(), "there is no simulation {index}, only {}", self.len());
        let (_, rest) = self.members().split(index);
        let (one, _) = rest.split(1);
        let mut result = Ok(());
        one.each(|_, member| {
            let read = &member.common().read;
            result = member.reset(|_, _| Ok(()), read);
            true
        });
        result
    }

    /// Observes all simulations, in the calling thread.
    pub(super) fn observe_all(&mut self) {
        self.members().each(|_, member| {
            member.observe();
            true
        });
    }

    /// Sets the controls `(n, nu)`, steps all simulations, and calls `read` with the index of each
    /// one that has not failed, the simulation, its record, and its row of observations, which is
    /// zero. Returns the error of `read` with the smallest index; the failures of the engine are
    /// those of the simulations only.
    pub(crate) fn step_with<R: Send>(
        &mut self,
        controls: &[f64],
        records: &mut [R],
        read: impl Fn(usize, &Data, &mut R, &mut [f64]) -> Result<()> + Sync,
    ) -> Result<()> {
        self.controls.as_mut_slice().copy_from_slice(controls);
        let substeps = self.substeps;
        let first_error = FirstError::default();
        self.each_with(records, |index, member, record| {
            member.step(substeps, |data, observation| {
                read(index, data, record, observation).map_err(|error| {
                    let failure = Error::Poisoned { failure: error.to_string() };
                    first_error.record(index, error);
                    failure
                })
            });
        });
        first_error.into_result()
    }

    /// Resets simulations as [`reset_where`](Self::reset_where) does, and calls `read` with each,
    /// as [`step_with`](Self::step_with) does.
    pub(crate) fn reset_with<R: Send>(
        &mut self,
        records: &mut [R],
        which: impl Fn(usize) -> bool + Sync,
        start: impl Fn(usize, u64, &mut Data) -> Result<()> + Sync,
        read: impl Fn(&Data, &mut R, &mut [f64]) -> Result<()> + Sync,
    ) -> Result<()> {
        let first_error = FirstError::default();
        self.each_with(records, |index, member, record| {
            if which(index) {
                let read = |data: &Data, observation: &mut [f64]| read(data, record, observation);
                let result = member.reset(|episode, data| start(index, episode, data), read);
                result.unwrap_or_else(|error| first_error.record(index, error));
            }
        });
        first_error.into_result()
    }

    /// Calls `work` for all simulations in parallel, and returns the error with the smallest index.
    pub(super) fn try_each(&mut self, work: impl Fn(usize, &mut Member<'_, '_>) -> Result<()> + Sync) -> Result<()> {
        let first_error = FirstError::default();
        self.each(|index, member| {
            if let Err(error) = work(index, member) {
                first_error.record(index, error);
            }
        });
        first_error.into_result()
    }

    /// Calls `work` for all simulations in parallel.
    fn each(&mut self, work: impl Fn(usize, &mut Member<'_, '_>) + Sync) {
        // A vector of values without a size allocates nothing.
        self.each_with(&mut vec![(); self.len()], |index, member, ()| work(index, member));
    }

    /// Calls `work` for all simulations in parallel, each with its record.
    fn each_with<R: Send>(&mut self, records: &mut [R], work: impl Fn(usize, &mut Member<'_, '_>, &mut R) + Sync) {
        let chunk = self.chunk.unwrap_or_else(|| default_chunk(self.len()));
        let stop = AtomicBool::new(false);
        in_chunks(WithRecords(self.members(), records), 0, chunk, &|first, WithRecords(members, records)| {
            let guard = StopOnPanic::new(&stop);
            members.each(|offset, member| {
                let go_on = !stop.load(Ordering::Relaxed);
                if go_on {
                    work(first + offset, member, &mut records[offset]);
                }
                go_on
            });
            guard.disarm();
        });
    }

    fn members(&mut self) -> Members<'_> {
        Members {
            common: &self.common,
            rows: &mut self.rows,
            states: MatrixViewMut::from(&mut self.states),
            controls: MatrixViewMut::from(&mut self.controls),
            observations: MatrixViewMut::from(&mut self.observations),
            values: MatrixViewMut::from(&mut self.values),
        }
    }
}

/// Part of the simulations, and a record of each.
struct WithRecords<'b, 'r, R>(Members<'b>, &'r mut [R]);

impl<R: Send> Split for WithRecords<'_, '_, R> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn split(self, first: usize) -> (Self, Self) {
        let ((members, other_members), (records, other_records)) = (self.0.split(first), self.1.split_at_mut(first));
        (Self(members, records), Self(other_members, other_records))
    }
}
