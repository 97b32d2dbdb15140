//! The linear system of a step from differences of inverse dynamics.
//!
//! The accelerations a of a state solve g(q, v, a) = 0, where g is what inverse dynamics gives, less all forces that are
//! applied. By the implicit function theorem
//!
//! ```text
//! ∂a/∂x = −H⁻¹ ∂g/∂x,      H = ∂g/∂a,
//! ```
//!
//! so what is differenced is inverse dynamics at constant a, which has no solver to run and none whose rounding and tolerance
//! would be divided by ε; H is known (see `newton.rs`). A step of the integrator Euler, with implicit damping D, then is
//!
//! ```text
//! W s = M a,      W = M + h D,      v' = v + h s,      q' = q ⊕ h v',
//! ```
//!
//! of which the derivatives are, with dM the change of the inertia matrix by a change of position,
//!
//! ```text
//! ds = W⁻¹ (dM (a − s) + M da),      dv' = dv + h ds,      dq' = ∂⊕/∂q dq + h ∂⊕/∂v dv'.
//! ```
//!
//! With W = M + h D the products become `W⁻¹ M H⁻¹ = H⁻¹ − h W⁻¹ D H⁻¹ =: P` and `a − s = h W⁻¹ D a`. Forces of actuators are
//! linear in what drives them, up to their limits, so each takes one difference, all actuators at once. Sensors of
//! accelerations take one more for each degree of freedom, and the chain rule.
//!
//! (The differences at constant acceleration are those of the engine's own `mjd_inverseFD` of later versions. The theorem's use
//! for simulations with contacts: J. Carpentier and N. Mansard, "Analytical derivatives of rigid body dynamics algorithms", RSS
//! 2018; S. Le Lidec et al., "Differentiable simulation for physical system identification", RA-L 2021.)

use mujoco_sys::{mjJNT_BALL, mjJNT_FREE, mjMAXVAL, mjSTAGE_ACC};

use super::drive::Drive;
use super::method::{Fallback, Step};
use super::sizes;
use super::worker::{Input, Wanted, Worker, sides};
use crate::data::Stage;
use crate::enums::Integrator;
use crate::error::Result;
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;

/// How much wider the differences by accelerations are, which are large numbers.
const WIDER: f64 = 1e3;

/// At the base point, and to the right and to the left of it.
const BASE: usize = 0;
const RIGHT: usize = 1;
const LEFT: usize = 2;

/// How a rotation is integrated: the first of its three degrees of freedom, and the derivatives of the result.
#[derive(Clone, Debug)]
struct Rotation {
    dof: usize,
    by_position: [f64; 9],
    by_velocity: [f64; 9],
}

/// What all columns need of the base point.
#[derive(Debug)]
pub(super) struct Base {
    pub(super) qacc: Vec<f64>,
    /// H⁻¹, W⁻¹ and Pᵀ. Without damping W⁻¹ is not needed, and P is H⁻¹.
    h_inverse: Matrix,
    w_inverse: Matrix,
    p_transposed: Matrix,
    /// Room for the inverse of a factor.
    lower: Matrix,
    pub(super) damped: bool,
    /// a − s
    pub(super) spread: Vec<f64>,
    rotations: Vec<Rotation>,
    /// By the control and by the activation of each actuator: its force, the next activation, and the sensors of its force.
    pub(super) by_control: Drive,
    pub(super) by_activation: Drive,
    /// Forces are applied to bodies, which depend on positions.
    pub(super) pushed: bool,
    /// `(nv, nsensordata)`, if some sensors are of accelerations.
    pub(super) sensors_by_acceleration: Matrix,
    accelerometers: bool,
    /// What is differenced: g, and `M (a − s)`, and sensors.
    pub(super) forces: [Vec<f64>; 3],
    pub(super) inertias: [Vec<f64>; 3],
    sensors: [Vec<f64>; 3],
    /// `∂g/∂x`, and `da`
    pub(super) column: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Base {
    pub(super) fn new(model: &Model) -> Self {
        let (nv, ns) = (model.nv(), model.nsensordata());
        let (dofs, square, sensors) = (vec![0.0; nv], Matrix::zeros(nv, nv), vec![0.0; ns]);
        let three = |values: &Vec<f64>| [values.clone(), values.clone(), values.clone()];
        Self {
            qacc: dofs.clone(),
            h_inverse: square.clone(),
            w_inverse: square.clone(),
            p_transposed: square.clone(),
            lower: square,
            damped: false,
            spread: dofs.clone(),
            rotations: Vec::with_capacity(model.njnt()),
            by_control: Drive::zeros(model),
            by_activation: Drive::zeros(model),
            pushed: false,
            sensors_by_acceleration: Matrix::zeros(nv, ns),
            accelerometers: model.sensor_needstage().contains(&(mjSTAGE_ACC as i32)),
            forces: three(&dofs),
            inertias: three(&dofs),
            sensors: three(&sensors),
            column: dofs.clone(),
            acceleration: dofs,
        }
    }
}

/// Why a step of this model cannot be linearised through inverse dynamics, if it cannot.
pub(super) fn obstacle(model: &Model) -> Option<Fallback> {
    let options = model.options();
    match options.integrator {
        Integrator::Rk4 => Some(Fallback::RungeKutta),
        Integrator::Implicit => Some(Fallback::ImplicitIntegrator),
        _ if options.noslip_iterations > 0 => Some(Fallback::NoSlip),
        _ => None,
    }
}

impl Worker {
    /// Finds out about the base point what all columns need. False if the solver has not converged.
    pub(super) fn prepare(&mut self, wanted: Wanted, step: Step) -> Result<bool> {
        let model = self.data.model().clone();
        self.data.forward_skip(Stage::Nothing, !wanted.sensors)?;
        if !self.data.qacc().iter().all(|value| value.abs() <= mjMAXVAL) {
            return Ok(false);
        }
        self.base.pushed = self.data.xfrc_applied().as_flattened().iter().any(|&value| value != 0.0);
        if !self.settle()? {
            return Ok(false);
        }
        self.base.qacc.copy_from_slice(self.data.qacc());
        if wanted.sensors {
            self.data.sensor_acc()?;
        }
        self.base.sensors[BASE].copy_from_slice(self.data.sensordata());
        self.drive(&model, step, wanted)?;
        self.invert(&model)?;

        let h = model.raw().opt.timestep;
        let Base { rotations, spread, qacc, .. } = &mut self.base;
        rotations.clear();
        for (joint, &kind) in model.jnt_type().iter().enumerate() {
            let dof = ffi::size(model.jnt_dofadr()[joint]);
            let dof = if kind == mjJNT_FREE as i32 {
                dof + 3
            } else if kind == mjJNT_BALL as i32 {
                dof
            } else {
                continue;
            };
            let next = [0, 1, 2].map(|axis| dof + axis);
            let next = next.map(|dof| self.data.qvel()[dof] + h * (qacc[dof] - spread[dof]));
            let derivative = math::quat_integrate_derivative(&next, h);
            rotations.push(Rotation { dof, by_position: derivative.dquat, by_velocity: derivative.dvel });
        }
        self.inertia(BASE);
        Ok(true)
    }

    /// H⁻¹, W⁻¹ and P.
    fn invert(&mut self, model: &Model) -> Result<()> {
        let (nv, h) = (model.nv(), model.raw().opt.timestep);
        let base = &mut self.base;
        invert(&self.newton.factor, &mut base.lower, &mut base.h_inverse);
        base.p_transposed.as_mut_slice().copy_from_slice(base.h_inverse.as_slice());
        base.spread.fill(0.0);
        base.damped = model.dof_damping().iter().any(|&damping| damping > 0.0);
        if !base.damped {
            return Ok(());
        }
        // The factor of H is not needed any more.
        let w = &mut self.newton.factor;
        self.data.full_m_into(w)?;
        for dof in 0..nv {
            w[(dof, dof)] += h * model.dof_damping()[dof];
        }
        math::chol_factor(&mut *w, 0.0)?;
        invert(w, &mut base.lower, &mut base.w_inverse);
        for (dof, &damping) in model.dof_damping().iter().enumerate() {
            if damping != 0.0 {
                add(&mut base.spread, base.w_inverse.row(dof), h * damping * base.qacc[dof]);
                for row in 0..nv {
                    let factor = h * damping * base.h_inverse[(row, dof)];
                    add(base.p_transposed.row_mut(row), base.w_inverse.row(dof), -factor);
                }
            }
        }
        Ok(())
    }

    /// Whether sensors need [`accelerate`](Self::accelerate) first.
    pub(super) fn has_accelerometers(&self) -> bool {
        self.base.accelerometers
    }

    /// The derivatives of the sensors of accelerations by one of these. All of them come before the columns, which need them.
    pub(super) fn accelerate(&mut self, dof: usize, step: Step, row: &mut [f64]) -> Result<()> {
        // Of other stages the readings stay as they are. These are linear in the accelerations but for elliptic cones.
        let eps = WIDER * step.eps;
        for (side, by) in [(RIGHT, eps), (LEFT, -eps)] {
            self.data.qacc_mut()[dof] = self.base.qacc[dof] + by;
            self.data.inv_constraint()?;
            self.data.sensor_acc()?;
            self.base.sensors[side].copy_from_slice(self.data.sensordata());
        }
        self.data.qacc_mut()[dof] = self.base.qacc[dof];
        let [_, right, left] = &self.base.sensors;
        quotient(row, left, right, 2.0 * eps);
        Ok(())
    }

    /// Computes a column, given what [`accelerate`](Self::accelerate) has found. They have to come in the order of
    /// [`inputs`](super::worker::inputs).
    pub(super) fn inverse_column(
        &mut self,
        model: &Model,
        input: Input,
        wanted: Wanted,
        step: Step,
        row: &mut [f64],
    ) -> Result<()> {
        match input {
            Input::Control(actuator) => self.driven_column(model, input, actuator, row),
            Input::Activation(activation) => {
                self.driven_column(model, input, activation + model.nu() - model.na(), row);
            }
            Input::Velocity(_) | Input::Position(_) => self.state_column(model, input, wanted, step, row)?,
        }
        Ok(())
    }

    /// The column of a velocity or a position.
    fn state_column(&mut self, model: &Model, input: Input, wanted: Wanted, step: Step, row: &mut [f64]) -> Result<()> {
        let (_, left) = sides(&self.data, input, step);
        for (side, by) in [(RIGHT, step.eps), (LEFT, -step.eps)] {
            if side == LEFT && !left {
                continue;
            }
            self.nudge(model, input, by)?;
            self.evaluate(input, wanted)?;
            self.balance(side)?;
            if matches!(input, Input::Position(_)) {
                self.inertia(side);
            }
            if wanted.sensors {
                self.data.sensor_acc()?;
                self.base.sensors[side].copy_from_slice(self.data.sensordata());
            }
            self.put_back(input);
        }
        let from = if left { LEFT } else { BASE };
        let width = if left { 2.0 * step.eps } else { step.eps };
        let base = &mut self.base;
        quotient(&mut base.column, &base.forces[from], &base.forces[RIGHT], width);
        row.fill(0.0);
        quotient(&mut row[sizes(model).0..], &base.sensors[from], &base.sensors[RIGHT], width);
        let inertia = (base.damped && matches!(input, Input::Position(_))).then_some((from, width));
        base.finish(model, row, input, inertia);
        Ok(())
    }
}

impl Base {
    /// Completes a column from `∂g/∂x`, and from `M (a − s)` where that changes.
    pub(super) fn finish(&mut self, model: &Model, row: &mut [f64], input: Input, inertia: Option<(usize, f64)>) {
        let (nv, nx, h) = (model.nv(), sizes(model).0, model.raw().opt.timestep);
        let (position, rest) = row[..nx].split_at_mut(nv);
        let velocity = &mut rest[..nv];
        add_product(velocity, &self.p_transposed, &self.column, -h);
        if let Some((from, width)) = inertia {
            quotient(&mut self.acceleration, &self.inertias[from], &self.inertias[RIGHT], width);
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
        if self.accelerometers && !row[nx..].is_empty() {
            self.acceleration.fill(0.0);
            add_product(&mut self.acceleration, &self.h_inverse, &self.column, -1.0);
            add_product(&mut row[nx..], &self.sensors_by_acceleration, &self.acceleration, 1.0);
        }
    }
}

/// The inverse of a matrix whose Cholesky factor L is given, `L⁻ᵀ L⁻¹`, with room for `L⁻¹`. Row operations only, of which the
/// compiler makes vector instructions; solving for one column after another takes several times as long.
fn invert(factor: &Matrix, lower: &mut Matrix, inverse: &mut Matrix) {
    let n = factor.nrows();
    for row in 0..n {
        let (above, rest) = lower.as_mut_slice().split_at_mut(row * n);
        let current = &mut rest[..=row];
        current.fill(0.0);
        current[row] = 1.0;
        for column in 0..row {
            add(&mut current[..=column], &above[column * n..=column * n + column], -factor[(row, column)]);
        }
        let pivot = factor[(row, row)];
        for value in current {
            *value /= pivot;
        }
    }
    inverse.as_mut_slice().fill(0.0);
    for row in 0..n {
        let values = &lower.row(row)[..=row];
        for (column, &value) in values.iter().enumerate() {
            add(&mut inverse.row_mut(column)[..=column], &values[..=column], value);
        }
    }
    for row in 0..n {
        for column in 0..row {
            inverse[(column, row)] = inverse[(row, column)];
        }
    }
}

/// `result += factor · matrixᵀ · vector`: row by row, which the compiler makes vector instructions of.
fn add_product(result: &mut [f64], matrix: &Matrix, vector: &[f64], factor: f64) {
    vector.iter().enumerate().for_each(|(row, value)| add(result, matrix.row(row), factor * value));
}

/// `result += factor · vector`
pub(super) fn add(result: &mut [f64], vector: &[f64], factor: f64) {
    result.iter_mut().zip(vector).for_each(|(result, value)| *result += factor * value);
}

/// `result = (to − from) / width`
fn quotient(result: &mut [f64], from: &[f64], to: &[f64], width: f64) {
    result.iter_mut().zip(from.iter().zip(to)).for_each(|(result, (from, to))| *result = (to - from) / width);
}
