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
//! The cross term is eliminated first: `A₀ = A − BR⁻¹Sᵀ`, `G₀ = BR⁻¹Bᵀ`, `H₀ = Q − SR⁻¹Sᵀ`. Then one step of the
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
//! has the derivation. Last come Newton steps (Hewer 1971), for as long as they reduce the residual.
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
mod dense;
mod diagnosis;
mod doubling;
mod error;
mod problem;
mod recursion;

use nalgebra::{DMatrix, DMatrixView, Dyn};

pub(in crate::control) use backup::{Backup, StepCost};
pub use error::{RiccatiError, RiccatiMatrix};
pub use recursion::RiccatiRecursion;

use problem::Problem;

/// What [`Riccati::residual_tolerance`] is if nobody says otherwise.
const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Largest difference between mirrored entries of `Q` or of `R` that passes for rounding, relative to the largest entry.
const SYMMETRY_TOLERANCE: f64 = 1e-8;

/// A discrete algebraic Riccati equation, ready to be solved.
///
/// With `n` states and `m` controls, `A` is `(n, n)`, `B` is `(n, m)`, `Q` is `(n, n)`, `R` is `(m, m)` and `S`, zero unless
/// [`with_cross_term`](Self::with_cross_term) gives it, is `(n, m)`. `R` must be positive definite, and `Q − SR⁻¹Sᵀ` ought to be positive
/// semidefinite, as it is for any cost that cannot be negative. `Q` and `R` stand for their symmetric parts: rounding may have made
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

/// The stabilising solution of a Riccati equation, and the figures that vouch for it.
#[derive(Clone, Debug, PartialEq)]
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
    ///   [`NotSymmetric`](RiccatiError::NotSymmetric), [`ControlCostNotPositive`](RiccatiError::ControlCostNotPositive):
    ///   the matrices do not state an equation. The first at fault is named.
    /// * [`UncontrollableMode`](RiccatiError::UncontrollableMode), [`UnobservableMode`](RiccatiError::UnobservableMode):
    ///   there is no stabilising solution, and this mode is why.
    /// * [`NoConvergence`](RiccatiError::NoConvergence): none was found, and no mode stands out as the reason.
    /// * [`Inaccurate`](RiccatiError::Inaccurate): the residual of what was found is above the tolerance.
    pub fn solve(&self) -> Result<RiccatiSolution, RiccatiError> {
        let problem = self.checked()?;
        let (solution, doublings) = problem.solve()?;
        if solution.relative_residual <= self.residual_tolerance {
            Ok(RiccatiSolution {
                p: solution.p,
                k: solution.k,
                relative_residual: solution.relative_residual,
                spectral_radius: doublings.spectral_radius,
                iterations: doublings.count,
            })
        } else {
            Err(RiccatiError::Inaccurate {
                relative_residual: solution.relative_residual,
                tolerance: self.residual_tolerance,
            })
        }
    }

    /// Copies the matrices, checking everything that can be checked by looking at the entries.
    fn checked(&self) -> Result<Problem, RiccatiError> {
        let (states, controls) = (self.a.nrows(), self.b.ncols());
        let a = checked(RiccatiMatrix::A, &self.a, (states, states))?;
        let b = checked(RiccatiMatrix::B, &self.b, (states, controls))?;
        let q = checked(RiccatiMatrix::Q, &self.q, (states, states))?;
        let r = checked(RiccatiMatrix::R, &self.r, (controls, controls))?;
        let s = match &self.s {
            Some(s) => Some(checked(RiccatiMatrix::S, s, (states, controls))?),
            None => None,
        };
        let q = symmetric(RiccatiMatrix::Q, q)?;
        let r = symmetric(RiccatiMatrix::R, r)?;
        Problem::new(a, b, q, r, s)
    }
}

/// A copy of `view`, if it has the expected shape and nothing but numbers in it.
fn checked(
    matrix: RiccatiMatrix,
    view: &DMatrixView<'_, f64, Dyn, Dyn>,
    expected: (usize, usize),
) -> Result<DMatrix<f64>, RiccatiError> {
    check(matrix, view, expected)?;
    Ok(view.clone_owned())
}

/// Whether `view` has the expected shape and nothing but numbers in it.
fn check(
    matrix: RiccatiMatrix,
    view: &DMatrixView<'_, f64, Dyn, Dyn>,
    expected: (usize, usize),
) -> Result<(), RiccatiError> {
    if view.shape() != expected {
        return Err(RiccatiError::WrongShape { matrix, expected, got: view.shape() });
    }
    match view.iter().position(|entry| !entry.is_finite()) {
        None => Ok(()),
        Some(position) => {
            let (row, column) = view.vector_to_matrix_index(position);
            Err(RiccatiError::NotFinite { matrix, row, column, value: view[(row, column)] })
        }
    }
}

/// The symmetric part of `weight`, if that is `weight` up to rounding.
fn symmetric(matrix: RiccatiMatrix, mut weight: DMatrix<f64>) -> Result<DMatrix<f64>, RiccatiError> {
    let tolerance = SYMMETRY_TOLERANCE * weight.amax();
    for column in 0..weight.ncols() {
        for row in 0..column {
            let (value, mirror) = (weight[(row, column)], weight[(column, row)]);
            if (value - mirror).abs() > tolerance {
                return Err(RiccatiError::NotSymmetric { matrix, row, column, value, mirror });
            }
        }
    }
    dense::symmetrise(&mut weight);
    Ok(weight)
}
