//! The doubling iteration, with deflation of the fast modes.
//!
//! The equation here is `X = H + AᵀX (I + GX)⁻¹ A`. A doubling replaces it by another equation of
//! the same form with the same solution. `A` becomes a growing power of the closed loop, so its
//! fast modes fall below the rounding error. Then `A = U Wᵀ` with few columns in `U` and `W`, and
//! the equation implies that `X = H + W x Wᵀ` for some small `x`. Inserting this, with
//! `M = I + GH`,
//!
//! ```text
//! x = UᵀX (I + GX)⁻¹ U
//!   = UᵀHM⁻¹U + (WᵀM⁻¹U)ᵀ x (I + WᵀM⁻¹GW x)⁻¹ (WᵀM⁻¹U)
//! ```
//!
//! by the Sherman–Morrison–Woodbury formula. This equation has the same form, its dimension is the
//! number of remaining slow modes, and its closed loop has exactly the remaining eigenvalues. So
//! the slow modes, which need many doublings, are iterated in a low dimension.

use crate::numerics::InstructionSet;
use crate::numerics::dense::{LowRank, LuFactors, PackedMatrix};

/// Maximum number of doublings. Even a closed loop whose spectral radius is the largest `f64` below
/// one converges in fewer.
const MAX_DOUBLINGS: usize = 64;

/// Norm of `A` at which the doubling has converged. The relative change of `X` by the next doubling
/// is the square of it.
const CONVERGED: f64 = 1e-8;

/// Smallest dimension that is worth deflating.
const MIN_ROWS_TO_DEFLATE: usize = 12;

/// Number of squarings in [`Doubling::log_spectral_radius`]. The last one has the weight 2⁻⁵², the
/// resolution of an `f64`.
const SQUARINGS: i32 = 52;

/// Equation `X = H + AᵀX (I + GX)⁻¹ A` with symmetric `G` and `H`, which the caller fills in, and
/// the buffers to solve it.
#[derive(Clone, Debug)]
pub(super) struct Doubling {
    simd: InstructionSet,
    pub(super) a: PackedMatrix,
    pub(super) g: PackedMatrix,
    /// `H` before and the solution after [`solve`](Self::solve).
    pub(super) h: PackedMatrix,
    /// The deflated equations, `depth` of them, from the largest to the smallest.
    deflations: Vec<Deflation>,
    depth: usize,
    /// `A` and `G` of the smallest equation before its first doubling.
    first: (PackedMatrix, PackedMatrix),
    /// Number of doublings before that.
    doublings: i32,
    factors: LuFactors,
    low_rank: LowRank,
    transpose: PackedMatrix,
    w: PackedMatrix,
    v: PackedMatrix,
    product: PackedMatrix,
}

/// Equation that was deflated. The solution `x` of the smaller equation yields its solution
/// `X = h + w x wᵀ`.
#[derive(Clone, Debug, Default)]
struct Deflation {
    w: PackedMatrix,
    h: PackedMatrix,
}

/// Result of [`Doubling::solve`] besides the solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubled {
    /// Number of doublings.
    pub(super) count: usize,
    /// Number of doublings before the first deflation, or `count` without any.
    pub(super) patience: usize,
    /// Spectral radius of the closed loop `(I + GX)⁻¹ A`.
    pub(super) spectral_radius: f64,
}

/// Failure of the doubling to converge.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoConvergence {
    /// Number of doublings.
    pub(super) count: usize,
}

impl Doubling {
    pub(super) fn new(simd: InstructionSet) -> Self {
        let none = PackedMatrix::default;
        Self {
            simd,
            a: none(),
            g: none(),
            h: none(),
            deflations: Vec::new(),
            depth: 0,
            first: (none(), none()),
            doublings: 0,
            factors: LuFactors::default(),
            low_rank: LowRank::default(),
            transpose: none(),
            w: none(),
            v: none(),
            product: none(),
        }
    }

    /// Doubles until `A` has vanished. Does not try to deflate before `patience` doublings; this
    /// limit only saves time.
    pub(super) fn solve(&mut self, patience: usize) -> Result<Doubled, NoConvergence> {
        self.depth = 0;
        let mut first_deflation = None;
        let mut patience = patience;
        self.begin(0);
        for (doublings, count) in (1..).zip(1..=MAX_DOUBLINGS) {
            let failure = NoConvergence { count };
            let norm = self.double().ok_or(failure)?;
            if norm <= CONVERGED {
                let spectral_radius = self.spectral_radius().ok_or(failure)?;
                self.unfold();
                return if self.h.is_finite() {
                    Ok(Doubled { count, patience: first_deflation.unwrap_or(count), spectral_radius })
                } else {
                    Err(failure)
                };
            }
            if count >= patience && self.deflate_fast_modes() {
                first_deflation.get_or_insert(count);
                patience = 0;
                self.begin(doublings);
            }
        }
        Err(NoConvergence { count: MAX_DOUBLINGS })
    }

    /// Saves the equation whose spectral radius is computed in the end.
    fn begin(&mut self, doublings: i32) {
        self.first.0.copy_from(&self.a);
        self.first.1.copy_from(&self.g);
        self.doublings = doublings;
    }

    /// Factorises `I + GX`. Returns `false` if it is singular.
    fn factorise(&mut self, x: impl Fn(&Self) -> &PackedMatrix, g: impl Fn(&Self) -> &PackedMatrix) -> bool {
        let mut factors = std::mem::take(&mut self.factors);
        factors.matrix().product(self.simd, g(self), x(self));
        factors.matrix().add_to_diagonal(1.0);
        let regular = factors.factorise(self.simd);
        self.factors = factors;
        regular
    }

    /// Doubles once. Returns the new norm of `A`, or `None` if it is not finite or `I + GH` is
    /// singular.
    fn double(&mut self) -> Option<f64> {
        let simd = self.simd;
        self.w.copy_from(&self.a);
        // Without `G` this is the Stein equation, `X = H + AᵀXA`.
        if self.g.rows() > 0 {
            if !self.factorise(|this| &this.h, |this| &this.g) {
                return None;
            }
            let Self { a, g, factors, transpose, w, v, product, .. } = self;
            v.copy_from(g);
            factors.solve(simd, w);
            factors.solve(simd, v);
            transpose.transpose_from(a);
            product.product(simd, a, v);
            g.add_symmetric_product(simd, product, transpose);
        }
        let Self { a, h, w, product, .. } = self;
        product.product(simd, h, w);
        h.add_symmetric_transposed(simd, a, product);
        product.product(simd, a, w);
        std::mem::swap(a, product);
        let norm = a.norm();
        norm.is_finite().then_some(norm)
    }

    /// Deflates the equation to the remaining modes, if at most half of the modes remain in `A`.
    fn deflate_fast_modes(&mut self) -> bool {
        let simd = self.simd;
        let rows = self.a.rows();
        if rows < MIN_ROWS_TO_DEFLATE || !self.low_rank.factorise(simd, &self.a) {
            return false;
        }
        let stein = self.g.rows() == 0;
        if !stein && !self.factorise(|this| &this.h, |this| &this.g) {
            return false;
        }
        if self.deflations.len() == self.depth {
            self.deflations.push(Deflation::default());
        }
        let Self { a, g, h, factors, low_rank, w: solved, v, product, transpose: u, .. } = self;
        let deflation = &mut self.deflations[self.depth];
        let w = &mut deflation.w;
        low_rank.write_to(rows, u, w);
        solved.copy_from(u);
        if !stein {
            v.product(simd, g, w);
            factors.solve(simd, solved);
            factors.solve(simd, v);
            g.clear(w.columns(), w.columns());
            g.add_symmetric_transposed(simd, w, v);
        }
        a.transposed_product(simd, w, solved);
        product.product(simd, h, solved);
        std::mem::swap(h, &mut deflation.h);
        h.clear(w.columns(), w.columns());
        h.add_symmetric_transposed(simd, u, product);
        self.depth += 1;
        true
    }

    /// Expands the solution of the smallest equation to the solution of the largest.
    fn unfold(&mut self) {
        let Self { simd, h, deflations, depth, transpose, product, .. } = self;
        for Deflation { w, h: larger } in deflations[..*depth].iter_mut().rev() {
            transpose.transpose_from(w);
            product.product(*simd, w, h);
            std::mem::swap(h, larger);
            h.add_symmetric_product(*simd, product, transpose);
        }
    }

    /// Returns the spectral radius of the closed loop, given the solution of the smallest equation.
    fn spectral_radius(&mut self) -> Option<f64> {
        self.w.copy_from(&self.first.0);
        if self.first.1.rows() > 0 {
            if !self.factorise(|this| &this.h, |this| &this.first.1) {
                return None;
            }
            self.factors.solve(self.simd, &mut self.w);
        }
        Some((self.log_spectral_radius() * 0.5_f64.powi(self.doublings)).exp())
    }

    /// Returns the natural logarithm of the spectral radius of `self.w`, by Gelfand's formula
    /// `ρ = lim ‖Mᵗ‖^(1/t)` with `t = 1, 2, 4, …`. Unlike a Schur decomposition it always
    /// terminates.
    fn log_spectral_radius(&mut self) -> f64 {
        let Self { simd, w: matrix, product, .. } = self;
        let mut logarithm = 0.0;
        for squaring in 0..=SQUARINGS {
            let norm = matrix.norm();
            if norm < f64::MIN_POSITIVE {
                return f64::NEG_INFINITY;
            }
            logarithm += norm.ln() * 0.5_f64.powi(squaring);
            matrix.scale(norm.recip());
            product.product(*simd, matrix, matrix);
            std::mem::swap(matrix, product);
        }
        logarithm
    }
}
