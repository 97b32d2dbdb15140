//! The solution process: balancing, elimination of the cross term, doubling, refinement.

use nalgebra::DMatrix;

use super::balancing;
use super::diagnosis::{MAX_EIGENVALUE_ITERATIONS, Matrices, diagnose, diagnose_failure};
use super::doubling::{Doubled, Doubling, NoConvergence};
use super::error::RiccatiError;
use crate::matrix::{Matrix, StridedView};
use crate::numerics::InstructionSet;
use crate::numerics::dense::{LuFactors, PackedMatrix};

/// Maximum number of Newton steps. Each squares the error, so two suffice unless the doubling was
/// inaccurate.
const MAX_NEWTON_STEPS: usize = 6;

/// Relative residual per state, in units of the machine precision, up to which no Newton step is
/// needed.
const GOOD_RESIDUAL: f64 = 32.0;

/// Doublings before the first attempt to deflate: the modes of a mechanical system take more than
/// 2⁴ steps to vanish.
const PATIENCE: usize = 4;

/// Distance of the spectral radius from one below which rounding alone may have moved an
/// uncontrollable or unobservable mode into the unit circle.
const DOUBTFUL_MARGIN: f64 = 1e-12;

/// Relative residual above which a mode may be controllable by rounding alone.
const DOUBTFUL_RESIDUAL: f64 = 1e-6;

/// Magnitude of a negative eigenvalue of `R`, relative to the largest entry, that counts as zero.
const NEGATIVE_TOLERANCE: f64 = 1e-12;

/// Riccati equation with validated matrices, symmetric `Q` and `R`, and the buffers to solve it.
/// The states are in balanced units: see `balancing.rs`.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    simd: InstructionSet,
    pub(super) a: PackedMatrix,
    pub(super) b: PackedMatrix,
    pub(super) q: PackedMatrix,
    pub(super) r: PackedMatrix,
    pub(super) s: Option<PackedMatrix>,
    spare_s: PackedMatrix,
    /// Diagonal of `D`, and buffers to compute it.
    units: Vec<f64>,
    unit_squares: (Vec<f64>, Vec<f64>),
    /// The current candidate, and the best one so far.
    pub(super) candidate: Candidate,
    best: Candidate,
    doubling: Doubling,
    b_transpose: PackedMatrix,
    product: PackedMatrix,
    other: PackedMatrix,
}

/// Candidate for the solution, with the quantities derived from it.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidate {
    pub(super) p: PackedMatrix,
    pub(super) k: PackedMatrix,
    pub(super) relative_residual: f64,
    residual: PackedMatrix,
    /// `A − BK`.
    closed_loop: PackedMatrix,
    /// Factors of `R + BᵀPB`.
    cost: LuFactors,
}

impl Problem {
    pub(super) fn new() -> Self {
        let simd = InstructionSet::detect();
        let none = PackedMatrix::default;
        Self {
            simd,
            a: none(),
            b: none(),
            q: none(),
            r: none(),
            s: None,
            spare_s: none(),
            units: Vec::new(),
            unit_squares: (Vec::new(), Vec::new()),
            candidate: Candidate::default(),
            best: Candidate::default(),
            doubling: Doubling::new(simd),
            b_transpose: none(),
            product: none(),
            other: none(),
        }
    }

    /// Sets or removes the cross term.
    pub(super) fn set_cross_term(&mut self, s: Option<&StridedView<'_>>) {
        if let Some(kept) = self.s.take() {
            self.spare_s = kept;
        }
        if let Some(s) = s {
            let mut kept = std::mem::take(&mut self.spare_s);
            kept.copy_view(s);
            self.s = Some(kept);
        }
    }

    /// Computes the stabilising solution to the accuracy that rounding permits, and stores it in
    /// `candidate`.
    pub(super) fn solve(&mut self) -> Result<Doubled, RiccatiError> {
        self.units.clear();
        self.start()?;
        self.choose_units();
        self.start()?;
        let mut doubled = match self.double_from_candidate() {
            Ok(doubled) => doubled,
            Err(failure) => self.solve_from_above(failure)?,
        };
        self.refine(&mut doubled);
        let doubtful =
            doubled.spectral_radius > 1.0 - DOUBTFUL_MARGIN || self.candidate.relative_residual > DOUBTFUL_RESIDUAL;
        match if doubtful { diagnose(self.matrices().as_ref()) } else { None } {
            Some(error) => Err(error),
            None => Ok(doubled),
        }
    }

    /// Sets the initial candidate: `P = 0`, or, if some controls have no cost, a multiple of the
    /// identity, which adds a cost of these controls.
    ///
    /// Any symmetric `X` is a valid start: the difference `Δ = P − X` solves an equation of the
    /// same form,
    ///
    /// ```text
    /// Δ = FᵀΔF − FᵀΔB (R + BᵀXB + BᵀΔB)⁻¹ BᵀΔF + residual of X,    F = A − B × gain of X
    /// ```
    ///
    /// which has no cross term. For `X = 0` it is the equation itself with `A − BR⁻¹Sᵀ`, `BR⁻¹Bᵀ`
    /// and `Q − SR⁻¹Sᵀ`.
    fn start(&mut self) -> Result<(), RiccatiError> {
        let states = self.a.rows();
        self.candidate.p.clear(states, states);
        if self.evaluate() {
            return Ok(());
        }
        let r = self.r.to_matrix(|_, _| 1.0);
        let largest = r.amax();
        let smallest_eigenvalue = smallest_eigenvalue(r);
        if smallest_eigenvalue < -NEGATIVE_TOLERANCE * largest || smallest_eigenvalue.is_nan() {
            return Err(RiccatiError::ControlCostNotPositive { smallest_eigenvalue });
        }
        let norm = self.q.norm();
        let cost = if norm > 0.0 { norm } else { 1.0 };
        self.candidate.p.clear(states, states);
        self.candidate.p.add_to_diagonal(cost);
        if self.evaluate() { Ok(()) } else { Err(RiccatiError::SingularPencil) }
    }

    /// Balances the states, given the equation of the difference to the candidate.
    fn choose_units(&mut self) {
        self.set_difference_equation();
        let Doubling { a, g, h, .. } = &self.doubling;
        let (squares, reciprocals) = &mut self.unit_squares;
        balancing::units(a, g, h, &mut self.product, (&mut self.units, squares, reciprocals));
        let units = &self.units;
        let (unit, reciprocal) = (|state: usize| units[state], |state: usize| 1.0 / units[state]);
        self.a.scale_both(unit, reciprocal);
        self.b.scale_both(unit, |_| 1.0);
        self.q.scale_both(reciprocal, reciprocal);
        if let Some(s) = &mut self.s {
            s.scale_both(reciprocal, |_| 1.0);
        }
    }

    /// Writes the equation of the difference to the candidate to `doubling`.
    fn set_difference_equation(&mut self) {
        let Self { simd, b, candidate, doubling, b_transpose, .. } = self;
        doubling.a.copy_from(&candidate.closed_loop);
        doubling.h.copy_from(&candidate.residual);
        b_transpose.transpose_from(b);
        candidate.cost.solve(*simd, b_transpose);
        doubling.g.clear(b.rows(), b.rows());
        doubling.g.add_symmetric_product(*simd, b, b_transpose);
    }

    /// Computes the difference to the solution by doubling, and adds it to the candidate.
    fn double_from_candidate(&mut self) -> Result<Doubled, NoConvergence> {
        self.set_difference_equation();
        let doubled = self.doubling.solve(PATIENCE)?;
        self.candidate.p.add(&self.doubling.h);
        let failure = NoConvergence { count: doubled.count };
        if self.evaluate() && doubled.spectral_radius < 1.0 { Ok(doubled) } else { Err(failure) }
    }

    /// Handles a failure of the doubling: returns the reason why there is no solution, or solves
    /// from another start.
    ///
    /// Doubling starts from `P = 0`. If a mode outside the unit circle has no cost, `P = 0` remains
    /// a solution along this mode, but the stabilising solution is larger. So this first solves an
    /// equation with a larger `Q`, whose solution is an upper bound, and then doubles again for the
    /// difference.
    fn solve_from_above(&mut self, failure: NoConvergence) -> Result<Doubled, RiccatiError> {
        if let Some(error) = diagnose(self.matrices().as_ref()) {
            return Err(error);
        }
        let norm = self.q.norm();
        let addition = if norm > 0.0 { norm } else { self.r.norm() };
        let from_above = |this: &mut Self| {
            this.start().ok()?;
            this.set_difference_equation();
            this.doubling.h.add_to_diagonal(addition);
            this.doubling.solve(PATIENCE).ok()?;
            this.candidate.p.add(&this.doubling.h);
            if !this.evaluate() {
                return None;
            }
            this.double_from_candidate().ok()
        };
        if let Some(doubled) = from_above(self) {
            return Ok(doubled);
        }
        Err(self.explain(RiccatiError::NoConvergence { iterations: failure.count }))
    }

    /// Returns the mode that explains a failure, or else the failure.
    pub(super) fn explain(&mut self, failure: RiccatiError) -> RiccatiError {
        diagnose_failure(self.matrices().as_ref()).unwrap_or(failure)
    }

    /// Refines the candidate by Newton steps while the residual decreases: `P + Δ`, where
    /// `Δ = FᵀΔF + residual` and `F = A − BK`.
    fn refine(&mut self, doubled: &mut Doubled) {
        let good = GOOD_RESIDUAL * self.a.rows() as f64 * f64::EPSILON;
        for _ in 0..MAX_NEWTON_STEPS {
            if self.candidate.relative_residual <= good {
                break;
            }
            let Self { candidate, doubling, best, .. } = self;
            doubling.a.copy_from(&candidate.closed_loop);
            doubling.g.clear(0, 0);
            doubling.h.copy_from(&candidate.residual);
            if doubling.solve(doubled.patience).is_err() {
                break;
            }
            std::mem::swap(best, candidate);
            candidate.p.copy_from(&best.p);
            candidate.p.add(&doubling.h);
            let better = self.evaluate() && self.candidate.relative_residual < self.best.relative_residual;
            if !better {
                std::mem::swap(&mut self.best, &mut self.candidate);
                break;
            }
        }
    }

    /// Computes the gain and the residual of the candidate. Returns `false` if `R + BᵀPB` is not
    /// positive definite.
    ///
    /// With this gain the residual equals `(A − BK)ᵀP(A − BK) + KᵀRK − SK − KᵀSᵀ + Q − P`, which is
    /// evaluated instead. Its terms are no larger than `P`, whereas `AᵀPA` can be so large that the
    /// difference cancels.
    fn evaluate(&mut self) -> bool {
        let Self { simd, a, b, q, r, s, candidate, product, other, units, .. } = self;
        let Candidate { p, k, relative_residual, residual, closed_loop, cost } = candidate;
        let simd = *simd;
        // Skips products with the initial P = 0.
        let (from_zero, plain) = (p.is_zero(), s.is_none());
        cost.matrix().copy_from(r);
        if !from_zero {
            product.product(simd, p, b);
            cost.matrix().add_symmetric_transposed(simd, b, product);
        }
        if !cost.factorise_positive(simd) {
            return false;
        }
        k.clear(b.columns(), a.columns());
        closed_loop.copy_from(a);
        residual.copy_from(q);
        if from_zero && plain {
            *relative_residual = if residual.is_zero() { 0.0 } else { f64::INFINITY };
            return true;
        }
        if !from_zero {
            k.transposed_product(simd, product, a);
        }
        if let Some(s) = s {
            other.transpose_from(s);
            k.add(other);
        }
        cost.solve(simd, k);
        closed_loop.subtract_product(simd, b, k);

        if !from_zero {
            product.product(simd, p, closed_loop);
            residual.add_symmetric_transposed(simd, closed_loop, product);
        }
        product.product(simd, r, k);
        residual.add_symmetric_transposed(simd, k, product);
        if let Some(s) = s {
            product.product(simd, s, k);
            other.transpose_from(product);
            other.add(product);
            other.scale(-1.0);
            residual.add(other);
        }
        residual.subtract(p);
        let norm = residual.norm_in(units);
        *relative_residual = if norm == 0.0 { 0.0 } else { norm / p.norm_in(units) };
        true
    }

    /// Writes the candidate in the original units.
    pub(super) fn write_to(&self, p: &mut Matrix, k: &mut Matrix) {
        let unit = |state: usize| self.units.get(state).copied().unwrap_or(1.0);
        self.candidate.p.write_to(p, |row, column| unit(row) * unit(column));
        self.candidate.k.write_to(k, |_, column| unit(column));
    }

    /// Returns `A`, `B`, `A − BR⁻¹Sᵀ` and `Q − SR⁻¹Sᵀ` in the original units. If some controls have
    /// no cost, the last two are the matrices of the difference equation of [`start`](Self::start).
    fn matrices(&mut self) -> Option<Matrices> {
        self.start().ok()?;
        let Candidate { closed_loop, residual, .. } = &self.candidate;
        let unit = |state: usize| self.units.get(state).copied().unwrap_or(1.0);
        Some([
            self.a.to_matrix(|row, column| unit(column) / unit(row)),
            self.b.to_matrix(|row, _| 1.0 / unit(row)),
            closed_loop.to_matrix(|row, column| unit(column) / unit(row)),
            residual.to_matrix(|row, column| unit(row) * unit(column)),
        ])
    }
}

/// Returns the smallest eigenvalue of a symmetric matrix, or NaN if the decomposition fails.
pub(super) fn smallest_eigenvalue(matrix: DMatrix<f64>) -> f64 {
    match matrix.try_symmetric_eigen(f64::EPSILON, MAX_EIGENVALUE_ITERATIONS) {
        Some(decomposition) => decomposition.eigenvalues.min(),
        None => f64::NAN,
    }
}
