//! The simulation of an estimator, with its linearisations.

use super::measurement::Measurement;
use super::noise::{Disturbance, ProcessNoise};
use crate::control::residual::ResidualJacobian;
use crate::data::Data;
use crate::derivative::{self, LinearisationReport, Lineariser, StateSpace, TransitionOptions, TransitionOutputs};
use crate::error::{Error, Result};
use crate::id::Lineage;
use crate::matrix::Matrix;
use crate::memory;
use crate::model::{EnableFlags, Model};
use crate::numerics::linear_algebra::{add, dot};

/// Simulation at an estimate, and the linear system there: `x' = f(x, u + w, α)` and `y = h(x, u +
/// w, α)` with the state x, the controls u, the noise w of the controls, and the disturbance α of
/// the accelerations. The last two are inputs of a step that are estimated: w if there is such
/// noise, and α if there is noise of forces and accelerometers measure it.
#[derive(Debug)]
pub(super) struct Plant {
    pub(super) data: Data,
    pub(super) noise: ProcessNoise,
    pub(super) measurement: Measurement,
    lineage: Lineage,
    lineariser: Lineariser,
    system: StateSpace,
    jacobian: ResidualJacobian,
    disturbance: Disturbance,
    /// `(3, nv)`
    linear: Matrix,
    /// Covariance of the noise that is added to the state after a step, `(nx, nx)`.
    pub(super) step_noise: Matrix,
    /// `(nx, nx + nw + nf)`: derivatives of the next state by the state and the inputs.
    pub(super) transition: Matrix,
    /// `(ny, nx + nw + nf)`: derivatives of the readings.
    pub(super) output: Matrix,
    /// `(ny)`: readings without noise.
    pub(super) predicted: Vec<f64>,
}

impl Plant {
    pub(super) fn new(mut data: Data, noise: ProcessNoise, measurement: Measurement) -> Result<Self> {
        let model = data.model().clone();
        check_model(&model)?;
        for (other, what) in [(&noise.model, "the process noise"), (&measurement.model, "the measurement")] {
            if other.lineage() != model.lineage() {
                return Err(Error::OtherModel { what });
            }
        }
        // Engines before 3 add noise to the readings, which then have no derivatives.
        if model.options().enable.contains(EnableFlags::SENSORNOISE) {
            data.edit_model(|model| model.edit_options(|options| options.enable.remove(EnableFlags::SENSORNOISE)))?;
        }
        let (nx, nu, _) = derivative::sizes(&model);
        let nf = if noise.has_forces() && measurement.has_accelerometers() { model.nv() } else { 0 };
        let (nz, ny, rows) = (nx + noise.controls.len() + nf, measurement.len(), measurement.largest_residual());
        memory::check("components of a Measurement", ny.max(rows), size_of::<f64>() * (nz + nu).max(1))?;
        Ok(Self {
            lineage: model.lineage(),
            lineariser: Lineariser::new(data.model().clone(), TransitionOptions::default())?,
            system: StateSpace::zeros(&model),
            jacobian: ResidualJacobian::zeros(&model, rows),
            disturbance: Disturbance::new(&model),
            linear: Matrix::zeros(3, model.nv()),
            step_noise: noise.covariance.clone(),
            transition: Matrix::zeros(nx, nz),
            output: Matrix::zeros(ny, nz),
            predicted: vec![0.0; ny],
            data,
            noise,
            measurement,
        })
    }

    /// Returns the numbers of states and of inputs.
    pub(super) fn sizes(&self) -> (usize, usize) {
        let (nx, nz) = self.transition.shape();
        (nx, nz - nx)
    }

    /// Returns the number of components of the disturbance.
    fn disturbances(&self) -> usize {
        let (_, inputs) = self.sizes();
        inputs - self.noise.controls.len()
    }

    /// Checks that the simulation still is of the model that the buffers are for, and sets its
    /// controls `u + w`.
    pub(super) fn set_controls(&mut self, controls: &[f64], inputs: &[f64]) -> Result<()> {
        self.check()?;
        Error::check_length("the controls of an estimator (nu)", controls.len(), self.data.model().nu())?;
        let ctrl = self.data.ctrl_mut();
        ctrl.copy_from_slice(controls);
        let noise = &inputs[..self.noise.controls.len()];
        ctrl.iter_mut().zip(noise).for_each(|(ctrl, noise)| *ctrl += noise);
        Ok(())
    }

    /// Checks the model of the simulation, which the caller can replace.
    pub(super) fn check(&self) -> Result<()> {
        if self.data.model().lineage() != self.lineage {
            return Err(Error::OtherModel { what: "the simulation of an estimator" });
        }
        check_model(self.data.model())
    }

    /// Writes the covariance of the state and the inputs at the start of a step, where they are
    /// independent, without that of the disturbance.
    pub(super) fn start(&self, covariance: &Matrix, joint: &mut Matrix) {
        let (nx, _) = self.sizes();
        joint.as_mut_slice().fill(0.0);
        joint.transposed_mut().view_mut((0, 0), (nx, nx)).copy_from(&covariance.transposed());
        for (index, &variance) in self.noise.controls.iter().enumerate() {
            joint[(nx + index, nx + index)] = variance;
        }
    }

    /// Writes the covariance of the disturbance, with the results of the present state, to that of
    /// the state and the inputs.
    pub(super) fn set_disturbance_covariance(&mut self, joint: &mut Matrix) -> Result<()> {
        let count = self.disturbances();
        if count > 0 {
            let first = self.transition.ncols() - count;
            let values = self.disturbance.compute(&self.noise, &mut self.data)?;
            joint.transposed_mut().view_mut((first, first), (count, count)).copy_from(&values.transposed());
        }
        Ok(())
    }

    /// Computes the readings without noise at the present state, controls and disturbance, and
    /// their derivatives.
    pub(super) fn measure(&mut self, inputs: &[f64]) -> Result<()> {
        self.measurement.predict(&mut self.data, &mut self.predicted)?;
        if self.measurement.has_sensors() {
            let d = (!self.noise.controls.is_empty()).then_some(&mut self.system.d);
            let outputs = TransitionOutputs { c: Some(&mut self.system.c), d, ..Default::default() };
            self.lineariser.linear_system_into(&mut self.data, outputs)?;
        }
        let (system, nw) = ((&self.system.c, &self.system.d), self.noise.controls.len());
        self.measurement.differentiate(&mut self.data, system, nw, &mut self.jacobian, &mut self.output)?;
        if self.disturbances() > 0 {
            let (nx, _) = self.sizes();
            let (first, disturbance) = (nx + nw, &inputs[nw..]);
            self.measurement.differentiate_accelerometers(&self.data, first, &mut self.linear, &mut self.output)?;
            for (predicted, row) in self.predicted.iter_mut().zip(self.output.rows()) {
                *predicted += dot(&row[first..], disturbance);
            }
        }
        Ok(())
    }

    /// Linearises a step at the present state and controls, and takes it. Sets the noise of the
    /// step, and unless `is_set`, the covariance of the disturbance.
    pub(super) fn advance(&mut self, inputs: &[f64], joint: &mut Matrix, is_set: bool) -> Result<LinearisationReport> {
        let ((nx, _), nw, nv) = (self.sizes(), self.noise.controls.len(), self.data.model().nv());
        let b = (nw > 0).then_some(&mut self.system.b);
        let outputs = TransitionOutputs { a: Some(&mut self.system.a), b, ..Default::default() };
        let report = self.lineariser.linear_system_into(&mut self.data, outputs)?;
        let mut transition = self.transition.transposed_mut();
        transition.rows_mut(0, nx).copy_from(&self.system.a.transposed());
        transition.rows_mut(nx, nw).copy_from(&self.system.b.transposed().rows(0, nw));
        self.data.step()?;
        // The results belong to the state before the step.
        let h = self.data.model().timestep();
        if self.disturbances() > 0 {
            if !is_set {
                self.set_disturbance_covariance(joint)?;
            }
            for dof in 0..nv {
                self.transition[(dof, nx + nw + dof)] = h * h;
                self.transition[(nv + dof, nx + nw + dof)] = h;
            }
            let disturbance = &inputs[nw..];
            self.data.integrate_pos(disturbance, h * h)?;
            self.data.qvel_mut().iter_mut().zip(disturbance).for_each(|(qvel, by)| *qvel += h * by);
        } else if self.noise.has_forces() {
            self.step_noise.as_mut_slice().copy_from_slice(self.noise.covariance.as_slice());
            let accelerations = self.disturbance.compute(&self.noise, &mut self.data)?;
            for (row, values) in accelerations.rows().enumerate() {
                let (position, velocity) = (h * h, h);
                for (target, factor) in [(row, position), (nv + row, velocity)] {
                    let (positions, rest) = self.step_noise.row_mut(target).split_at_mut(nv);
                    add(positions, values, factor * position);
                    add(&mut rest[..nv], values, factor * velocity);
                }
            }
        }
        Ok(report)
    }
}

/// Checks that `[dq; dv; da]` is the complete state of a model, and that its steps have linear
/// systems.
fn check_model(model: &Model) -> Result<()> {
    model.check_linearisable("state estimation")?;
    if model.plastic_len() + model.plugin_state_len() > 0 {
        let what = "state estimation of plugins or flexes with a state, which is not a part of [dq; dv; da]";
        return Err(Error::Unsupported(what.to_owned()));
    }
    Ok(())
}
