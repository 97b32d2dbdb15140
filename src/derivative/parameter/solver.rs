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

impl SolverNumber {
    /// Returns the number at a place in an array of the model, if it is one of these. A weight that
    /// the engine takes for zero is none: the mean of two geoms jumps there.
    pub(super) fn of(model: &Model, array: &str, row: usize, column: usize) -> Option<Self> {
        let (element, quantity) = match array {
            "geom_friction" => (Element::Geom(row), Quantity::Friction(column)),
            "geom_solref" => (Element::Geom(row), Quantity::Reference(column)),
            "geom_solimp" => (Element::Geom(row), Quantity::Impedance(column)),
            "geom_solmix" if model.geom_solmix()[row] >= mjMINVAL => (Element::Geom(row), Quantity::Mix),
            "pair_friction" => (Element::Pair(row), Quantity::Friction(column)),
            "pair_solref" => (Element::Pair(row), Quantity::Reference(column)),
            "pair_solimp" => (Element::Pair(row), Quantity::Impedance(column)),
            "jnt_solref" => (Element::Joint(row), Quantity::Reference(column)),
            "jnt_solimp" => (Element::Joint(row), Quantity::Impedance(column)),
            "dof_solref" => (Element::Dof(row), Quantity::Reference(column)),
            "dof_solimp" => (Element::Dof(row), Quantity::Impedance(column)),
            "tendon_solref_lim" => (Element::TendonLimit(row), Quantity::Reference(column)),
            "tendon_solimp_lim" => (Element::TendonLimit(row), Quantity::Impedance(column)),
            "tendon_solref_fri" => (Element::TendonFriction(row), Quantity::Reference(column)),
            "tendon_solimp_fri" => (Element::TendonFriction(row), Quantity::Impedance(column)),
            "eq_solref" => (Element::Equality(row), Quantity::Reference(column)),
            "eq_solimp" => (Element::Equality(row), Quantity::Impedance(column)),
            _ => return None,
        };
        Some(Self { element, quantity })
    }
}
