//! Vectors in space, spatial vectors, poses and contact forces.
//!
//! Spatial vectors have six components: angular, then linear. `(3, 3)` matrices are row-major
//! arrays of nine numbers, like a row of `data.xmat()`.
//!
//! A contact of dimension `dim` has one normal force and `dim − 1` friction components, each with a
//! coefficient `mu`. Its friction pyramid has two edges per friction component,
//! `normal ± mu[i] tangent[i]`, and the force is a sum of the edges with non-negative coefficients.
//! A frictionless contact (`dim` of 1) has a single number in both representations.

use mujoco_sys as sys;

use super::{array, count};
use crate::error::{Error, Result};

/// Returns the cross product `a × b`.
#[inline]
pub fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_cross(res, a.as_ptr(), b.as_ptr()) })
}

/// Returns `mat vec`: transforms from the local frame of the rotation matrix, for instance from a
/// body to the world.
#[inline]
pub fn rot_vec_mat(vec: &[f64; 3], mat: &[f64; 9]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::adapted::rot_vec_mat(res, vec.as_ptr(), mat.as_ptr()) })
}

/// Returns `matᵀ vec`: the inverse rotation, for instance from the world to a body.
#[inline]
pub fn rot_vec_mat_t(vec: &[f64; 3], mat: &[f64; 9]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::adapted::rot_vec_mat_t(res, vec.as_ptr(), mat.as_ptr()) })
}

/// Quantity that [`transform_spatial`] transforms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SpatialKind {
    /// Motion vector: angular and linear velocity.
    Motion,
    /// Force vector: torque and force.
    Force,
}

/// Transforms a spatial velocity `[ω; v]`, or a spatial force `[torque; force]`, to another
/// reference point and another frame: from `oldpos` to `newpos`, both in the old frame, then by the
/// transpose of `rotnew2old`, the rotation matrix from the new frame to the old. `None` means no
/// rotation.
///
/// ```
/// use mujoco_safe::math::{self, SpatialKind};
///
/// // A force of 2 N along x at the origin has a torque about a point above it.
/// let force = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
/// let moved = math::transform_spatial(&force, SpatialKind::Force, &[0.0, 0.0, 3.0], &[0.0; 3], None);
/// assert_eq!(moved, [0.0, -6.0, 0.0, 2.0, 0.0, 0.0]);
/// ```
pub fn transform_spatial(
    vec: &[f64; 6],
    kind: SpatialKind,
    newpos: &[f64; 3],
    oldpos: &[f64; 3],
    rotnew2old: Option<&[f64; 9]>,
) -> [f64; 6] {
    let rotation = rotnew2old.map_or(std::ptr::null(), |mat| mat.as_ptr());
    let flg_force = i32::from(kind == SpatialKind::Force);
    // SAFETY: six numbers to write, six and twice three to read, and nine or NULL.
    array(|res| unsafe {
        sys::mju_transformSpatial(res, vec.as_ptr(), flg_force, newpos.as_ptr(), oldpos.as_ptr(), rotation);
    })
}

/// Eigendecomposition of a symmetric `(3, 3)` matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eig3 {
    /// Eigenvalues, in decreasing order.
    pub eigval: [f64; 3],
    /// Unit eigenvectors: column `i` belongs to `eigval[i]`. The matrix is a rotation.
    pub eigvec: [f64; 9],
    /// The same rotation as a quaternion.
    pub quat: [f64; 4],
    /// Number of Jacobi rotations; 500 without convergence, for instance with NaN.
    pub iterations: u32,
}

/// Computes the eigenvalues and eigenvectors of a symmetric matrix by Jacobi's method. The
/// iteration stops when the off-diagonal elements are below `1e-12`, so scale matrices of this
/// magnitude. It also stops when the next rotation would be below 1.5 · 10⁻⁶ rad, which limits the
/// accuracy of the eigenvectors. The error of the eigenvalues is of second order in this angle.
///
/// ```
/// use mujoco_safe::math;
///
/// let found = math::eig3(&[2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 7.0]);
/// assert!(found.eigval.iter().zip([7.0, 3.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12));
/// ```
pub fn eig3(mat: &[f64; 9]) -> Eig3 {
    let mut res = Eig3 { eigval: [0.0; 3], eigvec: [0.0; 9], quat: [0.0; 4], iterations: 0 };
    // SAFETY: three, nine and four numbers to write, nine to read. The engine ends after 500
    // rotations at the latest.
    let iterations =
        unsafe { sys::mju_eig3(res.eigval.as_mut_ptr(), res.eigvec.as_mut_ptr(), res.quat.as_mut_ptr(), mat.as_ptr()) };
    res.iterations = iterations.unsigned_abs();
    res
}

/// Pose: position and orientation of one frame in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the origin, m.
    pub pos: [f64; 3],
    /// Orientation: a unit quaternion `[w, x, y, z]`.
    pub quat: [f64; 4],
}

impl Default for Pose {
    /// Returns the identity.
    fn default() -> Self {
        Self { pos: [0.0; 3], quat: [1.0, 0.0, 0.0, 0.0] }
    }
}

/// Composes two poses: `pose2` followed by `pose1`. If `pose2` is given in the frame with the pose
/// `pose1`, the result is the same pose in the outer frame. Its quaternion is normalised.
///
/// ```
/// use mujoco_safe::math::{self, Pose};
///
/// let hand = Pose { pos: [0.0, 0.0, 1.0], quat: math::axis_angle2quat(&[1.0, 0.0, 0.0], 0.5) };
/// let identity = math::mul_pose(&hand, &math::neg_pose(&hand));
/// assert!(identity.pos.iter().all(|value| value.abs() < 1e-15));
/// assert!((identity.quat[0] - 1.0).abs() < 1e-15);
/// ```
pub fn mul_pose(pose1: &Pose, pose2: &Pose) -> Pose {
    let mut res = Pose::default();
    // SAFETY: each position has three numbers, each quaternion four, and the result aliases neither
    // input.
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

/// Returns the inverse pose: the pose of the outer frame in the inner frame.
pub fn neg_pose(pose: &Pose) -> Pose {
    let mut res = Pose::default();
    // SAFETY: as in `mul_pose`.
    unsafe {
        sys::mju_negPose(res.pos.as_mut_ptr(), res.quat.as_mut_ptr(), pose.pos.as_ptr(), pose.quat.as_ptr());
    }
    res
}

/// Transforms the point `vec` from the inner frame to the outer frame: rotation, then translation.
pub fn trn_vec_pose(pose: &Pose, vec: &[f64; 3]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_trnVecPose(res, pose.pos.as_ptr(), pose.quat.as_ptr(), vec.as_ptr()) })
}

/// Converts a contact force of length `dim` (normal, then tangential) to the coefficients of the
/// pyramid edges, of length `2 (dim − 1)` or 1. Friction outside the pyramid is truncated on one
/// side, so [`decode_pyramid`] recovers only forces inside.
///
/// # Errors
///
/// [`Error::Shape`] unless `force` has one more element than `mu`, and `pyramid` has twice as many
/// as `mu` (one if `mu` is empty).
///
/// ```
/// use mujoco_safe::math;
///
/// let (mu, force) = ([0.5, 0.5], [10.0, 1.0, -2.0]);
/// let mut pyramid = [0.0; 4];
/// math::encode_pyramid(&mut pyramid, &force, &mu)?;
/// let mut decoded = [0.0; 3];
/// math::decode_pyramid(&mut decoded, &pyramid, &mu)?;
/// assert_eq!(decoded, force);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn encode_pyramid(pyramid: &mut [f64], force: &[f64], mu: &[f64]) -> Result<()> {
    Error::check_length("the pyramid of encode_pyramid", pyramid.len(), edges(mu))?;
    Error::check_length("the force of encode_pyramid", force.len(), mu.len().saturating_add(1))?;
    let dim = count("encode_pyramid", force.len())?;
    count("encode_pyramid", pyramid.len())?;
    if mu.is_empty() {
        pyramid.copy_from_slice(force);
        return Ok(());
    }
    // SAFETY: 2 (dim − 1) numbers to write, dim and dim − 1 to read.
    unsafe { sys::mju_encodePyramid(pyramid.as_mut_ptr(), force.as_ptr(), mu.as_ptr(), dim) };
    Ok(())
}

/// Converts the coefficients of the pyramid edges, of length `2 (dim − 1)` or 1, to a contact force
/// of length `dim`: normal, then tangential.
///
/// # Errors
///
/// [`Error::Shape`] unless `force` has one more element than `mu`, and `pyramid` has twice as many
/// as `mu` (one if `mu` is empty).
pub fn decode_pyramid(force: &mut [f64], pyramid: &[f64], mu: &[f64]) -> Result<()> {
    Error::check_length("the pyramid of decode_pyramid", pyramid.len(), edges(mu))?;
    Error::check_length("the force of decode_pyramid", force.len(), mu.len().saturating_add(1))?;
    let dim = count("decode_pyramid", force.len())?;
    count("decode_pyramid", pyramid.len())?;
    // SAFETY: dim numbers to write, 2 (dim − 1) and dim − 1 to read; with dim of 1 the engine reads
    // one number of the pyramid, which has at least one.
    unsafe { sys::mju_decodePyramid(force.as_mut_ptr(), pyramid.as_ptr(), mu.as_ptr(), dim) };
    Ok(())
}

/// Returns the number of edges of the friction pyramid.
fn edges(mu: &[f64]) -> usize {
    if mu.is_empty() { 1 } else { mu.len().saturating_mul(2) }
}
