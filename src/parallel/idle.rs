//! Simulations between two uses.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::Result;

/// Pool of idle simulations, or of values that contain a simulation. There are as many as threads
/// have been active at the same time.
#[derive(Debug)]
pub(crate) struct Idle<T>(Mutex<Vec<T>>);

impl<T> Default for Idle<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Idle<T> {
    /// Takes an idle value, or creates a value.
    pub(crate) fn take(&self, create: impl FnOnce() -> Result<T>) -> Result<T> {
        // A separate statement, which unlocks before `create` runs.
        let idle = self.lock().pop();
        idle.map_or_else(create, Ok)
    }

    pub(crate) fn give_back(&self, value: T) {
        self.lock().push(value);
    }

    /// Drops all idle values.
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
