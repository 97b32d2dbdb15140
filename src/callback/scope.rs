//! From when to when the closures are called.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Callbacks, trampoline};
use crate::data::Data;

/// Where the closures of a scope are while it lasts, and nothing afterwards. A simulation holds on to the place rather than to
/// them, because safe code may swap two simulations: one that leaves the scope finds the place empty, and goes on with that of
/// the scope around it.
#[derive(Debug)]
pub(crate) struct Slot {
    callbacks: Mutex<Option<Callbacks<'static>>>,
    outer: Option<Arc<Slot>>,
}

impl Slot {
    fn lock(&self) -> MutexGuard<'_, Option<Callbacks<'static>>> {
        self.callbacks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The innermost of these places whose scope still lasts.
    fn lasting(mut slot: Option<Arc<Self>>) -> Option<Arc<Self>> {
        while let Some(present) = slot.take_if(|slot| slot.lock().is_none()) {
            slot.clone_from(&present.outer);
        }
        slot
    }

    /// The closures of the innermost scope that still lasts. They are there as long as the lock is held.
    pub(super) fn innermost(&self) -> Option<MutexGuard<'_, Option<Callbacks<'static>>>> {
        let mut slot = self;
        loop {
            let callbacks = slot.lock();
            if callbacks.is_some() {
                return Some(callbacks);
            }
            slot = slot.outer.as_deref()?;
        }
    }
}

/// Empties the place at the end of the scope, also if that is a panic.
struct End(Arc<Slot>);

impl Drop for End {
    fn drop(&mut self) {
        // Waits for a call in another thread that is using them.
        let callbacks = self.0.lock().take();
        drop(callbacks);
    }
}

impl Data {
    /// Runs `run` with these closures in place: every call in it that computes something of this simulation, in whichever
    /// thread, calls them where the engine has come so far. See [`callback`](crate::callback). Clones do not have them. A scope
    /// within a scope has its own closures only.
    ///
    /// ```
    /// use mujoco_safe::{Callbacks, Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.1;
    /// let mut pushes = Vec::new();
    /// let balance = Callbacks::new().control(|moment| {
    ///     let push = 30.0 * moment.qpos()[1] + 5.0 * moment.qvel()[1];
    ///     moment.ctrl_mut()[0] = push;
    ///     pushes.push(push);
    /// });
    /// data.with_callbacks(balance, |data| (0..200).try_for_each(|_| data.step()))?;
    /// assert_eq!(pushes.len(), 200);
    /// assert!(data.qpos()[1].abs() < 0.1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// What the scope is given cannot leave it:
    ///
    /// ```compile_fail,E0521
    /// # use mujoco_safe::{Callbacks, Data, sample};
    /// let mut data = Data::new(sample::cartpole()).unwrap();
    /// let mut kept = None;
    /// let callbacks = Callbacks::new().control(|moment| kept = Some(moment.ctrl_mut())); // borrowed data escapes
    /// data.with_callbacks(callbacks, |data| data.step()).unwrap();
    /// ```
    #[doc(alias = "mjcb_control")]
    #[doc(alias = "mjcb_passive")]
    pub fn with_callbacks<R>(&mut self, callbacks: Callbacks<'_>, run: impl FnOnce(&mut Self) -> R) -> R {
        trampoline::install(&callbacks);
        // SAFETY: only the lifetime changes. `end` takes the closures out of the slot before this function returns or unwinds,
        // so before what they borrow can end, and they are called in no other way than through the slot, under its lock.
        let callbacks = unsafe { std::mem::transmute::<Callbacks<'_>, Callbacks<'static>>(callbacks) };
        let slot =
            Arc::new(Slot { callbacks: Mutex::new(Some(callbacks)), outer: Slot::lasting(self.callbacks.take()) });
        let end = End(slot.clone());
        self.callbacks = Some(slot.clone());
        let result = run(self);
        // Unless `run` has put another simulation in the place of this one.
        if self.callbacks.as_ref().is_some_and(|present| Arc::ptr_eq(present, &slot)) {
            self.callbacks.clone_from(&slot.outer);
        }
        drop(end);
        result
    }
}
