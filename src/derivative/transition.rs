//! How a step of the simulation depends on the state and the controls.

use std::ptr;

use mujoco_sys::{guard, mjSENS_CLOCK};

use super::method::Step;
use super::perturbation::{Input, sides};
use super::{Differences, check_eps};
use crate::data::{Computed, Data};
use crate::enums::Integrator;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// A linear system in discrete time, `dx' = A dx + B du`, `dy = C dx + D du`, of `nx = 2 nv + na` states, `nu` controls and
/// `nsensordata` outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// `(nx, nx)`: the next state by the state.
    pub a: Matrix,
    /// `(nx, nu)`: the next state by the controls.
    pub b: Matrix,
    /// `(nsensordata, nx)`: the sensors by the state.
    pub c: Matrix,
    /// `(nsensordata, nu)`: the sensors by the controls.
    pub d: Matrix,
}

impl StateSpace {
    /// Zeros, in the shapes that belong to a model.
    pub fn zeros(model: &Model) -> Self {
        let (nx, nu, ny) = sizes(model);
        Self { a: Matrix::zeros(nx, nx), b: Matrix::zeros(nx, nu), c: Matrix::zeros(ny, nx), d: Matrix::zeros(ny, nu) }
    }
}

/// Where [`Data::transition_fd_into`] writes to. What is `None` is not computed; without C and D the sensors are skipped.
#[derive(Debug, Default)]
pub struct TransitionOutputs<'a> {
    /// `(nx, nx)`
    pub a: Option<&'a mut Matrix>,
    /// `(nx, nu)`
    pub b: Option<&'a mut Matrix>,
    /// `(nsensordata, nx)`
    pub c: Option<&'a mut Matrix>,
    /// `(nsensordata, nu)`
    pub d: Option<&'a mut Matrix>,
}

impl<'a> From<&'a mut StateSpace> for TransitionOutputs<'a> {
    fn from(system: &'a mut StateSpace) -> Self {
        Self { a: Some(&mut system.a), b: Some(&mut system.b), c: Some(&mut system.c), d: Some(&mut system.d) }
    }
}

impl Data {
    /// Linearises a step of the simulation about the present state and controls, with the step `eps` of the differences;
    /// `1e-6` with [`Differences::Central`] is a good choice.
    ///
    /// (The engine's own central differences of the sensors by the controls have the wrong sign, and clocks depend on everything.
    /// Both are corrected.)
    ///
    /// The state, the controls and the time are as before afterwards, to the last bit. What is computed from them is that of
    /// the last perturbed state, and counts as not computed.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1, [`Error::Unsupported`] with the Runge–Kutta integrator, and the
    /// errors of [`step`](Self::step).
    ///
    /// ```
    /// use mujoco_safe::{Data, Differences, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let system = data.transition_fd(1e-6, Differences::Central)?;
    /// // The next position of the cart by its velocity: a little less than the time step, because of damping.
    /// assert!((system.a[(0, 2)] - 0.01).abs() < 1e-5);
    /// assert_eq!(data.time(), 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjd_transitionFD")]
    pub fn transition_fd(&mut self, eps: f64, differences: Differences) -> Result<StateSpace> {
        let mut system = StateSpace::zeros(self.model());
        self.transition_fd_into(eps, differences, &mut system)?;
        Ok(system)
    }

    /// As [`transition_fd`](Self::transition_fd), into the caller's matrices, of which any may be left out. Allocates nothing,
    /// but for a copy of the controls within [`with_callbacks`](Self::with_callbacks).
    ///
    /// # Errors
    ///
    /// As for [`transition_fd`](Self::transition_fd), and [`Error::Shape`] for a wrong shape.
    ///
    /// ```
    /// use mujoco_safe::{Data, Differences, Matrix, TransitionOutputs, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let mut a = Matrix::zeros(4, 4);
    /// let outputs = TransitionOutputs { a: Some(&mut a), ..Default::default() };
    /// data.transition_fd_into(1e-6, Differences::Forward, outputs)?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjd_transitionFD")]
    pub fn transition_fd_into<'a>(
        &mut self,
        eps: f64,
        differences: Differences,
        outputs: impl Into<TransitionOutputs<'a>>,
    ) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        check_eps("transition_fd", eps)?;
        if self.model().options().integrator == Integrator::Rk4 {
            return Err(Error::Unsupported(
                "transition_fd differentiates a step of the integrators Euler and Implicit, but this model's is Rk4"
                    .to_owned(),
            ));
        }
        let (nx, nu, ny) = sizes(self.model());
        let mut outputs = outputs.into();
        // The engine counts the entries of a matrix with a C int; beyond that it would write past its stack.
        let largest = nx.max(nu).saturating_mul(nx.max(ny));
        if i32::try_from(largest).is_err() {
            return Err(Error::Unsupported(format!("transition_fd of {nx} states, {nu} controls and {ny} outputs")));
        }
        let a = pointer("A of transition_fd", outputs.a.as_deref_mut(), (nx, nx))?;
        let b = pointer("B of transition_fd", outputs.b.as_deref_mut(), (nx, nu))?;
        let c = pointer("C of transition_fd", outputs.c.as_deref_mut(), (ny, nx))?;
        let d = pointer("D of transition_fd", outputs.d.as_deref_mut(), (ny, nu))?;
        let central = i32::from(differences == Differences::Central);
        let spills = self.last_control_is_stuck(eps);
        let time = self.time();
        // The engine puts them back too, but not after its last calls of a closure that sets them.
        let ctrl = self.callbacks.is_some().then(|| self.ctrl().to_vec());
        let put_back = |data: &mut Self| {
            if let Some(ctrl) = &ctrl {
                data.ctrl_mut().copy_from_slice(ctrl);
            }
        };
        let mut call = |a, b, c, d| {
            let result = self.run("mjd_transitionFD", Computed::empty(), |model, data| {
                // SAFETY: a model and a data that go together, and outputs that are NULL or have the shapes that the engine
                // writes.
                unsafe { guard::mjd_transition_fd(model, data, eps, central, a, b, c, d) }
            });
            put_back(self);
            result
        };
        let null = ptr::null_mut;
        // Where the control of the last actuator can be moved to neither side, 2.2.2 clears nq + nv + na numbers in a row of
        // 2 nv + na, and the rest of them is what lies behind: D, or the saved state that it goes on from. With B computed
        // alone nothing that is still needed lies there.
        if !b.is_null() && spills {
            call(a, null(), c, null())?;
            call(null(), null(), null(), d)?;
            call(null(), b, null(), null())?;
        } else {
            call(a, b, c, d)?;
        }
        // The engine takes steps, and puts back everything but the time.
        self.set_time(time);
        self.mend(eps, differences, &mut outputs);
        Ok(())
    }

    /// Corrects what 2.2.2 gets wrong of the sensors. Where a control is moved to both sides it subtracts the readings the wrong
    /// way round, and since the time goes on from one column to the next, clocks seem to depend on everything.
    fn mend(&self, eps: f64, differences: Differences, outputs: &mut TransitionOutputs<'_>) {
        let model = self.model();
        if let Some(d) = &mut outputs.d {
            for control in 0..model.nu() {
                if sides(self, Input::Control(control), Step { differences, eps }) == (true, true) {
                    (0..model.nsensordata()).for_each(|sensor| d[(sensor, control)] = 0.0 - d[(sensor, control)]);
                }
            }
        }
        for (&kind, &address) in model.sensor_type().iter().zip(model.sensor_adr()) {
            if kind == mjSENS_CLOCK as i32 {
                for output in [&mut outputs.c, &mut outputs.d].into_iter().flatten() {
                    output.row_mut(address as usize).fill(0.0);
                }
            }
        }
    }

    /// Whether the control of the last actuator is so near to or beyond its range that it cannot be moved by `eps`, in a model
    /// in which that makes the engine write too far.
    fn last_control_is_stuck(&self, eps: f64) -> bool {
        let model = self.model();
        let Some(last) = model.nu().checked_sub(1) else { return false };
        let [low, high] = model.actuator_ctrlrange()[last];
        let inside = |ctrl: f64| low <= ctrl && ctrl <= high;
        let ctrl = self.ctrl()[last];
        model.nq() > model.nv()
            && model.actuator_ctrllimited()[last] != 0
            && !(inside(ctrl) && (inside(ctrl + eps) || inside(ctrl - eps)))
    }
}

impl TransitionOutputs<'_> {
    /// Checks the shapes of the matrices that are present.
    pub(super) fn check(&self, model: &Model) -> Result<()> {
        let (nx, nu, ny) = sizes(model);
        for (what, output, shape) in [
            ("A of a linear system", &self.a, (nx, nx)),
            ("B of a linear system", &self.b, (nx, nu)),
            ("C of a linear system", &self.c, (ny, nx)),
            ("D of a linear system", &self.d, (ny, nu)),
        ] {
            if let Some(output) = output {
                Error::check_shape(what, output.shape(), shape)?;
            }
        }
        Ok(())
    }
}

/// How many states (`2 nv + na`), controls and outputs the linear system of a model has.
pub(crate) fn sizes(model: &Model) -> (usize, usize, usize) {
    (2 * model.nv() + model.na(), model.nu(), model.nsensordata())
}

fn pointer(what: &'static str, matrix: Option<&mut Matrix>, shape: (usize, usize)) -> Result<*mut f64> {
    let Some(matrix) = matrix else { return Ok(ptr::null_mut()) };
    Error::check_shape(what, matrix.shape(), shape)?;
    // NULL is how the engine is told to leave an output out; an empty one is no different.
    Ok(if matrix.as_slice().is_empty() { ptr::null_mut() } else { matrix.as_mut_ptr() })
}
