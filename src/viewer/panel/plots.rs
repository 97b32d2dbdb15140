//! Numbers over time.

use egui::{Align2, Area, Color32, Context, Id, Order, RichText, Ui};
use egui_plot::{Line, Plot, PlotPoints};

use super::layout::{GAP, SIDE};
use super::{Shown, style};
use crate::model::EnableFlags;
use crate::viewer::plot::{Curve, Plots as Curves};
use crate::viewer::snapshot::Snapshot;
use crate::viewer::watch::Watch;

/// Width of the plots, points.
const WIDTH: f32 = 330.0;
/// Their greatest height.
pub(super) const HEIGHT: f32 = 120.0;
/// What is above a plot.
const ABOVE: f32 = 40.0;
/// How many curves a plot has at most: more cannot be told apart.
const MOST_CURVES: usize = 16;

/// The curves, and which snapshot they have seen last.
#[derive(Default)]
pub(super) struct Plots {
    curves: Curves,
    seen: Option<(u64, u64)>,
}

impl Plots {
    /// Adds what a snapshot says, if it is a new one.
    pub fn take(&mut self, snapshot: &Snapshot, watched: &[Watch]) {
        let name = (snapshot.generation, snapshot.number);
        if self.seen != Some(name) {
            self.seen = Some(name);
            self.curves.take(snapshot, watched.iter().map(Watch::to_string));
        }
    }

    /// The curves of what is watched.
    pub fn watched(&self) -> &[Curve] {
        &self.curves.watched
    }

    pub fn show(&self, context: &Context, shown: &Shown<'_>) {
        let view = &*shown.view;
        let mut plots: Vec<(&str, &str, &[Curve])> = Vec::new();
        if view.sensors {
            plots.push((
                "sensors",
                if self.curves.sensors.is_empty() { "there are none" } else { "" },
                &self.curves.sensors,
            ));
        }
        if view.profile {
            let computed = shown.snapshot.model.options().enable.contains(EnableFlags::ENERGY);
            let unit = if computed { "J" } else { "switch it on in Physics" };
            plots.push(("solver", "", &self.curves.solver));
            plots.push(("time of a step", "ms", &self.curves.timing));
            plots.push(("energy", unit, &self.curves.energy));
        }
        if plots.is_empty() {
            return;
        }
        // One above another, as high as there is room for.
        let room = context.content_rect().height() - 4.0 * GAP;
        let legend = if view.sensors { 2.0 * ABOVE } else { 0.0 };
        let height = ((room - legend) / plots.len() as f32 - ABOVE).clamp(40.0, HEIGHT);
        let right = GAP + if view.right_panel { SIDE } else { 0.0 };
        let place = Area::new(Id::unique("plots")).anchor(Align2::RIGHT_BOTTOM, [-right, -GAP]);
        place.order(Order::Middle).show(context, |ui| {
            style::frame().show(ui, |ui| {
                ui.set_width(WIDTH);
                for (title, unit, curves) in plots {
                    plot(ui, title, unit, curves, height);
                }
            });
        });
    }
}

/// A plot over the time of the simulation, in the width that there is.
pub(super) fn plot(ui: &mut Ui, title: &str, unit: &str, curves: &[Curve], height: f32) {
    // The same again, darker, where there are more.
    let color = |index: usize| {
        let color = style::LINES[index % style::LINES.len()];
        if index < style::LINES.len() { color } else { color.gamma_multiply(0.55) }
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(7.0, 1.0);
        ui.label(RichText::new(title).strong());
        if !unit.is_empty() {
            ui.label(RichText::new(unit).small().color(style::FAINT));
        }
        for (index, curve) in curves.iter().take(MOST_CURVES).enumerate() {
            ui.label(RichText::new(&curve.name).small().color(color(index)));
        }
        if curves.len() > MOST_CURVES {
            ui.label(RichText::new(format!("and {} more", curves.len() - MOST_CURVES)).small().color(style::FAINT));
        }
    });
    let width = ui.available_width();
    Plot::new(title)
        .height(height)
        .width(width)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .show_crosshair(false)
        .grid_color(Color32::from_gray(80))
        .set_margin_fraction(egui::vec2(0.0, 0.1))
        .y_axis_min_width(38.0)
        .show(ui, |plot| {
            for (index, curve) in curves.iter().take(MOST_CURVES).enumerate() {
                let points: PlotPoints<'_> = curve.points().filter(|[_, value]| value.is_finite()).collect();
                plot.line(Line::new(curve.name.clone(), points).color(color(index)).width(1.2));
            }
        });
}
