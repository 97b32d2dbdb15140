//! Recorded trajectories as experiments.

use super::{Experiment, Measurement, Signal};
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::matrix::Matrix;
use crate::trajectory::Trajectory;

impl Signal {
    /// Returns the physics states `[qpos; qvel; act]` of a trajectory, for example for
    /// [`Experiment::with_segments`].
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn states_of(trajectory: &Trajectory) -> Result<Self> {
        Self::of_values(trajectory, trajectory.states().to_vec())
    }

    /// Returns the controls of a trajectory.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn controls_of(trajectory: &Trajectory) -> Result<Self> {
        Self::of_values(trajectory, trajectory.controls().to_vec())
    }

    /// Creates a signal from the values of all records.
    fn of_values(trajectory: &Trajectory, values: Vec<f64>) -> Result<Self> {
        let width = values.len().checked_div(trajectory.len()).unwrap_or(0);
        Self::new(trajectory.times().to_vec(), Matrix::from_row_major(trajectory.len(), width, values))
    }
}

impl Experiment {
    /// Creates an experiment from a [`Trajectory`], recorded or read from a CSV, NumPy or MCAP
    /// file: with its first state, its controls and, if it has them, the readings of all sensors.
    /// Inputs that a trajectory does not have, such as applied forces, are those of `data`.
    ///
    /// The standard deviation of a measurement is the [noise](crate::Model::sensor_noise) of its
    /// sensor, or 1 if that is zero.
    ///
    /// ```
    /// use mujoco_safe::identification::{Experiment, Identification, Options, Unknown};
    /// use mujoco_safe::rollout::Parameter;
    /// use mujoco_safe::{Data, RandomController, Trajectory, sample};
    ///
    /// let data = Data::new(sample::cartpole())?;
    /// let mut trajectory = Trajectory::with_sensordata(data.model());
    /// let mut real = data.clone();
    /// real.edit_model(|model| model.body_mut("pole")?.scale_mass(1.5))?;
    /// trajectory.record(&mut real, &mut RandomController::new(1), 100)?;
    ///
    /// let pole = data.model().body("pole")?.id();
    /// let mass = Unknown::parameter(data.model(), Parameter::MassFactor(pole))?;
    /// let log = Experiment::of_trajectory("log", &data, &trajectory)?;
    /// let fit = Identification::new(vec![mass])?.with_experiment(log)?.solve(Options::default())?;
    /// assert!((fit.estimates()[0].value - 1.5).abs() < 1e-6, "{fit}");
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the model has other sizes, [`Error::Invalid`] for an empty trajectory
    /// and for times that do not increase.
    pub fn of_trajectory(name: impl Into<String>, data: &Data, trajectory: &Trajectory) -> Result<Self> {
        if trajectory.is_empty() {
            let expected = "with at least one record";
            return Err(Error::invalid(InvalidKind::OutOfRange, "the trajectory of an experiment", "empty", expected));
        }
        let mut start = data.clone();
        trajectory.apply(0, &mut start)?;
        let mut experiment = Self::new(name, &start).with_controls(Signal::controls_of(trajectory)?);
        if !trajectory.sensordata(0).is_empty() {
            for sensor in start.model().sensors() {
                let range = sensor.data_range();
                let values = (0..trajectory.len()).flat_map(|record| &trajectory.sensordata(record)[range.clone()]);
                let signal = Signal::of_values(trajectory, values.copied().collect())?;
                let measurement = Measurement::of_sensor(start.model(), sensor.id(), signal)?;
                let noise = sensor.noise();
                experiment =
                    experiment.with_measurement(measurement.with_deviation(if noise > 0.0 { noise } else { 1.0 }));
            }
        }
        Ok(experiment)
    }
}
