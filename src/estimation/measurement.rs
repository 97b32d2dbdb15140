//! The measurement: the sensors that a filter reads, and their noise.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::control::residual::{Needs, Residual, ResidualJacobian};
use crate::data::Data;
use crate::element::Object;
use crate::enums::{SensorDataType, SensorType};
use crate::error::{Error, InvalidKind, Result};
use crate::id::{IntoId, SiteId};
use crate::kind;
use crate::matrix::Matrix;
use crate::model::{IntoModel, Model};
use crate::numerics::linear_algebra::{add, dot};

/// Sensors that a filter reads, with the standard deviations of their noise, and functions of the
/// state that the program measures otherwise.
///
/// A reading has the components of the sensors, in the order of the calls that added them, then
/// those of the residuals. [`select_into`](Self::select_into) takes the components of the sensors
/// from the array [`sensordata`](Data::sensordata) of another simulation of the model.
///
/// ```
/// use mujoco_safe::control::residual::{JointPosition, JointVelocity};
/// use mujoco_safe::estimation::Measurement;
/// use mujoco_safe::sample;
///
/// let model = std::sync::Arc::new(sample::humanoid());
/// let knee = JointPosition::new(&model, "left_knee")?.with_target(&[0.0])?;
/// let measurement = Measurement::new(&model)
///     .with_sensor("torso_gyro", 0.01)?          // rad/s
///     .with_sensor("torso_accelerometer", 0.2)?  // m/s²
///     .with_residual(knee, 0.002)?;              // an encoder without a sensor in the model
/// assert_eq!(measurement.len(), 7);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub struct Measurement {
    pub(super) model: Arc<Model>,
    sensors: Vec<SelectedSensor>,
    residuals: Vec<Box<dyn Residual>>,
    /// Components of each sensor and each residual.
    pub(super) parts: Vec<Range<usize>>,
    /// Variance of each component.
    pub(super) variances: Vec<f64>,
    needs: Needs,
}

struct SelectedSensor {
    /// Range in `sensordata`.
    source: Range<usize>,
    is_quaternion: bool,
    /// Site of an accelerometer.
    accelerometer: Option<SiteId>,
}

impl Measurement {
    /// Creates a measurement without components.
    pub fn new(model: impl IntoModel) -> Self {
        Self {
            model: model.into_model(),
            sensors: Vec::new(),
            residuals: Vec::new(),
            parts: Vec::new(),
            variances: Vec::new(),
            needs: Needs::State,
        }
    }

    /// Adds a sensor, with the standard deviation of each component in the unit of the sensor. That
    /// of a sensor of an orientation, whose reading is a quaternion, is in rad about each axis.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown sensor, [`Error::Invalid`]
    /// unless the deviation is from 1e-100 to 1e100, for a sensor that was added before, and for a
    /// sensor after a residual.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn with_sensor(mut self, sensor: impl IntoId<kind::Sensor>, deviation: f64) -> Result<Self> {
        let model = self.model.clone();
        let sensor = model.sensor(sensor.id_in(&*model)?);
        let (source, name) = (sensor.data_range(), sensor.to_string());
        let is_quaternion = sensor.datatype() == SensorDataType::Quaternion;
        if self.sensors.iter().any(|other| other.source.start == source.start && !source.is_empty()) {
            return Err(Error::invalid(InvalidKind::Duplicate, "a sensor of a Measurement", name, "added once"));
        }
        if !self.residuals.is_empty() {
            let expected = "added before the residuals";
            return Err(Error::invalid(InvalidKind::Unsuitable, "a sensor of a Measurement", name, expected));
        }
        self.add_part(source.len(), if is_quaternion { 0.5 * deviation } else { deviation })?;
        let accelerometer = match sensor.object() {
            Some(Object::Site(site)) if sensor.sensor_type() == SensorType::Accelerometer => Some(site),
            _ => None,
        };
        self.sensors.push(SelectedSensor { source, is_quaternion, accelerometer });
        self.needs = Needs::Forward;
        Ok(self)
    }

    /// Adds all sensors for which the model has a positive [`sensor_noise`](Model::sensor_noise),
    /// with that deviation. (The engine turns a quaternion about a random axis by an angle of that
    /// deviation, so the deviation about each axis is smaller by √3.)
    ///
    /// # Errors
    ///
    /// As for [`with_sensor`](Self::with_sensor).
    pub fn with_noisy_sensors(mut self) -> Result<Self> {
        let model = self.model.clone();
        for (index, &noise) in model.sensor_noise().iter().enumerate() {
            if noise > 0.0 {
                let is_quaternion = model.sensor(index)?.datatype() == SensorDataType::Quaternion;
                self = self.with_sensor(index, if is_quaternion { noise / 3_f64.sqrt() } else { noise })?;
            }
        }
        Ok(self)
    }

    /// Adds a function of the state and the controls, with the standard deviation of the noise of
    /// each component. Its value is the reading without noise; see
    /// [`residual`](crate::control::residual) for the functions that exist, and set their targets
    /// to zero.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the deviation is from 1e-100 to 1e100.
    pub fn with_residual(mut self, residual: impl Residual + 'static, deviation: f64) -> Result<Self> {
        self.add_part(residual.size(), deviation)?;
        self.needs = self.needs.max(residual.needs());
        self.residuals.push(Box::new(residual));
        Ok(self)
    }

    fn add_part(&mut self, size: usize, deviation: f64) -> Result<()> {
        let what = "the standard deviation of a sensor or residual";
        Error::check_range((1e-100..=1e100).contains(&deviation), what, deviation, "from 1e-100 to 1e100")?;
        let first = self.len();
        crate::memory::check("components of a Measurement", size, size_of::<f64>())?;
        self.variances.resize(first + size, deviation * deviation);
        self.parts.push(first..first + size);
        Ok(())
    }

    /// Returns the number of components of a reading.
    pub fn len(&self) -> usize {
        self.variances.len()
    }

    /// Returns `true` if a reading has no components.
    pub fn is_empty(&self) -> bool {
        self.variances.is_empty()
    }

    /// Returns the components of each sensor and each residual, in the order of the calls that
    /// added them.
    pub fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    /// Returns the standard deviation of the noise of each component. For a quaternion it is half
    /// of that about an axis.
    pub fn deviations(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.variances.iter().map(|variance| variance.sqrt())
    }

    /// Copies the components of the sensors from an array `sensordata` of the model. Those of
    /// residuals are unchanged.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] unless `sensordata` has `nsensordata` values and `readings` has
    /// [`len`](Self::len).
    pub fn select_into(&self, sensordata: &[f64], readings: &mut [f64]) -> Result<()> {
        Error::check_length("sensordata of select_into", sensordata.len(), self.model.nsensordata())?;
        Error::check_length("the readings of select_into", readings.len(), self.len())?;
        for (sensor, part) in self.sensors.iter().zip(&self.parts) {
            readings[part.clone()].copy_from_slice(&sensordata[sensor.source.clone()]);
        }
        Ok(())
    }

    pub(super) fn has_accelerometers(&self) -> bool {
        self.sensors.iter().any(|sensor| sensor.accelerometer.is_some())
    }

    pub(super) fn has_sensors(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// Returns the largest number of components of a residual.
    pub(super) fn largest_residual(&self) -> usize {
        self.parts[self.sensors.len()..].iter().map(Range::len).max().unwrap_or(0)
    }

    /// Computes what the components need, and writes the readings without noise at the present
    /// state.
    pub(super) fn predict(&self, data: &mut Data, readings: &mut [f64]) -> Result<()> {
        self.needs.compute(data)?;
        self.select_into(data.sensordata(), readings)?;
        for (residual, part) in self.residuals.iter().zip(&self.parts[self.sensors.len()..]) {
            residual.evaluate(data, &mut readings[part.clone()])?;
        }
        Ok(())
    }

    /// Writes the rows of the derivatives `(n, nx + nw + nf)`: of the sensors from C and D, then of
    /// the residuals. The last nf columns are by disturbances of the accelerations, and are left
    /// unchanged except for accelerometers.
    pub(super) fn differentiate(
        &self,
        data: &mut Data,
        (c, d): (&Matrix, &Matrix),
        nw: usize,
        jacobian: &mut ResidualJacobian,
        output: &mut Matrix,
    ) -> Result<()> {
        let nx = c.ncols();
        for (sensor, part) in self.sensors.iter().zip(&self.parts) {
            let (source, first, count) = (sensor.source.start, part.start, part.len());
            let (c, d, mut output) = (c.transposed(), d.transposed(), output.transposed_mut());
            output.view_mut((0, first), (nx, count)).copy_from(&c.columns(source, count));
            output.view_mut((nx, first), (nw, count)).copy_from(&d.view((0, source), (nw, count)));
        }
        jacobian.move_point();
        for (residual, part) in self.residuals.iter().zip(&self.parts[self.sensors.len()..]) {
            jacobian.clear(part.len());
            residual.differentiate(data, jacobian)?;
            for (row, component) in part.clone().enumerate() {
                output.row_mut(component)[..nx + nw].copy_from_slice(&jacobian.row(row)[..nx + nw]);
            }
        }
        Ok(())
    }

    /// Writes the derivatives of accelerometers by the accelerations to the columns of `output`
    /// from `first` on. `linear` is a buffer `(3, nv)`.
    pub(super) fn differentiate_accelerometers(
        &self,
        data: &Data,
        first: usize,
        linear: &mut Matrix,
        output: &mut Matrix,
    ) -> Result<()> {
        for (sensor, part) in self.sensors.iter().zip(&self.parts) {
            let Some(site) = sensor.accelerometer else { continue };
            data.jac_site_into(site, Some(&mut *linear), None)?;
            let axes = &data.site_xmat()[site.index()];
            for (axis, component) in part.clone().enumerate() {
                let row = &mut output.row_mut(component)[first..];
                row.fill(0.0);
                (0..3).for_each(|world| add(row, linear.row(world), axes[3 * world + axis]));
            }
        }
        Ok(())
    }

    /// Subtracts the predicted from the measured readings. Of the two quaternions that represent an
    /// orientation, takes the nearer one.
    pub(super) fn subtract(&self, readings: &[f64], predicted: &[f64], innovations: &mut [f64]) {
        for ((innovation, reading), predicted) in innovations.iter_mut().zip(readings).zip(predicted) {
            *innovation = reading - predicted;
        }
        for (sensor, part) in self.sensors.iter().zip(&self.parts) {
            if sensor.is_quaternion && dot(&readings[part.clone()], &predicted[part.clone()]) < 0.0 {
                for component in part.clone() {
                    innovations[component] = -readings[component] - predicted[component];
                }
            }
        }
    }
}

impl fmt::Debug for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sensors, residuals) = (self.sensors.len(), self.residuals.len());
        write!(f, "Measurement {{ {sensors} sensors, {residuals} residuals, {} components }}", self.len())
    }
}
