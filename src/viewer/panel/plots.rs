//! Numbers over time.

use egui::{Align2, Area, Color32, Context, Id, Order, RichText, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints};

use super::layout::{GAP, SIDE};
use super::{Shown, style};
use crate::model::EnableFlags;
use crate::viewer::plot::{Curve, Plots as Curves};
use crate::viewer::snapshot::Snapshot;
use crate::viewer::watch::Watch;

/// Width and height of a plot, points.
const SIZE: [f32; 2] = [340.0, 132.0];
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
        let mut right = GAP + if view.right_panel { SIDE } else { 0.0 };
        if view.profile {
            column(context, "profile", right, |ui| {
                plot(ui, "solver", "", &self.curves.solver);
                plot(ui, "time of a step", "ms", &self.curves.timing);
                let computed = shown.snapshot.model.options().enable.contains(EnableFlags::ENERGY);
                let unit = if computed { "J" } else { "J, which Physics has to be told to compute" };
                plot(ui, "energy", unit, &self.curves.energy);
            });
            right += SIZE[0] + 3.0 * GAP;
        }
        if view.sensors {
            column(context, "sensors", right, |ui| {
                if self.curves.sensors.is_empty() {
                    ui.label("This model has no sensors.");
                } else {
                    plot(ui, "sensors", "", &self.curves.sensors);
                }
            });
        }
    }
}

/// Plots one above another, in the lower right corner.
fn column(context: &Context, id: &'static str, right: f32, content: impl FnOnce(&mut Ui)) {
    Area::new(Id::unique(id)).anchor(Align2::RIGHT_BOTTOM, [-right, -GAP]).order(Order::Middle).show(context, |ui| {
        style::frame().show(ui, |ui| {
            ui.set_width(SIZE[0]);
            content(ui);
        });
    });
}

/// A plot over the time of the simulation.
pub(super) fn plot(ui: &mut Ui, title: &str, unit: &str, curves: &[Curve]) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).strong());
        ui.label(RichText::new(unit).small().color(style::FAINT));
        if curves.len() > MOST_CURVES {
            ui.label(RichText::new(format!("the first {MOST_CURVES} of {}", curves.len())).small().color(style::FAINT));
        }
    });
    let width = ui.available_width();
    Plot::new(title)
        .height(SIZE[1])
        .width(width)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .grid_color(Color32::from_gray(80))
        .set_margin_fraction(egui::vec2(0.0, 0.1))
        .y_axis_min_width(38.0)
        .legend(Legend::default().text_style(egui::TextStyle::Small).background_alpha(0.4).position(egui_plot::Corner::LeftTop))
        .show(ui, |plot| {
            for (index, curve) in curves.iter().take(MOST_CURVES).enumerate() {
                let points: PlotPoints<'_> = curve.points().filter(|[_, value]| value.is_finite()).collect();
                plot.line(Line::new(curve.name.clone(), points).color(style::LINES[index % style::LINES.len()]).width(1.2));
            }
        });
}
