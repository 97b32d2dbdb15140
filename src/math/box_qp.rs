//! Box-constrained quadratic programs: `½ xᵀH x + gᵀx → min`, `lower ≤ x ≤ upper`.
//!
//! The method is the projected Newton iteration of Y. Tassa, N. Mansard, E. Todorov,
//! "Control-limited differential dynamic programming", ICRA 2014, section III. Coordinates on a
//! bound whose gradient points outwards are clamped. The free coordinates take a Newton step that
//! is projected onto the box, with an Armijo line search.

use mujoco_sys::mjMINVAL;

use super::matrix::{check_square, chol_factor, chol_solve_in_place};
use super::vector::dot_of_equals;
use crate::error::{Error, Result};
use crate::matrix::{MatrixView, MatrixViewMut};

const MAX_ITERATIONS: u32 = 100;
/// Relative tolerance of the gradient, with respect to the terms of its sum.
const GRADIENT_TOLERANCE: f64 = 1e-13;
/// Absolute tolerance of the norm of the gradient.
const MIN_GRADIENT: f64 = 1e-8;
/// Armijo constant: required decrease as a fraction of the decrease predicted by the gradient.
const ARMIJO: f64 = 0.1;
/// Reduction factor of the step length in the line search.
const BACKTRACK: f64 = 0.5;
const MIN_STEP: f64 = 1e-22;

/// Termination status of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoxQpStatus {
    /// Converged to the minimum.
    Solved,
    /// The line search found no decrease although the gradient exceeds the tolerance. `x` is the
    /// minimum up to rounding.
    Stalled,
    /// Did not converge within 100 iterations.
    IterationLimit,
    /// The block of H for the free coordinates is not positive definite, so a minimum may not
    /// exist. `x` is the last iterate.
    NotPositiveDefinite,
}

/// Result of the solver besides `x`.
#[derive(Clone, Copy, Debug)]
pub struct BoxQpSolution<'a> {
    /// Termination status.
    pub status: BoxQpStatus,
    /// Number of iterations.
    pub iterations: u32,
    /// The `nfree` free coordinates, which no bound clamps, in increasing order.
    pub index: &'a [usize],
    /// Cholesky factor of the block of H for the free coordinates, `(nfree, nfree)`, in the lower
    /// triangle. Invalid after [`BoxQpStatus::NotPositiveDefinite`].
    pub factor: MatrixView<'a>,
}

/// Solver with a preallocated workspace for problems of one size. Solving does not allocate.
///
/// ```
/// use mujoco_safe::Matrix;
/// use mujoco_safe::math::{BoxQp, BoxQpStatus};
///
/// // The point of the box nearest to (2, 0.5).
/// let mut x = [0.0, 0.0];
/// let mut solver = BoxQp::new(2);
/// let h = Matrix::from_rows(&[[1.0, 0.0], [0.0, 1.0]]);
/// let solution = solver.solve(&mut x, &h, &[-2.0, -0.5], Some(&[-1.0, -1.0]), Some(&[1.0, 1.0]))?;
/// assert_eq!(solution.status, BoxQpStatus::Solved);
/// assert_eq!(solution.index, [1]); // a bound clamps the first coordinate
/// assert_eq!(x, [1.0, 0.5]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BoxQp {
    n: usize,
    factor: Vec<f64>,
    index: Vec<usize>,
    clamped: Vec<bool>,
    gradient: Vec<f64>,
    /// Newton step of all coordinates, and the packed step of the free coordinates.
    step: Vec<f64>,
    free_step: Vec<f64>,
    /// Scaled step projected onto the box.
    projected: Vec<f64>,
}

impl BoxQp {
    /// Creates a solver for problems with `n` unknowns.
    ///
    /// # Panics
    ///
    /// If the number of values of an `(n, n)` matrix overflows `usize`.
    #[doc(alias = "mju_boxQPmalloc")]
    pub fn new(n: usize) -> Self {
        let entries = n.checked_mul(n).unwrap_or_else(|| panic!("a matrix of {n} rows and columns is too large"));
        Self {
            n,
            factor: vec![0.0; entries],
            index: Vec::with_capacity(n),
            clamped: vec![false; n],
            gradient: vec![0.0; n],
            step: vec![0.0; n],
            free_step: vec![0.0; n],
            projected: vec![0.0; n],
        }
    }

    /// Returns the number of unknowns.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Solves for `x`, starting from its present value. The start may be infeasible; a start close
    /// to the solution converges faster. `h` is symmetric with the shape `(n, n)`; all vectors have
    /// the length `n`. `None` or an infinite value means no bound.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Invalid`] if `x` or `g` is not finite, or a
    /// lower bound exceeds the upper bound.
    #[doc(alias = "mju_boxQP")]
    pub fn solve<'a>(
        &mut self,
        x: &mut [f64],
        h: impl Into<MatrixView<'a>>,
        g: &[f64],
        lower: Option<&[f64]>,
        upper: Option<&[f64]>,
    ) -> Result<BoxQpSolution<'_>> {
        let (h, n) = (h.into(), self.n);
        Error::check_length("x of BoxQp::solve", x.len(), n)?;
        check_square("h of BoxQp::solve", h.shape())?;
        Error::check_shape("h of BoxQp::solve", h.shape(), (n, n))?;
        Error::check_length("g of BoxQp::solve", g.len(), n)?;
        for (what, bound) in [("lower of BoxQp::solve", lower), ("upper of BoxQp::solve", upper)] {
            Error::check_length(what, bound.map_or(n, <[f64]>::len), n)?;
        }
        check_finite("x", x)?;
        check_finite("g", g)?;
        let bounds = Bounds { lower, upper };
        bounds.check(n)?;

        x.iter_mut().enumerate().for_each(|(i, x)| *x = bounds.clamp(i, *x));
        let (status, iterations) = self.iterate(x, h, g, bounds)?;
        let nfree = self.index.len();
        let factor = MatrixView::from_row_major(nfree, nfree, &self.factor[..nfree * nfree]);
        Ok(BoxQpSolution { status, iterations, index: &self.index, factor })
    }

    /// Runs the projected Newton iteration.
    fn iterate(
        &mut self,
        x: &mut [f64],
        h: MatrixView<'_>,
        g: &[f64],
        bounds: Bounds<'_>,
    ) -> Result<(BoxQpStatus, u32)> {
        for iteration in 0..MAX_ITERATIONS {
            for (i, row) in h.rows().enumerate() {
                self.gradient[i] = g[i] + dot_of_equals(row, x);
            }
            let unchanged = self.find_free(x, bounds) && iteration > 0;
            if !unchanged && !self.factorise(h)? {
                return Ok((BoxQpStatus::NotPositiveDefinite, iteration));
            }
            if self.is_stationary(x, h, g) {
                return Ok((BoxQpStatus::Solved, iteration));
            }
            self.find_step()?;
            if !self.advance(x, h, bounds) {
                return Ok((BoxQpStatus::Stalled, iteration));
            }
        }
        Ok((BoxQpStatus::IterationLimit, MAX_ITERATIONS))
    }

    /// Advances `x` along the projected step by an Armijo line search. Returns `false` if no step
    /// length decreases the objective.
    fn advance(&mut self, x: &mut [f64], h: MatrixView<'_>, bounds: Bounds<'_>) -> bool {
        let mut length = 1.0;
        while length >= MIN_STEP {
            for (i, projected) in self.projected.iter_mut().enumerate() {
                *projected = bounds.clamp(i, x[i] + length * self.step[i]) - x[i];
            }
            // Change of the objective, computed without the cancellation of a difference of two
            // objectives.
            let slope = dot_of_equals(&self.gradient, &self.projected);
            let curvature: f64 =
                h.rows().zip(&self.projected).map(|(row, step)| step * dot_of_equals(row, &self.projected)).sum();
            let change = slope + 0.5 * curvature;
            if change < 0.0 && change <= ARMIJO * slope {
                x.iter_mut().enumerate().for_each(|(i, x)| *x = bounds.clamp(i, *x + length * self.step[i]));
                return true;
            }
            length *= BACKTRACK;
        }
        false
    }

    /// Finds the free coordinates. Returns `true` if the set has not changed.
    fn find_free(&mut self, x: &[f64], bounds: Bounds<'_>) -> bool {
        let mut unchanged = true;
        self.index.clear();
        for (i, &x) in x.iter().enumerate() {
            let descent = -self.gradient[i];
            let clamped = (x <= bounds.lower(i) && descent < 0.0) || (x >= bounds.upper(i) && descent > 0.0);
            unchanged &= clamped == self.clamped[i];
            self.clamped[i] = clamped;
            if !clamped {
                self.index.push(i);
            }
        }
        unchanged
    }

    /// Factorises the block of H for the free coordinates. Returns `false` if it is not positive
    /// definite.
    fn factorise(&mut self, h: MatrixView<'_>) -> Result<bool> {
        let nfree = self.index.len();
        let factor = &mut self.factor[..nfree * nfree];
        // `chunks_exact_mut` panics for a chunk size of 0; without free coordinates there are no
        // rows.
        for (&i, target) in self.index.iter().zip(factor.chunks_exact_mut(nfree.max(1))) {
            let row = h.row(i);
            target.iter_mut().zip(&self.index).for_each(|(target, &j)| *target = row[j]);
        }
        let rank = chol_factor(MatrixViewMut::from_row_major(nfree, nfree, factor), mjMINVAL)?;
        // The rank counts a NaN as a sufficient pivot. A NaN propagates to the last pivot.
        Ok(rank == nfree && factor.last().is_none_or(|last| last.is_finite()))
    }

    /// Returns `true` if the gradient of the free coordinates is zero, up to the rounding errors of
    /// its terms.
    fn is_stationary(&self, x: &[f64], h: MatrixView<'_>, g: &[f64]) -> bool {
        let squares: f64 = self.index.iter().map(|&i| self.gradient[i] * self.gradient[i]).sum();
        squares.sqrt() < MIN_GRADIENT
            || self.index.iter().all(|&i| {
                let terms: f64 = h.row(i).iter().zip(x).map(|(h, x)| (h * x).abs()).sum();
                self.gradient[i].abs() <= GRADIENT_TOLERANCE * (g[i].abs() + terms)
            })
    }

    /// Computes the Newton step of the free coordinates; the step of clamped coordinates is zero.
    fn find_step(&mut self) -> Result<()> {
        let nfree = self.index.len();
        let free = &mut self.free_step[..nfree];
        free.iter_mut().zip(&self.index).for_each(|(step, &i)| *step = -self.gradient[i]);
        let factor = MatrixView::from_row_major(nfree, nfree, &self.factor[..nfree * nfree]);
        chol_solve_in_place(factor, free)?;
        self.step.fill(0.0);
        for (&i, &value) in self.index.iter().zip(free.iter()) {
            self.step[i] = value;
        }
        Ok(())
    }
}

/// Bounds of the box.
#[derive(Clone, Copy)]
struct Bounds<'a> {
    lower: Option<&'a [f64]>,
    upper: Option<&'a [f64]>,
}

impl Bounds<'_> {
    #[inline]
    fn lower(&self, i: usize) -> f64 {
        self.lower.map_or(f64::NEG_INFINITY, |lower| lower[i])
    }

    #[inline]
    fn upper(&self, i: usize) -> f64 {
        self.upper.map_or(f64::INFINITY, |upper| upper[i])
    }

    #[inline]
    fn clamp(&self, i: usize, x: f64) -> f64 {
        // `f64::clamp` would panic for unchecked bounds.
        x.max(self.lower(i)).min(self.upper(i))
    }

    fn check(&self, n: usize) -> Result<()> {
        for i in 0..n {
            let (lower, upper) = (self.lower(i), self.upper(i));
            if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
                return Err(Error::out_of_range(
                    format!("the interval {i} of the box"),
                    format!("[{lower}, {upper}]"),
                    "one whose lower bound does not exceed its upper bound",
                ));
            }
        }
        Ok(())
    }
}

fn check_finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Error::not_finite(format!("{what}[{index}] of BoxQp::solve"), values[index])),
    }
}
