//! Residual of the direction in which a frame looks.

use super::{Frame, Needs, Residual, ResidualJacobian};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::math::rot_vec_mat;
use crate::numerics::spatial::{Vec3, cross, norm, scale, sub};

/// Direction of an axis of a frame, minus the direction from the frame to a target point: three
/// components without a unit, world frame. Their length is `2 sin(θ/2)` for the angle θ between
/// both directions.
///
/// The residual has a saddle point where the axis points away from the target.
///
/// ```
/// use mujoco_safe::control::residual::{Frame, Gaze, Residual};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.kinematics()?;
/// let head = *data.body("head")?.xpos();
/// let ahead = [head[0] + 2.0, head[1], head[2]];
/// let gaze = Gaze::new(Frame::body(data.model(), "head")?, [1.0, 0.0, 0.0])?.with_target(ahead);
/// let mut residual = [1.0; 3];
/// gaze.evaluate(&mut data, &mut residual)?;
/// assert!(residual.iter().all(|value| value.abs() < 1e-12)); // the figure faces forward
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
#[doc(alias = "look at")]
pub struct Gaze {
    frame: Frame,
    /// Unit vector in the axes of the frame.
    axis: Vec3,
    target: Vec3,
}

impl Gaze {
    /// Creates the residual for an axis in the axes of the frame, which is normalised. The target
    /// is the origin of the world.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for an axis whose length is zero or not finite.
    pub fn new(frame: Frame, axis: [f64; 3]) -> Result<Self> {
        let length = norm(&axis);
        if length > 0.0 && length.is_finite() {
            return Ok(Self { frame, axis: scale(&axis, 1.0 / length), target: [0.0; 3] });
        }
        Err(Error::out_of_range("the length of the axis of a Gaze", length, "above zero"))
    }

    /// Sets the point to look at, in metres, world frame.
    #[must_use]
    pub fn with_target(mut self, target: [f64; 3]) -> Self {
        self.target = target;
        self
    }

    /// Returns the axis and the direction to the target in the world, and the distance.
    fn directions(&self, data: &Data) -> Result<(Vec3, Vec3, f64)> {
        let offset = sub(&self.target, self.frame.position(data));
        let distance = norm(&offset);
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(Error::out_of_range(
                "the distance of a frame from the target of its gaze",
                distance,
                "above zero",
            ));
        }
        Ok((rot_vec_mat(&self.axis, self.frame.rotation(data)), scale(&offset, 1.0 / distance), distance))
    }
}

impl Residual for Gaze {
    fn size(&self) -> usize {
        3
    }

    fn needs(&self) -> Needs {
        Needs::Poses
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        let (axis, direction, _) = self.directions(data)?;
        residual.copy_from_slice(&sub(&axis, &direction));
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        let (axis, direction, distance) = self.directions(data)?;
        self.frame.jacobian_into(data, Some(&mut jacobian.linear), Some(&mut jacobian.angular))?;
        for row in 0..3 {
            let unit: Vec3 = std::array::from_fn(|axis| f64::from(u8::from(axis == row)));
            // The axis changes by θ × a, and e · (θ × a) is (a × e) · θ.
            jacobian.add_angular(row, cross(&axis, &unit));
            // A motion of the frame turns the direction by the part across it.
            let across = sub(&unit, &scale(&direction, direction[row]));
            jacobian.add_linear(row, scale(&across, 1.0 / distance));
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
