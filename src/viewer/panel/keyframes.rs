//! States to go to, and to keep.

use egui::{RichText, Ui};

use super::{Shown, name_of, style};
use crate::viewer::request::Request;

#[derive(Default)]
pub(super) struct KeyframesPanel {
    /// The name of the next state that is kept.
    name: String,
}

impl KeyframesPanel {
    pub fn show(&mut self, ui: &mut Ui, shown: &mut Shown<'_>) {
        let model = shown.snapshot.model.clone();
        for key in model.keyframes() {
            ui.horizontal(|ui| {
                if ui.button("Load").clicked() {
                    shown.ask(Request::LoadKey(key.id()));
                }
                ui.label(name_of(key.name(), key.index()));
            });
        }
        let captured = shown.snapshot.captured.clone();
        for key in captured.iter() {
            ui.horizontal(|ui| {
                if ui.button("Load").clicked() {
                    shown.ask(Request::LoadCaptured(key.number));
                }
                if ui.button("Copy").on_hover_text("as a <key> for the model's XML").clicked() {
                    ui.ctx().copy_text(key.xml.clone());
                }
                if ui.button("Forget").clicked() {
                    shown.ask(Request::RemoveCaptured(key.number));
                }
                ui.label(&key.name);
                ui.label(RichText::new(format!("{:.2} s", key.time)).color(style::FAINT));
            });
        }
        ui.horizontal(|ui| {
            ui.add(egui::TextEdit::singleline(&mut self.name).desired_width(130.0).hint_text("name"));
            if ui.button("Keep this state").clicked() {
                let name = std::mem::take(&mut self.name);
                shown.ask(Request::SaveKey((!name.is_empty()).then_some(name)));
            }
        });
    }
}
