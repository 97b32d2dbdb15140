//! Steps, forward and inverse dynamics, and the checks of their inputs.

use mujoco_sys::{guard, mjMAXVAL};

use super::{Data, MissingResults, PipelineFlags};
use crate::error::{Error, Instability, Result, UnstableField};
use crate::ffi;
use crate::kind::Kind;

/// # Steps and dynamics
impl Data {
    /// Advances the simulation by one time step: computes all quantities from the present state and
    /// inputs, then integrates.
    ///
    /// Afterwards `qpos`, `qvel`, `act` and `time` belong to the new state; all other quantities
    /// belong to the old state. Call [`forward`](Self::forward) to update them. (With the
    /// integrator [`Rk4`](crate::enums::Integrator::Rk4) only sensor readings and energies belong
    /// to the old state, the rest to the last of the four states in which the engine evaluates the
    /// dynamics.)
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] if a position, velocity, control or acceleration is NaN or beyond ±10¹⁰;
    /// [`Error::Callback`] if a closure panics; [`Error::Engine`] if the engine fails;
    /// [`Error::Poisoned`] after one of these, until a reset. A position, velocity or control that
    /// is out of range is detected before the engine is called and does not poison the data.
    #[doc(alias = "step!")]
    #[doc(alias = "mj_step")]
    #[doc(alias = "mj_checkAcc")]
    #[inline]
    pub fn step(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_step", PipelineFlags::AFTER_STEP, |m, d| {
            // SAFETY: `run` passes a model and a data of this model, and the state was checked
            // above.
            unsafe { guard::step_prechecked(m, d) }
        })
    }

    /// Advances the simulation by `n` steps with the same inputs, as [`step`](Self::step) does.
    /// Stops at the first error.
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step). Steps before the error are kept.
    #[doc(alias = "nstep")]
    pub fn step_n(&mut self, n: usize) -> Result<()> {
        (0..n).try_for_each(|_| self.step())
    }

    /// Computes the first half of a step: all quantities that depend on positions and velocities.
    /// Set controls and forces based on them, then call [`step2`](Self::step2).
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step).
    #[doc(alias = "mj_step1")]
    #[inline]
    pub fn step1(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_step1", PipelineFlags::AFTER_STEP1, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_step1(m, d) }
        })
    }

    /// Computes the second half of a step: actuation, accelerations, integration. The integrator
    /// [`Rk4`](crate::enums::Integrator::Rk4) cannot be split; this method takes an Euler step
    /// instead.
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step), and [`Error::NotComputed`] without a preceding
    /// [`step1`](Self::step1) or [`forward`](Self::forward), or if the state was advanced or the
    /// model changed in between. (The engine would continue with stale results: after a step with
    /// the results of the previous state, and after [`inverse`](Self::inverse) without the matrices
    /// that the dual solvers need.)
    #[doc(alias = "mj_step2")]
    #[inline]
    pub fn step2(&mut self) -> Result<()> {
        let computes = self.check_step2()?;
        self.run("mj_step2", computes, |m, d| {
            // SAFETY: as in `step`, and the earlier stages were computed for this model.
            unsafe { guard::mj_step2(m, d) }
        })
    }

    /// Checks that the second half of a step can be computed, and returns what it computes.
    fn check_step2(&self) -> Result<PipelineFlags> {
        self.check_usable()?;
        if !self.computed.contains(PipelineFlags::FIRST_HALF) {
            return Err(Error::NotComputed { call: "step2", missing: MissingResults::FIRST_HALF });
        }
        self.check_inputs()?;
        // The second half evaluates the sensors of the acceleration stage only.
        let sensors = (self.computed & PipelineFlags::SENSORS) | PipelineFlags::SENSOR_ACC;
        Ok((PipelineFlags::AFTER_STEP - PipelineFlags::SENSORS) | sensors)
    }

    /// Takes a step as [`step`](Self::step) does, for a difference of steps: see
    /// [`Model::for_differences`](crate::model::Model::for_differences).
    pub(crate) fn step_for_differences(&mut self) -> Result<()> {
        self.step_for_differences_with(self.model().raw().opt.iterations)
    }

    /// Takes a step as [`step_for_differences`](Self::step_for_differences) does, with another
    /// limit of the solver's iterations.
    pub(crate) fn step_for_differences_with(&mut self, iterations: i32) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        let model = self.model().clone();
        self.run("mj_step", PipelineFlags::AFTER_STEP, |_, d| {
            // SAFETY: as in `step`; the copy of the model has its arrays.
            model.for_differences_with(iterations, |m| unsafe { guard::step_prechecked(m, d) })
        })
    }

    /// Computes the second half of a step as [`step2`](Self::step2) does, for a difference of
    /// steps.
    pub(crate) fn step2_for_differences(&mut self) -> Result<()> {
        let computes = self.check_step2()?;
        let model = self.model().clone();
        self.run("mj_step2", computes, |_, d| {
            // SAFETY: as in `step2`; the copy of the model has its arrays.
            model.for_differences(|m| unsafe { guard::mj_step2(m, d) })
        })
    }

    /// Computes forward dynamics: all quantities from the present state and inputs, accelerations
    /// included, without advancing the time.
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step), except that accelerations are not checked.
    #[doc(alias = "forward!")]
    #[doc(alias = "forward dynamics")]
    #[doc(alias = "mj_forward")]
    #[inline]
    pub fn forward(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_forward", PipelineFlags::AFTER_FORWARD, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_forward(m, d) }
        })
    }

    /// Computes inverse dynamics: from positions, velocities and the accelerations in `qacc`, the
    /// forces that cause them, in `qfrc_inverse`.
    ///
    /// # Errors
    ///
    /// As for [`forward`](Self::forward).
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// // The moment that holds the pole at 0.1 rad.
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.1;
    /// data.qacc_mut().fill(0.0);
    /// data.inverse()?;
    /// let moment = 0.5 * 9.81 * 0.3 * 0.1_f64.sin(); // mass, gravity, lever
    /// assert!((data.qfrc_inverse()[1] + moment).abs() < 1e-9);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "inverse dynamics")]
    #[doc(alias = "mj_inverse")]
    #[inline]
    pub fn inverse(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.wake_before(PipelineFlags::AFTER_INVERSE);
        self.clear_stale_contacts();
        self.run("mj_inverse", PipelineFlags::AFTER_INVERSE, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_inverse(m, d) }
        })
    }

    /// Clears contacts and constraints that the engine would read out of bounds. The engine's
    /// inverse dynamics computes the transmission of an adhesion actuator from the contacts and
    /// constraints of the previous call. These may belong to another model or not match each other.
    #[inline]
    pub(super) fn clear_stale_contacts(&mut self) {
        if self.model().has_adhesion() && !self.computed.contains(PipelineFlags::CONSTRAINT) {
            let raw = self.raw_mut();
            (raw.ncon, raw.ne, raw.nf, raw.nefc) = (0, 0, 0, 0);
        }
    }

    /// Clears the constraint rows of all contacts. The engine assigns rows only while the
    /// constraint buffer has space, and does not modify the other contacts, which would keep the
    /// rows of an earlier call.
    pub(super) fn clear_contact_rows(&mut self) {
        /// Value of `exclude` for a contact without degrees of freedom. The engine sets it again.
        const EXCLUDED_WITHOUT_DOFS: i32 = 4;
        let (contacts, ncon) = (self.raw().contact, self.ncon());
        // SAFETY: the array has `ncon` contacts, and `self` is borrowed exclusively.
        for contact in unsafe { ffi::array_mut(contacts, ncon) } {
            contact.efc_address = -1;
            if contact.exclude == EXCLUDED_WITHOUT_DOFS {
                contact.exclude = 0;
            }
        }
    }

    /// Checks positions, velocities and controls for values that the engine would reset or replace.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] if a value is NaN or beyond ±10¹⁰.
    #[doc(alias = "mj_checkPos")]
    #[doc(alias = "mj_checkVel")]
    pub fn check_state(&self) -> Result<()> {
        self.check_inputs()
    }

    /// Checks positions, velocities and controls before the engine is called. The engine would
    /// reset them.
    #[inline]
    pub(crate) fn check_inputs(&self) -> Result<()> {
        let (raw, model) = (self.raw(), self.model());
        // SAFETY: the engine allocated each array with this length, and `self` is borrowed.
        let valid = unsafe {
            ffi::all(raw.qpos, model.nq(), is_in_range)
                && ffi::all(raw.qvel, model.nv(), is_in_range)
                && ffi::all(raw.ctrl, model.nu(), is_in_range)
        };
        if !valid {
            return Err(self.input_out_of_range());
        }
        if self.model().has_rangefinder_and_height_field() { self.check_field_poses() } else { Ok(()) }
    }

    #[cold]
    fn input_out_of_range(&self) -> Error {
        let (position, velocity, control) = (UnstableField::Position, UnstableField::Velocity, UnstableField::Control);
        [(position, self.qpos()), (velocity, self.qvel()), (control, self.ctrl())]
            .into_iter()
            .find_map(|(field, values)| {
                let index = values.iter().position(|&value| !is_in_range(value))?;
                Some(self.instability(field, index, Some(values[index]), self.time()).into())
            })
            .expect("Bug: all inputs are in range")
    }

    /// Returns the description of a value that is out of range.
    pub(super) fn instability(&self, field: UnstableField, index: usize, value: Option<f64>, time: f64) -> Instability {
        let model = self.model();
        // The last joint that starts at or before the index.
        let joint = |starts: &[i32]| {
            starts
                .iter()
                .rposition(|&start| ffi::size(start) <= index)
                .and_then(|joint| model.name_at(Kind::Joint, joint))
        };
        let name = match field {
            UnstableField::Position => joint(model.jnt_qposadr()),
            UnstableField::Velocity | UnstableField::Acceleration => joint(model.jnt_dofadr()),
            UnstableField::Control => model.name_at(Kind::Actuator, model.actuator_of_control(index)),
        };
        Instability { field, index, name: name.map(str::to_owned), value, time }
    }
}

/// Returns `true` if the engine accepts this value: one within ±10¹⁰.
#[inline]
fn is_in_range(value: f64) -> bool {
    // Without their signs, floating-point numbers have the order of their bit patterns, and NaNs
    // follow all other values.
    value.to_bits() << 1 <= mjMAXVAL.to_bits() << 1
}

#[cfg(test)]
mod tests {
    use mujoco_sys::mjMAXVAL;

    use crate::{Data, sample};

    #[test]
    fn only_values_beyond_the_limit_are_rejected() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.ctrl_mut().fill(-mjMAXVAL);
        assert!(data.check_inputs().is_ok());
        for value in [mjMAXVAL.next_up(), -mjMAXVAL.next_up(), f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -f64::NAN] {
            for index in [0, 7, data.ctrl().len() - 1] {
                data.ctrl_mut().fill(0.0);
                data.ctrl_mut()[index] = value;
                assert!(data.check_inputs().is_err(), "{value} at {index}");
            }
            data.ctrl_mut().fill(0.0);
            let last = data.qvel().len() - 1;
            data.qvel_mut()[last] = value;
            assert!(data.check_inputs().is_err(), "{value} in qvel");
            data.qvel_mut()[last] = 0.0;
            let last = data.qpos().len() - 1;
            let before = std::mem::replace(&mut data.qpos_mut()[last], value);
            assert!(data.check_inputs().is_err(), "{value} in qpos");
            data.qpos_mut()[last] = before;
        }
        assert!(data.check_inputs().is_ok());
    }
}
