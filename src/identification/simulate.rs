//! Simulation of a segment, with the values of the model for each column of a Jacobian.

use std::sync::Arc;

use super::column::{Column, Derivative, EPS, Values};
use super::experiment::Source;
use super::formulas::Formulas;
use super::plan::Plan;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::rollout::restore;

/// Readings of all steps of a segment, and the physics state after them.
#[derive(Clone, Debug, Default)]
pub(super) struct Simulated {
    /// `(steps + 1, width)`. Both are empty if the simulation has become unstable.
    pub(super) readings: Vec<f64>,
    pub(super) end: Vec<f64>,
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
    /// Memory for tangent vectors.
    tangent: Vec<f64>,
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
        let mut moved = Simulated::default();
        if !self.simulate(plan, segment, state, column, values, &mut moved)? {
            return Ok(None);
        }
        let step = values.step(column);
        let mut end = vec![0.0; plan.experiment.uncertainty.len()];
        plan.experiment.model.differentiate_state_into(&base.end, &moved.end, &mut end)?;
        for value in &mut end {
            *value /= step;
        }
        let mut readings = moved.readings;
        for (value, base) in readings.iter_mut().zip(&base.readings) {
            *value = (*value - base) / step;
        }
        Ok(Some(Derivative { column, readings, end }))
    }

    /// Computes the derivatives of a segment by formulas. Returns none if it becomes unstable.
    pub(super) fn by_formulas(
        &mut self,
        plan: &Plan,
        segment: usize,
        state: &[f64],
        columns: &[Column],
        values: &Values<'_>,
    ) -> Result<Vec<Derivative>> {
        let Self { simulations, formulas, .. } = self;
        simulations.resize_with(simulations.len().max(1), || None);
        let Some(data) = prepare(&mut simulations[0], plan, None, values)? else { return Ok(Vec::new()) };
        data.set_state(StateSpec::INTEGRATION, &plan.experiment.start)?;
        data.set_physics_state(state)?;
        if formulas.is_none() {
            *formulas = Some(Formulas::new(plan)?);
        }
        let formulas = formulas.as_mut().expect("Bug: the place has been filled");
        match formulas.differentiate(plan, segment, columns, values, data) {
            Err(Error::Unstable(_)) => Ok(Vec::new()),
            result => result,
        }
    }

    /// Simulates a segment that starts in a physics state. Returns `false` if it becomes unstable.
    pub(super) fn simulate(
        &mut self,
        plan: &Plan,
        segment: usize,
        state: &[f64],
        column: Column,
        values: &Values<'_>,
        result: &mut Simulated,
    ) -> Result<bool> {
        let Self { simulations, tangent, .. } = self;
        let place = if let Column::Unknown(index) = column { index + 1 } else { 0 };
        simulations.resize_with(simulations.len().max(place + 1), || None);
        let Some(data) = prepare(&mut simulations[place], plan, place.checked_sub(1), values)? else {
            return Ok(false);
        };

        let Plan { experiment, nodes, .. } = plan;
        let model = data.model().clone();
        data.set_state(StateSpec::INTEGRATION, &experiment.start)?;
        data.set_physics_state(state)?;
        if let Column::State(coordinate) = column {
            let nv = model.nv();
            match coordinate.checked_sub(nv) {
                None => {
                    tangent.clear();
                    tangent.resize(nv, 0.0);
                    tangent[coordinate] = 1.0;
                    data.integrate_pos(tangent, EPS)?;
                }
                Some(rate) if rate < nv => data.qvel_mut()[rate] += EPS,
                Some(rest) => data.act_mut()[rest - nv] += EPS,
            }
        }
        result.readings.clear();
        match steps(plan, segment, data, &mut result.readings) {
            Ok(()) => {
                result.end.resize(model.state_size(StateSpec::PHYSICS), 0.0);
                data.physics_state_into(&mut result.end)?;
                debug_assert_eq!(result.readings.len(), (nodes[segment + 1] - nodes[segment] + 1) * plan.width);
                Ok(true)
            }
            Err(Error::Unstable(_)) => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// Returns a simulation with the present values of the unknowns, one of which may have moved, or
/// none if a model with these values is impossible.
fn prepare<'s>(
    place: &'s mut Option<Prepared>,
    plan: &Plan,
    moved: Option<usize>,
    values: &Values<'_>,
) -> Result<Option<&'s mut Data>> {
    let pristine = &plan.experiment.model;
    if !place.as_ref().is_some_and(|prepared| Arc::ptr_eq(&prepared.pristine, pristine)) {
        *place = Some(Prepared { data: Data::new(pristine)?, version: 0, pristine: pristine.clone() });
    }
    let prepared = place.as_mut().expect("Bug: the place has been filled");
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
    Ok(Some(&mut prepared.data))
}

/// Performs the steps of a segment, and reads each state.
fn steps(plan: &Plan, segment: usize, data: &mut Data, readings: &mut Vec<f64>) -> Result<()> {
    let (first, last) = (plan.nodes[segment], plan.nodes[segment + 1]);
    let needs_forward = plan.needs_forward();
    for step in first..=last {
        plan.set_inputs(step, data);
        if step == last || needs_forward {
            data.forward()?;
            read(plan, data, readings)?;
        }
        if step < last {
            data.step()?;
            if !needs_forward {
                // The readings of the state before the step.
                read(plan, data, readings)?;
            }
        }
    }
    Ok(())
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
