//! Row operations on small dense matrices, written so that the compiler vectorises them.

use crate::matrix::Matrix;

/// Computes `result += factor · vector`.
pub(super) fn add(result: &mut [f64], vector: &[f64], factor: f64) {
    result.iter_mut().zip(vector).for_each(|(result, value)| *result += factor * value);
}

/// Computes `result += factor · matrixᵀ · vector`.
pub(super) fn add_product(result: &mut [f64], matrix: &Matrix, vector: &[f64], factor: f64) {
    vector.iter().enumerate().for_each(|(row, value)| add(result, matrix.row(row), factor * value));
}

/// Computes the difference quotient `result = (to − from) / width`.
pub(super) fn quotient(result: &mut [f64], from: &[f64], to: &[f64], width: f64) {
    result.iter_mut().zip(from.iter().zip(to)).for_each(|(result, (from, to))| *result = (to - from) / width);
}

/// Computes the inverse `L⁻ᵀ L⁻¹` of a matrix from its Cholesky factor L. `lower` receives `L⁻¹`.
///
/// Uses row operations only; solving for one column after another takes several times as long.
pub(super) fn invert(factor: &Matrix, lower: &mut Matrix, inverse: &mut Matrix) {
    let n = factor.nrows();
    for row in 0..n {
        let (above, rest) = lower.as_mut_slice().split_at_mut(row * n);
        let current = &mut rest[..=row];
        current.fill(0.0);
        current[row] = 1.0;
        for column in 0..row {
            add(&mut current[..=column], &above[column * n..=column * n + column], -factor[(row, column)]);
        }
        let pivot = factor[(row, row)];
        for value in current {
            *value /= pivot;
        }
    }
    inverse.as_mut_slice().fill(0.0);
    for row in 0..n {
        let values = &lower.row(row)[..=row];
        for (column, &value) in values.iter().enumerate() {
            add(&mut inverse.row_mut(column)[..=column], &values[..=column], value);
        }
    }
    for row in 0..n {
        for column in 0..row {
            inverse[(column, row)] = inverse[(row, column)];
        }
    }
}
