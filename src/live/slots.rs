//! Slots between the simulation and the browsers: the latest state, and the merged requests.
//!
//! Neither slot is a queue. The simulation only tries to lock: if a browser holds a slot, the
//! simulation goes on, and tries again in a later tick.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use super::message::{Message, Pull};

/// Shortest time between two states. It limits the work of the simulation for any number of
/// browsers.
const SHORTEST_PERIOD: Duration = Duration::from_millis(8);

/// State in the form in which browsers receive it.
#[derive(Debug)]
struct Snapshot {
    /// Number of states so far.
    number: u64,
    bytes: Vec<u8>,
}

/// Requests of the users.
#[derive(Debug, Default)]
pub(super) struct Requests {
    /// Before all others. It ends the pull, and releases the controls.
    pub(super) reset: bool,
    pub(super) pause: Option<bool>,
    pub(super) steps: u32,
    /// Values of the controls that users hold, until they release them.
    pub(super) held: Vec<Option<f64>>,
    /// Client that pulls and its pull, until it lets go.
    pub(super) pull: Option<(u64, Pull)>,
}

impl Requests {
    pub(super) fn new(controls: usize) -> Self {
        Self { held: vec![None; controls], ..Self::default() }
    }

    /// Ends the pull, and releases the controls.
    pub(super) fn let_go(&mut self) {
        self.held.fill(None);
        self.pull = None;
    }

    /// Merges a valid message of a client.
    fn add(&mut self, client: u64, message: Message) {
        match message {
            Message::Pause(pause) => self.pause = Some(pause),
            Message::Step(steps) => self.steps = self.steps.saturating_add(steps),
            Message::Reset => {
                self.let_go();
                (self.reset, self.steps) = (true, 0);
            }
            Message::Hold(index, value) => self.held[index] = Some(value),
            Message::Release(index) => self.held[index] = None,
            Message::Pull(pull) => self.pull = Some((client, pull)),
            Message::LetGo if self.pull.is_some_and(|(puller, _)| puller == client) => self.pull = None,
            Message::Next | Message::LetGo => {}
        }
    }
}

/// Slots, shared by the simulation and the threads of the browsers.
#[derive(Debug)]
pub(super) struct Slots {
    is_closed: AtomicBool,
    /// A browser waits for a state. Changes while the lock of the snapshot is held.
    is_wanted: AtomicBool,
    snapshot: Mutex<Snapshot>,
    new_snapshot: Condvar,
    /// Changes while the lock of the requests is held.
    has_requests: AtomicBool,
    inbox: Mutex<Requests>,
    new_request: Condvar,
}

impl Slots {
    /// States of this size need no allocation.
    pub(super) fn new(controls: usize, size: usize) -> Self {
        Self {
            is_closed: AtomicBool::new(false),
            is_wanted: AtomicBool::new(true),
            snapshot: Mutex::new(Snapshot { number: 0, bytes: Vec::with_capacity(size) }),
            new_snapshot: Condvar::new(),
            has_requests: AtomicBool::new(false),
            inbox: Mutex::new(Requests::new(controls)),
            new_request: Condvar::new(),
        }
    }

    pub(super) fn is_closed(&self) -> bool {
        self.is_closed.load(Ordering::Acquire)
    }

    /// Ends all waits.
    pub(super) fn close(&self) {
        self.is_closed.store(true, Ordering::Release);
        drop(lock(&self.snapshot));
        self.new_snapshot.notify_all();
    }

    /// Returns `true` if a browser waits for a state, and the time of the last one is long ago.
    pub(super) fn is_wanted(&self, last: Instant) -> bool {
        self.is_wanted.load(Ordering::Acquire) && last.elapsed() >= SHORTEST_PERIOD
    }

    /// Replaces the snapshot, unless a browser is copying it.
    pub(super) fn publish(&self, write: impl FnOnce(&mut Vec<u8>)) {
        let Some(mut snapshot) = try_lock(&self.snapshot) else { return };
        write(&mut snapshot.bytes);
        snapshot.number += 1;
        self.is_wanted.store(false, Ordering::Release);
        drop(snapshot);
        self.new_snapshot.notify_all();
    }

    /// Waits for a snapshot that is written after this call, and copies it. After the timeout,
    /// copies the latest. Returns `false` if the page is closed.
    pub(super) fn next(&self, timeout: Duration, bytes: &mut Vec<u8>) -> bool {
        let latest = lock(&self.snapshot);
        let number = latest.number;
        let is_old = |snapshot: &mut Snapshot| {
            let is_old = snapshot.number == number && !self.is_closed();
            self.is_wanted.fetch_or(is_old, Ordering::AcqRel);
            is_old
        };
        let snapshot = self.new_snapshot.wait_timeout_while(latest, timeout, is_old);
        let (snapshot, _) = snapshot.unwrap_or_else(PoisonError::into_inner);
        bytes.clear();
        bytes.extend_from_slice(&snapshot.bytes);
        !self.is_closed()
    }

    /// Adds a request of a client.
    pub(super) fn request(&self, client: u64, message: Message) {
        let mut inbox = lock(&self.inbox);
        inbox.add(client, message);
        self.has_requests.store(true, Ordering::Release);
        drop(inbox);
        self.new_request.notify_one();
    }

    /// Takes the requests since the last call, unless there are none or a browser holds the lock.
    pub(super) fn take(&self, requests: &mut Requests) {
        (requests.reset, requests.pause, requests.steps) = (false, None, 0);
        if !self.has_requests.load(Ordering::Acquire) {
            return;
        }
        let Some(mut inbox) = try_lock(&self.inbox) else { return };
        let Requests { reset, pause, steps, held, pull } = &mut *inbox;
        (requests.reset, requests.pause, requests.steps) = (mem::take(reset), mem::take(pause), mem::take(steps));
        requests.held.copy_from_slice(held);
        requests.pull = *pull;
        self.has_requests.store(false, Ordering::Release);
    }

    /// Ends the pull, and releases the controls.
    pub(super) fn let_go(&self) {
        lock(&self.inbox).let_go();
    }

    /// Waits for a request.
    pub(super) fn wait(&self, timeout: Duration) {
        let is_empty = |_: &mut Requests| !self.has_requests.load(Ordering::Acquire);
        drop(self.new_request.wait_timeout_while(lock(&self.inbox), timeout, is_empty));
    }
}

/// Locks a mutex. No code panics with a lock.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn try_lock<T>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match mutex.try_lock() {
        Ok(guard) => Some(guard),
        Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::Ordering;
    use std::thread;
    use std::time::Duration;

    use super::{Requests, Slots, lock};
    use crate::live::message::{Message, Pull};

    #[test]
    fn the_simulation_does_not_wait_for_a_browser_that_holds_the_slots() {
        let slots = Slots::new(1, 0);
        slots.request(0, Message::Reset);
        let mut requests = Requests::new(1);
        {
            let _held = (lock(&slots.snapshot), lock(&slots.inbox));
            slots.publish(|_| unreachable!("the snapshot is locked"));
            slots.take(&mut requests);
            assert!(!requests.reset);
        }
        assert!(slots.is_wanted.load(Ordering::Acquire), "the next tick tries again");
        slots.publish(|bytes| bytes.push(6));
        assert!(!slots.is_wanted.load(Ordering::Acquire));
        slots.take(&mut requests);
        assert!(requests.reset);
        // A browser receives a state that is published after its request.
        let mut bytes = Vec::new();
        thread::scope(|scope| {
            let received = scope.spawn(|| slots.next(Duration::from_secs(60), &mut bytes));
            while !slots.is_wanted.load(Ordering::Acquire) {
                thread::yield_now();
            }
            slots.publish(|bytes| bytes.push(7));
            assert!(received.join().unwrap());
        });
        assert_eq!(bytes, [6, 7]);
    }

    #[test]
    fn without_a_new_state_a_browser_receives_the_latest_after_a_time() {
        let slots = Slots::new(0, 0);
        slots.publish(|bytes| bytes.push(7));
        let mut bytes = Vec::new();
        assert!(slots.next(Duration::from_millis(1), &mut bytes));
        assert!(slots.is_wanted.load(Ordering::Acquire) && bytes == [7]);
        slots.close();
        assert!(!slots.next(Duration::from_secs(60), &mut bytes));
    }

    #[test]
    fn requests_are_merged() {
        let slots = Slots::new(2, 0);
        let pull = Pull { body: 1, point: [0.0; 3], target: [1.0; 3] };
        for message in [Message::Hold(0, 1.0), Message::Step(1), Message::Pull(pull), Message::Pause(true)] {
            slots.request(1, message);
        }
        slots.request(2, Message::Reset);
        for message in [Message::Hold(1, 1.0), Message::Hold(1, 2.0), Message::Step(1), Message::Step(u32::MAX)] {
            slots.request(1, message);
        }
        let mut requests = Requests::new(2);
        slots.take(&mut requests);
        assert_eq!((requests.reset, requests.pause, requests.steps), (true, Some(true), u32::MAX));
        assert_eq!((&requests.held[..], requests.pull), (&[None, Some(2.0)][..], None));
        slots.take(&mut requests);
        assert_eq!((requests.reset, requests.pause, requests.steps), (false, None, 0), "each is taken once");
        slots.request(1, Message::Pull(pull));
        slots.request(1, Message::Pull(Pull { target: [2.0; 3], ..pull }));
        for _ in 0..2 {
            slots.take(&mut requests);
            let expected = (Some(2.0), Some((1, Pull { target: [2.0; 3], ..pull })));
            assert_eq!((requests.held[1], requests.pull), expected, "a user holds until the end");
        }
        slots.request(2, Message::Release(1));
        slots.take(&mut requests);
        assert_eq!((requests.held[1], requests.pull.is_some()), (None, true));
        slots.let_go();
        slots.request(2, Message::Pause(false));
        slots.take(&mut requests);
        assert_eq!(requests.pull, None);
    }

    #[test]
    fn only_the_client_that_pulls_lets_go() {
        let slots = Slots::new(0, 0);
        let pull = Pull { body: 1, point: [0.0; 3], target: [1.0; 3] };
        let grip = |messages: &[(u64, Message)]| {
            for &(client, message) in messages {
                slots.request(client, message);
            }
            let mut requests = Requests::new(0);
            slots.take(&mut requests);
            requests.pull.map(|(_, pull)| pull)
        };
        assert_eq!(grip(&[(1, Message::Pull(pull)), (2, Message::LetGo)]), Some(pull));
        assert_eq!(grip(&[(1, Message::LetGo), (2, Message::LetGo)]), None);
        assert_eq!(grip(&[(1, Message::Pull(pull)), (2, Message::Pull(pull)), (1, Message::LetGo)]), Some(pull));
    }
}
