//! Simulations that wait for their next use.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::Result;

/// Idle simulations, or what contains them: as many as threads have been active at the same time.
#[derive(Debug)]
pub(crate) struct Idle<T>(Mutex<Vec<T>>);

impl<T> Default for Idle<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Idle<T> {
    /// Takes one that is idle, or creates one.
    pub(crate) fn take(&self, create: impl FnOnce() -> Result<T>) -> Result<T> {
        // A separate statement, which unlocks before `create` runs.
        let idle = self.lock().pop();
        idle.map_or_else(create, Ok)
    }

    pub(crate) fn give_back(&self, one: T) {
        self.lock().push(one);
    }

    /// Drops those that are idle.
    pub(crate) fn clear(&self) {
        self.lock().clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.lock().len()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
