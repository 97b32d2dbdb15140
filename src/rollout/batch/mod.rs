//! Batches of simulations that are stepped together.

mod adopt;
mod advance;
mod member;
mod parameters;
mod worker;

use std::fmt;
use std::sync::Arc;

pub(crate) use self::member::Refresh;
use self::member::{Common, Row};
use self::worker::{Worker, continue_from};
use super::Parameters;
use super::workers::{restart, restore};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Outcome, Result};
use crate::matrix::{Matrix, MatrixView};
use crate::memory;
use crate::model::{IntoModel, Model};
use crate::parallel::Pool;

/// Batch of simulations of one model that are stepped together under a policy.
///
/// The policy reads the observations and sets the controls of all simulations. It is called once
/// per step, in the calling thread; stepping, observing and resetting run in parallel. The
/// [module](crate::rollout) documents threads.
///
/// A batch keeps of each simulation only its [state](Self::states), its controls and its
/// observations: two kilobytes for a humanoid. Each thread has one [`Data`], into which it loads
/// the simulations one after another. [`data`](Self::data) and [`load`](Self::load) return a
/// simulation for inspection, and [`edit_where`](Self::edit_where) changes some of them.
///
/// A batch has no rewards, no ends of episodes and no time limits; it neither resets a simulation
/// automatically nor keeps the last observation before a reset. A
/// [`VectorEnvironment`](crate::environment::VectorEnvironment) adds these for reinforcement
/// learning.
///
/// ```
/// use mujoco_safe::rollout::Batch;
/// use mujoco_safe::sample;
///
/// // 16 cart-poles under one policy; the observations are the angle and its rate.
/// let mut batch = Batch::new(sample::cartpole(), 16)?.with_observations(2, |data, row| {
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
    rows: Vec<Row>,
    states: Matrix,
    controls: Matrix,
    observations: Matrix,
    /// Values of the parameters.
    values: Matrix,
    common: Common<'a>,
    /// Index of the first simulation for random numbers.
    first_index: usize,
    substeps: usize,
    chunk: Option<usize>,
}

impl<'a> Batch<'a> {
    /// Creates `count` simulations in the reference position. By default the observation is the
    /// physics state `[qpos; qvel; act]`; see [`with_observations`](Self::with_observations). Takes
    /// a [`Model`], an `Arc<Model>` or an `&Arc<Model>`, which all simulations share.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if memory does not suffice, [`Error::Engine`] or [`Error::OutOfMemory`]
    /// if the engine cannot allocate a simulation, [`Error::Unsupported`] for a model with the
    /// option `sleep`.
    pub fn new(model: impl IntoModel, count: usize) -> Result<Self> {
        let model = model.into_model();
        model.check_without_sleep("a batch")?;
        let numbers = model.state_size(StateSpec::INTEGRATION) + model.nu() + model.state_size(StateSpec::PHYSICS);
        memory::check("simulations", count, numbers * size_of::<f64>() + size_of::<Row>())?;
        let pool = Pool::new(model.clone(), Worker::new);
        let (mut rows, mut states) = (Vec::new(), Matrix::zeros(count, model.state_size(StateSpec::INTEGRATION)));
        if count > 0 {
            let mut lease = pool.lease();
            let data = lease.get()?.data();
            rows.extend((0..count).map(|_| Row::new(data.warning_counters())));
            (0..count).try_for_each(|index| data.state_into(StateSpec::INTEGRATION, states.row_mut(index)))?;
        }
        let batch = Self {
            rows,
            states,
            controls: Matrix::zeros(count, model.nu()),
            observations: Matrix::default(),
            values: Matrix::zeros(count, 0),
            common: Common {
                pool,
                read: Box::new(|_, _| Ok(())),
                refresh: Refresh::default(),
                first_control: model.state_range(StateSpec::INTEGRATION, StateSpec::CTRL).start,
                parameters: Parameters::new(),
            },
            first_index: 0,
            substeps: 1,
            chunk: None,
        };
        let width = model.state_size(StateSpec::PHYSICS);
        Ok(batch.with_observations(width, |data, row| data.physics_state_into(row)))
    }

    /// Sets the closure that observes a simulation by writing to a row of `nobs` zeros.
    ///
    /// The batch calls it after each step, reset and edit. After a step, computed quantities such
    /// as poses and contacts belong to the state before the step. After a reset or an edit, only
    /// the quantities that its closure has computed are available.
    /// [`with_forward_after_step`](Self::with_forward_after_step) computes all quantities for the
    /// present state first. A simulation for which it returns an error counts as
    /// [failed](Self::failure).
    ///
    /// # Panics
    ///
    /// If memory does not suffice for the observations.
    #[must_use]
    pub fn with_observations<O: Outcome<Value = ()>>(
        mut self,
        nobs: usize,
        read: impl Fn(&Data, &mut [f64]) -> O + Send + Sync + 'a,
    ) -> Self {
        self.observations = Matrix::zeros(self.len(), nobs);
        self.common.read = Box::new(move |data, row| read(data, row).into_result());
        self.observe_all();
        self
    }

    /// Calls [`Data::forward`] after each [`step`](Self::step), each reset and each edit, so that
    /// all quantities that the closure of [`with_observations`](Self::with_observations) reads
    /// belong to the present state. This includes sensor readings, which otherwise lag by one
    /// engine step like all computed quantities.
    ///
    /// The simulations are bit for bit the same with and without this call. A simulation in which
    /// it fails counts as [failed](Self::failure).
    ///
    /// It costs one evaluation of forward dynamics per call of [`step`](Self::step), independently
    /// of the number of substeps. With one substep and the integrator `Euler`, this nearly doubles
    /// the time of a step.
    ///
    /// ```
    /// use mujoco_safe::{Batch, sample};
    ///
    /// // Observe the height of the left hand of each humanoid.
    /// let model = sample::humanoid();
    /// let hand = model.body("hand_left")?.id();
    /// let mut batch = Batch::new(model, 4)?
    ///     .with_observations(1, |data, row| row[0] = data.body(hand).xpos()[2])
    ///     .with_forward_after_step();
    /// assert!(batch.observations()[(0, 0)] > 0.5); // m, in the initial pose
    /// batch.step(|_, _| ())?;
    ///
    /// let mut data = batch.data(0)?;
    /// data.forward()?;
    /// assert_eq!(batch.observations()[(0, 0)], data.body(hand).xpos()[2]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[must_use]
    pub fn with_forward_after_step(mut self) -> Self {
        self.common.refresh.forward = true;
        self.common.refresh.forward_after_reset = true;
        self.observe_all();
        self
    }

    /// Sets the computations before an observation of [`step_with`](Self::step_with) and
    /// [`reset_with`](Self::reset_with).
    pub(crate) fn with_refresh(mut self, refresh: Refresh) -> Self {
        self.common.refresh = refresh;
        self
    }

    /// Sets the number of engine steps per [`step`](Self::step), with the same controls; one by
    /// default.
    #[must_use]
    pub fn with_substeps(mut self, substeps: usize) -> Self {
        self.substeps = substeps;
        self
    }

    /// Sets the number of simulations that a thread takes at a time, at least one. The result does
    /// not depend on it. If it is the number of simulations or more, all run in the calling thread.
    #[must_use]
    pub fn with_chunk(mut self, simulations: usize) -> Self {
        self.chunk = Some(simulations.max(1));
        self
    }

    /// Returns the number of simulations, `n`.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns `true` if there are no simulations.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the model that the batch was created with.
    pub fn model(&self) -> &Arc<Model> {
        self.common.pool.model()
    }

    /// Returns the observations `(n, nobs)`. The row of a failed simulation is NaN.
    pub fn observations(&self) -> MatrixView<'_> {
        self.observations.view()
    }

    /// Returns the controls `(n, nu)` that the policy, a reset or an edit set last.
    pub fn controls(&self) -> MatrixView<'_> {
        self.controls.view()
    }

    /// Returns the states of all simulations `(n, nstate)`. A row is a state vector of
    /// [`StateSpec::INTEGRATION`]; [`Model::state_range`] finds a part in it. The controls in a
    /// state are the controls of the last step.
    ///
    /// ```
    /// use mujoco_safe::{Batch, StateSpec, sample};
    ///
    /// let mut batch = Batch::new(sample::humanoid(), 100)?;
    /// batch.step(|_, controls| controls.as_mut_slice().fill(0.1))?;
    /// let qpos = batch.model().state_range(StateSpec::INTEGRATION, StateSpec::QPOS);
    /// let height = batch.states().rows().map(|state| state[qpos.start + 2]).sum::<f64>() / 100.0;
    /// assert!(height > 1.2); // m, on average
    ///
    /// // Save all states, and return to them later.
    /// let saved = batch.states().to_matrix();
    /// batch.step(|_, _| ())?;
    /// batch.edit_where(|_| true, |index, data| data.set_state(StateSpec::INTEGRATION, saved.row(index)))?;
    /// assert_eq!(batch.states().to_matrix(), saved);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn states(&self) -> MatrixView<'_> {
        self.states.view()
    }

    /// Returns a copy of one simulation, for example to draw or to examine it. [`load`](Self::load)
    /// copies it without an allocation.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate the simulation.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn data(&self, index: usize) -> Result<Data> {
        let mut data = Data::new(self.model().clone())?;
        self.load(index, &mut data)?;
        Ok(data)
    }

    /// Sets a simulation to a copy of one of the batch: its state, its warnings, and its model with
    /// edits. `data` keeps its [callbacks](Data::set_callbacks). No quantities have been computed:
    /// see [`Data::forward`].
    ///
    /// The state of a failed simulation is that before the failed step, with the controls of this
    /// step, so that [`Data::step`] returns the same error.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] if `data` belongs to a model that was loaded separately.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    ///
    /// ```
    /// use mujoco_safe::{Batch, Data, Error, sample};
    ///
    /// let mut batch = Batch::new(sample::cartpole(), 3)?;
    /// batch.step(|_, controls| controls.as_mut_slice()[1] = f64::NAN)?;
    /// assert!(matches!(batch.failure(1), Some(Error::Unstable(_))));
    ///
    /// let mut data = Data::new(batch.model())?;
    /// batch.load(1, &mut data)?;
    /// assert!(data.ctrl()[0].is_nan() && data.step().is_err());
    /// batch.load(2, &mut data)?;
    /// assert_eq!(data.time(), 0.01);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn load(&self, index: usize, data: &mut Data) -> Result<()> {
        let row = &self.rows[index];
        self.model().relation(data.model()).check("the data to load a simulation into")?;
        match row
            .overrides
            .as_deref()
            .map(|overrides| &overrides.difference)
            .filter(|difference| !difference.is_empty())
        {
            None => data.swap_model(&mut self.model().clone()),
            Some(difference) => data.edit_model(|model| {
                restore(model, self.model());
                difference.write(self.model(), model);
            })?,
        }
        restart(data)?;
        continue_from(data, self.states.row(index), &row.warnings)
    }

    /// Returns the error of a simulation, if it has failed. A failed simulation is not stepped
    /// until it is reset. Its state is that before the call that failed.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn failure(&self, index: usize) -> Option<&Error> {
        self.rows[index].failure.as_ref()
    }

    /// Returns the number of the present episode of a simulation, which is the number of its
    /// resets: 0 in a new batch, 1 after the first reset. Failed resets count.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    pub fn episode(&self, index: usize) -> u64 {
        self.rows[index].episode
    }

    /// Returns the indices and the errors of all failed simulations.
    pub fn failures(&self) -> impl Iterator<Item = (usize, &Error)> {
        self.rows.iter().enumerate().filter_map(|(index, row)| Some((index, row.failure.as_ref()?)))
    }
}

impl fmt::Debug for Batch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Batch: {} simulations, {} failed, of {:?}", self.len(), self.failures().count(), self.model())
    }
}
