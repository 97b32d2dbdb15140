//! Operations on covariance matrices: checks, propagation, corrections, and changes of coordinates.

use std::ops::Range;

use nalgebra::{DMatrix, Matrix3};

use crate::enums::JointType;
use crate::error::{Error, InvalidKind, Result};
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::dense::PackedMatrix;
use crate::numerics::linear_algebra::{add, dot};
use crate::numerics::{InstructionSet, vectorised};

/// Largest error of a symmetric matrix, relative to the geometric mean of its diagonal entries.
const TOLERANCE: f64 = 1e-9;

/// Checks that a matrix is a covariance: square with `n` rows, finite, symmetric and positive
/// semidefinite.
pub(super) fn check(what: &'static str, matrix: &Matrix, n: usize) -> Result<()> {
    Error::check_shape(what, matrix.shape(), (n, n))?;
    let entry = |row: usize, column: usize| format!("entry ({row}, {column}) of {what}");
    Error::check_finite(matrix.as_slice(), |index| entry(index / n, index % n))?;
    for row in 0..n {
        if matrix[(row, row)] < 0.0 {
            return Err(Error::out_of_range(entry(row, row), matrix[(row, row)], "a variance, which is not negative"));
        }
    }
    for row in 0..n {
        for column in 0..n {
            let mean = matrix[(row, row)].sqrt() * matrix[(column, column)].sqrt();
            let (value, mirrored) = (matrix[(row, column)], matrix[(column, row)]);
            if (value - mirrored).abs() > TOLERANCE * mean {
                return Err(Error::invalid(
                    InvalidKind::OutOfRange,
                    entry(row, column),
                    value,
                    format!("equal to its mirror image, {mirrored}"),
                ));
            }
        }
    }
    let correlations = correlations(matrix, 0..n);
    let is_not_negative = |&value: &f64| value >= -TOLERANCE * n as f64;
    let is_semidefinite = n == 0
        || (is_finite(correlations.as_slice()) && correlations.symmetric_eigenvalues().iter().all(is_not_negative));
    Error::check_range(is_semidefinite, what, "indefinite", "positive semidefinite")
}

/// Returns the correlations of a part of the variables, which do not depend on units. Those of a
/// variable without variance are zero.
pub(super) fn correlations(covariance: &Matrix, part: Range<usize>) -> DMatrix<f64> {
    let deviation = |index: usize| covariance[(index, index)].sqrt();
    DMatrix::from_fn(part.len(), part.len(), |row, column| {
        let (row, column) = (part.start + row, part.start + column);
        // Of numbers below 1e-154, the product of two roots can be zero.
        if covariance[(row, column)] == 0.0 {
            0.0
        } else {
            covariance[(row, column)] / (deviation(row) * deviation(column))
        }
    })
}

/// Buffers for the propagation of a covariance.
#[derive(Clone, Debug, Default)]
pub(super) struct Propagation {
    prior: PackedMatrix,
    transition: PackedMatrix,
    transposed: PackedMatrix,
    product: PackedMatrix,
    result: PackedMatrix,
}

impl Propagation {
    /// Computes `result = F P Fᵀ + Q` with a transition F `(nx, nz)`, a covariance P `(nz, nz)` and
    /// a process noise Q `(nx, nx)`. The result is exactly symmetric.
    pub(super) fn propagate(&mut self, transition: &Matrix, prior: &Matrix, noise: &Matrix, result: &mut Matrix) {
        let (simd, (nx, nz)) = (InstructionSet::detect(), transition.shape());
        self.prior.copy_rows(nz, nz, prior.as_slice());
        self.transition.copy_rows(nx, nz, transition.as_slice());
        self.transposed.transpose_from(&self.transition);
        self.product.product(simd, &self.prior, &self.transposed);
        self.result.copy_rows(nx, nx, noise.as_slice());
        self.result.add_symmetric_product(simd, &self.transition, &self.product);
        for row in 0..nx {
            self.result.row_into(row, result.row_mut(row));
        }
    }
}

vectorised! {
/// Corrects a symmetric covariance P `(n, n)`, given row-major, by one reading with the gain k and
/// the gradient c, in the form of P. Joseph: `P ← (I − k cᵀ) P (I − k cᵀ)ᵀ + r k kᵀ`, which is a
/// sum of squares, so rounding does not make it indefinite. `product` is `P c`, and c is zero
/// outside of the range `used`. The result is symmetric up to rounding.
fn correct_rows(
    covariance: &mut [f64],
    gradient: &[f64],
    gain: &[f64],
    product: &[f64],
    variance: f64,
    used: &Range<usize>,
) {
    let n = gain.len();
    for (row, &gain_of_row) in covariance.chunks_exact_mut(n).zip(gain) {
        add(row, product, -gain_of_row);
        let mut sums = [0.0; 4];
        let (row_part, gradient_part) = (&row[used.clone()], &gradient[used.clone()]);
        let (rows, row_rest) = row_part.as_chunks::<4>();
        let (gradients, gradient_rest) = gradient_part.as_chunks::<4>();
        for (row, gradient) in rows.iter().zip(gradients) {
            for lane in 0..4 {
                sums[lane] += row[lane] * gradient[lane];
            }
        }
        let rest: f64 = row_rest.iter().zip(gradient_rest).map(|(row, gradient)| row * gradient).sum();
        let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest;
        add(row, gain, variance * gain_of_row - sum);
    }
}
}

vectorised! {
/// Computes `product = P c` for a symmetric P.
pub(super) fn multiply_symmetric(covariance: &[f64], gradient: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for (row, &factor) in covariance.chunks_exact(product.len().max(1)).zip(gradient) {
        if factor != 0.0 {
            add(product, row, factor);
        }
    }
}
}

/// Computes `product = P c` for a symmetric P, and returns `cᵀ P c`, which is not negative.
pub(super) fn variance_of(covariance: &Matrix, gradient: &[f64], product: &mut [f64]) -> f64 {
    multiply_symmetric(covariance.as_slice(), gradient, product);
    dot(gradient, product).max(0.0)
}

/// Corrects a covariance by a reading with the gradient c and this variance of its noise, where
/// `product` is `P c` and `gain` is `P c / (cᵀ P c + r)`.
pub(super) fn correct(covariance: &mut Matrix, gradient: &[f64], gain: &[f64], product: &[f64], variance: f64) {
    if gain.is_empty() {
        return;
    }
    let first = gradient.iter().position(|&value| value != 0.0).unwrap_or(0);
    let end = gradient.iter().rposition(|&value| value != 0.0).map_or(first, |last| last + 1);
    correct_rows(covariance.as_mut_slice(), gradient, gain, product, variance, &(first..end));
}

pub(super) fn is_finite(values: &[f64]) -> bool {
    values.iter().fold(true, |finite, value| finite & value.is_finite())
}

/// Returns the first degree of freedom of each rotation that a quaternion represents.
pub(super) fn rotations(model: &Model) -> Vec<usize> {
    let joints = model.jnt_type().iter().zip(model.jnt_dofadr());
    let first = |(&kind, &dof): (&i32, &i32)| match JointType::of_field(kind) {
        JointType::Free => Some(dof as usize + 3),
        JointType::Ball => Some(dof as usize),
        _ => None,
    };
    joints.filter_map(first).collect()
}

/// Changes the coordinates of a covariance, which belong to the tangent space at a position, to
/// those at the position moved by `by` `(nv)`.
///
/// The error after the move is `e⁺ = (x ⊞ e) ⊟ (x ⊞ by)`, whose derivative with respect to e at
/// `e = by` is the right Jacobian of the rotation vector (J. Solà, *Quaternion kinematics for the
/// error-state Kalman filter*, 2017, sections 4.3.4 and 6.3; the first-order form there is
/// `I − [by/2]×`).
pub(super) fn transport(covariance: &mut Matrix, rotations: &[usize], by: &[f64]) {
    transport_rows(covariance, rotations, by);
    for (first, jacobian) in jacobians(rotations, by) {
        for mut row in covariance.transposed_mut().fixed_rows_mut::<3>(first).column_iter_mut() {
            let moved = jacobian * &row;
            row.copy_from(&moved);
        }
    }
}

/// Changes the coordinates of the rows of a matrix, as [`transport`] does.
pub(super) fn transport_rows(matrix: &mut Matrix, rotations: &[usize], by: &[f64]) {
    for (first, jacobian) in jacobians(rotations, by) {
        for mut column in matrix.transposed_mut().fixed_columns_mut::<3>(first).row_iter_mut() {
            let moved = &column * jacobian.transpose();
            column.copy_from(&moved);
        }
    }
}

/// Returns the first degree of freedom of each rotation that is not zero, and its right Jacobian.
fn jacobians(rotations: &[usize], by: &[f64]) -> impl Iterator<Item = (usize, Matrix3<f64>)> {
    rotations.iter().filter_map(|&first| {
        let rotation = by[first..].first_chunk::<3>()?;
        let is_zero = rotation.iter().all(|&value| value == 0.0);
        let jacobian = || Matrix3::from_row_slice(&math::quat_integrate_derivative(rotation, 1.0).dvel);
        (!is_zero).then(|| (first, jacobian()))
    })
}
