//! Edits of models that correspond to parameters of batches.

use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Model, ModelMut};

/// Writes a value as the documentation of the parameter says. Returns `true` if other quantities
/// are derived from the value.
pub(crate) fn edit(parameter: Parameter, value: f64, original: &Model, model: &mut ModelMut<'_>) -> bool {
    match parameter {
        Parameter::Gravity(axis) => model.edit_options(|options| options.gravity[axis] = value).unwrap(),
        Parameter::MassFactor(body) => {
            model.body_mut(body).set_mass(value * original.body(body).mass());
            *model.body_mut(body).inertia_mut() = original.body(body).inertia().map(|moment| value * moment);
        }
        Parameter::CentreOfMass(body, axis) => model.body_mut(body).ipos_mut()[axis] = value,
        Parameter::JointStiffness(joint) => model.jnt_stiffness_mut()[joint.index()] = value,
        Parameter::JointDamping(joint) => {
            model.joint(joint).dofs().for_each(|dof| model.dof_damping_mut()[dof] = value);
        }
        Parameter::JointFrictionLoss(joint) => {
            model.joint(joint).dofs().for_each(|dof| model.dof_frictionloss_mut()[dof] = value);
        }
        Parameter::JointArmature(joint) => {
            model.joint(joint).dofs().for_each(|dof| model.dof_armature_mut()[dof] = value);
        }
        Parameter::GeomFriction(geom, component) => model.geom_mut(geom).friction_mut()[component] = value,
        Parameter::GeomSize(geom, component) => model.geom_mut(geom).size_mut()[component] = value,
        Parameter::ActuatorGain(actuator, component) => model.actuator_mut(actuator).gainprm_mut()[component] = value,
        Parameter::ActuatorBias(actuator, component) => model.actuator_mut(actuator).biasprm_mut()[component] = value,
        Parameter::ActuatorGear(actuator) => model.actuator_mut(actuator).gear_mut()[0] = value,
        other => unreachable!("{other:?}"),
    }
    matches!(
        parameter,
        Parameter::MassFactor(_)
            | Parameter::CentreOfMass(..)
            | Parameter::JointArmature(_)
            | Parameter::GeomSize(..)
            | Parameter::ActuatorGear(_)
    )
}
