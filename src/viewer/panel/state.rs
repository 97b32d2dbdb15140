//! Panels of the state: selected body, controls, joints and keyframes.

use std::f64::consts::PI;

use egui::{DragValue, Grid, RichText, Ui};

use super::names::NameList;
use super::{PanelContext, display_name, layout, style};
use crate::enums::JointType;
use crate::id::JointId;
use crate::model::Model;
use crate::viewer::link::EndpointRequest;

pub(super) fn show_selection(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let Some(selected) = cx.snapshot.selected else {
        ui.label(RichText::new("double-click on a body to select it").weak());
        return;
    };
    let model = cx.snapshot.model.clone();
    let body = model.body(selected.body);
    ui.horizontal(|ui| {
        ui.strong(display_name(body.name(), body.index()));
        if ui.button("Unselect").clicked() {
            cx.send(EndpointRequest::SelectBody(None));
        }
        if ui.button("Parent").clicked() {
            cx.send(EndpointRequest::SelectParent);
        }
    });
    let three = |numbers: &[f64]| format!("{:7.2} {:7.2} {:7.2}", numbers[0], numbers[1], numbers[2]);
    Grid::new("selection").num_columns(2).min_col_width(70.0).spacing([6.0, 2.0]).show(ui, |ui| {
        let mut line = |name: &str, value: String, highlighted: bool| {
            ui.label(RichText::new(name).weak());
            let value = RichText::new(value).monospace();
            ui.label(if highlighted { value.color(style::warning(ui)) } else { value });
            ui.end_row();
        };
        if let Some(geom) = selected.geom {
            line("geom", display_name(model.geom(geom).name(), geom.index()), false);
        }
        line("point, m", three(&selected.localpos), false);
        line("force, N", three(&selected.force[..3]), selected.active);
        line("torque, N m", three(&selected.force[3..]), selected.active);
    });
}

/// Panel of the controls.
#[derive(Default)]
pub(super) struct ControlsPanel {
    names: NameList,
}

impl ControlsPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        if ui.button("Set all to zero").clicked() {
            cx.send(EndpointRequest::ClearControls);
        }
        let (model, snapshot) = (cx.snapshot.model.clone(), cx.snapshot);
        self.names.update(snapshot.generation, || control_names(&model));
        self.names.show_filter(ui);
        let width = layout::name_width(ui);
        let controls =
            model.actuators().flat_map(|actuator| actuator.controls().map(move |control| (actuator, control)));
        for (index, ((actuator, control), &ctrl)) in controls.zip(&snapshot.ctrl).enumerate() {
            let Some(name) = self.names.get(index) else { continue };
            let is_limited = model.actuator_ctrllimited()[control] != 0;
            let [low, high] = if is_limited { model.actuator_ctrlrange()[control] } else { [-1.0, 1.0] };
            let number = control - actuator.controls().start;
            layout::named(ui, name, width, |ui| {
                let mut value = cx.predicted.control(snapshot, actuator.id(), number).unwrap_or(ctrl);
                let range = low.min(value)..=high.max(value);
                let slider = ui.add(layout::slider(&mut value, range).fixed_decimals(2));
                #[cfg(feature = "_test-hooks")]
                crate::viewer::test_hooks::add_slider(&slider, ui);
                if slider.changed() {
                    cx.send(EndpointRequest::SetControl(actuator.id(), number, value));
                }
            });
        }
    }
}

/// Returns a name for each control.
fn control_names(model: &Model) -> Vec<String> {
    let names = model.actuators().flat_map(|actuator| {
        let name = display_name(actuator.name(), actuator.index());
        let count = actuator.controls().len();
        (0..count).map(move |number| if count > 1 { format!("{name} [{number}]") } else { name.clone() })
    });
    names.collect()
}

/// Panel of the positions of the joints.
#[derive(Default)]
pub(super) struct JointsPanel {
    /// Indices of the listed joints, and their names.
    listed: Vec<usize>,
    names: NameList,
}

impl JointsPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        let (model, snapshot, editable) = (cx.snapshot.model.clone(), cx.snapshot, cx.is_editable());
        if !editable {
            ui.label(RichText::new("pause to edit").small().weak());
        }
        self.names.update(snapshot.generation, || {
            self.listed = listed_joints(&model);
            let joints = self.listed.iter().filter_map(|&joint| model.joint(joint).ok());
            joints.map(|joint| display_name(joint.name(), joint.index())).collect()
        });
        self.names.show_filter(ui);
        let hidden = model.njnt() - self.listed.len();
        if hidden > 0 {
            ui.label(RichText::new(format!("without {hidden} joints of flexes")).small().weak());
        }
        let width = layout::name_width(ui);
        for (number, joint) in self.listed.iter().enumerate() {
            let (Some(name), Ok(joint)) = (self.names.get(number), model.joint(*joint)) else { continue };
            // Only a snapshot whose values and model do not match has no such element.
            let Some(qpos) = snapshot.qpos.get(joint.qpos_range()) else { return };
            let unlimited = match joint.joint_type() {
                JointType::Hinge => PI,
                JointType::Slide => 1.0,
                JointType::Free | JointType::Ball => {
                    show_elements(ui, cx, name, joint.id(), qpos, editable);
                    continue;
                }
            };
            let [low, high] = if joint.limited() { *joint.range() } else { [-unlimited, unlimited] };
            layout::named(ui, name, width, |ui| {
                let mut value = cx.predicted.position(snapshot, joint.id(), 0).unwrap_or(qpos[0]);
                let range = low.min(value)..=high.max(value);
                if ui.add_enabled(editable, layout::slider(&mut value, range).fixed_decimals(3)).changed() {
                    cx.send(EndpointRequest::SetPosition(joint.id(), 0, value));
                }
            });
        }
    }
}

/// Returns the joints of a list: all except the joints of the vertices of flexes, which have no
/// names and can be thousands.
fn listed_joints(model: &Model) -> Vec<usize> {
    let mut is_vertex = vec![false; model.nbody()];
    #[cfg(engine_since = "3.0.0")]
    for &body in model.flex_vertbodyid() {
        is_vertex[body.max(0) as usize] = true;
    }
    // Vertices can also be on the world, and on bodies with other joints, which have names.
    is_vertex[0] = false;
    let joints = model.joints().filter(|joint| joint.name().is_some() || !is_vertex[joint.body().index()]);
    joints.map(|joint| joint.index()).collect()
}

/// Shows the elements of a position and a quaternion.
fn show_elements(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    [short, full]: [&str; 2],
    joint: JointId,
    qpos: &[f64],
    editable: bool,
) {
    let label = ui.label(short);
    if short != full {
        label.on_hover_text(full);
    }
    let split = if qpos.len() == 7 { 3 } else { 0 };
    for (what, part) in [("position", 0..split), ("rotation", split..qpos.len())] {
        if part.is_empty() {
            continue;
        }
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.label(RichText::new(what).small().weak());
            for index in part {
                let mut value = cx.predicted.position(cx.snapshot, joint, index).unwrap_or(qpos[index]);
                let drag = DragValue::new(&mut value).speed(0.005).fixed_decimals(2);
                if ui.add_enabled(editable, drag).changed() {
                    cx.send(EndpointRequest::SetPosition(joint, index, value));
                }
            }
        });
    }
}

/// Panel of the model's keyframes and the captured keyframes.
#[derive(Default)]
pub(super) struct KeyframesPanel {
    /// Name of the next captured keyframe.
    name: String,
}

impl KeyframesPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        let model = cx.snapshot.model.clone();
        for key in model.keyframes() {
            ui.horizontal(|ui| {
                if ui.button("Load").clicked() {
                    cx.send(EndpointRequest::LoadKey(key.id()));
                }
                ui.label(display_name(key.name(), key.index()));
            });
        }
        let captured = cx.snapshot.captured.clone();
        for key in captured.iter() {
            ui.horizontal(|ui| {
                if ui.button("Load").clicked() {
                    cx.send(EndpointRequest::LoadCaptured(key.number));
                }
                if ui.button("Copy").on_hover_text("copies a <key> element for the model's XML").clicked() {
                    ui.ctx().copy_text(key.xml.clone());
                }
                if ui.button("Delete").clicked() {
                    cx.send(EndpointRequest::RemoveCaptured(key.number));
                }
                ui.label(&key.name);
                ui.label(RichText::new(format!("{:.2} s", key.time)).weak());
            });
        }
        ui.horizontal(|ui| {
            let width = ui.available_width() - 96.0;
            layout::text_field(ui, &mut self.name, "name", width);
            if ui.button("Capture state").clicked() {
                let name = std::mem::take(&mut self.name);
                cx.send(EndpointRequest::SaveKey((!name.is_empty()).then_some(name)));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_of_flexes_are_not_listed() {
        let cloth = r#"<flexcomp name="cloth" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" radius=".01"/>"#;
        let text = |flex: &str| {
            format!(
                r#"<mujoco><worldbody>{flex}<body><joint/><joint name="x" type="slide"/><geom size=".1"/></body>
                </worldbody></mujoco>"#
            )
        };
        assert_eq!(listed_joints(&Model::from_xml_str(&text("")).unwrap()), [0, 1]);
        if cfg!(engine_since = "3.0.0") {
            let model = Model::from_xml_str(&text(cloth)).unwrap();
            assert_eq!((model.njnt(), listed_joints(&model)), (29, vec![27, 28]));
        }
    }
}
