//! Work shared by a few threads, of which the caller's is one.
//!
//! A linearisation takes less than a millisecond, and a thread that sleeps takes a good part of that to wake up. So nobody waits
//! for anybody: the caller begins at once, whoever comes later takes what is left, one piece after another, and where nobody
//! comes the caller does it all. Who does what shows in no result.

use std::hint;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Fewest pieces of work that are worth joining in for.
const WORTH_IT: usize = 4;

/// How often the caller looks whether the others have finished before it goes to sleep: longer than a piece of work takes.
const LOOKS: usize = 20_000;

/// Pieces of work, taken in turn.
pub(super) struct Queue<I>(Mutex<I>);

impl<I: ExactSizeIterator> Queue<I> {
    pub(super) fn new(pieces: impl IntoIterator<IntoIter = I>) -> Self {
        Self(Mutex::new(pieces.into_iter()))
    }

    /// The next piece.
    pub(super) fn take(&self) -> Option<I::Item> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).next()
    }

    /// Whether there is enough left for one more to join in.
    pub(super) fn is_worth_joining(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len() >= WORTH_IT
    }
}

/// Calls `work` for each member: for the first in this thread, and for the others in rayon's present pool, as far as it has threads to
/// spare. The argument is whether a member is the first.
pub(super) fn together<W: Send>(team: &mut [W], work: impl Fn(&mut W, bool) + Sync) {
    let Some((first, others)) = team.split_first_mut() else { return };
    if others.is_empty() {
        return work(first, true);
    }
    let busy = AtomicUsize::new(0);
    let (busy, work) = (&busy, &work);
    rayon::in_place_scope(|scope| {
        for member in others {
            scope.spawn(move |_| {
                busy.fetch_add(1, Ordering::Relaxed);
                work(member, false);
                busy.fetch_sub(1, Ordering::Relaxed);
            });
        }
        work(first, true);
        // Whoever is still at it has a single piece to finish. To sleep and be woken would take longer.
        for _ in 0..LOOKS {
            if busy.load(Ordering::Relaxed) == 0 {
                break;
            }
            hint::spin_loop();
        }
    });
}
