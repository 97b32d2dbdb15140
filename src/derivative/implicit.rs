//! Linear system of a step by implicit differentiation of the equations of motion.
//!
//! The accelerations a of a state solve g(q, v, a) = 0, where g is the residual of inverse
//! dynamics: the force that the accelerations need, minus all forces that act. By the implicit
//! function theorem
//!
//! ```text
//! ∂a/∂x = −H⁻¹ ∂g/∂x,      H = ∂g/∂a,
//! ```
//!
//! so only inverse dynamics at constant a is differenced. This needs no constraint solver, whose
//! rounding error and tolerance would be divided by ε. H is known (see `newton.rs`). A step of the
//! Euler integrator with implicit damping D is
//!
//! ```text
//! W s = M a,      W = M + h D,      v' = v + h s,      q' = q ⊕ h v',
//! ```
//!
//! with the derivatives, where dM is the change of the inertia matrix with the position,
//!
//! ```text
//! ds = W⁻¹ (dM (a − s) + M da),      dv' = dv + h ds,      dq' = ∂⊕/∂q dq + h ∂⊕/∂v dv'.
//! ```
//!
//! With W = M + h D the products simplify to `W⁻¹ M H⁻¹ = H⁻¹ − h W⁻¹ D H⁻¹ =: P` and
//! `a − s = h W⁻¹ D a`. Actuator forces are linear in controls and activations within their limits,
//! so one difference perturbs all actuators. Acceleration sensors take one more difference for each
//! degree of freedom, and the chain rule.
//!
//! (`mjd_inverseFD` in newer versions of the engine computes the same differences at constant
//! acceleration. The theorem is applied to simulations with contacts in J. Carpentier and N.
//! Mansard, "Analytical derivatives of rigid body dynamics algorithms", RSS 2018, and in S. Le
//! Lidec et al., "Differentiable simulation for physical system identification", RA-L 2021.)

use mujoco_sys::mjSTAGE_ACC;

use super::actuation::Actuation;
use super::kinks::{Scale, Trials, disagreement, has_contact_that_jumps, sides};
use super::method::Kinks;
use super::newton::Newton;
use super::perturbation::{Input, PerturbedData, Settings};
use super::residual::{Residual, multiply_inertia};
use super::rotation::{self, Rotation};
use super::transition::has_kinetic_energy;
use super::{Differences, sizes};
use crate::data::{Data, SensorUpdate};
use crate::error::Result;
use crate::math;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::linear_algebra::{add, add_product, invert, quotient};

/// Ratio of the perturbation of accelerations, which have large values, to the perturbation of
/// other inputs.
const ACCELERATION_EPS_FACTOR: f64 = 1e3;

/// Indices of evaluations at the base point, to its right and to its left.
const BASE: usize = 0;
const RIGHT: usize = 1;
const LEFT: usize = 2;

/// Quantities at the base point that all columns need, and the buffers of a column.
#[derive(Debug)]
pub(super) struct Linearisation {
    newton: Newton,
    residual: Residual,
    actuation: Actuation,
    qacc: Vec<f64>,
    /// H⁻¹, W⁻¹ and Pᵀ. Without damping W⁻¹ is unused and P is H⁻¹.
    h_inverse: Matrix,
    w_inverse: Matrix,
    p_transposed: Matrix,
    /// Buffer for the inverse of a Cholesky factor.
    lower: Matrix,
    damped: bool,
    /// a − s
    spread: Vec<f64>,
    rotations: Vec<Rotation>,
    has_acceleration_sensors: bool,
    has_kinetic_energy: bool,
    /// Values to be differenced, at `BASE`, `RIGHT` and `LEFT`: g, `M (a − s)` and `sensordata`.
    residuals: [Vec<f64>; 3],
    inertial: [Vec<f64>; 3],
    sensors: [Vec<f64>; 3],
    /// `∂g/∂x`
    column: Vec<f64>,
    /// `dM (a − s)`, and then `da`
    acceleration: Vec<f64>,
    /// `(nv)`: difference of `∂g/∂x` to the right and to the left, and of the next velocities.
    disagreements: [Vec<f64>; 2],
    trials: Trials,
    /// `true` if the collision functions of the present contacts can jump.
    may_jump: bool,
    /// Kinks in controls and activations.
    pub(super) kinks: Kinks,
}

/// Returns `true` if a step of the Euler integrator contains the implicit damping of the joints. In
/// 2.2.2 the flag for passive forces does not disable it.
pub(super) fn has_implicit_damping(model: &Model) -> bool {
    let is_enabled = model.raw().opt.disableflags as u32 & DisableFlags::DAMPER.bits() == 0;
    is_enabled && model.dof_damping().iter().any(|&damping| damping > 0.0)
}

impl Linearisation {
    pub(super) fn new(model: &Model) -> Self {
        let (nv, ns) = (model.nv(), model.nsensordata());
        let (dofs, square, sensors) = (vec![0.0; nv], Matrix::zeros(nv, nv), vec![0.0; ns]);
        let three = |values: &Vec<f64>| [values.clone(), values.clone(), values.clone()];
        Self {
            newton: Newton::new(model),
            residual: Residual { has_external_forces: false },
            actuation: Actuation::zeros(model),
            qacc: dofs.clone(),
            h_inverse: square.clone(),
            w_inverse: square.clone(),
            p_transposed: square.clone(),
            lower: square,
            damped: false,
            spread: dofs.clone(),
            rotations: Vec::with_capacity(model.njnt()),
            has_kinetic_energy: has_kinetic_energy(model),
            has_acceleration_sensors: model.sensor_needstage().contains(&(mjSTAGE_ACC as i32)),
            residuals: three(&dofs),
            inertial: three(&dofs),
            sensors: three(&sensors),
            column: dofs.clone(),
            acceleration: dofs.clone(),
            disagreements: [dofs.clone(), dofs],
            trials: Trials::new(sizes(model).0 + ns),
            may_jump: false,
            kinks: Kinks::empty(),
        }
    }

    /// Computes the quantities at the base point that all columns need. Returns `false` if the
    /// solver has not converged.
    pub(super) fn prepare(&mut self, point: &mut PerturbedData, settings: Settings<'_>) -> Result<bool> {
        let Settings { model, wanted, .. } = settings;
        let data = &mut point.data;
        let sensors = SensorUpdate::needed(wanted.sensors);
        let Some(residual) = self.newton.solve(data, sensors, &mut self.residuals[BASE])? else { return Ok(false) };
        self.residual = residual;
        self.may_jump = has_contact_that_jumps(data);
        self.qacc.copy_from_slice(data.qacc());
        if wanted.sensors {
            data.sensor_acc()?;
        }
        self.sensors[BASE].copy_from_slice(data.sensordata());
        self.kinks = self.actuation.differentiate(point, settings)?;
        self.invert(&point.data, model)?;

        let h = model.raw().opt.timestep;
        let Self { rotations, spread, qacc, .. } = self;
        let qvel = point.data.qvel();
        rotation::differentiate(model, |dof| qvel[dof] + h * (qacc[dof] - spread[dof]), rotations);
        self.multiply_inertia(&point.data, BASE);
        Ok(true)
    }

    /// Computes H⁻¹, W⁻¹ and P.
    fn invert(&mut self, data: &Data, model: &Model) -> Result<()> {
        let (nv, h) = (model.nv(), model.raw().opt.timestep);
        invert(&self.newton.factor, &mut self.lower, &mut self.h_inverse);
        self.p_transposed.as_mut_slice().copy_from_slice(self.h_inverse.as_slice());
        self.spread.fill(0.0);
        self.damped = has_implicit_damping(model);
        if !self.damped {
            return Ok(());
        }
        // The factor of H is no longer needed.
        let w = &mut self.newton.factor;
        data.full_m_into(w)?;
        for dof in 0..nv {
            w[(dof, dof)] += h * model.dof_damping()[dof];
        }
        math::chol_factor(&mut *w, 0.0)?;
        invert(w, &mut self.lower, &mut self.w_inverse);
        for (dof, &damping) in model.dof_damping().iter().enumerate() {
            if damping != 0.0 {
                add(&mut self.spread, self.w_inverse.row(dof), h * damping * self.qacc[dof]);
                for row in 0..nv {
                    let factor = h * damping * self.h_inverse[(row, dof)];
                    add(self.p_transposed.row_mut(row), self.w_inverse.row(dof), -factor);
                }
            }
        }
        Ok(())
    }

    /// Computes `M (a − s)`, which is needed only with damping.
    fn multiply_inertia(&mut self, data: &Data, side: usize) {
        if self.damped {
            multiply_inertia(data, &mut self.inertial[side], &self.spread);
        }
    }

    /// Returns `true` if the model has acceleration sensors. Their derivatives must then be passed
    /// to each column.
    pub(super) fn has_acceleration_sensors(&self) -> bool {
        self.has_acceleration_sensors
    }

    /// Computes the derivatives of the acceleration sensors with respect to the acceleration of one
    /// degree of freedom, and returns their kinks, such as a reading at its cutoff.
    pub(super) fn acceleration_row(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        dof: usize,
        row: &mut [f64],
    ) -> Result<Kinks> {
        let mut trials = std::mem::take(&mut self.trials);
        let kinks = trials.run(settings, false, row, |Settings { step, keep, .. }, row| {
            // Sensors of other stages keep their values. Acceleration sensors are linear, except
            // for elliptic cones.
            let eps = ACCELERATION_EPS_FACTOR * step.eps;
            for (side, by) in [(RIGHT, eps), (LEFT, -eps)] {
                point.data.qacc_mut()[dof] = self.qacc[dof] + by;
                point.data.inv_constraint()?;
                point.data.sensor_acc()?;
                self.sensors[side].copy_from_slice(point.data.sensordata());
            }
            point.data.qacc_mut()[dof] = self.qacc[dof];
            let [base, right, left] = &self.sensors;
            quotient(row, left, right, 2.0 * eps);
            Ok(disagreement([base, right, left], keep, eps))
        });
        self.trials = trials;
        kinks
    }

    /// Computes a column of the linear system, and returns its kinks. `acceleration_sensors` holds
    /// the rows of [`acceleration_row`](Self::acceleration_row). Columns must be computed in the
    /// order of [`inputs`](super::perturbation::inputs).
    pub(super) fn column(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        acceleration_sensors: &Matrix,
        row: &mut [f64],
    ) -> Result<Kinks> {
        let model = settings.model;
        match input {
            Input::Control(actuator) => {
                self.actuation.column(&point.data, model, input, actuator, &mut self.column, row);
            }
            Input::Activation(activation) => {
                let actuator = model.actuator_of_activation(activation);
                self.actuation.column(&point.data, model, input, actuator, &mut self.column, row);
            }
            Input::Velocity(_) | Input::Position(_) => {
                let mut trials = std::mem::take(&mut self.trials);
                let may_jump = self.may_jump && matches!(input, Input::Position(_));
                let kinks = trials.run(settings, may_jump, row, |settings, row| {
                    let inertial = self.difference(point, settings, input, row)?;
                    self.finish(model, row, input, inertial, acceleration_sensors);
                    Ok(self.disagreement(settings, row))
                });
                self.trials = trials;
                return kinks;
            }
        }
        self.finish(model, row, input, None, acceleration_sensors);
        Ok(Kinks::empty())
    }

    /// Returns the disagreement of the last differences to the right and to the left, in a column
    /// of the linear system.
    fn disagreement(&mut self, Settings { model, wanted, step, keep }: Settings<'_>, row: &[f64]) -> f64 {
        if step.differences == Differences::Forward {
            return 0.0;
        }
        let mut worst = 0.0;
        if wanted.sensors {
            let [base, right, left] = &self.sensors;
            worst = disagreement([base, right, left], keep, step.eps);
        }
        let nv = model.nv();
        if !wanted.system {
            return worst;
        }
        let [of_residual, of_velocity] = &mut self.disagreements;
        let [base, right, left] = &self.residuals;
        for (dof, value) in of_residual.iter_mut().enumerate() {
            *value = (right[dof] - 2.0 * base[dof] + left[dof]) / step.eps;
        }
        of_velocity.fill(0.0);
        add_product(of_velocity, &self.p_transposed, of_residual, -model.raw().opt.timestep);
        let velocity = &row[nv..2 * nv];
        let scale = Scale::of(velocity.iter().copied());
        let of_entry = |(difference, entry): (&f64, &f64)| scale.disagreement(*difference, *entry);
        of_velocity.iter().zip(velocity).map(of_entry).fold(worst, f64::max)
    }

    /// Differences the residual and the sensors with respect to a velocity or a position. Returns
    /// the side and the width of the difference of `M (a − s)`, if that changes.
    fn difference(
        &mut self,
        point: &mut PerturbedData,
        settings: Settings<'_>,
        input: Input,
        row: &mut [f64],
    ) -> Result<Option<(usize, f64)>> {
        let Settings { model, wanted, step, .. } = settings;
        let is_position = matches!(input, Input::Position(_));
        let (_, left) = sides(&point.data, input, step, &[]);
        for (side, by) in [(RIGHT, step.eps), (LEFT, -step.eps)] {
            if side == LEFT && !left {
                continue;
            }
            point.perturb(model, input, by)?;
            self.residual.update_forces(&mut point.data, is_position, wanted.sensors)?;
            if wanted.sensors && !is_position && self.has_kinetic_energy {
                point.data.sensor_pos()?;
            }
            self.residual.evaluate(&mut point.data, &mut self.residuals[side])?;
            if is_position {
                self.multiply_inertia(&point.data, side);
            }
            if wanted.sensors {
                point.data.sensor_acc()?;
                self.sensors[side].copy_from_slice(point.data.sensordata());
            }
            point.restore_input(input);
        }
        let from = if left { LEFT } else { BASE };
        let width = if left { 2.0 * step.eps } else { step.eps };
        quotient(&mut self.column, &self.residuals[from], &self.residuals[RIGHT], width);
        row.fill(0.0);
        quotient(&mut row[sizes(model).0..], &self.sensors[from], &self.sensors[RIGHT], width);
        Ok((self.damped && is_position).then_some((from, width)))
    }

    /// Completes a column from `∂g/∂x`, and from the difference of `M (a − s)` if there is one.
    fn finish(
        &mut self,
        model: &Model,
        row: &mut [f64],
        input: Input,
        inertial: Option<(usize, f64)>,
        acceleration_sensors: &Matrix,
    ) {
        let (nv, nx, h) = (model.nv(), sizes(model).0, model.raw().opt.timestep);
        let (position, rest) = row[..nx].split_at_mut(nv);
        let velocity = &mut rest[..nv];
        add_product(velocity, &self.p_transposed, &self.column, -h);
        if let Some((from, width)) = inertial {
            quotient(&mut self.acceleration, &self.inertial[from], &self.inertial[RIGHT], width);
            add_product(velocity, &self.w_inverse, &self.acceleration, h);
        }
        if let Input::Velocity(dof) = input {
            velocity[dof] += 1.0;
        }
        position.iter_mut().zip(&*velocity).for_each(|(position, velocity)| *position = h * velocity);
        for rotation in &self.rotations {
            let change = [0, 1, 2].map(|axis| h * velocity[rotation.dof + axis]);
            for axis in 0..3 {
                let by_velocity = &rotation.by_velocity[3 * axis..3 * axis + 3];
                position[rotation.dof + axis] = by_velocity.iter().zip(&change).map(|(by, change)| by * change).sum();
            }
        }
        if let Input::Position(dof) = input {
            match self.rotations.iter().find(|rotation| (rotation.dof..rotation.dof + 3).contains(&dof)) {
                Some(rotation) => {
                    for axis in 0..3 {
                        position[rotation.dof + axis] += rotation.by_position[3 * axis + dof - rotation.dof];
                    }
                }
                None => position[dof] += 1.0,
            }
        }
        if self.has_acceleration_sensors && !row[nx..].is_empty() {
            self.acceleration.fill(0.0);
            add_product(&mut self.acceleration, &self.h_inverse, &self.column, -1.0);
            add_product(&mut row[nx..], acceleration_sensors, &self.acceleration, 1.0);
        }
    }
}
