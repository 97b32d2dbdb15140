//! Panels of the physics options and the equality constraints.

use egui::{DragValue, Ui};

use super::{PanelContext, display_name, layout, visual};
use crate::element::{EqualityObjects, View};
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::id::{BodyId, JointId, SiteId, TendonId};
use crate::kind;
use crate::model::{DisableFlags, EnableFlags, Model};
use crate::viewer::link::EndpointRequest;

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 104.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let mut options = cx.predicted.options(cx.snapshot);
    let before = options;

    choice(ui, "integrator", &mut options.integrator, Integrator::from_raw);
    choice(ui, "collision", &mut options.collision, Collision::from_raw);
    choice(ui, "cone", &mut options.cone, Cone::from_raw);
    choice(ui, "jacobian", &mut options.jacobian, JacobianStorage::from_raw);
    choice(ui, "solver", &mut options.solver, Solver::from_raw);

    number(ui, "timestep, s", &mut options.timestep, 1e-5, 1e-5);
    count(ui, "iterations", &mut options.iterations);
    number(ui, "tolerance", &mut options.tolerance, 1e-9, 0.0);
    count(ui, "noslip iterations", &mut options.noslip_iterations);
    number(ui, "noslip tolerance", &mut options.noslip_tolerance, 1e-9, 0.0);
    count(ui, "mpr iterations", &mut options.mpr_iterations);
    number(ui, "mpr tolerance", &mut options.mpr_tolerance, 1e-9, 0.0);
    number(ui, "impratio", &mut options.impratio, 0.01, 1e-3);
    number(ui, "density, kg/m³", &mut options.density, 0.1, 0.0);
    number(ui, "viscosity, Pa s", &mut options.viscosity, 1e-4, 0.0);
    vector(ui, "gravity, m/s²", &mut options.gravity);
    vector(ui, "wind, m/s", &mut options.wind);
    vector(ui, "magnetic", &mut options.magnetic);

    ui.strong("Enabled by default");
    let mut disable = options.disable;
    let present = DisableFlags::all().iter_names().filter(|(_, flag)| flag.is_present());
    toggles(ui, present, |flag| !options.disable.contains(flag), |flag| disable.toggle(flag));
    options.disable = disable;
    ui.strong("Optional");
    let mut enable = options.enable;
    let present = EnableFlags::all().iter_names().filter(|(_, flag)| flag.is_present());
    toggles(ui, present, |flag| options.enable.contains(flag), |flag| enable.toggle(flag));
    options.enable = enable;

    if options != before {
        cx.send(EndpointRequest::SetOptions(Box::new(options)));
    }
}

fn choice<T: Copy + PartialEq + std::fmt::Debug>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    from_raw: fn(i32) -> Option<T>,
) {
    layout::labelled(ui, name, LABEL_WIDTH, |ui| visual::choice(ui, name, value, (0..).map_while(from_raw)));
}

fn number(ui: &mut Ui, name: &str, value: &mut f64, speed: f64, min: f64) {
    layout::labelled(ui, name, LABEL_WIDTH, |ui| {
        let text =
            |value: f64, _| if value != 0.0 && value.abs() < 1e-4 { format!("{value:e}") } else { format!("{value}") };
        ui.add(
            DragValue::new(value).speed(speed).range(min..=f64::MAX).custom_formatter(text).update_while_editing(false),
        );
    });
}

fn count(ui: &mut Ui, name: &str, value: &mut usize) {
    layout::labelled(ui, name, LABEL_WIDTH, |ui| {
        ui.add(DragValue::new(value).range(0..=100_000).update_while_editing(false))
    });
}

fn vector(ui: &mut Ui, name: &str, values: &mut [f64; 3]) {
    layout::labelled(ui, name, LABEL_WIDTH, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for value in values {
            ui.add(DragValue::new(value).speed(0.01).max_decimals(2).update_while_editing(false));
        }
    });
}

fn toggles<F: Copy>(
    ui: &mut Ui,
    flags: impl Iterator<Item = (&'static str, F)>,
    is_on: impl Fn(F) -> bool,
    mut toggle: impl FnMut(F),
) {
    layout::two_columns(ui, flags, |ui, (name, flag)| {
        let mut on = is_on(flag);
        if layout::checkbox(ui, &mut on, &visual::words(name)).changed() {
            toggle(flag);
        }
    });
}

pub(super) fn show_equalities(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let model = cx.snapshot.model.clone();
    for equality in model.equalities() {
        let mut active = cx.predicted.equality(cx.snapshot, equality.id()).unwrap_or_else(|| equality.active());
        let text = format!("{} ({:?})", equality_name(&model, &equality), equality.equality_type());
        if layout::checkbox(ui, &mut active, &text).changed() {
            cx.send(EndpointRequest::SetEquality(equality.id(), active));
        }
    }
}

/// Returns the name of a constraint, or the names of the elements that it couples.
fn equality_name(model: &Model, equality: &View<'_, Model, kind::Equality>) -> String {
    if let Some(name) = equality.name() {
        return name.to_owned();
    }
    let joint = |id: JointId| display_name(model.joint(id).name(), id.index());
    let tendon = |id: TendonId| display_name(model.tendon(id).name(), id.index());
    let body = |id: BodyId| display_name(model.body(id).name(), id.index());
    let site = |id: SiteId| display_name(model.site(id).name(), id.index());
    let (one, other) = match equality.objects() {
        EqualityObjects::Bodies(one, other) => (body(one), Some(body(other))),
        EqualityObjects::Sites(one, other) => (site(one), Some(site(other))),
        EqualityObjects::Joints(one, other) => (joint(one), other.map(joint)),
        EqualityObjects::Tendons(one, other) => (tendon(one), other.map(tendon)),
        EqualityObjects::Flex(flex) => (format!("flex {flex}"), None),
    };
    other.map_or(one.clone(), |other| format!("{one}, {other}"))
}

#[cfg(test)]
mod tests {
    use super::equality_name;
    use crate::Model;

    #[test]
    fn equality_constraints_have_the_names_of_their_elements() {
        let text = r#"<mujoco>
            <worldbody>
              <body name="arm"><joint name="elbow"/><geom size="0.1"/></body>
              <body name="cup"><joint name="lid"/><geom size="0.1"/></body>
              <body><joint/><geom size="0.1"/></body>
            </worldbody>
            <equality>
              <weld body1="arm" body2="cup"/>
              <connect body1="cup" anchor="0 0 0"/>
              <joint joint1="elbow" joint2="lid"/>
              <joint joint1="lid"/>
              <weld name="grasp" body1="arm" body2="cup"/>
            </equality>
          </mujoco>"#;
        let model = Model::from_xml_str(text).unwrap();
        let names: Vec<String> = model.equalities().map(|equality| equality_name(&model, &equality)).collect();
        assert_eq!(names, ["arm, cup", "cup, world", "elbow, lid", "lid", "grasp"]);
    }
}
