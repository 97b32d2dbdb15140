//! Identification of a model's parameters from measurements (system identification).
//!
//! An [`Identification`] has [`Unknown`]s, such as masses, damping, gains of actuators, and delays
//! or biases of sensors, and [`Experiment`]s with their controls and [`Measurement`]s, each with
//! its own clock. [`solve`](Identification::solve) finds the values with the smallest weighted
//! squares
//!
//! ```text
//! ½ Σ ((gain · simulated(t − delay) + bias − measured(t)) / σ)²  +  ½ Σ ((value − mean) / σ)²
//! ```
//!
//! between the bounds: with normally distributed noise, the most probable values. The second sum is
//! over the unknowns with a prior, and over the uncertain coordinates of states at the start.
//!
//! ```
//! use mujoco_safe::identification::{Experiment, Identification, Measurement, Options, Signal, Unknown};
//! use mujoco_safe::rollout::Parameter;
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <body name="arm">
//!              <joint name="hinge" axis="0 1 0" damping="0.1"/>
//!              <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
//!            </body>
//!          </worldbody>
//!          <sensor><jointpos name="angle" joint="hinge"/></sensor>
//!        </mujoco>"#,
//! )?;
//! // A log of a swinging pendulum: every 50 ms for two seconds, from 1 rad, with damping 0.25.
//! let mut real = Data::new(model.clone())?;
//! real.edit_model(|model| model.dof_damping_mut()[0] = 0.25)?;
//! real.qpos_mut()[0] = 1.0;
//! let (mut times, mut angles) = (Vec::new(), Vec::new());
//! while real.time() < 2.0 {
//!     times.push(real.time());
//!     angles.push(real.qpos()[0]);
//!     real.step_n(25)?;
//! }
//!
//! let mut start = Data::new(model.clone())?;
//! start.qpos_mut()[0] = 1.0;
//! let log = Experiment::new("swing", &start)
//!     .with_measurement(Measurement::of_sensor(start.model(), "angle", Signal::scalar(times, angles)?)?);
//! let hinge = start.model().joint("hinge")?.id();
//! let damping = Unknown::parameter(start.model(), Parameter::JointDamping(hinge))?;
//! let fit = Identification::new(vec![damping])?.with_experiment(log)?.solve(Options::default())?;
//! assert!((fit.value("dof_damping of joint 'hinge'")? - 0.25).abs() < 1e-6, "{fit}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Long and unstable motions
//!
//! By default the simulation runs from the start of an experiment to its end (single shooting). A
//! search from wrong values then often stops at a local minimum, and with contacts or unstable
//! motions it does not converge. [`Experiment::with_segments`] divides an experiment into segments
//! that start in states of their own, which the search joins. Impacts remain difficult: a first
//! guess of a velocity on the wrong side of one can hold the search, so let a robot move without
//! hitting anything, with its contacts closed or open throughout.
//!
//! # What the data determine
//!
//! [`Fit`] has a confidence interval for each unknown, the combinations of unknowns that the data
//! do not determine, and the errors of each measurement; [`Fit::validate`] simulates experiments
//! that were not used. `Fit::save_report`, with the feature `html`, writes all this to a page with
//! plots.
//!
//! # Derivatives
//!
//! Jacobians are differences of simulations, one for each unknown of the model and each coordinate
//! of the state at the start of a segment, on all threads of the current rayon pool. Results do not
//! depend on the number of threads. If all measurements are those of sensors and there are at least
//! 8 columns of states and of parameters that have
//! [formulas](crate::Lineariser::parameter_jacobian), those come from linearised steps in closed
//! form, which takes a few steps' time for all of them together. Delays, gains and biases have
//! formulas.
//!
//! Sources: L. Ljung, *System Identification*, 1999, for the estimate and its covariance; H. G.
//! Bock for multiple shooting (1983).

mod chain;
mod column;
mod experiment;
mod fit;
mod formulas;
mod measurement_error;
mod plan;
#[cfg(feature = "html")]
mod plot;
mod recorded;
#[cfg(feature = "html")]
mod report;
mod segment;
mod shooting;
mod signal;
mod simulate;
mod states;
mod unknown;

use std::collections::HashSet;

pub use self::experiment::{Experiment, Measurement};
pub use self::fit::{Combination, Estimate, Fit};
pub use self::measurement_error::MeasurementError;
use self::plan::Plan;
use self::shooting::Shooting;
pub use self::signal::Signal;
use self::unknown::Kind;
pub use self::unknown::Unknown;
use crate::error::{Error, InvalidKind, Result};
use crate::least_squares::{LeastSquares, LeastSquaresOptions, LeastSquaresOutcome, LeastSquaresStatus, Problem};
use crate::matrix::Matrix;

/// Weights of the gaps between segments, relative to those of the readings: the last one makes the
/// gaps negligible beside the noise.
const LOOSE_PENALTIES: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const LAST_PENALTY: f64 = 1e3;
/// Tolerance of the search with all but the last weight.
const LOOSE_TOLERANCE: f64 = 1e-3;

/// Options of [`Identification::solve`].
pub type Options = LeastSquaresOptions;

/// Unknowns and the experiments that determine them: see the [module](self).
#[derive(Clone, Debug)]
#[must_use]
pub struct Identification {
    unknowns: Vec<Unknown>,
    experiments: Vec<Experiment>,
    /// `true` if each measurement that an unknown corrects must exist.
    has_all_measurements: bool,
}

impl Identification {
    /// Creates an identification of these unknowns.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for values and bounds that are not finite or in the wrong order (a delay
    /// needs finite bounds), and for two unknowns of one name.
    pub fn new(unknowns: Vec<Unknown>) -> Result<Self> {
        unknowns.iter().try_for_each(Unknown::check)?;
        check_distinct("the unknowns", unknowns.iter().map(|unknown| &*unknown.name))?;
        Ok(Self { unknowns, experiments: Vec::new(), has_all_measurements: true })
    }

    /// Adds an experiment. All experiments must be of the same model, or of edited copies of it.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a model that was loaded separately, [`Error::Shape`] for controls,
    /// states or standard deviations of a wrong size, [`Error::Invalid`] for numbers out of range,
    /// two measurements of one name, and an experiment without measurements.
    ///
    /// # Panics
    ///
    /// If a parameter belongs to another model.
    pub fn with_experiment(mut self, experiment: Experiment) -> Result<Self> {
        experiment.check()?;
        if let Some(other) = self.experiments.first() {
            other.model.relation(&experiment.model).check("an experiment")?;
        }
        let names = experiment.measurements.iter().map(Measurement::name);
        check_distinct(&format!("the measurements of {}", experiment.name), names)?;
        for unknown in &self.unknowns {
            if let Kind::Parameter(parameter) = unknown.kind {
                parameter.name(&experiment.model)?;
            }
        }
        self.experiments.push(experiment);
        Ok(self)
    }

    /// Returns the unknowns.
    pub fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// Returns the experiments.
    pub fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// Searches for the values.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] without experiments, for a measurement that ends before its delay, and
    /// for an unknown delay, gain or bias of a measurement that no experiment has; the errors of
    /// closures, of [`Data::step`](crate::Data::step) and of
    /// [`update_constants`](crate::ModelMut::update_constants). A simulation that becomes unstable
    /// is an error only at the first values ([`Fit::status`] is then `NotFinite`); later, the
    /// search avoids it.
    pub fn solve(&self, options: Options) -> Result<Fit> {
        let plans = self.plans(&self.experiments)?;
        let mut problem = Shooting::new(&self.unknowns, plans)?;
        let n = problem.len();
        let mut outcome = None;
        if problem.has_gaps() {
            // Loose segments first: their states then agree with the readings.
            let mut solver = LeastSquares::new(n, Options { tolerance: LOOSE_TOLERANCE, ..options })?;
            for penalty in LOOSE_PENALTIES {
                problem.set_penalty(penalty);
                let loose = solver.minimise(&mut problem)?;
                outcome.get_or_insert(loose);
            }
            problem.set_penalty(LAST_PENALTY);
        }
        let last = LeastSquares::new(n, options)?.minimise(&mut problem)?;
        let earlier = outcome.unwrap_or(last);
        let outcome = LeastSquaresOutcome { first_cost: earlier.first_cost, ..last };
        let mut information = Matrix::zeros(n, n);
        if last.status != LeastSquaresStatus::NotFinite {
            problem.damped(0.0, &mut information, &mut vec![0.0; n]);
        }
        let errors = problem.errors()?;
        Ok(Fit::new(self, &problem, &information, outcome, errors))
    }

    /// Returns the layouts of experiments.
    fn plans(&self, experiments: &[Experiment]) -> Result<Vec<Plan>> {
        let what = "the number of experiments of an identification";
        Error::check_range(!experiments.is_empty(), what, 0, "at least one")?;
        for unknown in &self.unknowns {
            if let Kind::Correction(_, name) = &unknown.kind
                && self.has_all_measurements
                && !experiments.iter().any(|experiment| experiment.measurements.iter().any(|one| one.name == *name))
            {
                let expected = "the name of a measurement of an experiment";
                return Err(Error::invalid(InvalidKind::Unknown, &unknown.name, name, expected));
            }
        }
        experiments.iter().map(|experiment| Plan::new(experiment.clone(), &self.unknowns)).collect()
    }
}

fn check_distinct<'n>(what: &str, names: impl Iterator<Item = &'n str>) -> Result<()> {
    let mut known = HashSet::new();
    for name in names {
        if !known.insert(name) {
            let found = format!("two of {name}");
            return Err(Error::invalid(InvalidKind::Duplicate, what, found, "with a name for each"));
        }
    }
    Ok(())
}
