//! Nonlinear least squares with bounds, on any manifold: the Levenberg–Marquardt method.
//!
//! A [`Problem`] has a cost, usually `½ Σ r²` with residuals r, and a quadratic model of it about
//! the present point, usually with `H = JᵀJ` and `g = Jᵀr` (Gauss–Newton). [`LeastSquares`] reduces
//! the cost by steps d that minimise
//!
//! ```text
//! ½ dᵀ (H + λ diag H) d + gᵀd,    lower ≤ d ≤ upper
//! ```
//!
//! with a damping λ that grows until the cost decreases. The problem applies a step to its point,
//! so points may be poses or whole trajectories. [`Function`] is the problem of a vector function.
//!
//! The damped steps are those of D. W. Marquardt, *An algorithm for least-squares estimation of
//! nonlinear parameters*, SIAM J. Appl. Math. 11, 1963; λ changes as in H. B. Nielsen, *Damping
//! parameter in Marquardt's method*, IMM-REP-1999-05; bounds are those of [`BoxQp`]. The crate
//! `levenberg-marquardt` has neither bounds nor manifolds, and needs the Jacobian of all residuals
//! at once instead of H and g, which is what a log of a robot makes large.

mod function;

pub use self::function::{Function, ResidualFunction};
use crate::error::{Error, Result};
use crate::math::{BoxQp, BoxQpStatus};
use crate::matrix::Matrix;

/// Damping of the first step, and the least.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-12;
/// Damping at which the method gives up: steps no longer change the point.
const LARGEST_DAMPING: f64 = 1e16;
/// Least diagonal entry for the damping, relative to the largest one. It keeps the system definite
/// if the cost does not depend on a coordinate.
const LEAST_DIAGONAL: f64 = 1e-14;

/// Cost with a quadratic model about a present point.
pub trait Problem {
    /// Returns the number of coordinates of a step.
    fn len(&self) -> usize;

    /// Returns `true` if a step has no coordinates.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the bounds of a step from the present point. They are infinite before the call.
    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        let _ = (lower, upper);
    }

    /// Computes the cost at the present point, and a model of it for [`damped`](Self::damped).
    ///
    /// # Errors
    ///
    /// Any error of the problem. It ends the search.
    fn linearise(&mut self) -> Result<f64>;

    /// Writes the matrix `H + λ diag H` `(n, n)` and the gradient g `(n)` of the model. A problem
    /// may have more variables that it eliminates, with the same damping. Returns the reduction of
    /// the cost by those for a step of zero (0 if there are none), or `None` if they have no
    /// minimum.
    fn damped(&mut self, damping: f64, hessian: &mut Matrix, gradient: &mut [f64]) -> Option<f64>;

    /// Returns the cost after a step from the present point, which stays. The step is computed from
    /// the last [`damped`](Self::damped) model. A cost that is not finite rejects the step.
    ///
    /// # Errors
    ///
    /// Any error of the problem. It ends the search.
    fn evaluate(&mut self, step: &[f64]) -> Result<f64>;

    /// Moves the present point to that of the last [`evaluate`](Self::evaluate).
    fn accept(&mut self);
}

/// Adds a damping to the diagonal of H: `H + λ diag H`, with a least value that keeps the matrix
/// definite if the cost does not depend on a coordinate.
pub fn damp(damping: f64, hessian: &mut Matrix) {
    let n = hessian.nrows();
    let largest = (0..n).map(|i| hessian[(i, i)]).fold(0.0, f64::max);
    for i in 0..n {
        hessian[(i, i)] += damping * hessian[(i, i)].max(LEAST_DIAGONAL * largest);
    }
}

/// Options of [`LeastSquares`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LeastSquaresOptions {
    /// Greatest number of linearisations. 100 by default.
    pub iterations: usize,
    /// The search has converged when the model promises to reduce the cost by less than this part
    /// of it. `1e-10` by default.
    pub tolerance: f64,
    /// The search has converged when the cost is below. `1e-20` by default.
    pub least_cost: f64,
}

impl Default for LeastSquaresOptions {
    fn default() -> Self {
        Self { iterations: 100, tolerance: 1e-10, least_cost: 1e-20 }
    }
}

/// Reason for which a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LeastSquaresStatus {
    /// The cost is at a minimum, up to the tolerance.
    Converged,
    /// The number of iterations is reached.
    IterationLimit,
    /// No step reduces the cost, although the model promises it: a minimum up to the accuracy of
    /// the derivatives, or wrong derivatives, or a cost with jumps.
    Stalled,
    /// The cost at the present point is not finite.
    NotFinite,
}

/// Result of [`LeastSquares::minimise`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastSquaresOutcome {
    /// Reason of the end.
    pub status: LeastSquaresStatus,
    /// Number of linearisations.
    pub iterations: usize,
    /// Cost at the first point.
    pub first_cost: f64,
    /// Cost at the last point.
    pub cost: f64,
}

/// Levenberg–Marquardt method with bounds, with a workspace for steps of one length.
///
/// A search allocates nothing, apart from what the problem does.
///
/// ```
/// use mujoco_safe::least_squares::{Function, LeastSquares, LeastSquaresOptions, LeastSquaresStatus};
///
/// // Decay y = a exp(−b t) through three points.
/// let points = [(0.0, 2.0), (1.0, 2.0 * (-0.5_f64).exp()), (2.0, 2.0 * (-1.0_f64).exp())];
/// let mut x = [1.0, 0.0];
/// let mut problem = Function::new(&mut x, 3, |x: &[f64], r: &mut [f64]| {
///     for (r, (t, y)) in r.iter_mut().zip(points) {
///         *r = x[0] * (-x[1] * t).exp() - y;
///     }
///     Ok(())
/// })?;
/// let outcome = LeastSquares::new(2, LeastSquaresOptions::default())?.minimise(&mut problem)?;
/// assert_eq!(outcome.status, LeastSquaresStatus::Converged);
/// assert!((x[0] - 2.0).abs() < 1e-7 && (x[1] - 0.5).abs() < 1e-7);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct LeastSquares {
    options: LeastSquaresOptions,
    hessian: Matrix,
    gradient: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    step: Vec<f64>,
    qp: BoxQp,
}

impl LeastSquares {
    /// Creates a workspace for steps of `n` coordinates.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the tolerances are finite and not negative.
    ///
    /// # Panics
    ///
    /// If the number of values of an `(n, n)` matrix overflows `usize`.
    pub fn new(n: usize, options: LeastSquaresOptions) -> Result<Self> {
        for (what, value) in [("tolerance", options.tolerance), ("least_cost", options.least_cost)] {
            Error::check_not_negative(format_args!("{what} of LeastSquaresOptions"), value)?;
        }
        let qp = BoxQp::new(n);
        let vector = || vec![0.0; n];
        Ok(Self {
            options,
            hessian: Matrix::zeros(n, n),
            gradient: vector(),
            lower: vector(),
            upper: vector(),
            step: vector(),
            qp,
        })
    }

    /// Moves the point of a problem to a minimum of its cost.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the problem has another number of coordinates, [`Error::Invalid`] if a
    /// lower bound exceeds the upper one, and the errors of the problem.
    pub fn minimise(&mut self, problem: &mut impl Problem) -> Result<LeastSquaresOutcome> {
        Error::check_length("the coordinates of a least squares problem", problem.len(), self.gradient.len())?;
        let mut damping = Damping::default();
        let mut first_cost = f64::NAN;
        let mut iterations = 0;
        loop {
            let present = problem.linearise()?;
            if iterations == 0 {
                first_cost = present;
            }
            iterations += 1;
            let end = |status| Ok(LeastSquaresOutcome { status, iterations, first_cost, cost: present });
            if !present.is_finite() {
                return end(LeastSquaresStatus::NotFinite);
            }
            if present <= self.options.least_cost {
                return end(LeastSquaresStatus::Converged);
            }
            if iterations > self.options.iterations {
                return end(LeastSquaresStatus::IterationLimit);
            }
            // After a rejected step, more damping makes the model promise less.
            let mut is_first = true;
            loop {
                if let Some(promised) = self.damped_step(problem, damping.value)? {
                    if is_first && promised <= self.options.tolerance * present {
                        return end(LeastSquaresStatus::Converged);
                    }
                    is_first = false;
                    let cost = problem.evaluate(&self.step)?;
                    if cost < present {
                        problem.accept();
                        damping.succeed((present - cost) / promised);
                        break;
                    }
                }
                damping.fail();
                if damping.value > LARGEST_DAMPING {
                    return end(LeastSquaresStatus::Stalled);
                }
            }
        }
    }

    /// Computes a damped step. Returns the reduction of the cost that the damped model promises, or
    /// `None` if it has no minimum.
    fn damped_step(&mut self, problem: &mut impl Problem, damping: f64) -> Result<Option<f64>> {
        let Self { hessian, gradient, lower, upper, step, qp, .. } = self;
        hessian.as_mut_slice().fill(0.0);
        gradient.fill(0.0);
        lower.fill(f64::NEG_INFINITY);
        upper.fill(f64::INFINITY);
        step.fill(0.0);
        let Some(eliminated) = problem.damped(damping, hessian, gradient) else { return Ok(None) };
        if !hessian.as_slice().iter().chain(&*gradient).all(|value| value.is_finite()) {
            return Ok(None);
        }
        if gradient.iter().all(|&slope| slope == 0.0) {
            return Ok(Some(eliminated));
        }
        problem.bounds(lower, upper);
        let solution = qp.solve(step, &*hessian, gradient, Some(lower), Some(upper))?;
        if solution.status == BoxQpStatus::NotPositiveDefinite || step.iter().any(|value| !value.is_finite()) {
            return Ok(None);
        }
        let mut promised = eliminated;
        for (row, (value, slope)) in hessian.rows().zip(step.iter().zip(&*gradient)) {
            let product: f64 = row.iter().zip(&*step).map(|(entry, other)| entry * other).sum();
            promised -= value * (slope + 0.5 * product);
        }
        Ok(Some(promised))
    }
}

/// Damping λ and the factor of its next increase.
struct Damping {
    value: f64,
    growth: f64,
}

impl Default for Damping {
    fn default() -> Self {
        Self { value: FIRST_DAMPING, growth: 2.0 }
    }
}

impl Damping {
    /// Changes the damping after a step, given the reduction of the cost relative to the promised
    /// one.
    fn succeed(&mut self, ratio: f64) {
        let factor = (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(0.1, 2.0);
        self.value = (self.value * factor).max(LEAST_DAMPING);
        self.growth = 2.0;
    }

    fn fail(&mut self) {
        self.value *= self.growth;
        self.growth *= 2.0;
    }
}
