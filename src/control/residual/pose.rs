//! Residual of the pose of a frame, in the world or relative to another frame.
//!
//! With the position p and the rotation matrix R of the frame, and p′, R′ of the reference, the
//! relative position is `R′ᵀ d` with `d = p − p′`. It changes by
//! `R′ᵀ (∂p − ∂p′ + d × ∂θ′)`, where ∂θ are rotations in the axes of the world. The relative
//! orientation changes by the rotation `Rᵀ (∂θ − ∂θ′)` in the axes of the frame.

use super::{Frame, Needs, Residual, ResidualJacobian};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::math::{mul_quat, neg_quat, rot_vec_mat_t, sub_quat, sub_quat_derivative};
use crate::numerics::spatial::{cross, norm, sub};

/// Largest difference of the length of a quaternion from 1.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Pose of a frame relative to a target: three components in metres, and the rotation vector from
/// the target to the frame, three components in radians, in the axes of the target.
///
/// Without a reference, positions are in the world frame. With a reference frame, which may move,
/// the position and the target are in its axes.
///
/// ```
/// use mujoco_safe::control::residual::{Frame, FramePose, Residual};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.forward()?;
/// let frame = |name: &str| Frame::body(data.model(), name);
/// let hand = FramePose::new(frame("hand_left")?)
///     .relative_to(frame("hand_right")?)
///     .with_target([0.0, 0.5, 0.0], [1.0, 0.0, 0.0, 0.0]);
/// let mut residual = [0.0; 6];
/// hand.evaluate(&mut data, &mut residual)?;
/// assert!(residual[0].abs() < 1e-12); // the arms hang down symmetrically
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FramePose {
    frame: Frame,
    reference: Option<Frame>,
    /// Position, and quaternion.
    target: [f64; 7],
}

impl FramePose {
    /// Creates the residual. The target is the origin, without a rotation.
    pub fn new(frame: Frame) -> Self {
        Self { frame, reference: None, target: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0] }
    }

    /// Sets the frame that positions and orientations are relative to.
    #[must_use]
    pub fn relative_to(mut self, reference: Frame) -> Self {
        self.reference = Some(reference);
        self
    }

    /// Sets the target: a position in metres, and a unit quaternion `[w, x, y, z]` from the
    /// target's axes to those of the reference or the world.
    #[must_use]
    pub fn with_target(mut self, position: [f64; 3], quaternion: [f64; 4]) -> Self {
        self.target[..3].copy_from_slice(&position);
        self.target[3..].copy_from_slice(&quaternion);
        self
    }

    /// Returns the unit quaternion of the target.
    fn quaternion(&self) -> Result<[f64; 4]> {
        let quaternion: [f64; 4] = std::array::from_fn(|i| self.target[3 + i]);
        let length = norm(&quaternion);
        if (length - 1.0).abs() <= UNIT_TOLERANCE {
            return Ok(quaternion.map(|value| value / length));
        }
        Err(Error::out_of_range("the length of the quaternion of a target", length, "1"))
    }

    /// Returns the orientation of the frame, relative to the reference.
    fn orientation(&self, data: &Data) -> [f64; 4] {
        let quaternion = self.frame.quaternion(data);
        self.reference.map_or(quaternion, |reference| mul_quat(&neg_quat(&reference.quaternion(data)), &quaternion))
    }
}

impl Residual for FramePose {
    fn size(&self) -> usize {
        6
    }

    fn needs(&self) -> Needs {
        Needs::Poses
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        let quaternion = self.quaternion()?;
        let mut position = *self.frame.position(data);
        if let Some(reference) = self.reference {
            position = rot_vec_mat_t(&sub(&position, reference.position(data)), reference.rotation(data));
        }
        for (axis, value) in position.into_iter().enumerate() {
            residual[axis] = value - self.target[axis];
        }
        residual[3..].copy_from_slice(&sub_quat(&self.orientation(data), &quaternion));
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        let derivative = sub_quat_derivative(&self.orientation(data), &self.quaternion()?).da;
        let rotation = *self.frame.rotation(data);
        // Rows of the derivative with respect to rotations in the axes of the world.
        let turned: [[f64; 3]; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|axis| (0..3).map(|k| derivative[3 * row + k] * rotation[3 * axis + k]).sum())
        });
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let axes = self.reference.map_or(identity, |reference| *reference.rotation(data));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|row| std::array::from_fn(|k| axes[3 * k + row]));
        self.frame.jacobian_into(data, Some(&mut jacobian.linear), Some(&mut jacobian.angular))?;
        for row in 0..3 {
            jacobian.add_linear(row, columns[row]);
            jacobian.add_angular(3 + row, turned[row]);
        }
        if let Some(reference) = self.reference {
            let arm = sub(self.frame.position(data), reference.position(data));
            reference.jacobian_into(data, Some(&mut jacobian.linear), Some(&mut jacobian.angular))?;
            for row in 0..3 {
                jacobian.add_linear(row, columns[row].map(|value| -value));
                // The scalar product of a column c with d × θ is (c × d) · θ.
                jacobian.add_angular(row, cross(&columns[row], &arm));
                jacobian.add_angular(3 + row, turned[row].map(|value| -value));
            }
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
