//! The engine's utility mathematics (`mju_*`), with checked sizes.
//!
//! The engine's `mju_mulMatVec` is [`mul_mat_vec`] here; a search of this documentation also finds
//! the C names. As in the engine, output parameters come first. No function allocates, except for
//! error messages.
//!
//! ```
//! use mujoco_safe::{Data, Matrix, math, sample};
//!
//! // Velocity of the torso of a falling humanoid, from its Jacobian.
//! let mut data = Data::new(sample::humanoid())?;
//! data.step()?;
//! data.forward()?;
//! let jacobian = data.jac_body_com(data.model().body("torso")?)?;
//! let mut velocity = [0.0; 3];
//! math::mul_mat_vec(&mut velocity, &jacobian.linear, data.qvel())?;
//! assert!(velocity[2] < 0.0);
//!
//! // A wrong size is an error that names the argument and the expected size.
//! let error = math::mul_mat_vec(&mut velocity, &jacobian.linear, data.qpos()).unwrap_err();
//! assert_eq!(error.to_string(), "vec of mul_mat_vec has shape (28), but must have (27)");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Arrays and slices
//!
//! Functions of vectors in space and of quaternions take arrays, `&[f64; 3]` and `&[f64; 4]`, so
//! their sizes need no check. Fields with rows of a fixed length give arrays: `data.xquat()[body]`,
//! `data.body("torso")?.xquat()`, `data.joint("root")?.quat()`. A part of a slice, for example of
//! `qpos` or of the reading of a sensor, becomes an array by `try_into` or `first_chunk`:
//!
//! ```
//! use mujoco_safe::{Data, math, sample};
//!
//! let data = Data::new(sample::humanoid())?;
//! let quat: &[f64; 4] = data.qpos()[3..7].try_into().expect("four values");
//! let same: &[f64; 4] = data.qpos()[3..].first_chunk().expect("four values");
//! assert_eq!(math::quat2mat(quat), math::quat2mat(same));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Functions in place
//!
//! In C, the output of some functions may alias an argument. The borrow checker forbids this, so
//! separate functions work in place: [`scl_in_place`], [`chol_solve_in_place`],
//! [`chol_solve_band_in_place`], [`symmetrize_in_place`], [`add_to`] and [`sub_from`].
//!
//! ```compile_fail,E0502
//! # use mujoco_safe::{Matrix, math};
//! let mut mat = Matrix::zeros(2, 2);
//! math::transpose(&mut mat, &mat).unwrap(); // also borrowed as mutable
//! ```
//!
//! A column-major matrix, which the engine would read as its transpose, is not accepted:
//!
//! ```compile_fail,E0277
//! # use mujoco_safe::math;
//! let mat = nalgebra::DMatrix::<f64>::zeros(3, 2);
//! math::mul_mat_vec(&mut [0.0; 3], &mat, &[1.0, 2.0]).unwrap();
//! ```
//!
//! # Engine functions without a counterpart, and their replacements
//!
//! | function | replacement |
//! |---|---|
//! | `mju_add3`, `mju_dot3`, `mju_norm3`, `mju_copy4`, … | [`nalgebra::Vector3`] and arrays; [`cross`] and [`normalize4`] are provided |
//! | `mju_min`, `mju_max`, `mju_clip`, `mju_sign`, `mju_sqrt`, … | the methods of [`f64`] (its `clamp` panics for bounds in the wrong order) |
//! | `mju_round` | [`f64::round`]; the engine's behaviour for numbers beyond a C `int` is undefined |
//! | `mju_printMat`, `mju_printMatSparse` | the `Display` of [`Matrix`](crate::Matrix) and [`MatrixView`](crate::MatrixView): `{matrix:9.3}` |
//! | `mju_standardNormal` | the crate `rand_distr`; the engine uses C's `rand`, which all threads and libraries of a process share and which cannot be seeded per thread |
//! | `mju_type2Str`, `mju_str2Type` | [`Kind`](crate::kind::Kind) |
//! | `mju_warningText` | [`Warning`](crate::data::Warning); the engine's text is in a buffer shared by all threads |
//! | `mju_error`, `mju_warning`, `mju_clearHandlers` | [`Error`]; this crate installs the handlers |
//! | `mju_malloc`, `mju_free`, `mju_strncpy` | not needed in Rust |
//! | `mju_writeLog` | the crate `log`; the engine's function writes to a file |

mod band;
mod box_qp;
mod matrix;
mod qp;
mod quaternion;
mod ray;
mod scalar;
mod spatial;
mod vector;

use std::ffi::c_int;

pub use self::band::BandShape;
pub use self::box_qp::{BoxQp, BoxQpSolution, BoxQpStatus};
pub use self::qp::{Qp, QpProblem, QpSolution, QpStatus};
pub use self::quaternion::{QuatIntegrateDerivative, SubQuatDerivative};
pub use self::ray::SkinHit;
pub(crate) use self::ray::check_ray;
pub use self::spatial::{Eig3, Pose};
use crate::error::{Error, Result};
use crate::macros::with_aliases;

with_aliases! {
    pub use self::band::{
        BandKind = "flg_sym",
        band_mul_mat_vec = "mju_bandMulMatVec",
        band2dense = "mju_band2Dense",
        chol_factor_band = "mju_cholFactorBand",
        chol_solve_band = "mju_cholSolveBand",
        chol_solve_band_in_place = "mju_cholSolveBand",
        dense2band = "mju_dense2Band",
    };
    pub use self::matrix::{
        RankOneUpdate = "flg_plus",
        chol_factor = "mju_cholFactor",
        chol_solve = "mju_cholSolve",
        chol_solve_in_place = "mju_cholSolve",
        chol_update = "mju_cholUpdate",
        eye = "mju_eye",
        mul_mat_mat = "mju_mulMatMat",
        mul_mat_mat_t = "mju_mulMatMatT",
        mul_mat_t_mat = "mju_mulMatTMat",
        mul_mat_t_vec = "mju_mulMatTVec",
        mul_mat_vec = "mju_mulMatVec",
        mul_vec_mat_vec = "mju_mulVecMatVec",
        sqr_mat_td = "mju_sqrMatTD",
        symmetrize = "mju_symmetrize",
        symmetrize_in_place = "mju_symmetrize",
        transpose = "mju_transpose",
    };
    pub use self::quaternion::{
        axis_angle2quat = "mju_axisAngle2Quat",
        deriv_quat = "mju_derivQuat",
        euler2quat = "mju_euler2Quat",
        mat2quat = "mju_mat2Quat",
        mul_quat = "mju_mulQuat",
        mul_quat_axis = "mju_mulQuatAxis",
        neg_quat = "mju_negQuat",
        normalize4 = "mju_normalize4",
        quat_integrate = "mju_quatIntegrate",
        quat_integrate_derivative = "mjd_quatIntegrate",
        quat_z2vec = "mju_quatZ2Vec",
        quat2mat = "mju_quat2Mat",
        quat2vel = "mju_quat2Vel",
        rot_vec_quat = "mju_rotVecQuat",
        sub_quat = "mju_subQuat",
        sub_quat_derivative = "mjd_subQuat",
    };
    pub use self::ray::{
        ray_geom = "mju_rayGeom",
        ray_skin = "mju_raySkin",
    };
    pub use self::scalar::{
        halton = "mju_Halton",
        muscle_bias = "mju_muscleBias",
        muscle_dynamics = "mju_muscleDynamics",
        muscle_gain = "mju_muscleGain",
        sigmoid = "mju_sigmoid",
        spring_damper = "mju_springDamper",
    };
    pub use self::spatial::{
        SpatialKind = "flg_force",
        cross = "mju_cross",
        decode_pyramid = "mju_decodePyramid",
        eig3 = "mju_eig3",
        encode_pyramid = "mju_encodePyramid",
        mul_pose = "mju_mulPose",
        neg_pose = "mju_negPose",
        rot_vec_mat = "mju_rotVecMat",
        rot_vec_mat_t = "mju_rotVecMatT",
        transform_spatial = "mju_transformSpatial",
        trn_vec_pose = "mju_trnVecPose",
    };
    pub use self::vector::{
        add = "mju_add",
        add_scl = "mju_addScl",
        add_to = "mju_addTo",
        add_to_scl = "mju_addToScl",
        copy = "mju_copy" "mju_d2n" "mju_n2d",
        dot = "mju_dot" "mju_dot3",
        f2n = "mju_f2n",
        fill = "mju_fill",
        insertion_sort = "mju_insertionSort",
        insertion_sort_int = "mju_insertionSortInt",
        is_bad = "mju_isBad",
        is_zero = "mju_isZero",
        l1 = "mju_L1",
        n2f = "mju_n2f",
        norm = "mju_norm" "mju_norm3",
        normalize = "mju_normalize" "mju_normalize3",
        scl = "mju_scl",
        scl_in_place = "mju_scl",
        sub = "mju_sub",
        sub_from = "mju_subFrom",
        sum = "mju_sum",
        zero = "mju_zero",
    };
}

/// Converts a size to the engine's C `int`.
#[inline]
fn count(what: &'static str, size: usize) -> Result<c_int> {
    c_int::try_from(size).map_err(|_| Error::Unsupported(format!("{what}: {size} numbers exceed the range of a C int")))
}

/// Converts the shape of a matrix to the engine's C `int`s. The engine also computes the total
/// number of values in an `int`.
#[inline]
fn entries(what: &'static str, (nrows, ncols): (usize, usize)) -> Result<(c_int, c_int)> {
    count(what, nrows.saturating_mul(ncols))?;
    // The product does not bound the number of rows of a matrix without columns.
    Ok((count(what, nrows)?, count(what, ncols)?))
}

/// Returns the array that a function of the engine writes.
#[inline]
fn array<const N: usize>(write: impl FnOnce(*mut f64)) -> [f64; N] {
    let mut res = [0.0; N];
    write(res.as_mut_ptr());
    res
}
