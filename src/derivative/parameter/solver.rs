//! Solver parameters of constraints: numbers that act only by reference accelerations,
//! regularisation and friction.

use mujoco_sys::mjMINVAL;

use crate::model::Model;

/// Number from which solver parameters of constraints follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::derivative) struct SolverNumber {
    pub(in crate::derivative) element: Element,
    pub(in crate::derivative) quantity: Quantity,
}

/// Element of the model that gives constraints their parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::derivative) enum Element {
    Geom(usize),
    /// Explicit pair of geoms.
    Pair(usize),
    /// Limit of a joint.
    Joint(usize),
    /// Dry friction of a degree of freedom.
    Dof(usize),
    TendonLimit(usize),
    TendonFriction(usize),
    Equality(usize),
}

/// Quantity with the index of its component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::derivative) enum Quantity {
    Friction(usize),
    Reference(usize),
    Impedance(usize),
    /// Weight of a geom in the mean of two.
    Mix,
}

/// Element with the beginning and the end of the names of its arrays.
type ArraysOf = (&'static str, &'static str, fn(usize) -> Element);

const ELEMENTS: [ArraysOf; 7] = [
    ("geom_", "", Element::Geom),
    ("pair_", "", Element::Pair),
    ("jnt_", "", Element::Joint),
    ("dof_", "", Element::Dof),
    ("tendon_", "_lim", Element::TendonLimit),
    ("tendon_", "_fri", Element::TendonFriction),
    ("eq_", "", Element::Equality),
];

impl SolverNumber {
    /// Returns the number at a place in an array of the model, if it is one of these. A weight that
    /// the engine takes for zero is none: the mean of two geoms jumps there.
    pub(super) fn of(model: &Model, array: &str, row: usize, column: usize) -> Option<Self> {
        ELEMENTS.iter().find_map(|(start, end, element)| {
            let quantity = match array.strip_prefix(start)?.strip_suffix(end)? {
                "friction" => Quantity::Friction(column),
                "solref" => Quantity::Reference(column),
                "solimp" => Quantity::Impedance(column),
                "solmix" if model.geom_solmix()[row] >= mjMINVAL => Quantity::Mix,
                _ => return None,
            };
            Some(Self { element: element(row), quantity })
        })
    }
}
