//! A term of a residual cost.

use std::fmt;

use super::{Norm, Residual};
use crate::error::{Error, Result};

/// Weighted norm of a residual, with a name. A part of a [`ResidualCost`](super::ResidualCost).
#[non_exhaustive]
pub struct Term {
    /// Weight in each step; 1 by default. A term with the weight zero is not evaluated.
    pub weight: f64,
    /// Weight at the end of a trajectory; the same as `weight` by default.
    pub terminal_weight: f64,
    /// Cost of a component; half the square by default.
    pub norm: Norm,
    name: String,
    /// `(n)`: factors of the components.
    pub(super) scales: Vec<f64>,
    pub(super) residual: Box<dyn Residual>,
}

impl Term {
    /// Creates a term with the weight 1 and the quadratic norm.
    pub fn new(name: impl Into<String>, residual: impl Residual + 'static) -> Self {
        Self {
            weight: 1.0,
            terminal_weight: 1.0,
            norm: Norm::Quadratic,
            name: name.into(),
            scales: vec![1.0; residual.size()],
            residual: Box::new(residual),
        }
    }

    /// Sets [`weight`](Self#structfield.weight) and
    /// [`terminal_weight`](Self#structfield.terminal_weight).
    #[must_use]
    pub fn with_weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self.terminal_weight = weight;
        self
    }

    /// Sets [`terminal_weight`](Self#structfield.terminal_weight).
    #[must_use]
    pub fn with_terminal_weight(mut self, weight: f64) -> Self {
        self.terminal_weight = weight;
        self
    }

    /// Sets [`norm`](Self#structfield.norm).
    #[must_use]
    pub fn with_norm(mut self, norm: Norm) -> Self {
        self.norm = norm;
        self
    }

    /// Sets the factors of the components; 1 by default. A component with the factor zero has no
    /// cost. [`ResidualCost::new`](super::ResidualCost::new) checks that there is one for each
    /// component.
    #[must_use]
    pub fn with_scales(mut self, scales: impl Into<Vec<f64>>) -> Self {
        self.scales = scales.into();
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the number of components.
    pub fn size(&self) -> usize {
        self.residual.size()
    }

    /// Sets the target of the residual.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Unsupported`] for a residual without a target.
    pub fn set_target(&mut self, target: &[f64]) -> Result<()> {
        let Some(present) = self.residual.target_mut() else {
            return Err(Error::Unsupported(format!("the residual of the term '{}' has no target", self.name)));
        };
        Error::check_length("the target of a term", target.len(), present.len())?;
        present.copy_from_slice(target);
        Ok(())
    }

    /// Returns the weight in a step, or at the end.
    pub(super) fn weight_of(&self, is_terminal: bool) -> f64 {
        if is_terminal { self.terminal_weight } else { self.weight }
    }

    pub(super) fn check(&self) -> Result<()> {
        Error::check_length("the scales of a term", self.scales.len(), self.residual.size())?;
        match self.norm.width() {
            Some(width) if !(width > 0.0 && width.is_finite()) => Err(Error::out_of_range(
                format!("the width of the norm of the term '{}'", self.name),
                width,
                "above zero",
            )),
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { weight, terminal_weight, norm, name, .. } = self;
        write!(f, "Term '{name}': weight {weight}, at the end {terminal_weight}, {norm:?}, {} components", self.size())
    }
}
