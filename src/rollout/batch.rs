//! Batches of simulations that are stepped together.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Read;
use super::members::{Member, Members, Observer, Simulation, check_memory};
use super::parallel::{StopOnPanic, default_chunk, in_chunks};
use super::result::no_room;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Outcome, Result};
use crate::matrix::{Matrix, MatrixView, MatrixViewMut};
use crate::model::{IntoModel, Model};

/// Batch of simulations of one model that are stepped together under a policy: a vectorised environment of reinforcement
/// learning.
///
/// The policy reads the observations and sets the controls of all simulations. It is called once per step, in the calling thread;
/// stepping, observing and resetting run in parallel. The [module](crate::rollout) documents threads.
///
/// Each simulation has its own [`Data`] of several megabytes, mostly for the constraints and the stack that the model's `njmax`,
/// `nconmax` and `nstack` reserve.
///
/// ```
/// use mujoco_safe::rollout::Batch;
/// use mujoco_safe::sample;
///
/// // 16 cart-poles under one policy; the observations are the angle and its rate.
/// let mut batch = Batch::new(sample::cartpole(), 16)?.observe(2, |data, row| {
///     row.copy_from_slice(&[data.qpos()[1], data.qvel()[1]]);
/// });
/// batch.reset_where(|_| true, |index, _, data| data.qpos_mut()[1] = 0.01 * index as f64)?;
/// for _ in 0..200 {
///     batch.step(|observations, controls| {
///         for (observation, control) in observations.rows().zip(controls.as_mut_slice()) {
///             *control = 3.0 * observation[0] + 0.5 * observation[1];
///         }
///     })?;
///     // Reset the cart-poles that have fallen.
///     let fallen: Vec<bool> = batch.observations().rows().map(|row| row[0].abs() > 0.5).collect();
///     batch.reset_where(|index| fallen[index], |_, _, data| data.qpos_mut()[1] = 0.05)?;
/// }
/// assert!(batch.failures().next().is_none());
/// assert!(batch.observations().rows().all(|row| row[0].abs() < 0.2));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub struct Batch<'a> {
    model: Arc<Model>,
    simulations: Vec<Simulation>,
    observations: Matrix,
    controls: Matrix,
    observe: Box<Read<'a>>,
    forward: bool,
    substeps: usize,
    chunk: Option<usize>,
}

impl<'a> Batch<'a> {
    /// Creates `count` simulations in the reference position. By default the observation is the physics state
    /// `[qpos; qvel; act]`; see [`observe`](Self::observe). Takes a [`Model`], an `Arc<Model>` or an `&Arc<Model>`, which all simulations share.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if memory does not suffice, [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate a
    /// simulation.
    pub fn new(model: impl IntoModel, count: usize) -> Result<Self> {
        let model = model.into_model();
        let mut simulations = Vec::new();
        if count > 0 {
            let first = Data::new(model.clone())?;
            check_memory(&first, count)?;
            simulations.try_reserve_exact(count).map_err(|_| no_room("simulations", count))?;
            simulations.push(Simulation::new(first));
        }
        for _ in 1..count {
            simulations.push(Simulation::new(Data::new(model.clone())?));
        }
        let batch = Self {
            observations: Matrix::default(),
            controls: Matrix::zeros(count, model.nu()),
            observe: Box::new(|_, _| ()),
            forward: false,
            substeps: 1,
            chunk: None,
            simulations,
            model,
        };
        let width = batch.model.state_size(StateSpec::PHYSICS);
        // A simulation of another model leaves the row of zeros unchanged.
        Ok(batch.observe(width, |data, row| drop(data.physics_state_into(row))))
    }

    /// Sets the closure that observes a simulation by writing to a row of `nobs` zeros.
    ///
    /// It is called after each step, when computed quantities such as poses and contacts are those of the state before the step, and
    /// after each reset, when no quantities have been computed. [`forward_after_step`](Self::forward_after_step) computes them for the
    /// present state first.
    ///
    /// # Panics
    ///
    /// If memory does not suffice for the observations.
    #[must_use]
    pub fn observe(mut self, nobs: usize, read: impl Fn(&Data, &mut [f64]) + Send + Sync + 'a) -> Self {
        self.observations = Matrix::zeros(self.simulations.len(), nobs);
        self.observe = Box::new(read);
        self.observe_all();
        self
    }

    /// Calls [`Data::forward`] after each [`step`](Self::step) and each reset, so that all quantities that the closure of
    /// [`observe`](Self::observe) reads are those of the present state. This includes sensor readings, which otherwise lag by one
    /// engine step like all computed quantities.
    ///
    /// The simulations are bit for bit the same with and without this call. A simulation in which it fails counts as
    /// [failed](Self::failure).
    ///
    /// It costs one evaluation of forward dynamics per call of [`step`](Self::step), independently of the number of substeps. With one
    /// substep and the integrator `Euler`, this nearly doubles the time of a step.
    ///
    /// ```
    /// use mujoco_safe::{Batch, sample};
    ///
    /// // Observe the height of the left hand of each humanoid.
    /// let model = sample::humanoid();
    /// let hand = model.body("hand_left")?.id();
    /// let mut batch = Batch::new(model, 4)?
    ///     .observe(1, |data, row| row[0] = data.body(hand).xpos()[2])
    ///     .forward_after_step();
    /// assert!(batch.observations()[(0, 0)] > 0.5); // m, in the initial pose
    /// batch.step(|_, _| ())?;
    ///
    /// let mut data = batch.data(0).clone();
    /// data.forward()?;
    /// assert_eq!(batch.observations()[(0, 0)], data.body(hand).xpos()[2]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[must_use]
    pub fn forward_after_step(mut self) -> Self {
        self.forward = true;
        self.observe_all();
        self
    }

    fn observe_all(&mut self) {
        let observer = Observer { read: &*self.observe, forward: self.forward };
        for (index, simulation) in self.simulations.iter_mut().enumerate() {
            simulation.observe(observer, self.observations.row_mut(index));
        }
    }

    /// Sets the number of engine steps per [`step`](Self::step), with the same controls; one by default.
    #[must_use]
    pub fn substeps(mut self, substeps: usize) -> Self {
        self.substeps = substeps;
        self
    }

    /// Sets the number of simulations that a thread takes at a time, at least one. The result does not depend on it. If it is the
    /// number of simulations or more, all run in the calling thread.
    #[must_use]
    pub fn chunk(mut self, simulations: usize) -> Self {
        self.chunk = Some(simulations.max(1));
        self
    }

    /// Returns the number of simulations, `n`.
    pub fn len(&self) -> usize {
        self.simulations.len()
    }

    /// Returns `true` if there are no simulations.
    pub fn is_empty(&self) -> bool {
        self.simulations.is_empty()
    }

    /// Returns the model that the batch was created with.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Returns the observations `(n, nobs)`. The row of a failed simulation is NaN.
    pub fn observations(&self) -> MatrixView<'_> {
        self.observations.view()
    }

    /// Returns the controls that the policy set last `(n, nu)`.
    pub fn controls(&self) -> MatrixView<'_> {
        self.controls.view()
    }

    /// Returns one simulation.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn data(&self, index: usize) -> &Data {
        &self.simulations[index].data
    }

    /// Returns the error of a simulation, if it has failed. A failed simulation is not stepped until it is reset.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn failure(&self, index: usize) -> Option<&Error> {
        self.simulations[index].failure.as_ref()
    }

    /// Returns the number of the present episode of a simulation, which is the number of its resets: 0 in a new batch, 1 after the
    /// first reset. Failed resets count.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn episode(&self, index: usize) -> u64 {
        self.simulations[index].episode
    }

    /// Returns the indices and the errors of all failed simulations.
    pub fn failures(&self) -> impl Iterator<Item = (usize, &Error)> {
        self.simulations
            .iter()
            .enumerate()
            .filter_map(|(index, simulation)| Some((index, simulation.failure.as_ref()?)))
    }

    /// Calls the policy to set the controls `(n, nu)` from the observations `(n, nobs)`, steps all simulations, and observes them.
    /// The controls keep their values from the previous step unless the policy changes them. Does not allocate.
    ///
    /// A simulation that fails is not stepped again until it is reset, and its observations are NaN: see
    /// [`failure`](Self::failure).
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
        let (count, nu) = self.controls.shape();
        let mut controls = MatrixViewMut::from_row_major(count, nu, self.controls.as_mut_slice());
        policy(self.observations.view(), &mut controls).into_result()?;
        let substeps = self.substeps;
        self.each(|_, member| {
            if member.simulation.failure.is_none() {
                member.advance(substeps);
                member.observe();
            }
        });
        Ok(())
    }

    /// Resets the simulations whose index satisfies `which`, calls `start` to set their initial states, and observes them. An edit
    /// of the model by [`Data::edit_model`] in `start`, or a call of [`Data::set_callbacks`], affects that simulation only, and
    /// persists.
    ///
    /// The arguments of `start` are the index, the number of the [`episode`](Self::episode) that starts, and the simulation. The first
    /// reset of a simulation starts its episode 1. Random numbers from a seed of both numbers depend neither on the threads nor on
    /// the order in which the episodes of different simulations end:
    ///
    /// ```
    /// use mujoco_safe::{Batch, sample};
    /// use rand::{RngExt, SeedableRng};
    /// use rand_xoshiro::Xoshiro256PlusPlus;
    ///
    /// let mut batch = Batch::new(sample::cartpole(), 8)?;
    /// batch.reset_where(
    ///     |_| true,
    ///     |index, episode, data| {
    ///         let mut random = Xoshiro256PlusPlus::seed_from_u64(((index as u64) << 32) | episode);
    ///         data.qpos_mut()[1] = random.random_range(-0.1..0.1);
    ///     },
    /// )?;
    /// assert_eq!(batch.episode(3), 1);
    /// assert_ne!(batch.data(3).qpos()[1], batch.data(4).qpos()[1]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The error of the reset or of `start` with the smallest index. All simulations with an error count as failed.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    pub fn reset_where<O: Outcome<Value = ()>>(
        &mut self,
        which: impl Fn(usize) -> bool + Sync,
        start: impl Fn(usize, u64, &mut Data) -> O + Sync,
    ) -> Result<()> {
        let failed = std::sync::Mutex::new(None::<(usize, Error)>);
        self.each(|index, member| {
            if !which(index) {
                return;
            }
            let simulation = &mut *member.simulation;
            let result = simulation
                .restart()
                .and_then(|()| start(index, simulation.episode, &mut simulation.data).into_result());
            if let Err(error) = result {
                simulation.failure = Some(Error::Poisoned { failure: error.to_string() });
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
    /// [`Error::Engine`] if the engine fails, which does not occur for a loaded model.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn reset(&mut self, index: usize) -> Result<()> {
        self.simulations[index].restart()?;
        let observer = Observer { read: &*self.observe, forward: self.forward };
        self.simulations[index].observe(observer, self.observations.row_mut(index));
        Ok(())
    }

    /// Calls `work` for all simulations in parallel.
    fn each(&mut self, work: impl Fn(usize, &mut Member<'_>) + Sync) {
        let chunk = self.chunk.unwrap_or_else(|| default_chunk(self.simulations.len()));
        let stop = AtomicBool::new(false);
        let observer = Observer { read: &*self.observe, forward: self.forward };
        let members = Members {
            simulations: &mut self.simulations,
            controls: self.controls.view(),
            width: self.observations.ncols(),
            observations: self.observations.as_mut_slice(),
        };
        in_chunks(members, 0, chunk, &|first, members| {
            let guard = StopOnPanic::new(&stop);
            let Members { simulations, controls, width, observations } = members;
            for (offset, simulation) in simulations.iter_mut().enumerate() {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let index = first + offset;
                let row = &mut observations[offset * width..][..width];
                work(index, &mut Member { simulation, controls: controls.row(index), row, observer });
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
