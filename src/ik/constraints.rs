//! Constraints of the displacement: equations, which are the closed chains of the model and the
//! tasks of higher priorities, then inequalities.

use mujoco_sys::mjCNSTR_EQUALITY;

use super::inequality::Inequality;
use super::limit::Limit;
use crate::data::Data;
use crate::derivative::newton::add_row;
use crate::error::Result;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{add, dot};

/// A row whose part outside of the space of the others is below this fraction of its length depends
/// on them.
const DEPENDENT: f64 = 1e-7;
/// Half the width of the equations of higher priorities, relative to `1 + |x|`.
const SLACK: f64 = 1e-10;

#[derive(Debug)]
pub(super) struct Constraints {
    /// `(capacity + inequalities, nv)`. Those of the equations are orthonormal.
    pub(super) rows: Matrix,
    /// Limits of each row. Equations without limits have no effect.
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) causes: Vec<Limit>,
    /// Largest number of equations, and the present one.
    pub(super) capacity: usize,
    count: usize,
    /// Largest violation of an equality constraint of the model.
    pub(super) violation: f64,
    /// `(nv)`
    row: Vec<f64>,
    /// `(3, nv)`: Jacobians of the nearest points of a pair.
    buffers: [Matrix; 2],
}

impl Constraints {
    pub(super) fn new(capacity: usize, inequalities: &[Inequality], nv: usize) -> Self {
        let mut causes = vec![Limit::Equation; capacity];
        causes.extend(inequalities.iter().map(|inequality| inequality.cause()));
        Self {
            rows: Matrix::zeros(causes.len(), nv),
            lower: vec![f64::NEG_INFINITY; causes.len()],
            upper: vec![f64::INFINITY; causes.len()],
            causes,
            capacity,
            count: 0,
            violation: 0.0,
            row: vec![0.0; nv],
            buffers: [Matrix::zeros(3, nv), Matrix::zeros(3, nv)],
        }
    }

    /// Writes the equality constraints of the model and the inequalities at the present position.
    pub(super) fn start(&mut self, inequalities: &[Inequality], data: &mut Data) -> Result<()> {
        (self.count, self.violation) = (0, 0.0);
        self.lower[..self.capacity].fill(f64::NEG_INFINITY);
        self.upper[..self.capacity].fill(f64::INFINITY);
        let rows = if data.model().neq() > 0 { data.nefc() } else { 0 };
        for index in (0..rows).filter(|&row| data.efc_type()[row] as u32 == mjCNSTR_EQUALITY) {
            let violation = data.efc_pos()[index];
            self.violation = self.violation.max(violation.abs());
            self.row.fill(0.0);
            add_row(data, index, 1.0, &mut self.row);
            self.push_row(Some(-violation));
        }
        for (index, inequality) in (self.capacity..).zip(inequalities) {
            let row = self.rows.row_mut(index);
            row.fill(0.0);
            [self.lower[index], self.upper[index]] = inequality.write(data, &mut self.buffers, row)?;
        }
        Ok(())
    }

    /// Adds the row of an equation, unless it depends on earlier ones. It has no effect before
    /// [`hold`](Self::hold).
    pub(super) fn push(&mut self, row: &[f64]) {
        self.row.copy_from_slice(row);
        self.push_row(None);
    }

    /// Gram–Schmidt, twice, so that the rows are orthogonal up to rounding.
    fn push_row(&mut self, right: Option<f64>) {
        let length = norm(&self.row);
        if self.count == self.capacity || length == 0.0 {
            return;
        }
        let mut known = 0.0;
        for _ in 0..2 {
            for (other, value) in self.rows.rows().zip(&self.lower).take(self.count) {
                let part = dot(other, &self.row);
                add(&mut self.row, other, -part);
                known += part * value;
            }
        }
        let rest = norm(&self.row);
        if rest <= DEPENDENT * length || !rest.is_finite() {
            return;
        }
        let target = self.rows.row_mut(self.count);
        target.iter_mut().zip(&self.row).for_each(|(target, value)| *target = value / rest);
        if let Some(right) = right {
            let value = (right - known) / rest;
            (self.lower[self.count], self.upper[self.count]) = (value, value);
        }
        self.count += 1;
    }

    /// Requires the displacement in all directions of the equations, and widens the other limits so
    /// that they contain it despite rounding.
    pub(super) fn hold(&mut self, displacement: &[f64]) {
        let largest = displacement.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
        let slack = SLACK * (1.0 + largest);
        let limits = self.lower.iter_mut().zip(&mut self.upper);
        for (index, (row, (lower, upper))) in self.rows.rows().zip(limits).enumerate() {
            let value = dot(row, displacement);
            (*lower, *upper) =
                if index < self.count { (value - slack, value + slack) } else { (lower.min(value), upper.max(value)) };
        }
    }

    /// Returns `false` if the limits of an equation exceeded the range of `f64`.
    pub(super) fn is_finite(&self) -> bool {
        let mut limits = self.lower.iter().zip(&self.upper).take(self.count);
        limits.all(|(lower, upper)| *lower < f64::INFINITY && *upper > f64::NEG_INFINITY)
    }

    /// No longer asks pairs that are too near to move apart, and tendons outside of their ranges to
    /// return, and reports them. Returns `false` if there are none.
    pub(super) fn relax(&mut self, conflicts: &mut Vec<Limit>) -> bool {
        let before = conflicts.len();
        for row in self.capacity..self.lower.len() {
            let (lower, upper) = (&mut self.lower[row], &mut self.upper[row]);
            if *lower > 0.0 || *upper < 0.0 {
                (*lower, *upper) = (lower.min(0.0), upper.max(0.0));
                conflicts.push(self.causes[row]);
            }
        }
        conflicts.len() > before
    }
}

fn norm(row: &[f64]) -> f64 {
    dot(row, row).sqrt()
}
