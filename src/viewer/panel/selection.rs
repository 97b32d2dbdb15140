//! The selected body, and what pulls it.

use egui::{Grid, RichText, Ui};

use super::{Shown, name_of, style};
use crate::viewer::request::Request;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let Some(selected) = shown.snapshot.selected else {
        ui.label(RichText::new("double-click on a body selects it").color(style::FAINT));
        return;
    };
    let model = shown.snapshot.model.clone();
    let body = model.body(selected.body);
    ui.horizontal(|ui| {
        ui.strong(name_of(body.name(), body.index()));
        if ui.button("Unselect").clicked() {
            shown.ask(Request::SelectBody(None));
        }
        if ui.button("Parent").clicked() {
            shown.ask(Request::SelectParent);
        }
    });
    let three = |numbers: &[f64]| format!("{:7.2} {:7.2} {:7.2}", numbers[0], numbers[1], numbers[2]);
    Grid::new("selection").num_columns(2).min_col_width(70.0).spacing([6.0, 2.0]).show(ui, |ui| {
        let mut line = |name: &str, value: String, on: bool| {
            ui.label(RichText::new(name).color(style::FAINT));
            let value = RichText::new(value).monospace();
            ui.label(if on { value.color(style::WARNING) } else { value });
            ui.end_row();
        };
        if let Some(geom) = selected.geom {
            line("geom", name_of(model.geom(geom).name(), geom.index()), false);
        }
        line("point, m", three(&selected.localpos), false);
        line("force, N", three(&selected.force[..3]), selected.active);
        line("torque, N m", three(&selected.force[3..]), selected.active);
    });
}
