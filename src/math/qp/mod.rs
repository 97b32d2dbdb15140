//! Dense convex quadratic programs: `½ xᵀH x + gᵀx → min`, `lower ≤ x ≤ upper`,
//! `lower ≤ C x ≤ upper`.
//!
//! The method is the dual active-set method of D. Goldfarb and A. Idnani, "A numerically stable
//! dual method for solving strictly convex quadratic programs", Mathematical Programming 27, 1983.
//! It starts from the minimum of the last working set (of all constraints that held with equality),
//! adds the most violated constraint in each iteration, and drops constraints whose multipliers
//! would change sign. The matrices of the working set are updated by a Householder reflection for
//! an added constraint, and by Givens rotations for a dropped one.
//!
//! The interior-point solver of the crate clarabel 0.11 takes 39 times as long for the problems of
//! the bench `ik` (27 unknowns with bounds, 307 against 7.8 µs, in alternation): it is made for
//! large and sparse problems, does not start from an earlier solution, and allocates. It would add
//! 41 crates.

mod iteration;
mod working_set;

use self::working_set::{Constraint, Side, WorkingSet};
use super::matrix::check_square;
use crate::error::{Error, Result};
use crate::matrix::MatrixView;

/// Problem for [`Qp`]. Without bounds and constraints it is a linear system.
#[derive(Clone, Copy, Debug)]
pub struct QpProblem<'a> {
    h: MatrixView<'a>,
    g: &'a [f64],
    bounds: Option<[&'a [f64]; 2]>,
    constraints: Option<(MatrixView<'a>, [&'a [f64]; 2])>,
}

impl<'a> QpProblem<'a> {
    /// Creates a problem with the symmetric matrix H `(n, n)` and the vector g `(n)`. Only the
    /// upper triangle of H is read.
    pub fn new(h: impl Into<MatrixView<'a>>, g: &'a [f64]) -> Self {
        Self { h: h.into(), g, bounds: None, constraints: None }
    }

    /// Adds the bounds `lower ≤ x ≤ upper`, each `(n)`. An infinite value means no bound; equal
    /// values fix an unknown.
    #[must_use]
    pub fn with_bounds(mut self, lower: &'a [f64], upper: &'a [f64]) -> Self {
        self.bounds = Some([lower, upper]);
        self
    }

    /// Adds the constraints `lower ≤ C x ≤ upper` with C `(m, n)`. An infinite value means no
    /// limit; equal values are an equation.
    #[must_use]
    pub fn with_constraints(mut self, c: impl Into<MatrixView<'a>>, lower: &'a [f64], upper: &'a [f64]) -> Self {
        self.constraints = Some((c.into(), [lower, upper]));
        self
    }

    fn check(&self, n: usize, capacity: usize) -> Result<()> {
        check_square("h of Qp::solve", self.h.shape())?;
        Error::check_shape("h of Qp::solve", self.h.shape(), (n, n))?;
        Error::check_length("g of Qp::solve", self.g.len(), n)?;
        check_finite("g", self.g)?;
        if let Some([lower, upper]) = self.bounds {
            check_intervals("bounds", lower, upper, n)?;
        }
        if let Some((c, [lower, upper])) = self.constraints {
            if c.nrows() > capacity {
                let expected = format!("at most {capacity}, as in Qp::new");
                return Err(Error::out_of_range("the number of constraints of Qp::solve", c.nrows(), expected));
            }
            Error::check_shape("c of Qp::solve", c.shape(), (c.nrows(), n))?;
            check_finite("c", c.as_slice())?;
            check_intervals("constraints", lower, upper, c.nrows())?;
        }
        Ok(())
    }

    /// Returns the number of constraints.
    fn rows(&self) -> usize {
        self.constraints.map_or(0, |(c, _)| c.nrows())
    }

    /// Returns the limits of an unknown, or of a row of C after the unknowns.
    fn limits(&self, index: usize) -> [f64; 2] {
        let n = self.g.len();
        let limits = if index < n { self.bounds } else { self.constraints.map(|(_, limits)| limits) };
        let offset = if index < n { index } else { index - n };
        limits.map_or([f64::NEG_INFINITY, f64::INFINITY], |[lower, upper]| [lower[offset], upper[offset]])
    }

    /// Returns a row of C, by its index after the unknowns.
    fn row(&self, index: usize) -> &'a [f64] {
        let (c, _) = self.constraints.expect("Bug: a row of a problem without constraints");
        c.row(index - self.g.len())
    }
}

fn check_finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Error::not_finite(format!("{what}[{index}] of Qp::solve"), values[index])),
    }
}

fn check_intervals(what: &'static str, lower: &[f64], upper: &[f64], count: usize) -> Result<()> {
    Error::check_length("the lower limits of Qp::solve", lower.len(), count)?;
    Error::check_length("the upper limits of Qp::solve", upper.len(), count)?;
    for (index, (lower, upper)) in lower.iter().zip(upper).enumerate() {
        if !(lower <= upper && *lower < f64::INFINITY && *upper > f64::NEG_INFINITY) {
            return Err(Error::out_of_range(
                format!("interval {index} of the {what}"),
                format!("[{lower}, {upper}]"),
                "one whose lower limit does not exceed its upper limit",
            ));
        }
    }
    Ok(())
}

/// Termination status of [`Qp`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum QpStatus {
    /// Converged to the minimum.
    Solved,
    /// The constraints contradict each other. `x` is the minimum for those before
    /// [`QpSolution::conflict`].
    Infeasible,
    /// Did not converge within `100 + 4 (n + m)` iterations.
    IterationLimit,
    /// H is not positive definite, or has an entry that is not finite. `x` is zero.
    NotPositiveDefinite,
    /// A number has exceeded the range of `f64`. `x` is zero.
    Overflow,
}

/// Result of [`Qp::solve`] besides `x`.
#[derive(Clone, Copy, Debug)]
pub struct QpSolution<'a> {
    /// Termination status.
    pub status: QpStatus,
    /// Number of constraints that were added or dropped.
    pub iterations: u32,
    /// `(n)`: multipliers of the bounds, positive at an upper bound, negative at a lower bound.
    pub bound_multipliers: &'a [f64],
    /// `(m)`: multipliers of the constraints, with the same signs. The gradient at the minimum is
    /// `H x + g = −bound_multipliers − Cᵀ constraint_multipliers`.
    pub constraint_multipliers: &'a [f64],
    /// With [`QpStatus::Infeasible`], the constraint that contradicts others: an unknown's index
    /// for its bound, `n + i` for row i of C.
    pub conflict: Option<usize>,
}

/// Solver with a preallocated workspace. Solving does not allocate.
///
/// Each solution starts from the constraints that were active in the last one, so a sequence of
/// similar problems takes few iterations. The minimum is unique, and the start changes its last
/// bits at most; [`forget`](Self::forget) makes it independent of the past.
///
/// ```
/// use mujoco_safe::math::{Qp, QpProblem, QpStatus};
///
/// // The point nearest to (2, 1) with x ≤ 1 and x + y = 0.
/// let (h, g) = ([[1.0, 0.0], [0.0, 1.0]], [-2.0, -1.0]);
/// let problem = QpProblem::new(&h, &g)
///     .with_bounds(&[f64::NEG_INFINITY; 2], &[1.0, f64::INFINITY])
///     .with_constraints(&[[1.0, 1.0]], &[0.0], &[0.0]);
/// let mut x = [0.0; 2];
/// let mut solver = Qp::new(2, 1);
/// let solution = solver.solve(&mut x, &problem)?;
/// assert_eq!(solution.status, QpStatus::Solved);
/// assert!((x[0] - 0.5).abs() < 1e-12 && (x[1] + 0.5).abs() < 1e-12);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
#[doc(alias("quadratic program", "quadratic programming", "quadprog", "daqp"))]
pub struct Qp {
    n: usize,
    m: usize,
    working: WorkingSet,
    /// Constraints that were active at the end of the last solution.
    last: Vec<Constraint>,
    /// `(m)`: norms of the rows of C.
    norms: Vec<f64>,
    /// `(n + m)`: constraints that depend on the working set and hold within a loose tolerance.
    ignored: Vec<bool>,
    /// `(n + m)`
    multipliers: Vec<f64>,
}

impl Qp {
    /// Creates a solver for problems with `n` unknowns and at most `m` constraints besides bounds.
    ///
    /// # Panics
    ///
    /// If the number of values of an `(n, n)` matrix overflows `usize`.
    pub fn new(n: usize, m: usize) -> Self {
        Self {
            n,
            m,
            working: WorkingSet::new(n),
            last: Vec::with_capacity(n),
            norms: vec![0.0; m],
            ignored: vec![false; n + m],
            multipliers: vec![0.0; n + m],
        }
    }

    /// Returns the number of unknowns.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Forgets the active constraints of the last solution.
    pub fn forget(&mut self) {
        self.last.clear();
    }

    /// Solves a problem, and writes the minimum to `x`. Bounds hold exactly, constraints up to
    /// rounding.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Invalid`] if g or C is not finite, a lower
    /// limit exceeds the upper limit, or there are more constraints than the solver has space for.
    pub fn solve(&mut self, x: &mut [f64], problem: &QpProblem<'_>) -> Result<QpSolution<'_>> {
        Error::check_length("x of Qp::solve", x.len(), self.n)?;
        problem.check(self.n, self.m)?;
        self.multipliers.fill(0.0);
        x.fill(0.0);
        let (mut status, iterations, conflict) = self.iterate(x, problem);
        if !x.iter().all(|value| value.is_finite()) {
            status = QpStatus::Overflow;
        }
        if matches!(status, QpStatus::Overflow | QpStatus::NotPositiveDefinite) {
            x.fill(0.0);
        } else {
            self.finish(x, problem);
        }
        let (bound_multipliers, rest) = self.multipliers.split_at(self.n);
        let constraint_multipliers = &rest[..problem.rows()];
        Ok(QpSolution { status, iterations, bound_multipliers, constraint_multipliers, conflict })
    }

    /// Stores the working set and the multipliers, and removes the rounding errors at bounds.
    fn finish(&mut self, x: &mut [f64], problem: &QpProblem<'_>) {
        self.last.clear();
        self.last.extend_from_slice(self.working.constraints());
        for (constraint, multiplier) in self.working.constraints().iter().zip(self.working.multipliers()) {
            self.multipliers[constraint.index] = -constraint.side.sign() * multiplier;
        }
        if problem.bounds.is_some() {
            for (index, value) in x.iter_mut().enumerate() {
                let [lower, upper] = problem.limits(index);
                // Not `clamp`, which panics for bounds that are NaN.
                *value = value.max(lower).min(upper);
            }
        }
    }
}
