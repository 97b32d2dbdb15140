//! Calls of the engine on a simulation, and the effect of an engine error.
//!
//! Every call that can raise an engine error on a [`Data`] goes through one of four methods, which
//! differ in the pointer that they pass:
//!
//! | method | passes | for | after an engine error |
//! |---|---|---|---|
//! | [`Data::run`] | `*mut mjData` | parts of the pipeline, which may warn, reset the data and call closures | poisoned |
//! | [`Data::call_mut`] | `*mut mjData` | every other function that writes to the data or to its stack | poisoned |
//! | [`Data::call_on_stack`] | `*mut mjData` | functions that use its stack only | unchanged |
//! | [`Data::call`] | `*const mjData` | functions that only read | unchanged |
//!
//! Calls without a simulation go through [`ffi::check_without_data`]. The lint `disallowed_methods`
//! (`clippy.toml`) forbids [`ffi::check`], which all of these use, in the other files.

#![allow(clippy::disallowed_methods, reason = "the methods that the lint recommends")]

use std::ffi::c_int;

use mujoco_sys::{guard, mjData, mjModel};

use super::warning::{self, CounterChange, SavedCounters};
use super::{Data, PipelineFlags};
use crate::error::{Error, Result};
use crate::{ffi, messages};

impl Data {
    /// Makes a guarded call that only reads the data. An engine error leaves the data usable,
    /// because the call cannot change it.
    #[inline]
    pub(crate) fn call(
        &self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *const mjData) -> c_int,
    ) -> Result<()> {
        ffi::check(function, call(self.model().as_ptr(), self.as_ptr()))
    }

    /// Makes a guarded call that writes to the data or to its stack, but neither warns nor computes
    /// results that [`PipelineFlags`] records. An engine error poisons the data.
    #[inline]
    pub(crate) fn call_mut(
        &mut self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        let status = call(self.model().as_ptr(), self.as_mut_ptr());
        ffi::check(function, status).map_err(|error| self.poison(error))
    }

    /// Makes a guarded call that uses only the stack of the data. An engine error leaves the data
    /// usable, because the shim releases the stack.
    #[inline]
    pub(crate) fn call_on_stack(
        &mut self,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        ffi::check(function, call(self.model().as_ptr(), self.as_mut_ptr()))
    }

    /// Makes a guarded call of a part of the pipeline, which may warn, reset the data and call
    /// closures, and records `computes` as the valid results. An engine error, a failed closure and
    /// a reset by the engine poison the data.
    #[inline]
    pub(crate) fn run(
        &mut self,
        function: &'static str,
        computes: PipelineFlags,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<()> {
        let time = self.time();
        #[cfg(engine_since = "3.5.0")]
        self.clear_lazy_results();
        let counters = SavedCounters::replace(self.raw_mut());
        let (model, data) = (self.model().as_ptr(), self.as_mut_ptr());
        let (status, failure) = if self.has_callbacks() || self.model().needs_constraints() {
            self.call_with_handlers(computes, call)
        } else {
            (call(model, data), None)
        };
        self.clear_absent_constraints();
        let change = counters.restore(self.raw_mut());
        if status == guard::OK && change == CounterChange::None {
            self.computed = computes;
            messages::log_after_call();
            return Ok(());
        }
        self.finish(function, computes, time, &counters, status, change, failure)
    }

    /// Clears the flags by which newer engines skip energies, velocities of subtrees and forces on
    /// bodies that sensors need. The engine clears them in whole stages only, so a sensor stage
    /// after single parts would read values of an earlier state.
    #[cfg(engine_since = "3.5.0")]
    fn clear_lazy_results(&mut self) {
        let raw = self.raw_mut();
        (raw.flg_energypos, raw.flg_energyvel, raw.flg_subtreevel, raw.flg_rnepost) = (0, 0, 0, 0);
    }

    /// Makes the call of [`run`](Self::run) for a simulation with callbacks or with constraints
    /// that the engine needs. Returns its status, and the error if a closure failed.
    fn call_with_handlers(
        &mut self,
        computes: PipelineFlags,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> (c_int, Option<Error>) {
        let (model, data) = (self.model().as_ptr(), self.as_mut_ptr());
        let (is_handled, is_fatal) = (self.model().needs_constraints(), self.model().has_adhesion());
        let mut call = Some(call);
        let mut call = || {
            let call = call.take().expect("Bug: an engine call is made twice");
            if is_handled { warning::with_full_constraints(is_fatal, model, data, call) } else { call(model, data) }
        };
        // Calls that leave no valid results, such as finite differences, still run the whole
        // pipeline.
        let results = if computes.is_empty() { PipelineFlags::AFTER_FORWARD } else { computes };
        self.call_with_callbacks(results, &mut call)
    }

    /// Clears the numbers of the kinds of constraints if there are none. Engines since 2.3 keep
    /// them when they remove the constraints, and the visualiser would read the rows.
    #[inline]
    #[cfg_attr(not(engine_since = "2.3.0"), allow(clippy::unused_self, reason = "2.2.2 keeps no numbers"))]
    pub(crate) fn clear_absent_constraints(&mut self) {
        #[cfg(engine_since = "2.3.0")]
        if self.raw().nefc == 0 {
            let raw = self.raw_mut();
            (raw.ne, raw.nf) = (0, 0);
            #[cfg(engine_since = "3.0.0")]
            {
                raw.nl = 0;
            }
        }
    }

    /// Logs the new warnings of a call, or poisons the data if the call failed.
    #[cold]
    #[allow(clippy::too_many_arguments, reason = "the complete state of a call, in a cold function")]
    fn finish(
        &mut self,
        function: &'static str,
        computes: PipelineFlags,
        time: f64,
        counters: &SavedCounters,
        status: c_int,
        change: CounterChange,
        failure: Option<Error>,
    ) -> Result<()> {
        let error = match ffi::check(function, status) {
            // The engine only reports that a closure has failed; `failure` has the cause.
            Err(error) => Some(failure.unwrap_or(error)),
            Ok(()) if change == CounterChange::Reset => Some(Error::Unstable(self.instability_after_reset(time))),
            Ok(()) => None,
        };
        match error {
            None => {
                self.computed = computes;
                self.log_new_warnings(counters);
                Ok(())
            }
            Some(error) => Err(self.poison(error)),
        }
    }

    /// Makes the data unusable until a reset.
    #[cold]
    fn poison(&mut self, error: Error) -> Error {
        self.computed = PipelineFlags::empty();
        self.failure = Some(error.to_string().into());
        error
    }
}
