//! Quaternions `[w, x, y, z]` and rotations. A unit quaternion and its negative represent the same
//! rotation. Functions do not normalise their arguments unless stated otherwise.
//!
//! Rotation matrices are row-major arrays of nine numbers, like a row of `data.xmat()`.
//!
//! The derivatives of [`sub_quat`] and [`quat_integrate`] use rotation vectors in the quaternion's
//! own frame as tangent vectors: a perturbation δ maps `q` to `q quat(δ)`. They follow from the
//! right Jacobian of the exponential map of rotations,
//!
//! ```text
//! exp(φ + δ) ≈ exp(φ) exp(Jr(φ) δ),      Jr(φ)  = I − (1 − cos θ)/θ² [φ]× + (θ − sin θ)/θ³ [φ]×²,
//!                                        Jr⁻¹(φ) = I + ½ [φ]× + (1 − ½θ cot ½θ)/θ² [φ]×²,      θ = |φ|
//! ```
//!
//! (J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018,
//! equations 143 and 144.) The engine provides these derivatives since version 2.3.7. This module
//! implements them in Rust.

use mujoco_sys as sys;

use super::{array, rot_vec_mat_t};
use crate::error::{Error, InvalidKind, Result};
use crate::numerics::spatial::norm;

/// Normalises `quat` and returns its original norm. A quaternion with a norm below `1e-15` becomes
/// `[1, 0, 0, 0]`.
#[inline]
pub fn normalize4(quat: &mut [f64; 4]) -> f64 {
    // SAFETY: the engine reads and writes four numbers.
    unsafe { sys::mju_normalize4(quat.as_mut_ptr()) }
}

/// Rotates `vec` by `quat`.
///
/// ```
/// use mujoco_safe::math;
///
/// let quarter = math::axis_angle2quat(&[0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2);
/// let turned = math::rot_vec_quat(&[1.0, 0.0, 0.0], &quarter);
/// assert!((turned[1] - 1.0).abs() < 1e-15); // x has become y
/// ```
///
/// The orientation of a body or a site needs no conversion. The reading of a sensor is a slice,
/// which `first_chunk` converts:
///
/// ```
/// use mujoco_safe::{Data, Model, math};
///
/// let mut data = Data::new(Model::from_xml_str(
///     r#"<mujoco>
///          <worldbody>
///            <body name="arm" euler="0 0 90"><geom size="0.1"/><site name="tool" euler="0 0 -90"/></body>
///          </worldbody>
///          <sensor><framequat name="attitude" objtype="xbody" objname="arm"/></sensor>
///        </mujoco>"#,
/// )?)?;
/// data.forward()?;
/// let forward = [1.0, 0.0, 0.0];
/// let of_arm = math::rot_vec_quat(&forward, data.body("arm")?.xquat());
/// let of_tool = math::rot_vec_mat(&forward, data.site("tool")?.xmat());
/// let measured = data.sensor("attitude")?.data()?.first_chunk().expect("a quaternion");
/// assert!((of_arm[1] - 1.0).abs() < 1e-15);
/// assert!((of_tool[0] - 1.0).abs() < 1e-15);
/// assert_eq!(math::rot_vec_quat(&forward, measured), of_arm);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[inline]
pub fn rot_vec_quat(vec: &[f64; 3], quat: &[f64; 4]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_rotVecQuat(res, vec.as_ptr(), quat.as_ptr()) })
}

/// Returns the conjugate `[w, −x, −y, −z]`: the inverse rotation.
#[inline]
pub fn neg_quat(quat: &[f64; 4]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_negQuat(res, quat.as_ptr()) })
}

/// Returns the product `quat1 quat2`: the rotation `quat2` followed by `quat1`.
#[inline]
pub fn mul_quat(quat1: &[f64; 4], quat2: &[f64; 4]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_mulQuat(res, quat1.as_ptr(), quat2.as_ptr()) })
}

/// Returns the product `quat [0, axis]`.
#[inline]
pub fn mul_quat_axis(quat: &[f64; 4], axis: &[f64; 3]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_mulQuatAxis(res, quat.as_ptr(), axis.as_ptr()) })
}

/// Returns the rotation by `angle` (rad) about `axis`, which must be a unit vector.
#[inline]
pub fn axis_angle2quat(axis: &[f64; 3], angle: f64) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_axisAngle2Quat(res, axis.as_ptr(), angle) })
}

/// Returns the constant angular velocity (rad/s, in the rotated frame) that produces the rotation
/// `quat` within the time `dt` (s), along the shorter arc. With `dt` of 1 it is the rotation
/// vector.
#[inline]
pub fn quat2vel(quat: &[f64; 4], dt: f64) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_quat2Vel(res, quat.as_ptr(), dt) })
}

/// Returns the rotation vector (rad, in the frame of `qb`) from `qb` to `qa`: `qb quat(res) = qa`,
/// along the shorter arc.
///
/// [`sub_quat_derivative`] computes its derivatives.
#[inline]
pub fn sub_quat(qa: &[f64; 4], qb: &[f64; 4]) -> [f64; 3] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_subQuat(res, qa.as_ptr(), qb.as_ptr()) })
}

/// Converts a unit quaternion to a rotation matrix.
#[inline]
pub fn quat2mat(quat: &[f64; 4]) -> [f64; 9] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_quat2Mat(res, quat.as_ptr()) })
}

/// Converts a rotation matrix to a quaternion.
#[inline]
pub fn mat2quat(mat: &[f64; 9]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_mat2Quat(res, mat.as_ptr()) })
}

/// Returns the time derivative (1/s) of `quat` for the angular velocity `vel` (rad/s, world frame).
#[inline]
pub fn deriv_quat(quat: &[f64; 4], vel: &[f64; 3]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|res| unsafe { sys::mju_derivQuat(res, quat.as_ptr(), vel.as_ptr()) })
}

/// Integrates `quat` with the angular velocity `vel` (rad/s, in the rotated frame) over the time
/// `scale` (s), and normalises it.
///
/// [`quat_integrate_derivative`] computes its derivatives.
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
#[inline]
pub fn quat_integrate(quat: &mut [f64; 4], vel: &[f64; 3], scale: f64) {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    unsafe { sys::mju_quatIntegrate(quat.as_mut_ptr(), vel.as_ptr(), scale) };
}

/// Returns the shortest rotation from the z axis to the direction of `vec`; the identity for a zero
/// `vec`.
#[inline]
pub fn quat_z2vec(vec: &[f64; 3]) -> [f64; 4] {
    // SAFETY: the arrays have the lengths that the engine reads and writes.
    array(|quat| unsafe { sys::mju_quatZ2Vec(quat, vec.as_ptr()) })
}

/// Converts Euler angles (rad) to a quaternion. `seq` names the axes of the successive rotations:
/// `x`, `y`, `z` are axes of the rotated frame (intrinsic), `X`, `Y`, `Z` are fixed axes
/// (extrinsic). The default of MJCF is `"xyz"`. (Newer engines provide it in C.)
///
/// # Errors
///
/// [`Error::Invalid`] unless `seq` consists of three of these letters.
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
pub fn euler2quat(euler: &[f64; 3], seq: &str) -> Result<[f64; 4]> {
    let invalid = || {
        Error::invalid(InvalidKind::Text, "seq of euler2quat", format!("{seq:?}"), "three letters of x, y, z, X, Y, Z")
    };
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

/// Angle below which the coefficients are computed by their Taylor series. The truncated terms are
/// of fourth order in the angle.
const SMALL_ANGLE: f64 = 1e-3;

/// Derivatives of [`sub_quat`]: row-major `(3, 3)` matrices. The element in row `i` and column `j`
/// is the derivative of `res[i]` with respect to a rotation of the argument about axis `j` of its
/// own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubQuatDerivative {
    /// Derivative with respect to `qa`.
    #[doc(alias = "Da")]
    pub da: [f64; 9],
    /// Derivative with respect to `qb`: `−daᵀ`.
    #[doc(alias = "Db")]
    pub db: [f64; 9],
}

/// Computes the derivatives of [`sub_quat`]`(qa, qb)`. The function is not differentiable if the
/// arguments are half a turn apart, because the shorter arc changes. The result is then the
/// derivative along the chosen arc.
///
/// ```
/// use mujoco_safe::math;
///
/// let q = math::axis_angle2quat(&[0.0, 1.0, 0.0], 0.7);
/// let derivative = math::sub_quat_derivative(&q, &q);
/// assert_eq!(derivative.da, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
/// ```
pub fn sub_quat_derivative(qa: &[f64; 4], qb: &[f64; 4]) -> SubQuatDerivative {
    let phi = sub_quat(qa, qb);
    let angle = norm(&phi);
    let second = if angle < SMALL_ANGLE {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half / half.tan()) / (angle * angle)
    };
    let da = combination(&phi, 0.5, second);
    SubQuatDerivative { da, db: transposed(&da).map(|value| -value) }
}

/// Derivatives of [`quat_integrate`], as rotation vectors in the frame of the result. The matrices
/// are row-major `(3, 3)`: the element in row `i` and column `j` is the derivative of component `i`
/// with respect to component `j` of the argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuatIntegrateDerivative {
    /// Derivative with respect to a rotation of `quat` in its own frame.
    #[doc(alias = "Dquat")]
    pub dquat: [f64; 9],
    /// Derivative with respect to `scale · vel`, as in the engine. The derivative with respect to
    /// `vel` is `scale · dvel`.
    #[doc(alias = "Dvel")]
    pub dvel: [f64; 9],
    /// Derivative with respect to `scale`.
    #[doc(alias = "Dscale")]
    pub dscale: [f64; 3],
}

/// Computes the derivatives of [`quat_integrate`]`(quat, vel, scale)`. They do not depend on
/// `quat`.
pub fn quat_integrate_derivative(vel: &[f64; 3], scale: f64) -> QuatIntegrateDerivative {
    let phi = vel.map(|value| scale * value);
    let angle = norm(&phi);
    let (first, second, sinc) = if angle < SMALL_ANGLE {
        let square = angle * angle;
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0, 1.0 - square / 6.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        ((1.0 - cos) / (angle * angle), (angle - sin) / (angle * angle * angle), sin / angle)
    };
    QuatIntegrateDerivative {
        // exp(δ) exp(φ) = exp(φ) exp(Rᵀ δ), with the rotation matrix R of φ (Rodrigues' formula).
        dquat: combination(&phi, -sinc, first),
        dvel: combination(&phi, -first, second),
        // Rotations about the same axis commute.
        dscale: rot_vec_mat_t(vel, &combination(&phi, sinc, first)),
    }
}

/// Returns `I + first [φ]× + second [φ]×²`.
fn combination(&[x, y, z]: &[f64; 3], first: f64, second: f64) -> [f64; 9] {
    let cross = [0.0, -z, y, z, 0.0, -x, -y, x, 0.0];
    let square = [-y * y - z * z, x * y, x * z, x * y, -x * x - z * z, y * z, x * z, y * z, -x * x - y * y];
    std::array::from_fn(|at| f64::from(u8::from(at % 4 == 0)) + first * cross[at] + second * square[at])
}

fn transposed(mat: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|at| mat[at % 3 * 3 + at / 3])
}
