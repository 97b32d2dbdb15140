//! Sensors.

use std::ops::Range;

use super::{View, ViewMut, range};
use crate::data::Data;
use crate::ffi;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Sensor on Model {
    /// The engine's type, an `mjtSensor`.
    sensor_type: i32 = sensor_type;
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
