//! The dense kernels that the doubling spends its time in, arranged so that nearly all of their arithmetic is matrix products.
//!
//! nalgebra hands products of dynamically sized `f64` matrices to `matrixmultiply`, which runs at over ten times the speed of
//! nalgebra's column-by-column triangular solves; [`BlockLu::solve`] is therefore a blocked substitution.
//!
//! Transposes are copied, never viewed: nalgebra's small products read and write out of bounds when their left factor is a view whose rows
//! are not contiguous in memory (<https://github.com/dimforge/nalgebra/issues/1616>), and the copy costs a tenth of the product.

use nalgebra::{DMatrix, DMatrixViewMut, Dyn, LU};

/// Rows and columns in a diagonal block of [`BlockLu`].
const BLOCK: usize = 32;

/// Squarings in [`log_spectral_radius`]: the last one weighs 2⁻⁵², an `f64`'s resolution.
const SQUARINGS: i32 = 52;

/// Replaces `matrix` by its symmetric part, `(M + Mᵀ) / 2`.
pub(super) fn symmetrise(matrix: &mut DMatrix<f64>) {
    for column in 0..matrix.ncols() {
        for row in 0..column {
            let mean = 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
            matrix[(row, column)] = mean;
            matrix[(column, row)] = mean;
        }
    }
}

/// `factor · middle · factorᵀ`, for a symmetric `middle`, symmetric to the last bit.
pub(super) fn congruence(factor: &DMatrix<f64>, middle: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = factor * middle * factor.transpose();
    symmetrise(&mut product);
    product
}

/// `I + left · right`.
pub(super) fn identity_plus_product(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut sum = DMatrix::identity(left.nrows(), right.ncols());
    sum.gemm(1.0, left, right, 1.0);
    sum
}

/// The natural logarithm of the largest modulus among the eigenvalues, by Gelfand's formula `ρ = lim ‖Mᵗ‖^(1/t)` with
/// `t = 1, 2, 4, …`. Unlike a Schur decomposition it always ends.
pub(super) fn log_spectral_radius(mut matrix: DMatrix<f64>) -> f64 {
    let mut logarithm = 0.0;
    for squaring in 0..=SQUARINGS {
        let norm = matrix.norm();
        if norm == 0.0 {
            return f64::NEG_INFINITY;
        }
        logarithm += norm.ln() * 0.5_f64.powi(squaring);
        matrix /= norm;
        matrix = &matrix * &matrix;
    }
    logarithm
}

/// An LU factorisation with partial pivoting whose diagonal blocks are inverted once, so that a solve is made of products.
pub(super) struct BlockLu {
    factors: LU<f64, Dyn, Dyn>,
    /// For each block, the inverses of the unit lower and of the upper triangle on the diagonal.
    diagonal: Vec<(DMatrix<f64>, DMatrix<f64>)>,
}

impl BlockLu {
    /// Factorises a square matrix; `None` if it is singular to working precision, or not finite.
    pub(super) fn new(matrix: DMatrix<f64>) -> Option<Self> {
        let size = matrix.nrows();
        let factors = LU::new(matrix);
        let packed = factors.lu_internal();
        let diagonal = (0..size)
            .step_by(BLOCK)
            .map(|start| {
                let width = BLOCK.min(size - start);
                let block = packed.view((start, start), (width, width)).into_owned();
                Some((inverse_of_unit_lower(&block), inverse_of_upper(&block)?))
            })
            .collect::<Option<_>>()?;
        Some(Self { factors, diagonal })
    }

    /// Replaces `right` by the solution `X` of `M X = right`.
    pub(super) fn solve(&self, right: &mut DMatrix<f64>) {
        let packed = self.factors.lu_internal();
        let (size, columns) = right.shape();
        let mut scratch = DMatrix::zeros(BLOCK, columns);
        self.factors.p().permute_rows(right);

        for (index, (lower, _)) in self.diagonal.iter().enumerate() {
            let (start, width) = (index * BLOCK, lower.nrows());
            let (solved, mut current) = right.rows_range_pair_mut(..start, start..start + width);
            if start > 0 {
                current.gemm(-1.0, &packed.view((start, 0), (width, start)), &solved, 1.0);
            }
            replace_by_product(lower, &mut current, &mut scratch);
        }
        for (index, (_, upper)) in self.diagonal.iter().enumerate().rev() {
            let (start, width) = (index * BLOCK, upper.nrows());
            let end = start + width;
            let (mut current, solved) = right.rows_range_pair_mut(start..end, end..);
            if end < size {
                current.gemm(-1.0, &packed.view((start, end), (width, size - end)), &solved, 1.0);
            }
            replace_by_product(upper, &mut current, &mut scratch);
        }
    }
}

/// Replaces `block` by `factor · block`.
fn replace_by_product(factor: &DMatrix<f64>, block: &mut DMatrixViewMut<'_, f64>, scratch: &mut DMatrix<f64>) {
    let mut product = scratch.rows_mut(0, factor.nrows());
    product.gemm(1.0, factor, block, 0.0);
    block.copy_from(&product);
}

/// The inverse of the unit lower triangle packed in `block`.
fn inverse_of_unit_lower(block: &DMatrix<f64>) -> DMatrix<f64> {
    let size = block.nrows();
    let mut inverse = DMatrix::identity(size, size);
    for (index, mut column) in inverse.column_iter_mut().enumerate() {
        for pivot in index..size {
            let value: f64 = column[pivot];
            let below = block.view((pivot + 1, pivot), (size - pivot - 1, 1));
            column.rows_mut(pivot + 1, size - pivot - 1).axpy(-value, &below.column(0), 1.0);
        }
    }
    inverse
}

/// The inverse of the upper triangle packed in `block`; `None` if it is not finite.
fn inverse_of_upper(block: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = block.nrows();
    let mut inverse = DMatrix::identity(size, size);
    for (index, mut column) in inverse.column_iter_mut().enumerate() {
        for pivot in (0..=index).rev() {
            let value: f64 = column[pivot] / block[(pivot, pivot)];
            if !value.is_finite() {
                return None;
            }
            column[pivot] = value;
            let above = block.view((0, pivot), (pivot, 1));
            column.rows_mut(0, pivot).axpy(-value, &above.column(0), 1.0);
        }
    }
    Some(inverse)
}
