//! The doubling iteration, and how it sheds dimensions on the way.
//!
//! The equation here is `X = H + AᵀX (I + GX)⁻¹ A`. Doubling replaces it by another of the same kind with the same solution, and as `A`
//! becomes a higher and higher power of the closed loop, its quick modes vanish below rounding. Then `A = U Wᵀ` with few columns in
//! `U` and `W`, and the equation says that `X = H + W x Wᵀ` for some small `x`. Inserting this, with `M = I + GH`,
//!
//! ```text
//! x = UᵀX (I + GX)⁻¹ U
//!   = UᵀHM⁻¹U + (WᵀM⁻¹U)ᵀ x (I + WᵀM⁻¹GW x)⁻¹ (WᵀM⁻¹U)
//! ```
//!
//! by the Sherman–Morrison–Woodbury formula: an equation of the same kind again, in as many dimensions as slow modes are left, whose closed loop has
//! just the eigenvalues that are left. The slow modes, which are what needs many doublings, no longer pay for the quick ones.

use super::factors::Factors;
use super::lanes::Processor;
use super::low_rank::LowRank;
use super::panels::Panels;

/// Doublings after which to give up. By then a closed loop whose spectral radius is the largest `f64` below one would have converged.
const MOST_DOUBLINGS: usize = 64;

/// The norm of `A` at which the doubling has converged: the next step would change `X` relatively by the square of it.
const CONVERGED: f64 = 1e-8;

/// Fewest dimensions that are worth shedding any of.
const FEWEST_TO_SHED: usize = 12;

/// Squarings in [`Doubling::log_spectral_radius`]: the last one weighs 2⁻⁵², an `f64`'s resolution.
const SQUARINGS: i32 = 52;

/// The equation `X = H + AᵀX (I + GX)⁻¹ A`, with symmetric `G` and `H`, to be filled in, and room to solve it.
#[derive(Clone, Debug)]
pub(super) struct Doubling {
    processor: Processor,
    pub(super) a: Panels,
    pub(super) g: Panels,
    /// And then the solution.
    pub(super) h: Panels,
    /// Equations in which the solution of a smaller one is to be inserted, `depth` of them.
    shed: Vec<Shed>,
    depth: usize,
    /// `A` and `G` of the equation that is being solved, as it was before its first doubling.
    first: (Panels, Panels),
    /// The doublings that had been made by then.
    doublings: i32,
    factors: Factors,
    low_rank: LowRank,
    transpose: Panels,
    w: Panels,
    v: Panels,
    product: Panels,
}

/// `X = h + w x wᵀ`
#[derive(Clone, Debug, Default)]
struct Shed {
    w: Panels,
    h: Panels,
}

/// What [`Doubling::solve`] found out about the equation besides its solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubled {
    /// The number of doublings.
    pub(super) count: usize,
    /// The number of doublings after which the first dimensions were shed, or `count` if none ever were.
    pub(super) patience: usize,
    /// The spectral radius of `(I + GX)⁻¹ A`, the closed loop.
    pub(super) spectral_radius: f64,
}

/// The doubling did not converge.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoConvergence {
    /// The number of doublings.
    pub(super) count: usize,
}

impl Doubling {
    pub(super) fn new(processor: Processor) -> Self {
        let none = Panels::default;
        Self {
            processor,
            a: none(),
            g: none(),
            h: none(),
            shed: Vec::new(),
            depth: 0,
            first: (none(), none()),
            doublings: 0,
            factors: Factors::default(),
            low_rank: LowRank::default(),
            transpose: none(),
            w: none(),
            v: none(),
            product: none(),
        }
    }

    /// Doubles until `A` has vanished. Expects nothing to be shed before `patience` doublings, which only saves time.
    pub(super) fn solve(&mut self, patience: usize) -> Result<Doubled, NoConvergence> {
        self.depth = 0;
        let mut first_shed = None;
        let mut patience = patience;
        self.begin(0);
        for (doublings, count) in (1..).zip(1..=MOST_DOUBLINGS) {
            let failure = NoConvergence { count };
            let norm = self.double().ok_or(failure)?;
            if norm <= CONVERGED {
                let spectral_radius = self.spectral_radius().ok_or(failure)?;
                self.unfold();
                return if self.h.is_finite() {
                    Ok(Doubled { count, patience: first_shed.unwrap_or(count), spectral_radius })
                } else {
                    Err(failure)
                };
            }
            if count >= patience && self.shed_quick_modes() {
                first_shed.get_or_insert(count);
                patience = 0;
                self.begin(doublings);
            }
        }
        Err(NoConvergence { count: MOST_DOUBLINGS })
    }

    fn begin(&mut self, doublings: i32) {
        self.first.0.copy_from(&self.a);
        self.first.1.copy_from(&self.g);
        self.doublings = doublings;
    }

    /// Factorises `I + GX`; false if it is singular.
    fn factorise(&mut self, x: impl Fn(&Self) -> &Panels, g: impl Fn(&Self) -> &Panels) -> bool {
        let mut factors = std::mem::take(&mut self.factors);
        factors.matrix().product(self.processor, g(self), x(self));
        factors.matrix().add_to_diagonal(1.0);
        let regular = factors.factorise(self.processor);
        self.factors = factors;
        regular
    }

    /// One doubling; the new norm of `A`, or `None` if that is not finite or `I + GH` is singular.
    fn double(&mut self) -> Option<f64> {
        let processor = self.processor;
        self.w.copy_from(&self.a);
        // Without `G` this is Stein's equation, `X = H + AᵀXA`.
        if self.g.rows() > 0 {
            if !self.factorise(|this| &this.h, |this| &this.g) {
                return None;
            }
            let Self { a, g, factors, transpose, w, v, product, .. } = self;
            v.copy_from(g);
            factors.solve(processor, w);
            factors.solve(processor, v);
            transpose.transpose_from(a);
            product.product(processor, a, v);
            g.add_symmetric_product(processor, product, transpose);
        }
        let Self { a, h, w, product, .. } = self;
        product.product(processor, h, w);
        h.add_symmetric_transposed(processor, a, product);
        product.product(processor, a, w);
        std::mem::swap(a, product);
        let norm = a.norm();
        norm.is_finite().then_some(norm)
    }

    /// If at most half of the modes are left in `A`, goes over to the equation in their dimensions.
    fn shed_quick_modes(&mut self) -> bool {
        let processor = self.processor;
        let rows = self.a.rows();
        if rows < FEWEST_TO_SHED || !self.low_rank.factorise(processor, &self.a) {
            return false;
        }
        let stein = self.g.rows() == 0;
        if !stein && !self.factorise(|this| &this.h, |this| &this.g) {
            return false;
        }
        if self.shed.len() == self.depth {
            self.shed.push(Shed::default());
        }
        let Self { a, g, h, factors, low_rank, w: solved, v, product, transpose: u, .. } = self;
        let shed = &mut self.shed[self.depth];
        let w = &mut shed.w;
        low_rank.write_to(rows, u, w);
        solved.copy_from(u);
        if !stein {
            v.product(processor, g, w);
            factors.solve(processor, solved);
            factors.solve(processor, v);
            g.clear(w.columns(), w.columns());
            g.add_symmetric_transposed(processor, w, v);
        }
        a.transposed_product(processor, w, solved);
        product.product(processor, h, solved);
        std::mem::swap(h, &mut shed.h);
        h.clear(w.columns(), w.columns());
        h.add_symmetric_transposed(processor, u, product);
        self.depth += 1;
        true
    }

    /// Inserts the solution of the smallest equation in the one that it comes from, and so on.
    fn unfold(&mut self) {
        let Self { processor, h, shed, depth, transpose, product, .. } = self;
        for Shed { w, h: larger } in shed[..*depth].iter_mut().rev() {
            transpose.transpose_from(w);
            product.product(*processor, w, h);
            std::mem::swap(h, larger);
            h.add_symmetric_product(*processor, product, transpose);
        }
    }

    /// The spectral radius of the closed loop, given the solution of the smallest equation.
    fn spectral_radius(&mut self) -> Option<f64> {
        self.w.copy_from(&self.first.0);
        if self.first.1.rows() > 0 {
            if !self.factorise(|this| &this.h, |this| &this.first.1) {
                return None;
            }
            self.factors.solve(self.processor, &mut self.w);
        }
        Some((self.log_spectral_radius() * 0.5_f64.powi(self.doublings)).exp())
    }

    /// The natural logarithm of the largest modulus among the eigenvalues of `self.w`, by Gelfand's formula
    /// `ρ = lim ‖Mᵗ‖^(1/t)` with `t = 1, 2, 4, …`. Unlike a Schur decomposition it always ends.
    fn log_spectral_radius(&mut self) -> f64 {
        let Self { processor, w: matrix, product, .. } = self;
        let mut logarithm = 0.0;
        for squaring in 0..=SQUARINGS {
            let norm = matrix.norm();
            if norm < f64::MIN_POSITIVE {
                return f64::NEG_INFINITY;
            }
            logarithm += norm.ln() * 0.5_f64.powi(squaring);
            matrix.scale(norm.recip());
            product.product(*processor, matrix, matrix);
            std::mem::swap(matrix, product);
        }
        logarithm
    }
}
