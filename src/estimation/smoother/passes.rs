//! The forward and the backward pass over a window, about a trajectory.

use super::step::Step;
use crate::error::Result;
use crate::estimation::covariance;
use crate::estimation::filter::ExtendedKalmanFilter;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{add, dot};

/// Buffers of the passes.
#[derive(Debug)]
pub(super) struct Passes {
    /// `(nz, nz)`
    work: Matrix,
    zeros: Matrix,
    /// `(nx, nx)`
    predicted: Matrix,
    /// `(nx)`: difference of two states.
    difference: Vec<f64>,
    /// `(nq + nv + na)`
    state: Vec<f64>,
    /// Adjoint of the deviation: its vector `(nz)` and its matrix `(nz, nz)`, and the parts that
    /// belong to the state.
    vector: Vec<f64>,
    matrix: Matrix,
    state_matrix: Matrix,
    product: Vec<f64>,
}

impl Passes {
    pub(super) fn new(filter: &ExtendedKalmanFilter) -> Self {
        let (nx, inputs) = filter.plant.sizes();
        let (nz, model) = (nx + inputs, filter.data().model());
        Self {
            work: Matrix::zeros(nz, nz),
            zeros: Matrix::zeros(nz, nz),
            predicted: Matrix::zeros(nx, nx),
            difference: vec![0.0; nx],
            state: vec![0.0; model.nq() + model.nv() + model.na()],
            vector: vec![0.0; nz],
            matrix: Matrix::zeros(nz, nz),
            state_matrix: Matrix::zeros(nx, nx),
            product: vec![0.0; nz],
        }
    }

    /// Moves the trajectory to the estimate of the linear system about it. Returns the largest
    /// change in standard deviations, or `None` if the estimate is not finite, in which case the
    /// trajectory is unchanged.
    pub(super) fn run(&mut self, filter: &mut ExtendedKalmanFilter, steps: &mut [Step]) -> Result<Option<f64>> {
        self.begin(filter, &mut steps[0])?;
        for index in 0..steps.len() {
            Self::correct(filter, &mut steps[index])?;
            if let [step, next, ..] = &mut steps[index..] {
                self.advance(filter, step, next)?;
            }
        }
        self.vector.fill(0.0);
        self.matrix.as_mut_slice().fill(0.0);
        let mut change = 0.0_f64;
        for index in (0..steps.len()).rev() {
            change = self.estimate(filter, &mut steps[index]).max(change);
            self.step_back_readings(&steps[index]);
            if index > 0 {
                self.step_back_state(filter, &steps[index - 1]);
            }
        }
        if !change.is_finite() || !steps.iter().all(|step| covariance::is_finite(&step.correction.estimate)) {
            return Ok(None);
        }
        steps.iter_mut().try_for_each(|step| move_step(filter, step))?;
        Ok(Some(change))
    }

    /// Restores the trajectory of the iteration before.
    pub(super) fn undo(steps: &mut [Step]) {
        for step in steps {
            step.state.copy_from_slice(&step.previous_state);
            step.inputs.copy_from_slice(&step.previous_inputs);
        }
    }

    /// Sets the prior of the first step.
    fn begin(&mut self, filter: &ExtendedKalmanFilter, step: &mut Step) -> Result<()> {
        filter.data().model().differentiate_state_into(&step.prior_state, &step.state, &mut self.difference)?;
        self.predicted.as_mut_slice().copy_from_slice(step.prior_covariance.as_slice());
        step.correction.estimate.fill(0.0);
        self.set_prior(filter, step);
        Ok(())
    }

    /// Sets the prior of a step, given the deviation from a state, its covariance in the tangent
    /// space there, and the difference from this state to the point of linearisation.
    fn set_prior(&mut self, filter: &ExtendedKalmanFilter, step: &mut Step) {
        covariance::transport(&mut self.predicted, &filter.rotations, &self.difference);
        filter.plant.start(&self.predicted, &mut step.joint);
        let (state, inputs) = step.correction.estimate.split_at_mut(self.difference.len());
        add(state, &self.difference, -1.0);
        inputs.iter_mut().zip(&step.inputs).for_each(|(deviation, input)| *deviation = -input);
    }

    /// Corrects the deviation of a step by its readings.
    fn correct(filter: &mut ExtendedKalmanFilter, step: &mut Step) -> Result<()> {
        let plant = &mut filter.plant;
        plant.set_controls(&step.controls, &step.inputs)?;
        plant.data.set_physics_state(&step.state)?;
        if !step.has_readings {
            return Ok(());
        }
        plant.measure(&step.inputs)?;
        plant.set_disturbance_covariance(&mut step.joint)?;
        plant.measurement.subtract(&step.readings, &plant.predicted, &mut step.correction.innovations);
        step.correction.run(&mut step.joint, &plant.output, &plant.measurement, None);
        step.output.as_mut_slice().copy_from_slice(plant.output.as_slice());
        // The readings may have normalised the quaternions.
        plant.data.set_physics_state(&step.state)
    }

    /// Predicts the deviation of the next step.
    fn advance(&mut self, filter: &mut ExtendedKalmanFilter, step: &mut Step, next: &mut Step) -> Result<()> {
        let (plant, propagation) = (&mut filter.plant, &mut filter.propagation);
        plant.advance(&step.inputs, &mut step.joint, step.has_readings)?;
        propagation.propagate(&plant.transition, &step.joint, &plant.step_noise, &mut self.predicted);
        plant.data.physics_state_into(&mut self.state)?;
        // The transition leads to the tangent space at the state after the step of the simulation,
        // from there to that of the trajectory.
        plant.data.model().differentiate_state_into(&self.state, &next.state, &mut self.difference)?;
        covariance::transport_rows(&mut plant.transition, &filter.rotations, &self.difference);
        plant.transition.transposed().transpose_to(&mut step.transition.transposed_mut());
        for (deviation, row) in next.correction.estimate.iter_mut().zip(plant.transition.rows()) {
            *deviation = dot(row, &step.correction.estimate);
        }
        self.set_prior(filter, next);
        Ok(())
    }

    /// Computes the deviation and the covariance of a step from all readings. Returns the largest
    /// deviation of a state in standard deviations.
    fn estimate(&mut self, filter: &mut ExtendedKalmanFilter, step: &mut Step) -> f64 {
        let nx = self.predicted.nrows();
        filter.propagation.propagate(&step.joint, &self.matrix, &self.zeros, &mut self.work);
        let mut change = 0.0_f64;
        for (index, row) in step.joint.rows().enumerate() {
            let deviation = &mut step.correction.estimate[index];
            *deviation -= dot(row, &self.vector);
            let (size, variance) = (deviation.abs(), row[index]);
            // Rounding moves a part of the state that has no variance.
            if index < nx && size * size > 1e-24 * variance + 1e-300 {
                change = change.max(size / variance.sqrt());
            }
        }
        add(step.joint.as_mut_slice(), self.work.as_slice(), -1.0);
        step.covariance.transposed_mut().copy_from(&step.joint.transposed().view((0, 0), (nx, nx)));
        change
    }

    /// Takes the adjoint to before the readings of a step.
    fn step_back_readings(&mut self, step: &Step) {
        if !step.has_readings {
            return;
        }
        let correction = &step.correction;
        for index in (0..step.readings.len()).rev().filter(|&index| !step.readings[index].is_nan()) {
            let (gradient, gain, [innovation, variance]) =
                (step.output.row(index), correction.gains.row(index), correction.residuals[index]);
            let factor = dot(gain, &self.vector) + innovation / variance;
            add(&mut self.vector, gradient, -factor);
            // Λ ← (I − k cᵀ)ᵀ Λ (I − k cᵀ) + c cᵀ / s has the form of a correction in which the
            // gain and the gradient change places.
            covariance::multiply_symmetric(self.matrix.as_slice(), gain, &mut self.product);
            covariance::correct(&mut self.matrix, gain, gradient, &self.product, 1.0 / variance);
        }
    }

    /// Takes the adjoint to the step before.
    fn step_back_state(&mut self, filter: &mut ExtendedKalmanFilter, before: &Step) {
        let nx = self.predicted.nrows();
        self.state_matrix.transposed_mut().copy_from(&self.matrix.transposed().view((0, 0), (nx, nx)));
        filter.propagation.propagate(&before.transition, &self.state_matrix, &self.zeros, &mut self.matrix);
        for (product, row) in self.product.iter_mut().zip(before.transition.rows()) {
            *product = dot(row, &self.vector[..nx]);
        }
        self.vector.copy_from_slice(&self.product);
    }
}

/// Moves a step of the trajectory to its estimate.
fn move_step(filter: &ExtendedKalmanFilter, step: &mut Step) -> Result<()> {
    let model = filter.data().model();
    let (nv, nx) = (model.nv(), step.covariance.nrows());
    step.previous_state.copy_from_slice(&step.state);
    step.previous_inputs.copy_from_slice(&step.inputs);
    let (state, inputs) = step.correction.estimate.split_at(nx);
    model.integrate_state(&mut step.state, state)?;
    add(&mut step.inputs, inputs, 1.0);
    covariance::transport(&mut step.covariance, &filter.rotations, &state[..nv]);
    Ok(())
}
