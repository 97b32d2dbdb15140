//! Work on many things side by side, in chunks.
//!
//! The outputs are cut in two until the parts are small, and the halves are offered to the threads of rayon's present pool. What
//! each part of the outputs is made of depends on nothing but its own inputs, so where it is made, and how it was cut, do not
//! show in the result.

use std::sync::atomic::{AtomicBool, Ordering};

/// Outputs of a number of simulations, each with its own part.
pub(super) trait Split: Sized + Send {
    /// How many simulations.
    fn count(&self) -> usize;

    /// The first ones and the others.
    fn split(self, first: usize) -> (Self, Self);
}

/// How many simulations a thread takes at a time, where nobody said: a few parts for each thread, so that one with long parts
/// can leave some to the others.
pub(super) fn default_chunk(count: usize) -> usize {
    const PARTS_PER_THREAD: usize = 8;
    count.div_ceil(PARTS_PER_THREAD * rayon::current_num_threads()).max(1)
}

/// Calls `work` with parts of up to `chunk` simulations and with the index of the first of each.
pub(super) fn in_chunks<T: Split>(all: T, first: usize, chunk: usize, work: &(impl Fn(usize, T) + Sync)) {
    let count = all.count();
    if count <= chunk {
        return work(first, all);
    }
    let half = count.div_ceil(chunk) / 2 * chunk;
    let (low, high) = all.split(half);
    rayon::join(|| in_chunks(low, first, chunk, work), || in_chunks(high, first + half, chunk, work));
}

/// Cuts a buffer of this many values for each simulation.
pub(super) fn split_rows(values: &mut [f64], first: usize, width: usize) -> (&mut [f64], &mut [f64]) {
    values.split_at_mut(first * width)
}

/// Tells all threads to stop when it is dropped, which a panic does; otherwise it is to be disarmed.
pub(super) struct StopOnPanic<'s>(&'s AtomicBool);

impl<'s> StopOnPanic<'s> {
    pub(super) fn new(stop: &'s AtomicBool) -> Self {
        Self(stop)
    }

    pub(super) fn disarm(self) {
        std::mem::forget(self);
    }
}

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
