//! Plots of values over time, and the panel of watched values.

use egui::{Color32, Rangef, RichText, TextEdit, Ui};
use egui_plot::{AxisHints, Line, Plot, PlotPoints};

use super::curves::{Curve, Curves};
use super::{PanelContext, style};
use crate::model::EnableFlags;
use crate::viewer::endpoint::Watch;
use crate::viewer::link::{EndpointRequest, Snapshot};

/// Minimum height of a plot, points.
const MIN_HEIGHT: f32 = 70.0;
/// Maximum height of a plot, points.
const MAX_HEIGHT: f32 = 120.0;
/// Height of the title and the legend of a plot, points.
const TITLE_HEIGHT: f32 = 40.0;
/// Distances of grid lines at which the label of the time appears and is opaque, points.
const TIME_SPACING: Rangef = Rangef { min: 22.0, max: 36.0 };
/// Maximum number of curves in a plot. More curves could not be distinguished.
const MAX_CURVES: usize = 16;

/// Plots at the top of the right panel.
#[derive(Default)]
pub(super) struct PlotPanel {
    curves: Curves,
    /// Generation and number of the last snapshot.
    last: Option<(u64, u64)>,
}

impl PlotPanel {
    /// Adds the values of a snapshot to the curves, unless the curves contain it already.
    pub fn update(&mut self, snapshot: &Snapshot, watched: &[Watch]) {
        let id = (snapshot.generation, snapshot.number);
        if self.last != Some(id) {
            self.last = Some(id);
            self.curves.update(snapshot, watched.iter().map(Watch::to_string));
        }
    }

    /// Returns the curves of the watched values.
    pub fn watched(&self) -> &[Curve] {
        &self.curves.watched
    }

    /// Shows the plots of the instruments.
    pub fn show_instruments(&self, ui: &mut Ui) {
        let plots = &self.curves.instruments;
        // The sliders follow below.
        let room = 0.6 * ui.ctx().content_rect().height();
        let height = (room / plots.len().max(1) as f32 - TITLE_HEIGHT).clamp(MIN_HEIGHT, MAX_HEIGHT);
        for (index, plot) in plots.iter().enumerate() {
            // A title may equal the title of a plot of the viewer, or of a plot in another panel.
            ui.push_id(("instruments", index), |ui| show_plot(ui, &plot.title, "", &plot.curves, height));
        }
        #[cfg(feature = "_test-hooks")]
        crate::viewer::test_hooks::set_plots(
            plots
                .iter()
                .map(|plot| (plot.title.to_string(), plot.curves.iter().map(|curve| curve.name.clone()).collect()))
                .collect(),
        );
    }

    pub fn show(&self, ui: &mut Ui, cx: &PanelContext<'_>) {
        let view = &*cx.view;
        let mut plots: Vec<(&str, &str, &[Curve])> = Vec::new();
        if view.sensors {
            plots.push((
                "sensors",
                if self.curves.sensors.is_empty() { "none in this model" } else { "" },
                &self.curves.sensors,
            ));
        }
        if view.profile {
            let computed = cx.snapshot.model.options().enable.contains(EnableFlags::ENERGY);
            let unit = if computed { "J" } else { "enable ENERGY in Physics" };
            plots.push(("solver", "", &self.curves.solver));
            plots.push(("time of a step", "ms", &self.curves.timing));
            plots.push(("energy", unit, &self.curves.energy));
        }
        if plots.is_empty() {
            return;
        }
        // The plots share the height of the window. If that is too low, the panel scrolls.
        let legend = if view.sensors { 2.0 * TITLE_HEIGHT } else { 0.0 };
        let room = ui.ctx().content_rect().height() - legend;
        let height = (room / plots.len() as f32 - TITLE_HEIGHT).clamp(MIN_HEIGHT, MAX_HEIGHT);
        for (title, unit, curves) in plots {
            show_plot(ui, title, unit, curves, height);
        }
    }
}

/// Shows a plot over simulated time in the available width.
fn show_plot(ui: &mut Ui, title: &str, unit: &str, curves: &[Curve], height: f32) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(7.0, 1.0);
        ui.label(RichText::new(title).strong());
        if !unit.is_empty() {
            ui.label(RichText::new(unit).small().weak());
        }
        for (index, curve) in curves.iter().take(MAX_CURVES).enumerate() {
            ui.label(RichText::new(&curve.name).small().color(style::curve_color(ui, index)));
        }
        if curves.len() > MAX_CURVES {
            ui.label(RichText::new(format!("and {} more", curves.len() - MAX_CURVES)).small().weak());
        }
    });
    let colors: Vec<Color32> = (0..MAX_CURVES).map(|index| style::curve_color(ui, index)).collect();
    let (width, grid) = (ui.available_width(), ui.visuals().weak_text_color().gamma_multiply(0.5));
    Plot::new(title)
        .height(height)
        .width(width)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .show_crosshair(false)
        .grid_color(grid)
        .set_margin_fraction(egui::vec2(0.0, 0.1))
        .y_axis_min_width(38.0)
        .custom_x_axes(vec![AxisHints::new_x().label_spacing(TIME_SPACING)])
        .show(ui, |plot| {
            for (curve, color) in curves.iter().zip(colors) {
                let points: PlotPoints<'_> = curve.points().filter(|[_, value]| value.is_finite()).collect();
                plot.line(Line::new(curve.name.clone(), points).color(color).width(1.2));
            }
        });
}

/// Maximum number of watched values.
const MAX_WATCHES: usize = 16;

/// Panel of the watched values.
#[derive(Default)]
pub(super) struct WatchPanel {
    watched: Vec<Watch>,
    /// Text of the input field.
    text: String,
    /// Message of the last parse error.
    problem: String,
}

impl WatchPanel {
    pub fn watched(&self) -> &[Watch] {
        &self.watched
    }

    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>, curves: &[Curve]) {
        let mut changed = false;
        ui.horizontal(|ui| {
            let edit = TextEdit::singleline(&mut self.text).desired_width(150.0).hint_text("qpos[2]");
            let entered = ui.add(edit).lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if (ui.button("Watch").clicked() || entered) && self.watched.len() < MAX_WATCHES {
                match self.text.parse::<Watch>() {
                    Ok(watch) => {
                        if !self.watched.contains(&watch) {
                            self.watched.push(watch);
                            changed = true;
                        }
                        self.text.clear();
                        self.problem.clear();
                    }
                    Err(error) => self.problem = error.to_string(),
                }
            }
        });
        if !self.problem.is_empty() {
            ui.add(egui::Label::new(RichText::new(&self.problem).color(style::warning(ui))).wrap());
        }
        let mut removed = None;
        for (index, watch) in self.watched.iter().enumerate() {
            ui.horizontal(|ui| {
                if ui.small_button("x").on_hover_text("removes this value").clicked() {
                    removed = Some(index);
                }
                ui.label(watch.to_string());
                let value = cx.snapshot.watched.get(index).copied().unwrap_or(f64::NAN);
                let value = if value.is_nan() { "none".to_owned() } else { format!("{value:.6}") };
                ui.label(RichText::new(value).monospace());
            });
        }
        if let Some(index) = removed {
            self.watched.remove(index);
            changed = true;
        }
        if changed {
            cx.send(EndpointRequest::Watch(self.watched.clone()));
        }
        if !self.watched.is_empty() {
            show_plot(ui, "watched", "", curves, MAX_HEIGHT);
        }
    }
}
