//! The quadratic function of the tasks of one priority.

use super::Task;
use super::constraints::Constraints;
use crate::control::residual::{Needs, ResidualJacobian};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::add;
use crate::numerics::vectorised;

#[derive(Debug)]
pub(super) struct Objective {
    /// `(nv, nv)`: upper triangle of the matrix.
    pub(super) matrix: Matrix,
    /// `(nv)`
    pub(super) gradient: Vec<f64>,
    pub(super) jacobian: ResidualJacobian,
    /// Damping of the displacement, relative to the mean diagonal of the matrix.
    pub(super) regularisation: f64,
}

impl Objective {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        Self {
            matrix: Matrix::zeros(nv, nv),
            gradient: vec![0.0; nv],
            jacobian: ResidualJacobian::zeros(model, 0),
            regularisation: 1e-9,
        }
    }

    /// Returns the results of the pipeline that the tasks need.
    pub(super) fn needs(tasks: &[Task]) -> Needs {
        let needs = tasks.iter().filter(|task| task.weight != 0.0).map(|task| task.residual.needs());
        needs.max().unwrap_or(Needs::State)
    }

    /// Computes the matrix and the gradient for a displacement in the time `dt`. The damping is
    /// relative to the weighted square of the residuals. Adds the rows of the Jacobians to the
    /// equations for lower priorities, if there are any.
    pub(super) fn assemble(
        &mut self,
        tasks: &mut [Task],
        priority: u32,
        data: &mut Data,
        dt: f64,
        damping: f64,
        mut equations: Option<&mut Constraints>,
    ) -> Result<()> {
        let nv = self.gradient.len();
        self.matrix.as_mut_slice().fill(0.0);
        self.gradient.fill(0.0);
        let mut diagonal = 0.0;
        let weighted = |task: &&mut Task| task.priority == priority && task.weight != 0.0;
        for (index, task) in tasks.iter_mut().enumerate().filter(|(_, task)| weighted(task)) {
            task.check(index)?;
            task.residual.evaluate(data, &mut task.error)?;
            let what = |component| format!("component {component} of the residual of task {index}");
            Error::check_finite(&task.error, what)?;
            self.jacobian.clear(task.error.len());
            task.residual.differentiate(data, &mut self.jacobian)?;
            let range = if task.is_rate { nv..2 * nv } else { 0..nv };
            let mut square = 0.0;
            for (component, (&error, &factor)) in task.error.iter().zip(&task.weights).enumerate() {
                let weight = task.weight * factor;
                if weight == 0.0 {
                    continue;
                }
                let row = &self.jacobian.row(component)[range.clone()];
                if let Some(equations) = &mut equations {
                    equations.push(row);
                }
                if task.is_rate {
                    // The part of the residual that does not depend on the velocity.
                    let constant = error - row.iter().zip(data.qvel()).map(|(row, rate)| row * rate).sum::<f64>();
                    add_square(&mut self.matrix, &mut self.gradient, row, weight / (dt * dt), weight * constant / dt);
                } else {
                    add_square(&mut self.matrix, &mut self.gradient, row, weight, weight * task.gain * error);
                    square += weight * error * error;
                }
            }
            diagonal += task.damping * square + damping * square;
        }
        let mean = (0..nv).map(|dof| self.matrix[(dof, dof)]).sum::<f64>() / nv.max(1) as f64;
        diagonal += self.regularisation * mean;
        if mean == 0.0 {
            diagonal = 1.0;
        }
        (0..nv).for_each(|dof| self.matrix[(dof, dof)] += diagonal);
        Ok(())
    }
}

/// Adds the matrix and the gradient of `½ weight (row x)² + slope row x`.
fn add_square(matrix: &mut Matrix, gradient: &mut [f64], row: &[f64], weight: f64, slope: f64) {
    let Some(first) = row.iter().position(|&value| value != 0.0) else { return };
    let end = row.iter().rposition(|&value| value != 0.0).map_or(first, |last| last + 1);
    add_outer(matrix.as_mut_slice(), gradient, &row[first..end], first, weight, slope);
}

vectorised! {
/// Adds the outer product of a part of a row, which begins at the entry `first`, to the upper
/// triangle of a matrix.
fn add_outer(matrix: &mut [f64], gradient: &mut [f64], part: &[f64], first: usize, weight: f64, slope: f64) {
    let n = gradient.len();
    add(&mut gradient[first..first + part.len()], part, slope);
    for (index, &value) in part.iter().enumerate() {
        if value != 0.0 {
            let row = (first + index) * n;
            add(&mut matrix[row + first + index..row + first + part.len()], &part[index..], weight * value);
        }
    }
}
}
