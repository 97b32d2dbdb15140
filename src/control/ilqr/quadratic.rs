//! The quadratic cost of the deviation from a state.

use std::sync::{Arc, Mutex, PoisonError};

use super::cost::{CostExpansion, TrajectoryCost};
use crate::control::LqrWeights;
use crate::data::StateSpec;
use crate::derivative;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::math::{rot_vec_mat_t, sub_quat_derivative};
use crate::matrix::Matrix;
use crate::model::{IntoModel, Model};
use crate::numerics::linear_algebra::{add_product, dot};

/// Quadratic cost of the deviation from a target state and from reference controls:
/// `dxᵀQdx + duᵀRdu + 2dxᵀSdu` in each step, and `dxᵀPdx` at the end. There is no factor ½: the
/// value is twice the cost of texts that minimise `½dxᵀQdx + …`. The cost-to-go matrix of
/// [`Lqr`](crate::Lqr) for the same weights is consistent with it as the terminal weights `P`.
///
/// The difference of states is the same as in [`Lqr`](crate::Lqr), which treats quaternions as
/// rotations. The second derivatives omit the second derivatives of the difference itself (the
/// Gauss–Newton approximation), which are zero for models without quaternions.
///
/// The methods of [`TrajectoryCost`] return [`Error::Shape`] for a state, controls or an expansion
/// of a wrong length. After the first evaluation in each thread, they do not allocate.
///
/// ```
/// use mujoco_safe::control::ilqr::{QuadraticCost, TrajectoryCost};
/// use mujoco_safe::{LqrWeights, Matrix, sample};
///
/// let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
/// let cost = QuadraticCost::new(sample::cartpole(), &[0.0; 4], weights, Matrix::identity(4))?;
/// assert_eq!(cost.value(0, &[0.0, 0.1, 0.0, 0.0], Some(&[0.5]))?, 10.0 * 0.1 * 0.1 + 0.5 * 0.5);
/// assert_eq!(cost.value(100, &[0.0, 0.0, 0.0, 2.0], None)?, 4.0);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuadraticCost {
    model: Arc<Model>,
    state: Vec<f64>,
    controls: Vec<f64>,
    /// Second derivatives: twice the symmetric parts of the weights.
    step: Matrix,
    terminal: Matrix,
    by_controls: Matrix,
    mixed: Option<Matrix>,
    /// First index of each quaternion in `qpos`, and its first degree of freedom.
    quaternions: Vec<[usize; 2]>,
    buffers: Buffers,
}

/// Idle buffers for deviations, `[dx; du]`: one for each active thread, created on demand.
#[derive(Debug, Default)]
struct Buffers(Mutex<Vec<Vec<f64>>>);

impl Clone for Buffers {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Buffers {
    /// Takes an idle buffer, or creates one.
    fn take(&self, length: usize) -> Vec<f64> {
        let idle = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| vec![0.0; length])
    }

    fn give_back(&self, buffer: Vec<f64>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
    }
}

impl QuadraticCost {
    /// Creates the cost of the deviation from a target state, `[qpos; qvel; act]`, with the weights
    /// of each step and the terminal weights `(nx, nx)`. Only the symmetric parts of the matrices
    /// matter.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape.
    pub fn new(model: impl IntoModel, state: &[f64], weights: LqrWeights, terminal: impl Into<Matrix>) -> Result<Self> {
        let (model, terminal) = (model.into_model(), terminal.into());
        let (nx, nu, _) = derivative::sizes(&model);
        let LqrWeights { q, r, s } = weights;
        Error::check_length("the state of a QuadraticCost", state.len(), model.state_size(StateSpec::PHYSICS))?;
        Error::check_shape("Q of a QuadraticCost", q.shape(), (nx, nx))?;
        Error::check_shape("R of a QuadraticCost", r.shape(), (nu, nu))?;
        if let Some(s) = &s {
            Error::check_shape("S of a QuadraticCost", s.shape(), (nx, nu))?;
        }
        Error::check_shape("the terminal weights of a QuadraticCost", terminal.shape(), (nx, nx))?;
        Ok(Self {
            state: state.to_vec(),
            controls: vec![0.0; nu],
            step: twice(&q),
            terminal: twice(&terminal),
            by_controls: twice(&r),
            mixed: s.map(twice_cross_term),
            quaternions: quaternions(&model),
            buffers: Buffers::default(),
            model,
        })
    }

    /// Sets the reference controls `(nu)`, which have no cost; zeros by default.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_controls(mut self, controls: &[f64]) -> Result<Self> {
        Error::check_length("the controls of a QuadraticCost", controls.len(), self.controls.len())?;
        self.controls.copy_from_slice(controls);
        Ok(self)
    }

    /// Writes `[dx; du]`, where `du` is zero without controls.
    fn deviations_into(&self, state: &[f64], controls: Option<&[f64]>, deviations: &mut [f64]) -> Result<()> {
        Error::check_length("a state of a QuadraticCost", state.len(), self.state.len())?;
        let (nq, nv) = (self.model.nq(), self.model.nv());
        let (dx, du) = deviations.split_at_mut(self.step.nrows());
        let (dq, rest) = dx.split_at_mut(nv);
        self.model.differentiate_pos_into(1.0, &self.state[..nq], &state[..nq], dq)?;
        subtract(&state[nq..], &self.state[nq..], rest);
        let Some(controls) = controls else {
            du.fill(0.0);
            return Ok(());
        };
        Error::check_length("the controls of a QuadraticCost", controls.len(), self.controls.len())?;
        subtract(controls, &self.controls, du);
        Ok(())
    }

    /// Calls `work` with `dx` and `du`.
    fn with_deviations<T>(
        &self,
        state: &[f64],
        controls: Option<&[f64]>,
        work: impl FnOnce(&[f64], &[f64]) -> Result<T>,
    ) -> Result<T> {
        let (nx, nu) = (self.step.nrows(), self.controls.len());
        let mut buffer = self.buffers.take(nx + nu);
        let result = self.deviations_into(state, controls, &mut buffer).and_then(|()| {
            let (dx, du) = buffer.split_at(nx);
            work(dx, du)
        });
        self.buffers.give_back(buffer);
        result
    }

    /// Multiplies the derivatives with respect to the deviation by the derivative of the deviation
    /// with respect to the state. Only the blocks of quaternions differ from the identity.
    fn apply_chain_rule(&self, state: &[f64], expansion: &mut CostExpansion) {
        for &[first, dof] in &self.quaternions {
            let quaternion = |state: &[f64]| -> [f64; 4] { std::array::from_fn(|index| state[first + index]) };
            let jacobian = sub_quat_derivative(&quaternion(state), &quaternion(&self.state)).da;
            let CostExpansion { x, xx, xu, .. } = &mut *expansion;
            multiply_by_transpose(&jacobian, &mut x[dof..]);
            for row in 0..xx.nrows() {
                multiply_by_transpose(&jacobian, &mut xx.row_mut(row)[dof..]);
            }
            for matrix in [xx, xu] {
                for column in 0..matrix.ncols() {
                    let mut part = [0, 1, 2].map(|axis| matrix[(dof + axis, column)]);
                    multiply_by_transpose(&jacobian, &mut part);
                    for (axis, value) in part.into_iter().enumerate() {
                        matrix[(dof + axis, column)] = value;
                    }
                }
            }
        }
    }
}

/// Returns the first index of each quaternion in `qpos`, and its first degree of freedom.
fn quaternions(model: &Model) -> Vec<[usize; 2]> {
    let joints = model.joints().filter_map(|joint| {
        let offset = match joint.joint_type() {
            JointType::Free => 3,
            JointType::Ball => 0,
            _ => return None,
        };
        Some([joint.qpos_range().start + offset, joint.dofs().start + offset])
    });
    joints.collect()
}

/// Writes the difference of two vectors.
fn subtract(values: &[f64], references: &[f64], differences: &mut [f64]) {
    for ((difference, value), reference) in differences.iter_mut().zip(values).zip(references) {
        *difference = value - reference;
    }
}

/// Returns the sum of a square matrix and its transpose.
fn twice(matrix: &Matrix) -> Matrix {
    let mut sum = matrix.clone();
    for row in 0..matrix.nrows() {
        for column in 0..matrix.ncols() {
            sum[(row, column)] += matrix[(column, row)];
        }
    }
    sum
}

/// Returns twice a matrix.
fn twice_cross_term(mut matrix: Matrix) -> Matrix {
    matrix.as_mut_slice().iter_mut().for_each(|value| *value *= 2.0);
    matrix
}

/// Multiplies the first three numbers by the transpose of a 3×3 matrix.
fn multiply_by_transpose(matrix: &[f64; 9], numbers: &mut [f64]) {
    let part = numbers.first_chunk_mut().expect("Bug: a rotation has fewer than three degrees of freedom");
    *part = rot_vec_mat_t(part, matrix);
}

/// Returns `vectorᵀ · matrix · other`, without a buffer.
fn product(vector: &[f64], matrix: &Matrix, other: &[f64]) -> f64 {
    matrix.rows().zip(vector).map(|(row, factor)| factor * dot(row, other)).sum()
}

/// Computes `result += matrix · vector`.
fn add_image(result: &mut [f64], matrix: &Matrix, vector: &[f64]) {
    result.iter_mut().zip(matrix.rows()).for_each(|(result, row)| *result += dot(row, vector));
}

impl TrajectoryCost for QuadraticCost {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        self.with_deviations(state, controls, |dx, du| {
            if controls.is_none() {
                return Ok(0.5 * product(dx, &self.terminal, dx));
            }
            let mixed = self.mixed.as_ref().map_or(0.0, |mixed| product(dx, mixed, du));
            Ok(0.5 * (product(dx, &self.step, dx) + product(du, &self.by_controls, du)) + mixed)
        })
    }

    fn expand(
        &self,
        _step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        expansion.check_shapes(self.step.nrows(), self.controls.len())?;
        self.with_deviations(state, controls, |dx, du| {
            let CostExpansion { x, u, xx, uu, xu } = &mut *expansion;
            let by_state = if controls.is_some() { &self.step } else { &self.terminal };
            xx.as_mut_slice().copy_from_slice(by_state.as_slice());
            x.fill(0.0);
            add_image(x, xx, dx);
            if controls.is_some() {
                uu.as_mut_slice().copy_from_slice(self.by_controls.as_slice());
                u.fill(0.0);
                add_image(u, uu, du);
                if let Some(mixed) = &self.mixed {
                    xu.as_mut_slice().copy_from_slice(mixed.as_slice());
                    add_image(x, xu, du);
                    add_product(u, xu, dx, 1.0);
                }
            }
            self.apply_chain_rule(state, expansion);
            Ok(())
        })
    }
}
