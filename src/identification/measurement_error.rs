//! Differences between simulation and measurement.

use super::Signal;
use super::column::Values;
use super::plan::Plan;
use super::segment::for_each_reading;
use crate::error::Result;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::dot;

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
    let mut simulated: Vec<Matrix> = Vec::new();
    for (channel, measurement) in plan.channels.iter().zip(&plan.experiment.measurements) {
        let (rows, columns) = (channel.samples.len(), measurement.signal.width());
        simulated.push(Matrix::from_row_major(rows, columns, vec![f64::NAN; rows * columns]));
    }
    for &(segment, readings) in segments {
        for_each_reading(plan, segment, readings, values, |reading, _| {
            let row = reading.sample - plan.channels[reading.channel].samples.start;
            simulated[reading.channel][(row, reading.component)] = reading.simulated;
        });
    }
    let all = plan.channels.iter().zip(&plan.experiment.measurements).zip(simulated);
    all.map(|((channel, measurement), simulated)| {
        let measured = measurement.signal.rows(channel.samples.clone())?;
        let pairs = simulated.as_slice().iter().zip(measured.values().as_slice());
        let errors: Vec<f64> =
            pairs.map(|(simulated, measured)| simulated - measured).filter(|e| !e.is_nan()).collect();
        Ok(MeasurementError {
            experiment: plan.experiment.name.clone(),
            measurement: measurement.name.clone(),
            count: errors.len(),
            rms: (dot(&errors, &errors) / errors.len().max(1) as f64).sqrt(),
            simulated: Signal::new(measured.times().to_vec(), simulated)?,
            measured,
        })
    })
    .collect()
}
