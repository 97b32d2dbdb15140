//! The Bellman backup of a linear system with quadratic costs: the cost to go before a step from that after the step.

use nalgebra::DMatrix;

/// Quadratic cost of a step, `dxᵀ q dx + duᵀ r du + 2 dxᵀ s du`, or twice that: the recursion is the same for both.
#[derive(Clone, Copy)]
pub(in crate::control) struct StepCost<'a> {
    pub(in crate::control) q: &'a DMatrix<f64>,
    pub(in crate::control) r: &'a DMatrix<f64>,
    pub(in crate::control) s: Option<&'a DMatrix<f64>>,
}

/// Cost to go, with the buffers of the backup.
#[derive(Clone, Debug)]
pub(in crate::control) struct BellmanBackup {
    /// `P`, `(n, n)`: the cost to go from `dx` is `dxᵀ P dx`.
    pub(in crate::control) p: DMatrix<f64>,
    /// `R + BᵀPB`, `(m, m)`: the cost of the control in this step and later.
    pub(in crate::control) uu: DMatrix<f64>,
    /// `BᵀPA + Sᵀ`, `(m, n)`.
    pub(in crate::control) ux: DMatrix<f64>,
    b_transpose: DMatrix<f64>,
    pa: DMatrix<f64>,
    pb: DMatrix<f64>,
    rk: DMatrix<f64>,
    k_transpose: DMatrix<f64>,
    closed_loop: DMatrix<f64>,
    closed_loop_transpose: DMatrix<f64>,
}

impl BellmanBackup {
    /// Starts from the terminal cost, which must be symmetric.
    pub(in crate::control) fn new(p: DMatrix<f64>, controls: usize) -> Self {
        let (n, m) = (p.nrows(), controls);
        let zeros = DMatrix::zeros;
        Self {
            p,
            uu: zeros(m, m),
            ux: zeros(m, n),
            b_transpose: zeros(m, n),
            pa: zeros(n, n),
            pb: zeros(n, m),
            rk: zeros(m, n),
            k_transpose: zeros(n, m),
            closed_loop: zeros(n, n),
            closed_loop_transpose: zeros(n, n),
        }
    }

    /// Restarts from another terminal cost of the same shape, without allocating.
    pub(in crate::control) fn reset(&mut self, p: &DMatrix<f64>) {
        self.p.copy_from(p);
    }

    /// Computes [`uu`](Self::uu) and [`ux`](Self::ux) of a step.
    pub(in crate::control) fn expand(&mut self, a: &DMatrix<f64>, b: &DMatrix<f64>, cost: StepCost<'_>) {
        b.transpose_to(&mut self.b_transpose);
        self.pa.gemm(1.0, &self.p, a, 0.0);
        self.pb.gemm(1.0, &self.p, b, 0.0);
        self.uu.copy_from(cost.r);
        self.uu.gemm(1.0, &self.b_transpose, &self.pb, 1.0);
        symmetrise(&mut self.uu);
        match cost.s {
            Some(s) => s.transpose_to(&mut self.ux),
            None => self.ux.fill(0.0),
        }
        self.ux.gemm(1.0, &self.b_transpose, &self.pa, 1.0);
    }

    /// Replaces `P` by the cost to go before the step under the control `du = −K dx`, for any K:
    ///
    /// ```text
    /// P ← (A − BK)ᵀ P (A − BK) + KᵀRK − SK − KᵀSᵀ + Q
    /// ```
    ///
    /// For the optimal K this equals the Riccati recursion, without its difference of large terms.
    pub(in crate::control) fn close(
        &mut self,
        a: &DMatrix<f64>,
        b: &DMatrix<f64>,
        cost: StepCost<'_>,
        k: &DMatrix<f64>,
    ) {
        self.closed_loop.copy_from(a);
        self.closed_loop.gemm(-1.0, b, k, 1.0);
        self.closed_loop.transpose_to(&mut self.closed_loop_transpose);
        k.transpose_to(&mut self.k_transpose);
        self.rk.gemm(1.0, cost.r, k, 0.0);
        self.pa.gemm(1.0, &self.p, &self.closed_loop, 0.0);
        self.p.copy_from(cost.q);
        self.p.gemm(1.0, &self.closed_loop_transpose, &self.pa, 1.0);
        self.p.gemm(1.0, &self.k_transpose, &self.rk, 1.0);
        if let Some(s) = cost.s {
            self.p.gemm(-2.0, s, k, 1.0); // symmetrised below
        }
        symmetrise(&mut self.p);
    }
}

/// Replaces `matrix` by its symmetric part, `(M + Mᵀ) / 2`.
pub(super) fn symmetrise(matrix: &mut DMatrix<f64>) {
    for column in 0..matrix.ncols() {
        for row in 0..column {
            let mean = 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
            matrix[(row, column)] = mean;
            matrix[(column, row)] = mean;
        }
    }
}
