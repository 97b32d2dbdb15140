//! Solver parameters of constraints, and the elements of the model that they follow from.
//!
//! A contact has the parameters of an explicit pair, or mixes those of its geoms: with different
//! priorities those of one geom, else the larger friction, and the mean of `solref` and `solimp`,
//! weighted by `solmix`. If a geom has a `solref` in direct format, the contact has the smaller
//! numbers of the two.

use mujoco_sys::{
    mjCNSTR_EQUALITY, mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON,
    mjMINMU, mjMINVAL,
};

use crate::data::Data;
use crate::derivative::newton::contacts;
use crate::derivative::parameter::{Element, Quantity, SolverNumber};
use crate::enums::Collision;
use crate::ffi;
use crate::model::{EnableFlags, Model};

/// Largest relative difference of numbers that are computed in another order.
const ROUNDING: f64 = 1e-12;

/// Solver parameters of a constraint, or their derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SolverParameters {
    pub(super) reference: [f64; 2],
    pub(super) impedance: [f64; 5],
    /// Friction along the base rows of a contact after the first, zero for other constraints.
    pub(super) friction: [f64; 5],
}

/// Derivatives of the parameters of a constraint by a number.
pub(super) struct Change {
    pub(super) change: SolverParameters,
    /// True if the parameters have a kink, with the mean of both sides as the derivative.
    pub(super) is_kink: bool,
}

/// Origin of the parameters of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    Element(Element),
    /// The geoms of a contact.
    Mixed([usize; 2]),
}

impl Origin {
    /// Returns the origin of the parameters of the constraint that starts at a row, or `None` for a
    /// contact of flexes, and of geoms with several pairs.
    pub(super) fn of(data: &Data, row: usize) -> Option<Self> {
        let id = ffi::size(data.efc_id()[row]);
        #[expect(non_upper_case_globals, reason = "the engine's constants")]
        let element = match data.efc_type()[row] as u32 {
            mjCNSTR_EQUALITY => Element::Equality(id),
            mjCNSTR_FRICTION_DOF => Element::Dof(id),
            mjCNSTR_FRICTION_TENDON => Element::TendonFriction(id),
            mjCNSTR_LIMIT_JOINT => Element::Joint(id),
            mjCNSTR_LIMIT_TENDON => Element::TendonLimit(id),
            _ => return Self::of_contact(data, id),
        };
        Some(Self::Element(element))
    }

    fn of_contact(data: &Data, contact: usize) -> Option<Self> {
        let model = data.model();
        let contact = &contacts(data)[contact];
        let geoms = [contact.geom1, contact.geom2].map(|geom| usize::try_from(geom).ok());
        let [Some(first), Some(second)] = geoms else { return None };
        let mut pairs = model.pair_geom1().iter().zip(model.pair_geom2()).enumerate().filter(|(_, pair)| {
            let pair = [ffi::size(*pair.0), ffi::size(*pair.1)];
            pair == [first, second] || pair == [second, first]
        });
        match (pairs.next(), pairs.next()) {
            (Some((pair, _)), None) if model.options().collision != Collision::Dynamic => {
                Some(Self::Element(Element::Pair(pair)))
            }
            (None, None) => Some(Self::Mixed([first, second])),
            _ => None,
        }
    }

    /// Returns `true` if the parameters of the constraint that starts at a row, of which this is
    /// the origin, follow from it. Only contacts mix parameters.
    pub(super) fn explains(self, data: &Data, row: usize) -> bool {
        let model = data.model();
        let expected = match self {
            Self::Element(Element::Pair(pair)) => SolverParameters::of_pair(model, pair),
            Self::Mixed(geoms) => SolverParameters::mixed(model, geoms),
            Self::Element(_) => return true,
        };
        let found = SolverParameters::of(data, row);
        let agree = |ours: &[f64], theirs: &[f64]| {
            ours.iter().zip(theirs).all(|(ours, theirs)| (ours - theirs).abs() <= ROUNDING * theirs.abs().max(ROUNDING))
        };
        (overrides(model)
            || (agree(&expected.reference, &found.reference) && agree(&expected.impedance, &found.impedance)))
            && (overrides_friction(model) || agree(&expected.friction, &found.friction))
    }
}

impl SolverParameters {
    /// Returns the parameters of the constraint that starts at a row.
    pub(super) fn of(data: &Data, row: usize) -> Self {
        let (model, id) = (data.model(), ffi::size(data.efc_id()[row]));
        #[expect(non_upper_case_globals, reason = "the engine's constants")]
        let (reference, impedance) = match data.efc_type()[row] as u32 {
            mjCNSTR_EQUALITY => (model.eq_solref()[id], model.eq_solimp()[id]),
            mjCNSTR_FRICTION_DOF => (model.dof_solref()[id], model.dof_solimp()[id]),
            mjCNSTR_FRICTION_TENDON => (model.tendon_solref_fri()[id], model.tendon_solimp_fri()[id]),
            mjCNSTR_LIMIT_JOINT => (model.jnt_solref()[id], model.jnt_solimp()[id]),
            mjCNSTR_LIMIT_TENDON => (model.tendon_solref_lim()[id], model.tendon_solimp_lim()[id]),
            _ => {
                let contact = &contacts(data)[id];
                return Self { reference: contact.solref, impedance: contact.solimp, friction: contact.friction };
            }
        };
        Self { reference, impedance, friction: [0.0; 5] }
    }

    fn of_pair(model: &Model, pair: usize) -> Self {
        Self {
            reference: model.pair_solref()[pair],
            impedance: model.pair_solimp()[pair],
            friction: model.pair_friction()[pair].map(|friction| friction.max(mjMINMU)),
        }
    }

    fn mixed(model: &Model, geoms: [usize; 2]) -> Self {
        let weights = [Weights::new(model, geoms), Weights::new(model, [geoms[1], geoms[0]])];
        let mut mixed = Self::default();
        for (geom, weights) in geoms.into_iter().zip(weights) {
            let (reference, impedance) = (model.geom_solref()[geom], model.geom_solimp()[geom]);
            let friction = unpack(&model.geom_friction()[geom]);
            (0..2).for_each(|at| mixed.reference[at] += weights.reference[at] * reference[at]);
            (0..5).for_each(|at| mixed.impedance[at] += weights.impedance * impedance[at]);
            (0..5).for_each(|at| mixed.friction[at] += weights.friction[at] * friction[at]);
        }
        mixed.friction = mixed.friction.map(|friction| friction.max(mjMINMU));
        mixed
    }
}

/// Derivatives of the parameters of a contact by those of one of its geoms, which are also the
/// factors of its parameters in the mixture.
struct Weights {
    reference: [f64; 2],
    impedance: f64,
    friction: [f64; 5],
}

impl Weights {
    fn new(model: &Model, [geom, other]: [usize; 2]) -> Self {
        let [own, others] = [geom, other].map(|geom| model.geom_priority()[geom]);
        if own != others {
            let weight = if own > others { 1.0 } else { 0.0 };
            return Self { reference: [weight; 2], impedance: weight, friction: [weight; 5] };
        }
        let impedance = mix(model, [geom, other]);
        let [own, others] = [geom, other].map(|geom| &model.geom_solref()[geom]);
        let reference = if own[0] > 0.0 && others[0] > 0.0 {
            [impedance; 2]
        } else {
            [0, 1].map(|at| share(-own[at], -others[at]))
        };
        let [own, others] = [geom, other].map(|geom| unpack(&model.geom_friction()[geom]));
        Self { reference, impedance, friction: std::array::from_fn(|at| share(own[at], others[at])) }
    }
}

/// Returns the derivative of the larger of two numbers by the first: the mean of both sides if they
/// are equal.
fn share(own: f64, other: f64) -> f64 {
    if own == other {
        0.5
    } else if own > other {
        1.0
    } else {
        0.0
    }
}

/// Returns the weight of a geom in the mean of two.
fn mix(model: &Model, geoms: [usize; 2]) -> f64 {
    match geoms.map(|geom| model.geom_solmix()[geom]) {
        [own, other] if own >= mjMINVAL && other >= mjMINVAL => own / (own + other),
        [own, other] if own < mjMINVAL && other < mjMINVAL => 0.5,
        [own, _] if own < mjMINVAL => 0.0,
        _ => 1.0,
    }
}

/// Returns friction along five base rows: sliding, spinning and rolling.
fn unpack(&[slide, spin, roll]: &[f64; 3]) -> [f64; 5] {
    [slide, slide, spin, roll, roll]
}

/// Returns `true` if the options override `solref` and `solimp` of contacts.
fn overrides(model: &Model) -> bool {
    model.raw().opt.enableflags as u32 & EnableFlags::OVERRIDE.bits() != 0
}

fn overrides_friction(model: &Model) -> bool {
    cfg!(engine_since = "3.0.0") && overrides(model)
}

/// Returns the derivatives of the parameters of the constraint that starts at a row by a number, or
/// `None` if it does not depend on the number.
pub(super) fn change(data: &Data, row: usize, number: SolverNumber) -> Option<Change> {
    let model = data.model();
    let SolverNumber { element, quantity } = number;
    let origin = Origin::of(data, row)?;
    let is_contact = matches!(origin, Origin::Mixed(_) | Origin::Element(Element::Pair(_)));
    let is_overridden = match quantity {
        Quantity::Friction(_) => overrides_friction(model),
        _ => overrides(model),
    };
    if is_contact && is_overridden {
        return None;
    }
    let geoms = match origin {
        Origin::Element(own) if own == element => None,
        Origin::Mixed([first, second]) if element == Element::Geom(first) => Some([first, second]),
        Origin::Mixed([first, second]) if element == Element::Geom(second) => Some([second, first]),
        _ => return None,
    };
    let one = Weights { reference: [1.0; 2], impedance: 1.0, friction: [1.0; 5] };
    let weights = geoms.map_or(one, |geoms| Weights::new(model, geoms));
    let friction = SolverParameters::of(data, row).friction;
    let mut change = SolverParameters::default();
    let mut is_kink = false;
    match (quantity, geoms) {
        (Quantity::Reference(at), _) => {
            change.reference[at] = weights.reference[at];
            is_kink = geoms.is_some_and(|geoms| is_tie(model, geoms, at));
        }
        (Quantity::Impedance(at), _) => change.impedance[at] = weights.impedance,
        (Quantity::Friction(at), _) => {
            let range = match (geoms, at) {
                (None, at) => at..at + 1,
                (Some(_), 0) => 0..2,
                (Some(_), 1) => 2..3,
                (Some(_), _) => 3..5,
            };
            // Less friction than the engine's minimum has no effect.
            for at in range.filter(|&at| friction[at] > mjMINMU) {
                change.friction[at] = weights.friction[at];
                is_kink |= weights.friction[at] == 0.5;
            }
        }
        (Quantity::Mix, Some(geoms)) => change_weight(model, geoms, &mut change),
        (Quantity::Mix, None) => return None,
    }
    Some(Change { change, is_kink })
}

/// Returns `true` if the numbers of `solref` in direct format of two geoms are equal.
fn is_tie(model: &Model, geoms: [usize; 2], at: usize) -> bool {
    let [own, other] = geoms.map(|geom| model.geom_solref()[geom]);
    let [priority, others] = geoms.map(|geom| model.geom_priority()[geom]);
    priority == others && !(own[0] > 0.0 && other[0] > 0.0) && own[at] == other[at]
}

/// Writes the derivatives by the weight of the first geom.
fn change_weight(model: &Model, geoms: [usize; 2], change: &mut SolverParameters) {
    let [priority, others] = geoms.map(|geom| model.geom_priority()[geom]);
    let [weight, other] = geoms.map(|geom| model.geom_solmix()[geom]);
    if priority != others || other < mjMINVAL {
        return;
    }
    let slope = other / (weight + other).powi(2);
    let [own, others] = geoms.map(|geom| model.geom_solimp()[geom]);
    change.impedance = std::array::from_fn(|at| slope * (own[at] - others[at]));
    let [own, others] = geoms.map(|geom| model.geom_solref()[geom]);
    if own[0] > 0.0 && others[0] > 0.0 {
        change.reference = std::array::from_fn(|at| slope * (own[at] - others[at]));
    }
}
