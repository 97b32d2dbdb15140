//! Parameters of the model that differ between the simulations of a batch.

mod field;
mod random;

pub use self::field::{FieldNumber, Parameter};
pub use self::random::{Distribution, Random};
use crate::error::{Error, InvalidKind, Result};
use crate::model::{Model, ModelMut};

/// List of parameters that differ between the simulations of a [`Batch`](super::Batch), each with
/// the distribution of its values.
///
/// ```
/// use std::sync::Arc;
/// use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
/// use mujoco_safe::sample;
///
/// // 64 cart-poles with other masses of the pole and other friction of the joints.
/// let model = Arc::new(sample::cartpole());
/// let (pole, hinge) = (model.body("pole")?.id(), model.joint("hinge")?.id());
/// let parameters = Parameters::new()
///     .with(&model, Parameter::MassFactor(pole), Distribution::LogUniform { low: 0.5, high: 2.0 })?
///     .with(&model, Parameter::JointDamping(hinge), Distribution::Uniform { low: 0.0, high: 0.1 })?;
/// let mut batch = Batch::new(model, 64)?.with_parameters(parameters)?;
/// batch.sample_parameters(|_| true, 42)?;
/// batch.reset_where(|_| true, |_, _, data| data.qpos_mut()[1] = 0.2)?;
/// batch.step(|_, _| ())?;
///
/// let factor = batch.parameters()[(3, 0)];
/// assert!((0.5..2.0).contains(&factor));
/// let mass = batch.model().body_mass()[pole.index()];
/// assert_eq!(batch.data(3)?.model().body_mass()[pole.index()], factor * mass);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
#[must_use]
pub struct Parameters {
    columns: Vec<Column>,
}

#[derive(Clone, Debug)]
struct Column {
    parameter: Parameter,
    distribution: Distribution,
    name: String,
}

impl Parameters {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a parameter of the model with the distribution of its values.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a parameter that is already in the list, a component out of range, a
    /// geom whose size cannot vary, and a distribution with values that are not valid for the
    /// parameter.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let floor = model.geom("floor")?.id();
    /// let sliding = Parameter::GeomFriction(floor, 0);
    /// let wrong = Distribution::Uniform { low: -0.1, high: 1.0 };
    /// let error = Parameters::new().with(&model, sliding, wrong).unwrap_err();
    /// assert_eq!(
    ///     error.to_string(),
    ///     "the smallest value of geom_friction[0] of geom 'floor' is -0.1, but must be finite and not negative"
    /// );
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn with(mut self, model: &Model, parameter: Parameter, distribution: Distribution) -> Result<Self> {
        let name = parameter.name(model)?;
        if let Some(other) = self.columns.iter().find(|column| column.parameter.overlaps(parameter)) {
            return Err(Error::invalid(
                InvalidKind::Duplicate,
                "the list of parameters",
                if other.parameter == parameter {
                    format!("given {name} twice")
                } else {
                    format!("given {name} beside {}", other.name)
                },
                "without two parameters for one array, except different numbers of it by Parameter::field",
            ));
        }
        let valid = parameter.valid();
        if let Some([low, high]) = distribution.bounds() {
            for (what, value) in [("smallest", low), ("largest", high)] {
                if !valid.contains(value) {
                    return Err(Error::out_of_range(format!("the {what} value of {name}"), value, valid.text()));
                }
            }
            if low > high {
                let expected = format!("at most the largest, {high}");
                return Err(Error::out_of_range(format!("the smallest value of {name}"), low, expected));
            }
            if matches!(distribution, Distribution::LogUniform { .. }) && low <= 0.0 {
                return Err(Error::out_of_range(
                    format!("the smallest value of {name}"),
                    low,
                    "positive, for its logarithm",
                ));
            }
        }
        self.columns.push(Column { parameter, distribution, name });
        Ok(self)
    }

    /// Returns the number of parameters.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Returns `true` if there are no parameters.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Returns the names of the parameters, in the order of the columns:
    /// `factor of the mass of body 'pole'`, `gravity[2]`.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| &*column.name)
    }

    /// Checks that this model has the parameters, under their names.
    pub(super) fn check_model(&self, model: &Model) -> Result<()> {
        self.columns.iter().try_for_each(|column| column.parameter.name(model).map(drop))
    }

    /// Returns the values in the model.
    pub(super) fn nominal(&self, model: &Model) -> Vec<f64> {
        self.columns.iter().map(|column| column.parameter.nominal(model)).collect()
    }

    /// Draws new values, each from its own generator.
    pub(super) fn draw(&self, seed: u64, index: usize, episode: u64, values: &mut [f64]) {
        for (stream, (column, value)) in (1..).zip(self.columns.iter().zip(values)) {
            if let Some(drawn) = column.distribution.draw(&mut Random::stream(seed, index, episode, stream)) {
                *value = drawn;
            }
        }
    }

    /// Checks the values of a simulation.
    pub(super) fn check(&self, index: usize, values: &[f64]) -> Result<()> {
        for (column, &value) in self.columns.iter().zip(values) {
            let valid = column.parameter.valid();
            if !valid.contains(value) {
                let what = format!("the {} of simulation {index}", column.name);
                return Err(Error::out_of_range(what, value, valid.text()));
            }
        }
        Ok(())
    }

    /// Writes the values that differ from the present ones to a copy of the model, and updates the
    /// derived constants if necessary.
    pub(super) fn write(&self, from: &[f64], to: &[f64], model: &Model, copy: &mut ModelMut<'_>) -> Result<()> {
        let mut has_derived_constants = false;
        let changes =
            self.columns.iter().zip(from.iter().zip(to)).filter(|(_, (from, to))| from.to_bits() != to.to_bits());
        for (column, (_, &value)) in changes {
            column.parameter.write(value, model, copy)?;
            has_derived_constants |= column.parameter.has_derived_constants();
        }
        if has_derived_constants { copy.update_constants() } else { Ok(()) }
    }
}
