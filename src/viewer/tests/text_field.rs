//! Numbers that the user types into the panels while the simulation is busy, so that the newest
//! snapshot is older than the last key.

use egui::epaint::ClippedShape;
use egui::{Context, Event, PointerButton, Pos2, RawInput, Rect, Shape, vec2};

use super::Bench;
use crate::viewer::input::Action;
use crate::viewer::instruments::{Instruments, WithInstruments};
use crate::viewer::link::{PredictedState, Request};
use crate::viewer::panel::{PanelContext, Panels, WindowStatus};
use crate::{Data, ZeroController, sample};

/// Panels without a window.
struct Screen {
    bench: Bench,
    panels: Panels,
    context: Context,
    predicted: PredictedState,
    shapes: Vec<ClippedShape>,
}

impl Screen {
    fn new(bench: Bench) -> Self {
        let mut screen = Self {
            bench,
            panels: Panels::default(),
            context: Context::default(),
            predicted: PredictedState::default(),
            shapes: Vec::new(),
        };
        screen.bench.view.info = false;
        // The first passes determine the layout.
        for _ in 0..3 {
            screen.pass(Vec::new());
        }
        screen
    }

    /// Runs a pass of the panels and sends the resulting requests, as the window does, without a
    /// tick of the simulation.
    fn pass(&mut self, events: Vec<Event>) {
        let Self { bench: Bench { window, view, .. }, panels, context, predicted, shapes } = self;
        let status =
            WindowStatus { size: [1200, 900], rate: None, recording: None, loading: None, vsync: true, gpu: "none" };
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(1200.0, 900.0)));
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
    fn click(&mut self, text: &str) {
        let found = self.shapes.iter().find_map(|shape| find_text(&shape.shape, text));
        let pos = found.unwrap_or_else(|| panic!("the panels do not show {text}"));
        self.pass(vec![Event::PointerMoved(pos)]);
        for pressed in [true, false] {
            let modifiers = egui::Modifiers::NONE;
            self.pass(vec![Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers }]);
        }
        self.pass(Vec::new());
        assert!(self.context.text_edit_focused(), "{text} is a text field");
    }

    /// Types a text with a pass for each key, and ends the editing.
    fn write(&mut self, text: &str) {
        for character in text.chars() {
            self.pass(vec![Event::Text(character.to_string())]);
        }
        let enter = egui::Event::Key {
            key: egui::Key::Enter,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        self.pass(vec![enter]);
        self.pass(Vec::new());
    }
}

fn find_text(shape: &Shape, wanted: &str) -> Option<Pos2> {
    match shape {
        Shape::Vec(shapes) => shapes.iter().find_map(|shape| find_text(shape, wanted)),
        Shape::Text(text) if text.galley.text() == wanted => Some(text.visual_bounding_rect().center()),
        _ => None,
    }
}

#[test]
fn typed_parameter_is_received_after_the_last_key() {
    let mut force = 0.125;
    let declare = move |_: &mut ZeroController, _: &Data, instruments: &mut Instruments| {
        instruments.parameter("force", &mut force, -1.0..=1.0);
    };
    let controller = WithInstruments { controller: ZeroController, declare };
    let mut screen = Screen::new(Bench::instrumented(Data::new(sample::cartpole()).unwrap(), controller));
    screen.click("0.125");
    screen.write("0.375");
    assert_eq!(screen.bench.snapshot().parameters[0].value, 0.125, "the simulation is busy");
    assert_eq!(screen.bench.tick().parameters[0].value, 0.375);
}

#[test]
fn typed_controls_positions_and_speeds_are_received_after_the_last_key() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.ctrl_mut()[0] = 0.25;
    data.qpos_mut()[0] = 0.125;
    let mut bench = Bench::new(data);
    (bench.view.left_panel, bench.view.right_panel) = (true, true);
    let mut screen = Screen::new(bench);
    screen.click("0.25");
    screen.write("-0.75");
    screen.click("0.125");
    screen.write("0.625");
    screen.click("1.00x");
    screen.write("3.5");
    assert_eq!(screen.bench.snapshot().ctrl, [0.25], "the simulation is busy");
    let snapshot = screen.bench.tick();
    assert_eq!((snapshot.ctrl[0], snapshot.qpos[0], snapshot.speed.target()), (-0.75, 0.625, 3.5));
}

#[test]
fn buttons_toggle_the_state_after_the_pending_requests() {
    let mut screen = Screen::new(Bench::new(Data::new(sample::cartpole()).unwrap()));
    for paused in [false, true, false] {
        let request = Request::Pause(paused);
        let number = screen.bench.window.send(request.clone()).unwrap();
        screen.predicted.update(request, number, screen.bench.window.current().unwrap());
        assert_eq!(screen.predicted.is_paused(screen.bench.window.current().unwrap()), paused);
    }
}
