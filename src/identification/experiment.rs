//! Experiments: an initial state, the controls, and the measurements.

use std::fmt;
use std::sync::Arc;

use super::Signal;
use super::unknown::check_deviation;
use crate::control::residual::Norm;
use crate::data::{Data, StateSpec};
use crate::enums::SensorDataType;
use crate::error::{Error, InvalidKind, Result};
use crate::id::IntoId;
use crate::kind;
use crate::model::Model;

type Read = dyn Fn(&mut Data, &mut [f64]) -> Result<()> + Send + Sync;

/// Readings of a sensor, with its clock and errors.
///
/// `measured(t) = gain · simulated(t − delay) + bias + noise`. Between two steps, the simulated
/// reading is interpolated.
#[derive(Clone)]
#[must_use]
pub struct Measurement {
    pub(super) name: String,
    pub(super) source: Source,
    pub(super) signal: Signal,
    pub(super) deviation: f64,
    pub(super) norm: Norm,
    pub(super) delay: f64,
    pub(super) is_quaternion: bool,
}

#[derive(Clone)]
pub(super) enum Source {
    /// Places in `sensordata`.
    Sensor(std::ops::Range<usize>),
    Read(Arc<Read>),
}

impl Measurement {
    /// Readings of a sensor of the model, by name or id. A NaN is a missing reading. The sign of a
    /// quaternion does not matter.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] without such a sensor, [`Error::Shape`] unless the signal has the
    /// sensor's number of values.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    pub fn of_sensor(model: &Model, sensor: impl IntoId<kind::Sensor>, signal: Signal) -> Result<Self> {
        let sensor = sensor.id_in(model)?;
        let view = model.sensor(sensor);
        Error::check_length("the readings of a sensor", signal.width(), view.dim())?;
        let name = view.name().map_or_else(|| format!("sensor {}", sensor.index()), str::to_owned);
        let is_quaternion = view.datatype() == SensorDataType::Quaternion;
        Ok(Self { is_quaternion, ..Self::new(name, Source::Sensor(view.data_range()), signal) })
    }

    /// Readings of anything that a closure computes from a simulation, after
    /// [`forward`](Data::forward) of the state: one number for each column of the signal. It must
    /// not change the state.
    pub fn of(
        name: impl Into<String>,
        signal: Signal,
        read: impl Fn(&mut Data, &mut [f64]) -> Result<()> + Send + Sync + 'static,
    ) -> Self {
        Self::new(name.into(), Source::Read(Arc::new(read)), signal)
    }

    fn new(name: String, source: Source, signal: Signal) -> Self {
        Self { name, source, signal, deviation: 1.0, norm: Norm::Quadratic, delay: 0.0, is_quaternion: false }
    }

    /// Sets the standard deviation of the noise, in the unit of the readings. 1 by default. With
    /// several measurements, their ratios decide how much each counts.
    pub fn with_deviation(mut self, deviation: f64) -> Self {
        self.deviation = deviation;
        self
    }

    /// Sets a norm of the errors in units of the standard deviation, which limits the influence of
    /// outliers.
    pub fn with_norm(mut self, norm: Norm) -> Self {
        self.norm = norm;
        self
    }

    /// Sets a known delay, s. See [`Unknown::delay`](super::Unknown::delay) for an unknown one,
    /// which starts here.
    pub fn with_delay(mut self, delay: f64) -> Self {
        self.delay = delay;
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn check(&self) -> Result<()> {
        check_deviation(&format!("the standard deviation of {}", self.name), self.deviation)?;
        Error::check_finite(&[self.delay], |_| format!("the delay of {}", self.name))
    }
}

/// Experiment: the state at its start, the controls, and what was measured.
///
/// The simulation starts with the model, the time, the state and all other inputs of a [`Data`].
/// The model may be an edited one, for example with a known load.
#[derive(Clone)]
#[must_use]
pub struct Experiment {
    pub(super) name: String,
    pub(super) model: Arc<Model>,
    /// Values of [`StateSpec::INTEGRATION`] at the start.
    pub(super) start: Vec<f64>,
    pub(super) start_time: f64,
    pub(super) controls: Option<Signal>,
    pub(super) measurements: Vec<Measurement>,
    /// Standard deviations of the state at the start, in tangent coordinates: zero if known.
    pub(super) uncertainty: Vec<f64>,
    pub(super) segment: f64,
    /// Physics states, for the starts of segments.
    pub(super) guess: Option<Signal>,
}

impl Experiment {
    /// Creates an experiment that starts in the state of a simulation.
    pub fn new(name: impl Into<String>, start: &Data) -> Self {
        let model = start.model();
        Self {
            name: name.into(),
            uncertainty: vec![0.0; 2 * model.nv() + model.na()],
            model: model.clone(),
            start: start.state(StateSpec::INTEGRATION),
            start_time: start.time(),
            controls: None,
            measurements: Vec::new(),
            segment: f64::INFINITY,
            guess: None,
        }
    }

    /// Sets the controls `(nu)` with their own clock. Each is held until the next one. Without
    /// them, the controls stay those of the start.
    pub fn with_controls(mut self, controls: Signal) -> Self {
        self.controls = Some(controls);
        self
    }

    /// Adds a measurement.
    pub fn with_measurement(mut self, measurement: Measurement) -> Self {
        self.measurements.push(measurement);
        self
    }

    /// Declares the state at the start as uncertain: it is identified too. `deviation` has the
    /// standard deviations of positions, velocities and activations in tangent coordinates
    /// (`2 nv + na`); zero means known, infinity unknown.
    pub fn with_uncertain_start(mut self, deviation: &[f64]) -> Self {
        self.uncertainty = deviation.to_vec();
        self
    }

    /// Divides the experiment into segments of this duration, s, each of which starts in a state of
    /// its own: multiple shooting. The states are identified such that the segments join. The
    /// search then also finds parameters of unstable or chaotic motions, and from poor first
    /// values.
    ///
    /// `states` has physics states `[qpos; qvel; act]` as first guesses, for example positions from
    /// encoders and velocities from their differences. Positions are interpolated in tangent
    /// coordinates.
    pub fn with_segments(mut self, duration: f64, states: Signal) -> Self {
        self.segment = duration;
        self.guess = Some(states);
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the measurements.
    pub fn measurements(&self) -> &[Measurement] {
        &self.measurements
    }

    pub(super) fn check(&self) -> Result<()> {
        let name = &self.name;
        let model = &self.model;
        if self.measurements.is_empty() {
            let what = format!("the experiment {name}");
            return Err(Error::invalid(InvalidKind::OutOfRange, what, "without measurements", "with at least one"));
        }
        self.measurements.iter().try_for_each(Measurement::check)?;
        if let Some(controls) = &self.controls {
            Error::check_length("the controls of an experiment", controls.width(), model.nu())?;
            Error::check_finite(controls.values().as_slice(), |_| format!("a control of {name}"))?;
        }
        Error::check_length("the uncertainty of a start", self.uncertainty.len(), 2 * model.nv() + model.na())?;
        let what = format_args!("a standard deviation of the start of {name}");
        for &deviation in &self.uncertainty {
            Error::check_range(deviation >= 0.0, what, deviation, "not negative")?;
        }
        let what = format_args!("the duration of the segments of {name}");
        Error::check_range(self.segment > 0.0, what, self.segment, "positive")?;
        if let Some(guess) = &self.guess {
            Error::check_length("the states of segments", guess.width(), model.state_size(StateSpec::PHYSICS))?;
            Error::check_finite(guess.values().as_slice(), |_| format!("a state of a segment of {name}"))?;
        }
        Ok(())
    }
}

impl fmt::Debug for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Measurement {} with {} samples", self.name, self.signal.times().len())
    }
}

impl fmt::Debug for Experiment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Experiment {} with {:?}", self.name, self.measurements)
    }
}
