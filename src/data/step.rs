//! The pipeline: step, forward, inverse.

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{guard, mjData, mjModel, mjWARN_CNSTRFULL};

use super::warning::{Counted, Lifted};
use super::{Computed, Data, Needs};
use crate::callback;
use crate::error::{Error, Result};
use crate::ffi;

impl Data {
    /// Advances the simulation by one time step: computes everything from the present state and inputs, then integrates.
    ///
    /// Afterwards `qpos`, `qvel`, `act` and `time` are those of the new state; everything else is still of the old one. Call
    /// [`forward`](Self::forward) to bring it up to date.
    ///
    /// # Errors
    ///
    /// [`Error::Unstable`] if a position, velocity, control or acceleration is not a number or huge; [`Error::Engine`] if the
    /// engine fails; [`Error::Poisoned`] after such a failure, until a reset.
    #[doc(alias = "mj_step")]
    #[doc(alias = "mj_checkAcc")]
    #[inline]
    pub fn step(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_step", Computed::AFTER_STEP, |m, d| {
            // SAFETY: `run` passes a model and a data that go together, and the state was found good above.
            unsafe { guard::step_from_good_state(m, d) }
        })
    }

    /// The first half of a step: what depends on position and velocity. Set controls and forces from it, then call
    /// [`step2`](Self::step2).
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step).
    #[doc(alias = "mj_step1")]
    #[inline]
    pub fn step1(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_step1", Computed::AFTER_STEP1, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_step1(m, d) }
        })
    }

    /// The second half of a step: actuation, accelerations, integration. With the integrator
    /// [`Rk4`](crate::Integrator::Rk4), which cannot be halved, it takes an Euler step.
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step), and [`Error::NotComputed`] without a [`step1`](Self::step1) or
    /// [`forward`](Self::forward) before it, or if the state was advanced or the model changed in between. (The engine would
    /// go on with what it has: after a step with quantities of the state before it, after [`inverse`](Self::inverse) without
    /// the matrices that the dual solvers need.)
    #[doc(alias = "mj_step2")]
    #[inline]
    pub fn step2(&mut self) -> Result<()> {
        self.check_usable()?;
        if !self.computed.contains(Computed::AFTER_STEP1) {
            return Err(Error::NotComputed { call: "step2", needs: Needs::FIRST_HALF });
        }
        self.check_inputs()?;
        self.run("mj_step2", Computed::AFTER_STEP, |m, d| {
            // SAFETY: as in `step`, and the stages before this one were computed for this model.
            unsafe { guard::mj_step2(m, d) }
        })
    }

    /// Forward dynamics: computes everything from the present state and inputs, accelerations included, without advancing in
    /// time.
    ///
    /// # Errors
    ///
    /// As for [`step`](Self::step), except that accelerations are not judged.
    #[doc(alias = "mj_forward")]
    #[inline]
    pub fn forward(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_forward", Computed::AFTER_FORWARD, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_forward(m, d) }
        })
    }

    /// Inverse dynamics: from positions, velocities and the accelerations in `qacc` to the forces that cause them, in
    /// `qfrc_inverse`.
    ///
    /// # Errors
    ///
    /// As for [`forward`](Self::forward).
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// // What must hold the cart-pole with its pole at 0.1 rad?
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.1;
    /// data.qacc_mut().fill(0.0);
    /// data.inverse()?;
    /// let moment = 0.5 * 9.81 * 0.3 * 0.1_f64.sin(); // mass, gravity, lever
    /// assert!((data.qfrc_inverse()[1] + moment).abs() < 1e-9);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_inverse")]
    #[inline]
    pub fn inverse(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.forget_old_contacts();
        self.run("mj_inverse", Computed::AFTER_INVERSE, |m, d| {
            // SAFETY: as in `step`.
            unsafe { guard::mj_inverse(m, d) }
        })
    }

    /// Makes a guarded call that may warn, fail or reset, and notes what is computed afterwards. Every engine
    /// call that computes goes through here.
    #[inline]
    pub(crate) fn run(
        &mut self,
        function: &'static str,
        computes: Computed,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        let time = self.time();
        let warnings = Lifted::lift(self.raw_mut());
        let (model, data) = (self.model().as_ptr(), self.as_mut_ptr());
        let adhesive = self.model().has_adhesion();
        if adhesive || self.callbacks.is_some() {
            return self.run_specially(function, computes, time, &warnings, call);
        }
        let status = call(model, data);
        let counted = warnings.lower(self.raw_mut());
        if status == guard::OK && counted == Counted::Nothing {
            self.computed = computes;
            return Ok(());
        }
        self.settle(function, computes, time, &warnings, status, counted, None)
    }

    /// The rest of [`run`](Self::run) for a simulation with callbacks, or with an adhesion actuator.
    fn run_specially(
        &mut self,
        function: &'static str,
        computes: Computed,
        time: f64,
        warnings: &Lifted,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        let (model, data) = (self.model().as_ptr(), self.as_mut_ptr());
        let adhesive = self.model().has_adhesion();
        let all = || if adhesive { run_with_adhesion(model, data, call) } else { call(model, data) };
        let (status, failure) = match self.callbacks.clone() {
            None => (all(), None),
            Some(slot) => {
                // What leaves nothing behind, such as finite differences, goes through the whole pipeline all the same.
                let reaches = if computes.is_empty() { Computed::AFTER_FORWARD } else { computes };
                callback::computing(ptr::from_mut(self), data, reaches, &slot, all)
            }
        };
        let counted = warnings.lower(self.raw_mut());
        if status == guard::OK && counted == Counted::Nothing {
            self.computed = computes;
            return Ok(());
        }
        self.settle(function, computes, time, warnings, status, counted, failure)
    }

    /// The engine's inverse dynamics computes what an adhesion actuator acts on from the contacts and constraints of the call
    /// before. Those of another model, or that do not belong together, would lead it out of bounds, so there are none then.
    #[inline]
    pub(super) fn forget_old_contacts(&mut self) {
        if self.model().has_adhesion() && !self.computed.contains(Computed::CONSTRAINT) {
            let raw = self.raw_mut();
            (raw.ncon, raw.ne, raw.nf, raw.nefc) = (0, 0, 0, 0);
        }
    }

    /// The engine makes rows for the contacts that there is room for, and leaves the others as collision detection left them. When
    /// it makes them a second time, those must not keep the rows of the first.
    pub(super) fn forget_old_rows(&mut self) {
        /// The contact has no degrees of freedom, which the engine finds anew.
        const EXCLUDED_WITHOUT_DOFS: i32 = 4;
        let (contacts, ncon) = (self.raw().contact, self.ncon());
        // SAFETY: the engine keeps `ncon` contacts there, and `self` is borrowed exclusively.
        for contact in unsafe { ffi::array_mut(contacts, ncon) } {
            contact.efc_address = -1;
            if contact.exclude == EXCLUDED_WITHOUT_DOFS {
                contact.exclude = 0;
            }
        }
    }

    #[cold]
    #[allow(
        clippy::too_many_arguments,
        reason = "all that is known of a call, taken out of the way of the ones that go well"
    )]
    fn settle(
        &mut self,
        function: &'static str,
        computes: Computed,
        time: f64,
        warnings: &Lifted,
        status: c_int,
        counted: Counted,
        failure: Option<Error>,
    ) -> Result<()> {
        let failed = match ffi::check(function, status) {
            // The engine only knows that a closure has failed.
            Err(error) => Some(failure.unwrap_or(error)),
            Ok(()) if counted == Counted::Reset => Some(Error::Unstable(self.reset_by_engine(time))),
            Ok(()) => None,
        };
        match failed {
            None => {
                self.computed = computes;
                self.log_new_warnings(warnings);
                Ok(())
            }
            Some(error) => {
                self.computed = Computed::empty();
                self.failure = Some(error.to_string().into());
                Err(error)
            }
        }
    }
}

/// A call on a model with an adhesion actuator, for which a full constraint buffer has to be an error.
#[cold]
fn run_with_adhesion(
    model: *const mjModel,
    data: *mut mjData,
    call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
) -> c_int {
    const COUNTER: usize = mjWARN_CNSTRFULL as usize;
    // SAFETY: `run` passes its own data, and nothing refers to the counter. The engine speaks of it only while it is zero.
    let lifted = std::mem::take(unsafe { &mut (*data).warning[COUNTER].number });
    // SAFETY: sets a flag of this thread, which is put back before this returns.
    let outer = unsafe { guard::full_constraints_are_fatal(1) };
    let status = call(model, data);
    // SAFETY: as above.
    unsafe { guard::full_constraints_are_fatal(outer) };
    // SAFETY: as above.
    let counter = unsafe { &mut (*data).warning[COUNTER].number };
    *counter = counter.saturating_add(lifted);
    status
}
