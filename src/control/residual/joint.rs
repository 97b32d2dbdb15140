//! Residuals of the positions and velocities of joints.

use std::ops::Range;

use super::{Needs, Residual, ResidualJacobian, check_model, subtract};
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{IntoId, Lineage};
use crate::kind;
use crate::math::{sub_quat, sub_quat_derivative};
use crate::model::Model;

/// Position and degrees of freedom of a joint.
#[derive(Clone, Debug)]
struct Coordinates {
    qpos: Range<usize>,
    dofs: Range<usize>,
    /// Offset of the quaternion from the first position, and from the first degree of freedom.
    quaternion: Option<usize>,
}

impl Coordinates {
    fn new(model: &Model, joint: usize) -> Self {
        let (qpos, dof) = (ffi::size(model.jnt_qposadr()[joint]), ffi::size(model.jnt_dofadr()[joint]));
        let (nq, nv, quaternion) = match JointType::of_field(model.jnt_type()[joint]) {
            JointType::Free => (7, 6, Some(3)),
            JointType::Ball => (4, 3, Some(0)),
            JointType::Slide | JointType::Hinge => (1, 1, None),
        };
        Self { qpos: qpos..qpos + nq, dofs: dof..dof + nv, quaternion }
    }

    fn of(model: &Model, joint: Option<usize>) -> impl Iterator<Item = Self> + '_ {
        let joints = (0..model.njnt()).filter(move |&index| joint.is_none_or(|joint| joint == index));
        joints.map(|index| Self::new(model, index))
    }
}

/// Difference of the positions of a joint, or of all joints, from a target: m for slides, rad for
/// hinges, a rotation vector in rad for balls, and both for free joints.
/// [`Model::differentiate_pos_into`] defines the difference, which has one component for each
/// degree of freedom.
///
/// ```
/// use mujoco_safe::control::residual::{JointPosition, Residual};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let hinge = JointPosition::new(data.model(), "hinge")?.with_target(&[0.1])?;
/// data.qpos_mut()[1] = 0.3;
/// let mut residual = [0.0];
/// hinge.evaluate(&mut data, &mut residual)?;
/// assert!((residual[0] - 0.2).abs() < 1e-12);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointPosition {
    joints: Vec<Coordinates>,
    target: Vec<f64>,
    size: usize,
    lineage: Lineage,
}

impl JointPosition {
    /// Creates the residual of a joint. The target is its reference position, `qpos0`.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown joint.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn new(model: &Model, joint: impl IntoId<kind::Joint>) -> Result<Self> {
        let joint = joint.id_in(model)?.index();
        Ok(Self::with_joints(model, Coordinates::of(model, Some(joint))))
    }

    /// Creates the residual of all joints, with `nv` components. The target is the reference
    /// position, `qpos0`.
    pub fn all(model: &Model) -> Self {
        Self::with_joints(model, Coordinates::of(model, None))
    }

    fn with_joints(model: &Model, joints: impl Iterator<Item = Coordinates>) -> Self {
        let joints: Vec<_> = joints.collect();
        let target = joints.iter().flat_map(|joint| &model.qpos0()[joint.qpos.clone()]).copied().collect();
        let size = joints.iter().map(|joint| joint.dofs.len()).sum();
        Self { joints, target, size, lineage: model.lineage() }
    }

    /// Sets the target, as in `qpos`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_target(mut self, target: &[f64]) -> Result<Self> {
        Error::check_length("the target of a JointPosition", target.len(), self.target.len())?;
        self.target.copy_from_slice(target);
        Ok(self)
    }

    /// Returns each joint with its first component, its position and its target.
    fn parts<'a>(&'a self, data: &'a Data) -> impl Iterator<Item = (&'a Coordinates, usize, &'a [f64], &'a [f64])> {
        let mut first = (0, 0);
        self.joints.iter().map(move |joint| {
            let (component, coordinate) = first;
            first = (component + joint.dofs.len(), coordinate + joint.qpos.len());
            (joint, component, &data.qpos()[joint.qpos.clone()], &self.target[coordinate..first.1])
        })
    }
}

/// Returns the quaternion of a joint position.
fn quaternion(values: &[f64], offset: usize) -> &[f64; 4] {
    values[offset..].first_chunk().expect("Bug: the position of a joint ends before its quaternion")
}

impl Residual for JointPosition {
    fn size(&self) -> usize {
        self.size
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        check_model(data, self.lineage)?;
        for (joint, first, position, target) in self.parts(data) {
            let part = &mut residual[first..][..joint.dofs.len()];
            let scalars = joint.quaternion.unwrap_or(1);
            subtract(&position[..scalars], &target[..scalars], part);
            if let Some(offset) = joint.quaternion {
                part[offset..].copy_from_slice(&sub_quat(quaternion(position, offset), quaternion(target, offset)));
            }
        }
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        check_model(data, self.lineage)?;
        for (joint, first, position, target) in self.parts(data) {
            for scalar in 0..joint.quaternion.unwrap_or(1) {
                jacobian.by_state_mut(first + scalar)[joint.dofs.start + scalar] = 1.0;
            }
            if let Some(offset) = joint.quaternion {
                let derivative = sub_quat_derivative(quaternion(position, offset), quaternion(target, offset)).da;
                for (row, values) in derivative.chunks_exact(3).enumerate() {
                    let dof = joint.dofs.start + offset;
                    jacobian.by_state_mut(first + offset + row)[dof..dof + 3].copy_from_slice(values);
                }
            }
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}

/// Difference of the velocities of a joint, or of all joints, from a target: entries of `qvel`, in
/// m/s or rad/s.
#[derive(Clone, Debug)]
pub struct JointVelocity {
    dofs: Range<usize>,
    target: Vec<f64>,
    lineage: Lineage,
}

impl JointVelocity {
    /// Creates the residual of a joint. The target is zero.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown joint.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn new(model: &Model, joint: impl IntoId<kind::Joint>) -> Result<Self> {
        let joint = joint.id_in(model)?.index();
        Ok(Self::with_dofs(model, Coordinates::new(model, joint).dofs))
    }

    /// Creates the residual of all joints, with `nv` components. The target is zero.
    pub fn all(model: &Model) -> Self {
        Self::with_dofs(model, 0..model.nv())
    }

    fn with_dofs(model: &Model, dofs: Range<usize>) -> Self {
        Self { target: vec![0.0; dofs.len()], dofs, lineage: model.lineage() }
    }

    /// Sets the target, as in `qvel`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    pub fn with_target(mut self, target: &[f64]) -> Result<Self> {
        Error::check_length("the target of a JointVelocity", target.len(), self.target.len())?;
        self.target.copy_from_slice(target);
        Ok(self)
    }
}

impl Residual for JointVelocity {
    fn size(&self) -> usize {
        self.dofs.len()
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        check_model(data, self.lineage)?;
        subtract(&data.qvel()[self.dofs.clone()], &self.target, residual);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        check_model(data, self.lineage)?;
        let nv = data.model().nv();
        for (component, dof) in self.dofs.clone().enumerate() {
            jacobian.by_state_mut(component)[nv + dof] = 1.0;
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
