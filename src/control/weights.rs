//! Weights of a quadratic cost.

use nalgebra::{DMatrix, DVector};

/// Weights of a quadratic cost of deviations: `dxᵀ Q dx + duᵀ R du + 2 dxᵀ S du` at every step.
#[derive(Clone, Debug, PartialEq)]
pub struct LqrWeights {
    /// `(nx, nx)`, symmetric: cost of the state.
    pub q: DMatrix<f64>,
    /// `(nu, nu)`, symmetric and positive definite: cost of the controls.
    pub r: DMatrix<f64>,
    /// `(nx, nu)`: cross term of the state and the controls; `None` means zero.
    pub s: Option<DMatrix<f64>>,
}

impl LqrWeights {
    /// Creates diagonal weights: one weight per state, `[dq; dv; da]`, and one per control.
    pub fn diagonal(state: &[f64], control: &[f64]) -> Self {
        let diagonal = |values: &[f64]| DMatrix::from_diagonal(&DVector::from_column_slice(values));
        Self { q: diagonal(state), r: diagonal(control), s: None }
    }
}
