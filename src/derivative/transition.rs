//! The linear system of a step by the engine's finite differences, with corrections of its errors.

use std::ptr;

use mujoco_sys::{guard, mjSENS_CLOCK};

use super::{Differences, check_eps};
use crate::data::{Data, PipelineFlags};
use crate::enums::{Integrator, SensorType};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};

/// Linear system in discrete time, `dx' = A dx + B du`, `dy = C dx + D du`, with `nx = 2 nv + na`
/// states, `nu` controls and `nsensordata` outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// `(nx, nx)`: derivative of the next state with respect to the state.
    pub a: Matrix,
    /// `(nx, nu)`: derivative of the next state with respect to the controls.
    pub b: Matrix,
    /// `(nsensordata, nx)`: derivative of the sensors with respect to the state.
    pub c: Matrix,
    /// `(nsensordata, nu)`: derivative of the sensors with respect to the controls.
    pub d: Matrix,
}

impl StateSpace {
    /// Creates a system of zeros in the shapes for a model.
    pub fn zeros(model: &Model) -> Self {
        let (nx, nu, ny) = sizes(model);
        Self { a: Matrix::zeros(nx, nx), b: Matrix::zeros(nx, nu), c: Matrix::zeros(ny, nx), d: Matrix::zeros(ny, nu) }
    }
}

/// Outputs of [`Data::transition_fd_into`] and of
/// [`Lineariser::linear_system_into`](super::Lineariser::linear_system_into). Matrices that are
/// `None` are not computed; without C and D the sensors are skipped.
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

/// # Derivatives of a step
impl Data {
    /// Linearises a step of the simulation about the present state and controls, by differences
    /// with the step `eps`; `1e-6` with [`Differences::Central`] is a good choice.
    ///
    /// (In engines before 4.0, central differences of the sensors with respect to the controls have
    /// the wrong sign, in 2.2.2 clocks depend on all inputs, and in newer engines the kinetic
    /// energy does not depend on the velocities. With an implicit integrator, engines before 4.0
    /// neglect that a control changes the damping of an actuator whose gain depends on its
    /// velocity. This method corrects these. It also makes solvers iterate that would keep their
    /// initial guess: see [`Columns`](super::TransitionMethod::Columns).)
    ///
    /// The state, the controls and the time are unchanged afterwards, to the last bit. Computed
    /// quantities belong to the last perturbed state, and count as not computed.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1, [`Error::Unsupported`] with the
    /// Runge–Kutta integrator and for a model with delays of actuators or sensors, and the errors
    /// of [`step`](Self::step).
    ///
    /// ```
    /// use mujoco_safe::{Data, Differences, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let system = data.transition_fd(1e-6, Differences::Central)?;
    /// // Derivative of the cart's next position with respect to its velocity: almost the time step, because of damping.
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

    /// Linearises a step as [`transition_fd`](Self::transition_fd) does, into the caller's
    /// matrices, any of which may be omitted. Allocates nothing, except a copy of the controls if
    /// the simulation has [callbacks](crate::callback), of the warm start if it is disabled, of
    /// orientations of mocap bodies with 2.2.2, of a part of the model if an actuator has several
    /// controls, of the momentum if a sensor measures the kinetic energy, and of states if controls
    /// change the damping of actuators in an implicit integrator.
    ///
    /// # Errors
    ///
    /// As for [`transition_fd`](Self::transition_fd), and [`Error::Shape`] for a wrong shape.
    ///
    /// ```
    /// use mujoco_safe::derivative::TransitionOutputs;
    /// use mujoco_safe::{Data, Differences, Matrix, sample};
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
        self.model().check_linearisable("transition_fd")?;
        if self.model().options().integrator == Integrator::Rk4 {
            return Err(Error::Unsupported(
                "transition_fd supports the integrators Euler and Implicit, but this model uses Rk4".to_owned(),
            ));
        }
        let (nx, nu, ny) = sizes(self.model());
        let mut outputs = outputs.into();
        // The engine counts the entries of a matrix with a C int. An overflow would make it write
        // past its stack.
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
        // The engine restores the controls too, but not after its last calls of a closure that sets
        // them. It normalises the orientations of mocap bodies in 2.2.2, and does not restore the
        // warm start if it is disabled.
        let ctrl = self.has_callbacks().then(|| self.ctrl().to_vec());
        let is_cold = self.model().raw().opt.disableflags as u32 & DisableFlags::WARMSTART.bits() != 0;
        let warm_start = is_cold.then(|| self.qacc_warmstart().to_vec());
        let mocap =
            (cfg!(not(engine_since = "2.3.0")) && self.model().nmocap() > 0).then(|| self.mocap_quat().to_vec());
        let restore = |data: &mut Self| {
            if let Some(ctrl) = &ctrl {
                data.ctrl_mut().copy_from_slice(ctrl);
            }
            if let Some(warm_start) = &warm_start {
                data.qacc_warmstart_mut().copy_from_slice(warm_start);
            }
            if let Some(mocap) = &mocap {
                data.mocap_quat_mut().copy_from_slice(mocap);
            }
        };
        let model = self.model().clone();
        let mut call = |a, b, c, d| {
            let result = self.run("mjd_transitionFD", PipelineFlags::empty(), |_, data| {
                // SAFETY: the model and the data belong together, and each output is NULL or has
                // the shape that the engine writes.
                model
                    .for_differences(|model| unsafe { guard::mjd_transition_fd(model, data, eps, central, a, b, c, d) })
            });
            restore(self);
            result
        };
        let null = ptr::null_mut;
        // If the control of the last actuator can be perturbed to neither side, 2.2.2 clears nq +
        // nv + na entries of a row of 2 nv + na. The excess overwrites the memory after the row: D,
        // or the saved state that later columns start from. A call that computes B alone overwrites
        // nothing that is still needed.
        if !b.is_null() && spills {
            call(a, null(), c, null())?;
            call(null(), null(), null(), d)?;
            call(null(), b, null(), null())?;
        } else {
            call(a, b, c, d)?;
        }
        // The engine takes steps, and restores everything except the time.
        self.set_time(time);
        self.correct_sensors(eps, differences, &mut outputs);
        self.correct_input_columns(eps, differences, &mut outputs)?;
        match &mut outputs.c {
            Some(c) if has_kinetic_energy(self.model()) => self.correct_kinetic_energy(c),
            _ => Ok(()),
        }
    }

    /// Corrects the derivatives of sensors of the kinetic energy by the velocities. The engine
    /// evaluates these sensors together with the position sensors, which it does not repeat for a
    /// change of a velocity.
    fn correct_kinetic_energy(&mut self, c: &mut Matrix) -> Result<()> {
        let (model, nv) = (self.model().clone(), self.model().nv());
        self.fwd_position()?;
        let mut momentum = vec![0.0; nv];
        self.mul_m_into(self.qvel(), &mut momentum)?;
        let energy =
            0.5 * self.qvel().iter().zip(&momentum).map(|(velocity, momentum)| velocity * momentum).sum::<f64>();
        for (sensor, &address) in model.sensor_adr().iter().enumerate() {
            let cutoff = model.sensor_cutoff()[sensor];
            if model.sensor_type()[sensor] == SensorType::KineticEnergy.raw() && !(cutoff > 0.0 && energy > cutoff) {
                c.row_mut(address as usize)[nv..2 * nv].copy_from_slice(&momentum);
            }
        }
        self.set_computed(PipelineFlags::empty());
        Ok(())
    }

    /// Corrects two errors of the engine in C and D. Before 4.0, if a control is perturbed to both
    /// sides, the engine subtracts the readings in the wrong order. And in 2.2.2 the time advances
    /// from one column to the next, so clocks seem to depend on all inputs.
    fn correct_sensors(&self, eps: f64, differences: Differences, outputs: &mut TransitionOutputs<'_>) {
        let model = self.model();
        if cfg!(not(engine_since = "4.0.0"))
            && let Some(d) = &mut outputs.d
        {
            for control in 0..model.nu() {
                if differences == Differences::Central && self.can_perturb_to_both_sides(control, eps) {
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

    /// Returns `true` if the engine perturbs a control to both sides: one that is limited only if
    /// both are in its range.
    fn can_perturb_to_both_sides(&self, control: usize, eps: f64) -> bool {
        self.can_perturb(control, eps) && self.can_perturb(control, -eps)
    }

    /// Returns `true` if the engine perturbs a control by a number: if it is not limited, or is in
    /// its range before and after.
    pub(super) fn can_perturb(&self, control: usize, by: f64) -> bool {
        let [low, high] = self.model().actuator_ctrlrange()[control];
        let ctrl = self.ctrl()[control];
        self.model().actuator_ctrllimited()[control] == 0
            || [ctrl, ctrl + by].iter().all(|ctrl| (low..=high).contains(ctrl))
    }

    /// Returns `true` if the control of the last actuator cannot be perturbed by `eps` within its
    /// range, in a model for which this makes the engine write out of bounds.
    fn last_control_is_stuck(&self, eps: f64) -> bool {
        let model = self.model();
        let Some(last) = model.nu().checked_sub(1) else { return false };
        model.nq() > model.nv() && !self.can_perturb(last, eps) && !self.can_perturb(last, -eps)
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

/// Returns the numbers of states (`2 nv + na`), controls and outputs of the linear system of a
/// model.
pub(crate) fn sizes(model: &Model) -> (usize, usize, usize) {
    (2 * model.nv() + model.na(), model.nu(), model.nsensordata())
}

/// Returns the pointer for an output, or NULL if it is omitted or empty.
fn pointer(what: &'static str, matrix: Option<&mut Matrix>, shape: (usize, usize)) -> Result<*mut f64> {
    let Some(matrix) = matrix else { return Ok(ptr::null_mut()) };
    Error::check_shape(what, matrix.shape(), shape)?;
    // The engine omits an output that is NULL. An empty matrix is passed as NULL too.
    Ok(if matrix.as_slice().is_empty() { ptr::null_mut() } else { matrix.as_mut_ptr() })
}

/// Returns `true` for a model with a sensor of the kinetic energy, which the engine evaluates
/// together with the position sensors.
pub(super) fn has_kinetic_energy(model: &Model) -> bool {
    let disabled = model.raw().opt.disableflags as u32 & DisableFlags::SENSOR.bits() != 0;
    !disabled && model.sensor_type().contains(&SensorType::KineticEnergy.raw())
}
