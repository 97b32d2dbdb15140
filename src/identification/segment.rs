//! The residuals of a segment, and their quadratic model.

use super::column::{Derivative, Values};
use super::plan::{Channel, Plan};
use super::simulate::Simulated;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;

/// Cost of a segment, as a function of its columns: `½ [d; 1]ᵀ M [d; 1]`.
#[derive(Clone, Debug)]
pub(super) struct Quadratic {
    pub(super) cost: f64,
    /// M, `(columns + 1, columns + 1)`.
    pub(super) matrix: Matrix,
    /// Number of residuals, and sum of their squares.
    pub(super) count: usize,
    pub(super) squares: f64,
}

/// Reading and its slope, at a time between two steps.
pub(super) struct Between {
    step: usize,
    part: f64,
    /// Signs of the readings of both steps. A quaternion and its negative are the same rotation.
    signs: [f64; 2],
}

impl Between {
    pub(super) fn new(plan: &Plan, segment: usize, time: f64) -> Self {
        let steps = plan.steps(segment);
        let h = plan.experiment.model.timestep();
        let place = ((time - plan.time(plan.nodes[segment])) / h).clamp(0.0, steps as f64);
        let step = (place as usize).min(steps - 1);
        Self { step, part: place - step as f64, signs: [1.0; 2] }
    }

    pub(super) fn reading(&self, readings: &[f64], width: usize, component: usize) -> f64 {
        let [low, high] = self.both(readings, width, component);
        low + self.part * (high - low)
    }

    fn both(&self, readings: &[f64], width: usize, component: usize) -> [f64; 2] {
        [0, 1].map(|at| self.signs[at] * readings[(self.step + at) * width + component])
    }

    /// Chooses the signs of quaternions, which begin at `first`, such that they are near the
    /// measured one.
    pub(super) fn align(mut self, readings: &[f64], width: usize, first: usize, measured: &[f64]) -> Self {
        for at in [0, 1] {
            let simulated = &readings[(self.step + at) * width + first..];
            let product: f64 = simulated.iter().zip(measured).map(|(simulated, measured)| simulated * measured).sum();
            self.signs[at] = if product < 0.0 { -1.0 } else { 1.0 };
        }
        self
    }
}

/// Calls `each` with every residual of a segment in units of its standard deviation: the channel,
/// the place between steps, the component, and the residual.
fn residuals(
    plan: &Plan,
    segment: usize,
    readings: &[f64],
    values: &Values<'_>,
    mut each: impl FnMut(usize, &Between, usize, f64),
) {
    for (index, (channel, measurement)) in plan.channels.iter().zip(&plan.experiment.measurements).enumerate() {
        let Corrections { delay, gain, bias } = Corrections::of(channel, measurement.delay, values);
        for sample in plan.samples(segment, index, delay) {
            let row = measurement.signal.values().row(sample);
            let mut place = Between::new(plan, segment, measurement.signal.times()[sample] - delay);
            if measurement.is_quaternion {
                place = place.align(readings, plan.width, channel.first, row);
            }
            for (component, measured) in row.iter().enumerate() {
                // A missing reading.
                if measured.is_nan() {
                    continue;
                }
                let simulated = place.reading(readings, plan.width, channel.first + component);
                each(index, &place, component, (gain * simulated + bias - measured) / measurement.deviation);
            }
        }
    }
}

/// Values that correct a measurement.
pub(super) struct Corrections {
    pub(super) delay: f64,
    pub(super) gain: f64,
    pub(super) bias: f64,
}

impl Corrections {
    pub(super) fn of(channel: &Channel, delay: f64, values: &Values<'_>) -> Self {
        let value = |unknown: Option<usize>, known| unknown.map_or(known, |index| values.value(index));
        Self { delay: value(channel.delay, delay), gain: value(channel.gain, 1.0), bias: value(channel.bias, 0.0) }
    }
}

/// Returns the cost of a segment.
pub(super) fn cost(plan: &Plan, segment: usize, readings: &[f64], values: &Values<'_>) -> f64 {
    let mut sum = 0.0;
    residuals(plan, segment, readings, values, |channel, _, _, residual| {
        sum += plan.experiment.measurements[channel].norm.value(residual);
    });
    sum
}

/// Returns the quadratic model of the cost, given the derivatives by the columns of the state and
/// of the unknowns that change the model.
pub(super) fn quadratic(
    plan: &Plan,
    segment: usize,
    base: &Simulated,
    derivatives: &[Derivative],
    values: &Values<'_>,
) -> Quadratic {
    let (states, unknowns) = (plan.state_columns(segment), values.unknowns.len());
    let columns = states + unknowns;
    let mut matrix = Matrix::zeros(columns + 1, columns + 1);
    let mut row = vec![0.0; columns + 1];
    let mut cost = 0.0;
    let (mut count, mut squares) = (0, 0.0);
    let places: Vec<usize> = derivatives.iter().map(|derivative| plan.column(segment, derivative.column)).collect();
    let h = plan.experiment.model.timestep();
    residuals(plan, segment, &base.readings, values, |index, place, component, residual| {
        let (channel, measurement) = (&plan.channels[index], &plan.experiment.measurements[index]);
        let gain = channel.gain.map_or(1.0, |gain| values.value(gain));
        let component = channel.first + component;
        let simulated = place.reading(&base.readings, plan.width, component);
        row.fill(0.0);
        for (&column, derivative) in places.iter().zip(derivatives) {
            row[column] = gain * place.reading(&derivative.readings, plan.width, component);
        }
        let mut correct = |unknown: Option<usize>, by: f64| {
            if let Some(unknown) = unknown {
                row[states + unknown] += by * values.slope(unknown);
            }
        };
        let [low, high] = place.both(&base.readings, plan.width, component);
        correct(channel.delay, -gain * (high - low) / h);
        correct(channel.gain, simulated);
        correct(channel.bias, 1.0);
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
                add(&mut matrix.row_mut(column)[column..], &row[column..], weight * value);
            }
        }
    });
    for column in 0..=columns {
        (0..column).for_each(|other| matrix[(column, other)] = matrix[(other, column)]);
    }
    Quadratic { cost, matrix, count, squares }
}
