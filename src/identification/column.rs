//! Columns of a Jacobian, and the values of the unknowns.

use super::unknown::{Kind, Unknown};
use crate::derivative::{InertialParameters, ModelParameter};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::model::{Model, ModelMut};

/// Step of differences by coordinates of the state, in m, rad and their rates, and by unknowns,
/// relative to their scale.
pub(super) const EPS: f64 = 1e-6;

/// Coordinate that a simulation changes relative to the present point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// Coordinate of the state at the start of the segment.
    State(usize),
    /// Unknown of the model.
    Unknown(usize),
}

/// Derivatives of a simulation by a column: of the readings, and of the state at the end in
/// tangent coordinates.
#[derive(Clone, Debug)]
pub(super) struct Derivative {
    pub(super) column: Column,
    pub(super) readings: Vec<f64>,
    pub(super) end: Vec<f64>,
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
            Column::State(_) => EPS,
            Column::Unknown(index) => self.moved(index) - self.coordinates[index],
        }
    }

    /// Writes all values to a model. Returns `false` if an inertia with these values is impossible.
    pub(super) fn write(&self, moved: Option<usize>, pristine: &Model, model: &mut ModelMut<'_>) -> Result<bool> {
        let mut has_derived_constants = false;
        for (index, unknown) in self.unknowns.iter().enumerate() {
            let value = self.value_after(moved, index);
            match &unknown.kind {
                Kind::Parameter(parameter) => {
                    match parameter {
                        ModelParameter::LogCholesky(body, _) => {
                            if !self.write_inertia(moved, *body, index, model)? {
                                return Ok(false);
                            }
                        }
                        ModelParameter::Number(parameter) => parameter.write(value, pristine, model)?,
                        _ => match parameter.set(model, value) {
                            Err(Error::Invalid { .. }) => return Ok(false),
                            result => result?,
                        },
                    }
                    has_derived_constants |= parameter.has_derived_constants();
                }
                Kind::Edit(edit) => edit(value, model)?,
                Kind::Correction(..) => {}
            }
        }
        if has_derived_constants {
            model.update_constants()?;
        }
        Ok(true)
    }

    /// Writes all coordinates of the inertia of a body at once if `first` is the first of them.
    /// Returns `false` if the inertia is impossible, or so thin that the model rounds an extent to
    /// zero.
    fn write_inertia(
        &self,
        moved: Option<usize>,
        body: BodyId,
        first: usize,
        model: &mut ModelMut<'_>,
    ) -> Result<bool> {
        let coordinate = |unknown: &Unknown| match unknown.kind {
            Kind::Parameter(ModelParameter::LogCholesky(other, at)) if other == body => Some(at),
            _ => None,
        };
        if self.unknowns[..first].iter().any(|unknown| coordinate(unknown).is_some()) {
            return Ok(true);
        }
        let Some(mut coordinates) = InertialParameters::of(model, body).log_cholesky() else { return Ok(false) };
        for (index, unknown) in self.unknowns.iter().enumerate() {
            if let Some(at) = coordinate(unknown) {
                coordinates[at] = self.value_after(moved, index);
            }
        }
        match InertialParameters::from_log_cholesky(&coordinates).write(model, body) {
            Ok(()) => Ok(InertialParameters::of(model, body).log_cholesky().is_some()),
            Err(Error::Invalid { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Returns the value of an unknown, after a step of differences if it is the moved one.
    fn value_after(&self, moved: Option<usize>, index: usize) -> f64 {
        if moved == Some(index) { self.unknowns[index].value(self.moved(index)) } else { self.value(index) }
    }
}
