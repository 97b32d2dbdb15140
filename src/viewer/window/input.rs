//! Keyboard, mouse and dropped files of a session.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton as WinitButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{Key as WinitKey, NamedKey};
use winit::platform::modifier_supplement::KeyEventExtModifierSupplement;
use winit::window::Fullscreen;

use super::file_watch::FileWatch;
use super::model_loader::ModelLoader;
use super::overlay::viewer_modifiers;
use super::session::Session;
use crate::viewer::input::{
    Action, Gesture, Key, KeyPress, MouseButton, ViewAction, WindowAction, find_action, help_text,
};
use crate::viewer::link::{EndpointRequest, Kept, Mode, Request, SharedModel, SimulationRequest};

/// Columns of the terminal if `COLUMNS` is not set.
const DEFAULT_COLUMNS: usize = 80;
/// Pixels that a touchpad scrolls for one notch of a wheel.
const PIXELS_PER_NOTCH: f64 = 50.0;
/// Minimum time between passes of the panels that change the highlighted widget.
const HIGHLIGHT_SPACING: Duration = Duration::from_millis(100);
/// Minimum time between passes of the panels for motions over one widget, such as a plot that
/// labels the point under the pointer.
const HOVER_SPACING: Duration = Duration::from_millis(200);

impl Session {
    /// Dispatches an input event to the panels and to the scene.
    pub(super) fn handle_input(&mut self, event: &WindowEvent) {
        if self.overlay.needs_pass_before(event) {
            self.run_panels();
        }
        self.overlay.handle_event(&self.window, event, self.modifiers);
        let changes = match event {
            WindowEvent::ModifiersChanged(modifiers) => {
                self.modifiers = modifiers.state();
                true
            }
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => {
                self.press_key(event);
                true
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.change_button(*state, *button);
                true
            }
            WindowEvent::CursorMoved { position, .. } => self.move_pointer([position.x, position.y]),
            WindowEvent::MouseWheel { delta, .. } => {
                if !self.overlay.is_over(self.pointer) {
                    let mode = self.mode();
                    let gesture = self.mouse.scroll(notches(*delta), viewer_modifiers(self.modifiers), mode);
                    self.perform(gesture);
                }
                true
            }
            WindowEvent::Focused(false) => {
                self.release_all();
                true
            }
            WindowEvent::DroppedFile(path) => {
                self.open_file(path);
                true
            }
            WindowEvent::CursorLeft { .. }
            | WindowEvent::Focused(true)
            | WindowEvent::ThemeChanged(_)
            | WindowEvent::Ime(_) => true,
            _ => false,
        };
        if changes {
            // Only the scene follows a motion at once, unless the pointer drags a widget.
            self.panels_stale |= !matches!(event, WindowEvent::CursorMoved { .. }) || self.overlay.is_dragging();
            self.scheduler.request(Instant::now());
        }
    }

    fn mode(&self) -> Mode {
        self.link.current().map_or(Mode::Passive, |snapshot| self.predicted.mode(snapshot))
    }

    fn press_key(&mut self, event: &KeyEvent) {
        if event.state != ElementState::Pressed {
            return;
        }
        let editing = self.overlay.is_editing();
        let Some(key) = translate_key(event) else { return };
        #[cfg(feature = "_test-hooks")]
        crate::viewer::test_hooks::count_marker(key);
        let press = KeyPress { key, modifiers: viewer_modifiers(self.modifiers), repeat: event.repeat };
        match find_action(press, self.mode(), &self.options.released_keys) {
            // A text field takes all other keys.
            Some(action) if !editing || matches!(action, Action::Window(WindowAction::Quit)) => self.act(action),
            None if !editing => self.send(EndpointRequest::ForwardKey(press).into()),
            _ => {}
        }
    }

    /// Sends a request to the physics.
    fn send(&mut self, request: Request) {
        if let Some(view) = &self.view {
            self.link.set_view(&view.scene_view());
        }
        if let (Some(number), Some(snapshot)) = (self.link.send(request.clone()), self.link.current()) {
            self.predicted.update(request, number, snapshot);
        }
    }

    /// Performs the action of a key or a panel. Before the first snapshot, only actions on the
    /// window have an effect.
    pub(super) fn act(&mut self, action: &Action) {
        let (view, snapshot) = (self.view.as_mut(), self.link.current());
        match action {
            Action::Window(action) => self.act_on_window(*action),
            Action::View(action) => {
                let (Some(view), Some(snapshot)) = (view, snapshot) else { return };
                let window_action = view.apply(*action, &snapshot.model);
                if matches!(action, ViewAction::Camera(_) | ViewAction::FreeCamera) {
                    self.panels.announce_camera(&view.camera, &snapshot.model);
                }
                if let Some(action) = window_action {
                    self.act_on_window(action);
                }
            }
            Action::Open(path) => self.open_file(path),
            Action::Send(request) => {
                if view.is_some() && snapshot.is_some() {
                    self.send(request.clone());
                }
            }
        }
    }

    fn act_on_window(&mut self, action: WindowAction) {
        match action {
            WindowAction::Quit => self.close(),
            // All frames of a recording have the same size.
            WindowAction::Resize(_) | WindowAction::DefaultSize | WindowAction::FullScreen
                if self.output.is_recording() =>
            {
                self.panels.notice("the size cannot change during a recording".to_owned());
            }
            WindowAction::Resize(size) => self.resize(size),
            WindowAction::DefaultSize => {
                if let Some(size) = self.options.size {
                    self.resize(size.map(|length| length as u32));
                }
            }
            WindowAction::FullScreen => {
                let full = self.window.fullscreen().is_none();
                self.window.set_fullscreen(full.then_some(Fullscreen::Borderless(None)));
            }
            WindowAction::Record => self.toggle_recording(),
            WindowAction::Screenshot => self.request_screenshot(),
            WindowAction::Save(file) => self.send(EndpointRequest::Save(file, self.options.directory.clone()).into()),
            WindowAction::Reload => match self.options.file.clone() {
                Some(file) => self.load(&file, Kept::View),
                None => self.panels.notice("this model has no file; drop a file onto the window".to_owned()),
            },
            WindowAction::PrintHelp => self.print_help(),
            WindowAction::SetVsync(vsync) => self.surface.set_vsync(vsync),
        }
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        self.window.set_fullscreen(None);
        self.window.set_maximized(false);
        // `Some` means that the size has changed immediately, without an event.
        if self.window.request_inner_size(PhysicalSize::new(width, height)).is_some() {
            self.surface.resize();
        }
    }

    fn print_help(&self) {
        let columns = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok()).unwrap_or(DEFAULT_COLUMNS);
        println!("{}", help_text(self.mode(), &self.options.released_keys, columns));
    }

    /// Starts to load a model file that the user has chosen. The camera stays if it is the present
    /// file.
    pub(super) fn open_file(&mut self, path: &Path) {
        let is_present = self.options.file.as_deref().is_some_and(|file| same_file(file, path));
        self.load(path, if is_present { Kept::View } else { Kept::Nothing });
    }

    /// Starts to load a model file. The result of a previous load that has not ended is discarded.
    fn load(&mut self, path: &Path, kept: Kept) {
        match ModelLoader::start(path, kept, self.waker.clone()) {
            Ok(loader) => self.loader = Some(loader),
            Err(error) => self.panels.warn(format!("cannot load {}: {error}", path.display())),
        }
    }

    /// Loads the model's file after it was changed.
    pub(super) fn load_changes(&mut self) {
        if !self.options.watch {
            return;
        }
        let Some(file) = &self.options.file else { return };
        match &self.watch {
            Some(watch) if watch.path() == file => {
                if watch.take_change() {
                    self.load(&file.clone(), Kept::State);
                }
            }
            _ => match FileWatch::start(file, self.waker.clone()) {
                Ok(watch) => self.watch = Some(watch),
                Err(error) => {
                    self.options.watch = false;
                    self.panels.warn(format!("cannot watch {}: {error}", file.display()));
                }
            },
        }
    }

    /// Replaces the model after its file was loaded, or shows the error.
    pub(super) fn finish_loading(&mut self) {
        let Some(loader) = self.loader.take() else { return };
        match loader.take_result() {
            None => self.loader = Some(loader),
            Some(Ok(model)) => {
                self.panels_stale = true;
                self.options.file = Some(loader.path().to_owned());
                self.panels.loaded(loader.path());
                let model = SharedModel(Arc::new(model));
                let kept = loader.kept();
                self.send(SimulationRequest::Load(model, kept).into());
                let what = if kept == Kept::State { "adopted the changes of" } else { "loaded" };
                self.panels.notice(format!("{what} {}", loader.path().display()));
            }
            Some(Err(error)) => {
                self.panels_stale = true;
                self.panels.warn(error.to_string());
            }
        }
    }

    /// Handles the press or the release of a mouse button.
    fn change_button(&mut self, state: ElementState, button: WinitButton) {
        let Some(button) = translate_button(button) else { return };
        let gesture = if state == ElementState::Released {
            self.scene_pressed = false;
            self.mouse.release(button)
        } else if self.overlay.is_over(self.pointer) {
            return;
        } else {
            self.scene_pressed = true;
            self.overlay.stop_editing();
            let selected = self.link.current().is_some_and(|snapshot| self.predicted.may_be_selected(snapshot));
            self.mouse.press(button, viewer_modifiers(self.modifiers), self.event_time(), selected)
        };
        self.perform(gesture);
    }

    /// Handles a motion of the pointer. Returns `true` if the scene changes or a widget is dragged.
    /// Other motions over a panel may change highlights: passes of the panels at a lower rate
    /// determine if they do.
    fn move_pointer(&mut self, position: [f64; 2]) -> bool {
        self.pointer = position;
        let gesture = self.mouse.moved(position, viewer_modifiers(self.modifiers));
        let moves = gesture != Gesture::None;
        self.perform(gesture);
        if moves || self.overlay.is_dragging() {
            return true;
        }
        let hovered = if self.scene_pressed { None } else { self.overlay.widget_at(position) };
        let spacing = match (hovered, std::mem::replace(&mut self.hovered, hovered)) {
            (None, None) => return false,
            (hovered, last) if hovered == last => HOVER_SPACING,
            _ => HIGHLIGHT_SPACING,
        };
        self.scheduler.request_pass_spaced(Instant::now(), spacing);
        false
    }

    /// Releases the held button after the window has lost the focus, because the release event will
    /// not arrive.
    fn release_all(&mut self) {
        let gesture = self.mouse.leave();
        self.perform(gesture);
        self.scene_pressed = false;
    }

    fn perform(&mut self, gesture: Gesture) {
        let (Some(view), Some(snapshot)) = (&mut self.view, self.link.current()) else { return };
        match gesture {
            Gesture::None => {}
            Gesture::Camera(action, motion) => {
                // A camera that would leave the range of finite numbers is not moved.
                if let Err(error) = view.move_camera(action, motion, snapshot) {
                    log::debug!("{error}");
                }
            }
            Gesture::Send(request) => self.send(request),
        }
    }
}

/// Returns `true` if two paths lead to the same existing file.
fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

/// Converts a key by its symbol without modifiers. `None` for keys that the viewer does not
/// support.
fn translate_key(event: &KeyEvent) -> Option<Key> {
    let named = match event.key_without_modifiers() {
        WinitKey::Named(named) => named,
        WinitKey::Character(text) => return character(&text),
        _ => return None,
    };
    Some(match named {
        NamedKey::Escape => Key::Escape,
        NamedKey::Enter => Key::Enter,
        NamedKey::Space => Key::Space,
        NamedKey::Tab => Key::Tab,
        NamedKey::Backspace => Key::Backspace,
        NamedKey::Delete => Key::Delete,
        NamedKey::Insert => Key::Insert,
        NamedKey::Home => Key::Home,
        NamedKey::End => Key::End,
        NamedKey::PageUp => Key::PageUp,
        NamedKey::PageDown => Key::PageDown,
        NamedKey::ArrowUp => Key::Up,
        NamedKey::ArrowDown => Key::Down,
        NamedKey::ArrowLeft => Key::Left,
        NamedKey::ArrowRight => Key::Right,
        function => Key::Function(FUNCTIONS.iter().position(|key| *key == function)? as u8 + 1),
    })
}

const FUNCTIONS: [NamedKey; 12] = [
    NamedKey::F1,
    NamedKey::F2,
    NamedKey::F3,
    NamedKey::F4,
    NamedKey::F5,
    NamedKey::F6,
    NamedKey::F7,
    NamedKey::F8,
    NamedKey::F9,
    NamedKey::F10,
    NamedKey::F11,
    NamedKey::F12,
];

fn character(text: &str) -> Option<Key> {
    let mut characters = text.chars().flat_map(char::to_lowercase);
    let first = characters.next()?;
    match (first, characters.next()) {
        (' ', None) => Some(Key::Space),
        (character, None) => Some(Key::Character(character)),
        _ => None,
    }
}

fn translate_button(button: WinitButton) -> Option<MouseButton> {
    match button {
        WinitButton::Left => Some(MouseButton::Left),
        WinitButton::Middle => Some(MouseButton::Middle),
        WinitButton::Right => Some(MouseButton::Right),
        _ => None,
    }
}

/// Returns a scroll distance in notches of a wheel, upwards.
fn notches(delta: MouseScrollDelta) -> f64 {
    match delta {
        MouseScrollDelta::LineDelta(_, lines) => lines.into(),
        MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
    }
}
