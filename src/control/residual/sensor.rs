//! Residual of the reading of a sensor.

use std::ops::Range;

use super::{Needs, Residual, ResidualJacobian, check_model, subtract};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{IntoId, Lineage};
use crate::kind;
use crate::model::Model;

/// Reading of a sensor, minus a target.
///
/// The Jacobian is computed by a [`Lineariser`](crate::Lineariser), which has formulas for most
/// sensors. All sensors of a cost share one linearisation. A sensor also needs the results of
/// [`Data::forward`], so the other residuals are faster for quantities that both have, such as the
/// position of a site.
///
/// ```
/// use mujoco_safe::control::residual::{ResidualCost, SensorReading, Term};
/// use mujoco_safe::sample;
///
/// let model = sample::humanoid();
/// let gyro = SensorReading::new(&model, "torso_gyro")?;
/// let cost = ResidualCost::new(model, [Term::new("rotation", gyro)])?;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SensorReading {
    readings: Range<usize>,
    target: Vec<f64>,
    lineage: Lineage,
}

impl SensorReading {
    /// Creates the residual. The target is zero.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown sensor.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn new(model: &Model, sensor: impl IntoId<kind::Sensor>) -> Result<Self> {
        let sensor = sensor.id_in(model)?.index();
        let (first, size) = (ffi::size(model.sensor_adr()[sensor]), ffi::size(model.sensor_dim()[sensor]));
        Ok(Self { readings: first..first + size, target: vec![0.0; size], lineage: model.lineage() })
    }

    /// Sets the target, in the unit of the sensor.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_target(mut self, target: &[f64]) -> Result<Self> {
        Error::check_length("the target of a SensorReading", target.len(), self.target.len())?;
        self.target.copy_from_slice(target);
        Ok(self)
    }
}

impl Residual for SensorReading {
    fn size(&self) -> usize {
        self.readings.len()
    }

    fn needs(&self) -> Needs {
        Needs::Forward
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        check_model(data, self.lineage)?;
        subtract(&data.sensordata()[self.readings.clone()], &self.target, residual);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        check_model(data, self.lineage)?;
        jacobian.write_sensors(data, self.readings.start, self.readings.len())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
