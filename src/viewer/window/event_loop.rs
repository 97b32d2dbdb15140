//! The one event loop that a process may have, and who runs it.
//!
//! The windowing library lets a process make a single event loop, ever. It is kept when a window is closed, for the next one: in
//! the thread that asked first ([`run_here`]), or in a thread of its own ([`host`]) that lives as long as the process.

use std::cell::RefCell;
use std::sync::mpsc;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use winit::error::EventLoopError;
use winit::event_loop::{EventLoop, EventLoopProxy};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand;

use super::app::App;
use super::wake::{Token, Wake};
use crate::viewer::error::ViewerError;

thread_local! {
    /// This thread's event loop while it does not run.
    static RESTING: RefCell<Option<Box<EventLoop<Wake>>>> = const { RefCell::new(None) };
}

/// Whose the event loop is.
enum Owner {
    Nobody,
    /// A thread that shows a window when it asks for one.
    Caller(ThreadId),
    /// The thread of its own.
    Host(EventLoopProxy<Wake>),
    /// It could not be made, and cannot be tried again: the library counts the attempt.
    Failed(String),
}

static OWNER: Mutex<Owner> = Mutex::new(Owner::Nobody);

fn owner() -> MutexGuard<'static, Owner> {
    OWNER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where a window can be shown.
pub(super) enum Place {
    /// In this thread, which then waits until it is closed.
    Here(Box<EventLoop<Wake>>),
    /// In the thread of its own.
    Hosted(EventLoopProxy<Wake>),
}

/// Where a window of this thread's can be shown: in the thread of its own if there is one, else here.
pub(super) fn place() -> Result<Place, ViewerError> {
    let mut owner = owner();
    match &*owner {
        Owner::Host(proxy) => return Ok(Place::Hosted(proxy.clone())),
        Owner::Caller(thread) if *thread != thread::current().id() => return Err(ViewerError::OtherThread),
        Owner::Caller(_) => {
            let resting = RESTING.with(RefCell::take);
            return resting.map(Place::Here).ok_or(ViewerError::Nested);
        }
        Owner::Failed(reason) => return Err(ViewerError::NoDisplay(reason.clone())),
        Owner::Nobody => {}
    }
    let event_loop = remembered(&mut owner, build())?;
    *owner = Owner::Caller(thread::current().id());
    Ok(Place::Here(Box::new(event_loop)))
}

/// Shows the window that was asked for through the loop's proxy, in this thread, until it is closed.
pub(super) fn run_here(mut event_loop: Box<EventLoop<Wake>>, token: Token) -> Result<(), ViewerError> {
    let outcome = event_loop.run_app_on_demand(&mut App::until_closed(token));
    rest(event_loop);
    outcome.map_err(|error| failure(&error))
}

/// Keeps this thread's event loop for its next window.
pub(super) fn rest(event_loop: Box<EventLoop<Wake>>) {
    RESTING.with(|resting| resting.replace(Some(event_loop)));
}

/// The thread of its own, started by the first that asks.
#[cfg(not(target_os = "macos"))]
pub(super) fn host() -> Result<EventLoopProxy<Wake>, ViewerError> {
    let mut owner = owner();
    match &*owner {
        Owner::Host(proxy) => return Ok(proxy.clone()),
        Owner::Caller(_) => return Err(ViewerError::OtherThread),
        Owner::Failed(reason) => return Err(ViewerError::NoDisplay(reason.clone())),
        Owner::Nobody => {}
    }
    let (sender, receiver) = mpsc::channel();
    thread::Builder::new()
        .name("windows".to_owned())
        .spawn(move || match build() {
            Ok(event_loop) => {
                let _ = sender.send(Ok(event_loop.create_proxy()));
                if let Err(error) = event_loop.run_app(&mut App::forever()) {
                    log::error!("the thread of the windows has ended: {error}");
                }
            }
            Err(error) => drop(sender.send(Err(error))),
        })
        .map_err(ViewerError::Thread)?;
    let answer = receiver.recv().map_err(|_| ViewerError::Window("the thread of the windows has panicked".into()))?;
    let proxy = remembered(&mut owner, answer)?;
    *owner = Owner::Host(proxy.clone());
    Ok(proxy)
}

/// Notes that there will never be an event loop.
fn remembered<T>(owner: &mut Owner, made: Result<T, ViewerError>) -> Result<T, ViewerError> {
    if let Err(ViewerError::NoDisplay(reason)) = &made {
        *owner = Owner::Failed(reason.clone());
    }
    made
}

/// Makes the event loop.
fn build() -> Result<EventLoop<Wake>, ViewerError> {
    let mut builder = EventLoop::with_user_event();
    // A program's main thread is not always the one that shows windows. (On macOS it has to be.)
    #[cfg(target_os = "linux")]
    {
        use winit::platform::x11::EventLoopBuilderExtX11;
        builder.with_any_thread(true);
    }
    #[cfg(windows)]
    {
        use winit::platform::windows::EventLoopBuilderExtWindows;
        builder.with_any_thread(true);
    }
    builder.build().map_err(|error| failure(&error))
}

fn failure(error: &EventLoopError) -> ViewerError {
    match error {
        EventLoopError::RecreationAttempt => ViewerError::EventLoopTaken,
        EventLoopError::Os(_) | EventLoopError::NotSupported(_) => ViewerError::NoDisplay(error.to_string()),
        EventLoopError::ExitFailure(_) => ViewerError::Window(error.to_string()),
    }
}
