//! The regulator over a finite number of steps.

use nalgebra::{Cholesky, DMatrix, DMatrixView, Dyn};

use super::backup::{Backup, StepCost, symmetrise};
use super::problem::smallest_eigenvalue;
use super::{RiccatiError, RiccatiMatrix, check, check_symmetric};
use crate::control::LqrWeights;

/// The Riccati recursion: the best controls of a linear system over a finite number of steps, found from the last step to the
/// first (Bertsekas, *Dynamic Programming and Optimal Control*, volume I, section 4.1). Both the system and the weights may be
/// others in each step.
///
/// With the cost `dxᵀPdx` of where it ends and the cost `dxᵀQdx + duᵀRdu + 2dxᵀSdu` of each step,
/// [`step_back`](Self::step_back) finds the gain of the step before, `du = −K dx`, and the cost to go from there.
///
/// ```
/// use mujoco_safe::LqrWeights;
/// use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiRecursion};
/// use nalgebra::{DMatrix, dmatrix, matrix, vector};
///
/// // A mass of 1 kg pushed by a force for 0.1 s at a time: position (m), velocity (m/s). Only where it ends is of interest.
/// let (a, b) = (matrix![1.0, 0.1; 0.0, 1.0], vector![0.005, 0.1]);
/// let weights = LqrWeights::diagonal(&[0.0, 0.0], &[1e-3]);
/// let mut recursion = RiccatiRecursion::new(&DMatrix::identity(2, 2), 1)?;
/// for _ in 0..20 {
///     recursion.step_back(&a, &b, &weights)?;
/// }
/// // From 1 m off and at rest, with two seconds to go, it costs little to be there in the end.
/// assert!(recursion.p()[(0, 0)] < 0.02);
///
/// // With as much time as it likes, a system under constant weights has a constant gain.
/// let weights = LqrWeights::diagonal(&[1.0, 1.0], &[1.0]);
/// for _ in 0..1000 {
///     recursion.step_back(&a, &b, &weights)?;
/// }
/// let forever = Riccati::new(&a, &b, &weights.q, &weights.r).solve()?;
/// assert!((recursion.k() - forever.k).norm() < 1e-12);
/// # Ok::<(), RiccatiError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RiccatiRecursion {
    backup: Backup,
    k: DMatrix<f64>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
}

impl RiccatiRecursion {
    /// Begins at the end, where the cost is `dxᵀPdx`: `terminal` is P, `(n, n)` and symmetric.
    ///
    /// # Errors
    ///
    /// [`WrongShape`](RiccatiError::WrongShape), [`NotFinite`](RiccatiError::NotFinite) and
    /// [`NotSymmetric`](RiccatiError::NotSymmetric) of the matrix [`P`](RiccatiMatrix::P).
    pub fn new<'a>(terminal: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>, controls: usize) -> Result<Self, RiccatiError> {
        let terminal = terminal.into();
        let n = terminal.nrows();
        let p = symmetric(RiccatiMatrix::P, &terminal, n)?;
        Ok(Self {
            backup: Backup::new(p, controls),
            k: DMatrix::zeros(controls, n),
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, controls),
        })
    }

    /// Takes one step back in time, in which the system is `dx⁺ = A dx + B du`, and returns the gain K of that step, `(m, n)`.
    ///
    /// `Q` and `R` stand for their symmetric parts, as in [`Riccati`](super::Riccati).
    ///
    /// # Errors
    ///
    /// * [`WrongShape`](RiccatiError::WrongShape), [`NotFinite`](RiccatiError::NotFinite),
    ///   [`NotSymmetric`](RiccatiError::NotSymmetric): the first matrix at fault is named.
    /// * [`NoLeastCost`](RiccatiError::NoLeastCost): no control is best, as some other is always better.
    ///
    /// After an error all is as before the step.
    pub fn step_back<'a>(
        &mut self,
        a: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
        b: impl Into<DMatrixView<'a, f64, Dyn, Dyn>>,
        weights: &LqrWeights,
    ) -> Result<&DMatrix<f64>, RiccatiError> {
        let (a, b) = (a.into(), b.into());
        let (m, n) = self.k.shape();
        check(RiccatiMatrix::A, &a, (n, n))?;
        check(RiccatiMatrix::B, &b, (n, m))?;
        let q = symmetric(RiccatiMatrix::Q, &(&weights.q).into(), n)?;
        let r = symmetric(RiccatiMatrix::R, &(&weights.r).into(), m)?;
        if let Some(s) = &weights.s {
            check(RiccatiMatrix::S, &s.into(), (n, m))?;
        }
        self.a.copy_from(&a);
        self.b.copy_from(&b);
        let cost = StepCost { q: &q, r: &r, s: weights.s.as_ref() };
        self.backup.expand(&self.a, &self.b, cost);
        let Some(cholesky) = Cholesky::new(self.backup.uu.clone()) else {
            return Err(RiccatiError::NoLeastCost { smallest_eigenvalue: smallest_eigenvalue(self.backup.uu.clone()) });
        };
        self.k.copy_from(&self.backup.ux);
        cholesky.solve_mut(&mut self.k);
        self.backup.close(&self.a, &self.b, cost, &self.k);
        Ok(&self.k)
    }

    /// The gain K of the step that was taken last, `(m, n)`; zeros before the first.
    pub fn k(&self) -> &DMatrix<f64> {
        &self.k
    }

    /// The cost to go P, `(n, n)`, symmetric to the last bit: from `dx` it is `dxᵀPdx`.
    pub fn p(&self) -> &DMatrix<f64> {
        &self.backup.p
    }
}

/// The symmetric part of a weight of so many rows and columns, if that is the weight up to rounding.
fn symmetric(
    matrix: RiccatiMatrix,
    weight: &DMatrixView<'_, f64, Dyn, Dyn>,
    size: usize,
) -> Result<DMatrix<f64>, RiccatiError> {
    check(matrix, weight, (size, size))?;
    check_symmetric(matrix, weight)?;
    let mut weight = weight.clone_owned();
    symmetrise(&mut weight);
    Ok(weight)
}
