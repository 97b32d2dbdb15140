//! Sliders of the parameters of a controller or a program.

use egui::Ui;

use super::{PanelContext, layout};
use crate::viewer::link::EndpointRequest;

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 88.0;
/// Smallest ratio of the ends of the range of a logarithmic slider.
const LOGARITHMIC: f64 = 100.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let snapshot = cx.snapshot;
    if snapshot.parameters.is_empty() {
        return;
    }
    layout::section(ui, "Parameters", true, |ui| {
        for parameter in &snapshot.parameters {
            layout::labelled(ui, &parameter.name, LABEL_WIDTH, |ui| {
                let [low, high] = parameter.range;
                let mut value = cx.predicted.parameter(snapshot, &parameter.name).unwrap_or(parameter.value);
                let is_logarithmic = low > 0.0 && high >= LOGARITHMIC * low;
                let slider = layout::slider(&mut value, low..=high).logarithmic(is_logarithmic).max_decimals(5);
                let slider = ui.add(slider);
                #[cfg(feature = "_test-hooks")]
                crate::viewer::test_hooks::add_slider(&slider, ui);
                if slider.changed() {
                    cx.send(EndpointRequest::SetParameter(parameter.name.clone(), value));
                }
            });
        }
    });
}
