//! Costs of trajectories.

use crate::data::Data;
use crate::derivative;
use crate::error::{Error, Result};
use crate::matrix::{Matrix, MatrixView};
use crate::model::Model;

/// Cost of a trajectory: the sum of the costs of all steps and of a terminal cost.
///
/// A state is `[qpos; qvel; act]`. Without controls, the methods refer to the terminal cost, and
/// the state is the one after all steps. Several threads call the methods at the same time, for
/// different steps or trajectories.
///
/// [`QuadraticCost`](super::QuadraticCost) penalises the deviation from a state, and
/// [`ResidualCost`](crate::control::residual::ResidualCost) functions of poses, velocities, momenta
/// and sensors.
pub trait TrajectoryCost: Sync {
    /// Prepares for trajectories that start in the present state of `data`. A cost that depends on
    /// time, mocap poses or applied forces reads them here. By default does nothing.
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

    /// Writes the first and second derivatives of [`value`](Self::value). All entries of
    /// `expansion` are zero before the call. By default returns [`Error::Unsupported`], which
    /// suffices for a [`SamplingPlanner`](crate::control::predictive::SamplingPlanner).
    ///
    /// # Errors
    ///
    /// Any error of the cost, which ends the search.
    fn expand(
        &self,
        _step: usize,
        _state: &[f64],
        _controls: Option<&[f64]>,
        _expansion: &mut CostExpansion,
    ) -> Result<()> {
        Err(Error::Unsupported("this cost has no derivatives, which iLQR needs".to_owned()))
    }

    /// Returns the cost of a trajectory of `N` steps, without derivatives: `states`
    /// `(N + 1, nq + nv + na)` and `controls` `(N, nu)`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] unless there is one state more than controls, and the errors of
    /// [`value`](Self::value).
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

/// First and second derivatives of a cost with respect to the state, in its tangent space of
/// dimension `nx = 2 nv + na`, and with respect to the `nu` controls.
#[derive(Clone, Debug, PartialEq)]
pub struct CostExpansion {
    /// `(nx)`: gradient with respect to the state.
    pub x: Vec<f64>,
    /// `(nu)`: gradient with respect to the controls.
    pub u: Vec<f64>,
    /// `(nx, nx)`: second derivatives with respect to the state.
    pub xx: Matrix,
    /// `(nu, nu)`: second derivatives with respect to the controls.
    pub uu: Matrix,
    /// `(nx, nu)`: mixed second derivatives.
    pub xu: Matrix,
}

impl CostExpansion {
    /// Creates an expansion of zeros with the shapes for a model.
    pub fn zeros(model: &Model) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self {
            x: vec![0.0; nx],
            u: vec![0.0; nu],
            xx: Matrix::zeros(nx, nx),
            uu: Matrix::zeros(nu, nu),
            xu: Matrix::zeros(nx, nu),
        }
    }

    pub(super) fn clear(&mut self) {
        self.x.fill(0.0);
        self.u.fill(0.0);
        for matrix in [&mut self.xx, &mut self.uu, &mut self.xu] {
            matrix.as_mut_slice().fill(0.0);
        }
    }

    /// Checks the shapes, and that all entries are finite.
    pub(super) fn check(&self, step: usize, nx: usize, nu: usize) -> Result<()> {
        self.check_shapes(nx, nu)?;
        let all = [self.x.as_slice(), self.u.as_slice(), self.xx.as_slice(), self.uu.as_slice(), self.xu.as_slice()];
        match all.into_iter().flatten().find(|value| !value.is_finite()) {
            None => Ok(()),
            Some(value) => Err(Error::not_finite(format!("a derivative of the cost of step {step}"), value)),
        }
    }

    /// Checks the shapes, because a [`TrajectoryCost`] can replace the matrices.
    pub(super) fn check_shapes(&self, nx: usize, nu: usize) -> Result<()> {
        Error::check_length("x of a CostExpansion", self.x.len(), nx)?;
        Error::check_length("u of a CostExpansion", self.u.len(), nu)?;
        Error::check_shape("xx of a CostExpansion", self.xx.shape(), (nx, nx))?;
        Error::check_shape("uu of a CostExpansion", self.uu.shape(), (nu, nu))?;
        Error::check_shape("xu of a CostExpansion", self.xu.shape(), (nx, nu))
    }
}
