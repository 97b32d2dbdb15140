//! Slots between the simulation and the browsers: the latest state, and the merged requests.
//!
//! Neither slot is a queue. The simulation only tries to lock: if a browser holds a slot, the
//! simulation goes on, and tries again in its next tick.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use super::message::{Message, Pull};

/// State in the form in which browsers receive it.
#[derive(Debug, Default)]
struct Snapshot {
    /// Number of states so far.
    number: u64,
    bytes: Vec<u8>,
}

/// Requests since the simulation has last taken them.
#[derive(Debug, Default)]
pub(super) struct Requests {
    /// Before all others. The requests before a reset have no effect.
    pub(super) reset: bool,
    pub(super) pause: Option<bool>,
    pub(super) steps: u32,
    /// For each control its new setting.
    pub(super) controls: Vec<Option<Setting>>,
    pub(super) pull: Option<Grip>,
}

/// Setting of a control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Setting {
    Held(f64),
    Released,
}

/// State of a pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Grip {
    Held(Pull),
    Released,
}

impl Requests {
    pub(super) fn new(controls: usize) -> Self {
        Self { controls: vec![None; controls], ..Self::default() }
    }

    pub(super) fn clear(&mut self) {
        self.controls.fill(None);
        (self.reset, self.pause, self.steps, self.pull) = (false, None, 0, None);
    }
}

#[derive(Debug)]
struct Inbox {
    requests: Requests,
    /// Client that pulls.
    puller: Option<u64>,
}

impl Inbox {
    /// Merges a valid message of a client.
    fn add(&mut self, client: u64, message: Message) {
        let requests = &mut self.requests;
        match message {
            Message::Pause(pause) => requests.pause = Some(pause),
            Message::Step(steps) => requests.steps = requests.steps.saturating_add(steps),
            Message::Reset => {
                let pause = requests.pause;
                requests.clear();
                (requests.reset, requests.pause) = (true, pause);
            }
            Message::Hold(index, value) => requests.controls[index] = Some(Setting::Held(value)),
            Message::Release(index) => requests.controls[index] = Some(Setting::Released),
            Message::Pull(pull) => {
                self.puller = Some(client);
                requests.pull = Some(Grip::Held(pull));
            }
            Message::LetGo if self.puller == Some(client) => {
                self.puller = None;
                requests.pull = Some(Grip::Released);
            }
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
    inbox: Mutex<Inbox>,
    new_request: Condvar,
}

impl Slots {
    pub(super) fn new(controls: usize) -> Self {
        Self {
            is_closed: AtomicBool::new(false),
            is_wanted: AtomicBool::new(true),
            snapshot: Mutex::default(),
            new_snapshot: Condvar::new(),
            has_requests: AtomicBool::new(false),
            inbox: Mutex::new(Inbox { requests: Requests::new(controls), puller: None }),
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

    /// Returns `true` if a browser waits for a state.
    pub(super) fn is_wanted(&self) -> bool {
        self.is_wanted.load(Ordering::Acquire)
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

    /// Exchanges the requests for empty ones, if there are any and no browser holds the lock.
    /// Returns `true` if they were exchanged.
    pub(super) fn take(&self, empty: &mut Requests) -> bool {
        if !self.has_requests.load(Ordering::Acquire) {
            return false;
        }
        let Some(mut inbox) = try_lock(&self.inbox) else { return false };
        std::mem::swap(&mut inbox.requests, empty);
        self.has_requests.store(false, Ordering::Release);
        true
    }

    /// Waits for a request.
    pub(super) fn wait(&self, timeout: Duration) {
        let is_empty = |_: &mut Inbox| !self.has_requests.load(Ordering::Acquire);
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
    use std::thread;
    use std::time::Duration;

    use super::{Grip, Requests, Setting, Slots, lock};
    use crate::live::message::{Message, Pull};

    #[test]
    fn the_simulation_does_not_wait_for_a_browser_that_holds_the_slots() {
        let slots = Slots::new(1);
        slots.request(0, Message::Reset);
        let mut requests = Requests::new(1);
        {
            let _held = (lock(&slots.snapshot), lock(&slots.inbox));
            slots.publish(|_| unreachable!("the snapshot is locked"));
            assert!(!slots.take(&mut requests));
        }
        assert!(slots.is_wanted(), "the next tick tries again");
        slots.publish(|bytes| bytes.push(6));
        assert!(!slots.is_wanted());
        assert!(slots.take(&mut requests) && requests.reset);
        // A browser receives a state that is published after its request.
        let mut bytes = Vec::new();
        thread::scope(|scope| {
            let received = scope.spawn(|| slots.next(Duration::from_secs(60), &mut bytes));
            while !slots.is_wanted() {
                thread::yield_now();
            }
            slots.publish(|bytes| bytes.push(7));
            assert!(received.join().unwrap());
        });
        assert_eq!(bytes, [6, 7]);
    }

    #[test]
    fn without_a_new_state_a_browser_receives_the_latest_after_a_time() {
        let slots = Slots::new(0);
        slots.publish(|bytes| bytes.push(7));
        let mut bytes = Vec::new();
        assert!(slots.next(Duration::from_millis(1), &mut bytes));
        assert!(slots.is_wanted() && bytes == [7]);
        slots.close();
        assert!(!slots.next(Duration::from_secs(60), &mut bytes));
    }

    #[test]
    fn requests_are_merged() {
        let slots = Slots::new(2);
        let pull = Pull { body: 1, point: [0.0; 3], target: [1.0; 3] };
        for message in [Message::Hold(0, 1.0), Message::Step(1), Message::Pull(pull), Message::Pause(true)] {
            slots.request(1, message);
        }
        slots.request(2, Message::Reset);
        for message in [Message::Hold(1, 1.0), Message::Hold(1, 2.0), Message::Step(1), Message::Step(u32::MAX)] {
            slots.request(1, message);
        }
        let mut requests = Requests::new(2);
        assert!(slots.take(&mut requests));
        assert_eq!((requests.reset, requests.pause, requests.steps), (true, Some(true), u32::MAX));
        assert_eq!((&requests.controls[..], requests.pull), (&[None, Some(Setting::Held(2.0))][..], None));
        assert!(!slots.take(&mut requests), "there are no more");
        slots.request(1, Message::Pull(pull));
        slots.request(1, Message::Pull(Pull { target: [2.0; 3], ..pull }));
        let mut requests = Requests::new(2);
        assert!(slots.take(&mut requests));
        assert_eq!(requests.pull, Some(Grip::Held(Pull { target: [2.0; 3], ..pull })));
    }

    #[test]
    fn only_the_client_that_pulls_lets_go() {
        let slots = Slots::new(0);
        let pull = Pull { body: 1, point: [0.0; 3], target: [1.0; 3] };
        let grip = |messages: &[(u64, Message)]| {
            for &(client, message) in messages {
                slots.request(client, message);
            }
            let mut requests = Requests::new(0);
            assert!(slots.take(&mut requests));
            requests.pull
        };
        assert_eq!(grip(&[(1, Message::Pull(pull)), (2, Message::LetGo)]), Some(Grip::Held(pull)));
        assert_eq!(grip(&[(1, Message::LetGo), (2, Message::LetGo)]), Some(Grip::Released));
        assert_eq!(
            grip(&[(1, Message::Pull(pull)), (2, Message::Pull(pull)), (1, Message::LetGo)]),
            Some(Grip::Held(pull))
        );
    }
}
