//! A task in many simulations at once.

mod disturbance;

use std::fmt;
use std::ops::Range;

use self::disturbance::Disturbance;
use super::{Evaluation, Motion, Task, Transition};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::matrix::{Matrix, MatrixView};
use crate::memory;
use crate::model::IntoModel;
use crate::rollout::{Batch, Parameters, Random, Refresh};

/// Simulations of a [`Task`] that step together, each of which starts a new episode when one ends.
///
/// All outputs are contiguous row-major arrays, one row per simulation. After the last step of an
/// episode, [`observations`](Self::observations) has the first observation of the next episode, and
/// [`final_observations`](Self::final_observations) the last one of the ended episode (the mode
/// `SameStep` of Gymnasium's vector environments). Results depend on the seed and the actions only,
/// not on the number of threads.
///
/// The module [`environment`](crate::environment) has examples.
pub struct VectorEnvironment<T> {
    task: T,
    batch: Batch<'static>,
    seed: u64,
    /// States before the last step.
    before: Matrix,
    records: Vec<Record>,
    final_observations: Matrix,
    rewards: Vec<f64>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    /// Numbers of steps in the present episodes.
    steps: Vec<u64>,
    qpos: Range<usize>,
    qvel: Range<usize>,
    has_parameters: bool,
    disturbance: Disturbance,
}

/// Values of a task for one simulation.
#[derive(Clone)]
struct Record {
    memory: Vec<f64>,
    evaluation: Evaluation,
}

impl<T: Task> VectorEnvironment<T> {
    /// Creates `count` simulations of the task, and starts their first episodes. Takes a
    /// [`Model`](crate::Model), an `Arc<Model>` or an `&Arc<Model>`.
    ///
    /// # Errors
    ///
    /// The errors of [`Batch::new`], [`Error::Invalid`] if memory does not suffice for the values
    /// that the task remembers, and the errors of [`reset`](Self::reset).
    ///
    /// # Panics
    ///
    /// If memory does not suffice for the observations.
    pub fn new(model: impl IntoModel, task: T, count: usize, seed: u64) -> Result<Self> {
        let model = model.into_model();
        let (width, remembered, substeps) =
            (task.observation_size(&model), task.memory_size(&model), task.frame_skip());
        let refresh = Refresh {
            // Without a step, there are no quantities of a step.
            forward: task.forward_after_step() || substeps == 0,
            forward_after_reset: task.forward_after_start(),
            body_forces: task.body_forces(),
        };
        // The environment reads observations itself.
        let batch = Batch::new(&model, count)?
            .with_substeps(substeps)
            .with_observations(width, |_, _| ())
            .with_refresh(refresh);
        memory::check("simulations", count, remembered.saturating_mul(size_of::<f64>()))?;
        let record = Record {
            memory: memory::zeros("values that a task remembers", remembered)?,
            evaluation: Evaluation { reward: 0.0, terminated: false },
        };
        let mut environment = Self {
            task,
            batch,
            seed,
            before: Matrix::zeros(count, model.state_size(StateSpec::INTEGRATION)),
            records: vec![record; count],
            final_observations: Matrix::zeros(count, width),
            rewards: vec![0.0; count],
            terminated: vec![false; count],
            truncated: vec![false; count],
            steps: vec![0; count],
            qpos: model.state_range(StateSpec::INTEGRATION, StateSpec::QPOS),
            qvel: model.state_range(StateSpec::INTEGRATION, StateSpec::QVEL),
            has_parameters: false,
            disturbance: Disturbance::none(),
        };
        environment.reset()?;
        Ok(environment)
    }

    /// Draws new values of these parameters of the model at the start of each episode, and starts
    /// new episodes.
    ///
    /// ```
    /// use mujoco_safe::environment::{Hopper, VectorEnvironment};
    /// use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
    ///
    /// let model = Hopper::model();
    /// let torso = Parameter::MassFactor(model.body("torso")?.id());
    /// let parameters = Parameters::new().with(&model, torso, Distribution::Uniform { low: 0.8, high: 1.2 })?;
    /// let hoppers = VectorEnvironment::new(model, Hopper, 4, 42)?.with_parameters(parameters)?;
    /// assert_ne!(hoppers.batch().parameters()[(0, 0)], hoppers.batch().parameters()[(1, 0)]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`Batch::with_parameters`], [`Batch::sample_parameters`] and
    /// [`reset`](Self::reset).
    pub fn with_parameters(mut self, parameters: Parameters) -> Result<Self> {
        self.batch = self.batch.with_parameters(parameters)?;
        self.has_parameters = true;
        self.reset()?;
        Ok(self)
    }

    /// Sets the index that the random numbers of the first simulation depend on, zero by default,
    /// and starts new episodes. If each of several processes has a part of the simulations, and
    /// calls this with the index of its first one, all together compute what one process computes
    /// that does not call it.
    ///
    /// # Errors
    ///
    /// The errors of [`reset`](Self::reset).
    pub fn with_first_index(mut self, index: usize) -> Result<Self> {
        self.batch = self.batch.with_first_index(index);
        self.reset()?;
        Ok(self)
    }

    /// Ends all episodes, and starts new ones.
    ///
    /// # Errors
    ///
    /// The error of [`Task::start`], of [`Data::forward`] after it, of [`Task::observe`] or of
    /// [`Task::remember`] with the smallest index, and [`Error::OtherModel`] if `start` replaces
    /// the simulation by one of a model that was loaded separately.
    pub fn reset(&mut self) -> Result<()> {
        self.terminated.fill(false);
        self.truncated.fill(true);
        self.start_episodes()?;
        self.truncated.fill(false);
        self.rewards.fill(0.0);
        Ok(())
    }

    /// Applies the actions `(n, nu)`, row by row, with the noise and the delay if there are any,
    /// steps all simulations, and starts a new episode where one has ended.
    ///
    /// A simulation that fails, for example by an instability, counts as terminated, with a reward
    /// of zero and a final observation of NaN.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if there are not `n × nu` actions, and nothing is stepped. The error of
    /// [`Task::evaluate`], [`Task::observe`] or [`Task::remember`] with the smallest index, after
    /// all other simulations have been stepped; a simulation with an error counts as failed. The
    /// errors of [`reset`](Self::reset).
    ///
    /// # Panics
    ///
    /// If the task panics.
    pub fn step(&mut self, actions: &[f64]) -> Result<()> {
        let nu = self.batch.model().nu();
        Error::check_length("the actions (n × nu)", actions.len(), self.len().saturating_mul(nu))?;
        self.before.as_mut_slice().copy_from_slice(self.batch.states().as_slice());
        self.disturbance.disturb_actions(actions, &self.steps);
        let actions = self.disturbance.received(actions);
        let (task, states, qpos, qvel) = (&self.task, &self.before, &self.qpos, &self.qvel);
        let substeps = task.frame_skip() as f64;
        let result = self.batch.step_with(actions, &mut self.records, |index, data, record, observation| {
            let state = states.row(index);
            let before = Motion::new(&state[qpos.clone()], &state[qvel.clone()]);
            let (action, duration) = (&actions[index * nu..][..nu], data.model().timestep() * substeps);
            record.evaluation =
                task.evaluate(&Transition { before, action, data, memory: &record.memory, duration })?;
            observe(task, data, record, observation)
        });
        self.final_observations.as_mut_slice().copy_from_slice(self.batch.observations().as_slice());
        let limit = task.time_limit().unwrap_or(u64::MAX);
        for (index, record) in self.records.iter().enumerate() {
            self.steps[index] += 1;
            let failed = Evaluation { reward: 0.0, terminated: true };
            let Evaluation { reward, terminated } =
                if self.batch.failure(index).is_some() { failed } else { record.evaluation };
            (self.rewards[index], self.terminated[index]) = (reward, terminated);
            self.truncated[index] = !terminated && self.steps[index] >= limit;
        }
        if self.disturbance.has_observation_noise() {
            self.disturbance.disturb_observations(&mut self.final_observations);
        }
        result.and(self.start_episodes())
    }

    /// Starts new episodes where one has ended.
    fn start_episodes(&mut self) -> Result<()> {
        let ended = |index: usize| self.terminated[index] || self.truncated[index];
        if !(0..self.rewards.len()).any(ended) {
            return Ok(());
        }
        if self.has_parameters {
            self.batch.sample_parameters(ended, self.seed)?;
        }
        let (task, seed) = (&self.task, self.seed);
        for index in (0..self.rewards.len()).filter(|&index| ended(index)) {
            self.steps[index] = 0;
        }
        let first = self.batch.random_index(0);
        let random_index = |index: usize| first.wrapping_add(index);
        let result = self.batch.reset_with(
            &mut self.records,
            ended,
            |index, episode, data| task.start(&mut Random::new(seed, random_index(index), episode), data),
            |data, record, observation| {
                record.memory.fill(0.0);
                observe(task, data, record, observation)
            },
        );
        for index in (0..self.rewards.len()).filter(|&index| ended(index)) {
            let random = Random::stream(seed, random_index(index), self.batch.episode(index), disturbance::STREAM);
            self.disturbance.start(index, random, self.batch.observations().row(index));
        }
        result
    }
}

impl<T> VectorEnvironment<T> {
    /// Returns the number of simulations, `n`.
    pub fn len(&self) -> usize {
        self.rewards.len()
    }

    /// Returns `true` if there are no simulations.
    pub fn is_empty(&self) -> bool {
        self.rewards.is_empty()
    }

    /// Returns the present observations `(n, nobs)`: after the end of an episode, the first of the
    /// next one.
    pub fn observations(&self) -> MatrixView<'_> {
        if self.disturbance.has_observation_noise() {
            self.disturbance.observations.view()
        } else {
            self.batch.observations()
        }
    }

    /// Returns the observations after the last step, before new episodes started, `(n, nobs)`.
    pub fn final_observations(&self) -> MatrixView<'_> {
        self.final_observations.view()
    }

    /// Returns the rewards of the last step `(n)`.
    pub fn rewards(&self) -> &[f64] {
        &self.rewards
    }

    /// Returns the simulations `(n)` whose episode was ended by the task, or by a failure, in the
    /// last step.
    pub fn terminated(&self) -> &[bool] {
        &self.terminated
    }

    /// Returns the simulations `(n)` whose episode reached the time limit in the last step.
    pub fn truncated(&self) -> &[bool] {
        &self.truncated
    }

    /// Returns the task.
    pub fn task(&self) -> &T {
        &self.task
    }

    /// Returns the simulations, for example to draw one.
    pub fn batch(&self) -> &Batch<'static> {
        &self.batch
    }
}

impl<T> fmt::Debug for VectorEnvironment<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "VectorEnvironment of {}: {:?}", std::any::type_name::<T>(), self.batch)
    }
}

/// Writes the observation of a simulation, and what the task remembers of it.
fn observe(task: &impl Task, data: &Data, record: &mut Record, observation: &mut [f64]) -> Result<()> {
    task.observe(data, observation)?;
    task.remember(data, &mut record.memory)
}
