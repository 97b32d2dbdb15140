//! Derivatives by the solver parameters of constraints: `solref`, `solimp`, friction of contacts,
//! and the weight `solmix`.
//!
//! A number of the model changes the parameters of some constraints (`sources.rs`), these the
//! stiffness K, the damping B and the impedance I (`curve.rs`), and these the forces f
//! (`forces.rs`), at constant state and acceleration. So `∂g = −∂(Jᵀ f)`, and the accelerations
//! follow from the matrix H of the linearisation. The Jacobian J depends on the friction of
//! pyramidal cones.
//!
//! The formulas are those of the engine's documentation ("Computation", section "Constraint
//! model") and of E. Todorov, "Convex and analytically-invertible dynamics with contacts and
//! constraints", ICRA 2014. They apply to a state if they give the K, B and I that the engine has
//! computed, and the parameters of its contacts. That is checked at each state.

mod curve;
mod forces;
mod sources;

use self::curve::Curve;
use self::sources::{Change, Origin, SolverParameters};
use super::sink::Sink;
use crate::data::Data;
use crate::derivative::analytic::constraint::{is_active, row_count};
use crate::derivative::method::Kinks;
use crate::derivative::newton::constraint_row;
use crate::derivative::parameter::{Effect, Resolved, SolverNumber};

/// Passes the derivatives of the residual by a number on.
pub(super) fn differentiate(data: &Data, number: SolverNumber, sink: &mut impl Sink) {
    for_each_change(data, number, |row, count, Change { change, .. }| {
        let values = SolverParameters::of(data, row);
        let curve = Curve::new(data, row, count, &values, &change);
        let forces = forces::changes(data, row, count, &curve, &change);
        for (offset, force) in forces.into_iter().take(count).enumerate().filter(|(_, force)| *force != 0.0) {
            constraint_row(data, row + offset).iter().for_each(|(dof, moment)| sink.residual(dof, -moment * force));
        }
    });
}

/// Calls a function for each constraint with a force whose parameters a number changes, with its
/// first row, the count of its rows, and the change.
fn for_each_change(data: &Data, number: SolverNumber, mut call: impl FnMut(usize, usize, Change)) {
    for_each_active(data, |row, count| {
        if let Some(change) = sources::change(data, row, number) {
            call(row, count, change);
        }
    });
}

fn for_each_active(data: &Data, mut call: impl FnMut(usize, usize)) {
    let mut row = 0;
    while row < data.nefc() {
        let count = row_count(data, row);
        if is_active(data, row, count) {
            call(row, count);
        }
        row += count;
    }
}

/// Returns the kinks of the parameters of constraints by some numbers: equal friction of two geoms
/// in contact, of which the contact has the larger. Returns `None` if the engine has computed other
/// parameters of constraints than these formulas.
pub(super) fn examine(data: &Data, resolved: &[Resolved]) -> Option<Kinks> {
    let numbers = || {
        resolved.iter().filter_map(|resolved| match resolved.effect {
            Effect::Solver(number) => Some(number),
            _ => None,
        })
    };
    if numbers().next().is_none() {
        return Some(Kinks::empty());
    }
    let (mut is_understood, mut kinks) = (true, Kinks::empty());
    for_each_active(data, |row, count| {
        let values = SolverParameters::of(data, row);
        let curve = Curve::new(data, row, count, &values, &SolverParameters::default());
        is_understood &=
            curve.is_of_engine(data, row) && Origin::of(data, row).is_some_and(|origin| origin.explains(data, row));
    });
    for number in numbers() {
        for_each_change(data, number, |_, _, change| {
            if change.is_kink {
                kinks |= Kinks::CONSTRAINTS;
            }
        });
    }
    is_understood.then_some(kinks)
}
