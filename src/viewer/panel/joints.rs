//! A slider for each joint that has one number, and numbers for those that have more.

use std::f64::consts::PI;

use egui::{DragValue, RichText, Slider, Ui};

use super::{Shown, layout, name_of, style};
use crate::enums::JointType;
use crate::viewer::request::Request;

/// Width of the names.
const NAMES: f32 = 88.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let (model, snapshot, editable) = (shown.snapshot.model.clone(), shown.snapshot, shown.is_editable());
    if !editable {
        ui.label(RichText::new("pause to set them").small().color(style::FAINT));
    }
    for joint in model.joints() {
        let name = name_of(joint.name(), joint.index());
        // A snapshot of the model before has other positions.
        let Some(qpos) = snapshot.qpos.get(joint.qpos_range()) else { return };
        let unlimited = match joint.joint_type() {
            JointType::Hinge => PI,
            JointType::Slide => 1.0,
            JointType::Free | JointType::Ball => {
                many(ui, shown, &name, joint.id(), qpos, editable);
                continue;
            }
        };
        let [low, high] = if joint.limited() { *joint.range() } else { [-unlimited, unlimited] };
        layout::named(ui, &name, NAMES, |ui| {
            let mut value = qpos[0];
            let range = low.min(value)..=high.max(value);
            if ui.add_enabled(editable, Slider::new(&mut value, range).fixed_decimals(3)).changed() {
                shown.ask(Request::SetPosition(joint.id(), 0, value));
            }
        });
    }
}

/// Positions and quaternions.
fn many(ui: &mut Ui, shown: &mut Shown<'_>, name: &str, joint: crate::JointId, qpos: &[f64], editable: bool) {
    ui.label(name);
    let split = if qpos.len() == 7 { 3 } else { 0 };
    for (what, part) in [("position", 0..split), ("rotation", split..qpos.len())] {
        if part.is_empty() {
            continue;
        }
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.label(RichText::new(what).small().color(style::FAINT));
            for index in part {
                let mut value = qpos[index];
                let drag = DragValue::new(&mut value).speed(0.005).fixed_decimals(2);
                if ui.add_enabled(editable, drag).changed() {
                    shown.ask(Request::SetPosition(joint, index, value));
                }
            }
        });
    }
}
