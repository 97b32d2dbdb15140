//! Kernels on 8 × 8 blocks: products, triangular solves, and elimination.
//!
//! Products and solves are built from one micro-kernel, `accumulate`, whose sums stay in vector
//! registers. The kernels are compiled for several instruction sets.
#![allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
#![allow(clippy::needless_range_loop, reason = "index loops over arrays, which the compiler unrolls")]
#![allow(clippy::needless_pass_by_value, reason = "a view that is created for the call")]
#![allow(clippy::many_single_char_names, reason = "the entries of a block")]

use crate::numerics::for_processor;

/// Rows and columns of a block.
pub(super) const BLOCK: usize = 8;

/// Row of a block: a vector register of eight numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct F64x8(pub(super) [f64; BLOCK]);

impl F64x8 {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);

    /// Returns the sum of the entries.
    pub(super) fn sum(&self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    }
}

for_processor! {
    /// Computes `out = left · right`, or adds or subtracts the product, for matrices in panels.
    pub(super) fn multiply = product(out: Blocks<'_>, left: &[F64x8], right: &[F64x8])
}
for_processor! {
    /// Computes `out = leftᵀ · right`, or adds or subtracts the product.
    pub(super) fn multiply_transposed = transposed_product(out: Blocks<'_>, left: &[F64x8], right: &[F64x8])
}
for_processor! {
    /// Solves a system with a lower triangular matrix (forward substitution), given the inverses of
    /// its diagonal blocks. With fewer inverses than diagonal blocks, uses only the corresponding
    /// block columns of the matrix.
    pub(super) fn substitute_forward = forward(lower: &[F64x8], size: usize, inverses: &[F64x8], right: &mut [F64x8])
}
for_processor! {
    /// Solves a system with an upper triangular matrix (back substitution), given the inverses of
    /// its diagonal blocks.
    pub(super) fn substitute_backward = backward(upper: &[F64x8], size: usize, inverses: &[F64x8], right: &mut [F64x8])
}
for_processor! {
    /// Eliminates a column below the pivot: `row -= factor · pivot`, and stores each factor in the
    /// eliminated entry.
    pub(super) fn eliminate = eliminate_column(column: usize, inverse: f64, pivot: &F64x8, below: &mut [F64x8])
}
for_processor! {
    /// Computes `sums += Σ factor · row` over the first rows of a panel, with one factor per row.
    pub(super) fn add_rows = sum_scaled_rows(factors: &[f64], rows: &[F64x8], sums: &mut F64x8)
}
for_processor! {
    /// Computes `row -= factor · by` for the rows of a panel, and adds the squares of the results
    /// to `squares`.
    pub(super) fn subtract_rows = subtract_scaled_row(factors: &[f64], by: &F64x8, rows: &mut [F64x8], squares: &mut F64x8)
}

/// Combination of a product with the previous value of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Update {
    Set,
    Add,
    Subtract,
}

/// Output of a product: the panels of a matrix, each of `size` rows.
#[derive(Debug)]
pub(super) struct Blocks<'a> {
    pub(super) vectors: &'a mut [F64x8],
    pub(super) size: usize,
    pub(super) update: Update,
    /// Skips the blocks above the diagonal.
    pub(super) only_lower: bool,
}

impl Blocks<'_> {
    /// Returns the number of rows of each panel of `right`. If an operand is empty, writes the zero
    /// product and returns `None`.
    #[inline(always)]
    fn inner(&mut self, left: &[F64x8], right: &[F64x8]) -> Option<usize> {
        if self.vectors.is_empty() || left.is_empty() {
            if self.update == Update::Set {
                self.vectors.fill(F64x8::ZERO);
            }
            return None;
        }
        Some(right.len() / (self.vectors.len() / self.size))
    }
}

#[inline(always)]
fn store(out: &mut [F64x8], sums: &[F64x8], update: Update) {
    for (out, sum) in out.iter_mut().zip(sums) {
        for lane in 0..BLOCK {
            out.0[lane] = match update {
                Update::Set => sum.0[lane],
                Update::Add => out.0[lane] + sum.0[lane],
                Update::Subtract => out.0[lane] - sum.0[lane],
            };
        }
    }
}

/// Computes `sum += factor · row`.
#[inline(always)]
fn multiply_add<const FUSED: bool>(sum: &mut F64x8, factor: f64, row: &F64x8) {
    for lane in 0..BLOCK {
        sum.0[lane] = if FUSED { factor.mul_add(row.0[lane], sum.0[lane]) } else { factor * row.0[lane] + sum.0[lane] };
    }
}

/// Computes `sums += left · right` for `ROWS` rows of the block `left` and the complete block
/// `right`.
#[inline(always)]
fn accumulate<const FUSED: bool, const ROWS: usize>(
    sums: &mut [F64x8; ROWS],
    left: &[F64x8; ROWS],
    right: &[F64x8; BLOCK],
) {
    for column in 0..BLOCK {
        for row in 0..ROWS {
            multiply_add::<FUSED>(&mut sums[row], left[row].0[column], &right[column]);
        }
    }
}

/// Inverts the unit lower triangle of a block.
pub(super) fn invert_lower(block: &[F64x8; BLOCK]) -> [F64x8; BLOCK] {
    let mut inverse = [F64x8::ZERO; BLOCK];
    for row in 0..BLOCK {
        inverse[row].0[row] = 1.0;
        for column in 0..row {
            let (above, below) = inverse.split_at_mut(row);
            multiply_add::<false>(&mut below[0], -block[row].0[column], &above[column]);
        }
    }
    inverse
}

/// Inverts the upper triangle of a block, given the reciprocals of its diagonal.
pub(super) fn invert_upper(block: &[F64x8; BLOCK], reciprocals: &[f64; BLOCK]) -> [F64x8; BLOCK] {
    let mut inverse = [F64x8::ZERO; BLOCK];
    for row in (0..BLOCK).rev() {
        inverse[row].0[row] = 1.0;
        for column in row + 1..BLOCK {
            let (above, below) = inverse.split_at_mut(row + 1);
            multiply_add::<false>(&mut above[row], -block[row].0[column], &below[column - row - 1]);
        }
        inverse[row].0.iter_mut().for_each(|entry| *entry *= reciprocals[row]);
    }
    inverse
}

#[inline(always)]
fn product<const FUSED: bool, const ROWS: usize>(mut out: Blocks<'_>, left: &[F64x8], right: &[F64x8]) {
    let Some(inner) = out.inner(left, right) else { return };
    let Blocks { update, only_lower, .. } = out;
    for (panel, (out, right)) in out.vectors.chunks_exact_mut(out.size).zip(right.chunks_exact(inner)).enumerate() {
        let first = if only_lower { BLOCK * panel } else { 0 };
        let size = out.len();
        for start in (first..size).step_by(ROWS) {
            let mut sums = [F64x8::ZERO; ROWS];
            for (left, right) in left.chunks_exact(size).zip(right.as_chunks::<BLOCK>().0) {
                let left: &[F64x8; ROWS] = left[start..].first_chunk().expect("Bug: panels end with a block");
                accumulate::<FUSED, ROWS>(&mut sums, left, right);
            }
            store(&mut out[start..start + ROWS], &sums, update);
        }
    }
}

#[inline(always)]
fn transposed_product<const FUSED: bool, const ROWS: usize>(mut out: Blocks<'_>, left: &[F64x8], right: &[F64x8]) {
    let Some(inner) = out.inner(left, right) else { return };
    let Blocks { update, only_lower, .. } = out;
    for (panel, (out, right)) in out.vectors.chunks_exact_mut(out.size).zip(right.chunks_exact(inner)).enumerate() {
        let first = if only_lower { panel } else { 0 };
        for (out, left) in out.as_chunks_mut::<BLOCK>().0.iter_mut().zip(left.chunks_exact(inner)).skip(first) {
            for start in (0..BLOCK).step_by(ROWS) {
                let mut sums = [F64x8::ZERO; ROWS];
                for (left, right) in left.iter().zip(right) {
                    for row in 0..ROWS {
                        multiply_add::<FUSED>(&mut sums[row], left.0[start + row], right);
                    }
                }
                store(&mut out[start..start + ROWS], &sums, update);
            }
        }
    }
}

/// Solves for block `index` of a panel of right-hand sides: subtracts the contributions of the
/// `known` blocks, and multiplies by the inverse of the diagonal block, if it is given.
#[inline(always)]
fn substitute<const FUSED: bool, const ROWS: usize>(
    matrix: &[F64x8],
    size: usize,
    index: usize,
    known: std::ops::Range<usize>,
    inverse: Option<&[F64x8; BLOCK]>,
    panel: &mut [F64x8],
) {
    let first = BLOCK * index;
    for start in (first..first + BLOCK).step_by(ROWS) {
        let mut sums = [F64x8::ZERO; ROWS];
        let columns = matrix.chunks_exact(size).zip(panel.as_chunks::<BLOCK>().0);
        for (left, right) in columns.take(known.end).skip(known.start) {
            let left: &[F64x8; ROWS] = left[start..].first_chunk().expect("Bug: panels end with a block");
            accumulate::<FUSED, ROWS>(&mut sums, left, right);
        }
        store(&mut panel[start..start + ROWS], &sums, Update::Subtract);
    }
    if let Some(inverse) = inverse {
        let block: &mut [F64x8; BLOCK] = panel[first..].first_chunk_mut().expect("Bug: as above");
        let right = *block;
        for start in (0..BLOCK).step_by(ROWS) {
            let mut sums = [F64x8::ZERO; ROWS];
            let left: &[F64x8; ROWS] = inverse[start..].first_chunk().expect("Bug: as above");
            accumulate::<FUSED, ROWS>(&mut sums, left, &right);
            block[start..start + ROWS].copy_from_slice(&sums);
        }
    }
}

#[inline(always)]
fn forward<const FUSED: bool, const ROWS: usize>(
    lower: &[F64x8],
    size: usize,
    inverses: &[F64x8],
    right: &mut [F64x8],
) {
    let inverses = inverses.as_chunks::<BLOCK>().0;
    for panel in right.chunks_exact_mut(size) {
        for index in 0..size / BLOCK {
            let known = 0..index.min(inverses.len());
            substitute::<FUSED, ROWS>(lower, size, index, known, inverses.get(index), panel);
        }
    }
}

#[inline(always)]
fn backward<const FUSED: bool, const ROWS: usize>(
    upper: &[F64x8],
    size: usize,
    inverses: &[F64x8],
    right: &mut [F64x8],
) {
    let inverses = inverses.as_chunks::<BLOCK>().0;
    for panel in right.chunks_exact_mut(size) {
        for index in (0..size / BLOCK).rev() {
            let known = index + 1..size / BLOCK;
            substitute::<FUSED, ROWS>(upper, size, index, known, inverses.get(index), panel);
        }
    }
}

#[inline(always)]
fn eliminate_column<const FUSED: bool, const ROWS: usize>(
    column: usize,
    inverse: f64,
    pivot: &F64x8,
    below: &mut [F64x8],
) {
    let mut rest = *pivot;
    rest.0[..=column].fill(0.0);
    for row in below {
        let factor = row.0[column] * inverse;
        multiply_add::<FUSED>(row, -factor, &rest);
        row.0[column] = factor;
    }
}

#[inline(always)]
fn sum_scaled_rows<const FUSED: bool, const ROWS: usize>(factors: &[f64], rows: &[F64x8], sums: &mut F64x8) {
    // Four independent sums hide the latency of the additions.
    let mut parts = [*sums, F64x8::ZERO, F64x8::ZERO, F64x8::ZERO];
    let (fours, rest) = factors.as_chunks::<4>();
    for (factors, rows) in fours.iter().zip(rows.as_chunks::<4>().0) {
        for part in 0..4 {
            multiply_add::<FUSED>(&mut parts[part], factors[part], &rows[part]);
        }
    }
    for (factor, row) in rest.iter().zip(&rows[factors.len() - rest.len()..]) {
        multiply_add::<FUSED>(&mut parts[0], *factor, row);
    }
    let [a, b, c, d] = parts;
    for lane in 0..BLOCK {
        sums.0[lane] = (a.0[lane] + b.0[lane]) + (c.0[lane] + d.0[lane]);
    }
}

#[inline(always)]
fn subtract_scaled_row<const FUSED: bool, const ROWS: usize>(
    factors: &[f64],
    by: &F64x8,
    rows: &mut [F64x8],
    squares: &mut F64x8,
) {
    let mut parts = [F64x8::ZERO; 2];
    for (factors, rows) in factors.as_chunks::<2>().0.iter().zip(rows.as_chunks_mut::<2>().0) {
        for part in 0..2 {
            multiply_add::<FUSED>(&mut rows[part], -factors[part], by);
            let row = rows[part];
            for lane in 0..BLOCK {
                let value = row.0[lane];
                parts[part].0[lane] =
                    if FUSED { value.mul_add(value, parts[part].0[lane]) } else { value * value + parts[part].0[lane] };
            }
        }
    }
    for lane in 0..BLOCK {
        squares.0[lane] += parts[0].0[lane] + parts[1].0[lane];
    }
}

#[cfg(test)]
mod tests {
    use super::super::lu::LuFactors;
    use super::super::packed::PackedMatrix;
    use crate::numerics::InstructionSet;

    fn entry(seed: usize) -> impl Fn(usize, usize) -> f64 {
        move |row, column| (((row * 31 + column * 17 + seed * 7) % 23) as f64 - 11.0) / 8.0
    }

    fn matrix(rows: usize, columns: usize, seed: usize) -> PackedMatrix {
        let mut matrix = PackedMatrix::default();
        matrix.fill(rows, columns, entry(seed));
        matrix
    }

    /// The entries are small integers over a power of two, whose sums and products are exact.
    #[test]
    fn products_equal_the_definition_with_all_instruction_sets() {
        for simd in InstructionSet::all() {
            for (rows, inner, columns) in [(1, 1, 1), (3, 8, 9), (8, 5, 16), (17, 30, 9), (54, 21, 54), (4, 0, 3)] {
                let (left, right) = (entry(1), entry(2));
                let expected = |row, column| (0..inner).map(|k| left(row, k) * right(k, column)).sum::<f64>();
                let (mut out, mut transpose) = (matrix(2, 30, 3), PackedMatrix::default());
                out.product(simd, &matrix(rows, inner, 1), &matrix(inner, columns, 2));
                let mut with_transpose = matrix(2, 30, 3);
                transpose.transpose_from(&matrix(rows, inner, 1));
                with_transpose.transposed_product(simd, &transpose, &matrix(inner, columns, 2));
                for row in 0..rows {
                    for column in 0..columns {
                        assert_eq!(out.get(row, column), expected(row, column), "{simd:?}");
                        assert_eq!(with_transpose.get(row, column), expected(row, column), "{simd:?}");
                    }
                }
                // The padding remains zero.
                assert_eq!(out.norm(), with_transpose.norm());
                out.subtract_product(simd, &matrix(rows, inner, 1), &matrix(inner, columns, 2));
                assert_eq!(out.norm(), 0.0);
            }
        }
    }

    #[test]
    fn lu_solves_systems_with_all_instruction_sets() {
        for simd in InstructionSet::all() {
            for size in [1, 7, 8, 9, 23, 54] {
                let mut factors = LuFactors::default();
                // The large entries are on the antidiagonal, so the factorisation must exchange
                // rows.
                factors.matrix().fill(size, size, |row, column| {
                    entry(4)(row, column) + if row + column + 1 == size { 40.0 } else { 0.0 }
                });
                let (kept, right) = (factors.matrix().clone(), matrix(size, 11, 5));
                let mut solution = right.clone();
                assert!(factors.factorise(simd), "{size}");
                factors.solve(simd, &mut solution);
                let mut back = PackedMatrix::default();
                back.product(simd, &kept, &solution);
                back.subtract(&right);
                assert!(back.norm() < 1e-12 * right.norm(), "{simd:?}, {size}: {:e}", back.norm());
            }
        }
    }
}
