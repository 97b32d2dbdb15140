//! Which groups are shown.

use egui::Ui;

use super::{Shown, layout};

/// Width of the names.
const NAMES: f32 = 72.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let options = &mut shown.view.options;
    for (name, groups) in [
        ("geoms", &mut options.geomgroup),
        ("sites", &mut options.sitegroup),
        ("joints", &mut options.jointgroup),
        ("tendons", &mut options.tendongroup),
        ("actuators", &mut options.actuatorgroup),
        ("skins", &mut options.skingroup),
    ] {
        layout::named(ui, name, NAMES, |ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            for (number, on) in groups.iter_mut().enumerate() {
                ui.toggle_value(on, number.to_string());
            }
        });
    }
}
