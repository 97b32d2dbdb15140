//! Vectors and matrices of space, and spatial vectors of six numbers: rotation, then translation.
//!
//! Matrices `(3, 3)` are nine numbers, row by row, as a row of `data.xmat()` has them.

use mujoco_sys as sys;

use super::array;

/// The vector product `a × b`.
#[doc(alias = "mju_cross")]
#[inline]
pub fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    // SAFETY: three numbers to write, twice three to read.
    array(|res| unsafe { sys::mju_cross(res, a.as_ptr(), b.as_ptr()) })
}

/// `mat vec`: from the frame to the one that the matrix belongs to, such as from a body to the world.
#[doc(alias = "mju_rotVecMat")]
#[inline]
pub fn rot_vec_mat(vec: &[f64; 3], mat: &[f64; 9]) -> [f64; 3] {
    // SAFETY: three numbers to write, three and nine to read.
    array(|res| unsafe { sys::mju_rotVecMat(res, vec.as_ptr(), mat.as_ptr()) })
}

/// `matᵀ vec`: the opposite rotation, such as from the world to a body.
#[doc(alias = "mju_rotVecMatT")]
#[inline]
pub fn rot_vec_mat_t(vec: &[f64; 3], mat: &[f64; 9]) -> [f64; 3] {
    // SAFETY: three numbers to write, three and nine to read.
    array(|res| unsafe { sys::mju_rotVecMatT(res, vec.as_ptr(), mat.as_ptr()) })
}

/// A spatial velocity `[ω; v]`, or a spatial force `[moment; force]` where `flg_force` is true, taken at another point and in
/// another frame: from `oldpos` to `newpos`, both in the old frame, and turned by the transpose of `rotnew2old`, the rotation
/// matrix of the new frame in the old one. Without a matrix it is not turned.
///
/// ```
/// use mujoco_safe::math;
///
/// // A force of 2 N along x that acts at the origin has a moment about a point above it.
/// let force = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
/// let there = math::transform_spatial(&force, true, &[0.0, 0.0, 3.0], &[0.0; 3], None);
/// assert_eq!(there, [0.0, -6.0, 0.0, 2.0, 0.0, 0.0]);
/// ```
#[doc(alias = "mju_transformSpatial")]
pub fn transform_spatial(
    vec: &[f64; 6],
    flg_force: bool,
    newpos: &[f64; 3],
    oldpos: &[f64; 3],
    rotnew2old: Option<&[f64; 9]>,
) -> [f64; 6] {
    let rotation = rotnew2old.map_or(std::ptr::null(), |mat| mat.as_ptr());
    let flg_force = i32::from(flg_force);
    // SAFETY: six numbers to write, six and twice three to read, and nine or NULL.
    array(|res| unsafe {
        sys::mju_transformSpatial(res, vec.as_ptr(), flg_force, newpos.as_ptr(), oldpos.as_ptr(), rotation);
    })
}

/// The eigenvalues of a symmetric matrix `(3, 3)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eig3 {
    /// The eigenvalues, in decreasing order.
    pub eigval: [f64; 3],
    /// The eigenvectors, each of length 1: column `i` is that of `eigval[i]`. It is a rotation matrix.
    pub eigvec: [f64; 9],
    /// That rotation as a quaternion.
    pub quat: [f64; 4],
    /// After how many rotations of Jacobi's method; 500 where it has not converged, as with numbers that are none.
    pub iterations: u32,
}

/// The eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's method. It ends where what is
/// left off the diagonal is below `1e-12`, so scale matrices that are as small; or where the next rotation would be below 1.5 ·
/// 10⁻⁶ rad, so the eigenvectors are no more accurate than that. The eigenvalues are, to the square of it.
///
/// ```
/// use mujoco_safe::math;
///
/// let found = math::eig3(&[2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 7.0]);
/// assert!(found.eigval.iter().zip([7.0, 3.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12));
/// ```
#[doc(alias = "mju_eig3")]
pub fn eig3(mat: &[f64; 9]) -> Eig3 {
    let mut res = Eig3 { eigval: [0.0; 3], eigvec: [0.0; 9], quat: [0.0; 4], iterations: 0 };
    // SAFETY: three, nine and four numbers to write, nine to read. The engine ends after 500 rotations at the latest.
    let iterations =
        unsafe { sys::mju_eig3(res.eigval.as_mut_ptr(), res.eigvec.as_mut_ptr(), res.quat.as_mut_ptr(), mat.as_ptr()) };
    res.iterations = iterations.unsigned_abs();
    res
}
