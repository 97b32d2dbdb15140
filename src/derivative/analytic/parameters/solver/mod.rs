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
mod dual;
mod forces;
mod sources;

use std::iter::from_fn;

use self::curve::Curve;
use self::sources::SolverParameters;
use super::columns::Column;
use crate::data::Data;
use crate::derivative::analytic::constraint::{is_active, row_count};
use crate::derivative::method::Kinks;
use crate::derivative::newton::constraint_row;
use crate::derivative::parameter::{Effect, Resolved, SolverNumber};

/// Passes the derivatives of the residual by a number on.
pub(super) fn differentiate(data: &Data, number: SolverNumber, column: &mut Column<'_>) {
    for (row, count) in active(data) {
        let Some(parameters) = SolverParameters::of(data, row, Some(number)).filter(SolverParameters::varies) else {
            continue;
        };
        let curve = Curve::new(data, row, count, &parameters);
        let forces = forces::changes(data, row, count, &curve, &parameters);
        for (offset, force) in forces.into_iter().take(count).enumerate().filter(|(_, force)| *force != 0.0) {
            constraint_row(data, row + offset).iter().for_each(|(dof, moment)| column.residual(dof, -moment * force));
        }
    }
}

/// Returns the first row and the count of rows of each constraint with a force.
fn active(data: &Data) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut next = 0;
    let all = from_fn(move || {
        let row = next;
        (row < data.nefc()).then(|| {
            let count = row_count(data, row);
            next += count;
            (row, count)
        })
    });
    all.filter(|&(row, count)| is_active(data, row, count))
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
    let mut is_kink = false;
    for (row, count) in active(data) {
        let parameters = SolverParameters::of(data, row, None)?;
        if !Curve::new(data, row, count, &parameters).is_of_engine(data, row) {
            return None;
        }
        let mut of_numbers = numbers().filter_map(|number| SolverParameters::of(data, row, Some(number)));
        is_kink |= of_numbers.any(|parameters| parameters.is_kink);
    }
    Some(if is_kink { Kinks::CONSTRAINTS } else { Kinks::empty() })
}
