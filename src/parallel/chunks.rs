//! Parallel work on chunks of simulations.
//!
//! The outputs are split recursively until the parts are small, and the halves run in parallel on
//! the current rayon pool. Each part depends only on its own inputs, so the result does not depend
//! on threads or on the splits.

use std::sync::atomic::{AtomicBool, Ordering};

/// Outputs of several simulations, divided into one part per simulation.
pub(crate) trait Split: Sized + Send {
    /// Returns the number of simulations.
    fn count(&self) -> usize;

    /// Splits off the first simulations from the others.
    fn split(self, first: usize) -> (Self, Self);
}

/// Returns the default number of simulations that a thread takes at a time. It yields several
/// chunks for each thread, which balances the load.
pub(crate) fn default_chunk(count: usize) -> usize {
    const PARTS_PER_THREAD: usize = 8;
    count.div_ceil(PARTS_PER_THREAD * rayon::current_num_threads()).max(1)
}

/// Calls `work` with parts of up to `chunk` simulations and the index of the first simulation of
/// each.
pub(crate) fn in_chunks<T: Split>(all: T, first: usize, chunk: usize, work: &(impl Fn(usize, T) + Sync)) {
    let count = all.count();
    if count <= chunk {
        return work(first, all);
    }
    let half = count.div_ceil(chunk) / 2 * chunk;
    let (low, high) = all.split(half);
    rayon::join(|| in_chunks(low, first, chunk, work), || in_chunks(high, first + half, chunk, work));
}

/// Guard that sets a stop flag when a panic drops it. Without a panic, the owner must
/// [`disarm`](Self::disarm) it.
pub(crate) struct StopOnPanic<'s>(&'s AtomicBool);

impl<'s> StopOnPanic<'s> {
    pub(crate) fn new(stop: &'s AtomicBool) -> Self {
        Self(stop)
    }

    pub(crate) fn disarm(self) {
        std::mem::forget(self);
    }
}

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
