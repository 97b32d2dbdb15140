//! The Riccati recursion over a finite number of steps.

use nalgebra::Cholesky;

use super::bellman::{BellmanBackup, StepCost};
use super::problem::smallest_eigenvalue;
use super::{RiccatiError, RiccatiMatrix, check, check_symmetric};
use crate::control::LqrWeights;
use crate::matrix::{Matrix, StridedView};
use crate::numerics::linear_algebra::symmetrise;

/// Riccati recursion: the optimal gains of a linear system over a finite number of steps, from the
/// last step to the first (Bertsekas, *Dynamic Programming and Optimal Control*, volume I, section
/// 4.1). The system and the weights may vary from step to step.
///
/// With the terminal cost `dxᵀPdx` and the cost `dxᵀQdx + duᵀRdu + 2dxᵀSdu` of each step,
/// [`step_back`](Self::step_back) computes the gain of the preceding step, `du = −K dx`, and its
/// cost to go.
///
/// ```
/// use mujoco_safe::{LqrWeights, Matrix};
/// use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiRecursion};
/// use mujoco_safe::nalgebra::{Matrix2, Vector2};
///
/// // A mass of 1 kg under a force, in steps of 0.1 s: position (m), velocity (m/s). Only the final state has a cost.
/// let (a, b) = (Matrix2::new(1.0, 0.1, 0.0, 1.0), Vector2::new(0.005, 0.1));
/// let weights = LqrWeights::diagonal(&[0.0, 0.0], &[1e-3]);
/// let mut recursion = RiccatiRecursion::new(&Matrix::identity(2), 1)?;
/// for _ in 0..20 {
///     recursion.step_back(&a, &b, &weights)?;
/// }
/// // From 1 m and at rest, two seconds suffice to reach the target at a small cost.
/// assert!(recursion.p()[(0, 0)] < 0.02);
///
/// // Far from the end, constant weights yield a constant gain.
/// let weights = LqrWeights::diagonal(&[1.0, 1.0], &[1.0]);
/// for _ in 0..1000 {
///     recursion.step_back(&a, &b, &weights)?;
/// }
/// let stationary = Riccati::new(&a, &b, &weights.q, &weights.r).solve()?;
/// assert!((recursion.k().to_nalgebra() - stationary.k.to_nalgebra()).norm() < 1e-12);
/// # Ok::<(), RiccatiError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RiccatiRecursion {
    backup: BellmanBackup,
    p: Matrix,
    k: Matrix,
}

impl RiccatiRecursion {
    /// Creates a recursion from the terminal cost `dxᵀPdx`: `terminal` is P, `(n, n)` and
    /// symmetric.
    ///
    /// # Errors
    ///
    /// [`WrongShape`](RiccatiError::WrongShape), [`NotFinite`](RiccatiError::NotFinite) and
    /// [`NotSymmetric`](RiccatiError::NotSymmetric) for the matrix [`P`](RiccatiMatrix::P).
    pub fn new<'a>(terminal: impl Into<StridedView<'a>>, controls: usize) -> Result<Self, RiccatiError> {
        let terminal = terminal.into();
        let (n, _) = terminal.shape();
        let p = symmetric(RiccatiMatrix::P, &terminal, n)?;
        let mut backup = BellmanBackup::new();
        backup.restart(&p);
        Ok(Self { backup, p, k: Matrix::zeros(controls, n) })
    }

    /// Steps back in time over a step of the system `dx⁺ = A dx + B du`, and returns the gain K of
    /// that step, `(m, n)`.
    ///
    /// Uses the symmetric parts of `Q` and `R`, as [`Riccati`](super::Riccati) does.
    ///
    /// # Errors
    ///
    /// * [`WrongShape`](RiccatiError::WrongShape), [`NotFinite`](RiccatiError::NotFinite),
    ///   [`NotSymmetric`](RiccatiError::NotSymmetric): names the first offending matrix.
    /// * [`NoLeastCost`](RiccatiError::NoLeastCost): the cost has no minimum.
    ///
    /// After an error the recursion is unchanged.
    pub fn step_back<'a>(
        &mut self,
        a: impl Into<StridedView<'a>>,
        b: impl Into<StridedView<'a>>,
        weights: &LqrWeights,
    ) -> Result<&Matrix, RiccatiError> {
        let (a, b) = (a.into(), b.into());
        let (m, n) = self.k.shape();
        check(RiccatiMatrix::A, &a, (n, n))?;
        check(RiccatiMatrix::B, &b, (n, m))?;
        let q = symmetric(RiccatiMatrix::Q, &(&weights.q).into(), n)?;
        let r = symmetric(RiccatiMatrix::R, &(&weights.r).into(), m)?;
        if let Some(s) = &weights.s {
            check(RiccatiMatrix::S, &s.into(), (n, m))?;
        }
        let cost = StepCost { q: &q, r: &r, s: weights.s.as_ref() };
        let backup = &mut self.backup;
        backup.expand(a.to_matrix().view(), b.to_matrix().view(), cost, 0.0);
        let uu = backup.uu.to_matrix(|_, _| 1.0);
        let Some(cholesky) = Cholesky::new(uu.clone()) else {
            return Err(RiccatiError::NoLeastCost { smallest_eigenvalue: smallest_eigenvalue(uu) });
        };
        self.k = cholesky.solve(&backup.ux.to_matrix(|_, _| 1.0)).into();
        backup.k.copy_view(&(&self.k).into());
        backup.close(cost);
        backup.p.write_to(&mut self.p, |_, _| 1.0);
        Ok(&self.k)
    }

    /// Returns the gain K of the most recent step, `(m, n)`; zeros before the first.
    pub fn k(&self) -> &Matrix {
        &self.k
    }

    /// Returns the cost to go P, `(n, n)`, symmetric to the last bit: the cost from `dx` is
    /// `dxᵀPdx`.
    pub fn p(&self) -> &Matrix {
        &self.p
    }
}

/// Returns the symmetric part of a weight `(size, size)`, if the weight is symmetric up to
/// rounding.
fn symmetric(matrix: RiccatiMatrix, weight: &StridedView<'_>, size: usize) -> Result<Matrix, RiccatiError> {
    check(matrix, weight, (size, size))?;
    check_symmetric(matrix, weight)?;
    let mut weight = weight.to_matrix();
    symmetrise(&mut weight);
    Ok(weight)
}
