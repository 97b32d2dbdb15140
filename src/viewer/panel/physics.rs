//! What the simulation computes with.

use egui::{DragValue, Ui};

use super::{Shown, layout, visual};
use crate::enums::{Collision, Cone, Integrator, JacobianStorage, Solver};
use crate::model::{DisableFlags, EnableFlags};
use crate::viewer::request::Request;

/// Width of the names.
const NAMES: f32 = 104.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    let mut options = shown.options;
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

    ui.strong("Parts of a step");
    let mut disable = options.disable;
    flags(ui, DisableFlags::all().iter_names(), |flag| !options.disable.contains(flag), |flag| disable.toggle(flag));
    options.disable = disable;
    ui.strong("Extras");
    let mut enable = options.enable;
    flags(ui, EnableFlags::all().iter_names(), |flag| options.enable.contains(flag), |flag| enable.toggle(flag));
    options.enable = enable;

    if options != before {
        shown.ask(Request::SetOptions(Box::new(options)));
    }
}

fn choice<T: Copy + PartialEq + std::fmt::Debug>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    from_raw: fn(i32) -> Option<T>,
) {
    layout::named(ui, name, NAMES, |ui| visual::choice(ui, name, value, (0..).map_while(from_raw)));
}

fn number(ui: &mut Ui, name: &str, value: &mut f64, speed: f64, least: f64) {
    layout::named(ui, name, NAMES, |ui| {
        let text =
            |value: f64, _| if value != 0.0 && value.abs() < 1e-4 { format!("{value:e}") } else { format!("{value}") };
        ui.add(
            DragValue::new(value)
                .speed(speed)
                .range(least..=f64::MAX)
                .custom_formatter(text)
                .update_while_editing(false),
        );
    });
}

fn count(ui: &mut Ui, name: &str, value: &mut usize) {
    layout::named(ui, name, NAMES, |ui| ui.add(DragValue::new(value).range(0..=100_000).update_while_editing(false)));
}

fn vector(ui: &mut Ui, name: &str, values: &mut [f64; 3]) {
    layout::named(ui, name, NAMES, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for value in values {
            ui.add(DragValue::new(value).speed(0.01).max_decimals(2).update_while_editing(false));
        }
    });
}

fn flags<F: Copy>(
    ui: &mut Ui,
    every: impl Iterator<Item = (&'static str, F)>,
    is_on: impl Fn(F) -> bool,
    mut toggle: impl FnMut(F),
) {
    layout::pairs(ui, every, |ui, (name, flag)| {
        let mut on = is_on(flag);
        if ui.checkbox(&mut on, visual::sentence(name)).changed() {
            toggle(flag);
        }
    });
}
