//! Sensors and their readings.

use std::ops::Range;

use mujoco_sys as sys;

use super::{Object, View, ViewMut, range};
use crate::data::{Data, PipelineFlags, Stage};
use crate::enums::{SensorDataType, SensorType};
#[cfg(doc)]
use crate::error::Error;
use crate::error::Result;
use crate::ffi;
use crate::kind;
use crate::model::{Model, ModelMut};

/// # Methods of [`SensorDataMut`](super::SensorDataMut)
impl ViewMut<'_, Data, kind::Sensor> {
    /// Returns a mutable reference to the sensor's range of [`sensordata`](Data::sensordata).
    #[inline]
    pub fn data_mut(&mut self) -> &mut [f64] {
        let range = self.view().in_model().data_range();
        &mut self.owner.sensordata_mut()[range]
    }
}

fields!(Sensor on Model {
    /// Type of the sensor.
    sensor_type: {SensorType} = |sensor| SensorType::of_field(sensor.owner.sensor_type()[sensor.index()]);
    /// Data type of a reading.
    datatype: {SensorDataType} = |sensor| SensorDataType::of_field(sensor.owner.sensor_datatype()[sensor.index()]);
    /// Stage of the pipeline that the reading requires.
    needstage: {Stage} = |sensor| match sensor.owner.sensor_needstage()[sensor.index()] as u32 {
        sys::mjSTAGE_NONE => Stage::None,
        sys::mjSTAGE_POS => Stage::Position,
        sys::mjSTAGE_VEL => Stage::Velocity,
        sys::mjSTAGE_ACC => Stage::Acceleration,
        other => panic!("Bug: a model with needstage {other}"),
    };
    /// Object that the sensor is attached to; `None` for a clock.
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    object: {Option<Object>} = |sensor| {
        let (object_type, id) = (sensor.owner.sensor_objtype(), sensor.owner.sensor_objid());
        Object::from_raw(object_type[sensor.index()], id[sensor.index()], sensor.owner.lineage())
    };
    /// Object whose frame is the reference frame; `None` for the world frame, or the default frame
    /// of the sensor type.
    #[doc(alias = "reftype")]
    #[doc(alias = "refid")]
    reference: {Option<Object>} = |sensor| {
        let (object_type, id) = (sensor.owner.sensor_reftype(), sensor.owner.sensor_refid());
        Object::from_raw(object_type[sensor.index()], id[sensor.index()], sensor.owner.lineage())
    };
    /// Dimension of a reading.
    dim: {usize} = |sensor| ffi::size(sensor.owner.sensor_dim()[sensor.index()]);
    /// Range of a reading in `sensordata`.
    #[doc(alias = "adr")]
    data_range: {Range<usize>} = |sensor| range(sensor.owner.sensor_adr(), sensor.owner.sensor_dim(), sensor.index());
    /// Value at which readings are clamped; 0 for none.
    cutoff: f64 = sensor_cutoff, set_cutoff in sensor_cutoff_mut;
    /// Standard deviation of the noise, applied if
    /// [`EnableFlags::SENSORNOISE`](crate::model::EnableFlags::SENSORNOISE) is set.
    noise: f64 = sensor_noise, set_noise in sensor_noise_mut;
    /// User data.
    user: [f64] = sensor_user, user_mut in sensor_user_mut;
});

fields!(Sensor on Data {
    /// Reading of the sensor: its range of [`sensordata`](Data::sensordata), which a control loop
    /// can read without the check. After [`step`](Data::step) the reading belongs to the state
    /// before the step.
    ///
    /// Engine array `sensordata`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] unless the stage of the sensor has been computed,
    /// [`Error::Unsupported`] if the options of the model disable sensors.
    ///
    /// ```
    /// use mujoco_safe::{Data, Error, Model};
    ///
    /// let mut data = Data::new(Model::from_xml_str(
    ///     r#"<mujoco>
    ///          <worldbody><body pos="0 0 1"><freejoint/><geom size="0.1"/><site name="hand"/></body></worldbody>
    ///          <sensor><accelerometer name="imu" site="hand"/></sensor>
    ///        </mujoco>"#,
    /// )?)?;
    /// assert!(matches!(data.sensor("imu")?.data(), Err(Error::NotComputed { .. })));
    /// data.step()?;
    /// assert_eq!(data.sensor("imu")?.data()?.len(), 3);
    /// // The first half of a step does not compute accelerations: the array holds those of the previous step.
    /// data.step1()?;
    /// assert!(matches!(data.sensor("imu")?.data(), Err(Error::NotComputed { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    data: {Result<&'a [f64]>} = |sensor| {
        let data = sensor.owner;
        let needs = match data.model().sensor_needstage()[sensor.index()] as u32 {
            sys::mjSTAGE_POS => PipelineFlags::SENSOR_POS,
            sys::mjSTAGE_VEL => PipelineFlags::SENSOR_VEL,
            sys::mjSTAGE_ACC => PipelineFlags::SENSOR_ACC,
            // The engine evaluates no sensor of another stage, and the compiler creates none.
            _ => PipelineFlags::empty(),
        };
        data.check_parts("the reading of a sensor", needs)?;
        data.check_sensors_enabled()?;
        Ok(&data.sensordata()[sensor.in_model().data_range()])
    };
});
