//! Differences between simulation and measurement.

use super::Signal;
use super::column::Values;
use super::plan::Plan;
use super::segment::{Between, Corrections};
use crate::error::Result;
use crate::matrix::Matrix;

/// Errors of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasurementError {
    /// Name of the experiment.
    pub experiment: String,
    /// Name of the measurement.
    pub measurement: String,
    /// Number of readings.
    pub count: usize,
    /// Root mean square of the differences between simulation and measurement, in the unit of the
    /// readings.
    pub rms: f64,
    /// Simulated readings at the times of the samples, with delay, gain and bias.
    pub simulated: Signal,
    /// Measured readings at these times.
    pub measured: Signal,
}

/// Returns the errors of the measurements of an experiment, given the readings of its segments.
pub(super) fn errors_of(
    plan: &Plan,
    segments: &[(usize, &[f64])],
    values: &Values<'_>,
) -> Result<Vec<MeasurementError>> {
    let experiment = &plan.experiment;
    let mut errors = Vec::new();
    for (index, (channel, measurement)) in plan.channels.iter().zip(&experiment.measurements).enumerate() {
        let corrections = Corrections::of(channel, measurement.delay, values);
        let samples = channel.samples.clone();
        let mut simulated =
            Matrix::from_row_major(samples.len(), channel.width, vec![f64::NAN; samples.len() * channel.width]);
        let (mut count, mut squares) = (0, 0.0);
        for &(segment, readings) in segments {
            for sample in plan.samples(segment, index, corrections.delay) {
                let row = measurement.signal.values().row(sample);
                let mut place = Between::new(plan, segment, measurement.signal.times()[sample] - corrections.delay);
                if measurement.is_quaternion {
                    place = place.align(readings, plan.width, channel.first, row);
                }
                for component in 0..channel.width {
                    let reading = place.reading(readings, plan.width, channel.first + component);
                    let reading = corrections.gain * reading + corrections.bias;
                    simulated[(sample - samples.start, component)] = reading;
                    let error = reading - row[component];
                    if !error.is_nan() {
                        count += 1;
                        squares += error * error;
                    }
                }
            }
        }
        errors.push(MeasurementError {
            experiment: experiment.name.clone(),
            measurement: measurement.name.clone(),
            count: count as usize,
            rms: (squares / f64::from(count.max(1_u32))).sqrt(),
            simulated: Signal::new(measurement.signal.times()[samples.clone()].to_vec(), simulated)?,
            measured: measurement.signal.rows(samples)?,
        });
    }
    Ok(errors)
}
