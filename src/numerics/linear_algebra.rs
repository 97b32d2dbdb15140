//! Row operations on small dense matrices, written so that the compiler vectorises them.

use std::ops::Range;

use super::vectorised;
use crate::matrix::Matrix;

/// Computes `result += factor · vector`.
#[allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
#[inline(always)]
pub(crate) fn add(result: &mut [f64], vector: &[f64], factor: f64) {
    result.iter_mut().zip(vector).for_each(|(result, value)| *result += factor * value);
}

/// Returns the scalar product of two vectors.
#[inline]
pub(crate) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// Replaces a square matrix by its symmetric part, `(M + Mᵀ) / 2`.
pub(crate) fn symmetrise(matrix: &mut Matrix) {
    let n = matrix.nrows();
    let values = matrix.as_mut_slice();
    for row in 0..n {
        for column in 0..row {
            let (lower, upper) = (row * n + column, column * n + row);
            let mean = 0.5 * (values[lower] + values[upper]);
            (values[lower], values[upper]) = (mean, mean);
        }
    }
}

/// Computes `result += factor · matrixᵀ · vector`.
pub(crate) fn add_product(result: &mut [f64], matrix: &Matrix, vector: &[f64], factor: f64) {
    vector.iter().enumerate().for_each(|(row, value)| add(result, matrix.row(row), factor * value));
}

/// Adds `factor · left · rightᵀ` to a row-major matrix, whose rows have the length `columns` of
/// `right`. Returns the range of entries of `right` that are not zero.
#[allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
#[inline(always)]
pub(crate) fn add_products(
    matrix: &mut [f64],
    columns: usize,
    left: &[f64],
    right: &[f64],
    factor: f64,
) -> Range<usize> {
    let Some(first) = right.iter().position(|&value| value != 0.0) else { return 0..0 };
    let end = right.iter().rposition(|&value| value != 0.0).map_or(first, |last| last + 1);
    let right = &right[first..end];
    for (row, &value) in left.iter().enumerate() {
        if value != 0.0 {
            add(&mut matrix[row * columns..][first..end], right, factor * value);
        }
    }
    first..end
}

/// Computes the difference quotient `result = (to − from) / width`.
pub(crate) fn quotient(result: &mut [f64], from: &[f64], to: &[f64], width: f64) {
    result.iter_mut().zip(from.iter().zip(to)).for_each(|(result, (from, to))| *result = (to - from) / width);
}

/// Computes the inverse `L⁻ᵀ L⁻¹` of a matrix from its Cholesky factor L. `lower` receives `L⁻¹`.
///
/// Uses row operations only; solving for one column after another takes several times as long.
pub(crate) fn invert(factor: &Matrix, lower: &mut Matrix, inverse: &mut Matrix) {
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

vectorised! {
/// Computes `(L Lᵀ)⁻¹ X` in place, with a Cholesky factor L in the lower triangle of `factor`.
///
/// Uses operations on the rows of X, four at a time, so that its columns are processed together.
pub(crate) fn solve_cholesky(factor: &Matrix, matrix: &mut Matrix) {
    let (n, width) = matrix.shape();
    let values = matrix.as_mut_slice();
    for row in 0..n {
        let (above, rest) = values.split_at_mut(row * width);
        let current = &mut rest[..width];
        subtract_rows(current, above, |other| factor[(row, other)]);
        let inverse = 1.0 / factor[(row, row)];
        for value in current {
            *value *= inverse;
        }
    }
    for row in (0..n).rev() {
        let (rest, below) = values.split_at_mut((row + 1) * width);
        let current = &mut rest[row * width..];
        subtract_rows(current, below, |other| factor[(row + 1 + other, row)]);
        let inverse = 1.0 / factor[(row, row)];
        for value in current {
            *value *= inverse;
        }
    }
}
}

/// Computes the factors L, with a diagonal of ones, and U of a square matrix in place, without
/// pivoting.
pub(crate) fn factor_lu(matrix: &mut Matrix) {
    let n = matrix.nrows();
    for row in 1..n {
        let (above, rest) = matrix.as_mut_slice().split_at_mut(row * n);
        let current = &mut rest[..n];
        for column in 0..row {
            let upper = &above[column * n..(column + 1) * n];
            let factor = current[column] / upper[column];
            current[column] = factor;
            if factor != 0.0 {
                add(&mut current[column + 1..], &upper[column + 1..], -factor);
            }
        }
    }
}

/// Computes `(L U)⁻¹ X` in place, with the factors of [`factor_lu`].
pub(crate) fn solve_lu(factor: &Matrix, matrix: &mut Matrix) {
    let (n, width) = matrix.shape();
    let values = matrix.as_mut_slice();
    for row in 0..n {
        let (above, rest) = values.split_at_mut(row * width);
        subtract_rows(&mut rest[..width], above, |other| factor[(row, other)]);
    }
    for row in (0..n).rev() {
        let (rest, below) = values.split_at_mut((row + 1) * width);
        let current = &mut rest[row * width..];
        subtract_rows(current, below, |other| factor[(row, row + 1 + other)]);
        let inverse = 1.0 / factor[(row, row)];
        for value in current {
            *value *= inverse;
        }
    }
}

/// Computes `(L U)⁻ᵀ x` in place, with the factors of [`factor_lu`].
pub(crate) fn solve_lu_transposed(factor: &Matrix, vector: &mut [f64]) {
    let n = vector.len();
    for row in 0..n {
        vector[row] /= factor[(row, row)];
        let (done, rest) = vector.split_at_mut(row + 1);
        add(rest, &factor.row(row)[row + 1..], -done[row]);
    }
    for row in (1..n).rev() {
        let (above, rest) = vector.split_at_mut(row);
        add(above, &factor.row(row)[..row], -rest[0]);
    }
}

/// Subtracts a multiple of each row of `rows` from `result`.
#[allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
#[inline(always)]
fn subtract_rows(result: &mut [f64], rows: &[f64], factor: impl Fn(usize) -> f64) {
    let width = result.len();
    if width == 0 {
        return;
    }
    let mut blocks = rows.chunks_exact(4 * width);
    let mut index = 0;
    for block in blocks.by_ref() {
        let [a, b, c, d] = [0, 1, 2, 3].map(|row| factor(index + row));
        let (first, rest) = block.split_at(width);
        let (second, rest) = rest.split_at(width);
        let (third, fourth) = rest.split_at(width);
        let rows = first.iter().zip(second).zip(third).zip(fourth);
        for (result, (((first, second), third), fourth)) in result.iter_mut().zip(rows) {
            *result -= (a * first + b * second) + (c * third + d * fourth);
        }
        index += 4;
    }
    for row in blocks.remainder().chunks_exact(width) {
        add(result, row, -factor(index));
        index += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::{factor_lu, solve_cholesky, solve_lu};
    use crate::math;
    use crate::matrix::Matrix;

    #[test]
    fn cholesky_solves_agree_with_the_engine() {
        const N: usize = 11;
        let root = Matrix::from_row_major(N, N, (0..N * N).map(|i| (1.7 * i as f64).sin()).collect());
        let mut factor = Matrix::zeros(N, N);
        math::mul_mat_mat_t(&mut factor, &root, &root).unwrap();
        // The product is singular.
        (0..N).for_each(|row| factor[(row, row)] += 1.0);
        math::chol_factor(&mut factor, 0.0).unwrap();
        for width in [0, 1, 3, 9] {
            let mut ours = Matrix::from_row_major(N, width, (0..N * width).map(|i| (0.9 * i as f64).cos()).collect());
            let right = ours.clone();
            solve_cholesky(&factor, &mut ours);
            for column in 0..width {
                let mut theirs: Vec<f64> = (0..N).map(|row| right[(row, column)]).collect();
                math::chol_solve_in_place(&factor, &mut theirs).unwrap();
                for (row, value) in theirs.into_iter().enumerate() {
                    let tolerance = 1e-9 * (1.0 + value.abs());
                    assert!((ours[(row, column)] - value).abs() < tolerance, "row {row} of {width} columns");
                }
            }
        }
    }

    #[test]
    fn lu_solves_invert_the_product_with_the_matrix() {
        const N: usize = 7;
        let mut matrix = Matrix::from_row_major(N, N, (0..N * N).map(|i| (1.7 * i as f64).sin()).collect());
        // Without pivoting, the diagonal has to dominate.
        (0..N).for_each(|row| matrix[(row, row)] += 5.0);
        let mut factor = matrix.clone();
        factor_lu(&mut factor);
        for width in [0, 1, 3, 9] {
            let solution = Matrix::from_row_major(N, width, (0..N * width).map(|i| (0.9 * i as f64).cos()).collect());
            let mut product = Matrix::zeros(N, width);
            math::mul_mat_mat(&mut product, &matrix, &solution).unwrap();
            solve_lu(&factor, &mut product);
            for (ours, theirs) in product.as_slice().iter().zip(solution.as_slice()) {
                assert!((ours - theirs).abs() < 1e-13, "{width} columns");
            }
        }
    }
}
