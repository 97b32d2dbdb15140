//! Derivatives of a segment in closed form, where many columns make differences slow.
//!
//! The linearised steps propagate the derivatives S of the state, `S' = A S + ∂f/∂θ`, and `C S +
//! ∂y/∂θ` are those of the readings. Derivatives by parameters are those at constant derived
//! quantities, such as the inertias that weigh constraints.

use super::column::{Column, Derivative, Values};
use super::experiment::Source;
use super::plan::{PART, Plan, STEP};
use super::unknown::{Kind, Unknown};
use crate::data::Data;
use crate::derivative::{
    Lineariser, ModelParameter, ParameterJacobian, StateSpace, TransitionMethod, TransitionOptions, TransitionOutputs,
};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::rollout::Parameter;

/// Number of columns from which on formulas are faster than differences: a linearisation takes as
/// long as a few steps.
const MIN_COLUMNS: usize = 8;

/// Lineariser of a thread, with buffers.
#[derive(Debug)]
pub(super) struct Formulas {
    lineariser: Lineariser,
    system: StateSpace,
    parameters: Vec<ModelParameter>,
    by_parameters: ParameterJacobian,
}

impl Formulas {
    /// Creates the buffers for simulations of a model.
    pub(super) fn new(plan: &Plan) -> Result<Self> {
        let model = &plan.experiment.model;
        let lineariser = Lineariser::new(model, TransitionOptions::default())?;
        let by_parameters = ParameterJacobian::zeros(model, 0);
        Ok(Self { lineariser, system: StateSpace::zeros(model), parameters: Vec::new(), by_parameters })
    }

    /// Returns the unknowns whose columns should be computed by formulas, besides those of the
    /// state, or `None` if they do not apply to an experiment: some measurements are not those of
    /// sensors, the closed form does not apply, or there are only a few columns.
    pub(super) fn unknowns(plan: &Plan, unknowns: &[Unknown]) -> Result<Option<Vec<usize>>> {
        if plan.needs_forward() {
            return Ok(None);
        }
        let mut formulas = Self::new(plan)?;
        let mut data = Data::new(&plan.experiment.model)?;
        match formulas.lineariser.linear_system_into(&mut data, &mut formulas.system) {
            Ok(report) if report.method == TransitionMethod::Analytic => {}
            Ok(_) | Err(Error::Unsupported(_) | Error::Unstable(_)) => return Ok(None),
            Err(error) => return Err(error),
        }
        let mut found = Vec::new();
        for (index, unknown) in unknowns.iter().enumerate() {
            if let Kind::Parameter(parameter) = unknown.kind
                && unknown.has_column()
                && formulas.lineariser.differenced_parameters(&[parameter])?.is_empty()
            {
                found.push(index);
            }
        }
        let states = (0..plan.segments()).map(|segment| plan.states(segment).len()).max().unwrap_or(0);
        Ok((states + found.len() >= MIN_COLUMNS).then_some(found))
    }

    /// Computes the derivatives of a part of a segment by coordinates of the state at its start and
    /// by unknowns. `states` are those from there to the end of the segment. Returns an error for
    /// an unstable simulation.
    pub(super) fn differentiate(
        &mut self,
        plan: &Plan,
        columns: &[Column],
        values: &Values<'_>,
        data: &mut Data,
        states: &[Vec<f64>],
    ) -> Result<Vec<Derivative>> {
        let Self { lineariser, system, parameters, by_parameters } = self;
        // The unknowns come last.
        let coordinates = columns.iter().take_while(|column| matches!(column, Column::State(_))).count();
        let (asked, factors): (Vec<_>, Vec<_>) =
            columns[coordinates..].iter().filter_map(|&column| parameter(column, values)).unzip();
        if asked != *parameters {
            *by_parameters = ParameterJacobian::zeros(data.model(), asked.len());
            *parameters = asked;
        }
        let size = plan.experiment.uncertainty.len();
        let mut present = Matrix::zeros(size, columns.len());
        let mut next = present.clone();
        let mut readings = Matrix::zeros(data.model().nsensordata(), columns.len());
        let empty = |&column: &Column| {
            let readings = Vec::with_capacity(PART.min(states.len()) * plan.width);
            Derivative { column, readings, end: vec![0.0; size] }
        };
        let mut derivatives: Vec<Derivative> = columns.iter().map(empty).collect();
        for (place, column) in columns.iter().enumerate() {
            if let Column::State(coordinate) = column {
                present[(*coordinate, place)] = 1.0;
            }
        }
        for (index, state) in states.iter().take(PART).enumerate() {
            data.set_state(STEP, state)?;
            let is_last = index + 1 == states.len();
            let a = (!is_last).then_some(&mut system.a);
            let outputs = TransitionOutputs { a, c: Some(&mut system.c), ..Default::default() };
            lineariser.linear_system_with_parameters_into(data, outputs, parameters, (&mut *by_parameters).into())?;
            // The derivatives of a product with the state, and those by the parameters.
            let multiply = |by_state: &Matrix, by_parameters: &Matrix, result: &mut Matrix| {
                result.transposed_mut().gemm(1.0, &present.transposed(), &by_state.transposed(), 0.0);
                for (row, values) in by_parameters.rows().enumerate() {
                    let outputs = result.row_mut(row)[coordinates..].iter_mut();
                    outputs.zip(values).zip(&factors).for_each(|((output, value), factor)| *output += factor * value);
                }
            };
            multiply(&system.c, &by_parameters.sensors, &mut readings);
            for measurement in &plan.experiment.measurements {
                let Source::Sensor(range) = &measurement.source else { continue };
                for row in range.clone() {
                    for (derivative, &value) in derivatives.iter_mut().zip(readings.row(row)) {
                        derivative.readings.push(value);
                    }
                }
            }
            if !is_last {
                multiply(&system.a, &by_parameters.state, &mut next);
                std::mem::swap(&mut present, &mut next);
            }
        }
        for (place, derivative) in derivatives.iter_mut().enumerate() {
            derivative.end.iter_mut().enumerate().for_each(|(row, value)| *value = present[(row, place)]);
        }
        Ok(derivatives)
    }
}

/// Returns the parameter of the model that a column is, with the derivative of its value by the
/// coordinate.
fn parameter(column: Column, values: &Values<'_>) -> Option<(ModelParameter, f64)> {
    let Column::Unknown(index) = column else { return None };
    let Kind::Parameter(parameter) = values.unknowns[index].kind else { return None };
    let slope = values.slope(index);
    // A factor is relative to the present mass.
    let is_factor = matches!(parameter, ModelParameter::Number(Parameter::MassFactor(_)));
    Some((parameter, if is_factor { slope / values.value(index) } else { slope }))
}
