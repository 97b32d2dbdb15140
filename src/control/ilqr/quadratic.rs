//! The quadratic cost of the deviation from a state.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{DMatrix, DVectorView, Matrix3, Vector3};

use super::cost::{CostExpansion, TrajectoryCost};
use crate::control::LqrWeights;
use crate::data::StateSpec;
use crate::derivative;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::math::sub_quat_derivative;
use crate::model::{IntoModel, Model};

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
/// use mujoco_safe::{LqrWeights, sample};
/// use nalgebra::DMatrix;
///
/// let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
/// let cost = QuadraticCost::new(sample::cartpole(), &[0.0; 4], weights, DMatrix::identity(4, 4))?;
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
    step: DMatrix<f64>,
    terminal: DMatrix<f64>,
    by_controls: DMatrix<f64>,
    mixed: Option<DMatrix<f64>>,
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
    pub fn new(model: impl IntoModel, state: &[f64], weights: LqrWeights, terminal: DMatrix<f64>) -> Result<Self> {
        let model = model.into_model();
        let (nx, nu, _) = derivative::sizes(&model);
        let LqrWeights { q, r, s } = weights;
        Error::check_length("the state of a QuadraticCost", state.len(), model.state_size(StateSpec::PHYSICS))?;
        Error::check_shape("Q of a QuadraticCost", q.shape(), (nx, nx))?;
        Error::check_shape("R of a QuadraticCost", r.shape(), (nu, nu))?;
        if let Some(s) = &s {
            Error::check_shape("S of a QuadraticCost", s.shape(), (nx, nu))?;
        }
        Error::check_shape("the terminal weights of a QuadraticCost", terminal.shape(), (nx, nx))?;
        let twice = |matrix: DMatrix<f64>| &matrix + matrix.transpose();
        Ok(Self {
            state: state.to_vec(),
            controls: vec![0.0; nu],
            step: twice(q),
            terminal: twice(terminal),
            by_controls: twice(r),
            mixed: s.map(|s| s * 2.0),
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
        work: impl FnOnce(DVectorView<'_, f64>, DVectorView<'_, f64>) -> Result<T>,
    ) -> Result<T> {
        let (nx, nu) = (self.step.nrows(), self.controls.len());
        let mut buffer = self.buffers.take(nx + nu);
        let result = self.deviations_into(state, controls, &mut buffer).and_then(|()| {
            let (dx, du) = buffer.split_at(nx);
            work(DVectorView::from_slice(dx, nx), DVectorView::from_slice(du, nu))
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
            let transpose = Matrix3::from_column_slice(&jacobian);
            let CostExpansion { x, xx, xu, .. } = &mut *expansion;
            let product = transpose * x.fixed_rows::<3>(dof);
            x.fixed_rows_mut::<3>(dof).copy_from(&product);
            for row in 0..xx.nrows() {
                let product = transpose * Vector3::new(xx[(row, dof)], xx[(row, dof + 1)], xx[(row, dof + 2)]);
                xx.fixed_view_mut::<1, 3>(row, dof).copy_from(&product.transpose());
            }
            for matrix in [xx, xu] {
                for mut column in matrix.column_iter_mut() {
                    let product = transpose * column.fixed_rows::<3>(dof);
                    column.fixed_rows_mut::<3>(dof).copy_from(&product);
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

/// Returns `vectorᵀ · matrix · other`, without a buffer.
fn product(vector: DVectorView<'_, f64>, matrix: &DMatrix<f64>, other: DVectorView<'_, f64>) -> f64 {
    matrix.column_iter().zip(other.iter()).map(|(column, factor)| factor * column.dot(&vector)).sum()
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
            xx.copy_from(if controls.is_some() { &self.step } else { &self.terminal });
            x.gemv(1.0, xx, &dx, 0.0);
            if controls.is_some() {
                uu.copy_from(&self.by_controls);
                u.gemv(1.0, uu, &du, 0.0);
                if let Some(mixed) = &self.mixed {
                    xu.copy_from(mixed);
                    x.gemv(1.0, xu, &du, 1.0);
                    u.gemv_tr(1.0, xu, &dx, 1.0);
                }
            }
            self.apply_chain_rule(state, expansion);
            Ok(())
        })
    }
}
