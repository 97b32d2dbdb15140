//! The way from the matrices to the solution: choose units, eliminate the cross term, double, refine.

use nalgebra::{DMatrix, DMatrixView, Dyn};

use super::diagnosis::diagnose;
use super::doubling::{Doubled, Doubling, NoConvergence};
use super::error::RiccatiError;
use super::factors::Factors;
use super::lanes::Processor;
use super::panels::Panels;
use super::scaling;

/// Newton steps at most. Each squares the error, so two are enough unless the doubling went wrong.
const MOST_NEWTON_STEPS: usize = 6;

/// The relative residual for each state, in units of the precision, that is not worth a Newton step.
const GOOD: f64 = 32.0;

/// Doublings before which nothing is expected to be shed: a mechanical system's modes take longer than 2⁴ steps to vanish.
const PATIENCE: usize = 4;

/// How close to one the spectral radius comes when it may be rounding alone that has moved a mode, one that no control reaches or
/// that costs nothing, to the inside of the unit circle.
const DOUBTFUL_MARGIN: f64 = 1e-12;

/// The relative residual above which it may be rounding alone that makes a mode controllable.
const DOUBTFUL_RESIDUAL: f64 = 1e-6;

/// How negative an eigenvalue of `R` may be and still pass for zero, relative to the largest entry.
const NOT_NEGATIVE: f64 = 1e-12;

/// Iterations that nalgebra's eigenvalue solvers are allowed, so that they end.
pub(super) const MOST_EIGENVALUE_ITERATIONS: usize = 10_000;

/// A Riccati equation whose matrices fit together and are finite, with symmetric `Q` and `R`, and room to solve it. The states are in
/// units of their own: see `scaling.rs`.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    processor: Processor,
    pub(super) a: Panels,
    pub(super) b: Panels,
    pub(super) q: Panels,
    pub(super) r: Panels,
    pub(super) s: Option<Panels>,
    spare_s: Panels,
    /// The diagonal of `D`, and room to find it.
    units: Vec<f64>,
    unit_squares: (Vec<f64>, Vec<f64>),
    /// The one that is looked at, and the best so far.
    pub(super) candidate: Candidate,
    best: Candidate,
    doubling: Doubling,
    b_transpose: Panels,
    product: Panels,
    other: Panels,
}

/// A candidate for the solution, and what follows from it.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidate {
    pub(super) p: Panels,
    pub(super) k: Panels,
    pub(super) relative_residual: f64,
    residual: Panels,
    /// `A − BK`.
    closed_loop: Panels,
    /// Of `R + BᵀPB`.
    cost: Factors,
}

impl Problem {
    pub(super) fn new() -> Self {
        let processor = Processor::detect();
        let none = Panels::default;
        Self {
            processor,
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
            doubling: Doubling::new(processor),
            b_transpose: none(),
            product: none(),
            other: none(),
        }
    }

    /// Takes or leaves out the cross term.
    pub(super) fn set_cross_term(&mut self, s: Option<&DMatrixView<'_, f64, Dyn, Dyn>>) {
        if let Some(kept) = self.s.take() {
            self.spare_s = kept;
        }
        if let Some(s) = s {
            let mut kept = std::mem::take(&mut self.spare_s);
            kept.copy_view(s);
            self.s = Some(kept);
        }
    }

    /// Finds the stabilising solution, as accurate as it gets. It is the candidate then.
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
        match if doubtful { diagnose(self) } else { None } {
            Some(error) => Err(error),
            None => Ok(doubled),
        }
    }

    /// Makes that the candidate from which the solution is looked for: `P = 0`, or, where some controls cost nothing, a multiple of the
    /// identity, with which they do.
    ///
    /// Any symmetric `X` will do: the difference `Δ = P − X` solves an equation of the same kind,
    ///
    /// ```text
    /// Δ = FᵀΔF − FᵀΔB (R + BᵀXB + BᵀΔB)⁻¹ BᵀΔF + residual of X,    F = A − B × gain of X
    /// ```
    ///
    /// which has no cross term. With `X = 0` it is the equation itself with `A − BR⁻¹Sᵀ`, `BR⁻¹Bᵀ` and `Q − SR⁻¹Sᵀ`.
    fn start(&mut self) -> Result<(), RiccatiError> {
        let states = self.a.rows();
        self.candidate.p.clear(states, states);
        if self.evaluate() {
            return Ok(());
        }
        let r = self.r.to_matrix(|_, _| 1.0);
        let largest = r.amax();
        let smallest_eigenvalue = smallest_eigenvalue(r);
        if smallest_eigenvalue < -NOT_NEGATIVE * largest || smallest_eigenvalue.is_nan() {
            return Err(RiccatiError::ControlCostNotPositive { smallest_eigenvalue });
        }
        let norm = self.q.norm();
        let cost = if norm > 0.0 { norm } else { 1.0 };
        self.candidate.p.clear(states, states);
        self.candidate.p.add_to_diagonal(cost);
        if self.evaluate() { Ok(()) } else { Err(RiccatiError::SingularPencil) }
    }

    /// Changes the units of the states, given the equation of the candidate.
    fn choose_units(&mut self) {
        self.state_difference();
        let Doubling { a, g, h, .. } = &self.doubling;
        let (squares, reciprocals) = &mut self.unit_squares;
        scaling::units(a, g, h, &mut self.product, (&mut self.units, squares, reciprocals));
        let units = &self.units;
        let (unit, reciprocal) = (|state: usize| units[state], |state: usize| 1.0 / units[state]);
        self.a.scale_both(unit, reciprocal);
        self.b.scale_both(unit, |_| 1.0);
        self.q.scale_both(reciprocal, reciprocal);
        if let Some(s) = &mut self.s {
            s.scale_both(reciprocal, |_| 1.0);
        }
    }

    /// Writes the equation of the difference to the candidate to the doubling.
    fn state_difference(&mut self) {
        let Self { processor, b, candidate, doubling, b_transpose, .. } = self;
        doubling.a.copy_from(&candidate.closed_loop);
        doubling.h.copy_from(&candidate.residual);
        b_transpose.transpose_from(b);
        candidate.cost.solve(*processor, b_transpose);
        doubling.g.clear(b.rows(), b.rows());
        doubling.g.add_symmetric_product(*processor, b, b_transpose);
    }

    /// Adds to the candidate what doubling finds to be the difference to the solution.
    fn double_from_candidate(&mut self) -> Result<Doubled, NoConvergence> {
        self.state_difference();
        let doubled = self.doubling.solve(PATIENCE)?;
        self.candidate.p.add(&self.doubling.h);
        let failure = NoConvergence { count: doubled.count };
        if self.evaluate() && doubled.spectral_radius < 1.0 { Ok(doubled) } else { Err(failure) }
    }

    /// What to do when the doubling has failed: say why there is no solution, or else find it on another way.
    ///
    /// Doubling starts from `P = 0`. Where a mode outside the unit circle costs nothing, `P = 0` stays a solution along it, but
    /// not the stabilising one, which lies above. So the equation is solved with something added to `Q`, whose
    /// solution is above the one wanted, and then doubled again for the difference.
    fn solve_from_above(&mut self, failure: NoConvergence) -> Result<Doubled, RiccatiError> {
        if let Some(error) = diagnose(self) {
            return Err(error);
        }
        let norm = self.q.norm();
        let addition = if norm > 0.0 { norm } else { self.r.norm() };
        let from_above = |this: &mut Self| {
            this.start().ok()?;
            this.state_difference();
            this.doubling.h.add_to_diagonal(addition);
            this.doubling.solve(PATIENCE).ok()?;
            this.candidate.p.add(&this.doubling.h);
            if !this.evaluate() {
                return None;
            }
            this.double_from_candidate().ok()
        };
        from_above(self).ok_or(RiccatiError::NoConvergence { iterations: failure.count })
    }

    /// Newton's method for as long as it helps: `P + Δ`, where `Δ = FᵀΔF + residual` and `F = A − BK`.
    fn refine(&mut self, doubled: &mut Doubled) {
        let good = GOOD * self.a.rows() as f64 * f64::EPSILON;
        for _ in 0..MOST_NEWTON_STEPS {
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

    /// Computes the gain and the residual of the candidate; false if `R + BᵀPB` is not positive definite.
    ///
    /// With this gain the residual equals `(A − BK)ᵀP(A − BK) + KᵀRK − SK − KᵀSᵀ + Q − P`, which is evaluated instead: its terms
    /// are no larger than `P`, where `AᵀPA` can be so large that nothing is left of the difference.
    fn evaluate(&mut self) -> bool {
        let Self { processor, a, b, q, r, s, candidate, product, other, units, .. } = self;
        let Candidate { p, k, relative_residual, residual, closed_loop, cost } = candidate;
        let processor = *processor;
        // Nothing is to be learnt from products with zero, with which everything begins.
        let (from_zero, plain) = (p.is_zero(), s.is_none());
        cost.matrix().copy_from(r);
        if !from_zero {
            product.product(processor, p, b);
            cost.matrix().add_symmetric_transposed(processor, b, product);
        }
        if !cost.factorise_positive(processor) {
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
            k.transposed_product(processor, product, a);
        }
        if let Some(s) = s {
            other.transpose_from(s);
            k.add(other);
        }
        cost.solve(processor, k);
        closed_loop.subtract_product(processor, b, k);

        if !from_zero {
            product.product(processor, p, closed_loop);
            residual.add_symmetric_transposed(processor, closed_loop, product);
        }
        product.product(processor, r, k);
        residual.add_symmetric_transposed(processor, k, product);
        if let Some(s) = s {
            product.product(processor, s, k);
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

    /// Writes the candidate in the units that the equation came in.
    pub(super) fn write_to(&self, p: &mut DMatrix<f64>, k: &mut DMatrix<f64>) {
        let unit = |state: usize| self.units.get(state).copied().unwrap_or(1.0);
        self.candidate.p.write_to(p, |row, column| unit(row) * unit(column));
        self.candidate.k.write_to(k, |_, column| unit(column));
    }

    /// `A`, `B`, `A − BR⁻¹Sᵀ` and `Q − SR⁻¹Sᵀ`, or what takes the place of the last two where some controls cost nothing.
    pub(super) fn matrices(&mut self) -> Option<[DMatrix<f64>; 4]> {
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

/// The smallest eigenvalue of a symmetric matrix.
pub(super) fn smallest_eigenvalue(matrix: DMatrix<f64>) -> f64 {
    match matrix.try_symmetric_eigen(f64::EPSILON, MOST_EIGENVALUE_ITERATIONS) {
        Some(decomposition) => decomposition.eigenvalues.min(),
        None => f64::NAN,
    }
}
