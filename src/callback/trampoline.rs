//! What the engine calls, and how it finds the closure: a thread-local says which simulation the thread is computing.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::ffi::c_int;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;

use mujoco_sys::{callback as asked, mjData, mjModel, mjSTAGE_POS, mjSTAGE_VEL, mjtNum};

use super::scope::Slot;
use super::{Callbacks, ControlMoment, PassiveMoment, SensorMoment};
use crate::data::{Computed, Data};
use crate::error::Error;
use crate::ffi;
use crate::id::Id;

/// Why a closure has ended the call that ran it.
pub(crate) type Failure = Error;

/// The simulation that this thread is computing, while that has callbacks.
struct Present {
    data: *mut Data,
    raw: *const mjData,
    /// What the call computes, from what there was before it.
    reaches: Computed,
    callbacks: *mut Callbacks<'static>,
    failure: RefCell<Option<Failure>>,
}

thread_local! {
    static PRESENT: Cell<*const Present> = const { Cell::new(ptr::null()) };
}

/// Puts the outer simulation back: a closure of one may run another.
struct Restore(*const Present);

impl Drop for Restore {
    fn drop(&mut self) {
        PRESENT.set(self.0);
    }
}

/// Makes `call`, an engine call for `data`, with the closures in `slot`. Also returns why one of them has ended it, if so. The
/// caller borrows `data` exclusively and does not use that borrow until this returns.
pub(crate) fn computing(
    data: *mut Data,
    raw: *const mjData,
    reaches: Computed,
    slot: &Slot,
    call: impl FnOnce() -> c_int,
) -> (c_int, Option<Failure>) {
    let mut callbacks = slot.innermost();
    let Some(callbacks) = callbacks.as_mut().and_then(|callbacks| callbacks.as_mut()) else { return (call(), None) };
    let present = Present { data, raw, reaches, callbacks: ptr::from_mut(callbacks), failure: RefCell::new(None) };
    let status = {
        let _restore = Restore(PRESENT.replace(&raw const present));
        call()
    };
    (status, present.failure.into_inner())
}

/// Has the engine ask for what these closures answer.
pub(super) fn install(callbacks: &Callbacks<'_>) {
    for (what, wanted) in [
        (asked::CONTROL, callbacks.control.is_some()),
        (asked::PASSIVE, callbacks.passive.is_some()),
        (asked::SENSOR, callbacks.sensor.is_some()),
        (asked::CONTACT_FILTER, callbacks.contact_filter.is_some()),
        (asked::ACTUATOR_DYNAMICS, callbacks.actuator_dynamics.is_some()),
        (asked::ACTUATOR_GAIN, callbacks.actuator_gain.is_some()),
        (asked::ACTUATOR_BIAS, callbacks.actuator_bias.is_some()),
    ] {
        if wanted {
            // SAFETY: the handler looks at nothing but its own thread's simulation, catches every panic, and raises no error.
            unsafe { asked::install_callback(what, handler) };
        }
    }
}

/// Answers for the simulation that the thread is computing, and for no other: those keep the value that the engine brings.
unsafe extern "C" fn handler(
    what: c_int,
    _: *const mjModel,
    raw: *mut mjData,
    first: c_int,
    second: c_int,
    value: *mut mjtNum,
) -> c_int {
    // A thread that is ending has no thread-locals, and no simulation that it computes.
    let present = PRESENT.try_with(Cell::get).unwrap_or(ptr::null());
    // SAFETY: not NULL only while `computing` is in this thread, above this frame; it keeps `present` alive.
    let Some(present) = (unsafe { present.as_ref() }) else { return 0 };
    if !ptr::eq(present.raw, raw) {
        return 0;
    }
    // SAFETY: `computing` holds the lock of the slot, and a closure cannot run its own simulation, so there is no other borrow.
    let callbacks = unsafe { &mut *present.callbacks };
    // SAFETY: the simulation is borrowed exclusively by the call above this frame, which waits for the engine and derived the
    // pointer from that borrow.
    let data = unsafe { &mut *present.data };
    // SAFETY: the shim passes a place of its own.
    let value = unsafe { &mut *value };
    let question = Question { what, first: ffi::size(first), second: ffi::size(second) };
    let answer = catch_unwind(AssertUnwindSafe(|| {
        data.is_at(question.moment() & present.reaches);
        question.put(callbacks, data, value)
    }));
    let failure = match answer {
        Ok(Ok(())) => return 0,
        Ok(Err(failure)) => failure,
        Err(payload) => Error::Callback { callback: question.name(), message: message_of(payload) },
    };
    *present.failure.borrow_mut() = Some(failure);
    1
}

/// What the engine asks for.
struct Question {
    what: c_int,
    first: usize,
    second: usize,
}

impl Question {
    fn put(&self, callbacks: &mut Callbacks<'static>, data: &Data, value: &mut f64) -> Result<(), Failure> {
        let lineage = data.model().lineage();
        match self.what {
            asked::CONTROL => {
                if let Some(control) = &mut callbacks.control {
                    control(&mut ControlMoment::new(data));
                    // The engine would set all of them to zero.
                    data.check_inputs()?;
                }
            }
            asked::PASSIVE => {
                if let Some(passive) = &mut callbacks.passive {
                    passive(&mut PassiveMoment::new(data));
                }
            }
            asked::SENSOR => {
                if let Some(sensor) = &mut callbacks.sensor {
                    sensor(&mut SensorMoment::new(data));
                }
            }
            asked::CONTACT_FILTER => {
                if let Some(filter) = &mut callbacks.contact_filter {
                    let geoms = [self.first, self.second].map(|geom| Id::new(geom, lineage));
                    *value = f64::from(u8::from(!filter(data, geoms, *value == 0.0)));
                }
            }
            _ => {
                let answer = match self.what {
                    asked::ACTUATOR_DYNAMICS => &mut callbacks.actuator_dynamics,
                    asked::ACTUATOR_GAIN => &mut callbacks.actuator_gain,
                    _ => &mut callbacks.actuator_bias,
                };
                if let Some(answer) = answer {
                    *value = answer(data, Id::new(self.first, lineage));
                }
            }
        }
        Ok(())
    }

    /// Results that exist at the time of the question, if the call runs the whole pipeline.
    fn moment(&self) -> Computed {
        const POSITION: usize = mjSTAGE_POS as usize;
        const VELOCITY: usize = mjSTAGE_VEL as usize;
        match (self.what, self.first) {
            (asked::CONTACT_FILTER, _) => Computed::KINEMATICS,
            (asked::SENSOR, POSITION) => Computed::POSITION | Computed::SENSOR_POS,
            (asked::PASSIVE, _) => Computed::BEFORE_PASSIVE,
            (asked::SENSOR, stage) if stage != VELOCITY => Computed::FORCES | Computed::SENSORS,
            _ => Computed::VELOCITY | Computed::SENSOR_POS | Computed::SENSOR_VEL,
        }
    }

    fn name(&self) -> &'static str {
        match self.what {
            asked::CONTROL => "control",
            asked::PASSIVE => "passive",
            asked::SENSOR => "sensor",
            asked::CONTACT_FILTER => "contact_filter",
            asked::ACTUATOR_DYNAMICS => "actuator_dynamics",
            asked::ACTUATOR_GAIN => "actuator_gain",
            _ => "actuator_bias",
        }
    }
}

/// What a panic says.
fn message_of(payload: Box<dyn Any + Send>) -> String {
    let message = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without a text".to_owned());
    // It is the user's type, and dropping it may panic again.
    std::mem::forget(payload);
    message
}
