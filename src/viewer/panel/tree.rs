//! Tree of the bodies with their joints, geoms and sites, and their present values.

use egui::collapsing_header::CollapsingState;
use egui::{Label, RichText, Sense, Ui};

use super::{PanelContext, display_name, layout};
use crate::enums::JointType;
use crate::id::{BodyId, SiteId};
use crate::model::Model;
use crate::viewer::link::{EndpointRequest, Snapshot};

/// Maximum number of children of a body, and of elements of each kind, that are shown.
const MAX_SHOWN: usize = 100;

/// Panel of the model's tree. A click on a body selects it.
#[derive(Default)]
pub(super) struct TreePanel {
    /// Generation of the model of the tree; `None` before it is shown.
    generation: Option<u64>,
    /// Children and sites of each body.
    children: Vec<Vec<BodyId>>,
    sites: Vec<Vec<SiteId>>,
}

impl TreePanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        let model = cx.snapshot.model.clone();
        if self.generation != Some(cx.snapshot.generation) {
            self.generation = Some(cx.snapshot.generation);
            self.children = vec![Vec::new(); model.nbody()];
            self.sites = vec![Vec::new(); model.nbody()];
            for body in model.bodies().skip(1) {
                self.children[body.parent().index()].push(body.id());
            }
            for site in model.sites() {
                self.sites[site.body().index()].push(site.id());
            }
        }
        ui.spacing_mut().indent = 12.0;
        if let Some(world) = model.bodies().next() {
            self.show_body(ui, cx, &model, world.id());
        }
    }

    fn show_body(&self, ui: &mut Ui, cx: &mut PanelContext<'_>, model: &Model, id: BodyId) {
        let (body, index) = (model.body(id), id.index());
        let state = CollapsingState::load_with_default_open(ui.ctx(), ui.scope_id().with(index), index == 0);
        let header = state.show_header(ui, |ui| {
            let is_selected = cx.snapshot.selected.is_some_and(|selected| selected.body == id);
            let position = vector(cx.snapshot.xpos.get(index).filter(|_| index > 0));
            if row(ui, &display_name(body.name(), index), "", &position, is_selected, "selects the body") {
                cx.send(EndpointRequest::SelectBody(Some(id)));
            }
        });
        header.body(|ui| {
            for joint in body.joints().take(MAX_SHOWN) {
                let joint = model.joint(joint);
                let (kind, value) =
                    joint_value(cx.snapshot, joint.joint_type(), joint.qpos_range().start, joint.dofs().start);
                row(ui, &display_name(joint.name(), joint.index()), kind, &value, false, "");
            }
            for geom in body.geoms().take(MAX_SHOWN) {
                let position = vector(cx.snapshot.geom_xpos.get(geom.index()));
                row(ui, &display_name(model.geom(geom).name(), geom.index()), "geom", &position, false, "");
            }
            for site in self.sites[index].iter().take(MAX_SHOWN) {
                let position = vector(cx.snapshot.site_xpos.get(site.index()));
                row(ui, &display_name(model.site(*site).name(), site.index()), "site", &position, false, "");
            }
            for child in self.children[index].iter().take(MAX_SHOWN) {
                self.show_body(ui, cx, model, *child);
            }
            let lists = [body.joints().len(), body.geoms().len(), self.sites[index].len(), self.children[index].len()];
            let hidden: usize = lists.into_iter().map(|len| len.saturating_sub(MAX_SHOWN)).sum();
            if hidden > 0 {
                ui.label(RichText::new(format!("and {hidden} more")).small().weak());
            }
        });
    }
}

/// Shows an element and its value. Returns `true` if the user clicks on an element with a tooltip.
fn row(ui: &mut Ui, name: &str, kind: &str, value: &str, is_selected: bool, tooltip: &str) -> bool {
    ui.horizontal(|ui| {
        let width = (ui.available_width() - VALUE_WIDTH).max(60.0);
        let shown = layout::fit(ui, name, width);
        let text = RichText::new(&*shown);
        let clicked = if tooltip.is_empty() {
            let label = ui.add(Label::new(text).selectable(false).sense(Sense::hover()));
            if shown != name {
                label.on_hover_text(name);
            }
            false
        } else {
            ui.selectable_label(is_selected, text).on_hover_text(format!("{name}: {tooltip}")).clicked()
        };
        if !kind.is_empty() {
            ui.label(RichText::new(kind).small().weak());
        }
        ui.label(RichText::new(value).small().monospace());
        clicked
    })
    .inner
}

/// Width of a kind and a value, points.
const VALUE_WIDTH: f32 = 130.0;

/// Returns a position, m.
fn vector(position: Option<&[f64; 3]>) -> String {
    position.map_or_else(String::new, |[x, y, z]| format!("{x:.2} {y:.2} {z:.2}"))
}

/// Returns the kind of a joint, and its position and velocity.
fn joint_value(snapshot: &Snapshot, joint: JointType, qpos: usize, qvel: usize) -> (&'static str, String) {
    let numbers = |unit: &str| {
        let value = |values: &[f64], index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        let (position, velocity) = (value(&snapshot.qpos, qpos), value(&snapshot.qvel, qvel));
        format!("{position:.3} {unit} {velocity:.2} {unit}/s")
    };
    match joint {
        JointType::Hinge => ("hinge", numbers("rad")),
        JointType::Slide => ("slide", numbers("m")),
        JointType::Ball => ("ball", String::new()),
        JointType::Free => ("free", String::new()),
    }
}
