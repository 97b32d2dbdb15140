//! Numbers by their names.

use egui::{RichText, TextEdit, Ui};

use super::{Shown, plots, style};
use crate::viewer::plot::Curve;
use crate::viewer::request::Request;
use crate::viewer::watch::Watch;

/// How many can be watched.
const MOST: usize = 16;

#[derive(Default)]
pub(super) struct WatchPanel {
    watched: Vec<Watch>,
    /// What is being typed.
    text: String,
    /// What is wrong with it.
    problem: String,
}

impl WatchPanel {
    pub fn watched(&self) -> &[Watch] {
        &self.watched
    }

    pub fn show(&mut self, ui: &mut Ui, shown: &mut Shown<'_>, curves: &[Curve]) {
        let mut changed = false;
        ui.horizontal(|ui| {
            let edit = TextEdit::singleline(&mut self.text).desired_width(150.0).hint_text("qpos[2]");
            let entered = ui.add(edit).lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if (ui.button("Watch").clicked() || entered) && self.watched.len() < MOST {
                match self.text.parse::<Watch>() {
                    Ok(watch) => {
                        if !self.watched.contains(&watch) {
                            self.watched.push(watch);
                            changed = true;
                        }
                        self.text.clear();
                        self.problem.clear();
                    }
                    Err(error) => self.problem = error.to_string(),
                }
            }
        });
        if !self.problem.is_empty() {
            ui.add(egui::Label::new(RichText::new(&self.problem).color(style::WARNING)).wrap());
        }
        let mut forgotten = None;
        for (index, watch) in self.watched.iter().enumerate() {
            ui.horizontal(|ui| {
                if ui.small_button("x").on_hover_text("watch it no longer").clicked() {
                    forgotten = Some(index);
                }
                ui.label(watch.to_string());
                let value = shown.snapshot.watched.get(index).copied().unwrap_or(f64::NAN);
                let value = if value.is_nan() { "none".to_owned() } else { format!("{value:.6}") };
                ui.label(RichText::new(value).monospace());
            });
        }
        if let Some(index) = forgotten {
            self.watched.remove(index);
            changed = true;
        }
        if changed {
            shown.ask(Request::Watch(self.watched.clone()));
        }
        if !self.watched.is_empty() {
            plots::plot(ui, "watched", "", curves, plots::HEIGHT);
        }
    }
}
