//! What connects the window with the physics: requests one way, snapshots and events the other. Locks are held for as long as it
//! takes to swap a pointer.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{fmt, mem};

use super::event::Event;
use super::request::Request;
use super::snapshot::Snapshot;
use crate::scene::{Camera, CameraView, SceneOptions};

/// How many requests wait at most. What comes after them is lost: the program's loop has not looked for long.
const MOST_REQUESTS: usize = 4096;
/// How many events wait at most.
const MOST_EVENTS: usize = 1024;

/// What the window looks at.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Look {
    /// From where. `None` for the free camera that shows the whole model.
    pub camera: Option<Camera>,
    /// At what.
    pub options: SceneOptions,
}

impl Look {
    /// Whether another says the same. Where a camera is that follows a body is up to the body.
    fn says_the_same(&self, other: &Self) -> bool {
        let still = |camera: Option<Camera>| {
            camera.map(|camera| match camera.view {
                CameraView::Tracking(_) => Camera { lookat: [0.0; 3], ..camera },
                _ => camera,
            })
        };
        self.options == other.options && still(self.camera) == still(other.camera)
    }
}

#[derive(Default)]
struct Inbox {
    requests: VecDeque<Request>,
    /// The number of requests that were ever queued.
    asked: u64,
    look: Option<Look>,
}

#[derive(Default)]
struct Outbox {
    /// The newest snapshot, unless the window has it.
    ready: Option<Box<Snapshot>>,
    /// One that the window is done with.
    spare: Option<Box<Snapshot>>,
    events: Vec<Event>,
}

struct Shared {
    inbox: Mutex<Inbox>,
    arrived: Condvar,
    outbox: Mutex<Outbox>,
    /// The window was closed, or the program wants it to be.
    closed: AtomicBool,
    /// The physics has ended.
    over: AtomicBool,
    wake: Box<dyn Fn() + Send + Sync>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is behind a lock is only ever moved in and out.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The window's end.
pub(crate) struct Front {
    shared: Arc<Shared>,
    drawn: Option<Box<Snapshot>>,
    /// Whether `drawn` was handed out.
    seen: bool,
    /// What was said last.
    look: Option<Look>,
}

/// The physics' end.
pub(crate) struct Back {
    shared: Arc<Shared>,
}

/// Two ends. `wake` is called from the physics' thread when there is something new.
pub(crate) fn link(wake: impl Fn() + Send + Sync + 'static) -> (Front, Back) {
    let shared = Arc::new(Shared {
        inbox: Mutex::default(),
        arrived: Condvar::new(),
        outbox: Mutex::default(),
        closed: AtomicBool::new(false),
        over: AtomicBool::new(false),
        wake: Box::new(wake),
    });
    (Front { shared: shared.clone(), drawn: None, seen: true, look: None }, Back { shared })
}

impl Front {
    /// Asks for something to be done.
    pub fn ask(&self, request: Request) {
        {
            let inbox = &mut *lock(&self.shared.inbox);
            let requests = &mut inbox.requests;
            if requests.back_mut().is_some_and(|last| last.merge(&request)) {
                return;
            }
            if requests.len() >= MOST_REQUESTS {
                log::warn!(
                    "the viewer's request {request:?} is lost: the program has not looked at the ones before it"
                );
                return;
            }
            // A request that refers to the picture is executed with the view that it was asked from.
            if request.reads_poses()
                && let Some(look) = inbox.look.take()
            {
                requests.push_back(Request::Look(Box::new(look)));
                inbox.asked += 1;
            }
            requests.push_back(request);
            inbox.asked += 1;
        }
        self.shared.arrived.notify_one();
    }

    /// Returns the number that this request will have if it is queued next.
    pub fn next_number(&self, request: &Request) -> u64 {
        let inbox = lock(&self.shared.inbox);
        inbox.asked + 1 + u64::from(request.reads_poses() && inbox.look.is_some())
    }

    /// Returns the number of requests that were ever queued, which is the number of the last one.
    pub fn asked(&self) -> u64 {
        lock(&self.shared.inbox).asked
    }

    /// Says from where and at what the next snapshots are to look.
    pub fn look(&mut self, look: &Look) {
        if self.look.as_ref().is_some_and(|last| last.says_the_same(look)) {
            return;
        }
        self.look = Some(look.clone());
        lock(&self.shared.inbox).look = Some(look.clone());
        self.shared.arrived.notify_one();
    }

    /// The newest snapshot, and whether it is one that was not seen before. `None` before the first.
    pub fn latest(&mut self) -> Option<(&mut Snapshot, bool)> {
        let mut outbox = lock(&self.shared.outbox);
        if let Some(newer) = outbox.ready.take() {
            outbox.spare = self.drawn.replace(newer);
            self.seen = false;
        }
        drop(outbox);
        let newer = !mem::replace(&mut self.seen, true);
        self.drawn.as_deref_mut().map(|snapshot| (snapshot, newer))
    }

    /// As [`drawn`](Self::drawn), to be changed.
    pub fn drawn_mut(&mut self) -> Option<&mut Snapshot> {
        self.drawn.as_deref_mut()
    }

    /// The snapshot that [`latest`](Self::latest) gave last.
    pub fn drawn(&self) -> Option<&Snapshot> {
        self.drawn.as_deref()
    }

    /// What the physics had to say since the last call. The newest snapshot is taken with it, so that what is said of a model is
    /// said of that which is there; what was said of one that was replaced since is left out.
    pub fn events(&mut self) -> Vec<Event> {
        let mut outbox = lock(&self.shared.outbox);
        let mut events = mem::take(&mut outbox.events);
        if let Some(newer) = outbox.ready.take() {
            outbox.spare = self.drawn.replace(newer);
            self.seen = false;
        }
        drop(outbox);
        if let Some(snapshot) = &self.drawn {
            events.retain(|event| event.fits(&snapshot.model));
        }
        events
    }

    /// Ends the physics, or the program's loop.
    pub fn close(&self) {
        self.shared.closed.store(true, Ordering::Release);
        // The lock keeps the signal from getting lost between a look at the flag and the wait for it.
        drop(lock(&self.shared.inbox));
        self.shared.arrived.notify_all();
    }

    /// Whether the window is to close: the program wants it, or has ended.
    pub fn is_closing(&self) -> bool {
        self.shared.closed.load(Ordering::Acquire) || self.is_over()
    }

    /// Whether the physics has ended.
    pub fn is_over(&self) -> bool {
        self.shared.over.load(Ordering::Acquire)
    }
}

impl Drop for Front {
    /// A window that is gone is closed.
    fn drop(&mut self) {
        self.close();
    }
}

impl Back {
    /// Removes the next request from the queue.
    pub fn next(&self) -> Option<Request> {
        self.next_if(|_| true)
    }

    /// Removes the next request from the queue if it satisfies the condition.
    pub fn next_if(&self, condition: impl FnOnce(&Request) -> bool) -> Option<Request> {
        let requests = &mut lock(&self.shared.inbox).requests;
        if requests.front().is_some_and(condition) { requests.pop_front() } else { None }
    }

    /// Returns the number of the request that was removed from the queue last.
    pub fn taken(&self) -> u64 {
        let inbox = lock(&self.shared.inbox);
        inbox.asked - inbox.requests.len() as u64
    }

    /// Whether something was asked for that is not done yet.
    pub fn is_waited_for(&self) -> bool {
        !lock(&self.shared.inbox).requests.is_empty() || self.is_closed()
    }

    /// From where and at what to look, if that has changed.
    pub fn look(&self) -> Option<Look> {
        lock(&self.shared.inbox).look.take()
    }

    /// Waits until the window asks for something, is closed, or the time is there.
    pub fn wait(&self, until: Option<Instant>) {
        let mut inbox = lock(&self.shared.inbox);
        while inbox.requests.is_empty() && inbox.look.is_none() && !self.is_closed() {
            let Some(until) = until else {
                inbox = self.shared.arrived.wait(inbox).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = until.saturating_duration_since(Instant::now());
            if left == Duration::ZERO {
                return;
            }
            inbox = self.shared.arrived.wait_timeout(inbox, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Hands out a snapshot. One that nobody has use for comes back, to be written over.
    pub fn publish(&self, snapshot: Box<Snapshot>) -> Option<Box<Snapshot>> {
        let free = {
            let mut outbox = lock(&self.shared.outbox);
            let unread = outbox.ready.replace(snapshot);
            unread.or_else(|| outbox.spare.take())
        };
        (self.shared.wake)();
        free
    }

    /// Tells the window something.
    pub fn tell(&self, event: Event) {
        {
            let events = &mut lock(&self.shared.outbox).events;
            if events.len() < MOST_EVENTS {
                events.push(event);
            }
        }
        (self.shared.wake)();
    }

    /// Whether the window was closed.
    pub fn is_closed(&self) -> bool {
        self.shared.closed.load(Ordering::Acquire)
    }

    /// Closes the window.
    pub fn close(&self) {
        self.shared.closed.store(true, Ordering::Release);
        (self.shared.wake)();
    }
}

impl Drop for Back {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Release);
        (self.shared.wake)();
    }
}

impl fmt::Debug for Front {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Front").finish_non_exhaustive()
    }
}

impl fmt::Debug for Back {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Back").finish_non_exhaustive()
    }
}
