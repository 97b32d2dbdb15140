//! Derivatives by parameters of the model.
//!
//! With the residual g(q, v, a, u, θ) of the equations of motion (`../implicit.rs`),
//! `∂a/∂θ = −H⁻¹ ∂g/∂θ` has the same matrix as the linearisation, and the integrator converts it in
//! the same way. `effect.rs` decides how a parameter acts, `../analytic/parameters/` has the
//! formulas of ∂g/∂θ, `differences.rs` the differences for all others.

mod buffers;
mod differences;
mod effect;
mod inertial;
mod regressor;
mod solver;

pub(super) use self::buffers::ParameterBuffers;
pub use self::buffers::{ParameterJacobian, ParameterOutputs};
pub(super) use self::effect::{Effect, Factor, Resolved};
pub use self::inertial::InertialParameters;
pub(super) use self::regressor::{BodyFrame, BodyMotion};
pub(super) use self::solver::{Element, Quantity, SolverNumber};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::kind::Kind;
use crate::model::{Model, ModelMut};
use crate::rollout::Parameter;

/// Parameter of a model by which steps and inverse dynamics are differentiated. Each is one number.
///
/// [`Number`](Self::Number) are the parameters of batches, which by [`Parameter::field`] can be any
/// number in the arrays of the model. The others are parameters of the inertia of a body that
/// several numbers of the model contain.
///
/// A derivative by a parameter is the one at constant other numbers of the model: as for an edit
/// without [`update_constants`](crate::ModelMut::update_constants). The inertias that weigh
/// constraints (`body_invweight0` and the like) and the constants of actuators do not change with
/// it. The inertia matrix does, also that of bodies that move independently (`body_simple`), and so
/// do the masses of subtrees that sensors refer to.
///
/// ```
/// use mujoco_safe::derivative::ModelParameter;
/// use mujoco_safe::rollout::Parameter;
/// use mujoco_safe::sample;
///
/// let mut model = sample::cartpole();
/// let pole = model.body("pole")?.id();
/// let damping = ModelParameter::from(Parameter::JointDamping(model.joint("hinge")?.id()));
/// assert_eq!(damping.name(&model)?, "dof_damping of joint 'hinge'");
/// let mass = ModelParameter::Mass(pole);
/// let before = mass.value(&model)?;
/// mass.set(&mut model.edit(), 2.0 * before)?;
/// assert_eq!(model.body_mass()[pole.index()], 2.0 * before);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[doc(alias = "sensitivity")]
pub enum ModelParameter {
    /// Parameter of a batch. [`MassFactor`](Parameter::MassFactor) is the factor relative to the
    /// present mass, with the value 1.
    Number(Parameter),
    /// Mass of a body (`body_mass`), kg. The centre of mass and the rotational inertia about it do
    /// not change.
    Mass(BodyId),
    /// Element of the rotational inertia of a body about its centre of mass, in the axes of the
    /// body, kg·m²: `xx`, `yy`, `zz`, `xy`, `xz`, `yz`. Both elements of the symmetric matrix
    /// change.
    #[doc(alias = "body_inertia")]
    Inertia(BodyId, usize),
    /// One of the ten [inertial parameters](InertialParameters) of a body.
    Inertial(BodyId, usize),
    /// One of the ten [log-Cholesky coordinates](InertialParameters::log_cholesky) of the inertia
    /// of a body, for which each value is physically possible.
    #[doc(alias = "pseudo-inertia")]
    LogCholesky(BodyId, usize),
}

impl From<Parameter> for ModelParameter {
    fn from(parameter: Parameter) -> Self {
        Self::Number(parameter)
    }
}

impl ModelParameter {
    /// Returns the parameter for a number in an array of the model, as [`Parameter::field`] does.
    ///
    /// # Errors
    ///
    /// As for [`Parameter::field`].
    pub fn field(model: &Model, array: &str, row: usize, column: usize) -> Result<Self> {
        Parameter::field(model, array, row, column).map(Self::Number)
    }

    /// Returns the name: `geom_friction[0] of geom 'floor'`, `mass of body 'pole'`.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a component that does not exist, [`Error::Unsupported`] for a geom
    /// whose size cannot vary, and for log-Cholesky coordinates of a body without mass or without
    /// an extent in three dimensions.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub fn name(self, model: &Model) -> Result<String> {
        self.check(model)?;
        if let Self::Number(parameter) = self {
            return parameter.name(model);
        }
        let (body, what, component, count) = self.part();
        let component = if count == 1 { String::new() } else { format!("[{component}]") };
        Ok(format!("{what}{component} of {}", model.described(Kind::Body, body.index())))
    }

    /// Returns the body, the name, the component and the number of components of a parameter of the
    /// inertia.
    fn part(self) -> (BodyId, &'static str, usize, usize) {
        match self {
            Self::Number(_) => unreachable!("Bug: a number of the model is no part of an inertia"),
            Self::Mass(body) => (body, "mass", 0, 1),
            Self::Inertia(body, at) => (body, "inertia", at, 6),
            Self::Inertial(body, at) => (body, "inertial parameter", at, 10),
            Self::LogCholesky(body, at) => (body, "log-Cholesky coordinate", at, 10),
        }
    }

    /// Checks that a model has the parameter. Allocates nothing if it has.
    fn check(self, model: &Model) -> Result<()> {
        if let Self::Number(parameter) = self {
            return parameter.check(model);
        }
        let (body, what, component, count) = self.part();
        let index = model.body(body).id().index();
        let element = || model.described(Kind::Body, index);
        if component >= count {
            let what = format!("the component of the {what} of {}", element());
            return Err(Error::out_of_range(what, component, format!("less than {count}")));
        }
        if matches!(self, Self::LogCholesky(..)) && InertialParameters::of(model, body).log_cholesky().is_none() {
            return Err(Error::Unsupported(format!(
                "log-Cholesky coordinates of {}, which has no mass or no extent in three dimensions",
                element()
            )));
        }
        Ok(())
    }

    /// Returns the value in a model.
    ///
    /// # Errors
    ///
    /// As for [`name`](Self::name).
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub fn value(self, model: &Model) -> Result<f64> {
        self.check(model)?;
        Ok(match self {
            Self::Number(parameter) => parameter.nominal(model),
            Self::Mass(body) => model.body_mass()[body.index()],
            Self::Inertia(body, at) => InertialParameters::of(model, body).central_inertia()[at],
            Self::Inertial(body, at) => InertialParameters::of(model, body).0[at],
            Self::LogCholesky(body, at) => coordinates(model, body)[at],
        })
    }

    /// Returns the least and the largest value, of which not all need be valid.
    pub(crate) fn bounds(self) -> [f64; 2] {
        match self {
            Self::Number(parameter) => parameter.bounds(),
            Self::Mass(_) => [0.0, f64::INFINITY],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Returns `true` if other quantities of the model are derived from this one.
    pub(crate) fn has_derived_constants(self) -> bool {
        !matches!(self, Self::Number(parameter) if !parameter.has_derived_constants())
    }

    /// Changes the value in a model, and no other number. Derived constants need a call of
    /// [`update_constants`](crate::ModelMut::update_constants) afterwards.
    ///
    /// # Errors
    ///
    /// As for [`name`](Self::name), [`Error::Invalid`] for a value that is not valid: not finite,
    /// or outside of the range that the documentation of the parameter gives, or an inertia whose
    /// principal moments are not positive.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub fn set(self, model: &mut ModelMut<'_>, value: f64) -> Result<()> {
        self.check(model)?;
        let invalid = |text: &str| match self.name(model) {
            Ok(name) => Error::out_of_range(format!("the {name}"), value, text),
            Err(error) => error,
        };
        match self {
            Self::Number(parameter) if !parameter.valid().contains(value) => Err(invalid(parameter.valid().text())),
            Self::Mass(_) if !(value.is_finite() && value >= 0.0) => Err(invalid("finite and not negative")),
            _ if !value.is_finite() => Err(invalid("finite")),
            _ => self.write(model, value),
        }
    }

    /// Writes a value, which may be outside of the range of valid ones by the step of a difference.
    fn write(self, model: &mut ModelMut<'_>, value: f64) -> Result<()> {
        match self {
            Self::Number(parameter) => parameter.set(value, model),
            Self::Mass(body) => {
                model.body_mass_mut()[body.index()] = value;
                Ok(())
            }
            Self::Inertia(body, at) => {
                let parameters = InertialParameters::of(model, body);
                let mut central = parameters.central_inertia();
                central[at] = value;
                let point = InertialParameters::point(parameters.mass(), &parameters.centre_of_mass());
                point.with_inertia(&central).write(model, body)
            }
            Self::Inertial(body, at) => {
                let mut parameters = InertialParameters::of(model, body);
                parameters.0[at] = value;
                parameters.write(model, body)
            }
            Self::LogCholesky(body, at) => {
                let mut coordinates = coordinates(model, body);
                coordinates[at] = value;
                InertialParameters::from_log_cholesky(&coordinates).write(model, body)
            }
        }
    }

    /// Copies all numbers that the parameter changes from another copy of the model.
    fn restore(self, from: &Model, to: &mut ModelMut<'_>) -> Result<()> {
        let body = match self {
            Self::Number(Parameter::MassFactor(body))
            | Self::Mass(body)
            | Self::Inertia(body, _)
            | Self::Inertial(body, _)
            | Self::LogCholesky(body, _) => body,
            Self::Number(parameter) => {
                let Some((array, rows, column)) = parameter.place(from) else {
                    return parameter.set(parameter.nominal(from), to);
                };
                rows.for_each(|row| to.set_number(array, row, column, from.number(array, row, column)));
                return Ok(());
            }
        };
        let body = body.index();
        to.body_mass_mut()[body] = from.body_mass()[body];
        to.body_ipos_mut()[body] = from.body_ipos()[body];
        to.body_iquat_mut()[body] = from.body_iquat()[body];
        to.body_inertia_mut()[body] = from.body_inertia()[body];
        Ok(())
    }
}

/// Returns the log-Cholesky coordinates of a body that has them.
fn coordinates(model: &Model, body: BodyId) -> [f64; 10] {
    InertialParameters::of(model, body).log_cholesky().unwrap_or([f64::NAN; 10])
}
