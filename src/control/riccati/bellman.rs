//! The Bellman backup of a linear system with quadratic costs: the cost to go before a step from
//! that after the step.

use crate::matrix::{Matrix, MatrixView};
use crate::numerics::InstructionSet;
use crate::numerics::dense::PackedMatrix;

/// Quadratic cost of a step, `dxᵀ q dx + duᵀ r du + 2 dxᵀ s du`, or twice that: the recursion is
/// the same for both. Only the symmetric parts of `q` and `r` matter.
#[derive(Clone, Copy)]
pub(in crate::control) struct StepCost<'a> {
    pub(in crate::control) q: &'a Matrix,
    pub(in crate::control) r: &'a Matrix,
    pub(in crate::control) s: Option<&'a Matrix>,
}

/// Cost to go, with the buffers of the backup.
#[derive(Clone, Debug)]
pub(in crate::control) struct BellmanBackup {
    pub(in crate::control) simd: InstructionSet,
    /// `P`, `(n, n)`: the cost to go from `dx` is `dxᵀ P dx`.
    pub(in crate::control) p: PackedMatrix,
    /// System and control cost of the present step.
    pub(in crate::control) a: PackedMatrix,
    pub(in crate::control) b: PackedMatrix,
    pub(in crate::control) r: PackedMatrix,
    /// `R + Bᵀ(P + ρI)B`, `(m, m)`: the cost of the control in this step and later.
    pub(in crate::control) uu: PackedMatrix,
    /// `Bᵀ(P + ρI)A + Sᵀ`, `(m, n)`.
    pub(in crate::control) ux: PackedMatrix,
    /// `K`, `(m, n)`.
    pub(in crate::control) k: PackedMatrix,
    s_transpose: PackedMatrix,
    pb: PackedMatrix,
    rk: PackedMatrix,
    sk: PackedMatrix,
    closed_loop: PackedMatrix,
    p_closed_loop: PackedMatrix,
}

impl BellmanBackup {
    /// Creates buffers. [`restart`](Self::restart) sets the terminal cost.
    pub(in crate::control) fn new() -> Self {
        let empty = PackedMatrix::default;
        Self {
            simd: InstructionSet::detect(),
            p: empty(),
            a: empty(),
            b: empty(),
            r: empty(),
            uu: empty(),
            ux: empty(),
            k: empty(),
            s_transpose: empty(),
            pb: empty(),
            rk: empty(),
            sk: empty(),
            closed_loop: empty(),
            p_closed_loop: empty(),
        }
    }

    /// Restarts from a terminal cost. Uses its symmetric part.
    pub(in crate::control) fn restart(&mut self, p: &Matrix) {
        self.p.copy_symmetric_part(p);
    }

    /// Computes [`uu`](Self::uu) and [`ux`](Self::ux) of a step of the system `dx⁺ = A dx + B du`.
    /// The regularisation ρ acts as an additional cost of the next state.
    pub(in crate::control) fn expand(
        &mut self,
        a: MatrixView<'_>,
        b: MatrixView<'_>,
        cost: StepCost<'_>,
        regularisation: f64,
    ) {
        let (n, m) = b.shape();
        self.a.copy_rows(n, n, a.as_slice());
        self.b.copy_rows(n, m, b.as_slice());
        self.r.copy_symmetric_part(cost.r);
        self.pb.product(self.simd, &self.p, &self.b);
        self.pb.add_scaled(&self.b, regularisation);
        self.uu.copy_from(&self.r);
        self.uu.add_symmetric_transposed(self.simd, &self.b, &self.pb);
        if let Some(s) = cost.s {
            self.s_transpose.fill(m, n, |row, column| s[(column, row)]);
            self.ux.copy_from(&self.s_transpose);
        } else {
            self.ux.clear(m, n);
        }
        self.ux.add_transposed_product(self.simd, &self.pb, &self.a);
    }

    /// Replaces `P` by the cost to go before the step under the control `du = −K dx`, for any
    /// [`k`](Self::k):
    ///
    /// ```text
    /// P ← (A − BK)ᵀ P (A − BK) + KᵀRK − SK − KᵀSᵀ + Q
    /// ```
    ///
    /// For the optimal K this equals the Riccati recursion, without its difference of large terms.
    pub(in crate::control) fn close(&mut self, cost: StepCost<'_>) {
        self.closed_loop.copy_from(&self.a);
        self.closed_loop.subtract_product(self.simd, &self.b, &self.k);
        self.p_closed_loop.product(self.simd, &self.p, &self.closed_loop);
        self.rk.product(self.simd, &self.r, &self.k);
        self.p.copy_symmetric_part(cost.q);
        self.p.add_symmetric_transposed(self.simd, &self.closed_loop, &self.p_closed_loop);
        self.p.add_symmetric_transposed(self.simd, &self.k, &self.rk);
        if cost.s.is_some() {
            self.sk.transposed_product(self.simd, &self.s_transpose, &self.k);
            self.sk.symmetrise();
            self.p.add_scaled(&self.sk, -2.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::{BellmanBackup, StepCost};
    use crate::matrix::Matrix;
    use crate::numerics::dense::PackedMatrix;

    fn assert_equal(found: &PackedMatrix, expected: &DMatrix<f64>) {
        let error = (found.to_matrix(|_, _| 1.0) - expected).norm() / expected.norm();
        assert!(error < 1e-13, "relative error {error:e}");
    }

    /// The sizes are below, at and above multiples of the block of the kernels; the last are the
    /// sizes of the humanoid.
    #[test]
    fn a_backup_equals_its_definition() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut matrix =
            |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| random.random::<f64>() - 0.5);
        for (n, m) in [(1, 1), (4, 2), (8, 8), (17, 9), (54, 21)] {
            let (p, a, b, k) = (matrix(n, n), matrix(n, n), matrix(n, m), matrix(m, n));
            let (q, r, s) = (matrix(n, n), matrix(m, m), matrix(n, m));
            let symmetric = |matrix: &DMatrix<f64>| (matrix + matrix.transpose()) * 0.5;
            for (s, regularisation) in [(None, 0.0), (Some(&s), 0.0), (Some(&s), 0.7)] {
                let (row_major_q, row_major_r, row_major_s) = (Matrix::from(&q), Matrix::from(&r), s.map(Matrix::from));
                let cost = StepCost { q: &row_major_q, r: &row_major_r, s: row_major_s.as_ref() };
                let cross = s.cloned().unwrap_or_else(|| DMatrix::zeros(n, m));
                let mut backup = BellmanBackup::new();
                backup.restart(&Matrix::from(&p));
                backup.expand(Matrix::from(&a).view(), Matrix::from(&b).view(), cost, regularisation);
                let regularised = symmetric(&p) + DMatrix::identity(n, n) * regularisation;
                assert_equal(&backup.uu, &(symmetric(&r) + b.transpose() * &regularised * &b));
                assert_equal(&backup.ux, &(b.transpose() * &regularised * &a + cross.transpose()));

                backup.k.copy_rows(m, n, Matrix::from(&k).as_slice());
                backup.close(cost);
                let closed = &a - &b * &k;
                let sk = &cross * &k;
                let expected = closed.transpose() * symmetric(&p) * &closed + k.transpose() * symmetric(&r) * &k
                    - (&sk + sk.transpose())
                    + symmetric(&q);
                assert_equal(&backup.p, &expected);
                let next = backup.p.to_matrix(|_, _| 1.0);
                assert_eq!(next, next.transpose());

                let (vector, mut sums) = (matrix(m, 1), DVector::from_element(n, 1.0));
                backup.k.add_transposed_times(backup.simd, vector.as_slice(), sums.as_mut_slice());
                assert!((sums - (k.transpose() * vector).add_scalar(1.0)).norm() < 1e-13);
            }
        }
    }
}
