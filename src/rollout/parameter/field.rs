//! Quantities of the model that can differ between the simulations of a batch.

use crate::enums::GeomType;
use crate::error::{Error, Result};
use crate::id::{ActuatorId, BodyId, GeomId, JointId};
use crate::kind::Kind;
use crate::model::{Model, ModelMut};

/// Quantity of the model with a value for each simulation of a batch. Each is one number.
///
/// Each value is the value of the model's field, with the exception of
/// [`MassFactor`](Self::MassFactor). Components count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Parameter {
    /// Component of the acceleration of gravity (`opt.gravity`), m/s², in the world frame. Finite.
    #[doc(alias = "gravity")]
    Gravity(usize),
    /// Factor of the mass and the moments of inertia of a body relative to the model of the batch,
    /// as in [`scale_mass`](crate::element::BodyMut::scale_mass). From 1e-6 to 1e6. Updates the
    /// derived constants.
    #[doc(alias = "body_mass")]
    MassFactor(BodyId),
    /// Component of the position of a body's centre of mass in its frame (`body_ipos`), m. Finite.
    /// Updates the derived constants. Engines since 2.3 return an error for a body that moves
    /// independently (`body_simple`).
    #[doc(alias = "body_ipos")]
    CentreOfMass(BodyId, usize),
    /// Stiffness of a joint's spring (`jnt_stiffness`), N/m or N·m/rad. Not negative.
    #[doc(alias = "jnt_stiffness")]
    JointStiffness(JointId),
    /// Damping of all degrees of freedom of a joint (`dof_damping`), N·s/m or N·m·s/rad. Not
    /// negative.
    #[doc(alias = "dof_damping")]
    JointDamping(JointId),
    /// Dry friction of all degrees of freedom of a joint (`dof_frictionloss`), N or N·m. Not
    /// negative.
    #[doc(alias = "dof_frictionloss")]
    JointFrictionLoss(JointId),
    /// Inertia of the rotor, added to all degrees of freedom of a joint (`dof_armature`), kg or
    /// kg·m². Not negative. Updates the derived constants.
    #[doc(alias = "dof_armature")]
    JointArmature(JointId),
    /// Friction coefficient of a geom (`geom_friction`): sliding, torsional (m), rolling (m). Not
    /// negative.
    #[doc(alias = "geom_friction")]
    GeomFriction(GeomId, usize),
    /// Size of a sphere, capsule, cylinder, ellipsoid or box (`geom_size`), m. Positive. Updates
    /// the bounds for collision detection with the derived constants. The mass of the body does not
    /// change.
    #[doc(alias = "geom_size")]
    GeomSize(GeomId, usize),
    /// Gain parameter of an actuator (`actuator_gainprm`): for motors, position and velocity
    /// actuators the gain is component 0. Finite.
    #[doc(alias = "actuator_gainprm")]
    ActuatorGain(ActuatorId, usize),
    /// Bias parameter of an actuator (`actuator_biasprm`): constant, factor of the length and
    /// factor of the velocity for affine actuators. Finite.
    #[doc(alias = "actuator_biasprm")]
    ActuatorBias(ActuatorId, usize),
    /// First component of an actuator's gear (`actuator_gear`). Finite. Updates the derived
    /// constants.
    #[doc(alias = "actuator_gear")]
    ActuatorGear(ActuatorId),
}

/// Set of valid values.
#[derive(Clone, Copy)]
pub(super) enum Valid {
    Finite,
    NotNegative,
    Positive,
    Factor,
}

impl Valid {
    pub(super) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Factor => (1e-6..=1e6).contains(&value),
            }
    }

    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
            Self::Factor => "from 1e-6 to 1e6",
        }
    }
}

impl Parameter {
    pub(super) fn valid(self) -> Valid {
        match self {
            Self::Gravity(_)
            | Self::CentreOfMass(..)
            | Self::ActuatorGain(..)
            | Self::ActuatorBias(..)
            | Self::ActuatorGear(_) => Valid::Finite,
            Self::JointStiffness(_)
            | Self::JointDamping(_)
            | Self::JointFrictionLoss(_)
            | Self::JointArmature(_)
            | Self::GeomFriction(..) => Valid::NotNegative,
            Self::GeomSize(..) => Valid::Positive,
            Self::MassFactor(_) => Valid::Factor,
        }
    }

    /// Returns `true` if other quantities of the model are derived from this one.
    pub(super) fn has_derived_constants(self) -> bool {
        match self {
            Self::MassFactor(_)
            | Self::CentreOfMass(..)
            | Self::JointArmature(_)
            | Self::GeomSize(..)
            | Self::ActuatorGear(_) => true,
            Self::Gravity(_)
            | Self::JointStiffness(_)
            | Self::JointDamping(_)
            | Self::JointFrictionLoss(_)
            | Self::GeomFriction(..)
            | Self::ActuatorGain(..)
            | Self::ActuatorBias(..) => false,
        }
    }

    /// Returns the name, for example `geom_friction[0] of geom 'floor'`, or an error if the model
    /// does not have the quantity.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub(super) fn name(self, model: &Model) -> Result<String> {
        let element = self.element(model).map_or(String::new(), |(kind, index)| match model.name_at(kind, index) {
            Some(name) => format!(" of {kind} '{name}'"),
            None => format!(" of {kind} {index}"),
        });
        let (field, component) = self.field();
        let Some(component) = component else { return Ok(format!("{field}{element}")) };
        match self.components(model) {
            0 => Err(Error::Unsupported(format!(
                "{field}{element} cannot vary: the geom must be a sphere, capsule, cylinder, ellipsoid or box"
            ))),
            number if component >= number => Err(Error::out_of_range(
                format!("the component of {field}{element}"),
                component,
                format!("less than {number}"),
            )),
            _ => Ok(format!("{field}[{component}]{element}")),
        }
    }

    /// Returns the name of the field, and the component if there are several.
    fn field(self) -> (&'static str, Option<usize>) {
        match self {
            Self::Gravity(axis) => ("gravity", Some(axis)),
            Self::MassFactor(_) => ("factor of the mass", None),
            Self::CentreOfMass(_, axis) => ("body_ipos", Some(axis)),
            Self::JointStiffness(_) => ("jnt_stiffness", None),
            Self::JointDamping(_) => ("dof_damping", None),
            Self::JointFrictionLoss(_) => ("dof_frictionloss", None),
            Self::JointArmature(_) => ("dof_armature", None),
            Self::GeomFriction(_, component) => ("geom_friction", Some(component)),
            Self::GeomSize(_, component) => ("geom_size", Some(component)),
            Self::ActuatorGain(_, component) => ("actuator_gainprm", Some(component)),
            Self::ActuatorBias(_, component) => ("actuator_biasprm", Some(component)),
            Self::ActuatorGear(_) => ("actuator_gear[0]", None),
        }
    }

    fn element(self, model: &Model) -> Option<(Kind, usize)> {
        Some(match self {
            Self::Gravity(_) => return None,
            Self::MassFactor(body) | Self::CentreOfMass(body, _) => (Kind::Body, model.body(body).id().index()),
            Self::JointStiffness(joint)
            | Self::JointDamping(joint)
            | Self::JointFrictionLoss(joint)
            | Self::JointArmature(joint) => (Kind::Joint, model.joint(joint).id().index()),
            Self::GeomFriction(geom, _) | Self::GeomSize(geom, _) => (Kind::Geom, model.geom(geom).id().index()),
            Self::ActuatorGain(actuator, _) | Self::ActuatorBias(actuator, _) | Self::ActuatorGear(actuator) => {
                (Kind::Actuator, model.actuator(actuator).id().index())
            }
        })
    }

    /// Returns the number of components that can vary.
    fn components(self, model: &Model) -> usize {
        match self {
            Self::GeomSize(geom, _) => match GeomType::of_field(model.geom_type()[geom.index()]) {
                GeomType::Sphere => 1,
                GeomType::Capsule | GeomType::Cylinder => 2,
                GeomType::Ellipsoid | GeomType::Box => 3,
                _ => 0,
            },
            Self::ActuatorGain(actuator, _) => model.actuator_gainprm()[actuator.index()].len(),
            Self::ActuatorBias(actuator, _) => model.actuator_biasprm()[actuator.index()].len(),
            _ => 3,
        }
    }

    /// Returns the value in the model of the batch.
    pub(super) fn nominal(self, model: &Model) -> f64 {
        match self {
            Self::Gravity(axis) => model.options().gravity[axis],
            Self::MassFactor(_) => 1.0,
            Self::CentreOfMass(body, axis) => model.body_ipos()[body.index()][axis],
            Self::JointStiffness(joint) => model.jnt_stiffness()[joint.index()],
            Self::JointDamping(joint) => first(model, joint, model.dof_damping()),
            Self::JointFrictionLoss(joint) => first(model, joint, model.dof_frictionloss()),
            Self::JointArmature(joint) => first(model, joint, model.dof_armature()),
            Self::GeomFriction(geom, at) => model.geom_friction()[geom.index()][at],
            Self::GeomSize(geom, at) => model.geom_size()[geom.index()][at],
            Self::ActuatorGain(actuator, at) => model.actuator_gainprm()[actuator.index()][at],
            Self::ActuatorBias(actuator, at) => model.actuator_biasprm()[actuator.index()][at],
            Self::ActuatorGear(actuator) => model.actuator_gear()[model.first_output(actuator.index())][0],
        }
    }

    /// Writes a valid value to a copy of the model of the batch.
    pub(super) fn write(self, value: f64, model: &Model, copy: &mut ModelMut<'_>) -> Result<()> {
        match self {
            Self::Gravity(axis) => copy.edit_options(|options| options.gravity[axis] = value)?,
            Self::MassFactor(body) => {
                let index = body.index();
                copy.body_mass_mut()[index] = model.body_mass()[index] * value;
                copy.body_inertia_mut()[index] = model.body_inertia()[index].map(|moment| moment * value);
            }
            Self::CentreOfMass(body, axis) => copy.body_ipos_mut()[body.index()][axis] = value,
            Self::JointStiffness(joint) => copy.jnt_stiffness_mut()[joint.index()] = value,
            Self::JointDamping(joint) => copy.dof_damping_mut()[dofs(model, joint)].fill(value),
            Self::JointFrictionLoss(joint) => copy.dof_frictionloss_mut()[dofs(model, joint)].fill(value),
            Self::JointArmature(joint) => copy.dof_armature_mut()[dofs(model, joint)].fill(value),
            Self::GeomFriction(geom, at) => copy.geom_friction_mut()[geom.index()][at] = value,
            Self::GeomSize(geom, at) => copy.geom_size_mut()[geom.index()][at] = value,
            Self::ActuatorGain(actuator, at) => copy.actuator_gainprm_mut()[actuator.index()][at] = value,
            Self::ActuatorBias(actuator, at) => copy.actuator_biasprm_mut()[actuator.index()][at] = value,
            Self::ActuatorGear(actuator) => copy.actuator_gear_mut()[model.first_output(actuator.index())][0] = value,
        }
        Ok(())
    }
}

fn dofs(model: &Model, joint: JointId) -> std::ops::Range<usize> {
    model.joint(joint).dofs()
}

/// Returns the value of the joint's first degree of freedom.
fn first(model: &Model, joint: JointId, values: &[f64]) -> f64 {
    values[dofs(model, joint).start]
}
