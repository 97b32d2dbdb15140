//! The way from the matrices to the solution: eliminate the cross term, double, refine.

use nalgebra::{Cholesky, DMatrix, Dyn};

use super::dense::symmetrise;
use super::diagnosis::diagnose;
use super::doubling::{Doubled, Doubling, NoConvergence};
use super::error::RiccatiError;

/// Newton steps at most. Each squares the error, so two are enough unless the doubling went wrong.
const MOST_NEWTON_STEPS: usize = 6;

/// Doublings before which [`Doubling::patience`] expects nothing: a mechanical system's modes take longer than 2⁴ steps to vanish.
const PATIENCE: usize = 4;

/// How close to one the spectral radius comes when it may be rounding alone that has moved a mode, one that no control reaches or
/// that costs nothing, to the inside of the unit circle.
const DOUBTFUL_MARGIN: f64 = 1e-12;

/// The relative residual above which it may be rounding alone that makes a mode controllable.
const DOUBTFUL_RESIDUAL: f64 = 1e-6;

/// Iterations that nalgebra's eigenvalue solvers are allowed, so that they end.
pub(super) const MOST_EIGENVALUE_ITERATIONS: usize = 10_000;

/// A Riccati equation whose matrices fit together and are finite, with symmetric `Q` and `R`.
pub(super) struct Problem {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    q: DMatrix<f64>,
    r: DMatrix<f64>,
    s: Option<DMatrix<f64>>,
    /// `A − BR⁻¹Sᵀ`, `BR⁻¹Bᵀ` and `Q − SR⁻¹Sᵀ`: the equation without the cross term.
    pub(super) a_without_s: DMatrix<f64>,
    g: DMatrix<f64>,
    pub(super) q_without_s: DMatrix<f64>,
}

/// A candidate for the solution, and what follows from it.
pub(super) struct Candidate {
    pub(super) p: DMatrix<f64>,
    pub(super) k: DMatrix<f64>,
    pub(super) relative_residual: f64,
    residual: DMatrix<f64>,
    /// `A − BK`.
    closed_loop: DMatrix<f64>,
    /// Of `R + BᵀPB`.
    cholesky: Cholesky<f64, Dyn>,
}

impl Problem {
    /// Eliminates the cross term, which takes a positive definite `R`.
    pub(super) fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        q: DMatrix<f64>,
        r: DMatrix<f64>,
        s: Option<DMatrix<f64>>,
    ) -> Result<Self, RiccatiError> {
        let Some(cholesky) = Cholesky::new(r.clone()) else {
            return Err(RiccatiError::ControlCostNotPositive { smallest_eigenvalue: smallest_eigenvalue(r) });
        };
        let mut g = &b * cholesky.solve(&b.transpose());
        symmetrise(&mut g);
        let (mut a_without_s, mut q_without_s) = (a.clone(), q.clone());
        if let Some(s) = &s {
            let solved = cholesky.solve(&s.transpose());
            a_without_s.gemm(-1.0, &b, &solved, 1.0);
            q_without_s.gemm(-1.0, s, &solved, 1.0);
            symmetrise(&mut q_without_s);
        }
        Ok(Self { a, b, q, r, s, a_without_s, g, q_without_s })
    }

    /// The stabilising solution, as accurate as it gets.
    pub(super) fn solve(&self) -> Result<(Candidate, Doubled), RiccatiError> {
        let solved = self.double(self.q_without_s.clone()).and_then(|doubled| self.candidate_of(doubled));
        let (candidate, doubled) = match solved {
            Ok(solved) => solved,
            Err(failure) => self.solve_from_above(&failure)?,
        };
        let candidate = self.refine(candidate, doubled.patience);
        let doubtful =
            doubled.spectral_radius > 1.0 - DOUBTFUL_MARGIN || candidate.relative_residual > DOUBTFUL_RESIDUAL;
        let reason = if doubtful { diagnose(self) } else { None };
        match reason {
            Some(error) => Err(error),
            None => Ok((candidate, doubled)),
        }
    }

    /// Doubling with another `Q` than the equation's.
    fn double(&self, q: DMatrix<f64>) -> Result<Doubled, NoConvergence> {
        Doubling { a: self.a_without_s.clone(), g: Some(self.g.clone()), h: q, patience: PATIENCE }.solve()
    }

    /// What to do when the doubling has failed: say why there is no solution, or else find it on another way.
    ///
    /// Doubling starts from `P = 0`. Where a mode outside the unit circle costs nothing, `P = 0` stays a solution along it, but
    /// not the stabilising one, which lies above. So the equation is solved with something added to `Q`, whose
    /// solution `X` is above the one wanted, and then doubled again for the difference `Δ = P − X`:
    ///
    /// ```text
    /// Δ = FᵀΔF − FᵀΔB (R + BᵀXB + BᵀΔB)⁻¹ BᵀΔF + residual of X,    F = A − B × gain of X
    /// ```
    fn solve_from_above(&self, failure: &NoConvergence) -> Result<(Candidate, Doubled), RiccatiError> {
        if let Some(error) = diagnose(self) {
            return Err(error);
        }
        let norm = self.q_without_s.norm();
        let addition = if norm > 0.0 { norm } else { self.r.norm() };
        let mut q = self.q_without_s.clone();
        for index in 0..q.nrows() {
            q[(index, index)] += addition;
        }
        let from_above = || {
            let (above, _) = self.candidate_of(self.double(q)?)?;
            let mut doubled = Doubling {
                a: above.closed_loop,
                g: Some(&self.b * above.cholesky.solve(&self.b.transpose())),
                h: above.residual,
                patience: PATIENCE,
            }
            .solve()?;
            doubled.x += above.p;
            self.candidate_of(doubled)
        };
        from_above().map_err(|_: NoConvergence| RiccatiError::NoConvergence { iterations: failure.count })
    }

    /// Newton's method for as long as it helps: `P + Δ`, where `Δ = FᵀΔF + residual` and `F = A − BK`.
    fn refine(&self, mut best: Candidate, patience: usize) -> Candidate {
        #[allow(clippy::cast_precision_loss, reason = "no matrix has 2⁵² rows")]
        let good = best.p.nrows() as f64 * f64::EPSILON;
        for _ in 0..MOST_NEWTON_STEPS {
            if best.relative_residual <= good {
                break;
            }
            let step = Doubling { a: best.closed_loop.clone(), g: None, h: best.residual.clone(), patience };
            let Ok(step) = step.solve() else { break };
            match self.candidate(&best.p + step.x) {
                Some(next) if next.relative_residual < best.relative_residual => best = next,
                _ => break,
            }
        }
        best
    }

    /// The candidate that a doubling found, if it can be one.
    fn candidate_of(&self, mut doubled: Doubled) -> Result<(Candidate, Doubled), NoConvergence> {
        let x = std::mem::take(&mut doubled.x);
        match self.candidate(x) {
            Some(candidate) if doubled.spectral_radius < 1.0 => Ok((candidate, doubled)),
            _ => Err(NoConvergence { count: doubled.count }),
        }
    }

    /// The gain and the residual of `P`, unless `R + BᵀPB` is not positive definite.
    ///
    /// With this gain the residual equals `(A − BK)ᵀP(A − BK) + KᵀRK − SK − KᵀSᵀ + Q − P`, which is evaluated instead: its terms
    /// are no larger than `P`, where `AᵀPA` can be so large that nothing is left of the difference.
    fn candidate(&self, p: DMatrix<f64>) -> Option<Candidate> {
        let b_transpose = self.b.transpose();
        let mut cost = self.r.clone();
        cost.gemm(1.0, &b_transpose, &(&p * &self.b), 1.0);
        symmetrise(&mut cost);
        let cholesky = Cholesky::new(cost)?;
        let mut coupling = b_transpose * (&p * &self.a);
        if let Some(s) = &self.s {
            coupling += s.transpose();
        }
        let k = cholesky.solve(&coupling);
        let mut closed_loop = self.a.clone();
        closed_loop.gemm(-1.0, &self.b, &k, 1.0);

        let k_transpose = k.transpose();
        let mut residual = &self.q - &p;
        residual.gemm(1.0, &closed_loop.transpose(), &(&p * &closed_loop), 1.0);
        residual.gemm(1.0, &k_transpose, &(&self.r * &k), 1.0);
        if let Some(s) = &self.s {
            residual.gemm(-2.0, s, &k, 1.0); // symmetrised below
        }
        symmetrise(&mut residual);
        let norm = residual.norm();
        let relative_residual = if norm == 0.0 { 0.0 } else { norm / p.norm() };
        Some(Candidate { p, k, relative_residual, residual, closed_loop, cholesky })
    }
}

/// The smallest eigenvalue of a symmetric matrix.
pub(super) fn smallest_eigenvalue(matrix: DMatrix<f64>) -> f64 {
    match matrix.try_symmetric_eigen(f64::EPSILON, MOST_EIGENVALUE_ITERATIONS) {
        Some(decomposition) => decomposition.eigenvalues.min(),
        None => f64::NAN,
    }
}
