//! How [`sub_quat`] and [`quat_integrate`](super::quat_integrate) change with what they are given. Changes of a quaternion are
//! rotation vectors in its own frame: `q` becomes `q quat(δ)`.
//!
//! They follow from the right Jacobian of the exponential map of rotations,
//!
//! ```text
//! exp(φ + δ) ≈ exp(φ) exp(Jr(φ) δ),      Jr(φ)  = I − (1 − cos θ)/θ² [φ]× + (θ − sin θ)/θ³ [φ]×²,
//!                                        Jr⁻¹(φ) = I + ½ [φ]× + (1 − ½θ cot ½θ)/θ² [φ]×²,      θ = |φ|
//! ```
//!
//! (J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, equations 143 and 144.) The
//! engine has these functions from version 2.3.7 on; here they are written in Rust.

use super::{rot_vec_mat_t, sub_quat};

/// Below this angle the series of the coefficients is used, whose next term is of the order of its fourth power.
const SMALL: f64 = 1e-3;

/// The derivatives of [`sub_quat`], each `(3, 3)`, row by row: row `i`, column `j` is the derivative of `res[i]` by the
/// rotation of the argument about its own axis `j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubQuatDerivative {
    /// By `qa`.
    #[doc(alias = "Da")]
    pub da: [f64; 9],
    /// By `qb`: `−daᵀ`.
    #[doc(alias = "Db")]
    pub db: [f64; 9],
}

/// The derivatives of [`sub_quat`]`(qa, qb)`. Where the two are half a turn apart there is none, since the shorter way round
/// changes; these are of the way that is taken.
///
/// ```
/// use mujoco_safe::math;
///
/// let q = math::axis_angle2quat(&[0.0, 1.0, 0.0], 0.7);
/// let derivative = math::sub_quat_derivative(&q, &q);
/// assert_eq!(derivative.da, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
/// ```
#[doc(alias = "mjd_subQuat")]
pub fn sub_quat_derivative(qa: &[f64; 4], qb: &[f64; 4]) -> SubQuatDerivative {
    let phi = sub_quat(qa, qb);
    let angle = length(&phi);
    let second = if angle < SMALL {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half / half.tan()) / (angle * angle)
    };
    let da = combination(&phi, 0.5, second);
    SubQuatDerivative { da, db: transposed(&da).map(|value| -value) }
}

/// The derivatives of [`quat_integrate`](super::quat_integrate), as rotations of the result in its own frame. The matrices are
/// `(3, 3)`, row by row: row `i`, column `j` is the derivative of component `i` by number `j` of the argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuatIntegrateDerivative {
    /// By rotations of `quat` in its own frame.
    #[doc(alias = "Dquat")]
    pub dquat: [f64; 9],
    /// By `scale · vel`, as in the engine: the derivative by `vel` is `scale` times it.
    #[doc(alias = "Dvel")]
    pub dvel: [f64; 9],
    /// By `scale`.
    #[doc(alias = "Dscale")]
    pub dscale: [f64; 3],
}

/// The derivatives of [`quat_integrate`](super::quat_integrate)`(quat, vel, scale)`. They do not depend on `quat`.
#[doc(alias = "mjd_quatIntegrate")]
pub fn quat_integrate_derivative(vel: &[f64; 3], scale: f64) -> QuatIntegrateDerivative {
    let phi = vel.map(|value| scale * value);
    let angle = length(&phi);
    let (first, second, sinc) = if angle < SMALL {
        let square = angle * angle;
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0, 1.0 - square / 6.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        ((1.0 - cos) / (angle * angle), (angle - sin) / (angle * angle * angle), sin / angle)
    };
    QuatIntegrateDerivative {
        // exp(δ) exp(φ) = exp(φ) exp(Rᵀ δ), with the rotation matrix R of φ (Rodrigues).
        dquat: combination(&phi, -sinc, first),
        dvel: combination(&phi, -first, second),
        // A rotation commutes with those about its own axis.
        dscale: rot_vec_mat_t(vel, &combination(&phi, sinc, first)),
    }
}

fn length(vec: &[f64; 3]) -> f64 {
    vec.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// `I + first [φ]× + second [φ]×²`.
fn combination(&[x, y, z]: &[f64; 3], first: f64, second: f64) -> [f64; 9] {
    let cross = [0.0, -z, y, z, 0.0, -x, -y, x, 0.0];
    let square = [-y * y - z * z, x * y, x * z, x * y, -x * x - z * z, y * z, x * z, y * z, -x * x - y * y];
    std::array::from_fn(|at| f64::from(u8::from(at % 4 == 0)) + first * cross[at] + second * square[at])
}

fn transposed(mat: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|at| mat[at % 3 * 3 + at / 3])
}
