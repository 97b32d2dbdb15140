//! A slider for each actuator.

use egui::{Slider, Ui};

use super::{Shown, layout, name_of};
use crate::viewer::probe;
use crate::viewer::request::Request;

/// Width of the names.
const NAMES: f32 = 88.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    if ui.button("Set all to zero").clicked() {
        shown.ask(Request::ClearControls);
    }
    let (model, snapshot) = (shown.snapshot.model.clone(), shown.snapshot);
    for (actuator, &ctrl) in model.actuators().zip(&snapshot.ctrl) {
        let [low, high] = if actuator.ctrllimited() { *actuator.ctrlrange() } else { [-1.0, 1.0] };
        layout::named(ui, &name_of(actuator.name(), actuator.index()), NAMES, |ui| {
            let mut value = ctrl;
            let range = low.min(ctrl)..=high.max(ctrl);
            let slider = ui.add(Slider::new(&mut value, range).fixed_decimals(2));
            // The rail is at the left, the number at the right.
            let rail = slider.rect.left_center() + egui::vec2(ui.spacing().slider_width / 2.0, 0.0);
            probe::note_slider(rail, slider.rect.right_center() - egui::vec2(10.0, 0.0));
            if slider.changed() {
                shown.ask(Request::SetControl(actuator.id(), value));
            }
        });
    }
}
