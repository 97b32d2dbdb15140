//! Session of a window: its state, opening, closing and dispatch of events.

use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::ModifiersState;
use winit::monitor::MonitorHandle;
use winit::window::{Window, WindowId};

use super::Opening;
use super::canvas::Canvas;
use super::file_watch::FileWatch;
use super::model_loader::ModelLoader;
use super::open_windows::OpenWindow;
use super::output::Output;
use super::overlay::Overlay;
use super::panes::Panes;
use super::scene_renderer::SceneRenderer;
use super::scheduler::FrameScheduler;
use super::surface::WindowSurface;
use super::wake::{Waker, WindowToken, connection_is_lost, message_of};
use crate::error::catch_panic;
use crate::render::RendererOptions;
use crate::viewer::error::ViewerError;
use crate::viewer::input::{EventTime, Mouse};
use crate::viewer::link::{PredictedState, Snapshot, WindowEnd};
use crate::viewer::options::ViewerOptions;
use crate::viewer::panel::Panels;
use crate::viewer::remembered::Layout;
use crate::viewer::view::View;

/// Size of a window if no monitor reports its size.
const DEFAULT_SIZE: [usize; 2] = [1280, 720];

/// Window with its surface, its panels and its end of the link.
pub(super) struct Session {
    // Fields are dropped in this order: renderers before the surface, the surface before the
    // window.
    pub output: Output,
    pub renderer: SceneRenderer,
    pub panes: Panes,
    pub overlay: Overlay,
    pub canvas: Canvas,
    pub surface: WindowSurface,
    pub window: Arc<Window>,

    /// Receives the result of the opening, and then the error that ends the session, if there is
    /// one.
    result: mpsc::Sender<Result<(), ViewerError>>,
    pub link: WindowEnd,
    pub waker: Waker,
    pub options: ViewerOptions,
    /// File that remembers the layout, if the window does.
    remembered: Option<PathBuf>,
    /// Layout of the previous window, or of the options.
    pub layout: Layout,
    /// Layout at the start.
    pub start: Option<Layout>,
    /// `None` before the first snapshot.
    pub view: Option<View>,
    /// Generation of the model to which the view belongs.
    pub generation: u64,
    pub panels: Panels,
    /// The next frame needs a pass of the panels.
    pub panels_stale: bool,
    /// Content of the last pass of the panels.
    pub shown: Option<PanelContent>,
    /// Model file that will replace the model.
    pub loader: Option<ModelLoader>,
    /// Detects changes of the model's file.
    pub watch: Option<FileWatch>,
    pub mouse: Mouse,
    pub modifiers: ModifiersState,
    /// Position of the pointer, in pixels from the upper left corner.
    pub pointer: [f64; 2],
    /// Widget of the panels under the pointer.
    pub hovered: Option<egui::Id>,
    /// A button was pressed over the scene. Until its release, the panels ignore the pointer.
    pub scene_pressed: bool,
    pub predicted: PredictedState,
    pub opened: Instant,
    /// Start of the last frame, if the events that are processed now may have arrived while it was
    /// drawn.
    pub frame_start: Option<Duration>,
    pub scheduler: FrameScheduler,
    /// The last frame was not drawn because the window was hidden.
    pub hidden: bool,
    pub closed: bool,
    /// Dropped last, because the process may end then.
    pub _registration: OpenWindow,
}

/// Values that the panels show, except the window's.
pub(super) struct PanelContent {
    /// Generation and number of the snapshot.
    pub snapshot: (u64, u64),
    pub view: View,
}

impl PanelContent {
    pub fn shows(&self, snapshot: &Snapshot, view: &View) -> bool {
        self.snapshot == (snapshot.generation, snapshot.number) && self.view == *view
    }
}

impl Session {
    /// Opens a window, and sends the result to the thread that requested it.
    pub fn open(event_loop: &ActiveEventLoop, opening: Opening) -> Option<(WindowId, Self)> {
        if opening.link.is_closing() {
            // The caller has already closed the window.
            return None;
        }
        let sender = opening.result.clone();
        let (session, result) = match catch_panic(|| Self::new(event_loop, opening)) {
            Ok(Ok(session)) => (Some((session.window.id(), session)), Ok(())),
            Ok(Err(error)) => (None, Err(error)),
            Err(panic) => (None, Err(ViewerError::Window(format!("a panic of its thread: {panic}")))),
        };
        // Fails if the caller no longer waits.
        let _ = sender.send(result);
        session
    }

    fn new(event_loop: &ActiveEventLoop, opening: Opening) -> Result<Self, ViewerError> {
        let Opening { waker, link, mut options, result } = opening;
        let registration = OpenWindow::register(waker.proxy())?;
        let monitor = event_loop.primary_monitor().or_else(|| event_loop.available_monitors().next());
        let available = monitor.as_ref().map(MonitorHandle::size).filter(|size| size.width > 0 && size.height > 0);
        let available = available.map(|size| [size.width, size.height].map(|length| length as usize));
        let remembered = options.layout_file().map(Path::to_owned);
        let layout = match &remembered {
            Some(path) => Layout::read(path),
            None => Layout { theme: options.theme, scale: options.scale, ..Layout::default() },
        };
        let default = layout.size.unwrap_or(available.map_or(DEFAULT_SIZE, |size| size.map(|length| 17 * length / 20)));
        let size = match (options.size, available) {
            (Some(size), _) => size,
            // The monitor may be smaller than that of the previous window.
            (None, Some(available)) => [default[0].min(available[0]), default[1].min(available[1])],
            (None, None) => default,
        };
        options.size = Some(size);
        let size = size.map(|length| length as u32);
        let rate = monitor.and_then(|monitor| monitor.refresh_rate_millihertz()).map(|rate| f64::from(rate) / 1000.0);

        let attributes =
            Window::default_attributes().with_title(&options.title).with_inner_size(PhysicalSize::<u32>::from(size));
        let window = event_loop.create_window(attributes).map_err(|error| ViewerError::Window(message_of(&error)))?;
        let window = Arc::new(window);
        let surface = WindowSurface::new(window.clone(), options.vsync)?;
        let overlay = Overlay::new(&window, surface.gpu().device(), surface.format(), &layout);
        let canvas = Canvas::new(surface.gpu(), surface.format())?;
        let mut scheduler = FrameScheduler::new(rate);
        let now = Instant::now();
        scheduler.request(now);
        let mut panels = Panels::new(layout.recent.clone());
        options.file.iter().for_each(|file| panels.loaded(file));
        Ok(Self {
            output: Output::new(&options),
            renderer: SceneRenderer::new(RendererOptions::default().with_lighting(options.lighting)),
            panes: Panes::new(options.lighting),
            overlay,
            canvas,
            surface,
            window,
            result,
            link,
            waker,
            options,
            remembered,
            layout,
            start: None,
            view: None,
            generation: 0,
            panels,
            panels_stale: true,
            shown: None,
            loader: None,
            watch: None,
            mouse: Mouse::default(),
            modifiers: ModifiersState::empty(),
            pointer: [0.0; 2],
            hovered: None,
            scene_pressed: false,
            predicted: PredictedState::default(),
            opened: now,
            frame_start: None,
            scheduler,
            hidden: false,
            closed: false,
            _registration: registration,
        })
    }

    pub fn token(&self) -> WindowToken {
        self.waker.token()
    }

    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Handles an update of the physics: a new snapshot or event, or the request to close the
    /// window.
    pub fn handle_update(&mut self) {
        // `draw` acknowledges the update, so a simulation that is faster than the screen sends one
        // message per frame.
        if self.link.is_closing() {
            self.close();
        }
        self.scheduler.request(Instant::now());
    }

    /// Finishes the recording, ends the physics and hides the window.
    pub fn close(&mut self) {
        if let Err(problem) = self.finish_recording() {
            log::error!("{problem}");
        }
        self.remember_layout();
        self.link.close();
        self.closed = true;
        if !connection_is_lost() {
            // The destruction of the window reaches the server only with the next request, which
            // may never be sent.
            self.window.set_visible(false);
        }
    }

    /// Writes what the user has changed to the file of the layout.
    fn remember_layout(&mut self) {
        let (Some(path), Some(start), Some(view)) = (self.remembered.take(), &self.start, &self.view) else { return };
        let is_full = self.window.fullscreen().is_some();
        let size = (!is_full).then(|| self.surface.size().map(|length| length as usize));
        let end = Layout { size, recent: self.panels.recent().to_vec(), ..self.overlay.layout().with_view(view) };
        let layout = self.layout.changed(start, end);
        if layout != self.layout
            && let Err(error) = layout.write(&path)
        {
            log::warn!("the layout is not remembered: {error}");
        }
    }

    /// Ends the session with an error, which the thread that opened the window receives. Finishes
    /// the recording as [`close`](Self::close) does.
    pub fn fail(&mut self, problem: &str) {
        if self.closed {
            return;
        }
        log::error!("the window failed: {problem}");
        // Fails if the caller does not wait for the end.
        let _ = self.result.send(Err(ViewerError::Window(problem.to_owned())));
        if let Err(panic) = catch_panic(|| self.close()) {
            log::error!("a panic while the window was closed: {panic}");
            self.link.close();
            self.closed = true;
        }
    }

    /// Returns the time since the window was opened.
    pub fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    /// Returns bounds of the time of the event that is processed now. The event queue has no times,
    /// so the event may have arrived at any time since the start of the last frame.
    pub fn event_time(&self) -> EventTime {
        let latest = self.now();
        EventTime { earliest: self.frame_start.unwrap_or(latest), latest }
    }

    /// Records that the thread has waited for events, so that the next events have arrived after
    /// the last frame.
    pub fn events_awaited(&mut self) {
        self.frame_start = None;
    }

    pub fn handle_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => self.close(),
            WindowEvent::RedrawRequested => {
                if let Err(problem) = self.draw() {
                    self.recover(&problem);
                }
            }
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                self.surface.resize();
                self.overlay.handle_event(&self.window, event, self.modifiers);
                self.panels_stale = true;
                self.scheduler.request(Instant::now());
            }
            WindowEvent::Occluded(false) => self.scheduler.request(Instant::now()),
            _ => self.handle_input(event),
        }
    }
}
