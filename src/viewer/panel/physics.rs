//! Panels of the physics options and the equality constraints.

use egui::{DragValue, Ui};

use super::{PanelContext, display_name, layout, visual};
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::model::{DisableFlags, EnableFlags};
use crate::viewer::link::EndpointRequest;

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 104.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let mut options = cx.options;
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
    toggles(ui, DisableFlags::all().iter_names(), |flag| !options.disable.contains(flag), |flag| disable.toggle(flag));
    options.disable = disable;
    ui.strong("Optional");
    let mut enable = options.enable;
    toggles(ui, EnableFlags::all().iter_names(), |flag| options.enable.contains(flag), |flag| enable.toggle(flag));
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
        if ui.checkbox(&mut on, visual::words(name)).changed() {
            toggle(flag);
        }
    });
}

pub(super) fn show_equalities(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let model = cx.snapshot.model.clone();
    for equality in model.equalities() {
        let mut active = equality.active();
        let text = format!("{} ({:?})", display_name(equality.name(), equality.index()), equality.equality_type());
        if ui.checkbox(&mut active, text).changed() {
            cx.send(EndpointRequest::SetEquality(equality.id(), active));
        }
    }
}
