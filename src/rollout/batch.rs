//! Simulations that advance together.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::parallel::{Split, StopOnPanic, default_chunk, in_chunks, split_rows};
use super::restart::restart;
use super::{Read, no_room};
use crate::controller::Outcome;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::matrix::{Matrix, MatrixView, MatrixViewMut};
use crate::model::Model;

/// Simulations of one model that advance together, a step at a time, under a policy that sees the observations of all and sets
/// the controls of all: what reinforcement learning calls a vector of environments. The policy is called once for all, in the
/// calling thread; stepping, observing and resetting are done in parallel. See the [module](crate::rollout) for threads.
///
/// Each simulation is a [`Data`] of its own, which takes some megabytes: most of it for the constraints and the stack that the
/// model's `njmax`, `nconmax` and `nstack` leave room for.
///
/// ```
/// use mujoco_safe::rollout::Batch;
/// use mujoco_safe::sample;
///
/// // 16 cart-poles, of which each observes its angle and its rate, under one policy.
/// let mut batch = Batch::new(sample::cartpole(), 16)?.observe(2, |data, row| {
///     row.copy_from_slice(&[data.qpos()[1], data.qvel()[1]]);
/// });
/// batch.reset_where(|_| true, |index, data| data.qpos_mut()[1] = 0.01 * index as f64)?;
/// for _ in 0..200 {
///     batch.step(|observations, controls| {
///         for (observation, control) in observations.rows().zip(controls.as_mut_slice()) {
///             *control = 3.0 * observation[0] + 0.5 * observation[1];
///         }
///     })?;
///     // Those that have fallen begin anew.
///     let fallen: Vec<bool> = batch.observations().rows().map(|row| row[0].abs() > 0.5).collect();
///     batch.reset_where(|index| fallen[index], |_, data| data.qpos_mut()[1] = 0.05)?;
/// }
/// assert!(batch.failures().next().is_none());
/// assert!(batch.observations().rows().all(|row| row[0].abs() < 0.2));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub struct Batch<'a> {
    model: Arc<Model>,
    simulations: Vec<Data>,
    /// Why a simulation stands still, if it does.
    failures: Vec<Option<Error>>,
    observations: Matrix,
    controls: Matrix,
    observe: Box<Read<'a>>,
    substeps: usize,
    chunk: Option<usize>,
}

impl<'a> Batch<'a> {
    /// `count` simulations in the reference position, each of which observes its physics state `[qpos; qvel; act]` until
    /// [`observe`](Self::observe) says something else. Takes a [`Model`] or an `Arc<Model>`, which all share.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if there is no memory for so many, [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot
    /// allocate them.
    pub fn new(model: impl Into<Arc<Model>>, count: usize) -> Result<Self> {
        let model = model.into();
        let mut simulations = Vec::new();
        if count > 0 {
            let first = Data::new(model.clone())?;
            check_memory(&first, count)?;
            simulations.try_reserve_exact(count).map_err(|_| no_room("simulations", count))?;
            simulations.push(first);
        }
        for _ in 1..count {
            simulations.push(Data::new(model.clone())?);
        }
        let batch = Self {
            failures: simulations.iter().map(|_| None).collect(),
            observations: Matrix::default(),
            controls: Matrix::zeros(count, model.nu()),
            observe: Box::new(|_, _| ()),
            substeps: 1,
            chunk: None,
            simulations,
            model,
        };
        let width = batch.model.state_size(StateSpec::PHYSICS);
        // A simulation of another model leaves the row of zeros as it is.
        Ok(batch.observe(width, |data, row| drop(data.physics_state_into(row))))
    }

    /// Each simulation is observed by this closure, which writes to a row of `nobs` zeros: after each step, when what was computed
    /// is of the state before it, and after each reset, when nothing is computed yet.
    ///
    /// # Panics
    ///
    /// If there is no memory for the observations.
    #[must_use]
    pub fn observe(mut self, nobs: usize, read: impl Fn(&Data, &mut [f64]) + Send + Sync + 'a) -> Self {
        self.observations = Matrix::zeros(self.simulations.len(), nobs);
        self.observe = Box::new(read);
        for (index, data) in self.simulations.iter().enumerate() {
            (self.observe)(data, self.observations.row_mut(index));
        }
        self
    }

    /// How many steps of the engine a [`step`](Self::step) is, with the same controls: one if nothing is said.
    #[must_use]
    pub fn substeps(mut self, substeps: usize) -> Self {
        self.substeps = substeps;
        self
    }

    /// How many simulations a thread takes at a time, at least one; the result does not depend on it. If it is their number or
    /// more, all run in the calling thread.
    #[must_use]
    pub fn chunk(mut self, simulations: usize) -> Self {
        self.chunk = Some(simulations.max(1));
        self
    }

    /// The number of simulations, `n`.
    pub fn len(&self) -> usize {
        self.simulations.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.simulations.is_empty()
    }

    /// The model that all were made with.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The observations of all `(n, nobs)`. The row of a simulation with a failure is NaN.
    pub fn observations(&self) -> MatrixView<'_> {
        self.observations.view()
    }

    /// The controls that the policy set last `(n, nu)`.
    pub fn controls(&self) -> MatrixView<'_> {
        self.controls.view()
    }

    /// One simulation.
    ///
    /// # Panics
    ///
    /// If there is no such simulation.
    pub fn data(&self, index: usize) -> &Data {
        &self.simulations[index]
    }

    /// What went wrong in one simulation, if something did. It stands still then, until it is reset.
    ///
    /// # Panics
    ///
    /// If there is no such simulation.
    pub fn failure(&self, index: usize) -> Option<&Error> {
        self.failures[index].as_ref()
    }

    /// All simulations that stand still, and why.
    pub fn failures(&self) -> impl Iterator<Item = (usize, &Error)> {
        self.failures.iter().enumerate().filter_map(|(index, failure)| Some((index, failure.as_ref()?)))
    }

    /// Has the policy set the controls `(n, nu)` from the observations `(n, nobs)`, advances all simulations, and observes
    /// them. The controls are those of the step before until the policy changes them. Nothing is allocated for it.
    ///
    /// A simulation that fails stands still from then on, and its observations are NaN: see [`failure`](Self::failure).
    ///
    /// # Errors
    ///
    /// The policy's own, if it returns a [`Result`]; nothing is advanced then.
    ///
    /// # Panics
    ///
    /// If a closure does.
    pub fn step<O: Outcome>(&mut self, policy: impl FnOnce(MatrixView<'_>, &mut MatrixViewMut<'_>) -> O) -> Result<()> {
        let (count, nu) = self.controls.shape();
        let mut controls = MatrixViewMut::from_row_major(count, nu, self.controls.as_mut_slice());
        policy(self.observations.view(), &mut controls).into_result()?;
        let substeps = self.substeps;
        self.each(|_, member| {
            if member.failure.is_none() {
                *member.failure = member.advance(substeps).err();
                member.observe();
            }
        });
        Ok(())
    }

    /// Resets the simulations that `which` names by their index, has `start` set where they begin, and observes them. What
    /// [`Data::edit_model`] does in `start` stays until it is undone, for the one simulation.
    ///
    /// # Errors
    ///
    /// The first that the reset or `start` meets, by index. Those that failed stand still.
    ///
    /// # Panics
    ///
    /// If a closure does.
    pub fn reset_where<O: Outcome>(
        &mut self,
        which: impl Fn(usize) -> bool + Sync,
        start: impl Fn(usize, &mut Data) -> O + Sync,
    ) -> Result<()> {
        let failed = std::sync::Mutex::new(None::<(usize, Error)>);
        self.each(|index, member| {
            if !which(index) {
                return;
            }
            *member.failure = None;
            let result = restart(member.data).and_then(|()| start(index, member.data).into_result());
            if let Err(error) = result {
                *member.failure = Some(Error::Poisoned { failure: error.to_string() });
                let mut failed = failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if failed.as_ref().is_none_or(|(first, _)| index < *first) {
                    *failed = Some((index, error));
                }
            }
            member.observe();
        });
        match failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
            None => Ok(()),
            Some((_, error)) => Err(error),
        }
    }

    /// Resets one simulation to the reference position, and observes it.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the engine fails, which it does for no model that was loaded.
    ///
    /// # Panics
    ///
    /// If there is no such simulation.
    pub fn reset(&mut self, index: usize) -> Result<()> {
        restart(&mut self.simulations[index])?;
        self.failures[index] = None;
        let row = self.observations.row_mut(index);
        row.fill(0.0);
        (self.observe)(&self.simulations[index], row);
        Ok(())
    }

    /// Works on all simulations in parallel.
    fn each(&mut self, work: impl Fn(usize, &mut Member<'_>) + Sync) {
        let chunk = self.chunk.unwrap_or_else(|| default_chunk(self.simulations.len()));
        let stop = AtomicBool::new(false);
        let observe = &*self.observe;
        let members = Members {
            simulations: &mut self.simulations,
            failures: &mut self.failures,
            controls: self.controls.view(),
            width: self.observations.ncols(),
            observations: self.observations.as_mut_slice(),
        };
        in_chunks(members, 0, chunk, &|first, members| {
            let guard = StopOnPanic::new(&stop);
            let Members { simulations, failures, controls, width, observations } = members;
            for (offset, (data, failure)) in simulations.iter_mut().zip(failures).enumerate() {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let index = first + offset;
                let row = &mut observations[offset * width..][..width];
                work(index, &mut Member { data, failure, controls: controls.row(index), row, observe });
            }
            guard.disarm();
        });
    }
}

impl fmt::Debug for Batch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Batch: {} simulations, {} failed, of {:?}", self.len(), self.failures().count(), self.model)
    }
}

/// Some simulations, with all controls.
struct Members<'b> {
    simulations: &'b mut [Data],
    failures: &'b mut [Option<Error>],
    controls: MatrixView<'b>,
    observations: &'b mut [f64],
    width: usize,
}

impl Split for Members<'_> {
    fn count(&self) -> usize {
        self.simulations.len()
    }

    fn split(self, first: usize) -> (Self, Self) {
        let Self { controls, width, .. } = self;
        let (simulations, other_simulations) = self.simulations.split_at_mut(first);
        let (failures, other_failures) = self.failures.split_at_mut(first);
        let (observations, other_observations) = split_rows(self.observations, first, width);
        (
            Self { simulations, failures, controls, observations, width },
            Self {
                simulations: other_simulations,
                failures: other_failures,
                controls,
                observations: other_observations,
                width,
            },
        )
    }
}

/// One simulation, and what belongs to it.
struct Member<'m> {
    data: &'m mut Data,
    failure: &'m mut Option<Error>,
    controls: &'m [f64],
    row: &'m mut [f64],
    observe: &'m Read<'m>,
}

impl Member<'_> {
    fn advance(&mut self, substeps: usize) -> Result<()> {
        self.data.set_state(StateSpec::CTRL, self.controls)?;
        (0..substeps).try_for_each(|_| self.data.step())
    }

    fn observe(&mut self) {
        if self.failure.is_some() {
            self.row.fill(f64::NAN);
        } else {
            self.row.fill(0.0);
            (self.observe)(self.data, self.row);
        }
    }
}

/// Refuses a number of simulations for which there is no memory, before the first of them is allocated.
fn check_memory(simulation: &Data, count: usize) -> Result<()> {
    // SAFETY: a valid simulation, which nothing writes to while it is borrowed.
    let (buffer, stack) = unsafe { ((*simulation.as_ptr()).nbuffer, (*simulation.as_ptr()).nstack) };
    let bytes = usize::try_from(buffer).ok().zip(usize::try_from(stack).ok()).and_then(|(buffer, stack)| {
        let one = stack.checked_mul(size_of::<f64>())?.checked_add(buffer)?.checked_add(size_of::<Data>())?;
        one.checked_mul(count)
    });
    let fits = bytes.is_some_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if fits { Ok(()) } else { Err(no_room("simulations", count)) }
}
