//! Buffers of the delays of actuators and sensors, since 3.5.
//!
//! A buffer with `n` samples of `dim` numbers has the layout
//! `[user, cursor, times (n), values (n × dim)]`. The engine converts the cursor to the index of
//! the newest sample without a check. Safe code therefore changes the buffers only through
//! [`Data::set_state`], which checks the cursors, and by functions that write whole buffers. Any
//! other value is safe: the engine searches the times within the buffer, also if they are not in
//! order.

use std::ffi::c_int;

use mujoco_sys::{self as sys, adapted};

use super::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;
use crate::model::Model;

/// Kind of elements that have buffers, and for each element the number of samples and the
/// interpolation, and the address.
type Buffers<'a> = (&'static str, &'a [[i32; 2]], &'a [i32]);

/// Indices of [`Model::history_buffers`].
const ACTUATORS: usize = 0;
const SENSORS: usize = 1;

/// Interpolation between the samples of a buffer of delays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The sample before the time.
    ZeroOrderHold,
    /// Straight lines between the samples.
    Linear,
    /// A cubic spline.
    Cubic,
}

/// # Delays
impl Data {
    /// Writes the controls that an actuator uses at `time`, in seconds, to `values`, one for each
    /// of its [`controls`](crate::element::Actuator): those at the time less its delay, from its
    /// buffer of samples, with engines from 3.5. Times before the oldest and after the newest
    /// sample have their values. Without a buffer (`nsample`), the values are the present controls.
    ///
    /// `interpolation` is that of the actuator if it is `None`.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::Shape`] for a
    /// wrong length, and [`Error::Invalid`] for a time that is NaN. [`Error::Unsupported`] with
    /// MuJoCo 3.11 to 3.13 if the control of the actuator does not have the index of the actuator.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_readCtrl")]
    pub fn read_ctrl_into(
        &self,
        actuator: impl IntoId<kind::Actuator>,
        time: f64,
        interpolation: Option<Interpolation>,
        values: &mut [f64],
    ) -> Result<()> {
        let model = &**self.model();
        let actuator = actuator.id_in(model)?.index();
        let controls = model.controls_of(actuator);
        Error::check_length("values", values.len(), controls.len())?;
        if cfg!(all(engine_since = "3.11.0", not(engine_since = "3.14.0"))) && controls != (actuator..actuator + 1) {
            let message =
                "reading the control of an actuator beside one with several controls, with MuJoCo 3.11 to 3.13";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let interpolation = model.interpolation(ACTUATORS, actuator, time, interpolation)?;
        // SAFETY: an actuator of this model, and a place for each of its controls. The cursors of
        // the buffers are valid.
        unsafe {
            let (m, d) = (model.as_ptr(), self.as_ptr());
            adapted::read_ctrl(m, d, actuator as c_int, time, interpolation, values.as_mut_ptr());
        }
        Ok(())
    }

    /// Writes the reading of a sensor at `time`, in seconds, to `values`: that at the time less the
    /// sensor's delay, from its buffer of samples, with engines from 3.5. Times before the oldest
    /// and after the newest sample have their readings. Without a buffer (`nsample`), it is the
    /// present reading, [`data`](crate::element::SensorData).
    ///
    /// `interpolation` is that of the sensor if it is `None`.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::Shape`] unless
    /// the length of `values` is the dimension of the sensor, and [`Error::Invalid`] for a time
    /// that is NaN. For a sensor without a buffer also [`Error::NotComputed`] unless its stage has
    /// been computed.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_readSensor")]
    pub fn read_sensor_into(
        &self,
        sensor: impl IntoId<kind::Sensor>,
        time: f64,
        interpolation: Option<Interpolation>,
        values: &mut [f64],
    ) -> Result<()> {
        let model = &**self.model();
        let id = sensor.id_in(model)?;
        let sensor = id.index();
        Error::check_length("values", values.len(), model.sensor(id).dim())?;
        let interpolation = model.interpolation(SENSORS, sensor, time, interpolation)?;
        if !model.has_history(sensor) {
            values.copy_from_slice(self.sensor(id).data()?);
            return Ok(());
        }
        // SAFETY: a sensor of this model, and a place for its reading. The cursors of the buffers
        // are valid.
        unsafe {
            let (m, d) = (model.as_ptr(), self.as_ptr());
            adapted::read_sensor(m, d, sensor as c_int, time, interpolation, values.as_mut_ptr());
        }
        Ok(())
    }

    /// Fills the buffer of samples of an actuator: `times`, in seconds, and for each time the
    /// [`controls`](crate::element::Actuator) of the actuator. The last sample is the newest.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::Shape`] unless
    /// there are as many times as samples (`nsample`), and as many values as times and controls,
    /// and [`Error::Invalid`] for times that are not finite or do not increase by 1e-15 s. An
    /// actuator without a buffer, and every actuator of engines before 3.5, has no samples.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_initCtrlHistory")]
    pub fn init_ctrl_history(
        &mut self,
        actuator: impl IntoId<kind::Actuator>,
        times: &[f64],
        values: &[f64],
    ) -> Result<()> {
        let actuator = actuator.id_in(&**self.model())?.index();
        let dim = self.model().controls_of(actuator).len();
        self.init_history(ACTUATORS, actuator, dim, times, values, None)
    }

    /// Fills the buffer of samples of a sensor: `times`, in seconds, and for each time the reading.
    /// The last sample is the newest. `phase` is the time of the last computation, in seconds, for
    /// a sensor that is computed at intervals.
    ///
    /// # Errors
    ///
    /// As for [`init_ctrl_history`](Self::init_ctrl_history).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_initSensorHistory")]
    pub fn init_sensor_history(
        &mut self,
        sensor: impl IntoId<kind::Sensor>,
        times: &[f64],
        values: &[f64],
        phase: f64,
    ) -> Result<()> {
        let id = sensor.id_in(&**self.model())?;
        let dim = self.model().sensor(id).dim();
        self.init_history(SENSORS, id.index(), dim, times, values, Some(phase))
    }

    /// Writes a buffer in the layout `[user, cursor, times, values]`. `kind` is an index of
    /// [`Model::history_buffers`].
    fn init_history(
        &mut self,
        kind: usize,
        element: usize,
        dim: usize,
        times: &[f64],
        values: &[f64],
        user: Option<f64>,
    ) -> Result<()> {
        let (samples, address) = self.model().buffer(kind, element).map_or((0, 0), |([samples, _], at)| (samples, at));
        Error::check_length("times", times.len(), samples)?;
        Error::check_length("values", values.len(), samples * dim)?;
        if let Some(time) = times.iter().chain(&user).find(|time| !time.is_finite()) {
            return Err(Error::not_finite("a time of a sample", time));
        }
        // The engine's function has this limit, too.
        if let Some(pair) = times.windows(2).find(|pair| pair[1] - pair[0] < sys::mjMINVAL) {
            return Err(Error::out_of_range("a time of a sample", pair[1], format!("1e-15 s after {}", pair[0])));
        }
        if samples == 0 {
            return Ok(());
        }
        let buffer = &mut self.history_values_mut()[address..][..2 + samples * (1 + dim)];
        if let Some(user) = user {
            buffer[0] = user;
        }
        buffer[1] = (samples - 1) as f64;
        buffer[2..2 + samples].copy_from_slice(times);
        buffer[2 + samples..].copy_from_slice(values);
        Ok(())
    }

    /// Returns the buffers of all delays.
    pub(super) fn history_values(&self) -> &[f64] {
        // SAFETY: the engine allocated the array with this length.
        unsafe { ffi::array(adapted::history(self.as_ptr()), self.model().history_len()) }
    }

    /// Returns the buffers of all delays for writing. The caller checks them with
    /// [`Model::check_history`].
    pub(super) fn history_values_mut(&mut self) -> &mut [f64] {
        let length = self.model().history_len();
        // SAFETY: as above, and the data is borrowed exclusively.
        unsafe { ffi::array_mut(adapted::history(self.as_mut_ptr()), length) }
    }
}

impl Model {
    /// Returns the length of the buffers of delays, or 0 before 3.5.
    pub(crate) fn history_len(&self) -> usize {
        // SAFETY: a valid model, of which the function reads a size.
        ffi::size(unsafe { adapted::history_len(self.as_ptr()) })
    }

    /// Returns `true` if a sensor has a buffer of earlier samples.
    pub(crate) fn has_history(&self, sensor: usize) -> bool {
        self.buffer(SENSORS, sensor).is_some()
    }

    /// Returns [`Error::Unsupported`] for a model with delays, whose states of earlier steps a
    /// linear system of one step does not contain.
    pub(super) fn check_without_delays(&self, call: &str) -> Result<()> {
        if self.history_len() == 0 {
            return Ok(());
        }
        Err(Error::Unsupported(format!(
            "{call} of a model with buffers of samples (nsample) for delays of actuators or sensors"
        )))
    }

    /// Returns the buffers of actuators and sensors.
    #[cfg(engine_since = "3.5.0")]
    fn history_buffers(&self) -> [Buffers<'_>; 2] {
        [
            ("actuator", self.actuator_history(), self.actuator_historyadr()),
            ("sensor", self.sensor_history(), self.sensor_historyadr()),
        ]
    }

    #[cfg(not(engine_since = "3.5.0"))]
    #[allow(clippy::unused_self, reason = "newer engines have buffers")]
    fn history_buffers(&self) -> [Buffers<'_>; 0] {
        []
    }

    /// Returns the number of samples, the interpolation and the address of the buffer of an
    /// element, or `None` without a buffer. `kind` is an index of
    /// [`history_buffers`](Self::history_buffers).
    fn buffer(&self, kind: usize, element: usize) -> Option<([usize; 2], usize)> {
        let buffers = self.history_buffers();
        let &(_, shapes, addresses) = buffers.get(kind)?;
        let [samples, interpolation] = shapes[element];
        (samples > 0).then(|| ([ffi::size(samples), ffi::size(interpolation)], ffi::size(addresses[element])))
    }

    /// Returns the engine's number of an interpolation, by default that of the element.
    fn interpolation(
        &self,
        kind: usize,
        element: usize,
        time: f64,
        interpolation: Option<Interpolation>,
    ) -> Result<c_int> {
        if time.is_nan() {
            return Err(Error::not_finite("the time of a sample", time));
        }
        let default = self.buffer(kind, element).map_or(0, |([_, interpolation], _)| interpolation as c_int);
        Ok(interpolation.map_or(default, |interpolation| match interpolation {
            Interpolation::ZeroOrderHold => 0,
            Interpolation::Linear => 1,
            Interpolation::Cubic => 2,
        }))
    }

    /// Checks the cursors of the buffers in `history`, which has the length
    /// [`history_len`](Self::history_len).
    pub(super) fn check_history(&self, history: &[f64]) -> Result<()> {
        for (kind, buffers, addresses) in self.history_buffers() {
            for (element, (&[samples, _], &address)) in buffers.iter().zip(addresses).enumerate() {
                if samples <= 0 {
                    continue;
                }
                let at = ffi::size(address) + 1;
                let cursor = history[at];
                if !((0.0..f64::from(samples)).contains(&cursor) && cursor.fract() == 0.0) {
                    let what = format!("history[{at}], the index of the newest sample of {kind} {element},");
                    return Err(Error::out_of_range(what, cursor, format!("a whole number from 0 to {}", samples - 1)));
                }
            }
        }
        debug_assert_eq!(history.len(), self.history_len(), "Bug: a history has the length of the model's buffers");
        Ok(())
    }
}
