//! The windows that are open, and the events that they get.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use super::session::Session;
use super::wake::{Token, Wake};

/// A wait for events that is shorter found them in the queue. It is not zero since the thread may be without a processor meanwhile.
const AT_ONCE: Duration = Duration::from_millis(20);

/// All windows of the process. Each is drawn when something in it has changed, and the thread sleeps otherwise.
pub(super) struct App {
    sessions: HashMap<WindowId, Session>,
    ends: Ends,
}

/// When the event loop ends.
enum Ends {
    Never,
    /// When this window has come and gone. What is told about windows of before may come first.
    After(Token),
    /// When no window is left.
    WhenEmpty,
}

impl App {
    /// Ends when this window is closed, and all others that there are.
    pub fn until_closed(token: Token) -> Self {
        Self { sessions: HashMap::new(), ends: Ends::After(token) }
    }

    /// Waits for the next window when its last one is closed.
    #[cfg(not(target_os = "macos"))]
    pub fn forever() -> Self {
        Self { sessions: HashMap::new(), ends: Ends::Never }
    }

    fn by_token(&mut self, token: Token) -> Option<&mut Session> {
        self.sessions.values_mut().find(|session| session.token() == token)
    }

    /// Takes away the windows that are done.
    fn sweep(&mut self, event_loop: &ActiveEventLoop) {
        self.sessions.retain(|_, session| !session.is_over());
        if matches!(self.ends, Ends::WhenEmpty) && self.sessions.is_empty() {
            event_loop.exit();
        }
    }
}

impl ApplicationHandler<Wake> for App {
    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        let (StartCause::WaitCancelled { start, .. } | StartCause::ResumeTimeReached { start, .. }) = cause else {
            return;
        };
        if start.elapsed() > AT_ONCE {
            self.sessions.values_mut().for_each(Session::waited);
        }
    }

    fn resumed(&mut self, _: &ActiveEventLoop) {}

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Open(opening) => {
                if matches!(self.ends, Ends::After(awaited) if awaited == opening.waker.token()) {
                    self.ends = Ends::WhenEmpty;
                }
                if let Some((id, session)) = Session::open(event_loop, *opening) {
                    self.sessions.insert(id, session);
                }
            }
            Wake::Look(token) => {
                if let Some(session) = self.by_token(token) {
                    session.look();
                }
            }
            Wake::CloseAll => self.sessions.values_mut().for_each(Session::close),
        }
        self.sweep(event_loop);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        if let Some(session) = self.sessions.get_mut(&id) {
            session.event(event_loop, &event);
        }
        self.sweep(event_loop);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let mut next: Option<Instant> = None;
        for session in self.sessions.values() {
            match session.due() {
                Some(due) if due <= now => session.ask_to_be_drawn(),
                Some(due) => next = Some(next.map_or(due, |next| next.min(due))),
                None => {}
            }
        }
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
