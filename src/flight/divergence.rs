//! Largest difference of a quantity, its element, and its size against rounding.

use std::fmt;
use std::ops::Range;

use super::matched::is_contact;
use super::quantities::{Quantity, Rows, Series, find};
use crate::kind::Kind;
use crate::model::Model;
use crate::sys;

/// Quantity that differs between two engines.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Divergence {
    /// Number of the call, counted from the begin of the trace.
    pub call: u64,
    /// Simulated time before the call, s.
    pub time: f64,
    /// Method of [`Data`](crate::Data) that computes the quantity; or `model`, `sensors`,
    /// `integration`, `call`.
    pub stage: &'static str,
    /// Quantity: a field of the engine; a field of contacts; `M·u` and so on, the product of a
    /// matrix and a constant test vector; `next qpos` and so on, after the step.
    pub field: String,
    /// Element with the largest difference relative to rounding.
    pub element: String,
    /// Value in the trace, or the number of values.
    pub there: f64,
    /// Value of this engine, or the number of values.
    pub here: f64,
    /// Effect of rounding on this value: its largest change in three evaluations whose inputs are
    /// changed by 4 ε, and ε times the largest value of its row, or a thousandth of the largest
    /// one of the quantity. A difference up to 100 times as large counts as rounding. Zero for
    /// numbers of rows.
    pub rounding: f64,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { call, time, stage, field, element, there, here, rounding } = self;
        write!(f, "call {call} at {time} s, {stage}: {field} of {element}: {there} there, {here} here")?;
        let difference = (there - here).abs();
        write!(f, ", difference {difference:.1e}")?;
        if *rounding > 0.0 { write!(f, ", rounding {rounding:.1e}") } else { Ok(()) }
    }
}

/// Value that differs most, relative to rounding.
pub(super) struct Pair {
    pub(super) row: usize,
    column: usize,
    pub(super) there: f64,
    pub(super) here: f64,
    pub(super) rounding: f64,
    /// Ratio of the difference to the effect of rounding.
    pub(super) ratio: f64,
}

impl Pair {
    /// Returns the worst value. `disturbed` has the results of inputs that differ by rounding. A
    /// difference up to `near_zero` is none.
    pub(super) fn worst(there: &Series, here: &Series, disturbed: &[Option<&Series>], near_zero: f64) -> Option<Self> {
        let has_same_length = |other: &Series| other.values.len() == here.values.len();
        if !has_same_length(there) || there.columns != here.columns {
            let is_rounding = disturbed.iter().any(|other| !other.is_some_and(has_same_length));
            let (ratio, rounding) = if is_rounding { (0.0, f64::INFINITY) } else { (f64::INFINITY, 0.0) };
            let [there, here] = [there, here].map(|values| (values.values.len() / values.columns) as f64);
            return Some(Self { row: usize::MAX, column: 0, there, here, rounding, ratio });
        }
        let scale = |values: &[f64]| values.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        let of_field = 1e-3 * scale(&there.values).max(scale(&here.values));
        let mut worst = None::<Self>;
        for (row, (a, b)) in there.values.chunks(here.columns).zip(here.values.chunks(here.columns)).enumerate() {
            // A value can be the difference of larger ones.
            let mut rounding = f64::EPSILON * scale(a).max(scale(b)).max(of_field);
            for other in disturbed {
                let other = other.and_then(|other| other.values.chunks(here.columns).nth(row));
                let Some(other) = other else { continue };
                rounding += b.iter().zip(other).fold(0.0, |most: f64, (b, other)| most.max((b - other).abs()));
            }
            for (column, (&there, &here)) in a.iter().zip(b).enumerate() {
                let difference = (there - here).abs();
                let is_same = there == here || (there.is_nan() && here.is_nan()) || difference <= near_zero;
                let ratio = match is_same {
                    true => 0.0,
                    false if difference.is_finite() => difference / rounding,
                    false => f64::INFINITY,
                };
                if ratio > worst.as_ref().map_or(0.0, |worst| worst.ratio) {
                    worst = Some(Self { row, column, there, here, rounding, ratio });
                }
            }
        }
        worst
    }

    /// Returns the error of the solver: the difference from a result that has converged, of all
    /// values together, because the error has no direction; of sensors in this row.
    pub(super) fn error(&self, quantity: &Quantity, converged: &Series, here: &Series) -> f64 {
        if converged.values.len() != here.values.len() {
            return 0.0;
        }
        let rows = converged.values.chunks(here.columns).zip(here.values.chunks(here.columns)).enumerate();
        let rows = rows.filter(|(row, _)| quantity.rows != Rows::Readings || *row == self.row);
        let differences = rows.flat_map(|(_, (a, b))| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
        differences.fold(0.0, f64::max)
    }

    pub(super) fn report(&self, call: u64, time: f64, stage: &'static str, field: &str, element: String) -> Divergence {
        let (&Self { there, here, rounding, .. }, field) = (self, field.to_owned());
        Divergence { call, time, stage, field, element, there, here, rounding }
    }

    /// Returns the name of the element. `owner` names the owner of a row.
    pub(super) fn element(&self, columns: usize, owner: impl FnOnce(usize) -> String) -> String {
        match self.row {
            usize::MAX => "the number of rows".to_owned(),
            row if columns > 1 => format!("{}[{}]", owner(row), self.column),
            row => owner(row),
        }
    }
}

/// Returns the name of the object to which a row belongs. `here` has all quantities.
pub(super) fn row_name(rows: Rows, row: usize, here: &[Series], model: &Model) -> String {
    let value = |name: &str, index: usize| {
        find(here, name).and_then(|values| values.values.get(index)).map_or(-1.0, |value| *value)
    };
    let described = |kind, index: f64| model.described(kind, index.max(0.0) as usize);
    let has_row = |range: Range<usize>| range.contains(&row);
    match rows {
        Rows::Elements(kind) => model.described(kind, row),
        Rows::Positions => {
            let joint = model.joints().find(|joint| has_row(joint.qpos_range())).expect("Bug: a position has a joint");
            format!("{}[{}]", model.described(Kind::Joint, joint.index()), row - joint.qpos_range().start)
        }
        Rows::Dofs => {
            let joint = model.joints().find(|joint| has_row(joint.dofs())).expect("Bug: a velocity has a joint");
            format!("{}[{}]", model.described(Kind::Joint, joint.index()), row - joint.dofs().start)
        }
        Rows::Activations => model.described(Kind::Actuator, model.actuator_of_activation(row)),
        Rows::Outputs => {
            let actuator =
                (0..model.nactuator()).position(|actuator| has_row(model.outputs_of(actuator))).unwrap_or_default();
            model.described(Kind::Actuator, actuator)
        }
        Rows::Readings => {
            let sensor = model.sensors().position(|sensor| has_row(sensor.data_range())).unwrap_or_default();
            model.described(Kind::Sensor, sensor)
        }
        Rows::Contacts => {
            let geoms = [0, 1].map(|side| described(Kind::Geom, value("contact.geom", 2 * row + side)));
            format!("contact {row} of {} and {}", geoms[0], geoms[1])
        }
        Rows::Constraints => {
            let (of, id) = (value("efc_type", row), value("efc_id", row));
            let owner = match of as u32 {
                _ if is_contact(of) => row_name(Rows::Contacts, id.max(0.0) as usize, here, model),
                sys::mjCNSTR_EQUALITY => described(Kind::Equality, id),
                sys::mjCNSTR_FRICTION_DOF => {
                    format!("friction of {}", row_name(Rows::Dofs, id.max(0.0) as usize, here, model))
                }
                sys::mjCNSTR_LIMIT_JOINT => format!("limit of {}", described(Kind::Joint, id)),
                _ => described(Kind::Tendon, id),
            };
            format!("row {row}, {owner}")
        }
        Rows::One => "the simulation".to_owned(),
    }
}
