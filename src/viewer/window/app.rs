//! Event handler of the event loop.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use super::session::Session;
use super::wake::{CONNECTION_LOST, Wake, WindowToken, connection_is_lost};
use crate::error::catch_panic;
use crate::viewer::error::ViewerError;

/// After a shorter wait, the events were already in the queue. The limit is not zero, because the
/// thread may be preempted during the wait.
const MIN_WAIT: Duration = Duration::from_millis(20);

/// All windows of the process. A window is drawn when something in it has changed; otherwise the
/// thread sleeps.
///
/// A panic ends only its window: the process cannot create a second event loop, so a panic must not
/// reach the first.
pub(super) struct App {
    sessions: HashMap<WindowId, Session>,
    exit: ExitCondition,
}

/// Condition on which the event loop exits.
enum ExitCondition {
    #[cfg(not(target_os = "macos"))]
    Never,
    /// After this window was opened and all windows are closed. Messages about previous windows may
    /// arrive before it opens.
    After(WindowToken),
    WhenEmpty,
    /// At once. Windows are not opened any more.
    Now,
}

impl App {
    /// Creates an app that exits when this window and all other windows are closed.
    pub fn until_closed(token: WindowToken) -> Self {
        Self { sessions: HashMap::new(), exit: ExitCondition::After(token) }
    }

    /// Creates an app that drops the messages in the queue.
    pub fn ended() -> Self {
        Self { sessions: HashMap::new(), exit: ExitCondition::Now }
    }

    /// Creates an app that never exits.
    #[cfg(not(target_os = "macos"))]
    pub fn forever() -> Self {
        Self { sessions: HashMap::new(), exit: ExitCondition::Never }
    }

    /// Calls a function with each selected window, and removes the windows that are closed
    /// afterwards. Ends all windows after the loss of the connection.
    fn update(
        &mut self,
        event_loop: &ActiveEventLoop,
        is_selected: impl Fn(&Session) -> bool,
        mut update: impl FnMut(&mut Session),
    ) {
        for session in self.sessions.values_mut().filter(|session| is_selected(session)) {
            // Most calls of the windowing library panic after the loss.
            if connection_is_lost() {
                break;
            }
            if let Err(panic) = catch_panic(|| update(session))
                && !connection_is_lost()
            {
                session.fail(&format!("a panic of its thread: {panic}"));
            }
        }
        if connection_is_lost() {
            self.fail_all(CONNECTION_LOST);
            event_loop.exit();
        }
        self.remove_closed();
        if matches!(self.exit, ExitCondition::WhenEmpty | ExitCondition::Now) && self.sessions.is_empty() {
            event_loop.exit();
        }
    }

    fn remove_closed(&mut self) {
        for (_, session) in self.sessions.extract_if(|_, session| session.is_closed()) {
            if let Err(panic) = catch_panic(|| drop(session)) {
                log::error!("a window could not be destroyed: {panic}");
            }
        }
    }

    /// Ends all windows with an error.
    pub fn fail_all(&mut self, problem: &str) {
        self.sessions.values_mut().for_each(|session| session.fail(problem));
        self.remove_closed();
    }
}

impl ApplicationHandler<Wake> for App {
    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        let (StartCause::WaitCancelled { start, .. } | StartCause::ResumeTimeReached { start, .. }) = cause else {
            return;
        };
        if start.elapsed() > MIN_WAIT {
            self.sessions.values_mut().for_each(Session::events_awaited);
        }
    }

    fn resumed(&mut self, _: &ActiveEventLoop) {}

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Open(opening) => {
                if matches!(self.exit, ExitCondition::After(awaited) if awaited == opening.waker.token()) {
                    self.exit = ExitCondition::WhenEmpty;
                }
                if connection_is_lost() {
                    // Fails if the caller no longer waits.
                    let _ = opening.result.send(Err(ViewerError::Window(CONNECTION_LOST.to_owned())));
                } else if !matches!(self.exit, ExitCondition::Now)
                    && let Some((id, session)) = Session::open(event_loop, *opening)
                {
                    self.sessions.insert(id, session);
                }
                self.update(event_loop, |_| false, |_| ());
            }
            Wake::Update(token) => {
                self.update(event_loop, |session| session.token() == token, Session::handle_update);
            }
            Wake::CloseAll => self.update(event_loop, |_| true, Session::close),
            Wake::ConnectionLost => self.update(event_loop, |_| false, |_| ()),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        self.update(event_loop, |session| session.window.id() == id, |session| session.handle_event(&event));
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let mut next: Option<Instant> = None;
        let schedule = |session: &mut Session| {
            session.schedule(now);
            match session.scheduler.due() {
                Some(due) if due <= now => session.window.request_redraw(),
                due => next = [next, due, session.scheduler.pass_due()].into_iter().flatten().min(),
            }
        };
        self.update(event_loop, |_| true, schedule);
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
