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

use nalgebra::DMatrix;

use super::dense::{BlockLu, congruence, identity_plus_product, log_spectral_radius, symmetrise};

/// Doublings after which to give up. By then a closed loop whose spectral radius is the largest `f64` below one would have converged.
const MOST_DOUBLINGS: usize = 64;

/// The norm of `A` at which the doubling has converged: the next step would change `X` relatively by the square of it.
const CONVERGED: f64 = 1e-8;

/// Fewest dimensions that are worth shedding any of.
const FEWEST_TO_SHED: usize = 12;

/// After an eighth of the columns, what is left of a matrix of low rank is at most this much of it. It only saves time.
const PROMISING: f64 = 1e-2;

/// The equation `X = H + AᵀX (I + GX)⁻¹ A`, with symmetric `G` and `H`.
pub(super) struct Doubling {
    pub(super) a: DMatrix<f64>,
    /// `None` is zero: Stein's equation, `X = H + AᵀXA`.
    pub(super) g: Option<DMatrix<f64>>,
    pub(super) h: DMatrix<f64>,
    /// The doublings before which no dimension will be shed, as far as the caller knows. It only saves time.
    pub(super) patience: usize,
}

/// What [`Doubling::solve`] found.
pub(super) struct Doubled {
    pub(super) x: DMatrix<f64>,
    /// The number of doublings.
    pub(super) count: usize,
    /// The number of doublings after which the first dimensions were shed, or `count` if none ever were.
    pub(super) patience: usize,
    /// The spectral radius of `(I + GX)⁻¹ A`, the closed loop.
    pub(super) spectral_radius: f64,
}

/// The doubling did not converge.
pub(super) struct NoConvergence {
    /// The number of doublings.
    pub(super) count: usize,
}

/// An equation in which the solution of a smaller one is to be inserted: `X = h + w x wᵀ`.
struct Shed {
    w: DMatrix<f64>,
    h: DMatrix<f64>,
}

/// The closed loop of an equation to be solved, for its spectral radius.
struct ClosedLoop {
    a: DMatrix<f64>,
    g: Option<DMatrix<f64>>,
    /// The doublings that had been made when the equation was set up: `a` belongs to the closed loop to the power of two to this power.
    doublings: i32,
}

impl Doubling {
    /// Doubles until `A` has vanished.
    pub(super) fn solve(mut self) -> Result<Doubled, NoConvergence> {
        let mut shed = Vec::new();
        let mut first_shed = None;
        let mut closed_loop = self.closed_loop(0);
        let mut workspace = Workspace::new(self.a.nrows());
        for (doublings, count) in (1..).zip(1..=MOST_DOUBLINGS) {
            let failure = NoConvergence { count };
            let Some(norm) = self.double(&mut workspace) else {
                return Err(failure);
            };
            if norm <= CONVERGED {
                let Some(spectral_radius) = closed_loop.spectral_radius(&self.h) else {
                    return Err(failure);
                };
                let x = shed.into_iter().rev().fold(self.h, |x, Shed { w, h }| h + congruence(&w, &x));
                let finite = x.iter().all(|entry| entry.is_finite());
                return if finite {
                    Ok(Doubled { x, count, patience: first_shed.unwrap_or(count), spectral_radius })
                } else {
                    Err(failure)
                };
            }
            if count < self.patience {
                continue;
            }
            if let Some((w, smaller)) = self.without_quick_modes() {
                first_shed.get_or_insert(count);
                shed.push(Shed { w, h: self.h });
                self = smaller;
                closed_loop = self.closed_loop(doublings);
                workspace = Workspace::new(self.a.nrows());
            }
        }
        Err(NoConvergence { count: MOST_DOUBLINGS })
    }

    fn closed_loop(&self, doublings: i32) -> ClosedLoop {
        ClosedLoop { a: self.a.clone(), g: self.g.clone(), doublings }
    }

    /// One doubling; the new norm of `A`, or `None` if that is not finite or `I + GH` is singular.
    fn double(&mut self, workspace: &mut Workspace) -> Option<f64> {
        let size = self.a.nrows();
        let Workspace { transpose, square, right, product } = workspace;
        self.a.transpose_to(transpose);
        if let Some(g) = &mut self.g {
            // [(I + GH)⁻¹A, (I + GH)⁻¹G], and A times that.
            right.columns_mut(0, size).copy_from(&self.a);
            right.columns_mut(size, size).copy_from(g);
            BlockLu::new(identity_plus_product(g, &self.h))?.solve(right);
            product.gemm(1.0, &self.a, right, 0.0);
            square.gemm(1.0, &self.h, &right.columns(0, size), 0.0);
            g.gemm(1.0, &product.columns(size, size), transpose, 1.0);
            symmetrise(g);
            self.a.copy_from(&product.columns(0, size));
        } else {
            square.gemm(1.0, &self.h, &self.a, 0.0);
            self.a = &self.a * &self.a;
        }
        self.h.gemm(1.0, transpose, square, 1.0);
        symmetrise(&mut self.h);
        let norm = self.a.norm();
        norm.is_finite().then_some(norm)
    }

    /// If at most half of the modes are left in `A`, its right factor `W` and the equation in their dimensions.
    fn without_quick_modes(&self) -> Option<(DMatrix<f64>, Self)> {
        if self.a.nrows() < FEWEST_TO_SHED {
            return None;
        }
        let (u, w) = low_rank(&self.a)?;
        let rank = u.ncols();
        let mut right = u.clone();
        let mut g = None;
        if let Some(outer) = &self.g {
            right.resize_horizontally_mut(2 * rank, 0.0);
            right.columns_mut(rank, rank).copy_from(&(outer * &w));
            BlockLu::new(identity_plus_product(outer, &self.h))?.solve(&mut right);
            let mut inner = w.transpose() * right.columns(rank, rank);
            symmetrise(&mut inner);
            g = Some(inner);
        }
        let solved = right.columns(0, rank);
        let a = w.transpose() * solved;
        let mut h = u.transpose() * (&self.h * solved);
        symmetrise(&mut h);
        let patience = 0;
        Some((w, Self { a, g, h, patience }))
    }
}

impl ClosedLoop {
    /// The spectral radius of the original equation's closed loop, given the solution of the one that this belongs to.
    fn spectral_radius(self, x: &DMatrix<f64>) -> Option<f64> {
        let mut power = self.a;
        if let Some(g) = self.g {
            BlockLu::new(identity_plus_product(&g, x))?.solve(&mut power);
        }
        let logarithm = log_spectral_radius(power);
        Some((logarithm * 0.5_f64.powi(self.doublings)).exp())
    }
}

/// Factors `U` and `W` of `matrix = U Wᵀ` up to rounding, `U` with orthonormal columns, if at most half as many columns as the matrix
/// has are enough: Gram–Schmidt orthogonalisation that always takes the column of which most is left.
fn low_rank(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let size = matrix.ncols();
    let most = size / 2;
    let norm = matrix.norm();
    let mut rest = matrix.clone();
    let mut u = DMatrix::zeros(matrix.nrows(), most);
    let mut w = DMatrix::zeros(size, most);
    for rank in 0..=most {
        let (mut left, mut pivot, mut largest) = (0.0, 0, 0.0);
        for (index, column) in rest.column_iter().enumerate() {
            let square = column.norm_squared();
            left += square;
            if square > largest {
                (pivot, largest) = (index, square);
            }
        }
        let left = left.sqrt();
        if left <= f64::EPSILON * norm {
            return (rank > 0).then(|| (u.columns(0, rank).into_owned(), w.columns(0, rank).into_owned()));
        }
        if rank == most || (rank == size / 8 && left > PROMISING * norm) {
            return None;
        }
        let mut direction = rest.column(pivot).normalize();
        // What rounding has left of the earlier directions in the rest would show once the rest is small.
        let earlier = u.columns(0, rank);
        let overlap = earlier.tr_mul(&direction);
        direction.gemv(-1.0, &earlier, &overlap, 1.0);
        direction.normalize_mut();
        let coefficients = rest.tr_mul(&direction);
        rest.ger(-1.0, &direction, &coefficients, 1.0);
        u.set_column(rank, &direction);
        w.set_column(rank, &coefficients);
    }
    None
}

/// Room for a doubling's intermediate results.
struct Workspace {
    transpose: DMatrix<f64>,
    square: DMatrix<f64>,
    right: DMatrix<f64>,
    product: DMatrix<f64>,
}

impl Workspace {
    fn new(size: usize) -> Self {
        Self {
            transpose: DMatrix::zeros(size, size),
            square: DMatrix::zeros(size, size),
            right: DMatrix::zeros(size, 2 * size),
            product: DMatrix::zeros(size, 2 * size),
        }
    }
}
