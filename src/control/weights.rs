//! Weights of a quadratic cost.

use crate::matrix::Matrix;

/// Weights of a quadratic cost of deviations: `dxᵀ Q dx + duᵀ R du + 2 dxᵀ S du` at every step.
///
/// ```
/// use mujoco_safe::nalgebra::{DMatrix, RowVector4};
/// use mujoco_safe::{LqrWeights, Matrix};
///
/// let jacobian = RowVector4::new(1.0, 0.6, 0.0, 0.0); // of the position of a tip
/// let weights = LqrWeights::new(jacobian.transpose() * jacobian, Matrix::identity(1));
/// assert_eq!(weights.q.row(0), [1.0, 0.6, 0.0, 0.0]);
/// assert_eq!(LqrWeights::diagonal(&[1.0; 4], &[1.0]), LqrWeights::new(DMatrix::identity(4, 4), Matrix::identity(1)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LqrWeights {
    /// `(nx, nx)`, symmetric: cost of the state.
    pub q: Matrix,
    /// `(nu, nu)`, symmetric and positive definite: cost of the controls.
    pub r: Matrix,
    /// `(nx, nu)`: cross term of the state and the controls; `None` means zero.
    pub s: Option<Matrix>,
}

impl LqrWeights {
    /// Creates weights without a cross term. Accepts matrices of this crate and of nalgebra.
    pub fn new(q: impl Into<Matrix>, r: impl Into<Matrix>) -> Self {
        Self { q: q.into(), r: r.into(), s: None }
    }

    /// Creates diagonal weights: one weight per state, `[dq; dv; da]`, and one per control.
    pub fn diagonal(state: &[f64], control: &[f64]) -> Self {
        Self::new(Matrix::from_diagonal(state), Matrix::from_diagonal(control))
    }
}
