//! Affine control policies about a trajectory.

use crate::derivative;
use crate::matrix::Matrix;
use crate::model::Model;

/// Affine policy about a trajectory: `ctrl = controls + α feedforward − K dx` with the step size α.
#[derive(Clone, Debug)]
pub(in crate::control) struct AffinePolicy {
    /// `(N, nu)`
    pub(super) feedforward: Matrix,
    /// `N` matrices K, each `(nu, nx)`.
    pub(in crate::control) gains: Vec<Matrix>,
}

impl AffinePolicy {
    /// Creates the zero policy, which does not change the controls.
    pub(super) fn zeros(model: &Model, steps: usize) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self { feedforward: Matrix::zeros(steps, nu), gains: vec![Matrix::zeros(nu, nx); steps] }
    }
}

/// Decrease of the cost that the second-order expansion predicts for a policy.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PredictedDecrease {
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl PredictedDecrease {
    /// Returns the predicted decrease for a step size.
    pub(super) fn at(self, step_size: f64) -> f64 {
        -step_size * (self.slope + 0.5 * step_size * self.curvature)
    }
}
