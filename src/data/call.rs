//! Calls of the engine on a simulation, and the effect of an engine error on it.
//!
//! Every call that can raise an engine error on a [`Data`] goes through one of three methods, which differ in the pointer that
//! they lend:
//!
//! | method | lends | for | after an engine error |
//! |---|---|---|---|
//! | [`Data::run`] | `*mut mjData` | parts of the pipeline, which warn, reset and call closures | poisoned |
//! | [`Data::call_mut`] | `*mut mjData` | every other function that writes to the data or to its stack | poisoned |
//! | [`Data::call`] | `*const mjData` | functions that only read | unchanged |
//!
//! Calls without a simulation go through [`ffi::check_without_data`]. The lint `disallowed_methods` (`clippy.toml`) keeps
//! [`ffi::check`], which all of these use, out of the other files.

#![allow(clippy::disallowed_methods, reason = "the gates that the lint points to")]

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{guard, mjData, mjModel, mjWARN_CNSTRFULL};

use super::warning::{Counted, Lifted};
use super::{Computed, Data};
use crate::callback;
use crate::error::{Error, Result};
use crate::ffi;

impl Data {
    /// Makes a guarded call that only reads the data. An engine error leaves the data usable: the call could not change it.
    #[inline]
    pub(crate) fn call(
        &self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *const mjData) -> c_int,
    ) -> Result<()> {
        ffi::check(function, call(self.model().as_ptr(), self.as_ptr()))
    }

    /// Makes a guarded call that writes to the data or to its stack, but neither warns nor computes what [`Computed`] tracks. An
    /// engine error poisons the data.
    #[inline]
    pub(crate) fn call_mut(
        &mut self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        let status = call(self.model().as_ptr(), self.as_mut_ptr());
        ffi::check(function, status).map_err(|error| self.poison(error))
    }

    /// Makes a guarded call of a part of the pipeline, which may warn, reset the data and call closures, and records what is
    /// computed afterwards. An engine error, a failed closure and a reset by the engine poison the data.
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
                // Calls that leave nothing computed, such as finite differences, still run the whole pipeline.
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

    #[cold]
    #[allow(clippy::too_many_arguments, reason = "the whole state of a call, in a cold function")]
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
            Some(error) => Err(self.poison(error)),
        }
    }

    /// Makes the data unusable until a reset.
    #[cold]
    fn poison(&mut self, error: Error) -> Error {
        self.computed = Computed::empty();
        self.failure = Some(error.to_string().into());
        error
    }
}

/// Makes a call on a model with an adhesion actuator, for which a full constraint buffer has to be an error.
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

#[cfg(test)]
mod tests;
