//! Columns of derivatives, one for each parameter, and gradients, one number for each.

use super::sink::Sink;
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
    /// False if ∂g is differenced.
    pub(super) has_residual: bool,
}

impl Sink for Column<'_> {
    fn residual(&mut self, dof: usize, value: f64) {
        if self.has_residual {
            self.columns.residual[(dof, self.index)] += value;
        }
    }

    fn spread(&mut self, dof: usize, value: f64) {
        self.columns.spread[(dof, self.index)] += value;
    }

    fn activation(&mut self, activation: usize, value: f64) {
        self.columns.activation[(activation, self.index)] += value;
    }

    fn sensor(&mut self, address: usize, value: f64) {
        self.columns.reading[(address, self.index)] += value;
    }
}

/// Derivative of a number whose gradients by all terms are known.
pub(super) struct Product<'a> {
    /// μ
    pub(super) residual: &'a [f64],
    /// `h η`
    pub(super) spread: &'a [f64],
    pub(super) activation: &'a [f64],
    /// ζ, empty without sensors.
    pub(super) sensor: &'a [f64],
    pub(super) sum: f64,
}

impl Sink for Product<'_> {
    fn residual(&mut self, dof: usize, value: f64) {
        self.sum -= self.residual[dof] * value;
    }

    fn spread(&mut self, dof: usize, value: f64) {
        self.sum += self.spread[dof] * value;
    }

    fn activation(&mut self, activation: usize, value: f64) {
        self.sum += self.activation[activation] * value;
    }

    fn sensor(&mut self, address: usize, value: f64) {
        self.sum += self.sensor[address] * value;
    }
}
