//! Panel of the watched values.

use egui::{Key, Label, RichText, Ui};

use super::plots::PlotPanel;
use super::{PanelContext, layout, style};
use crate::viewer::endpoint::Watch;
use crate::viewer::link::EndpointRequest;

/// Maximum number of watched values.
const MAX_WATCHES: usize = 16;

/// Panel of the watched values.
#[derive(Default)]
pub(super) struct WatchPanel {
    watched: Vec<Watch>,
    /// Text of the input field.
    text: String,
    /// Message of the last parse error.
    problem: String,
}

impl WatchPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>, plots: &mut PlotPanel) {
        let before = self.watched.len();
        ui.horizontal(|ui| {
            let width = ui.available_width() - 58.0;
            let field = layout::text_field(ui, &mut self.text, "qpos[2] or joint knee", width);
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            field.on_hover_text(
                "a field of the data and an index or a name: qpos[2], qvel knee, xpos torso[2]; \
                 or a kind and a name: joint, actuator, sensor, tendon, body, geom, site, camera",
            );
            if ui.button("Watch").clicked() || entered {
                self.add(cx);
            }
        });
        if !self.problem.is_empty() {
            ui.add(Label::new(RichText::new(&self.problem).color(style::warning(ui))).wrap());
        }
        let mut removed = None;
        for (index, watch) in self.watched.iter().enumerate() {
            ui.horizontal(|ui| {
                if ui.small_button("×").on_hover_text("removes this value").clicked() {
                    removed = Some(index);
                }
                ui.label(watch.name());
                let current = cx.snapshot.signals.watched.iter().find(|other| other.watch.name() == watch.name());
                let value = current.map(|current| current.signal.value).filter(|value| !value.is_nan());
                let value = value.map_or_else(|| "none".to_owned(), |value| format!("{value:.6}"));
                ui.label(RichText::new(value).monospace());
            });
        }
        if let Some(index) = removed {
            self.watched.remove(index);
        }
        if self.watched.len() != before {
            cx.send(EndpointRequest::Watch(self.watched.clone()));
        }
        plots.show_watched(ui);
    }

    /// Adds the values that the text selects.
    fn add(&mut self, cx: &PanelContext<'_>) {
        match Watch::parse(&self.text, &cx.snapshot.model) {
            Ok(watches) => {
                let new = watches.into_iter().filter(|watch| !self.watched.contains(watch)).collect::<Vec<_>>();
                if self.watched.len() + new.len() > MAX_WATCHES {
                    self.problem = format!("{MAX_WATCHES} values can be watched at most");
                    return;
                }
                self.watched.extend(new);
                self.text.clear();
                self.problem.clear();
            }
            Err(error) => self.problem = error.to_string(),
        }
    }
}
