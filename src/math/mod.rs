//! The engine's mathematics, under the names that it has there, with every size checked.
//!
//! A function `mju_mulMatVec` of the engine is [`mul_mat_vec`] here; the search of this documentation finds it by its C name. As
//! in the engine the result comes first where it is written to. Nothing here allocates, except for what errors say.
//!
//! ```
//! use mujoco_safe::{Data, Matrix, math, sample};
//!
//! // How fast the torso of a falling humanoid moves, from its Jacobian.
//! let mut data = Data::new(sample::humanoid())?;
//! data.step()?;
//! data.forward()?;
//! let jacobian = data.jac_body_com(data.model().body("torso")?)?;
//! let mut velocity = [0.0; 3];
//! math::mul_mat_vec(&mut velocity, &jacobian.translation, data.qvel())?;
//! assert!(velocity[2] < 0.0);
//!
//! // A wrong size is an error that says which, and what would be right.
//! let error = math::mul_mat_vec(&mut velocity, &jacobian.translation, data.qpos()).unwrap_err();
//! assert_eq!(error.to_string(), "vec of mul_mat_vec has shape (28), but must have (27)");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! | file | what is in it |
//! |---|---|
//! | `vector.rs` | vectors of any length: [`dot`], [`norm`], [`add_scl`], … |
//! | `sort.rs` | [`insertion_sort`] |
//! | `matrix.rs` | dense matrices: [`mul_mat_mat`], [`sqr_mat_td`], [`transpose`], … |
//! | `cholesky.rs` | [`chol_factor`], [`chol_solve`], [`chol_update`] |
//! | `band.rs` | band matrices with dense rows: [`BandShape`], [`chol_factor_band`], … |
//! | `box_qp.rs` | quadratic programmes in a box: [`BoxQp`] |
//! | `quaternion.rs` | rotations: [`mul_quat`], [`quat2mat`], [`sub_quat`], [`euler2quat`], … |
//! | `quaternion_derivative.rs` | [`sub_quat_derivative`], [`quat_integrate_derivative`] |
//! | `pose.rs` | positions with orientations: [`Pose`], [`mul_pose`], … |
//! | `spatial.rs` | [`rot_vec_mat`], [`transform_spatial`], [`eig3`] |
//! | `pyramid.rs` | forces of contacts: [`encode_pyramid`], [`decode_pyramid`] |
//! | `ray.rs` | rays and single shapes: [`ray_geom`], [`ray_skin`] |
//! | `muscle.rs` | [`muscle_gain`], [`muscle_bias`], [`muscle_dynamics`] |
//! | `scalar.rs` | [`spring_damper`], [`sigmoid`], [`halton`] |
//!
//! # In place
//!
//! C lets the result of some functions be one of the arguments. Here it cannot be, so where it is of use there is a second
//! function: [`scl_in_place`], [`chol_solve_in_place`], [`chol_solve_band_in_place`], [`symmetrize_in_place`]; [`add_to`] and
//! [`sub_from`] are in place anyway.
//!
//! ```compile_fail,E0502
//! # use mujoco_safe::{Matrix, math};
//! let mut mat = Matrix::zeros(2, 2);
//! math::transpose(&mut mat, &mat).unwrap(); // also borrowed as mutable
//! ```
//!
//! Nor is a matrix taken whose columns lie one behind another, which the engine would read as its transpose:
//!
//! ```compile_fail,E0277
//! # use mujoco_safe::math;
//! let mat = nalgebra::DMatrix::<f64>::zeros(3, 2);
//! math::mul_mat_vec(&mut [0.0; 3], &mat, &[1.0, 2.0]).unwrap();
//! ```
//!
//! # What is not here, and what to use instead
//!
//! | function | instead |
//! |---|---|
//! | `mju_add3`, `mju_dot3`, `mju_norm3`, `mju_copy4`, … | [`nalgebra::Vector3`] and arrays; [`cross`] and [`normalize4`] are here |
//! | `mju_min`, `mju_max`, `mju_clip`, `mju_sign`, `mju_sqrt`, … | the methods of [`f64`] (its `clamp` panics where the bounds are in the wrong order) |
//! | `mju_round` | [`f64::round`]; for numbers beyond a C int what the engine does is undefined |
//! | `mju_printMat`, `mju_printMatSparse` | the `Display` of [`Matrix`](crate::Matrix) and [`MatrixView`](crate::MatrixView): `{matrix:9.3}` |
//! | `mju_standardNormal` | the crate `rand_distr`; the engine draws from C's `rand`, which all threads and libraries of a process share, and which cannot be seeded for one of them |
//! | `mju_type2Str`, `mju_str2Type` | [`Kind`](crate::Kind) |
//! | `mju_warningText` | [`Warning`](crate::Warning); the engine's text lies in one buffer for all threads |
//! | `mju_error`, `mju_warning`, `mju_clearHandlers` | [`Error`]; the handlers are this crate's |
//! | `mju_malloc`, `mju_free`, `mju_strncpy` | Rust has no need of them |
//! | `mju_writeLog` | the crate `log`; the engine's function writes to a file |

mod band;
mod box_qp;
mod cholesky;
mod matrix;
mod muscle;
mod pose;
mod pyramid;
mod quaternion;
mod quaternion_derivative;
mod ray;
mod scalar;
mod sort;
mod spatial;
mod vector;

use std::ffi::c_int;

pub use self::band::{
    BandShape, band_mul_mat_vec, band2dense, chol_factor_band, chol_solve_band, chol_solve_band_in_place, dense2band,
};
pub use self::box_qp::{BoxQp, BoxQpSolution, BoxQpStatus};
pub use self::cholesky::{chol_factor, chol_solve, chol_solve_in_place, chol_update};
pub use self::matrix::{
    eye, mul_mat_mat, mul_mat_mat_t, mul_mat_t_mat, mul_mat_t_vec, mul_mat_vec, mul_vec_mat_vec, sqr_mat_td,
    symmetrize, symmetrize_in_place, transpose,
};
pub use self::muscle::{muscle_bias, muscle_dynamics, muscle_gain};
pub use self::pose::{Pose, mul_pose, neg_pose, trn_vec_pose};
pub use self::pyramid::{decode_pyramid, encode_pyramid};
pub use self::quaternion::{
    axis_angle2quat, deriv_quat, euler2quat, mat2quat, mul_quat, mul_quat_axis, neg_quat, normalize4, quat_integrate,
    quat_z2vec, quat2mat, quat2vel, rot_vec_quat, sub_quat,
};
pub use self::quaternion_derivative::{
    QuatIntegrateDerivative, SubQuatDerivative, quat_integrate_derivative, sub_quat_derivative,
};
pub(crate) use self::ray::check_ray;
pub use self::ray::{SkinHit, ray_geom, ray_skin};
pub use self::scalar::{halton, sigmoid, spring_damper};
pub use self::sort::{insertion_sort, insertion_sort_int};
pub use self::spatial::{Eig3, cross, eig3, rot_vec_mat, rot_vec_mat_t, transform_spatial};
pub use self::vector::{
    add, add_scl, add_to, add_to_scl, copy, dot, f2n, fill, is_bad, is_zero, l1, n2f, norm, normalize, scl,
    scl_in_place, sub, sub_from, sum, zero,
};
use crate::error::{Error, Result};

/// A size for the engine, which counts with a C int.
#[inline]
fn count(what: &'static str, size: usize) -> Result<c_int> {
    c_int::try_from(size)
        .map_err(|_| Error::Unsupported(format!("{what}: {size} numbers are more than the engine can count")))
}

/// The rows and columns of a matrix for the engine, which counts all its numbers with a C int.
#[inline]
fn entries(what: &'static str, (nrows, ncols): (usize, usize)) -> Result<(c_int, c_int)> {
    count(what, nrows.saturating_mul(ncols))?;
    // Without columns there may be any number of rows.
    Ok((count(what, nrows)?, count(what, ncols)?))
}

/// The array that a function of the engine writes.
#[inline]
fn array<const N: usize>(write: impl FnOnce(*mut f64)) -> [f64; N] {
    let mut res = [0.0; N];
    write(res.as_mut_ptr());
    res
}
