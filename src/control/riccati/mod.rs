//! Solver for the discrete algebraic Riccati equation, by doubling.
//!
//! For a system `x⁺ = A x + B u` and the cost `Σ xᵀQx + uᵀRu + 2 xᵀSu`, the cost to go from `x`
//! under the optimal control is `xᵀPx`, where `P` is the stabilising solution of
//!
//! ```text
//! P = AᵀPA − (AᵀPB + S)(R + BᵀPB)⁻¹(BᵀPA + Sᵀ) + Q
//! ```
//!
//! and the optimal control is `u = −K x` with `K = (R + BᵀPB)⁻¹(BᵀPA + Sᵀ)`. Stabilising means that
//! every eigenvalue of `A − BK` lies inside the unit circle. [`Riccati`] holds the equation, and
//! [`Riccati::solve`] solves it or returns the reason why it has no solution.
//!
//! Over a finite number of steps, or if the system varies from step to step, use
//! [`RiccatiRecursion`] instead.
//!
//! # Algorithm
//!
//! The solver first eliminates the cross term: `A₀ = A − BR⁻¹Sᵀ`, `G₀ = BR⁻¹Bᵀ`, `H₀ = Q − SR⁻¹Sᵀ`.
//! It then balances these matrices by choosing units of the states, which makes the humanoid's
//! solution more accurate by two digits. A step of the structure-preserving doubling algorithm,
//!
//! ```text
//! A⁺ = A (I + GH)⁻¹ A
//! G⁺ = G + A (I + GH)⁻¹ G Aᵀ
//! H⁺ = H + AᵀH (I + GH)⁻¹ A
//! ```
//!
//! doubles the number of steps of the Riccati recursion that have been taken, so `H` converges to
//! `P` quadratically: after `k` doublings the error is proportional to `ρ` to the power `2ᵏ⁺¹`,
//! where `ρ` is the spectral radius of `A − BK`. Even a humanoid whose position on the floor has a
//! tiny weight, `1 − ρ ≈ 10⁻⁹`, needs only about forty. Most of these are nearly free, because by
//! then the rank of `A` is small and the iteration continues in that dimension; `doubling.rs` has
//! the derivation. If the residual exceeds the rounding error, Newton steps follow (Hewer 1971).
//!
//! # Sources
//!
//! * B. D. O. Anderson, *Second-order convergent algorithms for the steady-state Riccati equation*,
//!   International Journal of Control 28 (1978) 295–306.
//! * E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, *Structure-preserving algorithms for periodic
//!   discrete-time algebraic Riccati equations*, International Journal of Control 77 (2004)
//!   767–788.
//! * G. A. Hewer, *An iterative technique for the computation of the steady state gains for the
//!   discrete optimal regulator*, IEEE Transactions on Automatic Control 16 (1971) 382–384.
#![allow(clippy::many_single_char_names, reason = "A, B, Q, R, S, P, K, G and H are the symbols of the field")]

mod balancing;
mod bellman;
mod diagnosis;
mod doubling;
mod error;
mod problem;
mod recursion;

pub(in crate::control) use bellman::{BellmanBackup, StepCost};
pub use error::{RiccatiError, RiccatiMatrix};
pub use recursion::RiccatiRecursion;

use crate::matrix::{Matrix, StridedView};
use crate::numerics::dense::PackedMatrix;
use problem::Problem;

/// Default of [`Riccati::with_residual_tolerance`].
const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Largest difference between mirrored entries of `Q` or of `R`, relative to the largest entry,
/// that counts as rounding.
const SYMMETRY_TOLERANCE: f64 = 1e-8;

/// Discrete algebraic Riccati equation.
///
/// With `n` states and `m` controls, `A` is `(n, n)`, `B` is `(n, m)`, `Q` is `(n, n)`, `R` is
/// `(m, m)` and `S`, zero unless [`with_cross_term`](Self::with_cross_term) sets it, is `(n, m)`.
/// `R` must be positive semidefinite, and the total cost of a step should be. The solver uses the
/// symmetric parts of `Q` and `R`, which may differ from their transposes by up to 10⁻⁸ of the
/// largest entry because of rounding.
///
/// Accepts matrices of this crate, and matrices and views of nalgebra: see [`StridedView`].
///
/// ```
/// use mujoco_safe::control::riccati::{Riccati, RiccatiError};
/// use mujoco_safe::nalgebra::{Matrix1, Matrix2, Vector2};
///
/// // A mass of 1 kg under a force, in steps of 0.1 s: position (m), velocity (m/s).
/// let a = Matrix2::new(1.0, 0.1, 0.0, 1.0);
/// let b = Vector2::new(0.005, 0.1);
/// let solution = Riccati::new(&a, &b, &Matrix2::identity(), &Matrix1::identity()).solve()?;
///
/// assert!(solution.relative_residual < 1e-14);
/// assert!(solution.spectral_radius < 0.95);
/// let force = -solution.k[(0, 0)]; // at 1 m and at rest
/// assert!(-1.0 < force && force < -0.9); // newtons, towards the origin
/// # Ok::<(), RiccatiError>(())
/// ```
#[doc(alias = "ared")]
#[doc(alias = "dare")]
#[doc(alias = "solve_discrete_are")]
#[derive(Clone, Debug)]
pub struct Riccati<'a> {
    a: StridedView<'a>,
    b: StridedView<'a>,
    q: StridedView<'a>,
    r: StridedView<'a>,
    s: Option<StridedView<'a>>,
    residual_tolerance: f64,
}

/// Buffers to solve Riccati equations repeatedly without allocating, by [`Riccati::solve_into`].
/// They grow to the size of the largest equation.
#[derive(Clone, Debug)]
pub struct RiccatiWorkspace {
    problem: Problem,
}

impl RiccatiWorkspace {
    /// Creates an empty workspace, which allocates for its first equation.
    pub fn new() -> Self {
        Self { problem: Problem::new() }
    }
}

impl Default for RiccatiWorkspace {
    fn default() -> Self {
        Self::new()
    }
}

/// Stabilising solution of a Riccati equation, with measures of its quality. The default is empty,
/// as an output of [`Riccati::solve_into`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RiccatiSolution {
    /// Solution `P`, `(n, n)`, symmetric to the last bit: `xᵀPx` is the cost to go from `x`.
    pub p: Matrix,
    /// Gain `K = (R + BᵀPB)⁻¹(BᵀPA + Sᵀ)`, `(m, n)`, of the optimal control `u = −K x`.
    pub k: Matrix,
    /// Relative residual of the equation: the Frobenius norm of
    /// `AᵀPA − (AᵀPB + S)(R + BᵀPB)⁻¹(BᵀPA + Sᵀ) + Q − P`, divided by the norm of `P`; zero if both
    /// vanish.
    pub relative_residual: f64,
    /// Spectral radius of `A − BK`, the largest modulus of its eigenvalues, which is below one. In
    /// `t` steps a small error shrinks, in the slowest direction, by this factor to the power `t`.
    ///
    /// The doubling computes it from a high power of `A − BK`, so it resolves radii close to 1 that
    /// an eigenvalue solver would round to 1.
    pub spectral_radius: f64,
    /// Number of doublings.
    pub iterations: usize,
}

impl<'a> Riccati<'a> {
    /// Creates the equation of the system `x⁺ = A x + B u` with the cost `Σ xᵀQx + uᵀRu`.
    pub fn new(
        a: impl Into<StridedView<'a>>,
        b: impl Into<StridedView<'a>>,
        q: impl Into<StridedView<'a>>,
        r: impl Into<StridedView<'a>>,
    ) -> Self {
        Self { a: a.into(), b: b.into(), q: q.into(), r: r.into(), s: None, residual_tolerance: RESIDUAL_TOLERANCE }
    }

    /// Adds the term `2 xᵀSu` to the cost.
    #[must_use]
    pub fn with_cross_term(mut self, s: impl Into<StridedView<'a>>) -> Self {
        self.s = Some(s.into());
        self
    }

    /// Sets the relative residual above which [`solve`](Self::solve) returns an error; the default
    /// is 10⁻⁹.
    ///
    /// The tolerance does not affect the solution, which is always refined as far as rounding
    /// permits.
    #[must_use]
    pub fn with_residual_tolerance(mut self, tolerance: f64) -> Self {
        self.residual_tolerance = tolerance;
        self
    }

    /// Solves the equation.
    ///
    /// # Errors
    ///
    /// * [`WrongShape`](RiccatiError::WrongShape), [`NotFinite`](RiccatiError::NotFinite),
    ///   [`NotSymmetric`](RiccatiError::NotSymmetric),
    ///   [`ControlCostNotPositive`](RiccatiError::ControlCostNotPositive),
    ///   [`SingularPencil`](RiccatiError::SingularPencil): the matrices do not define an equation.
    ///   The error names the first offending matrix.
    /// * [`UncontrollableMode`](RiccatiError::UncontrollableMode),
    ///   [`UnobservableMode`](RiccatiError::UnobservableMode): there is no stabilising solution
    ///   because of this mode.
    /// * [`NoConvergence`](RiccatiError::NoConvergence): no solution was found, and no single mode
    ///   is the reason.
    /// * [`Inaccurate`](RiccatiError::Inaccurate): the residual of the solution is above the
    ///   tolerance.
    pub fn solve(&self) -> Result<RiccatiSolution, RiccatiError> {
        let mut solution = RiccatiSolution::default();
        self.solve_into(&mut RiccatiWorkspace::new(), &mut solution)?;
        Ok(solution)
    }

    /// Solves the equation as [`solve`](Self::solve) does, with existing buffers and into an
    /// existing solution. Allocates nothing after the first equation of the same size, except to
    /// diagnose a failure and if `R` is singular.
    ///
    /// ```
    /// use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiSolution, RiccatiWorkspace};
    /// use mujoco_safe::nalgebra::{Matrix1, Matrix2, Vector2};
    ///
    /// let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    /// for timestep in [0.1, 0.05] {
    ///     let (a, b) = (Matrix2::new(1.0, timestep, 0.0, 1.0), Vector2::new(timestep * timestep / 2.0, timestep));
    ///     Riccati::new(&a, &b, &Matrix2::identity(), &Matrix1::identity()).solve_into(&mut workspace, &mut solution)?;
    ///     assert!(solution.spectral_radius < 1.0);
    /// }
    /// # Ok::<(), RiccatiError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`solve`](Self::solve). The solution is then unchanged.
    pub fn solve_into(
        &self,
        workspace: &mut RiccatiWorkspace,
        solution: &mut RiccatiSolution,
    ) -> Result<(), RiccatiError> {
        let problem = &mut workspace.problem;
        self.copy_to(problem)?;
        let doubled = problem.solve()?;
        let relative_residual = problem.candidate.relative_residual;
        let good = relative_residual <= self.residual_tolerance;
        if !good {
            let failure = RiccatiError::Inaccurate { relative_residual, tolerance: self.residual_tolerance };
            // A caller may ask for more than rounding permits.
            return Err(if relative_residual > RESIDUAL_TOLERANCE { problem.explain(failure) } else { failure });
        }
        problem.write_to(&mut solution.p, &mut solution.k);
        solution.relative_residual = relative_residual;
        solution.spectral_radius = doubled.spectral_radius;
        solution.iterations = doubled.count;
        Ok(())
    }

    /// Copies the matrices, and checks shapes, finiteness and symmetry.
    fn copy_to(&self, problem: &mut Problem) -> Result<(), RiccatiError> {
        let (states, controls) = (self.a.shape().0, self.b.shape().1);
        check(RiccatiMatrix::A, &self.a, (states, states))?;
        check(RiccatiMatrix::B, &self.b, (states, controls))?;
        check(RiccatiMatrix::Q, &self.q, (states, states))?;
        check(RiccatiMatrix::R, &self.r, (controls, controls))?;
        if let Some(s) = &self.s {
            check(RiccatiMatrix::S, s, (states, controls))?;
        }
        problem.a.copy_view(&self.a);
        problem.b.copy_view(&self.b);
        copy_symmetric(RiccatiMatrix::Q, &self.q, &mut problem.q)?;
        copy_symmetric(RiccatiMatrix::R, &self.r, &mut problem.r)?;
        problem.set_cross_term(self.s.as_ref());
        Ok(())
    }
}

/// Checks that a matrix has the expected shape and finite entries.
fn check(matrix: RiccatiMatrix, view: &StridedView<'_>, expected: (usize, usize)) -> Result<(), RiccatiError> {
    if view.shape() != expected {
        return Err(RiccatiError::WrongShape { matrix, expected, found: view.shape() });
    }
    for (column, mut entries) in view.columns().enumerate() {
        if let Some(row) = entries.position(|entry| !entry.is_finite()) {
            return Err(RiccatiError::NotFinite { matrix, row, column, value: view[(row, column)] });
        }
    }
    Ok(())
}

/// Copies the symmetric part of `weight`, if `weight` is symmetric up to rounding.
fn copy_symmetric(matrix: RiccatiMatrix, weight: &StridedView<'_>, to: &mut PackedMatrix) -> Result<(), RiccatiError> {
    check_symmetric(matrix, weight)?;
    let (rows, columns) = weight.shape();
    to.fill(rows, columns, |row, column| 0.5 * (weight[(row, column)] + weight[(column, row)]));
    Ok(())
}

/// Checks that a matrix differs from its transpose only by rounding.
fn check_symmetric(matrix: RiccatiMatrix, weight: &StridedView<'_>) -> Result<(), RiccatiError> {
    let tolerance = SYMMETRY_TOLERANCE * weight.columns().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    for column in 0..weight.shape().1 {
        for row in 0..column {
            let (value, mirror) = (weight[(row, column)], weight[(column, row)]);
            if (value - mirror).abs() > tolerance {
                return Err(RiccatiError::NotSymmetric { matrix, row, column, value, mirror });
            }
        }
    }
    Ok(())
}
