//! Callbacks of a simulation: callbacks of the enclosing scopes, and callbacks that the simulation
//! owns.

use std::ffi::c_int;
use std::panic::AssertUnwindSafe;
use std::ptr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mujoco_sys::mjData;

use super::{Data, PipelineFlags};
use crate::error::Error;

/// Closures that the engine calls during a call on a simulation. Implemented by
/// [`Callbacks`](crate::callback::Callbacks).
pub(crate) trait EngineCallbacks: Send {
    /// Makes an engine call with these closures registered for the current thread. `results` are
    /// the results that the call computes. Returns the status of the call, and the error if a
    /// closure failed.
    ///
    /// # Safety
    ///
    /// `data` is derived from an exclusive borrow that the caller does not use until this returns,
    /// and `raw` is its pointer to the engine's data.
    unsafe fn run(
        &mut self,
        data: *mut Data,
        raw: *const mjData,
        results: PipelineFlags,
        call: &mut dyn FnMut() -> c_int,
    ) -> (c_int, Option<Error>);
}

/// Callbacks of a simulation. If it is within a scope, only the callbacks of the innermost scope
/// are called.
#[derive(Default)]
pub(super) struct ActiveCallbacks {
    /// Callbacks of the innermost [`Data::with_callbacks`].
    scope: Option<Arc<CallbackSlot>>,
    own: OwnCallbacks,
}

/// Callbacks of [`Data::set_callbacks`]. A panic in a closure poisons the simulation, so unwinding
/// exposes no broken state.
#[derive(Default)]
pub(crate) struct OwnCallbacks(Option<AssertUnwindSafe<Box<dyn EngineCallbacks>>>);

// SAFETY: a shared reference gives no access to the closures.
unsafe impl Sync for OwnCallbacks {}

impl OwnCallbacks {
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_none()
    }
}

impl Data {
    /// Returns `true` if a call on this simulation may call closures.
    #[inline]
    pub(crate) fn has_callbacks(&self) -> bool {
        self.callbacks.scope.is_some() || !self.callbacks.own.is_empty()
    }

    /// Replaces the callbacks that this simulation owns.
    pub(crate) fn replace_own_callbacks(&mut self, callbacks: Option<Box<dyn EngineCallbacks>>) {
        self.callbacks.own = OwnCallbacks(callbacks.map(AssertUnwindSafe));
    }

    /// Exchanges the callbacks that this simulation owns for others.
    pub(crate) fn swap_own_callbacks(&mut self, callbacks: &mut OwnCallbacks) {
        std::mem::swap(&mut self.callbacks.own, callbacks);
    }

    /// Makes an engine call with the callbacks of the innermost scope, else with those that this
    /// simulation owns. The call computes these `results`.
    pub(super) fn call_with_callbacks(
        &mut self,
        results: PipelineFlags,
        call: &mut dyn FnMut() -> c_int,
    ) -> (c_int, Option<Error>) {
        let scope = self.callbacks.scope.clone();
        // Moved out, because the closures get a reference to this simulation.
        let mut own = std::mem::take(&mut self.callbacks.own);
        let raw = self.as_ptr();
        let data = ptr::from_mut(self);
        let mut run = |callbacks: &mut dyn EngineCallbacks| {
            // SAFETY: `self` is borrowed exclusively, and not used until `run` returns.
            unsafe { callbacks.run(data, raw, results, call) }
        };
        let called = match scope.and_then(|slot| slot.with_active(&mut run)) {
            Some(called) => Some(called),
            None => own.0.as_mut().map(|own| run(&mut ***own)),
        };
        self.callbacks.own = own;
        called.unwrap_or_else(|| (call(), None))
    }

    /// Runs `run` with these callbacks active for all engine calls on this simulation.
    pub(crate) fn scope_callbacks<R>(
        &mut self,
        callbacks: Box<dyn EngineCallbacks + '_>,
        run: impl FnOnce(&mut Self) -> R,
    ) -> R {
        /// Empties the slot at the end of the scope, also during unwinding.
        struct ClearOnDrop(Arc<CallbackSlot>);

        impl Drop for ClearOnDrop {
            fn drop(&mut self) {
                // Waits for a call in another thread that is using the callbacks.
                let callbacks = self.0.lock().take();
                drop(callbacks);
            }
        }

        // SAFETY: only the lifetime changes. `clear` removes the callbacks from the slot before
        // this function returns or unwinds, so before their borrows end, and they are called only
        // through the slot, under its lock.
        let callbacks = unsafe {
            std::mem::transmute::<Box<dyn EngineCallbacks + '_>, Box<dyn EngineCallbacks + 'static>>(callbacks)
        };
        let outer = CallbackSlot::active(self.callbacks.scope.take());
        let slot = Arc::new(CallbackSlot { callbacks: Mutex::new(Some(callbacks)), outer });
        let clear = ClearOnDrop(slot.clone());
        self.callbacks.scope = Some(slot.clone());
        let result = run(self);
        // `run` may have replaced this simulation by another one with other callbacks.
        if self.callbacks.scope.as_ref().is_some_and(|present| Arc::ptr_eq(present, &slot)) {
            self.callbacks.scope.clone_from(&slot.outer);
        }
        drop(clear);
        result
    }
}

/// Callbacks of one scope. Empty after the scope has ended.
///
/// A simulation holds a slot instead of the callbacks, because safe code may swap two simulations.
/// A simulation that leaves the scope in this way finds the slot empty, and continues with the
/// callbacks of the enclosing scope.
struct CallbackSlot {
    callbacks: Mutex<Option<Box<dyn EngineCallbacks>>>,
    outer: Option<Arc<Self>>,
}

impl CallbackSlot {
    fn lock(&self) -> MutexGuard<'_, Option<Box<dyn EngineCallbacks>>> {
        self.callbacks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the innermost slot whose scope has not ended, from this one outwards.
    fn active(mut slot: Option<Arc<Self>>) -> Option<Arc<Self>> {
        while let Some(ended) = slot.take_if(|slot| slot.lock().is_none()) {
            slot.clone_from(&ended.outer);
        }
        slot
    }

    /// Runs `run` with the callbacks of the innermost scope that has not ended. Returns `None` if
    /// all have ended.
    fn with_active<R>(&self, run: impl FnOnce(&mut dyn EngineCallbacks) -> R) -> Option<R> {
        let mut slot = self;
        loop {
            // The lock keeps the scope from ending during the call.
            if let Some(callbacks) = slot.lock().as_mut() {
                return Some(run(&mut **callbacks));
            }
            slot = slot.outer.as_deref()?;
        }
    }
}
