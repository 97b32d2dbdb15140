//! Regressors: matrices by which the forces of rigid bodies depend on their inertial parameters.
//!
//! The spatial equation `f = I a + v ×* I v` of a body is linear in the ten numbers of I, and so
//! are the forces `τ_k = Σ S_k · f` of inverse dynamics. The acceleration of the world is minus
//! gravity.

use super::inertial::unit;
use crate::data::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::BodyId;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::spatial::{
    Inertia, Spatial, Vec3, add, add_scaled, angular, cross_force, linear, momentum, spatial, sub, velocity_at, wrench,
};

/// Velocity and acceleration of a body about its origin, in its axes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::derivative) struct BodyMotion {
    pub(in crate::derivative) velocity: Spatial,
    pub(in crate::derivative) acceleration: Spatial,
}

/// Frame of a body, relative to the reference point of its tree and the world's axes.
#[derive(Clone, Copy, Debug)]
pub(in crate::derivative) struct BodyFrame {
    /// Row-major.
    rotation: [f64; 9],
    arm: Vec3,
}

impl BodyFrame {
    pub(in crate::derivative) fn of(data: &Data, body: usize) -> Self {
        let root = ffi::size(data.model().body_rootid()[body]);
        Self { rotation: data.xmat()[body], arm: sub(&data.xpos()[body], &data.subtree_com()[root]) }
    }

    /// Returns a vector of the body in the world's axes.
    pub(in crate::derivative) fn to_world(self, vector: &Vec3) -> Vec3 {
        std::array::from_fn(|row| (0..3).map(|i| self.rotation[3 * row + i] * vector[i]).sum())
    }

    fn to_local(self, vector: &Vec3) -> Vec3 {
        std::array::from_fn(|axis| (0..3).map(|i| self.rotation[3 * i + axis] * vector[i]).sum())
    }

    /// Returns a motion vector about the reference point as one of the body.
    pub(in crate::derivative) fn motion(self, motion: &Spatial) -> Spatial {
        spatial(&self.to_local(&angular(motion)), &self.to_local(&velocity_at(motion, &self.arm)))
    }

    /// Returns a force vector of the body as one about the reference point.
    pub(in crate::derivative) fn force(self, force: &Spatial) -> Spatial {
        wrench(&self.to_world(&angular(force)), &self.to_world(&linear(force)), &self.arm)
    }

    /// Returns the present motion of the body.
    pub(in crate::derivative) fn present_motion(self, data: &Data, body: usize) -> BodyMotion {
        BodyMotion { velocity: self.motion(&data.cvel()[body]), acceleration: self.motion(&acceleration(data, body)) }
    }
}

impl BodyMotion {
    /// Returns the force that a change of the inertia needs.
    pub(in crate::derivative) fn force(&self, change: &[f64; 10]) -> Spatial {
        let inertia = in_engine_order(change);
        let of_velocity = momentum(&inertia, &self.velocity);
        add(&momentum(&inertia, &self.acceleration), &cross_force(&self.velocity, &of_velocity))
    }
}

/// Returns ten inertial parameters in the order of the engine.
fn in_engine_order(change: &[f64; 10]) -> Inertia {
    let [mass, x, y, z, xx, yy, zz, xy, xz, yz] = *change;
    [xx, yy, zz, xy, xz, yz, x, y, z, mass]
}

/// Returns the last degree of freedom that moves a body.
pub(in crate::derivative) fn last_dof(model: &Model, mut body: usize) -> Option<usize> {
    while body > 0 {
        let count = ffi::size(model.body_dofnum()[body]);
        if count > 0 {
            return Some(ffi::size(model.body_dofadr()[body]) + count - 1);
        }
        body = ffi::size(model.body_parentid()[body]);
    }
    None
}

/// Returns the degrees of freedom that move a body, from the last to the first.
pub(in crate::derivative) fn chain(model: &Model, body: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(last_dof(model, body), |&dof| usize::try_from(model.dof_parentid()[dof]).ok())
}

/// Returns the acceleration of a body about the reference point of its tree, minus gravity.
fn acceleration(data: &Data, body: usize) -> Spatial {
    let model = data.model();
    let options = &model.raw().opt;
    let mut sum = [0.0; 6];
    if options.disableflags as u32 & DisableFlags::GRAVITY.bits() == 0 {
        (0..3).for_each(|axis| sum[3 + axis] = -options.gravity[axis]);
    }
    for dof in chain(model, body) {
        add_scaled(&mut sum, &data.cdof()[dof], data.qacc()[dof]);
        add_scaled(&mut sum, &data.cdof_dot()[dof], data.qvel()[dof]);
    }
    sum
}

/// # Regressors
impl Data {
    /// Returns the regressor of the spatial equation of a body, `(6, 10)`: its product with the
    /// [inertial parameters](super::InertialParameters) is the sum `[torque; force]` of all forces
    /// except gravity that the motion of the body takes, about the origin of the body and in its
    /// axes, N·m and N, at the present positions, velocities and accelerations
    /// ([`qacc`](Self::qacc)).
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before velocities were computed.
    ///
    /// # Panics
    ///
    /// If the body belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::derivative::InertialParameters;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.forward()?;
    /// data.qacc_mut().fill(0.0);
    /// let cart = data.model().body("cart")?.id();
    /// let regressor = data.body_regressor(cart)?;
    /// // At rest, the cart needs its weight.
    /// assert!((regressor[(5, 0)] - 9.81).abs() < 1e-12);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// Source: C. Atkeson, C. An and J. Hollerbach, "Estimation of inertial parameters of
    /// manipulator loads and links", IJRR 1986.
    #[doc(alias = "bodyRegressor")]
    pub fn body_regressor(&self, body: BodyId) -> Result<Matrix> {
        let mut regressor = Matrix::zeros(6, 10);
        self.body_regressor_into(body, &mut regressor)?;
        Ok(regressor)
    }

    /// Writes the matrix of [`body_regressor`](Self::body_regressor). Allocates nothing.
    ///
    /// # Errors
    ///
    /// As for [`body_regressor`](Self::body_regressor), and [`Error::Shape`] unless the result is
    /// `(6, 10)`.
    ///
    /// # Panics
    ///
    /// If the body belongs to another model.
    pub fn body_regressor_into(&self, body: BodyId, regressor: &mut Matrix) -> Result<()> {
        let body = self.model().body(body).id().index();
        self.check_computed("body_regressor", Stage::Velocity)?;
        Error::check_shape("the result of body_regressor", regressor.shape(), (6, 10))?;
        let motion = BodyFrame::of(self, body).present_motion(self, body);
        for column in 0..10 {
            for (row, value) in motion.force(&unit(column)).into_iter().enumerate() {
                regressor[(row, column)] = value;
            }
        }
        Ok(())
    }

    /// Returns the regressor of inverse dynamics, `(nv, 10 nbody)`: its product with the
    /// [inertial parameters](super::InertialParameters) of all bodies, in their order, is the
    /// generalised force `M a + c` of the rigid bodies without armature, at the present positions,
    /// velocities and accelerations ([`qacc`](Self::qacc)). The columns of the world are zero.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before velocities were computed.
    ///
    /// ```
    /// use mujoco_safe::derivative::InertialParameters;
    /// use mujoco_safe::data::Accelerations;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.qvel_mut().fill(0.3);
    /// data.forward()?;
    /// let regressor = data.joint_regressor()?;
    /// let model = data.model().clone();
    /// let parameters: Vec<f64> = model.bodies().flat_map(|body| InertialParameters::of(&model, body.id()).0).collect();
    /// let mut expected = vec![0.0; model.nv()];
    /// data.rne_into(Accelerations::Present, &mut expected)?;
    /// for (row, expected) in regressor.rows().zip(expected) {
    ///     let force: f64 = row.iter().zip(&parameters).map(|(number, parameter)| number * parameter).sum();
    ///     assert!((force - expected).abs() < 1e-8);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "regressor")]
    #[doc(alias = "jointTorqueRegressor")]
    #[doc(alias = "computeJointTorqueRegressor")]
    pub fn joint_regressor(&self) -> Result<Matrix> {
        let mut regressor = Matrix::zeros(self.model().nv(), 10 * self.model().nbody());
        self.joint_regressor_into(&mut regressor)?;
        Ok(regressor)
    }

    /// Writes the matrix of [`joint_regressor`](Self::joint_regressor). Allocates nothing.
    ///
    /// # Errors
    ///
    /// As for [`joint_regressor`](Self::joint_regressor), and [`Error::Shape`] unless the result is
    /// `(nv, 10 nbody)`.
    pub fn joint_regressor_into(&self, regressor: &mut Matrix) -> Result<()> {
        let model = self.model();
        self.check_computed("joint_regressor", Stage::Velocity)?;
        Error::check_shape("the result of joint_regressor", regressor.shape(), (model.nv(), 10 * model.nbody()))?;
        regressor.as_mut_slice().fill(0.0);
        for body in 1..model.nbody() {
            let frame = BodyFrame::of(self, body);
            let motion = frame.present_motion(self, body);
            for number in 0..10 {
                let force = frame.force(&motion.force(&unit(number)));
                for dof in chain(model, body) {
                    regressor[(dof, 10 * body + number)] = crate::numerics::spatial::dot(&self.cdof()[dof], &force);
                }
            }
        }
        Ok(())
    }
}
