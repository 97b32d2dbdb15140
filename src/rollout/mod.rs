//! Many simulations of one model, on all cores.
//!
//! [`Rollout`] runs each from its initial state to the end: for sampling, for statistics, for control by trying. [`Batch`]
//! advances them together, a step at a time, under a policy that sees them all: for learning.
//!
//! ```
//! use mujoco_safe::rollout::Rollout;
//! use mujoco_safe::{StateSpec, sample};
//!
//! // The cart-pole from five angles, for a second, without control.
//! let angles: Vec<f64> = (0..5).flat_map(|angle| [0.0, 0.1 * f64::from(angle), 0.0, 0.0]).collect();
//! let result = Rollout::new(sample::cartpole(), 5, 100).initial_states(StateSpec::PHYSICS, &angles).run()?;
//! assert!(result.outcomes().iter().all(Result::is_ok));
//! assert_eq!(result.states().len(), 5 * 101 * 4);
//! assert_eq!(result.state(0, 100), [0.0; 4]); // it balances
//! assert!(result.state(1, 100)[1] > 1.0);     // it has fallen
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Threads
//!
//! Both use the [rayon] pool that they are called in, which is the global one unless the call is made within
//! `ThreadPool::install`. Each thread at work has a [`Data`] of its own and takes a chunk of simulations at a time. Each begins
//! with a full reset, so the results are those of a loop over [`Data::step`], bit for bit, for any number of threads and any
//! chunk.
//!
//! # Errors and panics
//!
//! An error of one simulation, from the engine or from a closure, ends that one and is told with its step; the others do not
//! notice. A panic of a closure is a panic of the call, when all threads have stopped; whatever was given to the call can be
//! used again.
//!
//! | file | what is in it |
//! |---|---|
//! | `run.rs` | the simulation of one rollout, and of all |
//! | `result.rs` | what comes out |
//! | `workers.rs` | the simulations that rollouts run in |
//! | `restart.rs` | a reset that costs little |
//! | `batch.rs` | simulations that advance together |
//! | `parallel.rs` | the work cut in chunks |

mod batch;
mod parallel;
mod restart;
mod result;
mod run;
mod workers;

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

pub use self::batch::Batch;
pub use self::result::{RolloutBuffers, RolloutError, RolloutResult};
pub use self::workers::Workers;
use crate::controller::{Controller, Outcome};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::model::{Model, ModelMut};

/// An edit of the model before a rollout.
type Edit<'a> = dyn Fn(usize, &mut ModelMut<'_>) -> Result<()> + Send + Sync + 'a;
/// What reads a row of numbers off a simulation.
type Read<'a> = dyn Fn(&Data, &mut [f64]) + Send + Sync + 'a;
/// What makes the controller of a rollout.
type MakeController<'a> = dyn Fn(usize) -> Box<dyn Controller + 'a> + Send + Sync + 'a;
/// What is told how many are done.
type Progress<'a> = dyn Fn(usize) -> ControlFlow<()> + Send + Sync + 'a;

/// Where rollouts begin.
enum Initial<'a> {
    Reference,
    Shared(StateSpec, &'a [f64]),
    Each(StateSpec, &'a [f64]),
}

/// What sets the controls.
enum Controls<'a> {
    None,
    Shared(&'a [f64]),
    Each(&'a [f64]),
    From(Box<MakeController<'a>>),
}

/// Many simulations of one model, each from its initial state through the same number of steps. See the
/// [module](crate::rollout) for threads, errors and panics.
///
/// In the order of what happens to each:
///
/// 1. a full reset, [`edit_model`](Self::edit_model) before it;
/// 2. the initial state is set, and recorded as row 0;
/// 3. in each step the controls are set, [`Data::step`] is taken, and sensor readings, outputs and the new state are recorded.
///
/// ```
/// use mujoco_safe::rollout::Rollout;
/// use mujoco_safe::{RandomController, StateSpec, sample};
///
/// // Eight humanoids that stand and then move at random, each of another weight.
/// let model = sample::humanoid();
/// let stand = model.key_qpos().row(2).to_vec();
/// let result = Rollout::new(model, 8, 20)
///     .initial_state(StateSpec::QPOS, &stand)
///     .controllers(|index| RandomController::new(index as u64))
///     .edit_model(|index, model| {
///         model.set_total_mass(40.0 + index as f64)?;
///         model.update_constants()
///     })
///     .record(StateSpec::QPOS | StateSpec::QVEL)
///     .outputs(1, |data, row| row[0] = data.actuator_force().iter().map(|force| force.powi(2)).sum())
///     .run()?;
/// assert_eq!(result.states_of(7).shape(), (21, 28 + 27));
/// assert_eq!(result.outputs_of(7).shape(), (20, 1));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[must_use = "nothing is simulated before `run`"]
pub struct Rollout<'a> {
    workers: Workers,
    count: usize,
    steps: usize,
    initial: Initial<'a>,
    controls: Controls<'a>,
    edit: Option<Box<Edit<'a>>>,
    record: StateSpec,
    outputs: Option<(usize, Box<Read<'a>>)>,
    progress: Option<Box<Progress<'a>>>,
    chunk: Option<usize>,
}

impl<'a> Rollout<'a> {
    /// `nroll` simulations of `nstep` steps each: from the reference position, without controls, until something else is said.
    /// Takes a [`Model`] or an `Arc<Model>`.
    pub fn new(model: impl Into<Arc<Model>>, nroll: usize, nstep: usize) -> Self {
        Self::on(&Workers::new(model), nroll, nstep)
    }

    /// As [`new`](Self::new), in simulations that are kept for the next time.
    pub fn on(workers: &Workers, nroll: usize, nstep: usize) -> Self {
        Self {
            workers: workers.clone(),
            count: nroll,
            steps: nstep,
            initial: Initial::Reference,
            controls: Controls::None,
            edit: None,
            record: StateSpec::PHYSICS,
            outputs: None,
            progress: None,
            chunk: None,
        }
    }

    /// All begin in this state: the parts that `spec` names `(nstate)`, and the rest as after a reset. Parts that are inputs,
    /// such as [`XFRC_APPLIED`](StateSpec::XFRC_APPLIED), stay for all steps.
    pub fn initial_state(mut self, spec: StateSpec, state: &'a [f64]) -> Self {
        self.initial = Initial::Shared(spec, state);
        self
    }

    /// Each begins in its own state `(nroll, nstate)`; otherwise as [`initial_state`](Self::initial_state).
    pub fn initial_states(mut self, spec: StateSpec, states: &'a [f64]) -> Self {
        self.initial = Initial::Each(spec, states);
        self
    }

    /// The controls of each rollout and step `(nroll, nstep, nu)`.
    pub fn controls(mut self, controls: &'a [f64]) -> Self {
        self.controls = Controls::Each(controls);
        self
    }

    /// The controls of each step `(nstep, nu)`, the same in all rollouts.
    pub fn shared_controls(mut self, controls: &'a [f64]) -> Self {
        self.controls = Controls::Shared(controls);
        self
    }

    /// Each rollout is under a controller of its own, which is made from the rollout's index when it begins.
    ///
    /// ```
    /// use mujoco_safe::rollout::Rollout;
    /// use mujoco_safe::{Data, sample};
    ///
    /// // The same feedback with four gains; the controls are recorded too.
    /// let result = Rollout::new(sample::cartpole(), 4, 50)
    ///     .controllers(|index| {
    ///         let gain = index as f64;
    ///         move |data: &mut Data| data.ctrl_mut()[0] = gain * (0.1 - data.qpos()[0])
    ///     })
    ///     .outputs(1, |data, row| row.copy_from_slice(data.ctrl()))
    ///     .run()?;
    /// assert_eq!(result.outputs_of(0).as_slice(), [0.0; 50]);
    /// assert_eq!(result.outputs_of(3)[(0, 0)], 3.0 * 0.1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn controllers<C: Controller + 'a>(mut self, make: impl Fn(usize) -> C + Send + Sync + 'a) -> Self {
        self.controls = Controls::From(Box::new(move |index| Box::new(make(index))));
        self
    }

    /// Changes the model for each rollout, given its index. The change is undone after it; the model of the others, and the
    /// one that the rollouts were made with, stay as they are. What an edit cannot change is not copied for it.
    ///
    /// The closure returns nothing or a [`Result`]; an error is that of the rollout, at step 0.
    pub fn edit_model<O: Outcome>(mut self, edit: impl Fn(usize, &mut ModelMut<'_>) -> O + Send + Sync + 'a) -> Self {
        self.edit = Some(Box::new(move |index, model| edit(index, model).into_result()));
        self
    }

    /// Which parts of the state are recorded: [`StateSpec::PHYSICS`] if nothing is said.
    pub fn record(mut self, spec: StateSpec) -> Self {
        self.record = spec;
        self
    }

    /// Records `noutput` numbers more after each step, which the closure writes to a row of zeros. It sees the simulation as
    /// [`Data::step`] leaves it: the state is the new one, what was computed is of the old one.
    pub fn outputs(mut self, noutput: usize, read: impl Fn(&Data, &mut [f64]) + Send + Sync + 'a) -> Self {
        self.outputs = Some((noutput, Box::new(read)));
        self
    }

    /// Calls the closure whenever a rollout has ended, with the number of those that have, from whichever thread. Two threads
    /// may call it at once, and the larger number first. [`ControlFlow::Break`] ends the run: what has not ended then is
    /// [`RolloutError::Cancelled`].
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use mujoco_safe::rollout::{Rollout, RolloutError};
    /// use mujoco_safe::sample;
    ///
    /// let result = Rollout::new(sample::cartpole(), 10, 50)
    ///     .chunk(10)
    ///     .progress(|done| if done < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    ///     .run()?;
    /// assert!(result.outcomes()[..3].iter().all(Result::is_ok));
    /// assert!(matches!(result.outcomes()[3], Err(RolloutError::Cancelled { step: 0 })));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn progress(mut self, hook: impl Fn(usize) -> ControlFlow<()> + Send + Sync + 'a) -> Self {
        self.progress = Some(Box::new(hook));
        self
    }

    /// How many rollouts a thread takes at a time, at least one; the result does not depend on it. If it is `nroll` or more, all
    /// run in the calling thread.
    pub fn chunk(mut self, rollouts: usize) -> Self {
        self.chunk = Some(rollouts.max(1));
        self
    }

    /// Simulates, and returns everything that was recorded.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for initial states or controls of a wrong length, [`Error::Invalid`] if there is no room for the result.
    /// What goes wrong in a rollout is told in its [`outcome`](RolloutResult::outcomes).
    ///
    /// # Panics
    ///
    /// If a closure does.
    pub fn run(&self) -> Result<RolloutResult> {
        self.check_inputs()?;
        let sizes = self.sizes();
        let mut states = reserve("states", sizes.states())?;
        let mut sensordata = reserve("sensor readings", sizes.sensordata())?;
        let mut outputs = reserve("outputs", sizes.outputs())?;
        let buffers = RolloutBuffers {
            states: Some(&mut states),
            sensordata: Some(&mut sensordata),
            outputs: Some(&mut outputs),
        };
        let outcomes = self.run_into(buffers)?;
        Ok(RolloutResult { sizes, states, sensordata, outputs, outcomes })
    }

    /// Simulates, and writes what is recorded to buffers of the caller's. Nothing is allocated in a step.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for initial states, controls or buffers of a wrong length. What goes wrong in a rollout is told in its
    /// place of the list that is returned.
    ///
    /// # Panics
    ///
    /// If a closure does.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Rollout, RolloutBuffers};
    /// use mujoco_safe::sample;
    ///
    /// // Only the heights of the torsos are of interest.
    /// let (nroll, nstep) = (4, 30);
    /// let mut heights = vec![0.0; nroll * nstep];
    /// let buffers = RolloutBuffers { outputs: Some(&mut heights), ..Default::default() };
    /// let outcomes = Rollout::new(sample::humanoid(), nroll, nstep)
    ///     .outputs(1, |data, row| row[0] = data.qpos()[2])
    ///     .run_into(buffers)?;
    /// assert!(outcomes.iter().all(Result::is_ok));
    /// assert!(heights[nstep - 1] < heights[0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn run_into(&self, buffers: RolloutBuffers<'_>) -> Result<Vec<Result<(), RolloutError>>> {
        self.check_inputs()?;
        self.check_buffers(&buffers)?;
        let mut outcomes = reserve_outcomes(self.count)?;
        run::all(self, buffers, &mut outcomes);
        Ok(outcomes)
    }

    fn sizes(&self) -> Sizes {
        let model = self.workers.model();
        Sizes {
            count: self.count,
            steps: self.steps,
            state: model.state_size(self.record),
            sensordata: model.nsensordata(),
            output: self.outputs.as_ref().map_or(0, |(width, _)| *width),
        }
    }

    fn check_inputs(&self) -> Result<()> {
        let model = self.workers.model();
        match &self.initial {
            Initial::Reference => {}
            Initial::Shared(spec, state) => {
                Error::check_length("the initial state (nstate)", state.len(), model.state_size(*spec))?;
            }
            Initial::Each(spec, states) => {
                let expected = self.count.saturating_mul(model.state_size(*spec));
                Error::check_length("the initial states (nroll × nstate)", states.len(), expected)?;
            }
        }
        match &self.controls {
            Controls::None | Controls::From(_) => Ok(()),
            Controls::Shared(controls) => {
                let expected = self.steps.saturating_mul(model.nu());
                Error::check_length("the shared controls (nstep × nu)", controls.len(), expected)
            }
            Controls::Each(controls) => {
                let expected = self.count.saturating_mul(self.steps).saturating_mul(model.nu());
                Error::check_length("the controls (nroll × nstep × nu)", controls.len(), expected)
            }
        }
    }

    fn check_buffers(&self, buffers: &RolloutBuffers<'_>) -> Result<()> {
        let sizes = self.sizes();
        for (what, buffer, expected) in [
            ("the buffer for states (nroll × (nstep + 1) × nstate)", &buffers.states, sizes.states()),
            ("the buffer for sensor readings (nroll × nstep × nsensordata)", &buffers.sensordata, sizes.sensordata()),
            ("the buffer for outputs (nroll × nstep × noutput)", &buffers.outputs, sizes.outputs()),
        ] {
            if let Some(buffer) = buffer {
                Error::check_length(what, buffer.len(), expected)?;
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Rollout<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Rollout: {} of {} steps, of {:?}", self.count, self.steps, self.workers.model())
    }
}

/// The sizes of what is recorded. Products saturate: no buffer is that long.
#[derive(Clone, Copy, Debug)]
struct Sizes {
    count: usize,
    steps: usize,
    state: usize,
    sensordata: usize,
    output: usize,
}

impl Sizes {
    /// The values of one rollout.
    fn states_of_one(self) -> usize {
        self.steps.saturating_add(1).saturating_mul(self.state)
    }

    fn sensordata_of_one(self) -> usize {
        self.steps.saturating_mul(self.sensordata)
    }

    fn outputs_of_one(self) -> usize {
        self.steps.saturating_mul(self.output)
    }

    fn states(self) -> usize {
        self.count.saturating_mul(self.states_of_one())
    }

    fn sensordata(self) -> usize {
        self.count.saturating_mul(self.sensordata_of_one())
    }

    fn outputs(self) -> usize {
        self.count.saturating_mul(self.outputs_of_one())
    }
}

fn no_room(what: &str, length: usize) -> Error {
    Error::invalid(format!("the number of {what}"), length, "as many as there is memory for")
}

/// A buffer of zeros, or an error if there is no memory for so many.
fn reserve(what: &str, length: usize) -> Result<Vec<f64>> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(length).map_err(|_| no_room(what, length))?;
    buffer.resize(length, 0.0);
    Ok(buffer)
}

/// The outcomes of rollouts that were not begun.
fn reserve_outcomes(count: usize) -> Result<Vec<Result<(), RolloutError>>> {
    let mut outcomes = Vec::new();
    outcomes.try_reserve_exact(count).map_err(|_| no_room("rollouts", count))?;
    outcomes.extend((0..count).map(|_| Err(RolloutError::Cancelled { step: 0 })));
    Ok(outcomes)
}
