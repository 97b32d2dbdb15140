//! A slider for each actuator.

use egui::{Slider, Ui};

use super::{Shown, layout, name_of};
use crate::viewer::request::Request;

/// Width of the names.
const NAMES: f32 = 92.0;

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
            if ui.add(Slider::new(&mut value, range).fixed_decimals(3)).changed() {
                shown.ask(Request::SetControl(actuator.id(), value));
            }
        });
    }
}
