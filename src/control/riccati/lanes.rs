//! The innermost loops: blocks of eight by eight numbers, multiplied and added.
//!
//! nalgebra hands large products to `matrixmultiply`, which allocates at every call, and solves triangular systems column by column.
//! Here everything is made of one step, `accumulate`, that keeps its sums in vector registers; it is compiled for each set of
//! instructions that an x86 processor may have, and the best is chosen when the program runs.
#![allow(clippy::inline_always, reason = "what is not inlined is not compiled for the processor")]
#![allow(clippy::needless_range_loop, reason = "loops over indices of arrays, which the compiler unrolls")]
#![allow(clippy::needless_pass_by_value, reason = "a view, made for the call")]

/// Rows and columns of a block.
pub(super) const BLOCK: usize = 8;

/// A row of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Lane(pub(super) [f64; BLOCK]);

impl Lane {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);

    pub(super) fn sum(&self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    }
}

/// Which instructions there are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Processor(Instructions);

#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "the last two are made on x86 only")]
enum Instructions {
    Any,
    Avx2,
    Avx512,
}

impl Processor {
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                return Self(Instructions::Avx512);
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self(Instructions::Avx2);
            }
        }
        Self(Instructions::Any)
    }
}

/// Whether one instruction multiplies and adds where nothing is known of the processor.
const ALWAYS_FUSED: bool = cfg!(any(target_arch = "aarch64", target_feature = "fma"));

/// Makes a function that calls another, compiled for the processor. Its parameters are whether one instruction multiplies and
/// adds, and how many rows of a block the registers have room for.
macro_rules! for_processor {
    ($(#[$doc:meta])* fn $name:ident = $inner:ident($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$doc])*
        pub(super) fn $name(processor: Processor, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f")]
                fn avx512($($argument: $kind),*) {
                    $inner::<true, 8>($($argument),*);
                }
                #[target_feature(enable = "avx2,fma")]
                fn avx2($($argument: $kind),*) {
                    $inner::<true, 4>($($argument),*);
                }
                match processor.0 {
                    // SAFETY: `Processor::detect`, which alone makes this value, has found these instructions.
                    Instructions::Avx512 => return unsafe { avx512($($argument),*) },
                    // SAFETY: as above.
                    Instructions::Avx2 => return unsafe { avx2($($argument),*) },
                    Instructions::Any => (),
                }
            }
            let _ = processor;
            $inner::<ALWAYS_FUSED, 2>($($argument),*);
        }
    };
}

for_processor! {
    /// `out = left · right`, or that added to it or subtracted, of matrices in panels.
    fn multiply = product(out: Blocks<'_>, left: &[Lane], right: &[Lane])
}
for_processor! {
    /// `out = leftᵀ · right`, likewise.
    fn multiply_transposed = transposed_product(out: Blocks<'_>, left: &[Lane], right: &[Lane])
}
for_processor! {
    /// The solution of a system with a lower triangular matrix, given the inverses of its blocks on the diagonal. If these are
    /// fewer, only as many of its block columns are made use of.
    fn substitute_forward = forward(lower: &[Lane], size: usize, inverses: &[Lane], right: &mut [Lane])
}
for_processor! {
    /// The solution of a system with an upper triangular matrix, given the inverses of its blocks on the diagonal.
    fn substitute_backward = backward(upper: &[Lane], size: usize, inverses: &[Lane], right: &mut [Lane])
}
for_processor! {
    /// `rows -= factors · row`, except for what the factors are written to.
    fn eliminate = eliminate_column(column: usize, inverse: f64, pivot: &Lane, below: &mut [Lane])
}
for_processor! {
    /// `sums += Σ factor · row`, for the rows of a panel and as many factors.
    fn add_rows = rows_times(factors: &[f64], rows: &[Lane], sums: &mut Lane)
}
for_processor! {
    /// `row -= factor · by`, for the rows of a panel; the squares of what is left are added up.
    fn subtract_rows = rows_less(factors: &[f64], by: &Lane, rows: &mut [Lane], squares: &mut Lane)
}

/// What becomes of a product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    Set,
    Add,
    Subtract,
}

/// The panels of a matrix, each of `size` rows, where a product goes.
#[derive(Debug)]
pub(super) struct Blocks<'a> {
    pub(super) lanes: &'a mut [Lane],
    pub(super) size: usize,
    pub(super) then: Then,
    /// Leaves out the blocks above the diagonal.
    pub(super) only_lower: bool,
}

impl Blocks<'_> {
    /// The rows of `right` that each panel has. Where there are none, or none in `left`, the product is zero, and all is done.
    #[inline(always)]
    fn inner(&mut self, left: &[Lane], right: &[Lane]) -> Option<usize> {
        if self.lanes.is_empty() || left.is_empty() {
            if self.then == Then::Set {
                self.lanes.fill(Lane::ZERO);
            }
            return None;
        }
        Some(right.len() / (self.lanes.len() / self.size))
    }
}

#[inline(always)]
fn store(out: &mut [Lane], sums: &[Lane], then: Then) {
    for (out, sum) in out.iter_mut().zip(sums) {
        for lane in 0..BLOCK {
            out.0[lane] = match then {
                Then::Set => sum.0[lane],
                Then::Add => out.0[lane] + sum.0[lane],
                Then::Subtract => out.0[lane] - sum.0[lane],
            };
        }
    }
}

/// `sum += factor · row`.
#[inline(always)]
fn multiply_add<const FUSED: bool>(sum: &mut Lane, factor: f64, row: &Lane) {
    for lane in 0..BLOCK {
        sum.0[lane] = if FUSED { factor.mul_add(row.0[lane], sum.0[lane]) } else { factor * row.0[lane] + sum.0[lane] };
    }
}

/// `sums += left · right`, for rows of a block and a whole one.
#[inline(always)]
fn accumulate<const FUSED: bool, const ROWS: usize>(
    sums: &mut [Lane; ROWS],
    left: &[Lane; ROWS],
    right: &[Lane; BLOCK],
) {
    for column in 0..BLOCK {
        for row in 0..ROWS {
            multiply_add::<FUSED>(&mut sums[row], left[row].0[column], &right[column]);
        }
    }
}

/// The inverse of the triangle with ones on its diagonal that is below that of a block.
pub(super) fn invert_lower(block: &[Lane; BLOCK]) -> [Lane; BLOCK] {
    let mut inverse = [Lane::ZERO; BLOCK];
    for row in 0..BLOCK {
        inverse[row].0[row] = 1.0;
        for column in 0..row {
            let (above, below) = inverse.split_at_mut(row);
            multiply_add::<false>(&mut below[0], -block[row].0[column], &above[column]);
        }
    }
    inverse
}

/// The inverse of the triangle that is above the diagonal of a block, and on it, given the reciprocals of the latter.
pub(super) fn invert_upper(block: &[Lane; BLOCK], reciprocals: &[f64; BLOCK]) -> [Lane; BLOCK] {
    let mut inverse = [Lane::ZERO; BLOCK];
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
fn product<const FUSED: bool, const ROWS: usize>(mut out: Blocks<'_>, left: &[Lane], right: &[Lane]) {
    let Some(inner) = out.inner(left, right) else { return };
    let Blocks { then, only_lower, .. } = out;
    for (panel, (out, right)) in out.lanes.chunks_exact_mut(out.size).zip(right.chunks_exact(inner)).enumerate() {
        let first = if only_lower { BLOCK * panel } else { 0 };
        let size = out.len();
        for start in (first..size).step_by(ROWS) {
            let mut sums = [Lane::ZERO; ROWS];
            for (left, right) in left.chunks_exact(size).zip(right.as_chunks::<BLOCK>().0) {
                let left: &[Lane; ROWS] = left[start..].first_chunk().expect("Bug: panels end with a block");
                accumulate::<FUSED, ROWS>(&mut sums, left, right);
            }
            store(&mut out[start..start + ROWS], &sums, then);
        }
    }
}

#[inline(always)]
fn transposed_product<const FUSED: bool, const ROWS: usize>(mut out: Blocks<'_>, left: &[Lane], right: &[Lane]) {
    let Some(inner) = out.inner(left, right) else { return };
    let Blocks { then, only_lower, .. } = out;
    for (panel, (out, right)) in out.lanes.chunks_exact_mut(out.size).zip(right.chunks_exact(inner)).enumerate() {
        let first = if only_lower { panel } else { 0 };
        for (out, left) in out.as_chunks_mut::<BLOCK>().0.iter_mut().zip(left.chunks_exact(inner)).skip(first) {
            for start in (0..BLOCK).step_by(ROWS) {
                let mut sums = [Lane::ZERO; ROWS];
                for (left, right) in left.iter().zip(right) {
                    for row in 0..ROWS {
                        multiply_add::<FUSED>(&mut sums[row], left.0[start + row], right);
                    }
                }
                store(&mut out[start..start + ROWS], &sums, then);
            }
        }
    }
}

/// Finishes block `index` of a panel of right sides: takes from it what the blocks of `known` contribute, and multiplies by the inverse of
/// the block on the diagonal, if there is one.
#[inline(always)]
fn substitute<const FUSED: bool, const ROWS: usize>(
    matrix: &[Lane],
    size: usize,
    index: usize,
    known: std::ops::Range<usize>,
    inverse: Option<&[Lane; BLOCK]>,
    panel: &mut [Lane],
) {
    let first = BLOCK * index;
    for start in (first..first + BLOCK).step_by(ROWS) {
        let mut sums = [Lane::ZERO; ROWS];
        let columns = matrix.chunks_exact(size).zip(panel.as_chunks::<BLOCK>().0);
        for (left, right) in columns.take(known.end).skip(known.start) {
            let left: &[Lane; ROWS] = left[start..].first_chunk().expect("Bug: panels end with a block");
            accumulate::<FUSED, ROWS>(&mut sums, left, right);
        }
        store(&mut panel[start..start + ROWS], &sums, Then::Subtract);
    }
    if let Some(inverse) = inverse {
        let block: &mut [Lane; BLOCK] = panel[first..].first_chunk_mut().expect("Bug: as above");
        let right = *block;
        for start in (0..BLOCK).step_by(ROWS) {
            let mut sums = [Lane::ZERO; ROWS];
            let left: &[Lane; ROWS] = inverse[start..].first_chunk().expect("Bug: as above");
            accumulate::<FUSED, ROWS>(&mut sums, left, &right);
            block[start..start + ROWS].copy_from_slice(&sums);
        }
    }
}

#[inline(always)]
fn forward<const FUSED: bool, const ROWS: usize>(lower: &[Lane], size: usize, inverses: &[Lane], right: &mut [Lane]) {
    let inverses = inverses.as_chunks::<BLOCK>().0;
    for panel in right.chunks_exact_mut(size) {
        for index in 0..size / BLOCK {
            let known = 0..index.min(inverses.len());
            substitute::<FUSED, ROWS>(lower, size, index, known, inverses.get(index), panel);
        }
    }
}

#[inline(always)]
fn backward<const FUSED: bool, const ROWS: usize>(upper: &[Lane], size: usize, inverses: &[Lane], right: &mut [Lane]) {
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
    pivot: &Lane,
    below: &mut [Lane],
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
fn rows_times<const FUSED: bool, const ROWS: usize>(factors: &[f64], rows: &[Lane], sums: &mut Lane) {
    // Four sums at a time, since one waits for itself.
    let mut parts = [*sums, Lane::ZERO, Lane::ZERO, Lane::ZERO];
    for (factors, rows) in factors.as_chunks::<4>().0.iter().zip(rows.as_chunks::<4>().0) {
        for part in 0..4 {
            multiply_add::<FUSED>(&mut parts[part], factors[part], &rows[part]);
        }
    }
    let [a, b, c, d] = parts;
    for lane in 0..BLOCK {
        sums.0[lane] = (a.0[lane] + b.0[lane]) + (c.0[lane] + d.0[lane]);
    }
}

#[inline(always)]
fn rows_less<const FUSED: bool, const ROWS: usize>(factors: &[f64], by: &Lane, rows: &mut [Lane], squares: &mut Lane) {
    let mut parts = [Lane::ZERO; 2];
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
    use super::super::factors::Factors;
    use super::super::panels::Panels;
    use super::{Instructions, Processor};

    /// All that this machine can be.
    fn processors() -> Vec<Processor> {
        match Processor::detect().0 {
            Instructions::Any => vec![Instructions::Any],
            Instructions::Avx2 => vec![Instructions::Any, Instructions::Avx2],
            Instructions::Avx512 => vec![Instructions::Any, Instructions::Avx2, Instructions::Avx512],
        }
        .into_iter()
        .map(Processor)
        .collect()
    }

    fn entry(seed: usize) -> impl Fn(usize, usize) -> f64 {
        move |row, column| (((row * 31 + column * 17 + seed * 7) % 23) as f64 - 11.0) / 8.0
    }

    fn matrix(rows: usize, columns: usize, seed: usize) -> Panels {
        let mut matrix = Panels::default();
        matrix.fill(rows, columns, entry(seed));
        matrix
    }

    /// Small integers over a power of two: sums and products of theirs are exact.
    #[test]
    fn products_are_those_of_the_textbook_with_all_instructions() {
        for processor in processors() {
            for (rows, inner, columns) in [(1, 1, 1), (3, 8, 9), (8, 5, 16), (17, 30, 9), (54, 21, 54), (4, 0, 3)] {
                let (left, right) = (entry(1), entry(2));
                let expected = |row, column| (0..inner).map(|k| left(row, k) * right(k, column)).sum::<f64>();
                let (mut out, mut transpose) = (matrix(2, 30, 3), Panels::default());
                out.product(processor, &matrix(rows, inner, 1), &matrix(inner, columns, 2));
                let mut with_transpose = matrix(2, 30, 3);
                transpose.transpose_from(&matrix(rows, inner, 1));
                with_transpose.transposed_product(processor, &transpose, &matrix(inner, columns, 2));
                for row in 0..rows {
                    for column in 0..columns {
                        assert_eq!(out.get(row, column), expected(row, column), "{processor:?}");
                        assert_eq!(with_transpose.get(row, column), expected(row, column), "{processor:?}");
                    }
                }
                // Nothing is written beyond the matrix.
                assert_eq!(out.norm(), with_transpose.norm());
                out.subtract_product(processor, &matrix(rows, inner, 1), &matrix(inner, columns, 2));
                assert_eq!(out.norm(), 0.0);
            }
        }
    }

    #[test]
    fn a_system_is_solved_with_all_instructions() {
        for processor in processors() {
            for size in [1, 7, 8, 9, 23, 54] {
                let mut factors = Factors::default();
                // What is large is on the other diagonal, so rows have to be exchanged.
                factors.matrix().fill(size, size, |row, column| {
                    entry(4)(row, column) + if row + column + 1 == size { 40.0 } else { 0.0 }
                });
                let (kept, right) = (factors.matrix().clone(), matrix(size, 11, 5));
                let mut solution = right.clone();
                assert!(factors.factorise(processor), "{size}");
                factors.solve(processor, &mut solution);
                let mut back = Panels::default();
                back.product(processor, &kept, &solution);
                back.subtract(&right);
                assert!(back.norm() < 1e-12 * right.norm(), "{processor:?}, {size}: {:e}", back.norm());
            }
        }
    }
}
