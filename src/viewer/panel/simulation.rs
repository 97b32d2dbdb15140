//! Panels of the simulation and of the playback of trajectories.

use egui::{Button, DragValue, RichText, Ui};

use super::{PanelContext, layout, style};
use crate::viewer::input::{Action, ViewAction, WindowAction};
use crate::viewer::link::{EndpointRequest, Mode, PlaybackRequest, Request, SavedFile, SimulationRequest, Status};

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 56.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.snapshot.modes.is_empty() {
        ui.label(RichText::new("The program steps this simulation.").weak());
        ui.horizontal(|ui| {
            pause_button(ui, cx);
            if ui.button("Reset").clicked() {
                cx.send(Request::Reset);
            }
        });
    } else {
        buttons(ui, cx);
        modes(ui, cx);
        speed(ui, cx);
        noise(ui, cx);
    }
    files(ui, cx);
}

fn buttons(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        let paused = pause_button(ui, cx);
        for (text, steps) in [("−50", -50), ("−1", -1), ("+1", 1), ("+50", 50)] {
            if ui.add_enabled(paused, Button::new(text)).clicked() {
                cx.send(SimulationRequest::Step(steps));
            }
        }
        if ui.button("Reset").on_hover_text("restores the start state").clicked() {
            cx.send(Request::Reset);
        }
    });
}

/// Shows the button that pauses or resumes the simulation. Returns `true` if it is paused.
fn pause_button(ui: &mut Ui, cx: &mut PanelContext<'_>) -> bool {
    let paused = cx.predicted.is_paused(cx.snapshot);
    if ui.add(Button::new(if paused { "Run" } else { "Pause" }).min_size(egui::vec2(46.0, 0.0))).clicked() {
        cx.send(Request::Pause(!paused));
    }
    paused
}

fn files(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        // All buttons fit into a row of a panel of the usual width.
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 4.0;
        if ui.button("Open…").on_hover_text("opens a model file").clicked() {
            cx.actions.push(Action::View(ViewAction::Files));
        }
        if ui.button("Reload").on_hover_text("reloads the model's file").clicked() {
            cx.actions.push(Action::Window(WindowAction::Reload));
        }
    });
    ui.horizontal(|ui| {
        if ui.button("Copy state").on_hover_text("as a <key> for the model's XML").clicked() {
            cx.send(EndpointRequest::CopyState);
        }
        if ui.button("Screenshot").on_hover_text("saves a screenshot without the panels").clicked() {
            cx.actions.push(Action::Window(WindowAction::Screenshot));
        }
        let recording = cx.status.recording.is_some();
        let record = Button::new(if recording { "Stop" } else { "Record" }).selected(recording);
        if ui.add(record).on_hover_text("records a video without the panels").clicked() {
            cx.actions.push(Action::Window(WindowAction::Record));
        }
    });
    layout::labelled(ui, "save", 28.0, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 4.0;
        for (text, file, tooltip) in [
            ("XML", SavedFile::Xml, "the model as XML"),
            ("MJB", SavedFile::Binary, "the model in the engine's binary form"),
            ("Model", SavedFile::ModelText, "the engine's listing of the model"),
            ("Data", SavedFile::DataText, "the engine's listing of the simulation"),
        ] {
            if ui.button(text).on_hover_text(format!("{tooltip}, to {}", file.name())).clicked() {
                cx.actions.push(Action::Window(WindowAction::Save(file)));
            }
        }
    });
}

fn modes(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    layout::labelled(ui, "mode", 40.0, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for mode in cx.snapshot.modes.clone() {
            let text = if mode == Mode::Passive { "Passive".to_owned() } else { mode.to_string() };
            if ui.selectable_label(mode == cx.predicted.mode(cx.snapshot), text).clicked() {
                cx.send(SimulationRequest::SetMode(mode));
            }
        }
    });
}

fn speed(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let speed = cx.snapshot.speed;
    layout::labelled(ui, "speed", LABEL_WIDTH, |ui| {
        let mut factor = cx.predicted.target_speed(cx.snapshot);
        let slider = layout::slider(&mut factor, 0.01..=10.0)
            .logarithmic(true)
            .custom_formatter(|value, _| format!("{value:.2}x"));
        if ui.add(slider).changed() {
            cx.send(SimulationRequest::SetSpeed(factor));
        }
        if ui.add_enabled(speed.by_factor, Button::new("1x")).on_hover_text("in real time").clicked() {
            cx.send(SimulationRequest::ToggleSpeed);
        }
    });
    layout::labelled(ui, "actual", LABEL_WIDTH, |ui| {
        if cx.snapshot.status == Status::Paused || speed.measured <= 0.0 {
            let text = if cx.snapshot.status == Status::Paused { "paused" } else { "measuring" };
            ui.label(RichText::new(text).weak());
            return;
        }
        let text = RichText::new(format!("{:.2}x real time", speed.measured)).monospace();
        let slow = speed.measured < 0.9 * speed.target();
        ui.label(if slow { text.color(style::warning(ui)) } else { text })
            .on_hover_text(format!("{:.1} s were dropped since the start", speed.dropped));
    });
}

fn noise(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    if cx.snapshot.model.nu() == 0 {
        return;
    }
    let mut noise = cx.predicted.noise(cx.snapshot);
    let before = noise;
    layout::labelled(ui, "noise", LABEL_WIDTH, |ui| {
        ui.add(DragValue::new(&mut noise.deviation).speed(0.002).range(0.0..=2.0).max_decimals(3))
            .on_hover_text("standard deviation of the noise on the controls; 0 for none");
        ui.label(RichText::new("of half the range").weak());
    });
    layout::labelled(ui, "", LABEL_WIDTH, |ui| {
        let time = &mut noise.correlation_time;
        ui.add(DragValue::new(time).speed(0.01).range(0.0..=10.0).max_decimals(3).suffix(" s"));
        ui.label(RichText::new("correlation time").weak());
    });
    if noise != before {
        cx.send(SimulationRequest::SetNoise(noise));
    }
}

/// Width of the labels, points.
const PLAYBACK_LABEL_WIDTH: f32 = 84.0;

pub(super) fn show_playback(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(playback) = cx.snapshot.playback else { return };
    layout::labelled(ui, "trajectory", PLAYBACK_LABEL_WIDTH, |ui| {
        let mut number = cx.predicted.trajectory(cx.snapshot).unwrap_or(playback.trajectory) + 1;
        let slider = layout::slider(&mut number, 1..=playback.trajectories)
            .custom_formatter(|value, _| format!("{value} / {}", playback.trajectories));
        if ui.add_enabled(playback.trajectories > 1, slider).changed() {
            cx.send(PlaybackRequest::SetTrajectory(number - 1));
        }
    });
    layout::labelled(ui, "record", PLAYBACK_LABEL_WIDTH, |ui| {
        let mut record = cx.predicted.record(cx.snapshot).unwrap_or(playback.frame) + 1;
        let slider = layout::slider(&mut record, 1..=playback.frames)
            .custom_formatter(|value, _| format!("{value} / {}", playback.frames));
        if ui.add(slider).changed() {
            cx.send(PlaybackRequest::SetFrame(record - 1));
        }
    });
    let burst = cx.predicted.burst(cx.snapshot, playback.burst);
    ui.horizontal(|ui| {
        for (text, on, request) in [
            ("reverse", playback.reversed, PlaybackRequest::ToggleReverse),
            ("burst", burst.on, PlaybackRequest::ToggleBurst),
            ("Doppler", burst.doppler, PlaybackRequest::ToggleDoppler),
        ] {
            let mut on = on;
            if ui.checkbox(&mut on, text).changed() {
                cx.send(request);
            }
        }
    });
    let mut notches = |ui: &mut Ui, name: &str, value: f64, request: fn(f64) -> PlaybackRequest| {
        layout::labelled(ui, name, PLAYBACK_LABEL_WIDTH, |ui| {
            let mut wanted = value;
            let slider = layout::slider(&mut wanted, 1.0..=40.0).step_by(1.0);
            if ui.add_enabled(burst.on, slider).changed() {
                cx.send(request(wanted - value));
            }
        });
    };
    notches(ui, "density", burst.factor, PlaybackRequest::ChangeBurstFactor);
    notches(ui, "fading", burst.gamma, PlaybackRequest::ChangeBurstGamma);
}
