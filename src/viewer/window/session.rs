//! One window: what belongs to it, and how it comes and goes.

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use super::Opening;
use super::canvas::Canvas;
use super::interrupt;
use super::output::Output;
use super::overlay::Overlay;
use super::pace::Pace;
use super::screen::Screen;
use super::wake::{Token, Waker};
use crate::viewer::error::ViewerError;
use crate::viewer::expected::Expected;
use crate::viewer::input::{Moment, Mouse};
use crate::viewer::launch::ViewerOptions;
use crate::viewer::link::Front;
use crate::viewer::panel::Panels;
use crate::viewer::view::View;

/// The size of a window where no monitor tells its own.
const USUAL_SIZE: [u32; 2] = [1280, 720];

/// One window.
pub(super) struct Session {
    // Dropped in this order: what draws before what it draws on.
    pub output: Output,
    pub canvas: Canvas,
    pub overlay: Overlay,
    pub screen: Screen,
    pub window: Arc<Window>,

    pub front: Front,
    pub waker: Waker,
    pub options: ViewerOptions,
    /// What it looks at. `None` before the first snapshot.
    pub view: Option<View>,
    /// The model that the view was made for.
    pub generation: u64,
    pub panels: Panels,
    pub mouse: Mouse,
    pub modifiers: ModifiersState,
    /// Where the pointer is, in pixels from the upper left corner.
    pub pointer: [f64; 2],
    /// Whether a button went down in the picture and not on a panel: until it is released, the panels are not there.
    pub holds_picture: bool,
    /// The state that requests without an answer lead to.
    pub expected: Expected,
    pub opened: Instant,
    /// The start of the frame after which the present events are processed, if they may have come while it was drawn.
    pub frame_began: Option<Duration>,
    pub pace: Pace,
    pub over: bool,
    _interrupt: interrupt::Guard,
}

impl Session {
    /// Opens a window, and tells who asked for it whether it came.
    pub fn open(event_loop: &ActiveEventLoop, opening: Opening) -> Option<(WindowId, Self)> {
        if opening.front.is_closing() {
            // Whoever asked for it has changed its mind.
            return None;
        }
        let answer = opening.opened.clone();
        let (session, told) = match Self::make(event_loop, opening) {
            Ok(session) => (Some((session.window.id(), session)), Ok(())),
            Err(error) => (None, Err(error)),
        };
        // Nobody may wait for it any more.
        let _ = answer.send(told);
        session
    }

    fn make(event_loop: &ActiveEventLoop, opening: Opening) -> Result<Self, ViewerError> {
        let Opening { waker, front, mut options, .. } = opening;
        let monitor = event_loop.primary_monitor().or_else(|| event_loop.available_monitors().next());
        let two_thirds = |size: PhysicalSize<u32>| [2 * size.width / 3, 2 * size.height / 3];
        let usual = monitor.as_ref().map(|monitor| two_thirds(monitor.size())).filter(|size| !size.contains(&0));
        let size = *options.size.get_or_insert(usual.unwrap_or(USUAL_SIZE));
        let rate = monitor.and_then(|monitor| monitor.refresh_rate_millihertz()).map(|rate| f64::from(rate) / 1000.0);

        let attributes =
            Window::default_attributes().with_title(&options.title).with_inner_size(PhysicalSize::<u32>::from(size));
        let window = event_loop.create_window(attributes).map_err(|error| ViewerError::Window(error.to_string()))?;
        let window = Arc::new(window);
        let screen = Screen::new(window.clone(), options.vsync)?;
        let overlay = Overlay::new(&window, screen.gpu().device(), screen.format());
        let mut mouse = Mouse::default();
        mouse.resize(screen.size().map(f64::from));
        let mut pace = Pace::new(rate);
        let now = Instant::now();
        pace.ask(now);
        Ok(Self {
            output: Output::new(&options),
            canvas: Canvas::default(),
            overlay,
            screen,
            window,
            front,
            _interrupt: interrupt::Guard::new(waker.proxy()),
            waker,
            options,
            view: None,
            generation: 0,
            panels: Panels::default(),
            mouse,
            modifiers: ModifiersState::empty(),
            pointer: [0.0; 2],
            holds_picture: false,
            expected: Expected::default(),
            opened: now,
            frame_began: None,
            pace,
            over: false,
        })
    }

    pub fn token(&self) -> Token {
        self.waker.token()
    }

    /// Whether it is to be taken away.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// There is something new to be seen.
    pub fn look(&mut self) {
        // Told again only when this is drawn: a simulation that is faster than the screen does not wake it for nothing.
        if self.front.is_closing() {
            self.close();
        }
        self.pace.ask(Instant::now());
    }

    /// Closes it: finishes what is recorded, and ends the physics.
    pub fn close(&mut self) {
        if let Err(problem) = self.finish_recording() {
            log::error!("{problem}");
        }
        self.front.close();
        // At once: what destroys it is sent only with what comes next, which may never come.
        self.window.set_visible(false);
        self.over = true;
    }

    /// When the next frame is due.
    pub fn due(&self) -> Option<Instant> {
        self.pace.due()
    }

    pub fn ask_to_be_drawn(&self) {
        self.window.request_redraw();
    }

    pub fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    /// Returns when the event that is processed now has come. The queue has no times: it may have come since the frame before began.
    pub fn moment(&self) -> Moment {
        let latest = self.now();
        Moment { earliest: self.frame_began.unwrap_or(latest), latest }
    }

    /// The thread has waited for events: the next ones have come since then.
    pub fn waited(&mut self) {
        self.frame_began = None;
    }

    pub fn event(&mut self, event_loop: &ActiveEventLoop, event: &WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => self.close(),
            WindowEvent::RedrawRequested => {
                if let Err(problem) = self.draw(event_loop) {
                    self.recover(&problem);
                }
            }
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                self.screen.resize();
                self.mouse.resize(self.screen.size().map(f64::from));
                self.overlay.hear(&self.window, event, self.modifiers);
                self.pace.ask(Instant::now());
            }
            WindowEvent::Occluded(false) => self.pace.ask(Instant::now()),
            _ => self.input(event),
        }
    }
}
