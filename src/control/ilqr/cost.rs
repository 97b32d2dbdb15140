//! What a trajectory costs.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3};

use crate::control::LqrWeights;
use crate::data::StateSpec;
use crate::derivative;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::math::sub_quat_derivative;
use crate::model::Model;

/// What a trajectory costs: the sum of what each step costs, and of what it costs to end where it ends.
///
/// A state is `[qpos; qvel; act]`. Without controls it is the last one, after all steps.
pub trait TrajectoryCost: Sync {
    /// What step `step` costs that begins in this state, under these controls.
    fn value(&self, step: usize, state: &[f64], controls: Option<&[f64]>) -> f64;

    /// Writes how [`value`](Self::value) changes, to first and second order; the expansion is all zeros before.
    fn expand(&self, step: usize, state: &[f64], controls: Option<&[f64]>, expansion: &mut CostExpansion);
}

/// The first and second derivatives of a cost by the state, of which there are `nx = 2 nv + na` in its tangent space, and by the
/// `nu` controls.
#[derive(Clone, Debug, PartialEq)]
pub struct CostExpansion {
    /// `(nx)`: the gradient by the state.
    pub x: DVector<f64>,
    /// `(nu)`: the gradient by the controls.
    pub u: DVector<f64>,
    /// `(nx, nx)`: the second derivatives by the state.
    pub xx: DMatrix<f64>,
    /// `(nu, nu)`: the second derivatives by the controls.
    pub uu: DMatrix<f64>,
    /// `(nx, nu)`: the mixed second derivatives.
    pub xu: DMatrix<f64>,
}

impl CostExpansion {
    /// Zeros, in the shapes that belong to a model.
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

    /// Whether the shapes are still what they were, as a cost can put in others, and all entries are numbers.
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

/// The cost of a deviation from a state in which the trajectory is to end, and from controls that cost nothing:
/// `dxᵀQdx + duᵀRdu + 2dxᵀSdu` in each step, and `dxᵀPdx` at the end, with the difference of states as in
/// [`Lqr`](crate::Lqr), so that quaternions are treated as rotations. Its second derivatives leave out those of the
/// difference itself (Gauss and Newton's approximation), which is none for models without quaternions.
///
/// A state or controls of a wrong length are a panic.
///
/// ```
/// use mujoco_safe::control::ilqr::{QuadraticCost, TrajectoryCost};
/// use mujoco_safe::{LqrWeights, sample};
/// use nalgebra::DMatrix;
///
/// let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
/// let cost = QuadraticCost::new(sample::cartpole(), &[0.0; 4], weights, DMatrix::identity(4, 4))?;
/// assert_eq!(cost.value(0, &[0.0, 0.1, 0.0, 0.0], Some(&[0.5])), 10.0 * 0.1 * 0.1 + 0.5 * 0.5);
/// assert_eq!(cost.value(100, &[0.0, 0.0, 0.0, 2.0], None), 4.0);
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
    /// The cost of a deviation from this state, `[qpos; qvel; act]`, with the weights of each step, and `(nx, nx)` weights of
    /// where it ends. Matrices stand for their symmetric parts.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape.
    pub fn new(
        model: impl Into<Arc<Model>>,
        state: &[f64],
        weights: LqrWeights,
        terminal: DMatrix<f64>,
    ) -> Result<Self> {
        let model = model.into();
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

    /// With these controls `(nu)` at no cost, instead of zeros.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_controls(mut self, controls: &[f64]) -> Result<Self> {
        Error::check_length("the controls of a QuadraticCost", controls.len(), self.controls.len())?;
        self.controls.copy_from_slice(controls);
        Ok(self)
    }

    /// `dx`.
    fn deviation(&self, state: &[f64]) -> DVector<f64> {
        let (found, expected) = (state.len(), self.state.len());
        assert!(found == expected, "a state of {found} numbers for a QuadraticCost of states of {expected}");
        let (nq, nv) = (self.model.nq(), self.model.nv());
        let mut dx = DVector::zeros(2 * nv + self.model.na());
        let (dq, rest) = dx.as_mut_slice().split_at_mut(nv);
        self.model.differentiate_pos(dq, 1.0, &self.state[..nq], &state[..nq]).expect("Bug: the lengths were checked");
        for ((rest, value), target) in rest.iter_mut().zip(&state[nq..]).zip(&self.state[nq..]) {
            *rest = value - target;
        }
        dx
    }

    /// `du`.
    fn change(&self, controls: &[f64]) -> DVector<f64> {
        let (found, expected) = (controls.len(), self.controls.len());
        assert!(found == expected, "{found} controls for a QuadraticCost of {expected}");
        DVector::from_iterator(
            controls.len(),
            controls.iter().zip(&self.controls).map(|(control, free)| control - free),
        )
    }

    /// How the deviation changes with the state: `(nx, nx)`, and the identity but for quaternions.
    fn derivative_of_deviation(&self, state: &[f64]) -> Option<DMatrix<f64>> {
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
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> f64 {
        let dx = self.deviation(state);
        let Some(controls) = controls else { return dx.dot(&(&self.terminal * &dx)) };
        let du = self.change(controls);
        let cross = self.weights.s.as_ref().map_or(0.0, |s| 2.0 * dx.dot(&(s * &du)));
        dx.dot(&(&self.weights.q * &dx)) + du.dot(&(&self.weights.r * &du)) + cross
    }

    fn expand(&self, _step: usize, state: &[f64], controls: Option<&[f64]>, expansion: &mut CostExpansion) {
        let twice = |matrix: &DMatrix<f64>| matrix + matrix.transpose();
        let dx = self.deviation(state);
        expansion.xx = twice(if controls.is_some() { &self.weights.q } else { &self.terminal });
        expansion.x = &expansion.xx * &dx;
        if let Some(controls) = controls {
            let du = self.change(controls);
            expansion.uu = twice(&self.weights.r);
            expansion.u = &expansion.uu * &du;
            if let Some(s) = &self.weights.s {
                expansion.xu = 2.0 * s;
                expansion.x += &expansion.xu * &du;
                expansion.u += expansion.xu.transpose() * &dx;
            }
        }
        if let Some(jacobian) = self.derivative_of_deviation(state) {
            let transpose = jacobian.transpose();
            expansion.x = &transpose * &expansion.x;
            expansion.xx = &transpose * &expansion.xx * jacobian;
            expansion.xu = transpose * &expansion.xu;
        }
    }
}
