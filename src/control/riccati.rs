//! The discrete algebraic Riccati equation, by doubling.
//!
//! For a system `x⁺ = A x + B u` and the cost `Σ xᵀQx + uᵀRu + 2 xᵀSu`, the cost to go from `x` under the best control is `xᵀPx`,
//! where `P` is the stabilising solution of
//!
//! ```text
//! P = AᵀPA − (AᵀPB + S)(R + BᵀPB)⁻¹(BᵀPA + Sᵀ) + Q
//! ```
//!
//! and the best control is `u = −K x` with `K = (R + BᵀPB)⁻¹(BᵀPA + Sᵀ)`. Stabilising means that every eigenvalue of `A − BK`
//! lies inside the unit circle. [`Riccati`] states the equation, [`Riccati::solve`] solves it or says why it cannot.
//!
//! Over a finite number of steps, or where the system changes from step to step, there is a recursion instead of an equation:
//! [`RiccatiRecursion`].
//!
//! # How
//!
//! The cross term is eliminated first: `A₀ = A − BR⁻¹Sᵀ`, `G₀ = BR⁻¹Bᵀ`, `H₀ = Q − SR⁻¹Sᵀ`, and the states get units in which these are
//! balanced (`riccati/scaling.rs`), which is worth two digits of the humanoid's solution. Then one step of the
//! structure-preserving doubling algorithm,
//!
//! ```text
//! A⁺ = A (I + GH)⁻¹ A
//! G⁺ = G + A (I + GH)⁻¹ G Aᵀ
//! H⁺ = H + AᵀH (I + GH)⁻¹ A
//! ```
//!
//! does what as many steps of the Riccati recursion would do as have been done already, so `H` converges to `P` quadratically:
//! after `k` doublings the error has the factor `ρ` to the power `2ᵏ⁺¹`, with `ρ` the spectral radius of `A − BK`. Even a humanoid
//! whose place on the floor costs next to nothing, `1 − ρ ≈ 10⁻⁹`, needs about forty. Most of these are nearly free, because by
//! then the rank of `A` has fallen to a handful and the rest happens in that many dimensions; `riccati/doubling.rs`
//! has the derivation. Where the residual is above what rounding explains, Newton steps follow (Hewer 1971).
//!
//! # Sources
//!
//! * B. D. O. Anderson, *Second-order convergent algorithms for the steady-state Riccati equation*,
//!   International Journal of Control 28 (1978) 295–306.
//! * E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, *Structure-preserving algorithms for periodic discrete-time algebraic Riccati
//!   equations*, International Journal of Control 77 (2004) 767–788.
//! * G. A. Hewer, *An iterative technique for the computation of the steady state gains for the discrete optimal
//!   regulator*, IEEE Transactions on Automatic Control 16 (1971) 382–384.
#![allow(clippy::many_single_char_names, reason = "A, B, Q, R, S, P, K, G and H are the symbols of the field")]

mod backup;
mod diagnosis;
mod doubling;
mod error;
mod factors;
mod lanes;
mod low_rank;
mod panels;
mod problem;
mod recursion;
mod scaling;

use nalgebra::{DMatrix, DMatrixView, Dyn};

pub(in crate::control) use backup::{Backup, StepCost};
pub use error::{RiccatiError, RiccatiMatrix};
pub use recursion::RiccatiRecursion;

use panels::Panels;
use problem::Problem;

/// What [`Riccati::residual_tolerance`] is if nobody says otherwise.
const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Largest difference between mirrored entries of `Q` or of `R` that passes for rounding, relative to the largest entry.
const SYMMETRY_TOLERANCE: f64 = 1e-8;

/// A discrete algebraic Riccati equation, ready to be solved.
///
/// With `n` states and `m` controls, `A` is `(n, n)`, `B` is `(n, m)`, `Q` is `(n, n)`, `R` is `(m, m)` and `S`, zero unless
/// [`with_cross_term`](Self::with_cross_term) gives it, is `(n, m)`. `R` must be positive semidefinite, and the whole cost ought to be, as
/// it is if it cannot be negative. `Q` and `R` stand for their symmetric parts: rounding may have made
/// them differ from their transposes by up to 10⁻⁸ of the largest entry.
///
/// Any nalgebra matrix or view goes in, statically or dynamically sized, column-major or row-major.
///
/// ```
/// use mujoco_safe::control::riccati::{Riccati, RiccatiError};
/// use nalgebra::{matrix, vector, Matrix1, Matrix2};
///
/// // A mass of 1 kg pushed by a force for 0.1 s at a time: position (m), velocity (m/s).
/// let a = matrix![1.0, 0.1; 0.0, 1.0];
/// let b = vector![0.005, 0.1];
/// let solution = Riccati::new(&a, &b, &Matrix2::identity(), &Matrix1::identity()).solve()?;
///
/// assert!(solution.relative_residual < 1e-14);
/// assert!(solution.spectral_radius < 0.95);
/// let force = -(&solution.k * vector![1.0, 0.0])[0]; // 1 m off and at rest
/// assert!(-1.0 < force && force < -0.9); // newtons, backwards
/// # Ok::<(), RiccatiError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Riccati<'a> {
    a: DMatrixView<'a, f64, Dyn, Dyn>,
    b: DMatrixView<'a, f64, Dyn, Dyn>,
    q: DMatrixView<'a, f64, Dyn, Dyn>,
    r: DMatrixView<'a, f64, Dyn, Dyn>,
    s: Option<DMatrixView<'a, f64, Dyn, Dyn>>,
    residual_tolerance: f64,
}

/// Room for solving Riccati equations again and again without allocating, with [`Riccati::solve_into`]. It grows to the size of the largest.
#[derive(Clone, Debug)]
pub struct RiccatiWorkspace {
    problem: Problem,
}

impl RiccatiWorkspace {
    /// An empty one, which the first equation fills.
    pub fn new() -> Self {
        Self { problem: Problem::new() }
    }
}

impl Default for RiccatiWorkspace {
    fn default() -> Self {
        Self::new()
    }
}

/// The stabilising solution of a Riccati equation, and the figures that vouch for it. The default is that of no equation, for
/// [`Riccati::solve_into`] to write to.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RiccatiSolution {
    /// The solution `P`, `(n, n)`, symmetric to the last bit: `xᵀPx` is the cost to go from `x`.
    pub p: DMatrix<f64>,
    /// The gain `K = (R + BᵀPB)⁻¹(BᵀPA + Sᵀ)`, `(m, n)`, of the best control `u = −K x`.
    pub k: DMatrix<f64>,
    /// How far `P` is from satisfying the equation: the Frobenius norm of
    /// `AᵀPA − (AᵀPB + S)(R + BᵀPB)⁻¹(BᵀPA + Sᵀ) + Q − P`, divided by that of `P`; zero where both vanish.
    pub relative_residual: f64,
    /// The largest modulus among the eigenvalues of `A − BK`, below one: after `t` steps a small error has shrunk, in
    /// the slowest direction, by this to the power `t`.
    ///
    /// It comes out of the doubling, which has a high power of `A − BK` at hand, and so tells from one even radii that
    /// the rounding of an eigenvalue solver would blur.
    pub spectral_radius: f64,
    /// How many doublings it took.
    pub iterations: usize,
}

impl<'a> Riccati<'a> {
    /// The equation of the system `x⁺ = A x + B u` with the cost `Σ xᵀQx + uᵀRu`.
    pub fn new(
        a: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
        b: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
        q: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
        r: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
    ) -> Self {
        Self { a: a.into(), b: b.into(), q: q.into(), r: r.into(), s: None, residual_tolerance: RESIDUAL_TOLERANCE }
    }

    /// Adds the term `2 xᵀSu` to the cost.
    #[must_use]
    pub fn with_cross_term(mut self, s: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>) -> Self {
        self.s = Some(s.into());
        self
    }

    /// Sets the relative residual above which a solution is refused; 10⁻⁹ otherwise.
    ///
    /// A solution is refined as far as rounding lets it whatever the tolerance, so this decides only what is an error.
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
    ///   [`NotSymmetric`](RiccatiError::NotSymmetric), [`ControlCostNotPositive`](RiccatiError::ControlCostNotPositive),
    ///   [`SingularPencil`](RiccatiError::SingularPencil):
    ///   the matrices do not state an equation. The first at fault is named.
    /// * [`UncontrollableMode`](RiccatiError::UncontrollableMode), [`UnobservableMode`](RiccatiError::UnobservableMode):
    ///   there is no stabilising solution, and this mode is why.
    /// * [`NoConvergence`](RiccatiError::NoConvergence): none was found, and no mode stands out as the reason.
    /// * [`Inaccurate`](RiccatiError::Inaccurate): the residual of what was found is above the tolerance.
    pub fn solve(&self) -> Result<RiccatiSolution, RiccatiError> {
        let mut solution = RiccatiSolution::default();
        self.solve_into(&mut RiccatiWorkspace::new(), &mut solution)?;
        Ok(solution)
    }

    /// As [`solve`](Self::solve), with room that is there already, into a solution that is there already. Allocates nothing when both have
    /// seen an equation of this size before, except for finding out why there is no solution, and where `R` is singular.
    ///
    /// ```
    /// use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiSolution, RiccatiWorkspace};
    /// use nalgebra::{matrix, vector, Matrix1, Matrix2};
    ///
    /// let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    /// for timestep in [0.1, 0.05] {
    ///     let (a, b) = (matrix![1.0, timestep; 0.0, 1.0], vector![timestep * timestep / 2.0, timestep]);
    ///     Riccati::new(&a, &b, &Matrix2::identity(), &Matrix1::identity()).solve_into(&mut workspace, &mut solution)?;
    ///     assert!(solution.spectral_radius < 1.0);
    /// }
    /// # Ok::<(), RiccatiError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`solve`](Self::solve). The solution is then as it was.
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
            return Err(RiccatiError::Inaccurate { relative_residual, tolerance: self.residual_tolerance });
        }
        problem.write_to(&mut solution.p, &mut solution.k);
        solution.relative_residual = relative_residual;
        solution.spectral_radius = doubled.spectral_radius;
        solution.iterations = doubled.count;
        Ok(())
    }

    /// Copies the matrices, checking everything that can be checked by looking at the entries.
    fn copy_to(&self, problem: &mut Problem) -> Result<(), RiccatiError> {
        let (states, controls) = (self.a.nrows(), self.b.ncols());
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

/// Refuses a matrix of another shape than expected, or with something in it that is not a number.
fn check(
    matrix: RiccatiMatrix,
    view: &DMatrixView<'_, f64, Dyn, Dyn>,
    expected: (usize, usize),
) -> Result<(), RiccatiError> {
    if view.shape() != expected {
        return Err(RiccatiError::WrongShape { matrix, expected, got: view.shape() });
    }
    for (column, entries) in view.column_iter().enumerate() {
        if let Some(row) = entries.iter().position(|entry| !entry.is_finite()) {
            return Err(RiccatiError::NotFinite { matrix, row, column, value: entries[row] });
        }
    }
    Ok(())
}

/// Copies the symmetric part of `weight`, if that is `weight` up to rounding.
fn copy_symmetric(
    matrix: RiccatiMatrix,
    weight: &DMatrixView<'_, f64, Dyn, Dyn>,
    to: &mut Panels,
) -> Result<(), RiccatiError> {
    check_symmetric(matrix, weight)?;
    to.fill(weight.nrows(), weight.ncols(), |row, column| 0.5 * (weight[(row, column)] + weight[(column, row)]));
    Ok(())
}

/// Refuses a matrix that differs from its transpose by more than rounding explains.
fn check_symmetric(matrix: RiccatiMatrix, weight: &DMatrixView<'_, f64, Dyn, Dyn>) -> Result<(), RiccatiError> {
    let tolerance = SYMMETRY_TOLERANCE * weight.amax();
    for column in 0..weight.ncols() {
        for row in 0..column {
            let (value, mirror) = (weight[(row, column)], weight[(column, row)]);
            if (value - mirror).abs() > tolerance {
                return Err(RiccatiError::NotSymmetric { matrix, row, column, value, mirror });
            }
        }
    }
    Ok(())
}
