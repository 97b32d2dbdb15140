//! Sensors.

use std::ops::Range;

use mujoco_sys as sys;

use super::{Object, View, ViewMut, range};
use crate::data::{Data, Stage};
use crate::enums::{SensorDataType, SensorType};
use crate::ffi;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Sensor on Model {
    /// What it measures.
    sensor_type: {SensorType} = |sensor| SensorType::of_field(sensor.owner.sensor_type()[sensor.index()]);
    /// What its numbers are.
    datatype: {SensorDataType} = |sensor| SensorDataType::of_field(sensor.owner.sensor_datatype()[sensor.index()]);
    /// Up to which stage the pipeline must be computed for it.
    needstage: {Stage} = |sensor| match sensor.owner.sensor_needstage()[sensor.index()] as u32 {
        sys::mjSTAGE_NONE => Stage::Nothing,
        sys::mjSTAGE_POS => Stage::Position,
        sys::mjSTAGE_VEL => Stage::Velocity,
        sys::mjSTAGE_ACC => Stage::Acceleration,
        other => panic!("Bug: a model with needstage {other}"),
    };
    /// What it measures it on; `None` for a clock.
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    object: {Option<Object>} = |sensor| {
        let (object_type, id) = (sensor.owner.sensor_objtype(), sensor.owner.sensor_objid());
        Object::from_raw(object_type[sensor.index()], id[sensor.index()], sensor.owner.lineage())
    };
    /// In whose frame it measures it; `None` for that of the world, or its usual one.
    #[doc(alias = "reftype")]
    #[doc(alias = "refid")]
    reference: {Option<Object>} = |sensor| {
        let (object_type, id) = (sensor.owner.sensor_reftype(), sensor.owner.sensor_refid());
        Object::from_raw(object_type[sensor.index()], id[sensor.index()], sensor.owner.lineage())
    };
    /// How many numbers a reading has.
    dim: {usize} = |sensor| ffi::size(sensor.owner.sensor_dim()[sensor.index()]);
    /// Where a reading is in `sensordata`.
    #[doc(alias = "adr")]
    data_range: {Range<usize>} = |sensor| range(sensor.owner.sensor_adr(), sensor.owner.sensor_dim(), sensor.index());
    /// At which value readings are clamped; 0 for none.
    cutoff: f64 = sensor_cutoff, set_cutoff in sensor_cutoff_mut;
    /// Standard deviation of its noise, where [`EnableFlags::SENSORNOISE`](crate::EnableFlags::SENSORNOISE) is set.
    noise: f64 = sensor_noise, set_noise in sensor_noise_mut;
    /// The user's own numbers.
    user: [f64] = sensor_user, user_mut in sensor_user_mut;
});

fields!(Sensor on Data {
    /// The reading.
    data: [f64] = sensordata at data_range, data_mut in sensordata_mut;
});
