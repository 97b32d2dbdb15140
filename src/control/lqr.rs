//! The linear-quadratic regulator.

use nalgebra::DMatrix;

use super::Controller;
use super::riccati::{Riccati, RiccatiError, RiccatiSolution};
use crate::data::Data;
use crate::derivative::{Differences, StateSpace};
use crate::error::{Error, Result};
use crate::matrix::Matrix;

/// What a deviation costs: `dxᵀ Q dx + duᵀ R du + 2 dxᵀ S du` at every step.
#[derive(Clone, Debug, PartialEq)]
pub struct LqrWeights {
    /// `(nx, nx)`, symmetric: the cost of the state.
    pub q: DMatrix<f64>,
    /// `(nu, nu)`, symmetric and positive definite: the cost of the controls.
    pub r: DMatrix<f64>,
    /// `(nx, nu)`: the cost of both together; zero if it is left out.
    pub s: Option<DMatrix<f64>>,
}

/// The linear-quadratic regulator about a set-point: `ctrl = ctrl0 − K dx`, where `dx = [qpos ⊖ qpos0; qvel; act − act0]` and
/// the difference of positions is that of [`differentiate_pos`](crate::Model::differentiate_pos), so that quaternions are
/// treated as rotations. K minimises the sum of all future costs of the linearised system (Anderson and Moore, *Optimal
/// Control: Linear Quadratic Methods*, 1990, chapter 2).
///
/// [`control`](Controller::control) allocates nothing.
///
/// ```
/// use mujoco_safe::{Controller, Data, Lqr, LqrWeights, sample};
/// use nalgebra::{DMatrix, dvector};
///
/// // The cart-pole, upright.
/// let mut data = Data::new(sample::cartpole())?;
/// let weights = LqrWeights { q: DMatrix::from_diagonal(&dvector![1.0, 10.0, 1.0, 5.0]), r: DMatrix::identity(1, 1), s: None };
/// let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
///
/// data.qpos_mut()[1] = 0.1;
/// for _ in 0..1000 {
///     lqr.control(&mut data)?;
///     data.step()?;
/// }
/// assert!(data.qpos()[1].abs() < 1e-3);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lqr {
    qpos0: Vec<f64>,
    act0: Vec<f64>,
    ctrl0: Vec<f64>,
    gain: Matrix,
    /// `dx`, so that `control` need not allocate it.
    deviation: Vec<f64>,
}

impl Lqr {
    /// The step of the finite differences with which [`at_present_state`](Self::at_present_state) linearises.
    pub const EPS: f64 = 1e-6;

    /// Linearises about the present state and controls, which become the set-point, and solves for the gain.
    ///
    /// # Errors
    ///
    /// Those of [`transition_fd`](Data::transition_fd), and [`Error::Riccati`] if there is no stabilising gain.
    pub fn at_present_state(data: &mut Data, weights: &LqrWeights) -> Result<Self> {
        let system = data.transition_fd(Self::EPS, Differences::Central)?;
        let solution = Self::solve(&system, weights)?;
        Self::with_gain(data, Matrix::from(&solution.k))
    }

    /// The solution of the Riccati equation for a linear system and weights: the gain, and how good it is.
    ///
    /// # Errors
    ///
    /// [`RiccatiError`] if there is no stabilising gain, or if shapes do not fit.
    pub fn solve(system: &StateSpace, weights: &LqrWeights) -> std::result::Result<RiccatiSolution, RiccatiError> {
        let (a, b) = (system.a.to_nalgebra(), system.b.to_nalgebra());
        let equation = Riccati::new(&a, &b, &weights.q, &weights.r);
        match &weights.s {
            None => equation.solve(),
            Some(s) => equation.with_cross_term(s).solve(),
        }
    }

    /// A regulator with a gain `(nu, 2 nv + na)` that is known, about the present position, activations and controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the gain has another shape.
    pub fn with_gain(data: &Data, gain: Matrix) -> Result<Self> {
        let model = data.model();
        let nx = 2 * model.nv() + model.na();
        Error::check_shape("the gain of an LQR", gain.shape(), (model.nu(), nx))?;
        Ok(Self {
            qpos0: data.qpos().to_vec(),
            act0: data.act().to_vec(),
            ctrl0: data.ctrl().to_vec(),
            gain,
            deviation: vec![0.0; nx],
        })
    }

    /// K, `(nu, 2 nv + na)`.
    pub fn gain(&self) -> &Matrix {
        &self.gain
    }

    /// The position of the set-point.
    pub fn qpos0(&self) -> &[f64] {
        &self.qpos0
    }

    /// The controls of the set-point.
    pub fn ctrl0(&self) -> &[f64] {
        &self.ctrl0
    }
}

impl Controller for Lqr {
    #[inline]
    fn control(&mut self, data: &mut Data) -> Result<()> {
        let model = data.model();
        let nv = model.nv();
        Error::check_length("the positions of an LQR", model.nq(), self.qpos0.len())?;
        Error::check_length("the activations of an LQR", model.na(), self.act0.len())?;
        Error::check_length("the deviation of an LQR", 2 * nv + model.na(), self.deviation.len())?;
        Error::check_length("the controls of an LQR", model.nu(), self.ctrl0.len())?;
        let (dq, rest) = self.deviation.split_at_mut(nv);
        let (dv, da) = rest.split_at_mut(nv);
        model.differentiate_pos(dq, 1.0, &self.qpos0, data.qpos())?;
        dv.copy_from_slice(data.qvel());
        for ((da, act), act0) in da.iter_mut().zip(data.act()).zip(&self.act0) {
            *da = act - act0;
        }
        let nx = self.deviation.len();
        for ((ctrl, ctrl0), row) in
            data.ctrl_mut().iter_mut().zip(&self.ctrl0).zip(self.gain.as_slice().chunks_exact(nx.max(1)))
        {
            *ctrl = ctrl0 - dot(row, &self.deviation);
        }
        Ok(())
    }
}

/// The scalar product, in four sums, which the compiler can keep in vector registers.
#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a4, a_rest), (b4, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in a4.iter().zip(b4) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums[0] + sums[1] + (sums[2] + sums[3]) + rest
}
