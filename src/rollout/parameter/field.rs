//! Quantities of the model that can differ between the simulations of a batch.

use std::ops::Range;

use crate::enums::GeomType;
use crate::error::{Error, Result};
use crate::id::{ActuatorId, BodyId, GeomId, JointId, Lineage};
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
    /// Number in any array of the model that a program can choose: see [`Parameter::field`].
    /// Finite, also as `f32`.
    Field(FieldNumber),
}

/// Number in an array of the model: see [`Parameter::field`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FieldNumber {
    array: &'static str,
    row: usize,
    column: usize,
    /// `true` if other quantities are derived from the number.
    has_derived: bool,
    lineage: Lineage,
}

/// Set of valid values.
#[derive(Clone, Copy)]
pub(crate) enum Valid {
    Finite,
    /// A number that is finite as `f32`, too.
    Single,
    NotNegative,
    Positive,
    Factor,
}

impl Valid {
    pub(crate) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Single => value.abs() <= f64::from(f32::MAX),
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::Factor => (1e-6..=1e6).contains(&value),
            }
    }

    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Single => "finite and at most 3.4e38 in magnitude",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
            Self::Factor => "from 1e-6 to 1e6",
        }
    }
}

impl Parameter {
    /// Returns the parameter for a number in an array of the model, by the engine's name of the
    /// array, the row and the column: [`Parameters`](super::Parameters) then gives it another value
    /// in each simulation. The row is the index of the element, or of a part of an element, such as
    /// a degree of freedom in `dof_damping`. The column is 0 in an array with one number in each
    /// row.
    ///
    /// All arrays of floating-point numbers are parameters that [`ModelMut`](crate::ModelMut) has
    /// for writing, except those that other arrays determine, such as `body_subtreemass`: limits
    /// (`jnt_range`, `tendon_range`), springs of tendons, parameters of pairs and equality
    /// constraints, poses of bodies, sites, cameras and lights, `cam_fovy`, colours (`geom_rgba`,
    /// `light_diffuse`) and others. Values of arrays of `f32` are rounded.
    ///
    /// A value is that of the array: no other number changes with it, except the derived quantities
    /// that the documentation of the array's accessor lists, such as
    /// [`body_pos_mut`](crate::ModelMut::body_pos_mut). Those that it lists as not updated stay,
    /// for example the mass of a body with another `geom_size`. A quaternion has four parameters,
    /// which the caller normalises. The values are not checked further: a negative damping is
    /// valid.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchField`] for an unknown name, [`Error::Unsupported`] with the reason for a
    /// field that cannot be a parameter and for the size of a mesh or a height field, and
    /// [`Error::Invalid`] for a row or a column outside of the array.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
    /// use mujoco_safe::sample;
    ///
    /// // Cart-poles with other limits of the cart, and other colours of the pole.
    /// let model = sample::cartpole();
    /// let limit = Parameter::field(&model, "jnt_range", model.joint("slider")?.index(), 1)?;
    /// let green = Parameter::field(&model, "geom_rgba", model.geom("pole")?.index(), 1)?;
    /// let parameters = Parameters::new()
    ///     .with(&model, limit, Distribution::Uniform { low: 0.5, high: 2.0 })?
    ///     .with(&model, green, Distribution::Uniform { low: 0.0, high: 1.0 })?;
    /// assert_eq!(parameters.names().next(), Some("jnt_range[1] of joint 'slider'"));
    /// let mut batch = Batch::new(model, 8)?.with_parameters(parameters)?;
    /// batch.sample_parameters(|_| true, 42)?;
    /// let drawn = batch.parameters()[(3, 0)];
    /// assert_eq!(batch.data(3)?.joint("slider")?.in_model().range()[1], drawn);
    ///
    /// let error = Parameter::field(batch.model(), "body_parentid", 1, 0).unwrap_err();
    /// assert!(error.to_string().contains("memory accesses"));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn field(model: &Model, array: &str, row: usize, column: usize) -> Result<Self> {
        let found = model.find_number(array, row, column)?;
        let (array, has_derived, lineage) = (found.name, found.has_derived, model.lineage());
        Ok(Self::Field(FieldNumber { array, row, column, has_derived, lineage }))
    }

    pub(crate) fn valid(self) -> Valid {
        match self {
            Self::Gravity(_)
            | Self::CentreOfMass(..)
            | Self::ActuatorGain(..)
            | Self::ActuatorBias(..)
            | Self::ActuatorGear(_) => Valid::Finite,
            Self::Field(_) => Valid::Single,
            Self::JointStiffness(_)
            | Self::JointDamping(_)
            | Self::JointFrictionLoss(_)
            | Self::JointArmature(_)
            | Self::GeomFriction(..) => Valid::NotNegative,
            Self::GeomSize(..) => Valid::Positive,
            Self::MassFactor(_) => Valid::Factor,
        }
    }

    /// Returns the least and the largest valid value.
    pub(crate) fn bounds(self) -> [f64; 2] {
        match self.valid() {
            Valid::Finite => [f64::NEG_INFINITY, f64::INFINITY],
            Valid::Single => [-f64::from(f32::MAX), f64::from(f32::MAX)],
            Valid::NotNegative => [0.0, f64::INFINITY],
            Valid::Positive => [f64::MIN_POSITIVE, f64::INFINITY],
            Valid::Factor => [1e-6, 1e6],
        }
    }

    /// Returns `true` if other quantities of the model are derived from this one.
    pub(crate) fn has_derived_constants(self) -> bool {
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
            Self::Field(number) => number.has_derived,
        }
    }

    /// Returns `true` if two parameters can write the same number: equal ones, and a number of an
    /// array that another parameter writes for an element.
    pub(super) fn overlaps(self, other: Self) -> bool {
        let [ours, theirs] = [self, other].map(|parameter| parameter.field_name().0.split('[').next());
        let is_scaled = |name: Option<&str>| matches!(name, Some("body_mass" | "body_inertia"));
        match (self, other) {
            (Self::Field(_), Self::Field(_)) => self == other,
            (Self::Field(_), Self::MassFactor(_)) => is_scaled(ours),
            (Self::MassFactor(_), Self::Field(_)) => is_scaled(theirs),
            (Self::Field(_), _) | (_, Self::Field(_)) => ours == theirs,
            _ => self == other,
        }
    }

    /// Returns the name, for example `geom_friction[0] of geom 'floor'`, or an error if the model
    /// does not have the quantity.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub(crate) fn name(self, model: &Model) -> Result<String> {
        if let Self::Field(FieldNumber { array, row, column, lineage, .. }) = self {
            assert!(lineage == model.lineage(), "the parameter {array}[{row}] belongs to another model");
            return Ok(model.find_number(array, row, column)?.described(model, row, column));
        }
        let element = self.element(model).map_or(String::new(), |(kind, index)| match model.name_at(kind, index) {
            Some(name) => format!(" of {kind} '{name}'"),
            None => format!(" of {kind} {index}"),
        });
        let (field, component) = self.field_name();
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

    /// Checks that the model has the quantity, as [`name`](Self::name) does, without allocation.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub(crate) fn check(self, model: &Model) -> Result<()> {
        if let Self::Field(FieldNumber { array, row, column, lineage, .. }) = self {
            assert!(lineage == model.lineage(), "the parameter {array}[{row}] belongs to another model");
            return model.find_number(array, row, column).map(drop);
        }
        let _ = self.element(model);
        match self.field_name().1 {
            Some(component) if component >= self.components(model) => self.name(model).map(drop),
            _ => Ok(()),
        }
    }

    /// Returns the name of the field, and the component if there are several.
    fn field_name(self) -> (&'static str, Option<usize>) {
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
            Self::Field(number) => (number.array, None),
        }
    }

    fn element(self, model: &Model) -> Option<(Kind, usize)> {
        Some(match self {
            Self::Gravity(_) | Self::Field(_) => return None,
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

    /// Returns the name of the array, the rows and the column of the numbers that a parameter is.
    /// `None` for gravity and a factor of the mass.
    pub(crate) fn place(self, model: &Model) -> Option<(&'static str, Range<usize>, usize)> {
        let (array, row, column) = match self {
            Self::Gravity(_) | Self::MassFactor(_) => return None,
            Self::JointDamping(joint) => return Some(("dof_damping", model.joint(joint).dofs(), 0)),
            Self::JointFrictionLoss(joint) => return Some(("dof_frictionloss", model.joint(joint).dofs(), 0)),
            Self::JointArmature(joint) => return Some(("dof_armature", model.joint(joint).dofs(), 0)),
            Self::CentreOfMass(body, axis) => ("body_ipos", body.index(), axis),
            Self::JointStiffness(joint) => ("jnt_stiffness", joint.index(), 0),
            Self::GeomFriction(geom, at) => ("geom_friction", geom.index(), at),
            Self::GeomSize(geom, at) => ("geom_size", geom.index(), at),
            Self::ActuatorGain(actuator, at) => ("actuator_gainprm", actuator.index(), at),
            Self::ActuatorBias(actuator, at) => ("actuator_biasprm", actuator.index(), at),
            Self::ActuatorGear(actuator) => ("actuator_gear", model.first_output(actuator.index()), 0),
            Self::Field(FieldNumber { array, row, column, .. }) => (array, row, column),
        };
        Some((array, row..row + 1, column))
    }

    /// Returns the value in the model of the batch.
    pub(crate) fn nominal(self, model: &Model) -> f64 {
        match (self, self.place(model)) {
            (_, Some((array, rows, column))) => model.number(array, rows.start, column),
            (Self::Gravity(axis), _) => model.options().gravity[axis],
            _ => 1.0,
        }
    }

    /// Writes a valid value to a copy of the model of the batch.
    pub(crate) fn write(self, value: f64, model: &Model, copy: &mut ModelMut<'_>) -> Result<()> {
        if let Self::MassFactor(body) = self {
            let index = body.index();
            copy.body_mass_mut()[index] = model.body_mass()[index];
            copy.body_inertia_mut()[index] = model.body_inertia()[index];
        }
        self.set(value, copy)
    }

    /// Writes a valid value. A factor multiplies the present mass.
    pub(crate) fn set(self, value: f64, model: &mut ModelMut<'_>) -> Result<()> {
        match (self, self.place(model)) {
            (_, Some((array, rows, column))) => rows.for_each(|row| model.set_number(array, row, column, value)),
            (Self::Gravity(axis), _) => model.edit_options(|options| options.gravity[axis] = value)?,
            (Self::MassFactor(body), _) => {
                let index = body.index();
                model.body_mass_mut()[index] *= value;
                model.body_inertia_mut()[index].iter_mut().for_each(|moment| *moment *= value);
            }
            _ => unreachable!("Bug: a parameter without a place"),
        }
        Ok(())
    }
}
