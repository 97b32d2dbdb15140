//! A work queue shared by a few threads, one of which is the caller's.
//!
//! A linearisation takes less than a millisecond, and waking a sleeping thread takes a large
//! fraction of that time. So no thread waits for another. The caller starts at once, and threads
//! that join later take the remaining items. If none joins, the caller does all the work. The
//! result does not depend on the assignment of items to threads.

use std::hint;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Result};

/// Minimum number of remaining items for which another worker joins.
const MIN_ITEMS_TO_JOIN: usize = 4;

/// Number of spin iterations in which the caller waits for the other workers before it sleeps. They
/// take longer than an item.
const SPINS: usize = 20_000;

/// Items of work, taken in order.
pub(crate) struct WorkQueue<I>(Mutex<I>);

impl<I: ExactSizeIterator> WorkQueue<I> {
    pub(crate) fn new(items: impl IntoIterator<IntoIter = I>) -> Self {
        Self(Mutex::new(items.into_iter()))
    }

    /// Takes the next item.
    pub(crate) fn take(&self) -> Option<I::Item> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).next()
    }

    /// Returns `true` if enough items remain for another worker to join.
    pub(crate) fn is_worth_joining(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len() >= MIN_ITEMS_TO_JOIN
    }
}

/// Calls `work` for each worker: for the first in this thread, and for the others in the current
/// rayon pool as threads become available. The second argument of `work` is true for the first
/// worker. A single worker involves neither rayon nor another thread.
pub(crate) fn for_each_worker<W: Send>(workers: &mut [W], work: impl Fn(&mut W, bool) + Sync) {
    let Some((first, others)) = workers.split_first_mut() else { return };
    if others.is_empty() {
        return work(first, true);
    }
    let busy = AtomicUsize::new(0);
    let (busy, work) = (&busy, &work);
    rayon::in_place_scope(|scope| {
        for worker in others {
            scope.spawn(move |_| {
                busy.fetch_add(1, Ordering::Relaxed);
                work(worker, false);
                busy.fetch_sub(1, Ordering::Relaxed);
            });
        }
        work(first, true);
        // Workers that are still running have one item to finish. Sleeping and waking up would take
        // longer.
        for _ in 0..SPINS {
            if busy.load(Ordering::Relaxed) == 0 {
                break;
            }
            hint::spin_loop();
        }
    });
}

/// Calls `work` for each item with its index, with the workers as in [`for_each_worker`]. If it
/// fails for several items, returns the error of the first one.
pub(crate) fn for_each_item<W: Send, T: Send>(
    workers: &mut [W],
    items: &mut [T],
    work: impl Fn(&mut W, usize, &mut T) -> Result<()> + Sync,
) -> Result<()> {
    let queue = WorkQueue::new(items.iter_mut().enumerate());
    let first_error = FirstError::default();
    for_each_worker(workers, |worker, _| {
        while let Some((index, item)) = queue.take() {
            if let Err(error) = work(worker, index, item) {
                // Threads take the items in order, so the first one that fails is among those that
                // threads have taken.
                first_error.record(index, error);
                return;
            }
        }
    });
    first_error.into_result()
}

/// Error with the smallest index among those of several threads.
#[derive(Default)]
pub(crate) struct FirstError(Mutex<Option<(usize, Error)>>);

impl FirstError {
    pub(crate) fn record(&self, index: usize, error: Error) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if first.as_ref().is_none_or(|&(earlier, _)| index < earlier) {
            *first = Some((index, error));
        }
    }

    pub(crate) fn into_result(self) -> Result<()> {
        let first = self.0.into_inner().unwrap_or_else(PoisonError::into_inner);
        first.map_or(Ok(()), |(_, error)| Err(error))
    }
}
