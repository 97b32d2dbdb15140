//! Derivatives of inverse dynamics by finite differences, and in closed form.

mod differences;
mod lineariser;

use self::differences::InversePerturbation;
use super::check_eps;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Derivatives of inverse dynamics: of the forces f (`qfrc_inverse`), the sensors s (`sensordata`)
/// and the inertia matrix m (`qM`, in the engine's sparse layout) with respect to positions q,
/// velocities v and accelerations a.
///
/// As in the engine, **a row belongs to an input** and a column to an output, which is the
/// transpose of a Jacobian in control theory: `df_dv[(i, j)]` is the derivative of
/// `qfrc_inverse[j]` with respect to `qvel[i]`. Positions are perturbed in their tangent space, one
/// degree of freedom at a time, as by [`Model::integrate_pos`](crate::Model::integrate_pos).
#[derive(Clone, Debug, PartialEq)]
pub struct InverseJacobians {
    /// `(nv, nv)`: derivatives of forces with respect to positions.
    #[doc(alias = "DfDq")]
    pub df_dq: Matrix,
    /// `(nv, nv)`: derivatives of forces with respect to velocities.
    #[doc(alias = "DfDv")]
    pub df_dv: Matrix,
    /// `(nv, nv)`: derivatives of forces with respect to accelerations. Without constraints this is
    /// the inertia matrix.
    #[doc(alias = "DfDa")]
    pub df_da: Matrix,
    /// `(nv, nsensordata)`: derivatives of sensors with respect to positions.
    #[doc(alias = "DsDq")]
    pub ds_dq: Matrix,
    /// `(nv, nsensordata)`: derivatives of sensors with respect to velocities.
    #[doc(alias = "DsDv")]
    pub ds_dv: Matrix,
    /// `(nv, nsensordata)`: derivatives of sensors with respect to accelerations.
    #[doc(alias = "DsDa")]
    pub ds_da: Matrix,
    /// `(nv, nM)`: derivatives of the inertia matrix with respect to positions.
    #[doc(alias = "DmDq")]
    pub dm_dq: Matrix,
}

impl InverseJacobians {
    /// Creates zeros in the shapes for a model.
    pub fn zeros(model: &Model) -> Self {
        let (nv, ns) = (model.nv(), model.nsensordata());
        let (force, sensor) = (Matrix::zeros(nv, nv), Matrix::zeros(nv, ns));
        Self {
            df_dq: force.clone(),
            df_dv: force.clone(),
            df_da: force,
            ds_dq: sensor.clone(),
            ds_dv: sensor.clone(),
            ds_da: sensor,
            dm_dq: Matrix::zeros(nv, model.inertia_len()),
        }
    }
}

/// Outputs of [`Data::inverse_fd_into`] and
/// [`Lineariser::inverse_jacobians_into`](super::Lineariser::inverse_jacobians_into). Matrices that
/// are `None` are not computed, at no cost.
#[derive(Debug, Default)]
pub struct InverseOutputs<'a> {
    /// `(nv, nv)`
    pub df_dq: Option<&'a mut Matrix>,
    /// `(nv, nv)`
    pub df_dv: Option<&'a mut Matrix>,
    /// `(nv, nv)`
    pub df_da: Option<&'a mut Matrix>,
    /// `(nv, nsensordata)`
    pub ds_dq: Option<&'a mut Matrix>,
    /// `(nv, nsensordata)`
    pub ds_dv: Option<&'a mut Matrix>,
    /// `(nv, nsensordata)`
    pub ds_da: Option<&'a mut Matrix>,
    /// `(nv, nM)`
    pub dm_dq: Option<&'a mut Matrix>,
}

impl<'a> From<&'a mut InverseJacobians> for InverseOutputs<'a> {
    fn from(jacobians: &'a mut InverseJacobians) -> Self {
        Self {
            df_dq: Some(&mut jacobians.df_dq),
            df_dv: Some(&mut jacobians.df_dv),
            df_da: Some(&mut jacobians.df_da),
            ds_dq: Some(&mut jacobians.ds_dq),
            ds_dv: Some(&mut jacobians.ds_dv),
            ds_da: Some(&mut jacobians.ds_da),
            dm_dq: Some(&mut jacobians.dm_dq),
        }
    }
}

impl InverseOutputs<'_> {
    /// Returns the same outputs for a shorter time.
    fn reborrow(&mut self) -> InverseOutputs<'_> {
        InverseOutputs {
            df_dq: self.df_dq.as_deref_mut(),
            df_dv: self.df_dv.as_deref_mut(),
            df_da: self.df_da.as_deref_mut(),
            ds_dq: self.ds_dq.as_deref_mut(),
            ds_dv: self.ds_dv.as_deref_mut(),
            ds_da: self.ds_da.as_deref_mut(),
            dm_dq: self.dm_dq.as_deref_mut(),
        }
    }

    /// Checks the shapes of the matrices that are present.
    fn check(&self, model: &Model) -> Result<()> {
        let (nv, ns, nm) = (model.nv(), model.nsensordata(), model.inertia_len());
        for (what, output, columns) in [
            ("DfDq of inverse_fd", &self.df_dq, nv),
            ("DfDv of inverse_fd", &self.df_dv, nv),
            ("DfDa of inverse_fd", &self.df_da, nv),
            ("DsDq of inverse_fd", &self.ds_dq, ns),
            ("DsDv of inverse_fd", &self.ds_dv, ns),
            ("DsDa of inverse_fd", &self.ds_da, ns),
            ("DmDq of inverse_fd", &self.dm_dq, nm),
        ] {
            if let Some(output) = output {
                Error::check_shape(what, output.shape(), (nv, columns))?;
            }
        }
        Ok(())
    }
}

/// Generalised force that [`Data::inverse_fd`] differentiates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InverseForce {
    /// All forces of inverse dynamics: `qfrc_inverse`.
    Total,
    /// Without the forces of the actuators under the present controls:
    /// `qfrc_inverse − qfrc_actuator`.
    WithoutActuators,
}

/// # Derivatives of inverse dynamics
impl Data {
    /// Computes the derivatives of inverse dynamics at the present positions, velocities and
    /// accelerations (`qacc`), by forward differences with the step `eps`; `1e-6` is a good choice.
    ///
    /// The state, `qacc` and all inputs are unchanged afterwards, to the last bit, and everything
    /// else is as after [`inverse`](Self::inverse).
    /// [`Lineariser::inverse_jacobians`](super::Lineariser::inverse_jacobians) computes them in
    /// closed form, which is faster and more accurate. (Newer engines provide this function in C.
    /// They reject the Runge–Kutta integrator and the `noslip` solver, neither of which affects
    /// inverse dynamics.)
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1, and the errors of
    /// [`inverse`](Self::inverse). The state is unchanged even after [`Error::Engine`], which
    /// poisons the data.
    ///
    /// ```
    /// use mujoco_safe::derivative::InverseForce;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.3;
    /// let jacobians = data.inverse_fd(1e-6, InverseForce::Total)?;
    /// // Derivative of the moment at the hinge with respect to its angle.
    /// let stiffness = -0.5 * 9.81 * 0.3 * 0.3_f64.cos(); // mass, gravity, lever
    /// assert!((jacobians.df_dq[(1, 1)] - stiffness).abs() < 1e-5);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjd_inverseFD")]
    pub fn inverse_fd(&mut self, eps: f64, force: InverseForce) -> Result<InverseJacobians> {
        let mut jacobians = InverseJacobians::zeros(self.model());
        self.inverse_fd_into(eps, force, &mut jacobians)?;
        Ok(jacobians)
    }

    /// Computes the derivatives as [`inverse_fd`](Self::inverse_fd) does, into the caller's
    /// matrices, any of which may be omitted. Allocates nothing, but uses space for
    /// `nq + 3 nv + 4 nmocap + nu` numbers on the engine's stack.
    ///
    /// # Errors
    ///
    /// As for [`inverse_fd`](Self::inverse_fd), and [`Error::Shape`] for a wrong shape.
    ///
    /// ```
    /// use mujoco_safe::derivative::{InverseForce, InverseOutputs};
    /// use mujoco_safe::{Data, Matrix, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut df_da = Matrix::zeros(2, 2);
    /// data.inverse_fd_into(1e-6, InverseForce::Total, InverseOutputs { df_da: Some(&mut df_da), ..Default::default() })?;
    /// assert!((df_da[(0, 0)] - data.full_m()?[(0, 0)]).abs() < 1e-8);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjd_inverseFD")]
    pub fn inverse_fd_into<'a>(
        &mut self,
        eps: f64,
        force: InverseForce,
        outputs: impl Into<InverseOutputs<'a>>,
    ) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        check_eps("inverse_fd", eps)?;
        self.model().check_without_sleep("inverse_fd")?;
        let mut outputs = outputs.into();
        outputs.check(self.model())?;
        InversePerturbation::new(self, eps, force)?.differentiate(&mut outputs)
    }
}
