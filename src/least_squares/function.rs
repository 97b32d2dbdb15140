//! The problem of a vector function.

use super::{Problem, damp};
use crate::control::residual::Norm;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{add, quotient};

/// Step of differences, relative to the greater of a coordinate and 1: about the square root of the
/// rounding error.
const STEP: f64 = 1.5e-8;

/// Vector function r(x). Closures `FnMut(&[f64], &mut [f64]) -> Result<()>` are such functions.
pub trait ResidualFunction {
    /// Writes the residuals.
    ///
    /// # Errors
    ///
    /// Any error of the function.
    fn residuals(&mut self, x: &[f64], residuals: &mut [f64]) -> Result<()>;

    /// Writes the Jacobian of the residuals, `(m, n)`, and returns `true`. By default returns
    /// `false`, and the Jacobian is differenced.
    ///
    /// # Errors
    ///
    /// Any error of the function.
    fn jacobian(&mut self, x: &[f64], jacobian: &mut Matrix) -> Result<bool> {
        let _ = (x, jacobian);
        Ok(false)
    }
}

impl<F: FnMut(&[f64], &mut [f64]) -> Result<()>> ResidualFunction for F {
    fn residuals(&mut self, x: &[f64], residuals: &mut [f64]) -> Result<()> {
        self(x, residuals)
    }
}

/// Least squares of a vector function `r(x)` with `m` components, between bounds:
/// `Σ ρ(r(x)) → min` with a [`Norm`] ρ. The point is the caller's vector.
#[derive(Debug)]
pub struct Function<'x, F> {
    x: &'x mut [f64],
    residual: F,
    norm: Norm,
    lower: Vec<f64>,
    upper: Vec<f64>,
    candidate: Vec<f64>,
    residuals: Vec<f64>,
    moved: Vec<f64>,
    column: Vec<f64>,
    jacobian: Matrix,
}

impl<'x, F: ResidualFunction> Function<'x, F> {
    /// Creates a problem without bounds that starts at `x`, for a function of `m` components.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if a coordinate is not finite.
    pub fn new(x: &'x mut [f64], m: usize, function: F) -> Result<Self> {
        Error::check_finite(x, |index| format!("coordinate {index} of the first point"))?;
        let n = x.len();
        Ok(Self {
            residual: function,
            norm: Norm::Quadratic,
            lower: vec![f64::NEG_INFINITY; n],
            upper: vec![f64::INFINITY; n],
            candidate: x.to_vec(),
            residuals: vec![0.0; m],
            moved: vec![0.0; m],
            column: vec![0.0; m],
            jacobian: Matrix::zeros(m, n),
            x,
        })
    }

    /// Sets a norm that limits the influence of large residuals.
    #[must_use]
    pub fn with_norm(mut self, norm: Norm) -> Self {
        self.norm = norm;
        self
    }

    /// Sets the bounds, and moves the first point into them.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] if a bound is NaN or a lower bound
    /// exceeds the upper one.
    pub fn with_bounds(mut self, lower: &[f64], upper: &[f64]) -> Result<Self> {
        Error::check_length("the lower bounds", lower.len(), self.x.len())?;
        Error::check_length("the upper bounds", upper.len(), self.x.len())?;
        for (index, (low, high)) in lower.iter().zip(upper).enumerate() {
            let what = format_args!("the lower bound of coordinate {index}");
            Error::check_range(low <= high, what, low, format_args!("at most the upper one, {high}"))?;
            self.x[index] = self.x[index].clamp(*low, *high);
        }
        self.lower.copy_from_slice(lower);
        self.upper.copy_from_slice(upper);
        Ok(self)
    }

    /// Writes the Jacobian at the present point, whose residuals are known.
    fn differentiate(&mut self) -> Result<()> {
        let Self { x, residual: function, candidate, residuals, moved, column, jacobian, upper, .. } = self;
        if function.jacobian(x, jacobian)? {
            return Ok(());
        }
        candidate.copy_from_slice(x);
        for index in 0..x.len() {
            let size = STEP * x[index].abs().max(1.0);
            // A step beyond the upper bound goes down.
            candidate[index] = if x[index] + size > upper[index] { x[index] - size } else { x[index] + size };
            function.residuals(candidate, moved)?;
            quotient(column, residuals, moved, candidate[index] - x[index]);
            candidate[index] = x[index];
            column.iter().enumerate().for_each(|(row, &value)| jacobian[(row, index)] = value);
        }
        Ok(())
    }
}

impl<F: ResidualFunction> Problem for Function<'_, F> {
    fn len(&self) -> usize {
        self.x.len()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        for index in 0..self.x.len() {
            lower[index] = self.lower[index] - self.x[index];
            upper[index] = self.upper[index] - self.x[index];
        }
    }

    fn linearise(&mut self) -> Result<f64> {
        self.residual.residuals(self.x, &mut self.residuals)?;
        self.differentiate()?;
        Ok(self.residuals.iter().map(|&residual| self.norm.value(residual)).sum())
    }

    fn damped(&mut self, damping: f64, hessian: &mut Matrix, gradient: &mut [f64]) -> Option<f64> {
        for (row, &residual) in self.jacobian.rows().zip(&self.residuals) {
            add(gradient, row, self.norm.slope(residual));
            let weight = self.norm.weight(residual);
            for (index, &value) in row.iter().enumerate() {
                add(hessian.row_mut(index), row, weight * value);
            }
        }
        damp(damping, hessian);
        Some(0.0)
    }

    fn evaluate(&mut self, step: &[f64]) -> Result<f64> {
        for (index, (candidate, step)) in self.candidate.iter_mut().zip(step).enumerate() {
            *candidate = (self.x[index] + step).max(self.lower[index]).min(self.upper[index]);
        }
        self.residual.residuals(&self.candidate, &mut self.moved)?;
        Ok(self.moved.iter().map(|&residual| self.norm.value(residual)).sum())
    }

    fn accept(&mut self) {
        self.x.copy_from_slice(&self.candidate);
    }
}
