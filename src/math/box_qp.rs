//! Quadratic programmes in a box: `½ xᵀH x + gᵀx → min`, `lower ≤ x ≤ upper`.
//!
//! The method is the projected Newton iteration of Y. Tassa, N. Mansard, E. Todorov, "Control-limited differential dynamic
//! programming", ICRA 2014, section III: coordinates that lie on a bound and are pushed against it are held, a Newton step is
//! taken in the others and cut off at the bounds, and its length is found by Armijo's rule.

use mujoco_sys::mjMINVAL;

use super::cholesky::{chol_factor, chol_solve_in_place};
use super::matrix::check_square;
use super::vector::dot_of_equals;
use crate::error::{Error, Result};
use crate::matrix::{MatrixView, MatrixViewMut};

const MOST_ITERATIONS: u32 = 100;
/// The gradient is zero where what is left is this part of the terms that it is the sum of.
const ROUNDING: f64 = 1e-13;
/// Or where its length is below this.
const SHORTEST_GRADIENT: f64 = 1e-8;
/// How much of what the gradient promises a step has to gain.
const ARMIJO: f64 = 0.1;
const BACKTRACK: f64 = 0.5;
const SHORTEST_STEP: f64 = 1e-22;

/// How the search for the minimum has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoxQpStatus {
    /// At the minimum.
    Solved,
    /// No step gains anything any more, though the gradient is not quite zero: at the minimum up to rounding.
    Stalled,
    /// Not at the minimum after 100 iterations.
    IterationLimit,
    /// The part of H for the free coordinates is not positive definite; there may be no minimum. `x` is where that was found.
    NotPositiveDefinite,
}

/// What is known at the minimum besides `x`.
#[derive(Clone, Copy, Debug)]
pub struct BoxQpSolution<'a> {
    /// How the search has ended.
    pub status: BoxQpStatus,
    /// After how many iterations.
    pub iterations: u32,
    /// The coordinates that are held by no bound, in increasing order: `nfree` of them.
    pub index: &'a [usize],
    /// Cholesky's factor of the rows and columns of H that `index` names, `(nfree, nfree)`, in the lower triangle. Of no use
    /// after [`BoxQpStatus::NotPositiveDefinite`].
    pub factor: MatrixView<'a>,
}

/// The solver, with room for problems of one size. Solving allocates nothing.
///
/// ```
/// use mujoco_safe::Matrix;
/// use mujoco_safe::math::{BoxQp, BoxQpStatus};
///
/// // The point of the box that is nearest to (2, 0.5).
/// let mut x = [0.0, 0.0];
/// let mut solver = BoxQp::new(2);
/// let h = Matrix::from_rows(&[[1.0, 0.0], [0.0, 1.0]]);
/// let solution = solver.solve(&mut x, &h, &[-2.0, -0.5], Some(&[-1.0, -1.0]), Some(&[1.0, 1.0]))?;
/// assert_eq!(solution.status, BoxQpStatus::Solved);
/// assert_eq!(solution.index, [1]); // the first is held by its bound
/// assert_eq!(x, [1.0, 0.5]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BoxQp {
    n: usize,
    factor: Vec<f64>,
    index: Vec<usize>,
    held: Vec<bool>,
    gradient: Vec<f64>,
    /// The Newton step: of all coordinates, and of the free ones, one behind another.
    step: Vec<f64>,
    free_step: Vec<f64>,
    /// What is left of the step within the bounds.
    way: Vec<f64>,
}

impl BoxQp {
    /// A solver for problems with `n` unknowns.
    ///
    /// # Panics
    ///
    /// If there is no room for a matrix of that size.
    #[doc(alias = "mju_boxQPmalloc")]
    pub fn new(n: usize) -> Self {
        let entries = n.checked_mul(n).unwrap_or_else(|| panic!("a matrix of {n} rows and columns is too large"));
        Self {
            n,
            factor: vec![0.0; entries],
            index: Vec::with_capacity(n),
            held: vec![false; n],
            gradient: vec![0.0; n],
            step: vec![0.0; n],
            free_step: vec![0.0; n],
            way: vec![0.0; n],
        }
    }

    /// The number of unknowns.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Finds `x` from where it is, which may be anywhere; the nearer to the solution, the quicker. `h` is `(n, n)` and
    /// symmetric, the others have `n` numbers; a bound that is left out, or is infinite, does not bound.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Invalid`] if `x` or `g` are not finite, or a lower bound is not at most the
    /// upper one.
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

    fn iterate(
        &mut self,
        x: &mut [f64],
        h: MatrixView<'_>,
        g: &[f64],
        bounds: Bounds<'_>,
    ) -> Result<(BoxQpStatus, u32)> {
        for iteration in 0..MOST_ITERATIONS {
            for (i, row) in h.rows().enumerate() {
                self.gradient[i] = g[i] + dot_of_equals(row, x);
            }
            let same = self.find_free(x, bounds) && iteration > 0;
            if !same && !self.factorise(h)? {
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
        Ok((BoxQpStatus::IterationLimit, MOST_ITERATIONS))
    }

    /// Goes along the step, bent at the bounds, for a length of Armijo's rule. False if no length gains anything.
    fn advance(&mut self, x: &mut [f64], h: MatrixView<'_>, bounds: Bounds<'_>) -> bool {
        let mut length = 1.0;
        while length >= SHORTEST_STEP {
            for (i, way) in self.way.iter_mut().enumerate() {
                *way = bounds.clamp(i, x[i] + length * self.step[i]) - x[i];
            }
            // The difference of the values, without taking the difference of two values.
            let slope = dot_of_equals(&self.gradient, &self.way);
            let curvature: f64 = h.rows().zip(&self.way).map(|(row, way)| way * dot_of_equals(row, &self.way)).sum();
            let change = slope + 0.5 * curvature;
            if change < 0.0 && change <= ARMIJO * slope {
                x.iter_mut().enumerate().for_each(|(i, x)| *x = bounds.clamp(i, *x + length * self.step[i]));
                return true;
            }
            length *= BACKTRACK;
        }
        false
    }

    /// Notes which coordinates are free, and tells whether they are the same as before.
    fn find_free(&mut self, x: &[f64], bounds: Bounds<'_>) -> bool {
        let mut same = true;
        self.index.clear();
        for (i, &x) in x.iter().enumerate() {
            let push = -self.gradient[i];
            let held = (x <= bounds.lower(i) && push < 0.0) || (x >= bounds.upper(i) && push > 0.0);
            same &= held == self.held[i];
            self.held[i] = held;
            if !held {
                self.index.push(i);
            }
        }
        same
    }

    /// Factorises the free part of H; false if it is not positive definite.
    fn factorise(&mut self, h: MatrixView<'_>) -> Result<bool> {
        let nfree = self.index.len();
        let factor = &mut self.factor[..nfree * nfree];
        // In rows of no length there is nothing to copy.
        for (&i, target) in self.index.iter().zip(factor.chunks_exact_mut(nfree.max(1))) {
            let row = h.row(i);
            target.iter_mut().zip(&self.index).for_each(|(target, &j)| *target = row[j]);
        }
        let rank = chol_factor(MatrixViewMut::from_row_major(nfree, nfree, factor), mjMINVAL)?;
        // A NaN passes for a pivot that is large enough, and then is in the last one too.
        Ok(rank == nfree && factor.last().is_none_or(|last| last.is_finite()))
    }

    /// Whether the gradient of the free coordinates is zero, up to the rounding of the terms that it is the sum of.
    fn is_stationary(&self, x: &[f64], h: MatrixView<'_>, g: &[f64]) -> bool {
        let squares: f64 = self.index.iter().map(|&i| self.gradient[i] * self.gradient[i]).sum();
        squares.sqrt() < SHORTEST_GRADIENT
            || self.index.iter().all(|&i| {
                let terms: f64 = h.row(i).iter().zip(x).map(|(h, x)| (h * x).abs()).sum();
                self.gradient[i].abs() <= ROUNDING * (g[i].abs() + terms)
            })
    }

    /// The Newton step of the free coordinates, and zeros for the others.
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

/// The box.
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
        // Not `f64::clamp`, which would panic for bounds that were not checked.
        x.max(self.lower(i)).min(self.upper(i))
    }

    fn check(&self, n: usize) -> Result<()> {
        for i in 0..n {
            let (lower, upper) = (self.lower(i), self.upper(i));
            if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
                return Err(Error::invalid(
                    format!("the interval {i} of the box"),
                    format!("[{lower}, {upper}]"),
                    "of a lower bound that is not above the upper one",
                ));
            }
        }
        Ok(())
    }
}

fn check_finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Error::invalid(format!("{what}[{index}] of BoxQp::solve"), values[index], "finite")),
    }
}
