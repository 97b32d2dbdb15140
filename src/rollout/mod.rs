//! Parallel simulations of one model.
//!
//! [`Rollout`] runs each simulation from its initial state to the end: for sampling, statistics and
//! predictive control. [`Batch`] steps all simulations together under a common policy;
//! [`environment`](crate::environment) adds what reinforcement learning needs.
//!
//! ```
//! use mujoco_safe::rollout::Rollout;
//! use mujoco_safe::{StateSpec, sample};
//!
//! // Simulate the cart-pole from five angles for a second, without control.
//! let states: Vec<f64> = (0..5).flat_map(|i| [0.0, 0.1 * f64::from(i), 0.0, 0.0]).collect();
//! let rollout = Rollout::new(sample::cartpole(), 5, 100);
//! let result = rollout.with_initial_states(StateSpec::PHYSICS, &states).run()?;
//! assert!(result.outcomes().iter().all(Result::is_ok));
//! assert_eq!(result.states().len(), 5 * 101 * 4);
//! assert_eq!(result.state(0, 100), [0.0; 4]); // upright
//! assert!(result.state(1, 100)[1] > 1.0);     // fallen
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Threads
//!
//! Both use the current [rayon] pool, which is the global one unless the call is inside
//! `ThreadPool::install`. Each thread has its own [`Data`] and takes a chunk of simulations at a
//! time. Each simulation starts with a full reset, so the results equal the results of a loop over
//! [`Data::step`], bit for bit, for any number of threads and any chunk size.
//!
//! # Errors and panics
//!
//! An error of the engine or of a closure ends the simulation in which it occurs and is reported
//! with its step; other simulations continue. If a closure panics, the call panics after all
//! threads have stopped. All arguments of the call remain usable.

mod batch;
#[cfg(feature = "npz")]
mod npz;
mod parameter;
mod result;
mod run;
mod workers;

use std::fmt;
use std::ops::ControlFlow;

pub use self::batch::Batch;
pub(crate) use self::batch::Refresh;
pub use self::parameter::{Distribution, FieldNumber, Parameter, Parameters, Random};
pub use self::result::{RolloutBuffers, RolloutError, RolloutResult};
use self::result::{Sizes, reserve_outcomes};
pub use self::workers::Workers;
pub(crate) use self::workers::restart;
pub(crate) use self::workers::restore;
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Outcome, Result};
use crate::memory;
use crate::model::{IntoModel, ModelMut};

/// Edit of the model before a rollout.
type Edit<'a> = dyn Fn(usize, &mut ModelMut<'_>) -> Result<()> + Send + Sync + 'a;
/// Closure that reads a row of outputs or observations from a simulation.
type Read<'a> = dyn Fn(&Data, &mut [f64]) -> Result<()> + Send + Sync + 'a;
/// Closure that creates the controller of a rollout.
type MakeController<'a> = dyn Fn(usize) -> Box<dyn Controller + 'a> + Send + Sync + 'a;
/// Progress hook, called with the number of completed rollouts.
type Progress<'a> = dyn Fn(usize) -> ControlFlow<()> + Send + Sync + 'a;

/// Initial states of rollouts.
enum Initial<'a> {
    Reference,
    Shared(StateSpec, &'a [f64]),
    Each(StateSpec, &'a [f64]),
}

/// Source of the controls.
enum Controls<'a> {
    None,
    Shared(&'a [f64]),
    Each(&'a [f64]),
    From(Box<MakeController<'a>>),
}

/// Builder for simulations of one model, each from its initial state over the same number of steps.
/// The [module](crate::rollout) documents threads, errors and panics.
///
/// Each rollout
///
/// 1. applies [`with_model_edits`](Self::with_model_edits), and resets the simulation;
/// 2. sets the initial state, and records it as row 0;
/// 3. in each step sets the controls, calls [`Data::step`], and records sensor readings, outputs
///    and the new state. [`with_forward_after_step`](Self::with_forward_after_step) updates the
///    quantities that the outputs are computed from.
///
/// ```
/// use mujoco_safe::rollout::Rollout;
/// use mujoco_safe::{RandomController, StateSpec, sample};
///
/// // Eight humanoids of different weights, which stand at first and move at random.
/// let model = sample::humanoid();
/// let stand = model.key_qpos().row(2).to_vec();
/// let result = Rollout::new(model, 8, 20)
///     .with_initial_state(StateSpec::QPOS, &stand)
///     .with_controllers(|index| RandomController::new(index as u64))
///     .with_model_edits(|index, model| {
///         model.set_total_mass(40.0 + index as f64)?;
///         model.update_constants()
///     })
///     .with_recorded_states(StateSpec::QPOS | StateSpec::QVEL)
///     .with_outputs(1, |data, row| row[0] = data.actuator_force().iter().map(|force| force.powi(2)).sum())
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
    forward: bool,
    progress: Option<Box<Progress<'a>>>,
    chunk: Option<usize>,
}

impl<'a> Rollout<'a> {
    /// Creates a builder for `nroll` simulations of `nstep` steps, by default from the reference
    /// position and with zero controls. Takes a [`Model`](crate::Model), an `Arc<Model>` or an
    /// `&Arc<Model>`.
    pub fn new(model: impl IntoModel, nroll: usize, nstep: usize) -> Self {
        Self::on(&Workers::new(model), nroll, nstep)
    }

    /// Creates a builder as [`new`](Self::new) does, whose simulations run on existing workers.
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
            forward: false,
            progress: None,
            chunk: None,
        }
    }

    /// Sets the common initial state `(nstate)`: the components in `spec`; the others have their
    /// values after a reset. Inputs, such as [`XFRC_APPLIED`](StateSpec::XFRC_APPLIED), apply in
    /// all steps.
    pub fn with_initial_state(mut self, spec: StateSpec, state: &'a [f64]) -> Self {
        self.initial = Initial::Shared(spec, state);
        self
    }

    /// Sets the initial state of each rollout `(nroll, nstate)`, as
    /// [`with_initial_state`](Self::with_initial_state) does for all.
    pub fn with_initial_states(mut self, spec: StateSpec, states: &'a [f64]) -> Self {
        self.initial = Initial::Each(spec, states);
        self
    }

    /// Sets the controls of each rollout and step `(nroll, nstep, nu)`.
    pub fn with_controls(mut self, controls: &'a [f64]) -> Self {
        self.controls = Controls::Each(controls);
        self
    }

    /// Sets the controls of each step `(nstep, nu)`, common to all rollouts.
    pub fn with_shared_controls(mut self, controls: &'a [f64]) -> Self {
        self.controls = Controls::Shared(controls);
        self
    }

    /// Sets a closure that creates the controller of each rollout from its index, when the rollout
    /// starts.
    ///
    /// ```
    /// use mujoco_safe::rollout::Rollout;
    /// use mujoco_safe::{Data, sample};
    ///
    /// // Compare four gains of the same feedback, and record the controls.
    /// let result = Rollout::new(sample::cartpole(), 4, 50)
    ///     .with_controllers(|index| {
    ///         let gain = index as f64;
    ///         move |data: &mut Data| data.ctrl_mut()[0] = gain * (0.1 - data.qpos()[0])
    ///     })
    ///     .with_outputs(1, |data, row| row.copy_from_slice(data.ctrl()))
    ///     .run()?;
    /// assert_eq!(result.outputs_of(0).as_slice(), [0.0; 50]);
    /// assert_eq!(result.outputs_of(3)[(0, 0)], 3.0 * 0.1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn with_controllers<C: Controller + 'a>(mut self, make: impl Fn(usize) -> C + Send + Sync + 'a) -> Self {
        self.controls = Controls::From(Box::new(move |index| Box::new(make(index))));
        self
    }

    /// Sets a closure that edits the model for each rollout, given its index.
    ///
    /// The edit applies to one rollout only; other rollouts and the shared model are unaffected.
    /// Parts of the model that an edit cannot change are not copied. The closure returns nothing or
    /// a [`Result`]; an error fails the rollout at step 0.
    pub fn with_model_edits<O: Outcome<Value = ()>>(
        mut self,
        edit: impl Fn(usize, &mut ModelMut<'_>) -> O + Send + Sync + 'a,
    ) -> Self {
        self.edit = Some(Box::new(move |index, model| edit(index, model).into_result()));
        self
    }

    /// Sets the recorded components of the state; [`StateSpec::PHYSICS`] by default.
    pub fn with_recorded_states(mut self, spec: StateSpec) -> Self {
        self.record = spec;
        self
    }

    /// Records `noutput` additional values after each step, which the closure writes to a row of
    /// zeros. At that point, as always after [`Data::step`], the simulation is in the new state and
    /// its computed quantities belong to the old state.
    /// [`with_forward_after_step`](Self::with_forward_after_step) computes them for the new state
    /// first. An error of the closure ends the rollout after the step, whose outputs are NaN.
    pub fn with_outputs<O: Outcome<Value = ()>>(
        mut self,
        noutput: usize,
        read: impl Fn(&Data, &mut [f64]) -> O + Send + Sync + 'a,
    ) -> Self {
        self.outputs = Some((noutput, Box::new(move |data, row| read(data, row).into_result())));
        self
    }

    /// Calls [`Data::forward`] after each step, so that all quantities that the closure of
    /// [`with_outputs`](Self::with_outputs) reads, such as poses, contacts and sensor readings,
    /// belong to the new state.
    ///
    /// The recorded states and sensor readings are bit for bit the same with and without this call,
    /// unless a controller reads computed quantities: these too then belong to the present state,
    /// except in the first step. An error of this call ends the rollout after the step, and the
    /// outputs of that step are NaN.
    ///
    /// It costs one evaluation of forward dynamics per step. With the integrator `Euler`, this
    /// nearly doubles the time of a step.
    ///
    /// ```
    /// use mujoco_safe::rollout::Rollout;
    /// use mujoco_safe::sample;
    ///
    /// // Record the position of the cart's frame after each step.
    /// let model = sample::cartpole();
    /// let cart = model.body("cart")?.id();
    /// let result = Rollout::new(model, 1, 50)
    ///     .with_shared_controls(&[1.0; 50])
    ///     .with_outputs(1, |data, row| row[0] = data.body(cart).xpos()[0])
    ///     .with_forward_after_step()
    ///     .run()?;
    /// assert!((0..50).all(|step| result.outputs_of(0)[(step, 0)] == result.state(0, step + 1)[0]));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn with_forward_after_step(mut self) -> Self {
        self.forward = true;
        self
    }

    /// Sets a hook that is called after each rollout with the number of completed rollouts.
    ///
    /// Several threads may call the hook concurrently, possibly not in the order of these numbers.
    /// [`ControlFlow::Break`] ends the run; rollouts that are not complete end with
    /// [`RolloutError::Cancelled`].
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use mujoco_safe::rollout::{Rollout, RolloutError};
    /// use mujoco_safe::sample;
    ///
    /// let result = Rollout::new(sample::cartpole(), 10, 50)
    ///     .with_chunk(10)
    ///     .with_progress(|done| if done < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    ///     .run()?;
    /// assert!(result.outcomes()[..3].iter().all(Result::is_ok));
    /// assert!(matches!(result.outcomes()[3], Err(RolloutError::Cancelled { step: 0 })));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn with_progress(mut self, hook: impl Fn(usize) -> ControlFlow<()> + Send + Sync + 'a) -> Self {
        self.progress = Some(Box::new(hook));
        self
    }

    /// Sets the number of rollouts that a thread takes at a time, at least one. The result does not
    /// depend on it. If it is `nroll` or more, all rollouts run in the calling thread.
    pub fn with_chunk(mut self, rollouts: usize) -> Self {
        self.chunk = Some(rollouts.max(1));
        self
    }

    /// Runs all rollouts, and returns the recorded values.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for initial states or controls of a wrong length, [`Error::Invalid`] if
    /// memory does not suffice for the result. Errors in a rollout are in its
    /// [`outcome`](RolloutResult::outcomes).
    ///
    /// # Panics
    ///
    /// If a closure panics.
    pub fn run(&self) -> Result<RolloutResult> {
        self.check_inputs()?;
        let sizes = self.sizes();
        let mut states = memory::zeros("states", sizes.states())?;
        let mut sensordata = memory::zeros("sensor readings", sizes.sensordata())?;
        let mut outputs = memory::zeros("outputs", sizes.outputs())?;
        let buffers = RolloutBuffers {
            states: Some(&mut states),
            sensordata: Some(&mut sensordata),
            outputs: Some(&mut outputs),
        };
        let outcomes = self.run_into(buffers)?;
        Ok(RolloutResult { sizes, states, sensordata, outputs, outcomes })
    }

    /// Runs all rollouts, and writes the recorded values to the caller's buffers. Steps do not
    /// allocate.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for initial states, controls or buffers of a wrong length. Errors in a
    /// rollout are in its entry of the returned list.
    ///
    /// # Panics
    ///
    /// If a closure panics.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Rollout, RolloutBuffers};
    /// use mujoco_safe::sample;
    ///
    /// // Record only the heights of the torsos.
    /// let (nroll, nstep) = (4, 30);
    /// let mut heights = vec![0.0; nroll * nstep];
    /// let buffers = RolloutBuffers { outputs: Some(&mut heights), ..Default::default() };
    /// let outcomes = Rollout::new(sample::humanoid(), nroll, nstep)
    ///     .with_outputs(1, |data, row| row[0] = data.qpos()[2])
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
