//! Connection between the window and the physics.
//!
//! Requests flow from the window to the physics through a bounded queue. Snapshots flow back
//! through a triple buffer, events through a list. Each lock is held only to move values in or out,
//! and to add the ranges of the signals of a snapshot that another replaces.

mod message;
mod playback;
mod prediction;
mod snapshot;
mod timeline;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{fmt, mem};

pub(crate) use self::message::{
    Asset, EndpointRequest, Event, Kept, PlaybackRequest, Request, SavedFile, SharedModel, SimulationRequest,
    ViewportPoint,
};
pub(crate) use self::playback::{Burst, PlaybackState, Sampling};
pub(crate) use self::prediction::PredictedState;
pub(crate) use self::snapshot::{
    Appearance, ControlNoise, InfoLine, InfoLines, Mode, PaneView, SelectedBody, SimulationSpeed, Snapshot, Status,
};
pub(crate) use self::timeline::Timeline;
use crate::id::CameraId;
use crate::scene::{Camera, CameraView, SceneOptions};

/// Capacity of the request queue. Requests beyond it are dropped with a warning: the program has
/// not called `sync` for a long time.
const MAX_REQUESTS: usize = 4096;
/// Capacity of the event list.
const MAX_EVENTS: usize = 1024;

/// Camera and scene options of a window, as far as the physics needs them to build the scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct SceneView {
    /// `None` for the free camera that shows the whole model.
    pub camera: Option<Camera>,
    pub options: SceneOptions,
    /// The free and the tracking camera are orthographic.
    pub orthographic: bool,
    /// Cameras of which a snapshot has the viewpoints.
    pub panes: Vec<CameraId>,
}

impl SceneView {
    /// Returns `true` if both views are equivalent. The look-at point of a tracking camera is
    /// ignored, because the tracked body determines it.
    fn is_equivalent(&self, other: &Self) -> bool {
        let comparable = |camera: Option<Camera>| {
            camera.map(|camera| match camera.view {
                CameraView::Tracking(_) => Camera { lookat: [0.0; 3], ..camera },
                _ => camera,
            })
        };
        self.options == other.options
            && (self.orthographic, &self.panes) == (other.orthographic, &other.panes)
            && comparable(self.camera) == comparable(other.camera)
    }
}

#[derive(Default)]
struct Inbox {
    requests: VecDeque<Request>,
    /// Number of requests that were ever queued.
    queued: u64,
    view: Option<SceneView>,
}

#[derive(Default)]
struct Outbox {
    /// Newest snapshot, unless the window has taken it.
    ready: Option<Box<Snapshot>>,
    /// Snapshot that the window has released.
    spare: Option<Box<Snapshot>>,
    events: Vec<Event>,
}

struct Shared {
    inbox: Mutex<Inbox>,
    /// Signalled when a request or a view arrives and when the window closes.
    arrived: Condvar,
    outbox: Mutex<Outbox>,
    /// The window was closed, or the program has closed it.
    closed: AtomicBool,
    /// The physics end was dropped.
    finished: AtomicBool,
    wake: Box<dyn Fn() + Send + Sync>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // The guarded values are only moved in and out, so a panic cannot leave them inconsistent.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Window's end of the link.
pub(crate) struct WindowEnd {
    shared: Arc<Shared>,
    current: Option<Box<Snapshot>>,
    /// `latest` has returned `current`.
    seen: bool,
    /// View that was sent last.
    view: Option<SceneView>,
}

/// Physics' end of the link.
pub(crate) struct PhysicsEnd {
    shared: Arc<Shared>,
}

/// Creates both ends of a link. The physics thread calls `wake` when there is a new snapshot or
/// event.
pub(crate) fn link(wake: impl Fn() + Send + Sync + 'static) -> (WindowEnd, PhysicsEnd) {
    let shared = Arc::new(Shared {
        inbox: Mutex::default(),
        arrived: Condvar::new(),
        outbox: Mutex::default(),
        closed: AtomicBool::new(false),
        finished: AtomicBool::new(false),
        wake: Box::new(wake),
    });
    (WindowEnd { shared: shared.clone(), current: None, seen: true, view: None }, PhysicsEnd { shared })
}

impl WindowEnd {
    /// Queues a request. Returns its number, which is the number of the previous request if both
    /// are merged, or `None` if the queue is full.
    pub fn send(&self, request: impl Into<Request>) -> Option<u64> {
        let request = request.into();
        let number = {
            let inbox = &mut *lock(&self.shared.inbox);
            let requests = &mut inbox.requests;
            if requests.back_mut().is_some_and(|last| last.merge(&request)) {
                return Some(inbox.queued);
            }
            if requests.len() >= MAX_REQUESTS {
                log::warn!("the viewer drops the request {request:?}: {MAX_REQUESTS} requests wait for the program");
                return None;
            }
            // A request that refers to the displayed frame must be executed with the view from
            // which the user made it.
            if request.reads_poses()
                && let Some(view) = inbox.view.take()
            {
                requests.push_back(EndpointRequest::SetView(Box::new(view)).into());
                inbox.queued += 1;
            }
            requests.push_back(request);
            inbox.queued += 1;
            inbox.queued
        };
        self.shared.arrived.notify_one();
        Some(number)
    }

    /// Returns the number of requests that were ever queued, which is the number of the last
    /// request.
    #[cfg(feature = "_test-hooks")]
    pub fn queued(&self) -> u64 {
        lock(&self.shared.inbox).queued
    }

    /// Sets the camera and the options of the next snapshots.
    pub fn set_view(&mut self, view: &SceneView) {
        if self.view.as_ref().is_some_and(|last| last.is_equivalent(view)) {
            return;
        }
        self.view = Some(view.clone());
        lock(&self.shared.inbox).view = Some(view.clone());
        self.shared.arrived.notify_one();
    }

    /// Returns the newest snapshot, and `true` if it has not been returned before. `None` before
    /// the first snapshot.
    pub fn latest(&mut self) -> Option<(&mut Snapshot, bool)> {
        drop(self.take());
        let newer = !mem::replace(&mut self.seen, true);
        self.current.as_deref_mut().map(|snapshot| (snapshot, newer))
    }

    /// Returns the snapshot of the last call of [`latest`](Self::latest) or
    /// [`take_events`](Self::take_events), mutably.
    pub fn current_mut(&mut self) -> Option<&mut Snapshot> {
        self.current.as_deref_mut()
    }

    /// Returns the snapshot of the last call of [`latest`](Self::latest) or
    /// [`take_events`](Self::take_events).
    pub fn current(&self) -> Option<&Snapshot> {
        self.current.as_deref()
    }

    /// Removes the events since the last call. Takes the newest snapshot along, so that events
    /// match its model. Events about a model that was replaced in the meantime are discarded.
    pub fn take_events(&mut self) -> Vec<Event> {
        let mut events = mem::take(&mut self.take().events);
        if let Some(snapshot) = &self.current {
            events.retain(|event| event.fits(&snapshot.model));
        }
        events
    }

    /// Makes the newest snapshot the current one, with the ranges that the plots have not recorded.
    /// Returns the outbox, which is locked.
    fn take(&mut self) -> MutexGuard<'_, Outbox> {
        let mut outbox = lock(&self.shared.outbox);
        if let Some(mut newer) = outbox.ready.take() {
            if let Some(current) = &self.current {
                newer.add_ranges(current);
            }
            outbox.spare = self.current.replace(newer);
            self.seen = false;
        }
        outbox
    }

    /// Ends the physics thread or the program's loop.
    pub fn close(&self) {
        self.shared.closed.store(true, Ordering::Release);
        // Taking the lock prevents a lost wake-up: `wait` holds it from its check of the flag until
        // it sleeps.
        drop(lock(&self.shared.inbox));
        self.shared.arrived.notify_all();
    }

    /// Returns `true` if the window must close: either end has requested it, or the physics has
    /// finished.
    pub fn is_closing(&self) -> bool {
        self.shared.closed.load(Ordering::Acquire) || self.is_finished()
    }

    /// Returns `true` if the physics has finished.
    pub fn is_finished(&self) -> bool {
        self.shared.finished.load(Ordering::Acquire)
    }
}

impl Drop for WindowEnd {
    fn drop(&mut self) {
        self.close();
    }
}

impl PhysicsEnd {
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
    pub fn executed(&self) -> u64 {
        let inbox = lock(&self.shared.inbox);
        inbox.queued - inbox.requests.len() as u64
    }

    /// Returns `true` if a request waits in the queue or the window was closed.
    pub fn has_work(&self) -> bool {
        !lock(&self.shared.inbox).requests.is_empty() || self.is_closed()
    }

    /// Removes the newest view if it has changed.
    pub fn take_view(&self) -> Option<SceneView> {
        lock(&self.shared.inbox).view.take()
    }

    /// Blocks until a request or a view arrives, the window is closed, or the deadline passes.
    pub fn wait(&self, deadline: Option<Instant>) {
        let mut inbox = lock(&self.shared.inbox);
        while inbox.requests.is_empty() && inbox.view.is_none() && !self.is_closed() {
            let Some(deadline) = deadline else {
                inbox = self.shared.arrived.wait(inbox).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = deadline.saturating_duration_since(Instant::now());
            if left == Duration::ZERO {
                return;
            }
            inbox = self.shared.arrived.wait_timeout(inbox, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Publishes a snapshot and wakes the window. Returns a snapshot that is free to be
    /// overwritten, if there is any.
    pub fn publish(&self, mut snapshot: Box<Snapshot>) -> Option<Box<Snapshot>> {
        let free = {
            let mut outbox = lock(&self.shared.outbox);
            let unread = outbox.ready.take();
            if let Some(unread) = &unread {
                snapshot.add_ranges(unread);
            }
            outbox.ready = Some(snapshot);
            unread.or_else(|| outbox.spare.take())
        };
        (self.shared.wake)();
        free
    }

    /// Sends an event to the window and wakes it.
    pub fn send(&self, event: Event) {
        {
            let events = &mut lock(&self.shared.outbox).events;
            if events.len() < MAX_EVENTS {
                events.push(event);
            }
        }
        (self.shared.wake)();
    }

    /// Returns `true` if the window was closed.
    pub fn is_closed(&self) -> bool {
        self.shared.closed.load(Ordering::Acquire)
    }

    /// Closes the window.
    pub fn close(&self) {
        self.shared.closed.store(true, Ordering::Release);
        (self.shared.wake)();
    }
}

impl Drop for PhysicsEnd {
    fn drop(&mut self) {
        self.shared.finished.store(true, Ordering::Release);
        (self.shared.wake)();
    }
}

impl fmt::Debug for WindowEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WindowEnd").finish_non_exhaustive()
    }
}

impl fmt::Debug for PhysicsEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PhysicsEnd").finish_non_exhaustive()
    }
}
