//! The backward pass: the affine control policy that minimises the expanded cost.

use nalgebra::DVector;

use super::cost::{CostExpansion, TrajectoryCost};
use super::forward::Trial;
use super::policy::{AffinePolicy, PredictedDecrease};
use crate::control::feedback::control_range;
use crate::control::riccati::{BellmanBackup, StepCost};
use crate::derivative::{self, LinearisationReport, StateSpace};
use crate::error::Result;
use crate::math::{BoxQp, BoxQpStatus};
use crate::matrix::{Matrix, MatrixView};
use crate::model::Model;
use crate::numerics::linear_algebra::add;
use crate::numerics::vectorised;
use crate::parallel::for_each_item;

/// The backward pass, with its buffers.
pub(super) struct Backward {
    nx: usize,
    nu: usize,
    /// Expansions of the cost of each step, and of the terminal cost.
    expansions: Vec<CostExpansion>,
    range: Vec<[f64; 2]>,
    solver: BoxQp,
    backup: BellmanBackup,
    /// Gradients of the cost to go, after and before the step.
    gradient: DVector<f64>,
    previous_gradient: DVector<f64>,
    buffers: StepBuffers,
}

/// Buffers for one step of the backward pass.
struct StepBuffers {
    /// Gradient of the cost to go with respect to the controls.
    u: DVector<f64>,
    /// Regularised Hessian of the cost to go with respect to the controls.
    uu: Matrix,
    /// Bounds of the change of the controls.
    lower: Vec<f64>,
    upper: Vec<f64>,
    feedforward: DVector<f64>,
    /// Change of the next state by the feedforward.
    change: DVector<f64>,
    /// Hessians times the feedforward, and times the change of the next state.
    curved: DVector<f64>,
    curved_next: DVector<f64>,
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
            backup: BellmanBackup::new(),
            gradient: DVector::zeros(nx),
            previous_gradient: DVector::zeros(nx),
            buffers: StepBuffers {
                u: DVector::zeros(nu),
                uu: Matrix::zeros(nu, nu),
                lower: vec![0.0; nu],
                upper: vec![0.0; nu],
                feedforward: DVector::zeros(nu),
                change: DVector::zeros(nx),
                curved: DVector::zeros(nu),
                curved_next: DVector::zeros(nx),
            },
        }
    }

    /// Takes the control ranges of an edited model.
    pub(super) fn adopt_ranges(&mut self, model: &Model) {
        for (index, range) in self.range.iter_mut().enumerate() {
            *range = control_range(model, index);
        }
    }

    /// Expands the cost along a trajectory, in up to `threads` threads. If several steps fail,
    /// returns the error of the first one.
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

    /// Computes the policy that minimises the expanded cost, and the decrease that it predicts.
    /// Returns `None` if the expanded cost is unbounded below in some step.
    pub(super) fn solve(
        &mut self,
        systems: &[(StateSpace, LinearisationReport)],
        nominal: &Trial,
        regularisation: f64,
        policy: &mut AffinePolicy,
    ) -> Result<Option<PredictedDecrease>> {
        let Self { expansions, range, solver, backup, gradient, previous_gradient, .. } = self;
        let StepBuffers { u, uu, lower, upper, feedforward, change, curved, curved_next } = &mut self.buffers;
        let (terminal, steps) = expansions.split_last().expect("Bug: no expansion of the terminal cost");
        let simd = backup.simd;
        backup.restart(&terminal.xx);
        gradient.copy_from_slice(&terminal.x);
        let mut decrease = PredictedDecrease::default();
        for (step, expansion) in steps.iter().enumerate().rev() {
            let system = &systems[step].0;
            // Most costs have no mixed terms. Two products of matrices are then omitted.
            let is_mixed = expansion.xu.as_slice().iter().any(|&value| value != 0.0);
            let cost = StepCost { q: &expansion.xx, r: &expansion.uu, s: is_mixed.then_some(&expansion.xu) };
            // The regularisation penalises changes of the next state.
            backup.expand(system.a.view(), system.b.view(), cost, regularisation);
            u.copy_from_slice(&expansion.u);
            backup.b.add_transposed_times(simd, gradient.as_slice(), u.as_mut_slice());

            for (index, row) in uu.as_mut_slice().chunks_exact_mut(self.nu.max(1)).enumerate() {
                backup.uu.row_into(index, row);
            }
            let controls = nominal.controls.row(step);
            for (index, (control, [low, high])) in controls.iter().zip(&*range).enumerate() {
                (lower[index], upper[index]) = (low - control, high - control);
            }
            // The feedforward of the previous iteration is the initial guess.
            let feedforward_row = policy.feedforward.row_mut(step);
            let solution =
                solver.solve(feedforward_row, &*uu, u.as_slice(), Some(lower.as_slice()), Some(upper.as_slice()))?;
            if solution.status == BoxQpStatus::NotPositiveDefinite {
                feedforward_row.fill(0.0);
                return Ok(None);
            }
            let gain = &mut policy.gains[step];
            gain.as_mut_slice().fill(0.0);
            for &free in solution.index {
                backup.ux.row_into(free, gain.row_mut(free));
            }
            solve_rows(solution.factor, solution.index, gain);
            backup.k.copy_rows(self.nu, self.nx, gain.as_slice());

            feedforward.copy_from_slice(feedforward_row);
            change.gemv_tr(1.0, &system.b.transposed(), feedforward, 0.0);
            curved_next.fill(0.0);
            backup.p.add_transposed_times(simd, change.as_slice(), curved_next.as_mut_slice());
            curved.fill(0.0);
            backup.r.add_transposed_times(simd, feedforward.as_slice(), curved.as_mut_slice());
            decrease.slope += feedforward.dot(u);
            decrease.curvature += feedforward.dot(curved) + change.dot(curved_next);

            // Gradient of the expansion about the feedforward, with du = feedforward − K dx.
            *gradient += &*curved_next;
            add(curved.as_mut_slice(), &expansion.u, 1.0);
            backup.b.add_transposed_times(simd, gradient.as_slice(), curved.as_mut_slice());
            previous_gradient.copy_from_slice(&expansion.x);
            backup.a.add_transposed_times(simd, gradient.as_slice(), previous_gradient.as_mut_slice());
            if is_mixed {
                previous_gradient.gemv_tr(1.0, &expansion.xu.transposed(), feedforward, 1.0);
            }
            curved.neg_mut();
            backup.k.add_transposed_times(simd, curved.as_slice(), previous_gradient.as_mut_slice());
            std::mem::swap(gradient, previous_gradient);
            backup.close(cost);
        }
        Ok(Some(decrease))
    }
}

vectorised! {
/// Replaces rows of a matrix by the solution `X` of `L Lᵀ X = rows`, with one row for each of the
/// increasing indices. The factor `L` is lower triangular.
fn solve_rows(factor: MatrixView<'_>, index: &[usize], matrix: &mut Matrix) {
    let width = matrix.ncols();
    let values = matrix.as_mut_slice();
    for (count, &row) in index.iter().enumerate() {
        let (known, rest) = values.split_at_mut(row * width);
        let coefficients = factor.row(count);
        for (&other, &coefficient) in index[..count].iter().zip(coefficients) {
            add(&mut rest[..width], &known[other * width..][..width], -coefficient);
        }
        for value in &mut rest[..width] {
            *value /= coefficients[count];
        }
    }
    for (count, &row) in index.iter().enumerate().rev() {
        let (rest, known) = values.split_at_mut((row + 1) * width);
        let solved = &mut rest[row * width..];
        for (other, &later) in index.iter().enumerate().skip(count + 1) {
            add(solved, &known[(later - row - 1) * width..][..width], -factor.row(other)[count]);
        }
        for value in solved {
            *value /= factor.row(count)[count];
        }
    }
}
}
