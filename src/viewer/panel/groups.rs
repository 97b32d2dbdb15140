//! Which groups are shown.

use egui::{Grid, Ui};

use super::Shown;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let options = &mut shown.view.options;
    Grid::new("groups").num_columns(7).spacing([4.0, 4.0]).show(ui, |ui| {
        for (name, groups) in [
            ("geoms", &mut options.geomgroup),
            ("sites", &mut options.sitegroup),
            ("joints", &mut options.jointgroup),
            ("tendons", &mut options.tendongroup),
            ("actuators", &mut options.actuatorgroup),
            ("skins", &mut options.skingroup),
        ] {
            ui.label(name);
            for (number, on) in groups.iter_mut().enumerate() {
                ui.toggle_value(on, format!(" {number} "));
            }
            ui.end_row();
        }
    });
}
