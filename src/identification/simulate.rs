//! Simulation of a segment, with the values of the model for each column of a Jacobian.

use std::sync::Arc;

use super::experiment::Source;
use super::formulas::Formulas;
use super::plan::Plan;
use super::states::difference;
use super::unknown::{Kind, Unknown};
use crate::data::{Data, StateSpec};
use crate::derivative::ModelParameter;
use crate::error::{Error, Result};
use crate::model::{Model, ModelMut};
use crate::rollout::restore;

/// Step of differences by coordinates of the state, in m, rad and their rates, and by unknowns,
/// relative to their scale.
const EPS: f64 = 1e-6;

/// What differs from the present point in a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Nothing,
    /// Coordinate of the state at the start of the segment.
    State(usize),
    /// Unknown of the model.
    Unknown(usize),
}

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

/// Derivatives of a [`Simulated`] by a column: of the readings, and of the state at the end in
/// tangent coordinates.
#[derive(Clone, Debug)]
pub(super) struct Derivative {
    pub(super) column: Column,
    pub(super) readings: Vec<f64>,
    pub(super) end: Vec<f64>,
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

/// Values of the unknowns.
pub(super) struct Values<'v> {
    pub(super) unknowns: &'v [Unknown],
    pub(super) coordinates: &'v [f64],
    /// Number that differs for other values.
    pub(super) version: u64,
}

impl Values<'_> {
    /// Returns the value of an unknown.
    pub(super) fn value(&self, index: usize) -> f64 {
        self.unknowns[index].value(self.coordinates[index])
    }

    /// Returns the derivative of the value of an unknown by its coordinate.
    pub(super) fn slope(&self, index: usize) -> f64 {
        if self.unknowns[index].is_logarithmic { self.value(index) } else { 1.0 }
    }

    /// Returns the coordinate of an unknown after a step of differences, which is within the
    /// bounds.
    pub(super) fn moved(&self, index: usize) -> f64 {
        let unknown = &self.unknowns[index];
        let (coordinate, size) = (self.coordinates[index], EPS * unknown.coordinate_scale());
        if coordinate + size > unknown.bounds()[1] { coordinate - size } else { coordinate + size }
    }

    /// Returns the step of differences of a column.
    pub(super) fn step(&self, column: Column) -> f64 {
        match column {
            Column::Nothing => 1.0,
            Column::State(_) => EPS,
            Column::Unknown(index) => self.moved(index) - self.coordinates[index],
        }
    }

    /// Writes all values to a model. Returns `false` if an inertia with these values is impossible.
    pub(super) fn write(&self, moved: Option<usize>, pristine: &Model, model: &mut ModelMut<'_>) -> Result<bool> {
        let mut has_derived_constants = false;
        for (index, unknown) in self.unknowns.iter().enumerate() {
            let value = if moved == Some(index) { unknown.value(self.moved(index)) } else { self.value(index) };
            match &unknown.kind {
                Kind::Parameter(parameter) => {
                    match parameter {
                        ModelParameter::Number(parameter) => parameter.write(value, pristine, model)?,
                        _ => match parameter.set(model, value) {
                            Err(Error::Invalid { .. }) => return Ok(false),
                            result => result?,
                        },
                    }
                    has_derived_constants |= parameter.has_derived_constants();
                }
                Kind::Edit(edit) => edit(value, model)?,
                Kind::Delay(_) | Kind::Gain(_) | Kind::Bias(_) => {}
            }
        }
        if has_derived_constants {
            model.update_constants()?;
        }
        Ok(true)
    }
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
        difference(&plan.experiment.model, &base.end, &moved.end, &mut end)?;
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
