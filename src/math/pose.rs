//! Poses: a position (m) and an orientation, of one frame in another.

use mujoco_sys as sys;

use super::array;

/// A position and an orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the origin is, m.
    pub pos: [f64; 3],
    /// How the axes are turned, `[w, x, y, z]` of length 1.
    pub quat: [f64; 4],
}

impl Default for Pose {
    /// Of a frame in itself.
    fn default() -> Self {
        Self { pos: [0.0; 3], quat: [1.0, 0.0, 0.0, 0.0] }
    }
}

/// The pose in the frame of `pose1` of what has the pose `pose2` in it: first `pose2`, then `pose1`. Its quaternion is brought to
/// the length 1.
///
/// ```
/// use mujoco_safe::math::{self, Pose};
///
/// let hand = Pose { pos: [0.0, 0.0, 1.0], quat: math::axis_angle2quat(&[1.0, 0.0, 0.0], 0.5) };
/// let found = math::mul_pose(&hand, &math::neg_pose(&hand));
/// assert!(found.pos.iter().all(|value| value.abs() < 1e-15));
/// assert!((found.quat[0] - 1.0).abs() < 1e-15);
/// ```
#[doc(alias = "mju_mulPose")]
pub fn mul_pose(pose1: &Pose, pose2: &Pose) -> Pose {
    let mut res = Pose::default();
    // SAFETY: each position has three numbers, each quaternion four, and the result is in neither of the others.
    unsafe {
        sys::mju_mulPose(
            res.pos.as_mut_ptr(),
            res.quat.as_mut_ptr(),
            pose1.pos.as_ptr(),
            pose1.quat.as_ptr(),
            pose2.pos.as_ptr(),
            pose2.quat.as_ptr(),
        );
    }
    res
}

/// The opposite pose: that of the outer frame in the inner one.
#[doc(alias = "mju_negPose")]
pub fn neg_pose(pose: &Pose) -> Pose {
    let mut res = Pose::default();
    // SAFETY: as in `mul_pose`.
    unsafe {
        sys::mju_negPose(res.pos.as_mut_ptr(), res.quat.as_mut_ptr(), pose.pos.as_ptr(), pose.quat.as_ptr());
    }
    res
}

/// The point `vec` of the inner frame, in the outer one: rotated and moved.
#[doc(alias = "mju_trnVecPose")]
pub fn trn_vec_pose(pose: &Pose, vec: &[f64; 3]) -> [f64; 3] {
    // SAFETY: three numbers to write, three, four and three to read.
    array(|res| unsafe { sys::mju_trnVecPose(res, pose.pos.as_ptr(), pose.quat.as_ptr(), vec.as_ptr()) })
}
