//! Equations of the displacement: the closed chains of the model, and the tasks of higher
//! priorities.

use mujoco_sys::mjCNSTR_EQUALITY;

use crate::data::Data;
use crate::derivative::newton::add_row;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{add, dot};

/// A row whose part outside of the space of the others is below this fraction of its length depends
/// on them.
const DEPENDENT: f64 = 1e-7;

/// Independent equations, with orthonormal rows.
#[derive(Debug)]
pub(super) struct Equations {
    /// `(capacity, nv)`
    rows: Matrix,
    /// `(capacity)`
    right: Vec<f64>,
    count: usize,
    /// `(nv)`
    row: Vec<f64>,
    /// Largest violation of an equality constraint of the model.
    pub(super) violation: f64,
}

impl Equations {
    pub(super) fn new(capacity: usize, nv: usize) -> Self {
        Self {
            rows: Matrix::zeros(capacity, nv),
            right: vec![0.0; capacity],
            count: 0,
            row: vec![0.0; nv],
            violation: 0.0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.violation = 0.0;
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn capacity(&self) -> usize {
        self.right.len()
    }

    /// Returns the rows and the right-hand sides.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&[f64], f64)> {
        self.rows.rows().zip(self.right.iter().copied()).take(self.count)
    }

    /// Adds the row of an equation, unless it depends on earlier ones. [`hold`](Self::hold) sets
    /// the right-hand side.
    pub(super) fn push(&mut self, row: &[f64]) {
        self.row.copy_from_slice(row);
        self.push_row(0.0);
    }

    /// Sets the right-hand sides to those of a displacement, so that it fulfils the equations up to
    /// rounding.
    pub(super) fn hold(&mut self, displacement: &[f64]) {
        for (right, row) in self.right.iter_mut().zip(self.rows.rows()).take(self.count) {
            *right = dot(row, displacement);
        }
    }

    /// Gram–Schmidt, twice, so that the rows are orthogonal up to rounding.
    fn push_row(&mut self, mut right: f64) {
        let length = norm(&self.row);
        if self.count == self.right.len() || length == 0.0 {
            return;
        }
        for _ in 0..2 {
            for (other, value) in self.rows.rows().zip(&self.right).take(self.count) {
                let part = dot(other, &self.row);
                add(&mut self.row, other, -part);
                right -= part * value;
            }
        }
        let rest = norm(&self.row);
        if rest <= DEPENDENT * length || !rest.is_finite() {
            return;
        }
        let target = self.rows.row_mut(self.count);
        target.iter_mut().zip(&self.row).for_each(|(target, value)| *target = value / rest);
        self.right[self.count] = right / rest;
        self.count += 1;
    }

    /// Adds the equality constraints of the model at the present position.
    pub(super) fn push_constraints(&mut self, data: &Data) {
        for index in 0..data.nefc() {
            if data.efc_type()[index] as u32 == mjCNSTR_EQUALITY {
                let violation = data.efc_pos()[index];
                self.violation = self.violation.max(violation.abs());
                self.row.fill(0.0);
                add_row(data, index, 1.0, &mut self.row);
                self.push_row(-violation);
            }
        }
    }
}

fn norm(row: &[f64]) -> f64 {
    dot(row, row).sqrt()
}
