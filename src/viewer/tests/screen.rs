//! Panels without a window, for tests of their contents and of input to them.

use egui::epaint::ClippedShape;
use egui::{Context, Event, Key, Mesh, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, vec2};

use super::Bench;
use crate::viewer::input::Action;
use crate::viewer::link::{PredictedState, Request};
use crate::viewer::options::Theme;
use crate::viewer::panel::{PanelContext, Panels, WindowStatus, apply_style};

/// Panels without a window.
pub(super) struct Screen {
    pub bench: Bench,
    pub panels: Panels,
    pub predicted: PredictedState,
    pub size: [u32; 2],
    context: Context,
    shapes: Vec<ClippedShape>,
}

impl Screen {
    /// Shows the open panels of the bench's view in a window of 1200 × 900 points.
    pub fn new(bench: Bench) -> Self {
        let mut screen = Self {
            bench,
            panels: Panels::default(),
            predicted: PredictedState::default(),
            size: [1200, 900],
            context: context(),
            shapes: Vec::new(),
        };
        screen.settle();
        screen
    }

    /// Runs the passes that determine the layout.
    pub fn settle(&mut self) {
        (0..3).for_each(|_| self.pass(Vec::new()));
    }

    /// Runs the simulation for some seconds, and shows ten states of each second.
    pub fn run(&mut self, seconds: f64) {
        self.bench.send(Request::Pause(false));
        for _ in 0..(10.0 * seconds).ceil() as usize {
            self.bench.pass(0.1);
            self.pass(Vec::new());
        }
        self.bench.send(Request::Pause(true));
        self.settle();
    }

    /// Runs a pass of the panels and sends the resulting requests, as the window does, without a
    /// tick of the simulation.
    pub fn pass(&mut self, events: Vec<Event>) {
        let Self { bench: Bench { window, view, .. }, panels, predicted, size, context, shapes } = self;
        let status = WindowStatus { size: *size, rate: None, recording: None, loading: None, vsync: true, gpu: "none" };
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32)));
        panels.record(window.current_mut().unwrap());
        let mut actions = Vec::new();
        let mut output = context.run_ui(RawInput { screen_rect, events, ..RawInput::default() }, |ui| {
            actions.clear();
            let snapshot = window.current().unwrap();
            let mut cx = PanelContext {
                snapshot,
                view,
                predicted,
                status: &status,
                panes: &[],
                released_keys: &[],
                actions: &mut actions,
            };
            panels.show(ui, &mut cx);
        });
        // Nothing is drawn.
        output.textures_delta.clear();
        *shapes = output.shapes;
        for action in actions {
            let Action::Send(request) = action else { panic!("an action on the window: {action:?}") };
            let number = window.send(request.clone()).unwrap();
            predicted.update(request, number, window.current().unwrap());
        }
    }

    /// Clicks on the first text that is equal to this one.
    pub fn click(&mut self, text: &str) {
        let rect = self.find(text).unwrap_or_else(|| panic!("the panels do not show {text}: {:?}", self.texts()));
        self.click_at(rect.center());
    }

    /// Clicks at a position.
    pub fn click_at(&mut self, pos: Pos2) {
        self.pass(vec![Event::PointerMoved(pos)]);
        for pressed in [true, false] {
            self.press(pos, pressed);
        }
        self.pass(Vec::new());
    }

    /// Presses or releases the left button.
    fn press(&mut self, pos: Pos2, pressed: bool) {
        self.pass(vec![Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }]);
    }

    /// Clicks on a text of a text field.
    pub fn edit(&mut self, text: &str) {
        self.click(text);
        assert!(self.context.text_edit_focused(), "{text} is a text field");
    }

    /// Drags with the left button.
    pub fn drag(&mut self, from: [f32; 2], to: [f32; 2]) {
        let [from, to] = [from, to].map(|[x, y]| Pos2::new(x, y));
        self.pass(vec![Event::PointerMoved(from)]);
        self.press(from, true);
        self.pass(vec![Event::PointerMoved(from.lerp(to, 0.5))]);
        self.pass(vec![Event::PointerMoved(to)]);
        self.press(to, false);
        self.settle();
    }

    /// Types a text with a pass for each key.
    pub fn write(&mut self, text: &str) {
        for character in text.chars() {
            self.pass(vec![Event::Text(character.to_string())]);
        }
    }

    /// Presses a key.
    pub fn key(&mut self, key: Key) {
        self.pass(vec![Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }]);
        self.pass(Vec::new());
    }

    /// Types a text and ends the editing with Enter.
    pub fn enter(&mut self, text: &str) {
        self.write(text);
        self.key(Key::Enter);
    }

    /// Returns the place of the first text that is equal to this one.
    pub fn find(&self, text: &str) -> Option<Rect> {
        self.placed().into_iter().find(|(shown, _)| shown == text).map(|(_, rect)| rect)
    }

    /// Returns the visible texts.
    pub fn texts(&self) -> Vec<String> {
        self.placed().into_iter().map(|(text, _)| text).collect()
    }

    /// Returns the number of lines with many points, which are curves of plots.
    pub fn curves(&self) -> usize {
        let is_curve = |shape: &ClippedShape| matches!(&shape.shape, Shape::Path(path) if !path.closed);
        self.shapes.iter().filter(|shape| is_curve(shape)).count()
    }

    /// Returns the places of filled areas, and the parts of these places that they cover.
    pub fn areas(&self) -> Vec<(Rect, f32)> {
        let covered = |mesh: &Mesh| -> f32 {
            let pos = |index: &u32| mesh.vertices[*index as usize].pos;
            let triangles = mesh.indices.chunks(3).map(|triangle| [0, 1, 2].map(|corner| pos(&triangle[corner])));
            triangles.map(|[a, b, c]| 0.5 * ((b - a).rot90().dot(c - a)).abs()).sum()
        };
        let meshes = self.shapes.iter().filter_map(|shape| match &shape.shape {
            Shape::Mesh(mesh) if !mesh.is_empty() => Some(mesh),
            _ => None,
        });
        meshes.map(|mesh| (mesh.calc_bounds(), covered(mesh) / mesh.calc_bounds().area())).collect()
    }

    fn placed(&self) -> Vec<(String, Rect)> {
        let mut texts = Vec::new();
        for ClippedShape { clip_rect, shape, .. } in &self.shapes {
            add_texts(shape, *clip_rect, &mut texts);
        }
        texts
    }
}

/// Returns a context with the style of the panels.
fn context() -> Context {
    let context = Context::default();
    apply_style(&context, Theme::Dark, 1.0);
    context
}

fn add_texts(shape: &Shape, clip: Rect, texts: &mut Vec<(String, Rect)>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| add_texts(shape, clip, texts)),
        Shape::Text(text) => {
            let rect = text.visual_bounding_rect();
            if clip.contains(rect.center()) {
                texts.push((text.galley.text().to_owned(), rect));
            }
        }
        _ => {}
    }
}
