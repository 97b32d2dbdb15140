//! Solver parameters of constraints, computed from the elements of the model that they follow from.
//!
//! A contact has the parameters of an explicit pair, or mixes those of its geoms: with different
//! priorities those of one geom, else the larger friction, and the mean of `solref` and `solimp`,
//! weighted by `solmix`. If a geom has a `solref` in direct format, the contact has the smaller
//! numbers of the two.

use std::array;
use std::cmp::Ordering;

use mujoco_sys::{
    mjCNSTR_EQUALITY, mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON,
    mjMINMU, mjMINVAL,
};

use super::dual::Dual;
use crate::data::Data;
use crate::derivative::newton::contacts;
use crate::derivative::parameter::{Element, Quantity, SolverNumber};
use crate::enums::Collision;
use crate::ffi;
use crate::model::{EnableFlags, Model};

/// Largest relative difference of numbers that are computed in another order.
const ROUNDING: f64 = 1e-12;

/// Solver parameters of a constraint, with their derivatives by a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolverParameters {
    pub(super) reference: [Dual; 2],
    pub(super) impedance: [Dual; 5],
    /// Friction along the base rows of a contact after the first, zero for other constraints.
    pub(super) friction: [Dual; 5],
    /// True if the parameters have a kink, with the mean of both sides as the derivative.
    pub(super) is_kink: bool,
}

impl SolverParameters {
    /// Returns the parameters of the constraint that starts at a row. `None` if they do not follow
    /// from the element of the number, if the engine has computed others, for a contact of flexes,
    /// and of geoms with several pairs.
    pub(super) fn of(data: &Data, row: usize, number: Option<SolverNumber>) -> Option<Self> {
        let id = ffi::size(data.efc_id()[row]);
        #[expect(non_upper_case_globals, reason = "the engine's constants")]
        let element = match data.efc_type()[row] as u32 {
            mjCNSTR_EQUALITY => Element::Equality(id),
            mjCNSTR_FRICTION_DOF => Element::Dof(id),
            mjCNSTR_FRICTION_TENDON => Element::TendonFriction(id),
            mjCNSTR_LIMIT_JOINT => Element::Joint(id),
            mjCNSTR_LIMIT_TENDON => Element::TendonLimit(id),
            _ => return Self::of_contact(data, id, number),
        };
        is_of(number, element).then(|| Self::of_element(data.model(), element, number))
    }

    fn of_contact(data: &Data, contact: usize, number: Option<SolverNumber>) -> Option<Self> {
        let model = data.model();
        let contact = &contacts(data)[contact];
        let geoms = [contact.geom1, contact.geom2].map(|geom| usize::try_from(geom).ok());
        let [Some(first), Some(second)] = geoms else { return None };
        let mut pairs = model.pair_geom1().iter().zip(model.pair_geom2()).enumerate().filter(|(_, pair)| {
            let pair = [ffi::size(*pair.0), ffi::size(*pair.1)];
            pair == [first, second] || pair == [second, first]
        });
        let mut parameters = match (pairs.next(), pairs.next()) {
            (Some((pair, _)), None)
                if model.options().collision != Collision::Dynamic && is_of(number, Element::Pair(pair)) =>
            {
                Self::of_element(model, Element::Pair(pair), number)
            }
            (None, None) if is_of(number, Element::Geom(first)) || is_of(number, Element::Geom(second)) => {
                Self::mixed(model, [first, second], number)
            }
            _ => return None,
        };
        // The options can override the parameters of contacts, since 3.0 also their friction.
        if model.raw().opt.enableflags as u32 & EnableFlags::OVERRIDE.bits() != 0 {
            parameters.reference = contact.solref.map(Dual::constant);
            parameters.impedance = contact.solimp.map(Dual::constant);
            if cfg!(engine_since = "3.0.0") {
                parameters.friction = contact.friction.map(Dual::constant);
            }
        }
        let agree = |ours: &[Dual], theirs: &[f64]| {
            let mut pairs = ours.iter().zip(theirs);
            pairs.all(|(ours, theirs)| (ours.value - theirs).abs() <= ROUNDING * theirs.abs().max(ROUNDING))
        };
        let is_of_engine = agree(&parameters.reference, &contact.solref)
            && agree(&parameters.impedance, &contact.solimp)
            && agree(&parameters.friction, &contact.friction);
        is_of_engine.then_some(parameters)
    }

    /// Returns the parameters of an element of the model.
    fn of_element(model: &Model, element: Element, number: Option<SolverNumber>) -> Self {
        let (reference, impedance) = match element {
            Element::Geom(id) => (model.geom_solref()[id], model.geom_solimp()[id]),
            Element::Pair(id) => (model.pair_solref()[id], model.pair_solimp()[id]),
            Element::Joint(id) => (model.jnt_solref()[id], model.jnt_solimp()[id]),
            Element::Dof(id) => (model.dof_solref()[id], model.dof_solimp()[id]),
            Element::TendonLimit(id) => (model.tendon_solref_lim()[id], model.tendon_solimp_lim()[id]),
            Element::TendonFriction(id) => (model.tendon_solref_fri()[id], model.tendon_solimp_fri()[id]),
            Element::Equality(id) => (model.eq_solref()[id], model.eq_solimp()[id]),
        };
        let is_varied = |quantity| number == Some(SolverNumber { element, quantity });
        let of_friction = |at| is_varied(Quantity::Friction(at));
        let friction = match element {
            Element::Geom(id) => {
                let [slide, spin, roll] = Dual::numbers(model.geom_friction()[id], of_friction);
                [slide, slide, spin, roll, roll]
            }
            Element::Pair(id) => Dual::numbers(model.pair_friction()[id], of_friction),
            _ => [Dual::default(); 5],
        };
        Self {
            reference: Dual::numbers(reference, |at| is_varied(Quantity::Reference(at))),
            impedance: Dual::numbers(impedance, |at| is_varied(Quantity::Impedance(at))),
            // Less friction than the engine's minimum has no effect.
            friction: friction
                .map(|friction| if friction.value > mjMINMU { friction } else { Dual::constant(mjMINMU) }),
            is_kink: false,
        }
    }

    /// Returns the mixed parameters of two geoms.
    fn mixed(model: &Model, geoms: [usize; 2], number: Option<SolverNumber>) -> Self {
        let [one, other] = geoms.map(|geom| Self::of_element(model, Element::Geom(geom), number));
        match model.geom_priority()[geoms[0]].cmp(&model.geom_priority()[geoms[1]]) {
            Ordering::Greater => return one,
            Ordering::Less => return other,
            Ordering::Equal => {}
        }
        let share = share(model, geoms, number);
        let mean = |one: Dual, other: Dual| share * one + (Dual::constant(1.0) - share) * other;
        let mut is_kink = false;
        let mut extreme = |one: Dual, other: Dual, order: Ordering| match one.value.partial_cmp(&other.value) {
            Some(Ordering::Equal) => {
                is_kink |= one.change != other.change;
                0.5 * (one + other)
            }
            found if found == Some(order) => one,
            _ => other,
        };
        let is_standard = [one, other].iter().all(|geom| geom.reference[0].value > 0.0);
        let reference = array::from_fn(|at| {
            let [one, other] = [one.reference[at], other.reference[at]];
            if is_standard { mean(one, other) } else { extreme(one, other, Ordering::Less) }
        });
        let friction = array::from_fn(|at| extreme(one.friction[at], other.friction[at], Ordering::Greater));
        let impedance = array::from_fn(|at| mean(one.impedance[at], other.impedance[at]));
        Self { reference, impedance, friction, is_kink }
    }

    /// Returns `true` if the parameters depend on the number.
    pub(super) fn varies(&self) -> bool {
        let mut all = self.reference.iter().chain(&self.impedance).chain(&self.friction);
        all.any(|parameter| parameter.change != 0.0)
    }
}

/// Returns `true` for the element of a number, or any element without one.
fn is_of(number: Option<SolverNumber>, element: Element) -> bool {
    number.is_none_or(|number| number.element == element)
}

/// Returns the weight of the first of two geoms in their mean.
fn share(model: &Model, geoms: [usize; 2], number: Option<SolverNumber>) -> Dual {
    let weights = geoms.map(|geom| {
        let number = number == Some(SolverNumber { element: Element::Geom(geom), quantity: Quantity::Mix });
        Dual { value: model.geom_solmix()[geom], change: if number { 1.0 } else { 0.0 } }
    });
    match weights.map(|weight| weight.value >= mjMINVAL) {
        [true, true] => weights[0] / (weights[0] + weights[1]),
        [false, false] => Dual::constant(0.5),
        [first, _] => Dual::constant(if first { 1.0 } else { 0.0 }),
    }
}
