//! The residuals of a segment, and their quadratic model.

use nalgebra::DMatrix;

use super::column::{Derivative, Values};
use super::plan::{Channel, Plan};
use super::simulate::Simulated;
use crate::numerics::linear_algebra::{add, dot};

/// Cost of a segment, as a function of its columns: `½ [d; 1]ᵀ M [d; 1]`.
#[derive(Clone, Debug)]
pub(super) struct Quadratic {
    pub(super) cost: f64,
    /// M, `(columns + 1, columns + 1)`.
    pub(super) matrix: DMatrix<f64>,
    /// Number of residuals, and sum of their squares.
    pub(super) count: usize,
    pub(super) squares: f64,
}

/// Sample of a component of a measurement, with its simulation.
pub(super) struct Reading {
    pub(super) channel: usize,
    pub(super) sample: usize,
    pub(super) component: usize,
    between: Between,
    gain: f64,
    /// Simulated reading, with and without gain and bias.
    pub(super) simulated: f64,
    uncorrected: f64,
}

/// Time between two steps.
#[derive(Clone, Copy)]
struct Between {
    step: usize,
    part: f64,
    /// Signs of the readings of both steps. A quaternion and its negative are the same rotation.
    signs: [f64; 2],
}

impl Between {
    fn new(plan: &Plan, segment: usize, time: f64) -> Self {
        let steps = plan.steps(segment);
        let h = plan.experiment.model.timestep();
        let place = ((time - plan.time(plan.nodes[segment])) / h).clamp(0.0, steps as f64);
        let step = (place as usize).min(steps - 1);
        Self { step, part: place - step as f64, signs: [1.0; 2] }
    }

    fn reading(&self, readings: &[f64], width: usize, component: usize) -> f64 {
        let [low, high] = self.both(readings, width, component);
        low + self.part * (high - low)
    }

    fn both(&self, readings: &[f64], width: usize, component: usize) -> [f64; 2] {
        [0, 1].map(|at| self.signs[at] * readings[(self.step + at) * width + component])
    }

    /// Chooses the signs of quaternions, which begin at `first`, such that they are near the
    /// measured one.
    fn align(&mut self, readings: &[f64], width: usize, first: usize, measured: &[f64]) {
        for at in [0, 1] {
            let product = dot(&readings[(self.step + at) * width + first..], measured);
            self.signs[at] = if product < 0.0 { -1.0 } else { 1.0 };
        }
    }
}

/// Calls `each` with every reading of a segment and its measured value, which is NaN if it is
/// missing.
pub(super) fn for_each_reading(
    plan: &Plan,
    segment: usize,
    readings: &[f64],
    values: &Values<'_>,
    mut each: impl FnMut(&Reading, f64),
) {
    let value = |unknown: Option<usize>, known| unknown.map_or(known, |index| values.value(index));
    for (channel, measurement) in plan.experiment.measurements.iter().enumerate() {
        let Channel { first, delay, gain, bias, .. } = plan.channels[channel];
        let (delay, gain, bias) = (value(delay, measurement.delay), value(gain, 1.0), value(bias, 0.0));
        for sample in plan.samples(segment, channel, delay) {
            let row = measurement.signal.values().row(sample);
            let mut between = Between::new(plan, segment, measurement.signal.times()[sample] - delay);
            if measurement.is_quaternion {
                between.align(readings, plan.width, first, row);
            }
            for (component, &measured) in row.iter().enumerate() {
                let uncorrected = between.reading(readings, plan.width, first + component);
                let simulated = gain * uncorrected + bias;
                each(&Reading { channel, sample, component, between, gain, simulated, uncorrected }, measured);
            }
        }
    }
}

/// Calls `each` with every reading that is not missing, and its residual in units of the standard
/// deviation.
fn residuals(plan: &Plan, segment: usize, readings: &[f64], values: &Values<'_>, mut each: impl FnMut(&Reading, f64)) {
    for_each_reading(plan, segment, readings, values, |reading, measured| {
        if !measured.is_nan() {
            let deviation = plan.experiment.measurements[reading.channel].deviation;
            each(reading, (reading.simulated - measured) / deviation);
        }
    });
}

/// Returns the cost of a segment.
pub(super) fn cost(plan: &Plan, segment: usize, readings: &[f64], values: &Values<'_>) -> f64 {
    let mut sum = 0.0;
    residuals(plan, segment, readings, values, |reading, residual| {
        sum += plan.experiment.measurements[reading.channel].norm.value(residual);
    });
    sum
}

/// Returns the quadratic model of the cost, given the derivatives by the columns of the state and
/// of the unknowns that change the model.
pub(super) fn quadratic(
    plan: &Plan,
    segment: usize,
    base: &Simulated,
    derivatives: &[&Derivative],
    values: &Values<'_>,
) -> Quadratic {
    let (states, unknowns) = (plan.states(segment).len(), values.unknowns.len());
    let columns = states + unknowns;
    let mut matrix = DMatrix::zeros(columns + 1, columns + 1);
    let mut row = vec![0.0; columns + 1];
    let mut cost = 0.0;
    let (mut count, mut squares) = (0, 0.0);
    let places: Vec<usize> = derivatives.iter().map(|derivative| plan.column(segment, derivative.column)).collect();
    let h = plan.experiment.model.timestep();
    residuals(plan, segment, &base.readings, values, |reading, residual| {
        let &Reading { channel, component, between, gain, uncorrected, .. } = reading;
        let (channel, measurement) = (&plan.channels[channel], &plan.experiment.measurements[channel]);
        let component = channel.first + component;
        row.fill(0.0);
        for (&column, derivative) in places.iter().zip(derivatives) {
            row[column] = gain * between.reading(&derivative.readings, plan.width, component);
        }
        let [low, high] = between.both(&base.readings, plan.width, component);
        let by_corrections =
            [(channel.delay, -gain * (high - low) / h), (channel.gain, uncorrected), (channel.bias, 1.0)];
        for (unknown, slope) in by_corrections {
            if let Some(unknown) = unknown {
                row[states + unknown] += slope * values.slope(unknown);
            }
        }
        for value in &mut row {
            *value /= measurement.deviation;
        }
        row[columns] = residual;

        cost += measurement.norm.value(residual);
        count += 1;
        squares += residual * residual;
        let weight = measurement.norm.weight(residual);
        for (column, &value) in row.iter().enumerate() {
            if value != 0.0 {
                add(&mut matrix.column_mut(column).as_mut_slice()[column..], &row[column..], weight * value);
            }
        }
    });
    matrix.fill_upper_triangle_with_lower_triangle();
    Quadratic { cost, matrix, count, squares }
}
