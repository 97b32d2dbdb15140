//! From the end to the beginning: how to change the controls.

use nalgebra::{DMatrix, DVector};

use super::cost::{CostExpansion, TrajectoryCost};
use super::forward::Trial;
use crate::control::feedback::control_range;
use crate::control::riccati::{Backup, StepCost};
use crate::derivative::{self, LinearisationReport, StateSpace};
use crate::error::Result;
use crate::math::{BoxQp, BoxQpStatus, chol_solve_in_place};
use crate::matrix::{Matrix, MatrixView};
use crate::model::Model;

/// How to change the controls: `ctrl = controls + α feedforward − K dx`.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// `(N, nu)`
    pub(super) feedforward: Matrix,
    /// `N` of them, each `(nu, nx)`.
    pub(super) gains: Vec<Matrix>,
}

impl Plan {
    /// No change.
    pub(super) fn zeros(model: &Model, steps: usize) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self { feedforward: Matrix::zeros(steps, nu), gains: vec![Matrix::zeros(nu, nx); steps] }
    }
}

/// By how much a plan lowers the cost, as far as the expansion to second order goes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Promise {
    slope: f64,
    curvature: f64,
}

impl Promise {
    /// With this part of the feedforward.
    pub(super) fn at(self, part: f64) -> f64 {
        -part * (self.slope + 0.5 * part * self.curvature)
    }
}

/// The pass backwards in time, and what it needs.
pub(super) struct Backward {
    nx: usize,
    nu: usize,
    /// One for each step, and one of the end.
    expansions: Vec<CostExpansion>,
    range: Vec<[f64; 2]>,
    solver: BoxQp,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    gain: DMatrix<f64>,
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
            a: DMatrix::zeros(nx, nx),
            b: DMatrix::zeros(nx, nu),
            gain: DMatrix::zeros(nu, nx),
        }
    }

    /// Expands the cost along a trajectory.
    pub(super) fn expand(&mut self, nominal: &Trial, cost: &dyn TrajectoryCost) -> Result<()> {
        let steps = nominal.controls.nrows();
        for (step, expansion) in self.expansions.iter_mut().enumerate() {
            let controls = (step < steps).then(|| nominal.controls.row(step));
            expansion.clear();
            cost.expand(step, nominal.states.row(step), controls, expansion);
            expansion.check(step, self.nx, self.nu)?;
        }
        Ok(())
    }

    /// Finds the change of controls that costs the least, and what it promises; nothing if there is no such change in some step,
    /// because the cost falls without end.
    pub(super) fn plan(
        &mut self,
        systems: &[(StateSpace, LinearisationReport)],
        nominal: &Trial,
        regularisation: f64,
        plan: &mut Plan,
    ) -> Result<Option<Promise>> {
        let (end, steps) = self.expansions.split_last().expect("Bug: no expansion of the end");
        let mut backup = Backup::new(end.xx.clone(), self.nu);
        let mut gradient = end.x.clone();
        let mut promise = Promise::default();
        for (step, expansion) in steps.iter().enumerate().rev() {
            let system = &systems[step].0;
            system.a.transposed().transpose_to(&mut self.a);
            system.b.transposed().transpose_to(&mut self.b);
            let cost = StepCost { q: &expansion.xx, r: &expansion.uu, s: Some(&expansion.xu) };
            backup.expand(&self.a, &self.b, cost);
            let by_controls = &expansion.u + self.b.tr_mul(&gradient);
            let by_state = &expansion.x + self.a.tr_mul(&gradient);

            // Regularised as if the states cost more: what changes them is held back.
            let mut uu = backup.uu.clone();
            let mut ux = backup.ux.clone();
            if regularisation > 0.0 {
                let b_transpose = self.b.transpose() * regularisation;
                uu.gemm(1.0, &b_transpose, &self.b, 1.0);
                ux.gemm(1.0, &b_transpose, &self.a, 1.0);
            }
            let controls = nominal.controls.row(step);
            let bound = |end: usize| -> Vec<f64> {
                controls.iter().zip(&self.range).map(|(control, range)| range[end] - control).collect()
            };
            let feedforward = plan.feedforward.row_mut(step);
            // What was found before is a good place to begin.
            let hessian = MatrixView::from_row_major(self.nu, self.nu, uu.as_slice());
            let solution =
                self.solver.solve(feedforward, hessian, by_controls.as_slice(), Some(&bound(0)), Some(&bound(1)))?;
            if solution.status == BoxQpStatus::NotPositiveDefinite {
                feedforward.fill(0.0);
                return Ok(None);
            }
            self.gain.fill(0.0);
            let mut column = vec![0.0; solution.index.len()];
            for state in 0..self.nx {
                column.iter_mut().zip(solution.index).for_each(|(entry, &free)| *entry = ux[(free, state)]);
                chol_solve_in_place(solution.factor, &mut column)?;
                column.iter().zip(solution.index).for_each(|(entry, &free)| self.gain[(free, state)] = *entry);
            }

            let feedforward = DVector::from_column_slice(feedforward);
            let curved = &backup.uu * &feedforward;
            promise.slope += feedforward.dot(&by_controls);
            promise.curvature += feedforward.dot(&curved);
            // From the expansion about the change, with du = feedforward − K dx.
            gradient = by_state + backup.ux.tr_mul(&feedforward) - self.gain.tr_mul(&(by_controls + curved));
            backup.close(&self.a, &self.b, cost, &self.gain);
            self.gain.transpose_to(&mut plan.gains[step].transposed_mut());
        }
        Ok(Some(promise))
    }
}
