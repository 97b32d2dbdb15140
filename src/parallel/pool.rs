//! Pool of simulations that threads use one after another.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::Result;
use crate::model::Model;

/// Pool of simulations of one model, or of values that contain a simulation. There are as many as
/// threads have been active at the same time.
pub(crate) struct Pool<T> {
    model: Arc<Model>,
    create: fn(&Arc<Model>) -> Result<T>,
    idle: Mutex<Vec<T>>,
}

impl<T> Pool<T> {
    /// Creates an empty pool. `create` creates a value for a thread that finds no idle one.
    pub(crate) fn new(model: Arc<Model>, create: fn(&Arc<Model>) -> Result<T>) -> Self {
        Self { model, create, idle: Mutex::default() }
    }

    #[inline]
    pub(crate) fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Returns the number of idle values.
    pub(crate) fn idle(&self) -> usize {
        self.lock().len()
    }

    /// Returns a place for a value.
    pub(crate) fn lease(&self) -> Lease<'_, T> {
        Lease { pool: self, value: None }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<T>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Place of a thread for a value of a pool: empty until the first [`get`](Self::get). The value
/// returns to the pool at the end, except after a panic, which may have interrupted a change.
pub(crate) struct Lease<'p, T> {
    pool: &'p Pool<T>,
    value: Option<T>,
}

impl<T> Lease<'_, T> {
    /// Returns the value. The first call takes an idle value, or creates one.
    pub(crate) fn get(&mut self) -> Result<&mut T> {
        if self.value.is_none() {
            // A separate statement, which unlocks before `create` runs.
            let idle = self.pool.lock().pop();
            self.value = Some(idle.map_or_else(|| (self.pool.create)(&self.pool.model), Ok)?);
        }
        Ok(self.value.as_mut().expect("Bug: the place has been filled"))
    }
}

impl<T> Drop for Lease<'_, T> {
    fn drop(&mut self) {
        if let Some(value) = self.value.take()
            && !std::thread::panicking()
        {
            self.pool.lock().push(value);
        }
    }
}
