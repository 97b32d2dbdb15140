//! Gradients of costs along trajectories by the adjoint method, and forward sensitivities.
//!
//! For the cost `Σ ℓ_k(x_k, u_k, y_k) + ℓ_N(x_N, y_N)` of the steps `x' = f(x, u, θ)` with the
//! sensors y, the adjoint states run backwards,
//!
//! ```text
//! λ_N = ∂ℓ_N,        λ_k = A_kᵀ λ_{k+1} + ∂ℓ_k/∂x + C_kᵀ ∂ℓ_k/∂y,
//! ∂u_k = B_kᵀ λ_{k+1} + ∂ℓ_k/∂u + D_kᵀ ∂ℓ_k/∂y,        ∂θ = Σ (∂f/∂θ)ᵀ λ_{k+1} + (∂y/∂θ)ᵀ ∂ℓ_k/∂y.
//! ```
//!
//! The states are computed again from checkpoints, so that √N of them are stored twice (A. Griewank
//! and A. Walther, "Evaluating Derivatives", SIAM 2008, chapters 3 and 12).

use std::mem;

use super::method::{LinearisationReport, TransitionMethod};
use super::parameter::{ModelParameter, ParameterJacobian, ParameterOutputs};
use super::perturbation::BasePoint;
use super::trajectory::{Adjoint, CostGradient, CostSlopes};
use super::worker::linearise;
use super::{Lineariser, TransitionOutputs, sizes};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::{add, add_product};

/// # Gradients along trajectories
impl Lineariser {
    /// Computes the cost of a trajectory of N steps from the present state, and its gradient by all
    /// controls, `(N, nu)`, the initial state and parameters of the model.
    ///
    /// The function `cost` receives the number k of a step, the simulation before the step with its
    /// controls set and its sensors computed, and the [slopes](CostSlopes) that it fills; it
    /// returns the cost. The calls come in decreasing order of k, from the final state with k = N
    /// and the controls of the last step.
    ///
    /// The gradient is exact to the accuracy of the linearisations, one for each step. The cost of
    /// computing it hardly depends on the number of controls and parameters with formulas: each
    /// takes a dot product. Parameters that are
    /// [differenced](Self::differenced_parameters) take four evaluations of the equations of motion
    /// in each step. Memory grows like √N, since states are computed again from checkpoints.
    ///
    /// The report is the one of the steps together: the kinks and the differenced terms of all, and
    /// the last fallback. The simulation is unchanged afterwards.
    ///
    /// ```
    /// use mujoco_safe::derivative::ModelParameter;
    /// use mujoco_safe::{Data, Lineariser, Matrix, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.2;
    /// let model = data.model().clone();
    /// let mass = ModelParameter::Mass(model.body("pole")?.id());
    /// let mut lineariser = Lineariser::new(model, Default::default())?;
    /// // The square of the final angle, after 50 steps without control.
    /// let controls = Matrix::zeros(50, 1);
    /// let (gradient, _) = lineariser.cost_gradient(&mut data, &controls, &[mass], |step, data, slopes| {
    ///     if step < 50 {
    ///         return 0.0;
    ///     }
    ///     let angle = data.qpos()[1];
    ///     slopes.state[1] = 2.0 * angle;
    ///     angle * angle
    /// })?;
    /// // A push in the direction in which the pole falls moves the cart below it.
    /// assert!(gradient.controls[(0, 0)] < 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] unless `controls` is `(N, nu)`, [`Error::Invalid`] for a cost or a slope
    /// that is not finite, and the errors of [`Data::step`] and of
    /// [`parameter_jacobian_into`](Self::parameter_jacobian_into).
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    #[doc(alias = "adjoint")]
    #[doc(alias = "backpropagation")]
    #[doc(alias = "reverse mode")]
    #[doc(alias = "differentiable simulation")]
    pub fn cost_gradient(
        &mut self,
        data: &mut Data,
        controls: &Matrix,
        parameters: &[ModelParameter],
        cost: impl FnMut(usize, &Data, &mut CostSlopes<'_>) -> f64,
    ) -> Result<(CostGradient, LinearisationReport)> {
        let mut gradient = CostGradient::zeros(data.model(), controls.nrows(), parameters.len());
        let report = self.cost_gradient_into(data, controls, parameters, cost, &mut gradient)?;
        Ok((gradient, report))
    }

    /// Computes the gradient as [`cost_gradient`](Self::cost_gradient) does, into the caller's
    /// matrices. Allocates nothing after the first call with the same sizes.
    ///
    /// # Errors
    ///
    /// As for [`cost_gradient`](Self::cost_gradient), and [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    pub fn cost_gradient_into(
        &mut self,
        data: &mut Data,
        controls: &Matrix,
        parameters: &[ModelParameter],
        cost: impl FnMut(usize, &Data, &mut CostSlopes<'_>) -> f64,
        gradient: &mut CostGradient,
    ) -> Result<LinearisationReport> {
        let (nx, nu, _) = sizes(data.model());
        Error::check_shape("the controls of cost_gradient", controls.shape(), (controls.nrows(), nu))?;
        Error::check_shape("the gradient by controls", gradient.controls.shape(), controls.shape())?;
        Error::check_length("the gradient by the initial state", gradient.initial_state.len(), nx)?;
        Error::check_length("the gradient by parameters", gradient.parameters.len(), parameters.len())?;
        self.set_parameters(data, parameters, false)?;
        let mut adjoint = match self.adjoint.take() {
            Some(mut adjoint) => {
                adjoint.simulation.clone_from(data);
                adjoint
            }
            None => Box::new(Adjoint::new(data)?),
        };
        mem::swap(&mut adjoint.resolved, &mut self.parameters.resolved);
        self.parameters.clear();
        let result = self.propagate(data, controls, &mut adjoint, cost, gradient);
        self.adjoint = Some(adjoint);
        result
    }

    /// Runs a trajectory forwards and the adjoint states backwards.
    fn propagate(
        &mut self,
        data: &Data,
        controls: &Matrix,
        adjoint: &mut Adjoint,
        mut cost: impl FnMut(usize, &Data, &mut CostSlopes<'_>) -> f64,
        gradient: &mut CostGradient,
    ) -> Result<LinearisationReport> {
        let (steps, size) = (controls.nrows(), data.model().state_size(StateSpec::INTEGRATION));
        let length = ((steps as f64).sqrt().ceil() as usize).max(1);
        adjoint.checkpoints.resize(steps.div_ceil(length) * size, 0.0);
        adjoint.segment.resize(length * size, 0.0);
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        adjoint.simulation.set_state(StateSpec::INTEGRATION, &self.base)?;
        for step in 0..steps {
            if step % length == 0 {
                let first = step / length * size;
                let checkpoint = &mut adjoint.checkpoints[first..first + size];
                adjoint.simulation.state_into(StateSpec::INTEGRATION, checkpoint)?;
            }
            adjoint.step(controls.row(step))?;
        }

        gradient.parameters.fill(0.0);
        gradient.controls.as_mut_slice().fill(0.0);
        let mut report = LinearisationReport::new(self.options().method, None);
        adjoint.present.fill(0.0);
        adjoint.simulation.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        gradient.cost = adjoint.evaluate(steps, true, &mut cost)?;
        // The final sensors are those with the last controls.
        self.transpose(adjoint, true, gradient, steps.checked_sub(1), &mut report)?;

        for number in (0..steps.div_ceil(length)).rev() {
            let (first, checkpoint) = (number * length, number * size);
            let last = (first + length).min(steps);
            adjoint
                .simulation
                .set_state(StateSpec::INTEGRATION, &adjoint.checkpoints[checkpoint..checkpoint + size])?;
            for step in first..last {
                let at = (step - first) * size;
                adjoint.simulation.ctrl_mut().copy_from_slice(controls.row(step));
                let state = &mut adjoint.segment[at..at + size];
                adjoint.simulation.state_into(StateSpec::INTEGRATION, state)?;
                if step + 1 < last {
                    adjoint.simulation.step()?;
                }
            }
            for step in (first..last).rev() {
                let at = (step - first) * size;
                self.base.copy_from_slice(&adjoint.segment[at..at + size]);
                adjoint.simulation.set_state(StateSpec::INTEGRATION, &self.base)?;
                gradient.cost += adjoint.evaluate(step, false, &mut cost)?;
                self.transpose(adjoint, false, gradient, Some(step), &mut report)?;
            }
        }
        gradient.initial_state.copy_from_slice(&adjoint.present);
        Ok(report)
    }

    /// Propagates the adjoint state across the step from `base`, whose partial derivatives are in
    /// the buffers, and adds to a row of the gradient by the controls. At the end of the
    /// trajectory, where the adjoint state is zero, only the sensors contribute.
    fn transpose(
        &mut self,
        adjoint: &mut Adjoint,
        is_end: bool,
        gradient: &mut CostGradient,
        row: Option<usize>,
        report: &mut LinearisationReport,
    ) -> Result<()> {
        let wants_sensors = adjoint.sensors.iter().any(|&slope| slope != 0.0);
        if !is_end || wants_sensors {
            let system = &mut adjoint.system;
            let mut outputs = TransitionOutputs::from(&mut *system);
            if !wants_sensors {
                (outputs.c, outputs.d) = (None, None);
            }
            let base = BasePoint { integration: &self.base, knot: None };
            let has_parameters = !adjoint.resolved.is_empty();
            let worker = &mut self.workers[..1];
            let found = linearise(worker, base, &self.options, self.obstacles, outputs, has_parameters)?;
            report.merge(found);
            self.add_parameters(adjoint, wants_sensors, found.is_at_point(), gradient, report)?;
        }
        let Adjoint { system, present, next, controls, sensors, .. } = adjoint;
        if !is_end {
            add_product(next, &system.a, present, 1.0);
        }
        if wants_sensors {
            add_product(next, &system.c, sensors, 1.0);
        }
        if let Some(row) = row {
            let by_controls = gradient.controls.row_mut(row);
            add(by_controls, controls, 1.0);
            if !is_end {
                add_product(by_controls, &system.b, present, 1.0);
            }
            if wants_sensors {
                add_product(by_controls, &system.d, sensors, 1.0);
            }
        }
        mem::swap(present, next);
        Ok(())
    }

    /// Adds the gradient by the parameters in the step from `base`, which was linearised.
    fn add_parameters(
        &mut self,
        adjoint: &mut Adjoint,
        wants_sensors: bool,
        is_at_point: bool,
        gradient: &mut CostGradient,
        report: &mut LinearisationReport,
    ) -> Result<()> {
        if adjoint.resolved.is_empty() {
            return Ok(());
        }
        let (method, _) = self.obstacles.method(self.options().method);
        let worker = &mut self.workers[0];
        if !is_at_point {
            worker.point.move_to(BasePoint { integration: &self.base, knot: None })?;
        }
        let (analytic, data) = (&mut worker.analytic, &mut worker.point.data);
        let Adjoint { resolved, present, sensors, others, columns, .. } = adjoint;
        let is_closed = method == TransitionMethod::Analytic
            && analytic.prepare_parameters(data, resolved, wants_sensors, is_at_point)?.is_ok();
        let weights = if wants_sensors { &sensors[..] } else { &[] };
        others.clear();
        if is_closed {
            report.kinks |= analytic.kinks;
            analytic.differentiate_function(data, resolved, present, weights);
            for (index, resolved) in resolved.iter().enumerate() {
                if resolved.is_differenced || !analytic.has_readings(data.model(), &resolved.effect, weights) {
                    others.push(index);
                } else {
                    gradient.parameters[index] += analytic.parameters.gradient[index];
                }
            }
        } else {
            others.extend(0..resolved.len());
        }
        if others.is_empty() {
            return Ok(());
        }
        self.parameters.resolved.clear();
        self.parameters.resolved.extend(others.iter().map(|&index| resolved[index].clone()));
        let model = data.model().clone();
        if columns.state.ncols() != others.len() {
            *columns = ParameterJacobian::zeros(&model, others.len());
        }
        let mut outputs = ParameterOutputs::from(&mut *columns);
        if !wants_sensors {
            outputs.sensors = None;
        }
        worker.point.move_to(BasePoint { integration: &self.base, knot: None })?;
        report.merge(self.differentiate_parameters(&mut outputs, false)?);
        for (column, &index) in others.iter().enumerate() {
            let by_state = columns.state.rows().zip(&*present).map(|(row, weight)| row[column] * weight);
            let by_sensors = columns.sensors.rows().zip(weights).map(|(row, weight)| row[column] * weight);
            gradient.parameters[index] += by_state.chain(by_sensors).sum::<f64>();
        }
        Ok(())
    }

    /// Computes the sensitivities of the states of a trajectory of N steps from the present state
    /// by parameters of the model: `x_0`, …, `x_N`, each `(2 nv + na, n)`, in the tangent space of
    /// positions.
    ///
    /// They run forwards, `S_{k+1} = A_k S_k + ∂f/∂θ`, so that the cost grows with the number of
    /// parameters. For the gradient of one number use [`cost_gradient`](Self::cost_gradient). The
    /// simulation is unchanged afterwards.
    ///
    /// ```
    /// use mujoco_safe::derivative::ModelParameter;
    /// use mujoco_safe::{Data, Lineariser, Matrix, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.2;
    /// let model = data.model().clone();
    /// let mass = ModelParameter::Mass(model.body("cart")?.id());
    /// let mut lineariser = Lineariser::new(model, Default::default())?;
    /// let (sensitivities, _) = lineariser.sensitivities(&mut data, &Matrix::zeros(50, 1), &[mass])?;
    /// assert_eq!(sensitivities.len(), 51);
    /// // The falling pole moves a heavier cart less.
    /// assert!(sensitivities[50][(0, 0)] > 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`cost_gradient`](Self::cost_gradient).
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    #[doc(alias = "forward mode")]
    pub fn sensitivities(
        &mut self,
        data: &mut Data,
        controls: &Matrix,
        parameters: &[ModelParameter],
    ) -> Result<(Vec<Matrix>, LinearisationReport)> {
        let (nx, nu, _) = sizes(data.model());
        Error::check_shape("the controls of sensitivities", controls.shape(), (controls.nrows(), nu))?;
        let mut copy = data.clone();
        let mut report = LinearisationReport::new(self.options().method, None);
        let mut states = vec![Matrix::zeros(nx, parameters.len())];
        let mut a = Matrix::zeros(nx, nx);
        for controls in controls.rows() {
            copy.ctrl_mut().copy_from_slice(controls);
            let mut next = Matrix::zeros(nx, parameters.len());
            let system = TransitionOutputs { a: Some(&mut a), ..Default::default() };
            let outputs = ParameterOutputs { state: Some(&mut next), sensors: None };
            report.merge(self.linear_system_with_parameters_into(&mut copy, system, parameters, outputs)?);
            let present = states.last().expect("Bug: the initial state is in the list");
            for row in 0..nx {
                add_product(next.row_mut(row), present, a.row(row), 1.0);
            }
            states.push(next);
            copy.step()?;
        }
        Ok((states, report))
    }
}
