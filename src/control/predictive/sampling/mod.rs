//! Planning by sampling over a receding horizon.

mod candidates;
mod law;
mod options;
mod spline;

use std::fmt;

use self::candidates::Candidates;
use self::law::Law;
pub use self::options::SamplingOptions;
pub use self::spline::Interpolation;
use super::observation::Observation;
use super::{PlanReport, Planner};
use crate::control::ilqr::{Forward, TrajectoryCost, Trial};
use crate::control::{Lqr, TimeVaryingLqr};
use crate::data::{Data, StateSpec};
use crate::derivative;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::IntoModel;

/// Planner that simulates random variations of its previous plan.
///
/// The controls of a plan are a spline with a few knots. Each iteration adds normally distributed
/// noise to the knots, within the control ranges, and simulates these candidates in parallel.
///
/// - With a [temperature](SamplingOptions::temperature) of zero, the candidate of minimal cost is
///   the new plan: predictive sampling (T. Howell et al., *Predictive Sampling: Real-time Behaviour
///   Synthesis with MuJoCo*, 2022). The previous plan is one of the candidates, so an iteration
///   never increases the cost.
/// - With a temperature λ above zero, the knots of the new plan are the mean of the candidates'
///   knots with the weights `exp(−(J − J_min) / λ)` for costs J: model predictive path integral
///   control (MPPI; G. Williams et al., *Information theoretic MPC for model-based reinforcement
///   learning*, ICRA 2017). The cost of the mean can exceed the cost of the best candidate. If its
///   simulation is unstable, the best candidate is the plan. Costs of the noise, which the paper
///   adds, are absent.
///
/// The previous plan is moved forward to the present time without interpolation, because the times
/// of the knots do not change. The gains of the plan are zero, or the gains of the
/// [regulator](Self::with_regulator).
///
/// The cost needs no derivatives, and is evaluated as for [`Ilqr`](crate::control::ilqr::Ilqr). The
/// plan depends on the seed, but not on the number of threads: each candidate has its own random
/// numbers and is simulated from a reset simulation. After the first plan, a plan in one thread
/// does not allocate, and a plan in several threads allocates only what the queue of rayon's pool
/// needs.
///
/// ```
/// use mujoco_safe::control::ilqr::TrajectoryCost;
/// use mujoco_safe::control::predictive::{PredictiveController, SamplingOptions, SamplingPlanner};
/// use mujoco_safe::{Controller, Data, Result, sample};
///
/// /// Cost with a step at 0.1 rad, which has no useful derivative.
/// struct Upright;
///
/// impl TrajectoryCost for Upright {
///     fn value(&self, _step: usize, state: &[f64], _controls: Option<&[f64]>) -> Result<f64> {
///         let [x, angle, velocity, rate] = *state else { return Ok(0.0) };
///         Ok(f64::from(u8::from(angle.abs() > 0.1)) + angle * angle + 0.1 * x * x + 0.05 * (velocity * velocity + rate * rate))
///     }
/// }
///
/// let mut data = Data::new(sample::cartpole())?;
/// data.qpos_mut()[1] = 0.15;
/// let options = SamplingOptions::default().with_samples(16);
/// let planner = SamplingPlanner::new(data.model(), 50, options)?;
/// let mut controller = PredictiveController::new(&data, planner, Upright, 4)?;
/// for _ in 0..200 {
///     controller.control(&mut data)?;
///     data.step()?;
/// }
/// assert!(data.qpos()[1].abs() < 0.1, "the pole is upright");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub struct SamplingPlanner {
    horizon: usize,
    options: SamplingOptions,
    regulator: Option<Lqr>,
    forward: Forward,
    observation: Observation,
    candidates: Candidates,
    /// Trajectory of the plan.
    plan: Trial,
    /// Gains of the plan, one for each step.
    gains: Vec<Matrix>,
    /// Weights of the candidates.
    weights: Vec<f64>,
    /// Start of the previous plan, s.
    start: Option<f64>,
}

impl SamplingPlanner {
    /// Creates a planner for plans of `horizon` steps of the model's time step. The first plan
    /// starts from zero controls, clamped to their ranges.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the horizon has at least one step, all numbers of the options are
    /// at least 1, and the deviations and the temperature are finite and not negative;
    /// [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate a simulation.
    pub fn new(model: impl IntoModel, horizon: usize, options: SamplingOptions) -> Result<Self> {
        let model = model.into_model();
        if horizon == 0 {
            return Err(Error::out_of_range("the horizon of a SamplingPlanner", 0, "at least 1 step"));
        }
        options.check()?;
        let (nx, nu, _) = derivative::sizes(&model);
        let mut candidates = Candidates::new(horizon, &options, nu);
        candidates.adopt_ranges(&model, false);
        Ok(Self {
            regulator: None,
            forward: Forward::new(model.clone(), options.threads),
            candidates,
            plan: Trial::zeros(&model, horizon),
            gains: vec![Matrix::zeros(nu, nx); horizon],
            weights: vec![0.0; options.samples],
            start: None,
            horizon,
            options,
            observation: Observation::new(model)?,
        })
    }

    /// Sets the controls that the first plan holds, `(nu)`. With a regulator, they are added to its
    /// controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_initial_controls(mut self, controls: &[f64]) -> Result<Self> {
        let nu = self.observation.data().model().nu();
        Error::check_length("the initial controls of a SamplingPlanner", controls.len(), nu)?;
        self.candidates.set_initial(controls);
        Ok(self)
    }

    /// Adds the controls of a regulator to the spline of each candidate. The regulator alone is the
    /// second candidate of each iteration. The plan has the gains of the regulator, so it corrects
    /// deviations between two plans. Sampling about a regulator stabilises simulations that fall
    /// within the horizon under controls without feedback.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the regulator is for a model with other sizes.
    pub fn with_regulator(mut self, regulator: Lqr) -> Result<Self> {
        let model = self.observation.data().model();
        let (nx, nu, _) = derivative::sizes(model);
        Error::check_length("the positions of the regulator", regulator.qpos0().len(), model.nq())?;
        Error::check_shape("the gain of the regulator", regulator.gain().shape(), (nu, nx))?;
        self.gains = vec![regulator.gain().clone(); self.horizon];
        self.candidates.adopt_ranges(model, true);
        self.regulator = Some(regulator);
        Ok(self)
    }

    /// Sets the components of the state that plans start from, as
    /// [`IlqrPlanner::with_foreseen`](super::IlqrPlanner::with_foreseen) does.
    #[must_use]
    pub fn with_foreseen(mut self, foreseen: StateSpec) -> Self {
        self.observation.foresee(foreseen);
        self
    }

    /// Returns the options that the planner was created with.
    pub fn options(&self) -> &SamplingOptions {
        &self.options
    }

    /// Moves the previous plan to the present time, or starts from the initial controls.
    fn warm_start(&mut self) {
        match self.observation.steps_since(self.start) {
            Some(steps) => self.candidates.shift(steps),
            None => self.candidates.restart(),
        }
    }

    /// Simulates the candidates, and takes a new plan. Returns the cost of the first candidate.
    fn iterate(&mut self, cost: &dyn TrajectoryCost) -> Result<f64> {
        let Self { options, regulator, forward, candidates, plan, weights, horizon, .. } = self;
        let regulator = regulator.as_ref();
        candidates.draw(options, regulator.is_some());
        let (grid, drawn) = (candidates.grid, &*candidates);
        forward.run(options.samples, *horizon, |index| Law { grid, knots: drawn.knots(index), regulator }, cost)?;
        let Some(best) = forward.cheapest() else {
            forward.check_first("the cost of the first candidate of a SamplingPlanner")?;
            return Ok(f64::INFINITY);
        };
        let trials = forward.trials();
        let initial = if trials[0].1.is_ok() { trials[0].0.cost } else { f64::INFINITY };
        let least = trials[best].0.cost;
        for (weight, (trial, result)) in weights.iter_mut().zip(&*trials) {
            let excess = if result.is_ok() { (trial.cost - least) / options.temperature } else { f64::NAN };
            *weight = if excess.is_nan() { 0.0 } else { (-excess).exp() };
        }
        weights[best] = 1.0;
        std::mem::swap(&mut trials[best].0, plan);
        if options.temperature > 0.0 {
            candidates.average(weights);
            let (grid, knots) = (candidates.grid, &candidates.plan);
            forward.run(1, *horizon, |_| Law { grid, knots, regulator }, cost)?;
            if forward.cheapest().is_some() {
                std::mem::swap(&mut forward.trials()[0].0, plan);
                return Ok(initial);
            }
        }
        candidates.select(best);
        Ok(initial)
    }
}

impl Planner for SamplingPlanner {
    fn horizon(&self) -> usize {
        self.horizon
    }

    fn plan(&mut self, data: &Data, cost: &dyn TrajectoryCost, policy: &mut TimeVaryingLqr) -> Result<PlanReport> {
        if self.observation.observe(data, "the simulation of a SamplingPlanner")? {
            self.candidates.adopt_ranges(data.model(), self.regulator.is_some());
        }
        self.warm_start();
        // After an error, the next plan starts from the initial controls.
        self.start = None;
        self.forward.start(self.observation.data(), cost)?;
        let initial_cost = self.iterate(cost)?;
        for _ in 1..self.options.iterations {
            self.iterate(cost)?;
        }
        let data = self.observation.data();
        policy.overwrite(data, &self.plan.states, &self.plan.controls, &self.gains)?;
        self.start = Some(data.time());
        Ok(PlanReport { initial_cost, cost: self.plan.cost })
    }

    fn reset(&mut self) {
        self.start = None;
    }
}

impl fmt::Debug for SamplingPlanner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "SamplingPlanner: {} steps, {:?}, of {:?}",
            self.horizon,
            self.options,
            self.observation.data().model()
        )
    }
}
