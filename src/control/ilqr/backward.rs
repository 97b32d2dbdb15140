//! The backward pass: the affine control policy that minimises the expanded cost.

use nalgebra::{DMatrix, DVector};

use super::cost::{CostExpansion, TrajectoryCost};
use super::forward::Trial;
use crate::control::feedback::control_range;
use crate::control::riccati::{BellmanBackup, StepCost};
use crate::derivative::{self, LinearisationReport, StateSpace, for_each_item};
use crate::error::Result;
use crate::math::{BoxQp, BoxQpStatus, chol_solve_in_place};
use crate::matrix::{Matrix, MatrixView};
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
    slope: f64,
    curvature: f64,
}

impl PredictedDecrease {
    /// Returns the predicted decrease for a step size.
    pub(super) fn at(self, step_size: f64) -> f64 {
        -step_size * (self.slope + 0.5 * step_size * self.curvature)
    }
}

/// The backward pass, with its buffers.
pub(super) struct Backward {
    nx: usize,
    nu: usize,
    /// Expansions of the cost of each step, and of the terminal cost.
    expansions: Vec<CostExpansion>,
    range: Vec<[f64; 2]>,
    solver: BoxQp,
    backup: BellmanBackup,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    gain: DMatrix<f64>,
    /// Gradients of the cost to go, after and before the step.
    gradient: DVector<f64>,
    previous_gradient: DVector<f64>,
    buffers: StepBuffers,
}

/// Buffers for one step of the backward pass.
struct StepBuffers {
    /// Gradient of the cost to go with respect to the controls.
    u: DVector<f64>,
    /// Regularised Hessians of the cost to go.
    uu: DMatrix<f64>,
    ux: DMatrix<f64>,
    /// `Bᵀ` times the regularisation.
    b_transpose: DMatrix<f64>,
    /// Bounds of the change of the controls.
    lower: Vec<f64>,
    upper: Vec<f64>,
    feedforward: DVector<f64>,
    /// The Hessian times the feedforward.
    curved: DVector<f64>,
    /// Column of the gain, restricted to the controls that are not at a bound.
    column: Vec<f64>,
}

impl Backward {
    pub(super) fn new(model: &Model, steps: usize) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self {
            nx,
            nu,
            expansions: vec![CostExpansion::zeros(model); steps + 1],
            range: (0..nu).map(|index| control_range(model, index)).collect(),
            solver: BoxQp::new(nu),
            backup: BellmanBackup::new(DMatrix::zeros(nx, nx), nu),
            a: DMatrix::zeros(nx, nx),
            b: DMatrix::zeros(nx, nu),
            gain: DMatrix::zeros(nu, nx),
            gradient: DVector::zeros(nx),
            previous_gradient: DVector::zeros(nx),
            buffers: StepBuffers {
                u: DVector::zeros(nu),
                uu: DMatrix::zeros(nu, nu),
                ux: DMatrix::zeros(nu, nx),
                b_transpose: DMatrix::zeros(nu, nx),
                lower: vec![0.0; nu],
                upper: vec![0.0; nu],
                feedforward: DVector::zeros(nu),
                curved: DVector::zeros(nu),
                column: Vec::with_capacity(nu),
            },
        }
    }

    /// Takes the control ranges of an edited model.
    pub(super) fn adopt_ranges(&mut self, model: &Model) {
        for (index, range) in self.range.iter_mut().enumerate() {
            *range = control_range(model, index);
        }
    }

    /// Expands the cost along a trajectory, in up to `threads` threads. If several steps fail, returns the error of the first one.
    pub(super) fn expand(&mut self, nominal: &Trial, cost: &dyn TrajectoryCost, threads: usize) -> Result<()> {
        let steps = nominal.controls.nrows();
        let (nx, nu) = (self.nx, self.nu);
        // The threads have no state, so the vector does not allocate.
        for_each_item(&mut vec![(); threads], &mut self.expansions, |(), step, expansion| {
            let controls = (step < steps).then(|| nominal.controls.row(step));
            expansion.clear();
            cost.expand(step, nominal.states.row(step), controls, expansion)?;
            expansion.check(step, nx, nu)
        })
    }

    /// Computes the policy that minimises the expanded cost, and the decrease that it predicts. Returns `None` if the expanded
    /// cost is unbounded below in some step.
    pub(super) fn solve(
        &mut self,
        systems: &[(StateSpace, LinearisationReport)],
        nominal: &Trial,
        regularisation: f64,
        policy: &mut AffinePolicy,
    ) -> Result<Option<PredictedDecrease>> {
        let Self { expansions, range, solver, backup, a, b, gain, gradient, previous_gradient, .. } = self;
        let StepBuffers { u, uu, ux, b_transpose, lower, upper, feedforward, curved, column } = &mut self.buffers;
        let (terminal, steps) = expansions.split_last().expect("Bug: no expansion of the terminal cost");
        backup.reset(&terminal.xx);
        gradient.copy_from(&terminal.x);
        let mut decrease = PredictedDecrease::default();
        for (step, expansion) in steps.iter().enumerate().rev() {
            let system = &systems[step].0;
            system.a.transposed().transpose_to(a);
            system.b.transposed().transpose_to(b);
            // Most costs have no mixed terms. Two products of matrices are then omitted.
            let is_mixed = expansion.xu.iter().any(|&value| value != 0.0);
            let cost = StepCost { q: &expansion.xx, r: &expansion.uu, s: is_mixed.then_some(&expansion.xu) };
            backup.expand(a, b, cost);
            u.copy_from(&expansion.u);
            u.gemv_tr(1.0, b, gradient, 1.0);
            previous_gradient.copy_from(&expansion.x);
            previous_gradient.gemv_tr(1.0, a, gradient, 1.0);

            // The regularisation penalises changes of the next state, like an additional cost of the state.
            uu.copy_from(&backup.uu);
            ux.copy_from(&backup.ux);
            if regularisation > 0.0 {
                b.transpose_to(b_transpose);
                *b_transpose *= regularisation;
                uu.gemm(1.0, b_transpose, b, 1.0);
                ux.gemm(1.0, b_transpose, a, 1.0);
            }
            let controls = nominal.controls.row(step);
            for (index, (control, [low, high])) in controls.iter().zip(&*range).enumerate() {
                (lower[index], upper[index]) = (low - control, high - control);
            }
            // The feedforward of the previous iteration is the initial guess.
            let change = policy.feedforward.row_mut(step);
            let hessian = MatrixView::from_row_major(self.nu, self.nu, uu.as_slice());
            let solution =
                solver.solve(change, hessian, u.as_slice(), Some(lower.as_slice()), Some(upper.as_slice()))?;
            if solution.status == BoxQpStatus::NotPositiveDefinite {
                change.fill(0.0);
                return Ok(None);
            }
            gain.fill(0.0);
            column.clear();
            column.resize(solution.index.len(), 0.0);
            for state in 0..self.nx {
                column.iter_mut().zip(solution.index).for_each(|(entry, &free)| *entry = ux[(free, state)]);
                chol_solve_in_place(solution.factor, column)?;
                column.iter().zip(solution.index).for_each(|(entry, &free)| gain[(free, state)] = *entry);
            }

            feedforward.copy_from_slice(change);
            curved.gemm(1.0, &backup.uu, feedforward, 0.0);
            decrease.slope += feedforward.dot(u);
            decrease.curvature += feedforward.dot(curved);
            // Gradient of the expansion about the change, with du = feedforward − K dx.
            *curved += &*u;
            previous_gradient.gemv_tr(1.0, &backup.ux, feedforward, 1.0);
            previous_gradient.gemv_tr(-1.0, gain, curved, 1.0);
            std::mem::swap(gradient, previous_gradient);
            backup.close(a, b, cost, gain);
            gain.transpose_to(&mut policy.gains[step].transposed_mut());
        }
        Ok(Some(decrease))
    }
}
