//! Derivatives of a segment in closed form, where many columns make differences slow.
//!
//! The linearised steps propagate the derivatives of the state, `S' = A S`, and `C S` are those of
//! the readings.

use super::experiment::Source;
use super::plan::Plan;
use super::simulate::{Column, Derivative};
use crate::data::Data;
use crate::derivative::{Lineariser, StateSpace, TransitionMethod, TransitionOptions, TransitionOutputs};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;

/// Number of columns from which on formulas are faster than differences: a linearisation takes as
/// long as a few steps.
const MIN_COLUMNS: usize = 8;

/// Lineariser of a thread, with buffers.
#[derive(Debug)]
pub(super) struct Formulas {
    lineariser: Lineariser,
    system: StateSpace,
}

impl Formulas {
    /// Creates the buffers for simulations of a model.
    pub(super) fn new(plan: &Plan) -> Result<Self> {
        let model = &plan.experiment.model;
        let lineariser = Lineariser::new(model, TransitionOptions::default())?;
        Ok(Self { lineariser, system: StateSpace::zeros(model) })
    }

    /// Returns `true` if a number of columns should be computed by formulas: the measurements are
    /// those of sensors, and the closed form applies.
    pub(super) fn apply(plan: &Plan, columns: usize) -> Result<bool> {
        if columns < MIN_COLUMNS || plan.needs_forward() {
            return Ok(false);
        }
        let mut data = Data::new(&plan.experiment.model)?;
        let mut formulas = Self::new(plan)?;
        match formulas.lineariser.linear_system_into(&mut data, &mut formulas.system) {
            Ok(report) => Ok(report.method == TransitionMethod::Analytic),
            Err(Error::Unsupported(_) | Error::Unstable(_)) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Computes the derivatives of a segment by coordinates of the state. `data` is the simulation at
    /// its start. Returns an error for an unstable one.
    pub(super) fn differentiate(
        &mut self,
        plan: &Plan,
        segment: usize,
        columns: &[Column],
        data: &mut Data,
    ) -> Result<Vec<Derivative>> {
        let Self { lineariser, system } = self;
        let (first, last) = (plan.nodes[segment], plan.nodes[segment + 1]);
        let size = plan.experiment.uncertainty.len();
        let mut present = Matrix::zeros(size, columns.len());
        let mut next = present.clone();
        let mut readings = vec![0.0; columns.len()];
        let empty = |&column: &Column| {
            let readings = Vec::with_capacity((last - first + 1) * plan.width);
            Derivative { column, readings, end: vec![0.0; size] }
        };
        let mut derivatives: Vec<Derivative> = columns.iter().map(empty).collect();
        for (place, column) in columns.iter().enumerate() {
            if let Column::State(coordinate) = column {
                present[(*coordinate, place)] = 1.0;
            }
        }
        for step in first..=last {
            plan.set_inputs(step, data);
            let a = (step < last).then_some(&mut system.a);
            let outputs = TransitionOutputs { a, c: Some(&mut system.c), ..Default::default() };
            lineariser.linear_system_into(data, outputs)?;
            for measurement in &plan.experiment.measurements {
                let Source::Sensor(range) = &measurement.source else { continue };
                for row in range.clone() {
                    readings.fill(0.0);
                    for (factor, values) in system.c.row(row).iter().zip(present.rows()) {
                        if *factor != 0.0 {
                            add(&mut readings, values, *factor);
                        }
                    }
                    derivatives
                        .iter_mut()
                        .zip(&readings)
                        .for_each(|(derivative, &value)| derivative.readings.push(value));
                }
            }
            if step < last {
                for row in 0..size {
                    let next = next.row_mut(row);
                    next.fill(0.0);
                    for (factor, values) in system.a.row(row).iter().zip(present.rows()) {
                        if *factor != 0.0 {
                            add(next, values, *factor);
                        }
                    }
                }
                std::mem::swap(&mut present, &mut next);
                data.step()?;
            }
        }
        for (place, derivative) in derivatives.iter_mut().enumerate() {
            derivative.end.iter_mut().enumerate().for_each(|(row, value)| *value = present[(row, place)]);
        }
        Ok(derivatives)
    }
}
