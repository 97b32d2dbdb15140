//! Costs of trajectories.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3};

use crate::control::LqrWeights;
use crate::data::{Data, StateSpec};
use crate::derivative;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::math::sub_quat_derivative;
use crate::matrix::MatrixView;
use crate::model::{IntoModel, Model};

/// Cost of a trajectory: the sum of the costs of all steps and of a terminal cost.
///
/// A state is `[qpos; qvel; act]`. Without controls, the methods refer to the terminal cost, and the state is the one after all
/// steps. Several threads call the methods at the same time, for different steps or trajectories.
///
/// [`QuadraticCost`] penalises the deviation from a state, and [`ResidualCost`](crate::control::residual::ResidualCost) functions of
/// poses, velocities, momenta and sensors.
pub trait TrajectoryCost: Sync {
    /// Prepares for trajectories that start in the present state of `data`. A cost that depends on time, mocap poses or applied
    /// forces reads them here. By default does nothing.
    ///
    /// # Errors
    ///
    /// Any error of the cost. The search then does not start.
    fn begin(&self, _data: &Data) -> Result<()> {
        Ok(())
    }

    /// Returns the cost of step `step`, which starts in this state under these controls.
    ///
    /// # Errors
    ///
    /// Any error of the cost. The line search discards the trajectory.
    fn value(&self, step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64>;

    /// Writes the first and second derivatives of [`value`](Self::value). All entries of `expansion` are zero before the call.
    ///
    /// # Errors
    ///
    /// Any error of the cost, which ends the search.
    fn expand(&self, step: usize, state: &[f64], controls: Option<&[f64]>, expansion: &mut CostExpansion)
    -> Result<()>;

    /// Returns the cost of a trajectory of `N` steps, without derivatives: `states` `(N + 1, nq + nv + na)` and `controls` `(N, nu)`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] unless there is one state more than controls, and the errors of [`value`](Self::value).
    fn total(&self, states: MatrixView<'_>, controls: MatrixView<'_>) -> Result<f64> {
        let steps = controls.nrows();
        Error::check_length("the states of a trajectory", states.nrows(), steps + 1)?;
        let mut sum = self.value(steps, states.row(steps), None)?;
        for (step, controls) in controls.rows().enumerate() {
            sum += self.value(step, states.row(step), Some(controls))?;
        }
        Ok(sum)
    }
}

/// First and second derivatives of a cost with respect to the state, in its tangent space of dimension `nx = 2 nv + na`, and with
/// respect to the `nu` controls.
#[derive(Clone, Debug, PartialEq)]
pub struct CostExpansion {
    /// `(nx)`: gradient with respect to the state.
    pub x: DVector<f64>,
    /// `(nu)`: gradient with respect to the controls.
    pub u: DVector<f64>,
    /// `(nx, nx)`: second derivatives with respect to the state.
    pub xx: DMatrix<f64>,
    /// `(nu, nu)`: second derivatives with respect to the controls.
    pub uu: DMatrix<f64>,
    /// `(nx, nu)`: mixed second derivatives.
    pub xu: DMatrix<f64>,
}

impl CostExpansion {
    /// Creates an expansion of zeros with the shapes for a model.
    pub fn zeros(model: &Model) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self {
            x: DVector::zeros(nx),
            u: DVector::zeros(nu),
            xx: DMatrix::zeros(nx, nx),
            uu: DMatrix::zeros(nu, nu),
            xu: DMatrix::zeros(nx, nu),
        }
    }

    pub(super) fn clear(&mut self) {
        self.x.fill(0.0);
        self.u.fill(0.0);
        self.xx.fill(0.0);
        self.uu.fill(0.0);
        self.xu.fill(0.0);
    }

    /// Checks the shapes, because a [`TrajectoryCost`] can replace the matrices, and that all entries are finite.
    pub(super) fn check(&self, step: usize, nx: usize, nu: usize) -> Result<()> {
        Error::check_length("x of a CostExpansion", self.x.len(), nx)?;
        Error::check_length("u of a CostExpansion", self.u.len(), nu)?;
        Error::check_shape("xx of a CostExpansion", self.xx.shape(), (nx, nx))?;
        Error::check_shape("uu of a CostExpansion", self.uu.shape(), (nu, nu))?;
        Error::check_shape("xu of a CostExpansion", self.xu.shape(), (nx, nu))?;
        let all = [self.x.as_slice(), self.u.as_slice(), self.xx.as_slice(), self.uu.as_slice(), self.xu.as_slice()];
        match all.into_iter().flatten().find(|value| !value.is_finite()) {
            None => Ok(()),
            Some(value) => Err(Error::invalid(format!("a derivative of the cost of step {step}"), value, "finite")),
        }
    }
}

/// Quadratic cost of the deviation from a target state and from reference controls: `dxᵀQdx + duᵀRdu + 2dxᵀSdu` in each step,
/// and `dxᵀPdx` at the end. There is no factor ½: the value is twice the cost of texts that minimise `½dxᵀQdx + …`. The cost-to-go
/// matrix of [`Lqr`](crate::Lqr) for the same weights is consistent with it as the terminal weights `P`.
///
/// The difference of states is that of [`Lqr`](crate::Lqr), which treats quaternions as rotations. The second derivatives omit
/// those of the difference itself (the Gauss–Newton approximation), which are zero for models without quaternions.
///
/// The methods of [`TrajectoryCost`] return [`Error::Shape`] for a state or controls of a wrong length.
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
    weights: LqrWeights,
    terminal: DMatrix<f64>,
}

impl QuadraticCost {
    /// Creates the cost of the deviation from a target state, `[qpos; qvel; act]`, with the weights of each step and the terminal
    /// weights `(nx, nx)`. Only the symmetric parts of the matrices matter.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape.
    pub fn new(model: impl IntoModel, state: &[f64], weights: LqrWeights, terminal: DMatrix<f64>) -> Result<Self> {
        let model = model.into_model();
        let (nx, nu, _) = derivative::sizes(&model);
        Error::check_length("the state of a QuadraticCost", state.len(), model.state_size(StateSpec::PHYSICS))?;
        Error::check_shape("Q of a QuadraticCost", weights.q.shape(), (nx, nx))?;
        Error::check_shape("R of a QuadraticCost", weights.r.shape(), (nu, nu))?;
        if let Some(s) = &weights.s {
            Error::check_shape("S of a QuadraticCost", s.shape(), (nx, nu))?;
        }
        Error::check_shape("the terminal weights of a QuadraticCost", terminal.shape(), (nx, nx))?;
        Ok(Self { controls: vec![0.0; nu], model, state: state.to_vec(), weights, terminal })
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

    /// Returns `dx`.
    fn deviation(&self, state: &[f64]) -> Result<DVector<f64>> {
        Error::check_length("a state of a QuadraticCost", state.len(), self.state.len())?;
        let (nq, nv) = (self.model.nq(), self.model.nv());
        let mut dx = DVector::zeros(2 * nv + self.model.na());
        let (dq, rest) = dx.as_mut_slice().split_at_mut(nv);
        self.model.differentiate_pos_into(1.0, &self.state[..nq], &state[..nq], dq)?;
        for ((rest, value), target) in rest.iter_mut().zip(&state[nq..]).zip(&self.state[nq..]) {
            *rest = value - target;
        }
        Ok(dx)
    }

    /// Returns `du`.
    fn control_deviation(&self, controls: &[f64]) -> Result<DVector<f64>> {
        Error::check_length("the controls of a QuadraticCost", controls.len(), self.controls.len())?;
        let deviations = controls.iter().zip(&self.controls).map(|(control, reference)| control - reference);
        Ok(DVector::from_iterator(controls.len(), deviations))
    }

    /// Returns the derivative of the deviation with respect to the state, `(nx, nx)`, or `None` if it is the identity, which is
    /// the case without quaternions.
    fn deviation_jacobian(&self, state: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = None;
        for joint in self.model.joints() {
            let (offset, dof) = match joint.joint_type() {
                JointType::Free => (3, 3),
                JointType::Ball => (0, 0),
                _ => continue,
            };
            let (first, dof) = (joint.qpos_range().start + offset, joint.dofs().start + dof);
            let quaternion = |state: &[f64]| -> [f64; 4] { std::array::from_fn(|index| state[first + index]) };
            let derivative = sub_quat_derivative(&quaternion(state), &quaternion(&self.state)).da;
            let nx = 2 * self.model.nv() + self.model.na();
            let jacobian = jacobian.get_or_insert_with(|| DMatrix::identity(nx, nx));
            jacobian.fixed_view_mut::<3, 3>(dof, dof).copy_from(&Matrix3::from_row_slice(&derivative));
        }
        jacobian
    }
}

impl TrajectoryCost for QuadraticCost {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        let dx = self.deviation(state)?;
        let Some(controls) = controls else { return Ok(dx.dot(&(&self.terminal * &dx))) };
        let du = self.control_deviation(controls)?;
        let cross = self.weights.s.as_ref().map_or(0.0, |s| 2.0 * dx.dot(&(s * &du)));
        Ok(dx.dot(&(&self.weights.q * &dx)) + du.dot(&(&self.weights.r * &du)) + cross)
    }

    fn expand(
        &self,
        _step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        let twice = |matrix: &DMatrix<f64>| matrix + matrix.transpose();
        let dx = self.deviation(state)?;
        expansion.xx = twice(if controls.is_some() { &self.weights.q } else { &self.terminal });
        expansion.x = &expansion.xx * &dx;
        if let Some(controls) = controls {
            let du = self.control_deviation(controls)?;
            expansion.uu = twice(&self.weights.r);
            expansion.u = &expansion.uu * &du;
            if let Some(s) = &self.weights.s {
                expansion.xu = 2.0 * s;
                expansion.x += &expansion.xu * &du;
                expansion.u += expansion.xu.transpose() * &dx;
            }
        }
        if let Some(jacobian) = self.deviation_jacobian(state) {
            let transpose = jacobian.transpose();
            expansion.x = &transpose * &expansion.x;
            expansion.xx = &transpose * &expansion.xx * jacobian;
            expansion.xu = transpose * &expansion.xu;
        }
        Ok(())
    }
}
