//! Numbers to identify.

use std::fmt;
use std::sync::Arc;

use crate::derivative::ModelParameter;
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::model::{Model, ModelMut};

type Edit = dyn Fn(f64, &mut ModelMut<'_>) -> Result<()> + Send + Sync;

/// Number to identify: a parameter of the model, or the delay, gain or bias of a
/// [`Measurement`](super::Measurement), with a first value, bounds and what is known about it.
#[derive(Clone)]
#[must_use]
pub struct Unknown {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) first: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Mean and standard deviation.
    pub(super) prior: Option<(f64, f64)>,
    pub(super) scale: Option<f64>,
    pub(super) is_logarithmic: bool,
}

#[derive(Clone)]
pub(super) enum Kind {
    Parameter(ModelParameter),
    Edit(Arc<Edit>),
    /// Correction of the measurement of a name.
    Correction(Correction, String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Correction {
    Delay,
    Gain,
    Bias,
}

impl Unknown {
    /// A [`Parameter`](crate::rollout::Parameter) of batches, which by
    /// [`Parameter::field`](crate::rollout::Parameter::field) can be any number in the arrays of
    /// the model, or a [`ModelParameter`] of the inertia of a body. It starts with its value in the
    /// model, and is between the bounds of all valid values. Derived quantities are updated
    /// ([`update_constants`](crate::ModelMut::update_constants)).
    ///
    /// For the whole inertia of a body, take its ten log-Cholesky coordinates: all their values are
    /// physically possible (see [`all_inertia`](Self::all_inertia)).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a component that the element does not have.
    ///
    /// # Panics
    ///
    /// If the element belongs to another model.
    pub fn parameter(model: &Model, parameter: impl Into<ModelParameter>) -> Result<Self> {
        let parameter = parameter.into();
        let (name, first) = (parameter.name(model)?, parameter.value(model)?);
        let [lower, upper] = parameter.bounds();
        Ok(Self { lower, upper, ..Self::new(name, Kind::Parameter(parameter), first) })
    }

    /// The ten [log-Cholesky coordinates](ModelParameter::LogCholesky) of the mass, the centre of
    /// mass and the rotational inertia of a body.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] for a body without mass or without an extent in three dimensions.
    ///
    /// # Panics
    ///
    /// If the body belongs to another model.
    pub fn all_inertia(model: &Model, body: BodyId) -> Result<Vec<Self>> {
        (0..10).map(|at| Self::parameter(model, ModelParameter::LogCholesky(body, at))).collect()
    }

    /// A number that a closure writes to a model, for example one that several elements share. The
    /// closure also updates derived quantities
    /// ([`update_constants`](crate::ModelMut::update_constants)). It is called with an unchanged
    /// model and, if there are several, in the order in which they were added.
    ///
    /// ```
    /// use mujoco_safe::identification::Unknown;
    ///
    /// // One damping for all joints.
    /// let damping = Unknown::edit("damping", 0.1, |value, model| {
    ///     model.dof_damping_mut().fill(value);
    ///     Ok(())
    /// })
    /// .between(0.0, 10.0);
    /// ```
    pub fn edit(
        name: impl Into<String>,
        first: f64,
        edit: impl Fn(f64, &mut ModelMut<'_>) -> Result<()> + Send + Sync + 'static,
    ) -> Self {
        Self::new(name.into(), Kind::Edit(Arc::new(edit)), first)
    }

    /// The time by which the measurement of this name lags behind the simulation, s. By default
    /// from 0 to 0.1; its bounds must be finite. Readings that the simulation does not reach with
    /// all delays between the bounds are not used.
    pub fn delay(measurement: &str) -> Self {
        let unknown = Self::correction("delay", Correction::Delay, measurement, 0.0);
        Self { upper: 0.1, scale: Some(1e-3), lower: 0.0, ..unknown }
    }

    /// The factor of the measurement of this name: `measured = gain · simulated + bias`.
    pub fn gain(measurement: &str) -> Self {
        Self::correction("gain", Correction::Gain, measurement, 1.0)
    }

    /// The constant in the measurement of this name, equal for all its components.
    pub fn bias(measurement: &str) -> Self {
        Self::correction("bias", Correction::Bias, measurement, 0.0)
    }

    fn correction(what: &str, correction: Correction, measurement: &str, first: f64) -> Self {
        Self::new(format!("{what} of {measurement}"), Kind::Correction(correction, measurement.to_owned()), first)
    }

    fn new(name: String, kind: Kind, first: f64) -> Self {
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { name, kind, first, lower, upper, prior: None, scale: None, is_logarithmic: false }
    }

    /// Sets the value to start from.
    pub fn starting_at(mut self, value: f64) -> Self {
        self.first = value;
        self
    }

    /// Sets the bounds.
    pub fn between(mut self, lower: f64, upper: f64) -> Self {
        (self.lower, self.upper) = (lower, upper);
        self
    }

    /// Adds what is known: the value is normally distributed with this mean and standard deviation.
    pub fn with_prior(mut self, mean: f64, deviation: f64) -> Self {
        self.prior = Some((mean, deviation));
        self
    }

    /// Sets the size of a change that matters. It decides the step of differences (1e-6 of it) and
    /// the units in which combinations of parameters are compared. By default the magnitude of the
    /// first value, or 1 if that is zero.
    pub fn with_scale(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }

    /// Searches for the logarithm. The value stays positive, and the confidence interval is that of
    /// a factor: for masses and inertias.
    pub fn logarithmic(mut self) -> Self {
        self.is_logarithmic = true;
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Checks the numbers.
    pub(super) fn check(&self) -> Result<()> {
        let name = &self.name;
        let Self { first, lower, upper, .. } = *self;
        let expected = format_args!("at most the upper one, {upper}");
        Error::check_range(lower <= upper, format_args!("the lower bound of {name}"), lower, expected)?;
        let (what, expected) = (format!("the first value of {name}"), format!("finite and from {lower} to {upper}"));
        Error::check_range(first.is_finite() && (lower..=upper).contains(&first), &what, first, expected)?;
        if matches!(self.kind, Kind::Correction(Correction::Delay, _)) {
            Error::check_finite(&[lower, upper], |_| format!("a bound of the {name}"))?;
        }
        Error::check_range(!self.is_logarithmic || first > 0.0, what, first, "positive, for its logarithm")?;
        if let Some((mean, deviation)) = self.prior {
            Error::check_finite(&[mean], |_| format!("the mean of {name}"))?;
            check_deviation(&format!("the standard deviation of {name}"), deviation)?;
        }
        self.scale.map_or(Ok(()), |scale| check_deviation(&format!("the scale of {name}"), scale))
    }

    /// Returns the coordinate of a value in the search.
    pub(super) fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.ln() } else { value }
    }

    /// Returns the value of a coordinate, between the bounds in spite of rounding.
    pub(super) fn value(&self, coordinate: f64) -> f64 {
        let value = if self.is_logarithmic { coordinate.exp() } else { coordinate };
        value.max(self.lower).min(self.upper)
    }

    /// Returns the bounds of the coordinate.
    pub(super) fn bounds(&self) -> [f64; 2] {
        [self.lower.max(if self.is_logarithmic { 0.0 } else { f64::NEG_INFINITY }), self.upper]
            .map(|value| self.coordinate(value))
    }

    /// Returns the size of a change of the coordinate that matters.
    pub(super) fn coordinate_scale(&self) -> f64 {
        let scale = self.scale.unwrap_or(if self.first == 0.0 { 1.0 } else { self.first.abs() });
        if self.is_logarithmic { scale / self.first } else { scale }
    }

    /// Returns the longest step of the coordinate in an iteration: a factor of 20 for logarithms,
    /// for which a linear model is not right far away. Without this limit, an extent of a body on
    /// which the readings hardly depend would become zero.
    pub(super) fn longest_step(&self) -> f64 {
        let is_logarithm =
            self.is_logarithmic || matches!(self.kind, Kind::Parameter(ModelParameter::LogCholesky(_, 0..4)));
        if is_logarithm { 20_f64.ln() } else { f64::INFINITY }
    }

    /// Returns `true` if the value changes the model and is not known.
    pub(super) fn has_column(&self) -> bool {
        matches!(self.kind, Kind::Parameter(_) | Kind::Edit(_)) && self.lower < self.upper
    }
}

/// Checks that a number is finite and positive.
pub(super) fn check_deviation(what: &str, deviation: f64) -> Result<()> {
    Error::check_range(deviation.is_finite() && deviation > 0.0, what, deviation, "finite and positive")
}

impl fmt::Debug for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Unknown {} = {} in [{}, {}]", self.name, self.first, self.lower, self.upper)
    }
}
