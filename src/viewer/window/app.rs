//! Event handler of the event loop.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use super::event_loop::{Wake, WindowToken};
use super::session::Session;

/// After a shorter wait, the events were already in the queue. The limit is not zero, because the thread may be preempted during the
/// wait.
const MIN_WAIT: Duration = Duration::from_millis(20);

/// All windows of the process. A window is drawn when something in it has changed; otherwise the thread sleeps.
pub(super) struct App {
    sessions: HashMap<WindowId, Session>,
    exit: ExitCondition,
}

/// Condition on which the event loop exits.
enum ExitCondition {
    Never,
    /// After this window was opened and all windows are closed. Messages about previous windows may arrive before it opens.
    After(WindowToken),
    WhenEmpty,
}

impl App {
    /// Creates an app that exits when this window and all other windows are closed.
    pub fn until_closed(token: WindowToken) -> Self {
        Self { sessions: HashMap::new(), exit: ExitCondition::After(token) }
    }

    /// Creates an app that never exits.
    #[cfg(not(target_os = "macos"))]
    pub fn forever() -> Self {
        Self { sessions: HashMap::new(), exit: ExitCondition::Never }
    }

    fn by_token(&mut self, token: WindowToken) -> Option<&mut Session> {
        self.sessions.values_mut().find(|session| session.token() == token)
    }

    /// Removes the closed windows.
    fn remove_closed(&mut self, event_loop: &ActiveEventLoop) {
        self.sessions.retain(|_, session| !session.is_closed());
        if matches!(self.exit, ExitCondition::WhenEmpty) && self.sessions.is_empty() {
            event_loop.exit();
        }
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
                if let Some((id, session)) = Session::open(event_loop, *opening) {
                    self.sessions.insert(id, session);
                }
            }
            Wake::Update(token) => {
                if let Some(session) = self.by_token(token) {
                    session.handle_update();
                }
            }
            Wake::CloseAll => self.sessions.values_mut().for_each(Session::close),
        }
        self.remove_closed(event_loop);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        if let Some(session) = self.sessions.get_mut(&id) {
            session.handle_event(&event);
        }
        self.remove_closed(event_loop);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let mut next: Option<Instant> = None;
        for session in self.sessions.values_mut() {
            session.run_due_pass(now);
            match session.scheduler.due() {
                Some(due) if due <= now => session.window.request_redraw(),
                due => next = [next, due, session.scheduler.pass_due()].into_iter().flatten().min(),
            }
        }
        self.remove_closed(event_loop);
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
