//! Pause, step, speed, mode, history.

use egui::{Button, RichText, Slider, Ui};

use super::{Shown, layout, style};
use crate::viewer::input::{Action, WindowAction};
use crate::viewer::mode::Mode;
use crate::viewer::request::Request;
use crate::viewer::snapshot::Status;

/// Width of the names.
const NAMES: f32 = 56.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let status = shown.snapshot.status;
    let own = status != Status::Program;
    if own {
        buttons(ui, shown);
        modes(ui, shown);
        speed(ui, shown);
        history(ui, shown);
    } else {
        ui.label(RichText::new("The program steps this simulation.").color(style::FAINT));
        ui.horizontal(|ui| {
            if ui.button("Reset").clicked() {
                shown.ask(Request::Reset);
            }
        });
    }
    files(ui, shown);
}

fn buttons(ui: &mut Ui, shown: &mut Shown<'_>) {
    let paused = shown.snapshot.status == Status::Paused;
    ui.horizontal(|ui| {
        if ui.add(Button::new(if paused { "Run" } else { "Pause" }).min_size(egui::vec2(46.0, 0.0))).clicked() {
            shown.ask(Request::Pause(!paused));
        }
        for (text, steps) in [("−50", -50), ("−1", -1), ("+1", 1), ("+50", 50)] {
            if ui.add_enabled(paused, Button::new(text)).clicked() {
                shown.ask(Request::Step(steps));
            }
        }
        if ui.button("Reset").on_hover_text("back to the start").clicked() {
            shown.ask(Request::Reset);
        }
    });
}

fn files(ui: &mut Ui, shown: &mut Shown<'_>) {
    ui.horizontal(|ui| {
        if ui.button("Reload").on_hover_text("reads the model's file again").clicked() {
            shown.act(Action::Window(WindowAction::Reload));
        }
        if ui.button("Copy state").on_hover_text("as a <key> for the model's XML").clicked() {
            shown.ask(Request::CopyState);
        }
        if ui.button("Picture").on_hover_text("saves what is seen, without the panels").clicked() {
            shown.act(Action::Window(WindowAction::Screenshot));
        }
        let recording = shown.facts.recording.is_some();
        if ui.selectable_label(recording, if recording { "Stop" } else { "Record" }).clicked() {
            shown.act(Action::Window(WindowAction::Record));
        }
    });
}

fn modes(ui: &mut Ui, shown: &mut Shown<'_>) {
    layout::named(ui, "mode", 40.0, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for mode in shown.snapshot.modes.clone() {
            let text = if mode == Mode::Passive { "Passive".to_owned() } else { mode.to_string() };
            if ui.selectable_label(mode == shown.snapshot.mode, text).clicked() {
                shown.ask(Request::SetMode(mode));
            }
        }
    });
}

fn speed(ui: &mut Ui, shown: &mut Shown<'_>) {
    let pace = shown.snapshot.pace;
    layout::named(ui, "speed", NAMES, |ui| {
        let mut factor = pace.wanted();
        let slider =
            Slider::new(&mut factor, 0.01..=10.0).logarithmic(true).custom_formatter(|value, _| format!("{value:.2}x"));
        if ui.add(slider).changed() {
            shown.ask(Request::SetSpeed(factor));
        }
        if ui.add_enabled(pace.by_factor, Button::new("1x")).on_hover_text("in real time").clicked() {
            shown.ask(Request::ToggleSpeed);
        }
    });
    layout::named(ui, "reached", NAMES, |ui| {
        if shown.snapshot.status == Status::Paused || pace.measured <= 0.0 {
            ui.label(RichText::new("at rest").color(style::FAINT));
            return;
        }
        let text = RichText::new(format!("{:.2}x real time", pace.measured)).monospace();
        let slow = pace.measured < 0.9 * pace.wanted();
        ui.label(if slow { text.color(style::WARNING) } else { text })
            .on_hover_text(format!("{:.1} s were given up since the start", pace.dropped));
    });
}

fn history(ui: &mut Ui, shown: &mut Shown<'_>) {
    let (count, moment) = (shown.snapshot.history, shown.snapshot.moment);
    layout::named(ui, "history", NAMES, |ui| {
        let mut at = moment.min(count);
        let slider = Slider::new(&mut at, 0..=count).show_value(false);
        if ui.add_enabled(count > 0, slider).on_hover_text("states to go back to").changed() {
            shown.ask(Request::Scrub(at));
        }
        ui.label(RichText::new(format!("{}", at as i64 - count as i64)).monospace().color(style::FAINT));
    });
}
