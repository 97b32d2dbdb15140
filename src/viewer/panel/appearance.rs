//! Panel of the model's appearance: the settings of the visualiser (`mjModel.vis`) and the
//! statistics on which they are based (`mjModel.stat`).

use egui::{CollapsingHeader, DragValue, Ui};

use super::{PanelContext, layout};
use crate::model::SettingMut;
use crate::viewer::link::EndpointRequest;

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 104.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let mut appearance = cx.predicted.appearance(cx.snapshot);
    let before = appearance;
    let visual = &mut appearance.visual;
    group(ui, "global", visual.global.settings());
    group(ui, "quality", visual.quality.settings());
    group(ui, "headlight", visual.headlight.settings());
    group(ui, "map", visual.map.settings());
    group(ui, "scale", visual.scale.settings());
    group(ui, "rgba", visual.rgba.settings());
    group(ui, "statistic", appearance.statistics.settings());
    // A value out of range is rejected with a notice.
    if appearance != before {
        cx.send(EndpointRequest::SetAppearance(Box::new(appearance)));
    }
}

fn group<'a>(ui: &mut Ui, name: &str, settings: impl Iterator<Item = (&'static str, SettingMut<'a>)>) {
    CollapsingHeader::new(name).show_unindented(ui, |ui| {
        for (name, setting) in settings {
            layout::labelled(ui, name, LABEL_WIDTH, |ui| show_setting(ui, setting));
        }
    });
}

fn show_setting(ui: &mut Ui, setting: SettingMut<'_>) {
    ui.spacing_mut().item_spacing.x = 3.0;
    match setting {
        SettingMut::Count(count) => drop(ui.add(DragValue::new(count).update_while_editing(false))),
        SettingMut::Number(number) => drop(ui.add(drag(number))),
        SettingMut::Double(number) => drop(ui.add(drag(number))),
        SettingMut::Switch(on) => drop(ui.checkbox(on, "")),
        SettingMut::Rgb(colour) => show_colour(ui, colour),
        SettingMut::Rgba(colour) => show_colour(ui, colour),
        SettingMut::Vector(vector) => vector.iter_mut().for_each(|part| drop(ui.add(drag(part)))),
    }
}

/// Shows the parts of a colour in narrow fields, so that all four fit into the panel.
fn show_colour(ui: &mut Ui, parts: &mut [f32]) {
    ui.spacing_mut().interact_size.x = 32.0;
    ui.spacing_mut().button_padding.x = 3.0;
    for part in parts {
        ui.add(drag(part).max_decimals(2));
    }
}

fn drag<N: egui::emath::Numeric>(number: &mut N) -> DragValue<'_> {
    let size = number.to_f64().abs();
    DragValue::new(number).speed((0.01 * size).max(1e-3)).max_decimals(3).update_while_editing(false)
}
