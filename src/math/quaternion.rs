//! Quaternions `[w, x, y, z]`, and the rotations that those of length 1 stand for. A quaternion and its negative stand for the
//! same rotation. Of another length they are taken as they are, unless it says otherwise.
//!
//! Rotation matrices are nine numbers, row by row, as a row of `data.xmat()` has them.

use mujoco_sys as sys;

use super::array;
use crate::error::{Error, Result};

/// Divides `quat` by its length, and returns the length that it had. One that is shorter than `1e-15` becomes `[1, 0, 0, 0]`.
#[doc(alias = "mju_normalize4")]
#[inline]
pub fn normalize4(quat: &mut [f64; 4]) -> f64 {
    // SAFETY: four numbers.
    unsafe { sys::mju_normalize4(quat.as_mut_ptr()) }
}

/// `vec`, rotated by `quat`.
///
/// ```
/// use mujoco_safe::math;
///
/// let quarter = math::axis_angle2quat(&[0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2);
/// let turned = math::rot_vec_quat(&[1.0, 0.0, 0.0], &quarter);
/// assert!((turned[1] - 1.0).abs() < 1e-15); // x has become y
/// ```
#[doc(alias = "mju_rotVecQuat")]
#[inline]
pub fn rot_vec_quat(vec: &[f64; 3], quat: &[f64; 4]) -> [f64; 3] {
    // SAFETY: three numbers to write, three and four to read.
    array(|res| unsafe { sys::mju_rotVecQuat(res, vec.as_ptr(), quat.as_ptr()) })
}

/// The conjugate `[w, −x, −y, −z]`: the opposite rotation.
#[doc(alias = "mju_negQuat")]
#[inline]
pub fn neg_quat(quat: &[f64; 4]) -> [f64; 4] {
    // SAFETY: four numbers to write, four to read.
    array(|res| unsafe { sys::mju_negQuat(res, quat.as_ptr()) })
}

/// The product `quat1 quat2`: first the rotation `quat2`, then `quat1`.
#[doc(alias = "mju_mulQuat")]
#[inline]
pub fn mul_quat(quat1: &[f64; 4], quat2: &[f64; 4]) -> [f64; 4] {
    // SAFETY: four numbers to write, twice four to read.
    array(|res| unsafe { sys::mju_mulQuat(res, quat1.as_ptr(), quat2.as_ptr()) })
}

/// The product `quat [0, axis]`.
#[doc(alias = "mju_mulQuatAxis")]
#[inline]
pub fn mul_quat_axis(quat: &[f64; 4], axis: &[f64; 3]) -> [f64; 4] {
    // SAFETY: four numbers to write, four and three to read.
    array(|res| unsafe { sys::mju_mulQuatAxis(res, quat.as_ptr(), axis.as_ptr()) })
}

/// The rotation by `angle` (rad) about `axis`, which must be of length 1.
#[doc(alias = "mju_axisAngle2Quat")]
#[inline]
pub fn axis_angle2quat(axis: &[f64; 3], angle: f64) -> [f64; 4] {
    // SAFETY: four numbers to write, three to read.
    array(|res| unsafe { sys::mju_axisAngle2Quat(res, axis.as_ptr(), angle) })
}

/// The constant angular velocity (rad/s, in the frame that is rotated) that makes the rotation `quat` in the time `dt` (s), the
/// shorter way round. With `dt` of 1 it is the rotation vector.
#[doc(alias = "mju_quat2Vel")]
#[inline]
pub fn quat2vel(quat: &[f64; 4], dt: f64) -> [f64; 3] {
    // SAFETY: three numbers to write, four to read.
    array(|res| unsafe { sys::mju_quat2Vel(res, quat.as_ptr(), dt) })
}

/// The rotation vector (rad, in the frame of `qb`) that leads from `qb` to `qa`: `qb quat(res) = qa`, the shorter way round.
///
/// Its derivatives are [`sub_quat_derivative`](super::sub_quat_derivative).
#[doc(alias = "mju_subQuat")]
#[inline]
pub fn sub_quat(qa: &[f64; 4], qb: &[f64; 4]) -> [f64; 3] {
    // SAFETY: three numbers to write, twice four to read.
    array(|res| unsafe { sys::mju_subQuat(res, qa.as_ptr(), qb.as_ptr()) })
}

/// The rotation matrix of a quaternion of length 1.
#[doc(alias = "mju_quat2Mat")]
#[inline]
pub fn quat2mat(quat: &[f64; 4]) -> [f64; 9] {
    // SAFETY: nine numbers to write, four to read.
    array(|res| unsafe { sys::mju_quat2Mat(res, quat.as_ptr()) })
}

/// The quaternion of a rotation matrix.
#[doc(alias = "mju_mat2Quat")]
#[inline]
pub fn mat2quat(mat: &[f64; 9]) -> [f64; 4] {
    // SAFETY: four numbers to write, nine to read.
    array(|res| unsafe { sys::mju_mat2Quat(res, mat.as_ptr()) })
}

/// The change of `quat` per second at the angular velocity `vel` (rad/s, world frame).
#[doc(alias = "mju_derivQuat")]
#[inline]
pub fn deriv_quat(quat: &[f64; 4], vel: &[f64; 3]) -> [f64; 4] {
    // SAFETY: four numbers to write, four and three to read.
    array(|res| unsafe { sys::mju_derivQuat(res, quat.as_ptr(), vel.as_ptr()) })
}

/// Turns `quat` with the angular velocity `vel` (rad/s, in its own frame) for the time `scale` (s), and makes its length 1.
///
/// Its derivatives are [`quat_integrate_derivative`](super::quat_integrate_derivative).
///
/// ```
/// use mujoco_safe::math;
///
/// let start = [1.0, 0.0, 0.0, 0.0];
/// let mut end = start;
/// math::quat_integrate(&mut end, &[0.1, -0.2, 0.3], 2.0);
/// let vector = math::sub_quat(&end, &start);
/// assert!((vector[1] + 0.4).abs() < 1e-15);
/// ```
#[doc(alias = "mju_quatIntegrate")]
#[inline]
pub fn quat_integrate(quat: &mut [f64; 4], vel: &[f64; 3], scale: f64) {
    // SAFETY: four numbers to read and write, three to read.
    unsafe { sys::mju_quatIntegrate(quat.as_mut_ptr(), vel.as_ptr(), scale) };
}

/// The shortest rotation that leads from the z axis to the direction of `vec`. None for a `vec` of no length.
#[doc(alias = "mju_quatZ2Vec")]
#[inline]
pub fn quat_z2vec(vec: &[f64; 3]) -> [f64; 4] {
    // SAFETY: four numbers to write, three to read.
    array(|quat| unsafe { sys::mju_quatZ2Vec(quat, vec.as_ptr()) })
}

/// The rotation of three Euler angles (rad), about the axes that `seq` names one after another: `x`, `y`, `z` are the axes of
/// the frame as it is by then (intrinsic), `X`, `Y`, `Z` those that stay (extrinsic). The default of MJCF is `"xyz"`. (Newer
/// engines have it in C.)
///
/// # Errors
///
/// [`Error::Invalid`] unless `seq` has three of these letters.
///
/// ```
/// use mujoco_safe::math;
///
/// let [roll, pitch, yaw] = [0.1, 0.2, 0.3];
/// let intrinsic = math::euler2quat(&[yaw, pitch, roll], "zyx")?;
/// let extrinsic = math::euler2quat(&[roll, pitch, yaw], "XYZ")?;
/// assert!(math::sub_quat(&intrinsic, &extrinsic).iter().all(|angle| angle.abs() < 1e-15));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_euler2Quat")]
pub fn euler2quat(euler: &[f64; 3], seq: &str) -> Result<[f64; 4]> {
    let invalid = || Error::invalid("seq of euler2quat", format!("{seq:?}"), "three letters of x, y, z, X, Y, Z");
    let letters: [u8; 3] = seq.as_bytes().try_into().map_err(|_| invalid())?;
    let mut quat = [1.0, 0.0, 0.0, 0.0];
    for (angle, letter) in euler.iter().zip(letters) {
        let mut axis = [0.0; 3];
        match letter.to_ascii_lowercase() {
            lower @ b'x'..=b'z' => axis[usize::from(lower - b'x')] = 1.0,
            _ => return Err(invalid()),
        }
        let rotation = axis_angle2quat(&axis, *angle);
        quat = if letter.is_ascii_lowercase() { mul_quat(&quat, &rotation) } else { mul_quat(&rotation, &quat) };
    }
    Ok(quat)
}
