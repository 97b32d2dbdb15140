//! The function that the engine calls. It finds the closure through a thread-local that refers to
//! the simulation in progress.

use std::cell::{Cell, RefCell};
use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{callback, mjData, mjModel, mjSTAGE_POS, mjSTAGE_VEL, mjtNum};

use super::{Callbacks, ControlContext, PassiveContext, SensorContext};
use crate::data::{Data, EngineCallbacks, PipelineFlags};
use crate::error::{Error, Result, catch_panic};
use crate::ffi;
use crate::id::Id;

/// Engine call in progress in this thread, on a simulation with callbacks.
struct ActiveCall {
    data: *mut Data,
    raw: *const mjData,
    /// Results that the call computes.
    results: PipelineFlags,
    callbacks: *mut Callbacks<'static>,
    /// Error of the closure that ended the call.
    failure: RefCell<Option<Error>>,
}

thread_local! {
    static ACTIVE: Cell<*const ActiveCall> = const { Cell::new(ptr::null()) };
}

/// Restores the outer call when dropped. Calls nest when a closure steps another simulation.
struct RestoreOuter(*const ActiveCall);

impl Drop for RestoreOuter {
    fn drop(&mut self) {
        ACTIVE.set(self.0);
    }
}

impl EngineCallbacks for Callbacks<'_> {
    unsafe fn run(
        &mut self,
        data: *mut Data,
        raw: *const mjData,
        results: PipelineFlags,
        call: &mut dyn FnMut() -> c_int,
    ) -> (c_int, Option<Error>) {
        // The pointer is used only until this returns, so the lifetime of the borrows does not
        // matter.
        let callbacks = ptr::from_mut(self).cast::<Callbacks<'static>>();
        let active = ActiveCall { data, raw, results, callbacks, failure: RefCell::new(None) };
        let status = {
            let _restore = RestoreOuter(ACTIVE.replace(&raw const active));
            call()
        };
        (status, active.failure.into_inner())
    }
}

/// Installs the engine callbacks that these closures need.
pub(super) fn install(callbacks: &Callbacks<'_>) {
    for kind in callbacks.present() {
        // SAFETY: the handler accesses only the simulation of its own thread, catches every panic,
        // and raises no engine error.
        unsafe { callback::install_callback(kind, handler) };
    }
}

/// Calls the closure of the simulation that this thread is computing. For other simulations `value`
/// is unchanged, which is the engine's behaviour without a callback.
unsafe extern "C" fn handler(
    kind: c_int,
    _: *const mjModel,
    raw: *mut mjData,
    first: c_int,
    second: c_int,
    value: *mut mjtNum,
) -> c_int {
    // The thread-local is destroyed in a thread that is ending, but then no call is active.
    let active = ACTIVE.try_with(Cell::get).unwrap_or(ptr::null());
    // SAFETY: not NULL only while `EngineCallbacks::run` is on the stack of this thread, and `run`
    // owns the value.
    let Some(active) = (unsafe { active.as_ref() }) else { return 0 };
    if !ptr::eq(active.raw, raw) {
        return 0;
    }
    // SAFETY: `run` borrows the callbacks exclusively under the lock of their slot, and a closure
    // cannot step its own simulation, so no other reference exists.
    let callbacks = unsafe { &mut *active.callbacks };
    // SAFETY: the caller of `run` borrows the simulation exclusively, derived the pointer from that
    // borrow, and does not use it before the engine returns.
    let data = unsafe { &mut *active.data };
    // SAFETY: the shim passes a valid pointer to a local variable.
    let value = unsafe { &mut *value };
    let request = Request { kind, first: ffi::size(first), second: ffi::size(second) };
    let result = catch_panic(|| {
        data.set_computed(request.valid_results() & active.results);
        request.call_closure(callbacks, data, value)
    });
    let failure = match result {
        Ok(Ok(())) => return 0,
        Ok(Err(failure)) => failure,
        Err(message) => Error::Callback { callback: callback_name(kind), message },
    };
    *active.failure.borrow_mut() = Some(failure);
    1
}

/// Callback request of the engine.
struct Request {
    kind: c_int,
    /// Stage, geom or actuator.
    first: usize,
    /// Second geom.
    second: usize,
}

impl Request {
    fn call_closure(&self, callbacks: &mut Callbacks<'_>, data: &Data, value: &mut f64) -> Result<()> {
        let lineage = data.model().lineage();
        match self.kind {
            callback::CONTROL => {
                if let Some(control) = &mut callbacks.control {
                    control(&mut ControlContext::new(data));
                    // The engine would set all controls to zero.
                    data.check_inputs()?;
                }
            }
            callback::PASSIVE => {
                if let Some(passive) = &mut callbacks.passive {
                    passive(&mut PassiveContext::new(data));
                }
            }
            callback::SENSOR => {
                if let Some(sensor) = &mut callbacks.sensor {
                    sensor(&mut SensorContext::new(data));
                }
            }
            callback::CONTACT_FILTER => {
                if let Some(filter) = &mut callbacks.contact_filter {
                    let geoms = [self.first, self.second].map(|geom| Id::new(geom, lineage));
                    *value = f64::from(u8::from(!filter(data, geoms, *value == 0.0)));
                }
            }
            callback::ACTUATOR_DYNAMICS if data.model().activations_of(self.first).len() > 1 => {
                // The engine ignores the value.
                if callbacks.actuator_dynamics.is_some() {
                    return Err(Error::Unsupported(format!(
                        "the callback actuator_dynamics returns one derivative, but actuator {} has several activations",
                        self.first
                    )));
                }
            }
            _ => {
                let closure = match self.kind {
                    callback::ACTUATOR_DYNAMICS => &mut callbacks.actuator_dynamics,
                    callback::ACTUATOR_GAIN => &mut callbacks.actuator_gain,
                    _ => &mut callbacks.actuator_bias,
                };
                if let Some(closure) = closure {
                    *value = closure(data, Id::new(self.first, lineage));
                }
            }
        }
        Ok(())
    }

    /// Returns the results that are valid at this point if the engine call runs the whole pipeline.
    fn valid_results(&self) -> PipelineFlags {
        const POSITION: usize = mjSTAGE_POS as usize;
        const VELOCITY: usize = mjSTAGE_VEL as usize;
        match (self.kind, self.first) {
            (callback::CONTACT_FILTER, _) => PipelineFlags::KINEMATICS,
            (callback::SENSOR, POSITION) => PipelineFlags::POSITION | PipelineFlags::SENSOR_POS,
            (callback::PASSIVE, _) => PipelineFlags::BEFORE_PASSIVE,
            (callback::SENSOR, stage) if stage != VELOCITY => PipelineFlags::FORCES | PipelineFlags::SENSORS,
            _ => PipelineFlags::VELOCITY | PipelineFlags::SENSOR_POS | PipelineFlags::SENSOR_VEL,
        }
    }
}

/// Returns the name of the method of [`Callbacks`] that sets a callback.
pub(super) fn callback_name(kind: c_int) -> &'static str {
    match kind {
        callback::CONTROL => "control",
        callback::PASSIVE => "passive",
        callback::SENSOR => "sensor",
        callback::CONTACT_FILTER => "contact_filter",
        callback::ACTUATOR_DYNAMICS => "actuator_dynamics",
        callback::ACTUATOR_GAIN => "actuator_gain",
        _ => "actuator_bias",
    }
}
