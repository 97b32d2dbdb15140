//! Planning by iLQR over a receding horizon.

use std::fmt;

use super::observation::Observation;
use super::{PlanReport, Planner};
use crate::control::TimeVaryingLqr;
use crate::control::ilqr::{Forward, IlqrOptions, IlqrTimes, Search, TrajectoryCost};
use crate::data::{Data, StateSpec};
use crate::derivative::{Lineariser, TransitionOptions};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::IntoModel;

/// Number of values of the regularisation that an iteration tries. It bounds the time of a plan.
const ATTEMPTS: usize = 4;

/// Planner that improves its plan by a few iterations of [iLQR](crate::control::ilqr) at a time
/// (Tassa, Erez and Todorov, *Synthesis and stabilization of complex behaviors through online
/// trajectory optimization*, IROS 2012).
///
/// Each plan starts from the previous one, moved forward to the present time: from its controls
/// with feedback about its states, or without feedback if that costs less. The regularisation
/// carries over too. The last backward pass determines the gains.
///
/// After the first plan, a plan in one thread does not allocate, and a plan in several threads
/// allocates only what the queue of rayon's pool needs.
pub struct IlqrPlanner {
    options: IlqrOptions,
    lineariser: Lineariser,
    forward: Forward,
    search: Search,
    observation: Observation,
    /// `(horizon, nu)`: controls of the first trajectory.
    initial: Matrix,
    /// Start of the previous plan, s.
    start: Option<f64>,
}

impl IlqrPlanner {
    /// Creates a planner for plans of `horizon` steps of the model's time step. Each plan makes up
    /// to [`iterations`](IlqrOptions::iterations) iterations; one suffices if plans are frequent.
    /// The first plan starts from zero controls, clamped to their ranges.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the horizon has at least one step, and at most as many as there is
    /// memory for. The errors of [`Ilqr::new`](crate::control::ilqr::Ilqr::new).
    pub fn new(model: impl IntoModel, horizon: usize, options: IlqrOptions) -> Result<Self> {
        let model = model.into_model();
        if horizon == 0 {
            return Err(Error::out_of_range("the horizon of an IlqrPlanner", 0, "at least 1 step"));
        }
        options.check()?;
        let transition = TransitionOptions { threads: options.threads, ..Default::default() };
        Ok(Self {
            lineariser: Lineariser::new(model.clone(), transition)?,
            forward: Forward::new(model.clone(), options.threads),
            search: Search::new(&model, horizon, transition.method)?,
            initial: Matrix::zeros(horizon, model.nu()),
            start: None,
            options,
            observation: Observation::new(model)?,
        })
    }

    /// Sets the controls that the first plan starts from, `(horizon, nu)`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape.
    pub fn with_initial_controls(mut self, controls: Matrix) -> Result<Self> {
        Error::check_shape("the initial controls of an IlqrPlanner", controls.shape(), self.initial.shape())?;
        self.initial = controls;
        Ok(self)
    }

    /// Sets the components of the state that plans start from. By default, these are all of
    /// [`StateSpec::INTEGRATION`] except applied forces: a plan ignores a push. The other
    /// components have the values after a reset.
    #[must_use]
    pub fn with_foreseen(mut self, foreseen: StateSpec) -> Self {
        self.observation.foresee(foreseen);
        self
    }

    /// Returns the options that the planner was created with.
    pub fn options(&self) -> &IlqrOptions {
        &self.options
    }

    /// Returns the times of the parts of the last plan.
    pub fn times(&self) -> IlqrTimes {
        self.search.times
    }

    /// Moves the previous plan to the present time, or starts from the initial controls.
    fn warm_start(&mut self) {
        if let Some(steps) = self.observation.steps_since(self.start) {
            self.search.shift(steps);
        } else {
            self.search.forget();
            self.search.nominal.controls.as_mut_slice().copy_from_slice(self.initial.as_slice());
            self.search.nominal.states.as_mut_slice().fill(0.0);
        }
    }
}

impl Planner for IlqrPlanner {
    fn horizon(&self) -> usize {
        self.initial.nrows()
    }

    fn plan(&mut self, data: &Data, cost: &dyn TrajectoryCost, policy: &mut TimeVaryingLqr) -> Result<PlanReport> {
        if self.observation.observe(data, "the simulation of an IlqrPlanner")? {
            self.search.adopt_ranges(data.model());
        }
        self.warm_start();
        // After an error, the next plan starts from the initial controls.
        self.start = None;
        self.search.times = IlqrTimes::default();
        let Self { options, lineariser, forward, search, observation, .. } = self;
        let data = observation.data();
        forward.start(data, cost)?;
        search.restart(cost, forward)?;
        let initial_cost = search.nominal.cost;
        for _ in 0..options.iterations {
            search.expand(data, cost, lineariser)?;
            if search.iterate(cost, forward, options, ATTEMPTS)?.is_some() {
                break;
            }
        }
        policy.overwrite(data, &search.nominal.states, &search.nominal.controls, &search.policy.gains)?;
        self.start = Some(data.time());
        Ok(PlanReport { initial_cost, cost: self.search.nominal.cost })
    }

    fn reset(&mut self) {
        self.start = None;
    }
}

impl fmt::Debug for IlqrPlanner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "IlqrPlanner: {} steps, {:?}, of {:?}", self.horizon(), self.options, self.observation.data().model())
    }
}
