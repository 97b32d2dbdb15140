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
//! A task needs the length of its observation, the initial states, the observation and the reward:
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
//!     fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
//!         data.physics_state_into(observation)
//!     }
//!
//!     fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
//!         let upright = transition.data.qpos()[1].cos();
//!         Ok(Evaluation { reward: upright - 0.01 * transition.action[0].powi(2), terminated: false })
//!     }
//! }
//!
//! let mut environment = VectorEnvironment::new(sample::cartpole(), SwingUp, 1, 7)?;
//! environment.step(&[1.0])?;
//! assert!(environment.rewards()[0] < 0.2);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Rewards and observations can depend on all quantities of the simulation: poses, sensor readings,
//! contacts and forces. Random quantities of an episode, such as a target, are best a part of the
//! simulation: of a mocap body, of a joint as in Gymnasium's `Reacher`, or of
//! [`userdata`](Data::userdata). So the observation and the reward can read them.
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use mujoco_safe::environment::{Evaluation, Task, Transition, VectorEnvironment};
//! use mujoco_safe::id::SiteId;
//! use mujoco_safe::rollout::Random;
//! use mujoco_safe::{Data, Model, Result};
//!
//! const ARM: &str = r#"<mujoco><option gravity="0 0 0"/><worldbody>
//!     <body name="target" mocap="true"/>
//!     <geom name="wall" type="box" pos="-.18 0 0" size=".01 .3 .1"/>
//!     <body>
//!       <joint name="shoulder" axis="0 0 1" damping=".002"/>
//!       <geom name="upper_arm" type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>
//!       <body pos=".1 0 0">
//!         <joint name="elbow" axis="0 0 1" damping=".002"/>
//!         <geom name="lower_arm" type="capsule" fromto="0 0 0 .1 0 0" size=".01"/>
//!         <site name="tip" pos=".1 0 0"/>
//!       </body>
//!     </body></worldbody>
//!   <actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator></mujoco>"#;
//!
//! /// Move the tip of an arm to a target, and do not touch the wall.
//! struct Reach {
//!     tip: SiteId,
//! }
//!
//! impl Reach {
//!     /// Returns the position of the tip relative to the target, in the plane, m.
//!     fn offset(&self, data: &Data) -> [f64; 2] {
//!         let (tip, target) = (data.site(self.tip).xpos(), data.mocap_pos()[0]);
//!         [tip[0] - target[0], tip[1] - target[1]]
//!     }
//! }
//!
//! impl Task for Reach {
//!     fn observation_size(&self, _: &Model) -> usize {
//!         2 + 2 + 2
//!     }
//!
//!     fn frame_skip(&self) -> usize {
//!         5
//!     }
//!
//!     fn time_limit(&self) -> Option<u64> {
//!         Some(200)
//!     }
//!
//!     fn forward_after_step(&self) -> bool {
//!         true // so that the position of the tip is that of the present state
//!     }
//!
//!     fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
//!         let (radius, angle) = (random.uniform(0.05, 0.2), random.uniform(-0.5 * PI, 0.5 * PI));
//!         data.mocap_pos_mut()[0] = [radius * angle.cos(), radius * angle.sin(), 0.0];
//!         Ok(())
//!     }
//!
//!     fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
//!         observation[..2].copy_from_slice(data.qpos());
//!         observation[2..4].copy_from_slice(data.qvel());
//!         observation[4..].copy_from_slice(&self.offset(data));
//!         Ok(())
//!     }
//!
//!     fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
//!         let [x, y] = self.offset(transition.data);
//!         let effort: f64 = transition.action.iter().map(|torque| torque * torque).sum();
//!         let touches = transition.data.ncon() > 0;
//!         Ok(Evaluation { reward: -x.hypot(y) - 0.01 * effort, terminated: touches })
//!     }
//! }
//!
//! let model = Model::from_xml_str(ARM)?;
//! let tip = model.site("tip")?.id();
//! let mut arms = VectorEnvironment::new(model, Reach { tip }, 8, 42)?;
//! let mut touched = false;
//! for _ in 0..200 {
//!     arms.step(&[0.01, 0.0].repeat(8))?;
//!     touched |= arms.terminated().contains(&true);
//! }
//! assert!(touched);
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
///
/// After an action, the environment calls [`evaluate`](Self::evaluate), [`observe`](Self::observe)
/// and [`remember`](Self::remember) with the simulation, in the threads that step the simulations.
/// Its quantities belong to these states:
///
/// | quantities | after `start` | after an action | with `forward_after_step` |
/// |---|---|---|---|
/// | `qpos`, `qvel`, `act`, `time`, controls, mocap bodies, `userdata` | present | present | present |
/// | poses, velocities of bodies, contacts, forces, accelerations, sensor readings | present | those of the [last engine step](crate::guide::concepts#age-of-results), which belong to the state before it | present |
/// | `cacc`, `cfrc_int`, `cfrc_ext`, with [`body_forces`](Self::body_forces) | present | those of the last engine step | present |
///
/// The task reads the simulation, and changes it only in [`start`](Self::start). Edits of the model
/// in `start` affect one simulation, and persist; [`Batch::reset_where`](crate::Batch::reset_where)
/// states their cost, and [`with_parameters`](VectorEnvironment::with_parameters) varies the model
/// without it.
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

    /// Returns `true` if [`Data::forward`] is called after the engine steps of an action, so that
    /// poses, contacts, forces and sensor readings belong to the present state; `false` by default.
    /// This costs one evaluation of forward dynamics per action, and does not change the results of
    /// later steps: see [`Batch::with_forward_after_step`](crate::Batch::with_forward_after_step).
    fn forward_after_step(&self) -> bool {
        false
    }

    /// Returns `true` if [`Data::forward`] is called after [`start`](Self::start); `true` by
    /// default. This costs one evaluation of forward dynamics per episode, and does not change the
    /// results of later steps. Without it, only quantities that `start` computes are available at
    /// the start of an episode, which suffices for a task that reads positions and velocities.
    fn forward_after_start(&self) -> bool {
        true
    }

    /// Returns `true` if [`Data::rne_post_constraint`] computes the accelerations of the bodies and
    /// the forces on them, `cacc`, `cfrc_int` and `cfrc_ext`, after an action and after the forward
    /// dynamics of a start; `false` by default.
    fn body_forces(&self) -> bool {
        false
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
    /// # Errors
    ///
    /// Any error of the task: [`VectorEnvironment::step`] returns it. The results of the last step
    /// or of [`forward_after_step`](Self::forward_after_step) are present, so calls that need them,
    /// such as [`Contact::force`](crate::data::Contact::force), do not fail.
    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()>;

    /// Returns the reward of a step, and if the episode ends in its new state.
    ///
    /// # Errors
    ///
    /// As for [`observe`](Self::observe).
    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation>;

    /// Returns the number of values that the task [remembers](Self::remember) of each simulation;
    /// none by default.
    fn memory_size(&self, model: &Model) -> usize {
        let _ = model;
        0
    }

    /// Updates the values that [`Transition::memory`] contains in the next step, such as a pose
    /// before the step, the previous action, or the time since a foot touched the ground. They are
    /// zero at the start of an episode. By default, the task remembers nothing.
    ///
    /// # Errors
    ///
    /// As for [`observe`](Self::observe).
    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        let _ = (data, memory);
        Ok(())
    }
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
    /// Simulation after the step. [`Task`] states which of its quantities belong to the present
    /// state.
    pub data: &'t Data,
    /// Values that the task [remembered](Task::remember) before the step.
    pub memory: &'t [f64],
    /// Duration of the step, s: the time step of the model times the frame skip.
    pub duration: f64,
}

impl<'t> Transition<'t> {
    /// Combines the parts of a step.
    pub fn new(before: Motion<'t>, action: &'t [f64], data: &'t Data, memory: &'t [f64], duration: f64) -> Self {
        Self { before, action, data, memory, duration }
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
