//! Search for elements by name.

use egui::{Key, Label, RichText, Ui};

use super::{PanelContext, layout};
use crate::element::{Object, Transmission, Wrap};
use crate::id::{ActuatorId, BodyId, SensorId, TendonId};
use crate::model::Model;
use crate::viewer::link::EndpointRequest;

/// Maximum number of results.
const MAX_RESULTS: usize = 12;

/// Element that was found.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    kind: &'static str,
    name: String,
    /// Body of the element, or the body that it acts on or measures.
    body: Option<BodyId>,
}

/// Panel with a text field and the elements whose names contain the text. A click selects the body
/// of an element, and Enter that of the first.
#[derive(Default)]
pub(super) struct FindPanel {
    text: String,
    /// Generation of the model of the results.
    generation: u64,
    found: Vec<Found>,
    /// Number of further results.
    more: usize,
}

impl FindPanel {
    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        let width = ui.available_width();
        let field = layout::text_field(ui, &mut self.text, "name of an element", width);
        if field.changed() || self.generation != cx.snapshot.generation {
            self.generation = cx.snapshot.generation;
            self.update(&cx.snapshot.model);
        }
        if field.lost_focus()
            && ui.input(|input| input.key_pressed(Key::Enter))
            && let Some(body) = self.found.iter().find_map(|found| found.body)
        {
            cx.send(EndpointRequest::SelectBody(Some(body)));
        }
        for Found { kind, name, body } in &self.found {
            ui.horizontal(|ui| {
                match body {
                    Some(body) => {
                        if ui.selectable_label(false, name).on_hover_text("selects the body").clicked() {
                            cx.send(EndpointRequest::SelectBody(Some(*body)));
                        }
                    }
                    None => drop(ui.add(Label::new(name).selectable(false))),
                }
                ui.label(RichText::new(*kind).small().weak());
            });
        }
        if self.more > 0 {
            ui.label(RichText::new(format!("and {} more", self.more)).small().weak());
        }
    }

    fn update(&mut self, model: &Model) {
        (self.found, self.more) = (Vec::new(), 0);
        if !self.text.is_empty() {
            let mut found = find(model, &self.text);
            self.found.extend(found.by_ref().take(MAX_RESULTS));
            self.more = found.count();
        }
    }
}

/// Returns the elements whose names contain the text, in upper or lower case.
fn find(model: &Model, text: &str) -> impl Iterator<Item = Found> {
    let wanted = text.to_lowercase();
    let bodies = model.bodies().map(|body| ("body", body.name(), Some(body.id())));
    let joints = model.joints().map(|joint| ("joint", joint.name(), Some(joint.body())));
    let geoms = model.geoms().map(|geom| ("geom", geom.name(), Some(geom.body())));
    let sites = model.sites().map(|site| ("site", site.name(), Some(site.body())));
    let actuators = model.actuators().map(|actuator| ("actuator", actuator.name(), of_actuator(model, actuator.id())));
    let sensors = model.sensors().map(|sensor| ("sensor", sensor.name(), of_sensor(model, sensor.id())));
    let tendons = model.tendons().map(|tendon| ("tendon", tendon.name(), of_tendon(model, tendon.id())));
    bodies
        .chain(joints)
        .chain(geoms)
        .chain(sites)
        .chain(actuators)
        .chain(sensors)
        .chain(tendons)
        .filter(move |(_, name, _)| name.is_some_and(|name| name.to_lowercase().contains(&wanted)))
        .map(|(kind, name, body)| Found { kind, name: name.unwrap_or_default().to_owned(), body })
}

/// Returns the body that an actuator acts on.
fn of_actuator(model: &Model, actuator: ActuatorId) -> Option<BodyId> {
    Some(match model.actuator(actuator).transmission() {
        Transmission::Joint(joint) | Transmission::JointInParent(joint) | Transmission::JointOrientation(joint) => {
            model.joint(joint).body()
        }
        Transmission::SliderCrank { slider: site, .. }
        | Transmission::Site(site)
        | Transmission::SiteOrientation { site, .. } => model.site(site).body(),
        Transmission::Tendon(tendon) => return of_tendon(model, tendon),
        Transmission::Body(body) => body,
    })
}

/// Returns the body of the object of a sensor.
fn of_sensor(model: &Model, sensor: SensorId) -> Option<BodyId> {
    Some(match model.sensor(sensor).object()? {
        Object::Body(body) | Object::XBody(body) => body,
        Object::Joint(joint) => model.joint(joint).body(),
        Object::Geom(geom) => model.geom(geom).body(),
        Object::Site(site) => model.site(site).body(),
        Object::Camera(camera) => model.camera(camera).body(),
        Object::Actuator(actuator) => return of_actuator(model, actuator),
        Object::Tendon(tendon) => return of_tendon(model, tendon),
        _ => return None,
    })
}

/// Returns the first body on the path of a tendon.
fn of_tendon(model: &Model, tendon: TendonId) -> Option<BodyId> {
    model.tendon(tendon).path().find_map(|wrap| match wrap {
        Wrap::Joint { joint, .. } => Some(model.joint(joint).body()),
        Wrap::Site(site) => Some(model.site(site).body()),
        Wrap::Sphere { geom, .. } | Wrap::Cylinder { geom, .. } => Some(model.geom(geom).body()),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::{Found, find};
    use crate::{Model, sample};

    #[test]
    fn elements_are_found_by_a_part_of_their_name_in_any_case() {
        let model = sample::humanoid();
        let kinds: Vec<_> = find(&model, "Left_KNEE").map(|found| (found.kind, found.name)).collect();
        assert_eq!(kinds, [("joint", "left_knee".to_owned()), ("actuator", "left_knee".to_owned())]);
        assert!(find(&model, "no such element").next().is_none());
    }

    #[test]
    fn elements_have_the_bodies_that_they_act_on() {
        let text = r#"<mujoco>
            <worldbody>
              <body name="arm"><joint name="elbow"/><geom size="0.1"/><site name="palm"/>
                <body name="hand"><joint name="wrist"/><geom size="0.1"/><site name="tip"/></body></body>
            </worldbody>
            <tendon><spatial name="x_rope"><site site="palm"/><site site="tip"/></spatial>
              <fixed name="x_pair"><joint joint="wrist" coef="1"/></fixed></tendon>
            <actuator><motor name="x_motor" joint="wrist"/><motor name="x_jet" site="palm"/>
              <motor name="x_winch" tendon="x_pair"/></actuator>
            <sensor><gyro name="x_gyro" site="tip"/><framepos name="x_pos" objtype="body" objname="arm"/>
              <actuatorfrc name="x_force" actuator="x_motor"/><tendonpos name="x_length" tendon="x_rope"/>
              <clock name="x_clock"/></sensor>
          </mujoco>"#;
        let model = Model::from_xml_str(text).unwrap();
        let body = |found: &Found| found.body.map(|body| model.body(body).name().unwrap().to_owned());
        let found: Vec<_> = find(&model, "x_").map(|found| (found.name.clone(), body(&found))).collect();
        let expected = [
            ("x_motor", Some("hand")),
            ("x_jet", Some("arm")),
            ("x_winch", Some("hand")),
            ("x_gyro", Some("hand")),
            ("x_pos", Some("arm")),
            ("x_force", Some("hand")),
            ("x_length", Some("arm")),
            ("x_clock", None),
            ("x_rope", Some("arm")),
            ("x_pair", Some("hand")),
        ];
        assert_eq!(found, expected.map(|(name, body)| (name.to_owned(), body.map(str::to_owned))));
    }
}
