//! The pipeline: step, forward, inverse.

use mujoco_sys::guard;

use super::{Computed, Data, Needs};
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
    /// [`Error::Unstable`] if a position, velocity, control or acceleration is not a number or huge; [`Error::Callback`] if a
    /// closure panics; [`Error::Engine`] if the engine fails; [`Error::Poisoned`] after one of these, until a reset. A position,
    /// velocity or control that is out of range is found before the engine is called and does not poison the data.
    #[doc(alias = "mj_step")]
    #[doc(alias = "mj_checkAcc")]
    #[inline]
    pub fn step(&mut self) -> Result<()> {
        self.check_usable()?;
        self.check_inputs()?;
        self.run("mj_step", Computed::AFTER_STEP, |m, d| {
            // SAFETY: `run` passes a model and a data that go together, and the state was found good above.
            unsafe { guard::step_prechecked(m, d) }
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
        if !self.computed.contains(Computed::FIRST_HALF) {
            return Err(Error::NotComputed { call: "step2", needs: Needs::FIRST_HALF });
        }
        self.check_inputs()?;
        // The second half reads the sensors of its own stage only.
        let sensors = (self.computed & Computed::SENSORS) | Computed::SENSOR_ACC;
        self.run("mj_step2", (Computed::AFTER_STEP - Computed::SENSORS) | sensors, |m, d| {
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
}
