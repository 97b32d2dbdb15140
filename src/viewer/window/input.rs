//! A session's keys, mouse and files.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton as WinitButton, WindowEvent};
use winit::window::Fullscreen;

use super::session::Session;
use super::translate;
use crate::model::Model;
use crate::viewer::input::{Action, Gesture, KeyPress, WindowAction, action, help_text};
use crate::viewer::mode::Mode;
use crate::viewer::probe;
use crate::viewer::request::Request;
use crate::viewer::view::Effect;

/// Columns of a terminal that does not tell.
const USUAL_COLUMNS: usize = 80;

impl Session {
    /// Hands an event to the panels or to the picture.
    pub(super) fn input(&mut self, event: &WindowEvent) {
        if self.overlay.needs_pass_before(event) {
            self.lay_out();
        }
        self.overlay.hear(&self.window, event, self.modifiers);
        let changes = match event {
            WindowEvent::ModifiersChanged(modifiers) => {
                self.modifiers = modifiers.state();
                true
            }
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => {
                self.key(event);
                true
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.button(*state, *button);
                true
            }
            WindowEvent::CursorMoved { position, .. } => self.moved([position.x, position.y]),
            WindowEvent::MouseWheel { delta, .. } => {
                if !self.overlay.is_over(self.pointer) {
                    let mode = self.mode();
                    let gesture =
                        self.mouse.scroll(translate::notches(*delta), translate::modifiers(self.modifiers), mode);
                    self.gesture(gesture);
                }
                true
            }
            WindowEvent::Focused(false) => {
                self.let_go();
                true
            }
            WindowEvent::DroppedFile(path) => {
                self.load(path);
                true
            }
            WindowEvent::CursorLeft { .. }
            | WindowEvent::Focused(true)
            | WindowEvent::ThemeChanged(_)
            | WindowEvent::Ime(_) => true,
            _ => false,
        };
        if changes {
            self.pace.ask(Instant::now());
        }
    }

    fn mode(&self) -> Mode {
        self.front.drawn().map_or(Mode::Passive, |snapshot| self.expected.mode(snapshot))
    }

    fn key(&mut self, event: &KeyEvent) {
        if event.state != ElementState::Pressed || self.overlay.is_editing() {
            return;
        }
        let Some(key) = translate::key(event) else { return };
        probe::note_key(key);
        let press = KeyPress { key, modifiers: translate::modifiers(self.modifiers), repeat: event.repeat };
        match action(press, self.mode()) {
            Some(action) => self.act(action),
            None => self.ask(Request::Key(press)),
        }
    }

    /// Queues a request for the simulation.
    pub(super) fn ask(&mut self, request: Request) {
        if let Some(view) = &self.view {
            self.front.look(&view.look());
        }
        if let Some(snapshot) = self.front.drawn() {
            self.expected.note(&request, self.front.next_number(&request), snapshot);
        }
        self.front.ask(request);
    }

    pub(super) fn act(&mut self, action: Action) {
        let (Some(view), Some(snapshot)) = (&mut self.view, self.front.drawn()) else {
            // Before there is something to be seen, a window can be closed and sized.
            if let Action::Window(action) = action {
                self.act_on_window(action);
            }
            return;
        };
        let effect = view.act(action, &snapshot.model);
        self.effect(effect);
    }

    fn effect(&mut self, effect: Effect) {
        match effect {
            Effect::Done => {}
            Effect::Ask(request) => self.ask(request),
            Effect::Window(action) => self.act_on_window(action),
        }
    }

    pub(super) fn act_on_window(&mut self, action: WindowAction) {
        match action {
            WindowAction::Quit => self.close(),
            // A recording keeps its size, and so does what is seen of it.
            WindowAction::Resize(_) | WindowAction::DefaultSize | WindowAction::FullScreen
                if self.output.is_recording() =>
            {
                self.panels.notice("the size stays while a recording runs".to_owned());
            }
            WindowAction::Resize(size) => self.resize(size),
            WindowAction::DefaultSize => {
                if let Some(size) = self.options.size {
                    self.resize(size);
                }
            }
            WindowAction::FullScreen => {
                let full = self.window.fullscreen().is_none();
                self.window.set_fullscreen(full.then_some(Fullscreen::Borderless(None)));
            }
            WindowAction::Record => self.toggle_recording(),
            WindowAction::Screenshot => self.screenshot(),
            WindowAction::Reload => match self.options.file.clone() {
                Some(file) => self.load(&file),
                None => self.panels.notice("this model is not from a file; drop one onto the window".to_owned()),
            },
            WindowAction::PrintHelp => self.print_help(),
        }
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        self.window.set_fullscreen(None);
        self.window.set_maximized(false);
        // If it was done at once, there is no event.
        if self.window.request_inner_size(PhysicalSize::new(width, height)).is_some() {
            self.screen.resize();
            self.mouse.resize(self.screen.size().map(f64::from));
        }
    }

    fn print_help(&self) {
        let columns = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok()).unwrap_or(USUAL_COLUMNS);
        println!("{}", help_text(self.mode(), columns));
    }

    /// Replaces the model by that of a file.
    pub(super) fn load(&mut self, path: &Path) {
        let is_binary = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mjb"));
        let model = if is_binary { Model::from_binary_path(path) } else { Model::from_xml_path(path) };
        match model {
            Ok(model) => {
                self.options.file = Some(path.to_owned());
                self.ask(Request::Reload(Arc::new(model)));
                self.panels.notice(format!("loaded {}", path.display()));
            }
            Err(error) => self.panels.warn(error.to_string()),
        }
    }

    fn button(&mut self, state: ElementState, button: WinitButton) {
        let Some(button) = translate::button(button) else { return };
        let gesture = if state == ElementState::Released {
            self.holds_picture = false;
            self.mouse.release(button)
        } else if self.overlay.is_over(self.pointer) {
            return;
        } else {
            self.holds_picture = true;
            self.overlay.stop_editing();
            let selected = self.front.drawn().is_some_and(|snapshot| self.expected.is_selected(snapshot));
            self.mouse.press(button, translate::modifiers(self.modifiers), self.moment(), selected)
        };
        self.gesture(gesture);
    }

    /// Says whether something is to be seen of it.
    fn moved(&mut self, at: [f64; 2]) -> bool {
        let was_over = self.overlay.is_over(self.pointer);
        self.pointer = at;
        let gesture = self.mouse.moved(at, translate::modifiers(self.modifiers));
        let moves = gesture != Gesture::None;
        self.gesture(gesture);
        moves || was_over || (!self.holds_picture && self.overlay.is_over(at))
    }

    /// The window has lost the keyboard, and with it the release of what is held.
    fn let_go(&mut self) {
        let gesture = self.mouse.leave();
        self.gesture(gesture);
        self.holds_picture = false;
    }

    fn gesture(&mut self, gesture: Gesture) {
        let (Some(view), Some(snapshot)) = (&mut self.view, self.front.drawn()) else { return };
        match view.gesture(gesture, snapshot) {
            Ok(effect) => self.effect(effect),
            // As when a camera is pushed beyond all numbers: it stays where it is.
            Err(error) => log::debug!("{error}"),
        }
    }
}
