//! Search for elements by name.

use egui::{RichText, TextEdit, Ui};

use super::PanelContext;
use crate::id::BodyId;
use crate::model::Model;
use crate::viewer::link::EndpointRequest;

/// Maximum number of results.
const MAX_RESULTS: usize = 12;

/// Panel with a text field and the elements whose names contain the text. A click selects the body
/// of an element.
#[derive(Default)]
pub(super) struct FindPanel {
    text: String,
}

impl FindPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        ui.add(TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY).hint_text("name of an element"));
        if self.text.is_empty() {
            return;
        }
        let model = cx.snapshot.model.clone();
        let mut found = find(&model, &self.text);
        for (kind, name, body) in found.by_ref().take(MAX_RESULTS) {
            ui.horizontal(|ui| {
                if ui.selectable_label(false, name).on_hover_text("selects the body").clicked() {
                    cx.send(EndpointRequest::SelectBody(Some(body)));
                }
                ui.label(RichText::new(kind).small().weak());
            });
        }
        let more = found.count();
        if more > 0 {
            ui.label(RichText::new(format!("and {more} more")).small().weak());
        }
    }
}

/// Returns the kind, the name and the body of each element whose name contains the text, in upper
/// or lower case.
fn find<'m>(model: &'m Model, text: &str) -> impl Iterator<Item = (&'static str, &'m str, BodyId)> {
    let wanted = text.to_lowercase();
    let bodies = model.bodies().map(|body| ("body", body.name(), body.id()));
    let joints = model.joints().map(|joint| ("joint", joint.name(), joint.body()));
    let geoms = model.geoms().map(|geom| ("geom", geom.name(), geom.body()));
    let sites = model.sites().map(|site| ("site", site.name(), site.body()));
    bodies
        .chain(joints)
        .chain(geoms)
        .chain(sites)
        .filter_map(|(kind, name, body)| Some((kind, name?, body)))
        .filter(move |(_, name, _)| name.to_lowercase().contains(&wanted))
}

#[cfg(test)]
mod tests {
    use super::find;
    use crate::sample;

    #[test]
    fn elements_are_found_by_a_part_of_their_name_in_any_case() {
        let model = sample::humanoid();
        let found: Vec<_> = find(&model, "Left_KNEE").collect();
        let knee = model.joint("left_knee").unwrap();
        assert_eq!(found, [("joint", "left_knee", knee.body())]);
        assert!(find(&model, "no such element").next().is_none());
    }
}
