//! A step in the window of a smoother.

use crate::estimation::update::Correction;
use crate::matrix::Matrix;

/// State of a step, with what is known about it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// Point of linearisation: the estimate, `[qpos; qvel; act]`, and that of the inputs of the
    /// step.
    pub(super) state: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    /// The point of linearisation of the iteration before.
    pub(super) previous_state: Vec<f64>,
    pub(super) previous_inputs: Vec<f64>,
    /// `(nx, nx)`: covariance of the error of the estimate.
    pub(super) covariance: Matrix,
    /// Prediction of the filter before the readings.
    pub(super) prior_state: Vec<f64>,
    pub(super) prior_covariance: Matrix,
    /// Inputs. A reading that was not used is NaN.
    pub(super) controls: Vec<f64>,
    pub(super) readings: Vec<f64>,
    pub(super) has_readings: bool,
    /// `(ny, nz)`: derivatives of the readings.
    pub(super) output: Matrix,
    /// `(nz, nx)`: transposed derivative of the next state.
    pub(super) transition: Matrix,
    /// Deviation from the point of linearisation, with its correction by the readings, and its
    /// covariance `(nz, nz)`: after the readings up to this step, then after all readings.
    pub(super) correction: Correction,
    pub(super) joint: Matrix,
}

impl Step {
    /// Creates buffers for a state of `state` numbers, and `[nx, nn, nu, ny]` coordinates, inputs,
    /// controls and readings.
    pub(super) fn new(state: usize, [nx, nn, nu, ny]: [usize; 4]) -> Self {
        let nz = nx + nn;
        Self {
            state: vec![0.0; state],
            inputs: vec![0.0; nn],
            previous_state: vec![0.0; state],
            previous_inputs: vec![0.0; nn],
            covariance: Matrix::zeros(nx, nx),
            prior_state: vec![0.0; state],
            prior_covariance: Matrix::zeros(nx, nx),
            controls: vec![0.0; nu],
            readings: vec![f64::NAN; ny],
            has_readings: false,
            output: Matrix::zeros(ny, nz),
            transition: Matrix::zeros(nz, nx),
            correction: Correction::new(nz, ny),
            joint: Matrix::zeros(nz, nz),
        }
    }
}
