//! Time derivative of the Jacobian of a point.

use super::Jacobian;
use crate::data::{Data, PipelineFlags};
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;
use crate::matrix::Matrix;
use crate::numerics::spatial::{add, angular, cross, cross_motion, linear};

/// Results that the derivative is computed from.
const INPUTS: PipelineFlags = PipelineFlags::KINEMATICS.union(PipelineFlags::COM_POS).union(PipelineFlags::COM_VEL);

/// # Jacobians
impl Data {
    /// Computes the time derivative of the Jacobian of a point that moves with a body. The point is
    /// in metres, world frame. The acceleration of the point is `jac · qacc + jac_dot · qvel`.
    ///
    /// Implemented in Rust. The results differ from those of `mj_jacDot` in engines since 3.3.1 in
    /// the last bits at most; the function of 3.2.5 to 3.3.0 has other results.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_vel`](Self::com_vel), which [`forward`](Self::forward) and
    /// [`step`](Self::step) compute too.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.joint_mut("left_knee")?.qvel_mut()[0] = 1.0;
    /// data.forward()?;
    /// let foot = data.body("foot_left")?.xpos();
    /// let rate = data.jac_dot(*foot, "foot_left")?;
    /// assert_eq!(rate.linear.shape(), (3, data.model().nv()));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_jacDot")]
    pub fn jac_dot(&self, point: [f64; 3], body: impl IntoId<kind::Body>) -> Result<Jacobian> {
        let mut rate = self.zero_jacobian();
        self.jac_dot_into(point, body, Some(&mut rate.linear), Some(&mut rate.angular))?;
        Ok(rate)
    }

    /// Writes the derivatives of [`jac_dot`](Self::jac_dot) to matrices of the shape `(3, nv)`.
    /// Matrices that are `None` are not computed.
    ///
    /// # Errors
    ///
    /// As for [`jac_dot`](Self::jac_dot), and [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jacDot")]
    pub fn jac_dot_into(
        &self,
        point: [f64; 3],
        body: impl IntoId<kind::Body>,
        mut translation: Option<&mut Matrix>,
        mut rotation: Option<&mut Matrix>,
    ) -> Result<()> {
        let model = self.model();
        let body = body.id_in(&**model)?.index();
        self.check_parts("jac_dot", INPUTS)?;
        for (what, output) in [("translation", &translation), ("rotation", &rotation)] {
            output.as_ref().map_or(Ok(()), |output| Error::check_shape(what, output.shape(), (3, model.nv())))?;
        }
        for output in [translation.as_deref_mut(), rotation.as_deref_mut()].into_iter().flatten() {
            output.as_mut_slice().fill(0.0);
        }
        let origin = self.subtree_com()[ffi::size(model.body_rootid()[body])];
        let offset = [0, 1, 2].map(|axis| point[axis] - origin[axis]);
        // The velocity of the point is about the centre of mass, as the axes of the motions are.
        let motion = &self.cvel()[body];
        let velocity = add(&linear(motion), &cross(&angular(motion), &offset));
        let mut next = self.last_dof(body);
        while let Some(dof) = next {
            let rate = self.axis_rate(dof);
            if let Some(rotation) = &mut rotation {
                for row in 0..3 {
                    rotation[(row, dof)] = rate[row];
                }
            }
            if let Some(translation) = &mut translation {
                let turning = add(&linear(&rate), &cross(&angular(&rate), &offset));
                let column = add(&turning, &cross(&angular(&self.cdof()[dof]), &velocity));
                for (row, value) in column.into_iter().enumerate() {
                    translation[(row, dof)] = value;
                }
            }
            next = usize::try_from(model.dof_parentid()[dof]).ok();
        }
        Ok(())
    }

    /// Returns the time derivative of the spatial axis of a degree of freedom. The axes of a
    /// rotation by a quaternion turn with the body itself; `cdof_dot` has the derivatives for the
    /// velocities of the earlier axes only.
    fn axis_rate(&self, dof: usize) -> [f64; 6] {
        let model = self.model();
        let joint = ffi::size(model.dof_jntid()[dof]);
        let turns_with_body = match JointType::of_field(model.jnt_type()[joint]) {
            JointType::Ball => true,
            JointType::Free => dof >= ffi::size(model.jnt_dofadr()[joint]) + 3,
            JointType::Slide | JointType::Hinge => false,
        };
        if turns_with_body {
            cross_motion(&self.cvel()[ffi::size(model.dof_bodyid()[dof])], &self.cdof()[dof])
        } else {
            self.cdof_dot()[dof]
        }
    }
}
