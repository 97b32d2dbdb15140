//! The linear-quadratic regulator about a set-point.

use super::feedback::Feedback;
use super::riccati::{Riccati, RiccatiError, RiccatiSolution};
use super::weights::LqrWeights;
use crate::controller::Controller;
use crate::data::Data;
use crate::derivative::{self, Lineariser, StateSpace, TransitionOptions, TransitionOutputs};
use crate::error::{Error, Result};
use crate::matrix::Matrix;

/// Linear-quadratic regulator about a set-point: `ctrl = ctrl0 − K dx` with
/// `dx = [qpos ⊖ qpos0; qvel; act − act0]`.
///
/// The difference of positions is computed by
/// [`differentiate_pos_into`](crate::Model::differentiate_pos_into), which treats quaternions as
/// rotations. K minimises the sum of all future costs of the linearised system (Anderson and Moore,
/// *Optimal Control: Linear Quadratic Methods*, 1990, chapter 2).
///
/// [`control`](Controller::control) allocates nothing.
///
/// ```
/// use mujoco_safe::{Controller, Data, Lqr, LqrWeights, sample};
///
/// // The cart-pole, upright.
/// let mut data = Data::new(sample::cartpole())?;
/// let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
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
    feedback: Feedback,
}

impl Lqr {
    /// Recommended step of central differences if [`Data::transition_fd`] computes the system of a
    /// regulator.
    pub const EPS: f64 = 1e-6;

    /// Linearises about the present state and controls, which become the set-point, and solves for
    /// the gain.
    ///
    /// The method of linearisation is the default of [`TransitionOptions`]. The state of `data`
    /// does not change. To use another method, or to avoid allocating a [`Lineariser`], combine
    /// [`solve`](Self::solve) and [`with_gain`](Self::with_gain).
    ///
    /// # Errors
    ///
    /// The errors of [`Lineariser::linear_system_into`], and [`Error::Solver`] with a
    /// [`RiccatiError`] if there is no stabilising gain.
    #[doc(alias = "dlqr")]
    pub fn at_present_state(data: &mut Data, weights: &LqrWeights) -> Result<Self> {
        let mut system = StateSpace::zeros(data.model());
        // The regulator does not use the sensors.
        let outputs = TransitionOutputs { a: Some(&mut system.a), b: Some(&mut system.b), ..Default::default() };
        Lineariser::new(data.model().clone(), TransitionOptions::default())?.linear_system_into(data, outputs)?;
        let solution = Self::solve(&system, weights)?;
        Self::with_gain(data, solution.k)
    }

    /// Solves the Riccati equation for a linear system and weights. The solution contains the gain
    /// and measures of its quality.
    ///
    /// # Errors
    ///
    /// [`RiccatiError`] if there is no stabilising gain, or if shapes do not match.
    pub fn solve(system: &StateSpace, weights: &LqrWeights) -> Result<RiccatiSolution, RiccatiError> {
        let equation = Riccati::new(&system.a, &system.b, &weights.q, &weights.r);
        match &weights.s {
            None => equation.solve(),
            Some(s) => equation.with_cross_term(s).solve(),
        }
    }

    /// Creates a regulator with a given gain `(nu, 2 nv + na)` about the present position,
    /// activations and controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] if the gain has another shape.
    pub fn with_gain(data: &Data, gain: Matrix) -> Result<Self> {
        let (nx, nu, _) = derivative::sizes(data.model());
        Error::check_shape("the gain of an LQR", gain.shape(), (nu, nx))?;
        Ok(Self {
            qpos0: data.qpos().to_vec(),
            act0: data.act().to_vec(),
            ctrl0: data.ctrl().to_vec(),
            gain,
            feedback: Feedback::new(nx),
        })
    }

    /// Returns the gain K, `(nu, 2 nv + na)`.
    pub fn gain(&self) -> &Matrix {
        &self.gain
    }

    /// Returns the positions of the set-point.
    pub fn qpos0(&self) -> &[f64] {
        &self.qpos0
    }

    /// Returns the activations of the set-point.
    pub fn act0(&self) -> &[f64] {
        &self.act0
    }

    /// Returns the controls of the set-point.
    pub fn ctrl0(&self) -> &[f64] {
        &self.ctrl0
    }
}

impl Controller for Lqr {
    #[inline]
    fn control(&mut self, data: &mut Data) -> Result<()> {
        Error::check_length("the controls of an LQR", data.model().nu(), self.ctrl0.len())?;
        self.feedback.measure(data, &self.qpos0, None, &self.act0)?;
        let ctrl = data.ctrl_mut();
        ctrl.copy_from_slice(&self.ctrl0);
        self.feedback.subtract(&self.gain, ctrl);
        Ok(())
    }
}
