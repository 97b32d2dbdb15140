//! Environments of reinforcement learning: observations, rewards, ends of episodes and resets, for
//! many simulations at once.
//!
//! A [`Task`] defines the observations, the reward and the end of an episode. A
//! [`VectorEnvironment`] runs a task in a [`Batch`](crate::Batch) of simulations and resets each at
//! the end of its episode, as the vector environments of [Gymnasium](https://gymnasium.farama.org)
//! do. For a single environment, use a batch of one.
//!
//! ```
//! use mujoco_safe::environment::{Hopper, VectorEnvironment};
//!
//! let mut hoppers = VectorEnvironment::new(Hopper::model(), Hopper, 16, 42)?;
//! let mut total = 0.0;
//! for _ in 0..10 {
//!     let actions: Vec<f64> = hoppers.observations().rows().flat_map(|x| [-x[1], 0.0, 0.1]).collect();
//!     hoppers.step(&actions)?;
//!     total += hoppers.rewards().iter().sum::<f64>();
//! }
//! assert!(total > 100.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Ready tasks
//!
//! | task | model | Gymnasium's task with the same observations, rewards and ends |
//! |---|---|---|
//! | [`InvertedPendulum`] | [`sample::cartpole`](crate::sample::cartpole) | [`InvertedPendulum-v5`](https://gymnasium.farama.org/environments/mujoco/inverted_pendulum/) |
//! | [`Hopper`] | one leg with a torso, 3 motors | [`Hopper-v5`](https://gymnasium.farama.org/environments/mujoco/hopper/) |
//! | [`HalfCheetah`] | two legs with a torso, in a plane, 6 motors | [`HalfCheetah-v5`](https://gymnasium.farama.org/environments/mujoco/half_cheetah/) |
//!
//! The models have other dimensions, masses and strengths than Gymnasium's models, so returns
//! cannot be compared.
//!
//! # A task of your own
//!
//! ```
//! use mujoco_safe::environment::{Evaluation, Task, Transition, VectorEnvironment};
//! use mujoco_safe::rollout::Random;
//! use mujoco_safe::{Data, Model, Result, sample};
//!
//! /// Swing the pole up, with little force.
//! struct SwingUp;
//!
//! impl Task for SwingUp {
//!     fn observation_size(&self, model: &Model) -> usize {
//!         model.nq() + model.nv()
//!     }
//!
//!     fn time_limit(&self) -> Option<u64> {
//!         Some(500)
//!     }
//!
//!     fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
//!         data.reset_to_key("hanging_down")?;
//!         data.qpos_mut()[1] += random.uniform(-0.1, 0.1);
//!         Ok(())
//!     }
//!
//!     fn observe(&self, data: &Data, observation: &mut [f64]) {
//!         data.physics_state_into(observation).expect("the observation has the size of the state");
//!     }
//!
//!     fn evaluate(&self, transition: &Transition<'_>) -> Evaluation {
//!         let upright = transition.after.qpos[1].cos();
//!         Evaluation { reward: upright - 0.01 * transition.action[0].powi(2), terminated: false }
//!     }
//! }
//!
//! let mut environment = VectorEnvironment::new(sample::cartpole(), SwingUp, 1, 7)?;
//! environment.step(&[1.0])?;
//! assert!(environment.rewards()[0] < 0.2);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```

mod tasks;
mod vector;

pub use self::tasks::{HalfCheetah, Hopper, InvertedPendulum};
pub use self::vector::VectorEnvironment;
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;
use crate::rollout::Random;

/// Definition of a task: initial states, observations, rewards and the end of an episode.
pub trait Task: Send + Sync {
    /// Returns the number of values in an observation.
    fn observation_size(&self, model: &Model) -> usize;

    /// Returns the number of engine steps per step of the environment, with the same action; one by
    /// default.
    fn frame_skip(&self) -> usize {
        1
    }

    /// Returns the number of steps after which an episode is truncated, if any. By default,
    /// episodes have no limit.
    fn time_limit(&self) -> Option<u64> {
        None
    }

    /// Sets the initial state of an episode. The simulation has been reset. The random numbers are
    /// determined by the seed of the environment, the index of the simulation and the number of the
    /// episode.
    ///
    /// # Errors
    ///
    /// Any error of the task, for example from a call on the simulation.
    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()>;

    /// Writes the observation of a simulation to a row of zeros.
    ///
    /// Poses, contacts and sensor readings belong to the state before the last engine step, unless
    /// the environment was created with
    /// [`with_forward_after_step`](VectorEnvironment::with_forward_after_step).
    fn observe(&self, data: &Data, observation: &mut [f64]);

    /// Returns the reward of a step, and if the episode ends in its new state.
    fn evaluate(&self, transition: &Transition<'_>) -> Evaluation;
}

/// Positions and velocities of a simulation.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Motion<'t> {
    /// Positions `(nq)`.
    pub qpos: &'t [f64],
    /// Velocities `(nv)`.
    pub qvel: &'t [f64],
}

impl<'t> Motion<'t> {
    /// Combines positions and velocities.
    pub fn new(qpos: &'t [f64], qvel: &'t [f64]) -> Self {
        Self { qpos, qvel }
    }
}

/// Step of an environment.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Transition<'t> {
    /// Motion before the step.
    pub before: Motion<'t>,
    /// Action `(nu)`: the controls during the step.
    pub action: &'t [f64],
    /// Motion after the step.
    pub after: Motion<'t>,
    /// Duration of the step, s: the time step of the model times the frame skip.
    pub duration: f64,
}

impl<'t> Transition<'t> {
    /// Combines the parts of a step.
    pub fn new(before: Motion<'t>, action: &'t [f64], after: Motion<'t>, duration: f64) -> Self {
        Self { before, action, after, duration }
    }
}

/// Reward of a step, and the end of the episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Reward of the step.
    pub reward: f64,
    /// `true` if the new state ends the episode: success or failure of the task, but not the time
    /// limit.
    pub terminated: bool,
}
