//! What is shown: labels, frames and the parts of a scene.

use egui::{ComboBox, Ui};

use super::{Shown, layout};
use crate::scene::{FrameMode, LabelMode};
use crate::viewer::input::{Action, BINDINGS};

/// Width of the names.
const NAMES: f32 = 64.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let options = &mut shown.view.options;
    layout::named(ui, "label", NAMES, |ui| {
        let every = (0..).map_while(LabelMode::from_raw);
        choice(ui, "label", &mut options.label, every);
    });
    layout::named(ui, "frame", NAMES, |ui| {
        let every = (0..).map_while(FrameMode::from_raw);
        choice(ui, "frame", &mut options.frame, every);
    });
    let flags = BINDINGS.iter().filter_map(|binding| match binding.action {
        Action::Visual(flag) => Some((flag, binding)),
        _ => None,
    });
    layout::pairs(ui, flags, |ui, (flag, binding)| {
        let mut on = options.flags.contains(flag);
        let text = sentence(&flag.iter_names().map(|(name, _)| name).collect::<String>());
        if ui.checkbox(&mut on, text).on_hover_text(format!("{} ({})", binding.help, binding.key)).changed() {
            options.flags.set(flag, on);
        }
    });
}

/// One of several values, by their names.
pub(super) fn choice<T: Copy + PartialEq + std::fmt::Debug>(
    ui: &mut Ui,
    id: &str,
    value: &mut T,
    every: impl IntoIterator<Item = T>,
) -> bool {
    let before = *value;
    ComboBox::from_id_salt(id).width(140.0).selected_text(format!("{value:?}")).show_ui(ui, |ui| {
        for one in every {
            ui.selectable_value(value, one, format!("{one:?}"));
        }
    });
    *value != before
}

/// The engine's spelling of a flag, as words.
pub(super) fn sentence(name: &str) -> String {
    let known = [
        ("CONVEXHULL", "convex hull"),
        ("RANGEFINDER", "rangefinder"),
        ("SCLINERTIA", "scaled inertia"),
        ("PERTFORCE", "perturb force"),
        ("PERTOBJ", "perturb object"),
        ("CONTACTPOINT", "contact point"),
        ("CONTACTFORCE", "contact force"),
        ("CONTACTSPLIT", "contact split"),
        ("AUTOCONNECT", "auto connect"),
        ("COM", "centre of mass"),
        ("SELECT", "select point"),
        ("STATIC", "static body"),
        ("IDCOLOR", "id colour"),
    ];
    known
        .iter()
        .find(|(spelling, _)| *spelling == name)
        .map_or_else(|| name.to_lowercase().replace('_', " "), |(_, words)| (*words).to_owned())
}
