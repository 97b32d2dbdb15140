//! The event loop of the process.
//!
//! The windowing library allows a process to create a single event loop. After a window is closed,
//! the loop is therefore kept for the next window: in the thread that opened the first window
//! ([`run_on_this_thread`]), or in a background thread ([`window_thread`]) that lives as long as
//! the process.
//!
//! The library also connects to a single X server, once. After the loss of that connection, all
//! windows end with an error, and later ones cannot be opened.

use std::cell::RefCell;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use winit::error::EventLoopError;
use winit::event_loop::{EventLoop, EventLoopProxy};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand;
#[cfg(target_os = "linux")]
use winit::raw_window_handle::HasDisplayHandle;

use super::app::App;
use super::wake::{CONNECTION_LOST, Wake, WindowToken, connection_is_lost, message_of};
use crate::error::catch_panic;
use crate::viewer::error::ViewerError;

thread_local! {
    /// Event loop of this thread while it does not run.
    static IDLE: RefCell<Option<Box<EventLoop<Wake>>>> = const { RefCell::new(None) };
}

/// Owner of the event loop.
enum Owner {
    None,
    /// Thread that has called [`Viewer::run`](crate::viewer::Viewer::run) or
    /// [`run`](crate::viewer::run) first.
    Caller(ThreadId),
    /// Background thread.
    #[cfg_attr(target_os = "macos", allow(dead_code, reason = "only the main thread of macOS shows windows"))]
    WindowThread(EventLoopProxy<Wake>),
    /// The creation has failed, or the loop has ended for good. The library does not allow a second
    /// attempt.
    Failed(String),
}

static OWNER: Mutex<Owner> = Mutex::new(Owner::None);

/// Lock of the owner. While a thread holds it, the event loop does not end for good, so that
/// messages to it are received.
pub(super) struct OwnerLock(MutexGuard<'static, Owner>);

fn owner() -> OwnerLock {
    OwnerLock(OWNER.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Access to the event loop.
pub(super) enum EventLoopAccess {
    /// The calling thread must run the event loop.
    ThisThread(Box<EventLoop<Wake>>),
    /// The background thread runs the event loop.
    WindowThread(EventLoopProxy<Wake>),
}

/// Returns the event loop for a window of the calling thread: the loop of the background thread if
/// it was started, else the loop of the calling thread. The lock must be held until the window is
/// requested.
pub(super) fn acquire() -> Result<(EventLoopAccess, OwnerLock), ViewerError> {
    let mut lock = owner();
    let owner = &mut *lock.0;
    match owner {
        Owner::WindowThread(proxy) => return Ok((EventLoopAccess::WindowThread(proxy.clone()), lock)),
        Owner::Caller(thread) if *thread != thread::current().id() => return Err(ViewerError::OtherThread),
        Owner::Caller(_) => {
            let idle = IDLE.with(RefCell::take).ok_or(ViewerError::Nested)?;
            return Ok((EventLoopAccess::ThisThread(idle), lock));
        }
        Owner::Failed(reason) => return Err(ViewerError::NoDisplay(reason.clone())),
        Owner::None => {}
    }
    let event_loop = record_failure(owner, build())?;
    *owner = Owner::Caller(thread::current().id());
    Ok((EventLoopAccess::ThisThread(Box::new(event_loop)), lock))
}

/// Runs the event loop on the calling thread until the window, which was requested through the
/// loop's proxy, is closed.
pub(super) fn run_on_this_thread(event_loop: Box<EventLoop<Wake>>, token: WindowToken) -> Result<(), ViewerError> {
    store(run(event_loop, App::until_closed(token))?);
    Ok(())
}

/// Runs an event loop until it exits. Returns it if it can run again.
///
/// # Errors
///
/// [`ViewerError::Window`] if the connection to the display server is lost or the windowing library
/// fails. All windows have received the error.
fn run(mut event_loop: Box<EventLoop<Wake>>, mut app: App) -> Result<Box<EventLoop<Wake>>, ViewerError> {
    // The handlers of `app` do not panic, but the library panics in some of its calls after the
    // connection was lost.
    let result = catch_panic(|| event_loop.run_app_on_demand(&mut app));
    let problem = match result {
        _ if connection_is_lost() => CONNECTION_LOST.to_owned(),
        Ok(Ok(())) => return Ok(event_loop),
        Ok(Err(error)) => message_of(&error),
        Err(panic) => format!("the event loop has panicked: {panic}"),
    };
    app.fail_all(&problem);
    *owner().0 = Owner::Failed(format!("{problem}; a program can connect only once"));
    // No window can be requested any more. This drops the requests that are in the queue.
    let _ = catch_panic(|| event_loop.run_app_on_demand(&mut App::ended()));
    // Its destructor would use the connection.
    std::mem::forget(event_loop);
    Err(ViewerError::Window(problem))
}

/// Stores the event loop of this thread for its next window.
pub(super) fn store(event_loop: Box<EventLoop<Wake>>) {
    IDLE.with(|idle| idle.replace(Some(event_loop)));
}

/// Returns a proxy of the background thread's event loop. The first call starts the thread. The
/// lock must be held until the window is requested.
#[cfg(not(target_os = "macos"))]
pub(super) fn window_thread() -> Result<(EventLoopProxy<Wake>, OwnerLock), ViewerError> {
    let mut lock = owner();
    let owner = &mut *lock.0;
    match owner {
        Owner::WindowThread(proxy) => return Ok((proxy.clone(), lock)),
        Owner::Caller(_) => return Err(ViewerError::OtherThread),
        Owner::Failed(reason) => return Err(ViewerError::NoDisplay(reason.clone())),
        Owner::None => {}
    }
    let (sender, receiver) = std::sync::mpsc::channel();
    thread::Builder::new()
        .name("windows".to_owned())
        .spawn(move || match build() {
            Ok(event_loop) => {
                let _ = sender.send(Ok(event_loop.create_proxy()));
                if let Err(error) = run(Box::new(event_loop), App::forever()) {
                    log::error!("{error}");
                }
            }
            Err(error) => drop(sender.send(Err(error))),
        })
        .map_err(ViewerError::Thread)?;
    let answer = receiver.recv().map_err(|_| ViewerError::Window("the window thread has panicked".into()))?;
    let proxy = record_failure(owner, answer)?;
    *owner = Owner::WindowThread(proxy.clone());
    Ok((proxy, lock))
}

/// Records that the creation of the event loop has failed for good.
fn record_failure<T>(owner: &mut Owner, created: Result<T, ViewerError>) -> Result<T, ViewerError> {
    if let Err(ViewerError::NoDisplay(reason)) = &created {
        *owner = Owner::Failed(reason.clone());
    }
    created
}

/// Creates the event loop.
fn build() -> Result<EventLoop<Wake>, ViewerError> {
    let mut builder = EventLoop::with_user_event();
    // Any thread may show windows, except on macOS.
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
    let event_loop = builder.build().map_err(|error| convert(&error))?;
    #[cfg(target_os = "linux")]
    if let Ok(display) = event_loop.display_handle() {
        let proxy = event_loop.create_proxy();
        let is_watched = crate::x11::watch(display, move || drop(proxy.send_event(Wake::ConnectionLost)));
        if !is_watched {
            log::debug!("this version of Xlib ends the process with the X server");
        }
    }
    Ok(event_loop)
}

fn convert(error: &EventLoopError) -> ViewerError {
    match error {
        EventLoopError::RecreationAttempt => ViewerError::EventLoopTaken,
        EventLoopError::Os(_) | EventLoopError::NotSupported(_) => ViewerError::NoDisplay(message_of(error)),
        EventLoopError::ExitFailure(_) => ViewerError::Window(message_of(error)),
    }
}
