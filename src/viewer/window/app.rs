//! The windows that are open, and the events that they get.

use std::collections::HashMap;
use std::time::Instant;

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use super::session::Session;
use super::wake::{Token, Wake};

/// All windows of the process. Each is drawn when something in it has changed, and the thread sleeps otherwise.
pub(super) struct App {
    sessions: HashMap<WindowId, Session>,
    /// Whether the event loop ends when the last window is closed.
    ends: bool,
}

impl App {
    /// Ends when its last window is closed.
    pub fn until_closed() -> Self {
        Self { sessions: HashMap::new(), ends: true }
    }

    /// Waits for the next window when its last one is closed.
    pub fn forever() -> Self {
        Self { ends: false, ..Self::until_closed() }
    }

    fn by_token(&mut self, token: Token) -> Option<&mut Session> {
        self.sessions.values_mut().find(|session| session.token() == token)
    }

    /// Takes away the windows that are done.
    fn sweep(&mut self, event_loop: &ActiveEventLoop) {
        self.sessions.retain(|_, session| !session.is_over());
        if self.ends && self.sessions.is_empty() {
            event_loop.exit();
        }
    }
}

impl ApplicationHandler<Wake> for App {
    fn resumed(&mut self, _: &ActiveEventLoop) {}

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Open(opening) => {
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
