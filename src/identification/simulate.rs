//! Simulation of a segment, with the values of the model for each column of a Jacobian.

use std::sync::Arc;

use super::column::{Column, Derivative, EPS, Values};
use super::experiment::Source;
use super::formulas::Formulas;
use super::plan::{Plan, STEP};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::numerics::linear_algebra::quotient;
use crate::rollout::restore;

/// Readings of all steps of a segment, and the physics state after them.
#[derive(Clone, Debug, Default)]
pub(super) struct Simulated {
    /// `(steps + 1, width)`. Both are empty if the simulation has become unstable.
    pub(super) readings: Vec<f64>,
    pub(super) end: Vec<f64>,
    /// [`STEP`] before each step and at the end, if formulas need it.
    pub(super) states: Vec<Vec<f64>>,
}

impl Simulated {
    /// Returns `true` if the simulation reached the end.
    pub(super) fn is_stable(&self) -> bool {
        !self.end.is_empty()
    }
}

/// Simulations of one thread: for the present point, and for a change of each unknown.
#[derive(Default)]
pub(super) struct Worker {
    simulations: Vec<Option<Prepared>>,
    formulas: Option<Formulas>,
}

/// Simulation with a model that has been edited for a version of the unknowns.
struct Prepared {
    data: Data,
    version: u64,
    /// Model of the experiment that the edits started from.
    pristine: Arc<Model>,
}

impl Worker {
    /// Differences the simulation of a segment by a column. Returns `None` if it becomes unstable.
    pub(super) fn difference(
        &mut self,
        plan: &Plan,
        segment: usize,
        state: &[f64],
        column: Column,
        values: &Values<'_>,
        base: &Simulated,
    ) -> Result<Option<Derivative>> {
        let moved = self.simulate(plan, segment, state, Some(column), values)?;
        if !moved.is_stable() {
            return Ok(None);
        }
        let step = values.step(column);
        let (mut readings, mut end) = (moved.readings.clone(), vec![0.0; plan.experiment.uncertainty.len()]);
        quotient(&mut readings, &base.readings, &moved.readings, step);
        plan.experiment.model.differentiate_state_into(&base.end, &moved.end, &mut end)?;
        for value in &mut end {
            *value /= step;
        }
        Ok(Some(Derivative { column, readings, end }))
    }

    /// Computes the derivatives of a part of a segment by formulas, given the states from its start
    /// to the end of the segment. Returns none if it becomes unstable.
    pub(super) fn by_formulas(
        &mut self,
        plan: &Plan,
        columns: &[Column],
        values: &Values<'_>,
        states: &[Vec<f64>],
    ) -> Result<Vec<Derivative>> {
        let Self { simulations, formulas } = self;
        let Some(data) = prepare(simulations, plan, None, values)? else { return Ok(Vec::new()) };
        let formulas = match formulas {
            Some(formulas) => formulas,
            empty => empty.insert(Formulas::new(plan)?),
        };
        if_stable(formulas.differentiate(plan, columns, values, data, states))
    }

    /// Simulates a segment that starts in a physics state, with or without a change of a column.
    pub(super) fn simulate(
        &mut self,
        plan: &Plan,
        segment: usize,
        state: &[f64],
        column: Option<Column>,
        values: &Values<'_>,
    ) -> Result<Simulated> {
        let (mut state, mut moved) = (state.to_vec(), None);
        match column {
            None => {}
            Some(Column::State(coordinate)) => {
                let mut change = vec![0.0; plan.experiment.uncertainty.len()];
                change[coordinate] = EPS;
                plan.experiment.model.integrate_state(&mut state, &change)?;
            }
            Some(Column::Unknown(index)) => moved = Some(index),
        }
        let Some(data) = prepare(&mut self.simulations, plan, moved, values)? else {
            return Ok(Simulated::default());
        };
        data.set_physics_state(&state)?;
        if_stable(steps(plan, segment, data))
    }
}

/// Replaces the error of an unstable simulation by an empty result.
fn if_stable<T: Default>(result: Result<T>) -> Result<T> {
    if matches!(result, Err(Error::Unstable(_))) { Ok(T::default()) } else { result }
}

/// Prepares a simulation at the start of the experiment, with the values and the change of an
/// unknown. Returns `None` if the values are not possible.
fn prepare<'s>(
    simulations: &'s mut Vec<Option<Prepared>>,
    plan: &Plan,
    moved: Option<usize>,
    values: &Values<'_>,
) -> Result<Option<&'s mut Data>> {
    let place = moved.map_or(0, |index| index + 1);
    simulations.resize_with(simulations.len().max(place + 1), || None);
    let pristine = &plan.experiment.model;
    let simulation = &mut simulations[place];
    simulation.take_if(|prepared| !Arc::ptr_eq(&prepared.pristine, pristine));
    let prepared = match simulation {
        Some(prepared) => prepared,
        empty => empty.insert(Prepared { data: Data::new(pristine)?, version: 0, pristine: pristine.clone() }),
    };
    if prepared.version != values.version {
        prepared.version = 0;
        let is_possible = prepared.data.edit_model(|model| {
            restore(model, pristine);
            values.write(moved, pristine, model)
        })?;
        if !is_possible {
            return Ok(None);
        }
        prepared.version = values.version;
    }
    if prepared.data.check_usable().is_err() {
        prepared.data.reset()?;
    }
    prepared.data.set_state(StateSpec::INTEGRATION, &plan.experiment.start)?;
    Ok(Some(&mut prepared.data))
}

/// Performs the steps of a segment, and reads each state.
fn steps(plan: &Plan, segment: usize, data: &mut Data) -> Result<Simulated> {
    let (mut readings, mut states) = (Vec::new(), Vec::new());
    let (first, last) = (plan.nodes[segment], plan.nodes[segment + 1]);
    let needs_forward = plan.needs_forward();
    for step in first..=last {
        plan.set_inputs(step, data);
        if plan.formulas.is_some() {
            states.push(data.state(STEP));
        }
        if step == last || needs_forward {
            data.forward()?;
            read(plan, data, &mut readings)?;
        }
        if step < last {
            data.step()?;
            if !needs_forward {
                // The readings of the state before the step.
                read(plan, data, &mut readings)?;
            }
        }
    }
    Ok(Simulated { readings, end: data.state(StateSpec::PHYSICS), states })
}

fn read(plan: &Plan, data: &mut Data, readings: &mut Vec<f64>) -> Result<()> {
    for measurement in &plan.experiment.measurements {
        match &measurement.source {
            Source::Sensor(range) => readings.extend_from_slice(&data.sensordata()[range.clone()]),
            Source::Read(read) => {
                let first = readings.len();
                readings.resize(first + measurement.signal.width(), 0.0);
                read(data, &mut readings[first..])?;
            }
        }
    }
    Ok(())
}
