//! Constraints that hold with equality, and the matrices with which the minimum on them is found.
//!
//! With `H = L Lᵀ` and the normals `N = (a₁ … a_q)` of the working set, the rows of an orthogonal
//! transformation of `L⁻¹` are stored: `Jᵀ = Qᵀ L⁻¹` with `Jᵀ N = (R; 0)` and a triangle R. The
//! first q rows span the space of the working set, the others the directions in which x can move
//! without leaving it.

#![allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]

use super::QpProblem;
use crate::matrix::MatrixView;
use crate::numerics::linear_algebra::add;
use crate::numerics::vectorised;

/// A normal whose part outside of the space of the working set is below this fraction of its length
/// depends on the working set.
const DEPENDENT: f64 = 1e-8;

/// Limit of a constraint that holds with equality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

impl Side {
    /// Returns the factor that turns the limit into `factor · a x ≥ factor · limit`.
    pub(super) fn sign(self) -> f64 {
        if self == Self::Lower { 1.0 } else { -1.0 }
    }
}

/// Limit of an unknown, or of a row of C, which has the index n and above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Constraint {
    pub(super) index: usize,
    pub(super) side: Side,
}

impl Constraint {
    /// Returns the limit, multiplied by the sign.
    pub(super) fn limit(self, problem: &QpProblem<'_>) -> f64 {
        self.side.sign() * problem.limits(self.index)[self.side as usize]
    }

    /// Returns `true` for an equation, whose multiplier may have any sign.
    fn is_equation(self, problem: &QpProblem<'_>) -> bool {
        let [lower, upper] = problem.limits(self.index);
        lower == upper
    }
}

#[derive(Clone, Debug)]
pub(super) struct WorkingSet {
    n: usize,
    /// `(n, n)`: upper triangle of H, destroyed by its elimination.
    h: Vec<f64>,
    /// `(n, n)`: `Jᵀ`
    rows: Vec<f64>,
    /// `(n, n)`: R in the upper triangle.
    triangle: Vec<f64>,
    constraints: Vec<Constraint>,
    /// Constraints that are equations.
    equations: Vec<bool>,
    multipliers: Vec<f64>,
    /// `(n)`: `Jᵀ a` of a normal.
    coordinates: Vec<f64>,
    /// `(n)`: change of x by a unit step along a normal, within the working set.
    pub(super) step: Vec<f64>,
    /// `(n)`: decrease of the multipliers by the same step.
    slopes: Vec<f64>,
}

impl WorkingSet {
    pub(super) fn new(n: usize) -> Self {
        let entries = n.checked_mul(n).unwrap_or_else(|| panic!("a matrix of {n} rows and columns is too large"));
        Self {
            n,
            h: vec![0.0; entries],
            rows: vec![0.0; entries],
            triangle: vec![0.0; entries],
            constraints: Vec::with_capacity(n),
            equations: Vec::with_capacity(n),
            multipliers: Vec::with_capacity(n + 1),
            coordinates: vec![0.0; n],
            step: vec![0.0; n],
            slopes: vec![0.0; n],
        }
    }

    pub(super) fn constraints(&self) -> &[Constraint] {
        &self.constraints
    }

    pub(super) fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    pub(super) fn contains(&self, index: usize) -> bool {
        self.constraints.iter().any(|constraint| constraint.index == index)
    }

    /// Empties the working set, and computes `L⁻¹`. Returns `false` if H is not positive definite.
    pub(super) fn start(&mut self, h: MatrixView<'_>) -> bool {
        self.constraints.clear();
        self.equations.clear();
        self.multipliers.clear();
        self.h.copy_from_slice(h.as_slice());
        self.slopes.iter_mut().enumerate().for_each(|(row, value)| *value = self.h[row * self.n + row]);
        let mut definite = true;
        invert_factor(&mut self.h, &mut self.rows, &self.slopes, &mut definite);
        definite
    }

    /// Prepares a step along the normal of a constraint: its coordinates, and the changes of x and
    /// of the multipliers. Returns the slope of `a x`, or `None` if the normal depends on the
    /// working set.
    pub(super) fn prepare(&mut self, constraint: Constraint, problem: &QpProblem<'_>) -> Option<f64> {
        let (n, count) = (self.n, self.constraints.len());
        let sign = constraint.side.sign();
        if constraint.index < n {
            for (coordinate, row) in self.coordinates.iter_mut().zip(self.rows.chunks_exact(n)) {
                *coordinate = sign * row[constraint.index];
            }
        } else {
            dots(&mut self.coordinates, &self.rows, problem.row(constraint.index), sign);
        }
        let (fixed, free) = self.coordinates.split_at(count);
        let slope: f64 = free.iter().map(|value| value * value).sum();
        let all: f64 = slope + fixed.iter().map(|value| value * value).sum::<f64>();
        for row in (0..count).rev() {
            let known: f64 = (row + 1..count).map(|column| self.triangle[row * n + column] * self.slopes[column]).sum();
            self.slopes[row] = (fixed[row] - known) / self.triangle[row * n + row];
        }
        if slope <= DEPENDENT * DEPENDENT * all || slope == 0.0 {
            self.step.fill(0.0);
            return None;
        }
        self.step.fill(0.0);
        combine(&mut self.step, &self.rows[count * n..], free);
        Some(slope)
    }

    /// Returns the longest step that keeps the signs of the multipliers, and the place of the
    /// constraint whose multiplier becomes zero.
    pub(super) fn longest_step(&self) -> (f64, Option<usize>) {
        let mut longest = (f64::INFINITY, None);
        for (place, (multiplier, slope)) in self.multipliers.iter().zip(&self.slopes).enumerate() {
            if !self.equations[place] && *slope > 0.0 {
                let length = multiplier.max(0.0) / slope;
                if length < longest.0 {
                    longest = (length, Some(place));
                }
            }
        }
        longest
    }

    /// Changes the multipliers by a step.
    pub(super) fn advance(&mut self, length: f64) {
        self.multipliers.iter_mut().zip(&self.slopes).for_each(|(multiplier, slope)| *multiplier -= length * slope);
    }

    /// Adds the constraint of the last [`prepare`](Self::prepare), which did not depend on the
    /// others.
    pub(super) fn push(&mut self, constraint: Constraint, problem: &QpProblem<'_>, multiplier: f64) {
        let (n, count) = (self.n, self.constraints.len());
        let norm = self.coordinates[count..].iter().map(|value| value * value).sum::<f64>().sqrt();
        let first = self.coordinates[count];
        let diagonal = if first > 0.0 { -norm } else { norm };
        self.coordinates[count] = first - diagonal;
        // `reflected` becomes the sum of the rows times the vector of the reflection. It is the
        // step of `prepare`, except for the first row.
        let factor = 1.0 / (norm * (norm + first.abs()));
        let rows = &mut self.rows[count * n..];
        add(&mut self.step, &rows[..n], -diagonal);
        reflect(rows, &self.step, &self.coordinates[count..], factor);
        for row in 0..count {
            self.triangle[row * n + count] = self.coordinates[row];
        }
        self.triangle[count * n + count] = diagonal;
        self.constraints.push(constraint);
        self.equations.push(constraint.is_equation(problem));
        self.multipliers.push(multiplier);
    }

    /// Drops the constraint at a place.
    pub(super) fn remove(&mut self, place: usize) {
        let (n, count) = (self.n, self.constraints.len());
        self.constraints.remove(place);
        self.equations.remove(place);
        self.multipliers.remove(place);
        for row in 0..count {
            let values = &mut self.triangle[row * n..row * n + count];
            values.copy_within(place + 1.., place);
        }
        // Each remaining column from the place on has one entry below the diagonal.
        for row in place..count - 1 {
            let (upper, lower) = self.triangle.split_at_mut((row + 1) * n);
            let (upper, lower) = (&mut upper[row * n + row..row * n + count - 1], &mut lower[row..count - 1]);
            let length = upper[0].hypot(lower[0]);
            let (cos, sin) = if length > 0.0 { (upper[0] / length, lower[0] / length) } else { (1.0, 0.0) };
            rotate(upper, lower, cos, sin);
            let (upper, lower) = self.rows.split_at_mut((row + 1) * n);
            rotate(&mut upper[row * n..], &mut lower[..n], cos, sin);
        }
    }

    /// Writes the minimum on the working set to `x`, and the multipliers there. Returns the place
    /// of the inequality with the most negative multiplier.
    pub(super) fn minimise(&mut self, x: &mut [f64], problem: &QpProblem<'_>) -> Option<usize> {
        let (n, count) = (self.n, self.constraints.len());
        dots(&mut self.coordinates, &self.rows, problem.g, -1.0);
        for row in 0..count {
            let known: f64 = (0..row).map(|column| self.triangle[column * n + row] * self.slopes[column]).sum();
            let limit = self.constraints[row].limit(problem);
            self.slopes[row] = (limit - known) / self.triangle[row * n + row];
        }
        for row in (0..count).rev() {
            let known: f64 =
                (row + 1..count).map(|column| self.triangle[row * n + column] * self.multipliers[column]).sum();
            let value = self.slopes[row] - self.coordinates[row];
            self.multipliers[row] = (value - known) / self.triangle[row * n + row];
        }
        self.coordinates[..count].copy_from_slice(&self.slopes[..count]);
        x.fill(0.0);
        combine(x, &self.rows, &self.coordinates);
        let places = (0..count).filter(|&place| !self.equations[place] && self.multipliers[place] < 0.0);
        places.min_by(|&a, &b| self.multipliers[a].total_cmp(&self.multipliers[b]))
    }
}

vectorised! {
/// Computes `L⁻¹` by the elimination of a symmetric matrix with the given diagonal, of which the
/// upper triangle is used. A pivot of the size of rounding errors counts as zero.
fn invert_factor(h: &mut [f64], inverse: &mut [f64], diagonals: &[f64], definite: &mut bool) {
    let n = diagonals.len();
    inverse.fill(0.0);
    (0..n).for_each(|row| inverse[row * n + row] = 1.0);
    for pivot in 0..n {
        let diagonal = h[pivot * n + pivot];
        let (above, below) = h.split_at_mut((pivot + 1) * n);
        let source = &above[pivot * n..];
        let (inverse_above, inverse_below) = inverse.split_at_mut((pivot + 1) * n);
        let inverse_source = &mut inverse_above[pivot * n..];
        for row in pivot + 1..n {
            let factor = source[row] / diagonal;
            if factor != 0.0 {
                let start = (row - pivot - 1) * n;
                add(&mut below[start + row..start + n], &source[row..], -factor);
                add(&mut inverse_below[start..=start + pivot], &inverse_source[..=pivot], -factor);
            }
        }
        let scale = 1.0 / diagonal.sqrt();
        inverse_source[..=pivot].iter_mut().for_each(|value| *value *= scale);
        *definite &= diagonal > n as f64 * f64::EPSILON * diagonals[pivot] && scale.is_finite();
    }
}
}

vectorised! {
/// Computes `result = factor · matrix · vector`.
fn dots(result: &mut [f64], matrix: &[f64], vector: &[f64], factor: f64) {
    for (result, row) in result.iter_mut().zip(matrix.chunks_exact(vector.len().max(1))) {
        *result = factor * dot(row, vector);
    }
}
}

vectorised! {
/// Computes `result += matrixᵀ · factors`.
fn combine(result: &mut [f64], matrix: &[f64], factors: &[f64]) {
    for (row, factor) in matrix.chunks_exact(result.len().max(1)).zip(factors) {
        add(result, row, *factor);
    }
}
}

vectorised! {
/// Subtracts `factor · vector[i] · direction` from row i.
fn reflect(rows: &mut [f64], direction: &[f64], vector: &[f64], factor: f64) {
    for (row, value) in rows.chunks_exact_mut(direction.len().max(1)).zip(vector) {
        add(row, direction, -factor * value);
    }
}
}

vectorised! {
/// Rotates two rows.
fn rotate(upper: &mut [f64], lower: &mut [f64], cos: f64, sin: f64) {
    for (upper, lower) in upper.iter_mut().zip(lower) {
        (*upper, *lower) = (cos * *upper + sin * *lower, cos * *lower - sin * *upper);
    }
}
}

/// Returns the dot product, with eight sums that the compiler keeps in vector registers.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let ((a_blocks, a_rest), (b_blocks, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    let halves: [f64; 4] = std::array::from_fn(|lane| sums[lane] + sums[lane + 4]);
    (halves[0] + halves[2]) + (halves[1] + halves[3]) + rest
}
