//! Effects of parameters on the equations of motion.
//!
//! A parameter with a formula resolves to one effect. A number that no arm of [`number`] names, or
//! that the model uses in a way without a formula, is [`Effect::Other`]: it is differenced.

use std::ops::Range;

use super::inertial::{self, InertialParameters};
use super::solver::SolverNumber;
use super::{ModelParameter, coordinates};
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, JointType, TransmissionType};
use crate::error::Result;
use crate::ffi;
use crate::id::{BodyId, JointId};
use crate::model::Model;
use crate::numerics::spatial::Vec3;
use crate::rollout::Parameter;

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
    /// Dry friction of degrees of freedom, all of which have some.
    FrictionLoss(Range<usize>),
    Stiffness(usize),
    /// Rest position of a scalar degree of freedom, with the stiffness of its spring.
    SpringReference {
        dof: usize,
        stiffness: f64,
    },
    TendonStiffness(usize),
    TendonDamping(usize),
    /// Dry friction of a tendon that has some.
    TendonFrictionLoss(usize),
    /// Rest length of a tendon: its only one, or the lower or the upper end of its range.
    TendonRestLength {
        tendon: usize,
        is_lower: bool,
        is_upper: bool,
    },
    /// Coefficient of a constant, of the length and of the velocity in an affine gain or bias.
    Gain {
        actuator: usize,
        factor: Factor,
    },
    Bias {
        actuator: usize,
        factor: Factor,
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
        let effect = match parameter {
            ModelParameter::Number(parameter) => number(model, parameter),
            _ => inertial_effect(model, parameter),
        };
        // The forces of a medium depend on boxes with the same inertia.
        let options = &model.raw().opt;
        let has_medium = options.density != 0.0 || options.viscosity != 0.0;
        let is_inertial = matches!(effect, Effect::Inertial { .. });
        let is_differenced = effect == Effect::Other || (is_inertial && has_medium);
        let array = match parameter {
            ModelParameter::Number(parameter) => parameter.place(model).map_or("", |(array, ..)| array),
            _ => "",
        };
        let is_relative = ["solref", "solimp", "friction", "dynprm"].iter().any(|part| array.contains(part));
        let is_bounded = is_bounded(parameter, array);
        let acts_by_constraints = acts_by_constraints(parameter, array);
        Ok(Self { parameter, effect, is_differenced, value, is_bounded, acts_by_constraints, is_relative })
    }
}

/// Returns `true` for a parameter that the engine uses only if it is positive.
fn is_bounded(parameter: ModelParameter, array: &str) -> bool {
    const ARRAYS: [&str; 14] = [
        "body_mass",
        "dof_armature",
        "dof_damping",
        "dof_frictionloss",
        "geom_friction",
        "geom_margin",
        "geom_size",
        "geom_solmix",
        "jnt_stiffness",
        "pair_friction",
        "site_size",
        "tendon_damping",
        "tendon_frictionloss",
        "tendon_stiffness",
    ];
    match parameter {
        ModelParameter::Mass(_)
        | ModelParameter::Number(
            Parameter::JointDamping(_) | Parameter::JointFrictionLoss(_) | Parameter::JointArmature(_),
        ) => true,
        _ => ARRAYS.contains(&array),
    }
}

/// Returns `true` for a number on which neither the inertia matrix nor the integrator depends.
fn acts_by_constraints(parameter: ModelParameter, array: &str) -> bool {
    const ARRAYS: [&str; 22] = [
        "dof_frictionloss",
        "dof_solimp",
        "dof_solref",
        "eq_solimp",
        "eq_solref",
        "geom_friction",
        "geom_gap",
        "geom_margin",
        "geom_solimp",
        "geom_solmix",
        "geom_solref",
        "jnt_margin",
        "jnt_range",
        "jnt_solimp",
        "jnt_solref",
        "pair_friction",
        "pair_solimp",
        "pair_solref",
        "tendon_frictionloss",
        "tendon_range",
        "tendon_solref_lim",
        "tendon_solimp_lim",
    ];
    matches!(parameter, ModelParameter::Number(Parameter::JointFrictionLoss(_))) || ARRAYS.contains(&array)
}

/// Returns the effect of a parameter of the inertia of a body.
fn inertial_effect(model: &Model, parameter: ModelParameter) -> Effect {
    let (body, change) = match parameter {
        ModelParameter::Mass(body) => (body, of_mass(model, body.index())),
        ModelParameter::Inertia(body, at) => {
            let mut change = [0.0; 10];
            change[4 + at] = 1.0;
            (body, change)
        }
        ModelParameter::Inertial(body, at) => {
            let mut change = [0.0; 10];
            change[at] = 1.0;
            (body, change)
        }
        ModelParameter::LogCholesky(body, at) => {
            (body, InertialParameters::log_cholesky_derivative(&coordinates(model, body))[at])
        }
        ModelParameter::Number(_) => return Effect::Other,
    };
    of_change(model, body, change)
}

fn of_change(model: &Model, body: BodyId, change: [f64; 10]) -> Effect {
    let centre = inertial::centre_change(&InertialParameters::of(model, body), &change);
    Effect::Inertial { body: body.index(), change, centre }
}

/// Returns the change of the inertial parameters by the mass, at constant inertia about the centre.
fn of_mass(model: &Model, body: usize) -> [f64; 10] {
    let centre @ [x, y, z] = model.body_ipos()[body];
    let [xx, yy, zz, xy, xz, yz] = inertial::shift(1.0, &centre);
    [1.0, x, y, z, xx, yy, zz, xy, xz, yz]
}

/// Returns the effect of a parameter of batches.
fn number(model: &Model, parameter: Parameter) -> Effect {
    let dofs = |joint: JointId| model.joint(joint).dofs();
    match parameter {
        Parameter::Gravity(axis) => return Effect::Gravity(axis),
        Parameter::MassFactor(body) => return of_change(model, body, InertialParameters::of(model, body).0),
        Parameter::JointArmature(joint) => return Effect::Armature(dofs(joint)),
        Parameter::JointDamping(joint) => return damping(model, dofs(joint)),
        Parameter::JointFrictionLoss(joint) => return friction_loss(model, dofs(joint)),
        _ => {}
    }
    let Some((array, row, column)) = parameter.place(model) else { return Effect::Other };
    let body = || BodyId::new(row, model.lineage());
    match array {
        "body_mass" => inertial_effect(model, ModelParameter::Mass(body())),
        "body_ipos" => {
            let (mass, centre) = (model.body_mass()[row], model.body_ipos()[row]);
            let mut unit = [0.0; 3];
            unit[column] = 1.0;
            let [xx, yy, zz, xy, xz, yz] = inertial::shift_change(mass, &centre, &unit);
            let [x, y, z] = unit.map(|value| mass * value);
            Effect::Inertial { body: row, change: [0.0, x, y, z, xx, yy, zz, xy, xz, yz], centre: unit }
        }
        "body_inertia" => {
            let axis = inertial::column(&inertial::inertial_axes(model, row), column);
            let [xx, yy, zz, xy, xz, yz] = inertial::outer(&axis);
            let change = [0.0, 0.0, 0.0, 0.0, xx, yy, zz, xy, xz, yz];
            Effect::Inertial { body: row, change, centre: [0.0; 3] }
        }
        "dof_armature" => Effect::Armature(row..row + 1),
        "dof_damping" => damping(model, row..row + 1),
        "dof_frictionloss" => friction_loss(model, row..row + 1),
        "jnt_stiffness" => Effect::Stiffness(row),
        "qpos_spring" => spring_reference(model, row),
        "tendon_stiffness" => Effect::TendonStiffness(row),
        "tendon_damping" if model.tendon_damping()[row] >= 0.0 => Effect::TendonDamping(row),
        "tendon_frictionloss" if model.tendon_frictionloss()[row] > 0.0 => Effect::TendonFrictionLoss(row),
        "tendon_lengthspring" => rest_length(model, row, column),
        "actuator_gainprm" => gain(model, row, column),
        "actuator_biasprm" => bias(model, row, column),
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

/// A degree of freedom without friction has no constraint that could change.
fn friction_loss(model: &Model, dofs: Range<usize>) -> Effect {
    let has_friction = model.dof_frictionloss()[dofs.clone()].iter().all(|&loss| loss > 0.0);
    if has_friction { Effect::FrictionLoss(dofs) } else { Effect::Other }
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

fn factor(column: usize) -> Factor {
    [Factor::One, Factor::Length, Factor::Velocity].get(column).copied().unwrap_or(Factor::Zero)
}

fn gain(model: &Model, actuator: usize, column: usize) -> Effect {
    match ActuatorGain::from_raw(model.actuator_gaintype()[actuator]) {
        Some(ActuatorGain::Fixed) => {
            Effect::Gain { actuator, factor: if column == 0 { Factor::One } else { Factor::Zero } }
        }
        Some(ActuatorGain::Affine) => Effect::Gain { actuator, factor: factor(column) },
        _ => Effect::Other,
    }
}

fn bias(model: &Model, actuator: usize, column: usize) -> Effect {
    match ActuatorBias::from_raw(model.actuator_biastype()[actuator]) {
        Some(ActuatorBias::None) => Effect::Bias { actuator, factor: Factor::Zero },
        Some(ActuatorBias::Affine) => Effect::Bias { actuator, factor: factor(column) },
        _ => Effect::Other,
    }
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
