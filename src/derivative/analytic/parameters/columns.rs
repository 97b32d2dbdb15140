//! Columns of derivatives, one for each parameter.

use crate::matrix::Matrix;
use crate::model::Model;

/// Derivatives with a column for each parameter.
#[derive(Debug, Default)]
pub(in crate::derivative) struct Columns {
    /// `(nv, n)`: ∂g, then X, then ∂v'.
    pub(in crate::derivative) residual: Matrix,
    /// `(nv, n)`: ∂M w + h ∂Q s.
    pub(in crate::derivative) spread: Matrix,
    /// `(nv, n)`: X, if sensors are wanted.
    pub(in crate::derivative) deceleration: Matrix,
    /// `(na, n)`: derivatives of the next activations.
    pub(in crate::derivative) activation: Matrix,
    /// `(nsensordata, n)`: derivatives of the readings, first at constant accelerations.
    pub(in crate::derivative) reading: Matrix,
}

impl Columns {
    /// Gives the matrices a column of zeros for each parameter.
    pub(super) fn clear(&mut self, model: &Model, count: usize, wants_sensors: bool) {
        let (nv, na) = (model.nv(), model.na());
        let [readings, decelerations] = [model.nsensordata(), nv].map(|rows| if wants_sensors { rows } else { 0 });
        for (matrix, rows) in [
            (&mut self.residual, nv),
            (&mut self.spread, nv),
            (&mut self.deceleration, decelerations),
            (&mut self.activation, na),
            (&mut self.reading, readings),
        ] {
            if matrix.shape() == (rows, count) {
                matrix.as_mut_slice().fill(0.0);
            } else {
                *matrix = Matrix::zeros(rows, count);
            }
        }
    }
}

/// One of the columns.
pub(super) struct Column<'a> {
    pub(super) columns: &'a mut Columns,
    pub(super) index: usize,
}

impl Column<'_> {
    /// Adds to ∂g.
    pub(super) fn residual(&mut self, dof: usize, value: f64) {
        self.columns.residual[(dof, self.index)] += value;
    }

    /// Adds to `∂M w + h ∂Q s`.
    pub(super) fn spread(&mut self, dof: usize, value: f64) {
        self.columns.spread[(dof, self.index)] += value;
    }

    /// Adds to the derivative of a next activation.
    pub(super) fn activation(&mut self, activation: usize, value: f64) {
        self.columns.activation[(activation, self.index)] += value;
    }

    /// Adds to the derivative of a reading at constant accelerations.
    pub(super) fn sensor(&mut self, address: usize, value: f64) {
        self.columns.reading[(address, self.index)] += value;
    }
}
