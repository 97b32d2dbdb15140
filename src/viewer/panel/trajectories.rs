//! Which moment of which trajectory is shown.

use egui::{Slider, Ui};

use super::{Shown, layout};
use crate::viewer::request::Request;

/// Width of the names.
const NAMES: f32 = 84.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let Some(playback) = shown.snapshot.playback else { return };
    layout::named(ui, "trajectory", NAMES, |ui| {
        let mut number = playback.trajectory + 1;
        let slider = Slider::new(&mut number, 1..=playback.trajectories)
            .custom_formatter(|value, _| format!("{value} / {}", playback.trajectories));
        if ui.add_enabled(playback.trajectories > 1, slider).changed() {
            shown.ask(Request::SetTrajectory(number - 1));
        }
    });
    layout::named(ui, "record", NAMES, |ui| {
        let mut record = playback.frame + 1;
        let slider = Slider::new(&mut record, 1..=playback.frames)
            .custom_formatter(|value, _| format!("{value} / {}", playback.frames));
        if ui.add(slider).changed() {
            shown.ask(Request::SetFrame(record - 1));
        }
    });
    let burst = playback.burst;
    ui.horizontal(|ui| {
        for (text, on, request) in [
            ("reverse", playback.reversed, Request::Reverse),
            ("burst", burst.on, Request::Burst),
            ("Doppler", burst.doppler, Request::Doppler),
        ] {
            let mut on = on;
            if ui.checkbox(&mut on, text).changed() {
                shown.ask(request);
            }
        }
    });
    let mut notches = |ui: &mut Ui, name: &str, value: f64, request: fn(f64) -> Request| {
        layout::named(ui, name, NAMES, |ui| {
            let mut wanted = value;
            let slider = Slider::new(&mut wanted, 1.0..=40.0).step_by(1.0);
            if ui.add_enabled(burst.on, slider).changed() {
                shown.ask(request(wanted - value));
            }
        });
    };
    notches(ui, "moments", burst.factor, Request::BurstFactor);
    notches(ui, "fading", burst.gamma, Request::BurstGamma);
}
