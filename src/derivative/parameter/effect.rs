//! Effects of parameters on the equations of motion.
//!
//! A parameter with a formula resolves to one effect. A number that no arm of [`number`] names, or
//! that the model uses in a way without a formula, is [`Effect::Other`]: it is differenced.

use std::ops::Range;

use mujoco_sys::{mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON};
use nalgebra::Vector4;

use super::inertial::{self, InertialParameters, unit};
use super::solver::SolverNumber;
use super::{ModelParameter, coordinates};
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, JointType, TransmissionType};
use crate::error::Result;
use crate::ffi;
use crate::id::BodyId;
use crate::model::Model;
use crate::numerics::spatial::Vec3;
use crate::rollout::Parameter;

/// Parts of the names of arrays whose numbers the engine uses only if they are positive.
const BOUNDED: [&str; 8] =
    ["body_mass", "armature", "damping", "friction", "geom_margin", "size", "solmix", "stiffness"];
/// Parts of the names of arrays on which neither the inertia matrix nor the integrator depends.
const OF_CONSTRAINTS: [&str; 8] =
    ["solref", "solimp", "solmix", "friction", "margin", "gap", "jnt_range", "tendon_range"];
/// Parts of the names of arrays of numbers of different magnitudes.
const RELATIVE: [&str; 4] = ["solref", "solimp", "friction", "dynprm"];

/// Way in which a parameter acts.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::derivative) enum Effect {
    /// Change of the ten inertial parameters of a body, and of its centre of mass, in its frame.
    Inertial {
        body: usize,
        change: [f64; 10],
        centre: Vec3,
    },
    /// Component of gravity.
    Gravity(usize),
    Armature(Range<usize>),
    Damping(Range<usize>),
    /// Dry friction of degrees of freedom or of tendons, all of which have some, with the type of
    /// their constraints.
    FrictionLoss {
        kind: u32,
        ids: Range<usize>,
    },
    Stiffness(usize),
    /// Rest position of a scalar degree of freedom, with the stiffness of its spring.
    SpringReference {
        dof: usize,
        stiffness: f64,
    },
    TendonStiffness(usize),
    TendonDamping(usize),
    /// Rest length of a tendon: its only one, or the lower or the upper end of its range.
    TendonRestLength {
        tendon: usize,
        is_lower: bool,
        is_upper: bool,
    },
    /// Coefficient of a constant, of the length and of the velocity in an affine gain or bias.
    Coefficient {
        actuator: usize,
        factor: Factor,
        is_gain: bool,
    },
    /// Time constant of a filter.
    TimeConstant {
        actuator: usize,
        activation: usize,
    },
    /// Gear of an actuator of a scalar joint or a tendon, which is not zero.
    Gear(usize),
    /// Solver parameter of constraints.
    Solver(SolverNumber),
    /// No formula.
    Other,
}

/// Quantity that a coefficient multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::derivative) enum Factor {
    One,
    Length,
    Velocity,
    /// The coefficient has no effect.
    Zero,
}

/// A parameter with its effect.
#[derive(Clone, Debug)]
pub(in crate::derivative) struct Resolved {
    pub(in crate::derivative) parameter: ModelParameter,
    pub(in crate::derivative) effect: Effect,
    /// `true` if the derivative of the residual is differenced. The other derivatives of the effect
    /// have formulas unless it is [`Effect::Other`].
    pub(in crate::derivative) is_differenced: bool,
    pub(in crate::derivative) value: f64,
    /// `true` if values below zero are not valid, or have no meaning.
    pub(in crate::derivative) is_bounded: bool,
    /// `true` for a number that only the constraints depend on.
    pub(in crate::derivative) acts_by_constraints: bool,
    /// `true` if the step of a difference is relative to any value that is not zero.
    pub(in crate::derivative) is_relative: bool,
}

impl Resolved {
    /// Checks a parameter and resolves it.
    pub(in crate::derivative) fn new(model: &Model, parameter: ModelParameter) -> Result<Self> {
        let value = parameter.value(model)?;
        let place = match parameter {
            ModelParameter::Number(parameter) => parameter.place(model),
            _ => None,
        };
        let array = place.as_ref().map_or("", |(array, ..)| array);
        let effect = match place {
            Some((array, rows, column)) => number(model, array, rows, column),
            None => effect(model, parameter),
        };
        // The forces of a medium depend on boxes with the same inertia.
        let options = &model.raw().opt;
        let has_medium = options.density != 0.0 || options.viscosity != 0.0;
        let is_inertial = matches!(effect, Effect::Inertial { .. });
        let is_differenced = effect == Effect::Other || (is_inertial && has_medium);
        let is_of = |parts: &[&str]| parts.iter().any(|part| array.contains(part));
        let is_relative = is_of(&RELATIVE);
        let is_bounded = matches!(parameter, ModelParameter::Mass(_)) || is_of(&BOUNDED);
        let acts_by_constraints = is_of(&OF_CONSTRAINTS);
        Ok(Self { parameter, effect, is_differenced, value, is_bounded, acts_by_constraints, is_relative })
    }
}

/// Returns the effect of a parameter that is no number in an array.
fn effect(model: &Model, parameter: ModelParameter) -> Effect {
    let (body, change) = match parameter {
        ModelParameter::Number(Parameter::Gravity(axis)) => return Effect::Gravity(axis),
        ModelParameter::Number(Parameter::MassFactor(body)) => (body, InertialParameters::of(model, body).0),
        ModelParameter::Number(_) => return Effect::Other,
        // At constant inertia about the centre.
        ModelParameter::Mass(body) => (body, InertialParameters::point(1.0, &model.body_ipos()[body.index()]).0),
        ModelParameter::Inertia(body, at) => (body, unit(4 + at)),
        ModelParameter::Inertial(body, at) => (body, unit(at)),
        ModelParameter::LogCholesky(body, at) => {
            (body, InertialParameters::log_cholesky_derivative(&coordinates(model, body))[at])
        }
    };
    of_change(model, body, change)
}

fn of_change(model: &Model, body: BodyId, change: [f64; 10]) -> Effect {
    let centre = inertial::centre_change(&InertialParameters::of(model, body), &change);
    Effect::Inertial { body: body.index(), change, centre }
}

/// Returns the effect of numbers in an array: one, or one for each degree of freedom of a joint.
fn number(model: &Model, array: &str, rows: Range<usize>, column: usize) -> Effect {
    let row = rows.start;
    match array {
        "body_mass" => effect(model, ModelParameter::Mass(BodyId::new(row, model.lineage()))),
        "body_ipos" => {
            let (mass, [x, y, z]) = (model.body_mass()[row], model.body_ipos()[row]);
            let shift = mass * Vector4::ith(column, 1.0) * Vector4::new(x, y, z, 1.0).transpose();
            let change = InertialParameters::of_product(&shift).0;
            Effect::Inertial { body: row, change, centre: unit(column) }
        }
        "body_inertia" => {
            let moment = inertial::principal_moment(model, row, column);
            let change = InertialParameters([0.0; 10]).with_inertia(&moment).0;
            Effect::Inertial { body: row, change, centre: [0.0; 3] }
        }
        "dof_armature" => Effect::Armature(rows),
        "dof_damping" => damping(model, rows),
        "dof_frictionloss" => friction_loss(mjCNSTR_FRICTION_DOF, model.dof_frictionloss(), rows),
        "jnt_stiffness" => Effect::Stiffness(row),
        "qpos_spring" => spring_reference(model, row),
        "tendon_stiffness" => Effect::TendonStiffness(row),
        "tendon_damping" if model.tendon_damping()[row] >= 0.0 => Effect::TendonDamping(row),
        "tendon_frictionloss" => friction_loss(mjCNSTR_FRICTION_TENDON, model.tendon_frictionloss(), rows),
        "tendon_lengthspring" => rest_length(model, row, column),
        "actuator_gainprm" => coefficient(model, row, column, true),
        "actuator_biasprm" => coefficient(model, row, column, false),
        "actuator_dynprm" if column == 0 => time_constant(model, row),
        "actuator_gear" if column == 0 => gear(model, row),
        _ => SolverNumber::of(model, array, row, column).map_or(Effect::Other, Effect::Solver),
    }
}

/// Negative damping is not part of the implicit damping of all engines.
fn damping(model: &Model, dofs: Range<usize>) -> Effect {
    let is_valid = model.dof_damping().iter().all(|&damping| damping >= 0.0);
    if is_valid { Effect::Damping(dofs) } else { Effect::Other }
}

/// Without friction there is no constraint that could change.
fn friction_loss(kind: u32, losses: &[f64], ids: Range<usize>) -> Effect {
    let has_friction = losses[ids.clone()].iter().all(|&loss| loss > 0.0);
    if has_friction { Effect::FrictionLoss { kind, ids } } else { Effect::Other }
}

fn spring_reference(model: &Model, at: usize) -> Effect {
    let joints = model.jnt_type().iter().zip(model.jnt_qposadr()).zip(model.jnt_dofadr());
    for (joint, ((&kind, &first), &dof)) in joints.enumerate() {
        let (offset, dof) = (at.wrapping_sub(ffi::size(first)), ffi::size(dof));
        let scalars = match JointType::of_field(kind) {
            JointType::Free => 3,
            JointType::Slide | JointType::Hinge => 1,
            JointType::Ball => 0,
        };
        if offset < scalars {
            return Effect::SpringReference { dof: dof + offset, stiffness: model.jnt_stiffness()[joint] };
        }
    }
    Effect::Other
}

fn rest_length(model: &Model, tendon: usize, column: usize) -> Effect {
    let is_only = model.number_array("tendon_lengthspring").is_some_and(|array| array.columns == 1);
    Effect::TendonRestLength { tendon, is_lower: is_only || column == 0, is_upper: is_only || column == 1 }
}

fn coefficient(model: &Model, actuator: usize, column: usize, is_gain: bool) -> Effect {
    let kinds = if is_gain { model.actuator_gaintype() } else { model.actuator_biastype() };
    // Quantities with a coefficient.
    let used = match (is_gain, kinds[actuator]) {
        (true, kind) if kind == ActuatorGain::Fixed.raw() => 1,
        (true, kind) if kind == ActuatorGain::Affine.raw() => 3,
        (false, kind) if kind == ActuatorBias::None.raw() => 0,
        (false, kind) if kind == ActuatorBias::Affine.raw() => 3,
        _ => return Effect::Other,
    };
    let quantities = [Factor::One, Factor::Length, Factor::Velocity];
    let factor = quantities[..used].get(column).copied().unwrap_or(Factor::Zero);
    Effect::Coefficient { actuator, factor, is_gain }
}

fn time_constant(model: &Model, actuator: usize) -> Effect {
    let is_filter = ActuatorDynamics::from_raw(model.actuator_dyntype()[actuator]) == Some(ActuatorDynamics::Filter);
    let is_regular = model.actuator_dynprm()[actuator][0] > mujoco_sys::mjMINVAL;
    match model.activation_of(actuator) {
        Some(activation) if is_filter && is_regular => Effect::TimeConstant { actuator, activation },
        _ => Effect::Other,
    }
}

fn gear(model: &Model, output: usize) -> Effect {
    // With several outputs for an actuator the model has no closed form.
    if model.actuator_gear()[output][0] == 0.0 || output >= model.nactuator() {
        return Effect::Other;
    }
    let is_scalar = match TransmissionType::from_raw(model.actuator_trntype()[output]) {
        Some(TransmissionType::Tendon) => true,
        Some(TransmissionType::Joint | TransmissionType::JointInParent) => {
            let joint = ffi::size(model.actuator_trnid()[output][0]);
            matches!(JointType::of_field(model.jnt_type()[joint]), JointType::Hinge | JointType::Slide)
        }
        _ => false,
    };
    if is_scalar { Effect::Gear(output) } else { Effect::Other }
}
