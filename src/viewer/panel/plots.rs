//! Plots of values over time, in the right panel and in windows.

use egui::{Context, Id, RichText, Ui, Window};

use super::curves::{Curves, Group, Plot};
use super::{PanelContext, chart, layout};
use crate::model::EnableFlags;
use crate::viewer::link::Snapshot;

/// Minimum height of a plot, points.
const MIN_HEIGHT: f32 = 76.0;
/// Maximum height of a plot, points.
const MAX_HEIGHT: f32 = 120.0;
/// Height of the title and the names of a plot, points.
const TITLE_HEIGHT: f32 = 40.0;
/// Minimum number of curves of sensors with a filter.
const MIN_FILTERED: usize = 6;
/// Initial size of the window of a plot, points.
const WINDOW_SIZE: [f32; 2] = [420.0, 240.0];

/// Plots of all groups.
#[derive(Default)]
pub(super) struct PlotPanel {
    curves: Curves,
    /// Generation and number of the last snapshot.
    last: Option<(u64, u64)>,
    /// Text that the names of the sensors contain.
    filter: String,
    /// Plots that are shown in windows.
    windows: Vec<Id>,
}

impl PlotPanel {
    /// Adds the values of a snapshot to the curves, unless the curves contain it already. Its
    /// ranges are empty afterwards.
    pub fn update(&mut self, snapshot: &mut Snapshot) {
        let id = (snapshot.generation, snapshot.number);
        if self.last != Some(id) {
            self.last = Some(id);
            self.curves.update(snapshot);
            snapshot.clear_ranges();
        }
    }

    /// Shows the plots of the instruments.
    pub fn show_instruments(&mut self, ui: &mut Ui) {
        // The sliders follow below.
        let room = 0.6 * ui.ctx().content_rect().height();
        self.show_group(ui, Group::Instruments, room);
        #[cfg(feature = "_test-hooks")]
        crate::viewer::test_hooks::set_plots(
            self.curves
                .plots(Group::Instruments)
                .iter()
                .map(|plot| (plot.title.to_string(), plot.curves.iter().map(|curve| curve.name.clone()).collect()))
                .collect(),
        );
    }

    /// Shows the open plots of the viewer.
    pub fn show(&mut self, ui: &mut Ui, cx: &PanelContext<'_>) {
        let open = [cx.view.sensors, cx.view.profile];
        if cx.view.sensors {
            self.show_filter(ui);
        }
        // The plots share the height of the window. If that is too low, the panel scrolls.
        let room = ui.ctx().content_rect().height();
        for (group, _) in [Group::Sensors, Group::Profile].into_iter().zip(open).filter(|(_, open)| *open) {
            self.show_group(ui, group, room);
        }
        if cx.view.profile && !cx.snapshot.model.options().enable.contains(EnableFlags::ENERGY) {
            ui.label(RichText::new("the option ENERGY in Physics computes the energy").small().weak());
        }
    }

    /// Shows the plots of the watched values.
    pub fn show_watched(&mut self, ui: &mut Ui) {
        self.show_group(ui, Group::Watched, 0.0);
    }

    fn show_filter(&mut self, ui: &mut Ui) {
        let sensors = self.curves.plots(Group::Sensors);
        let count: usize = sensors.iter().map(|plot| plot.curves.len()).sum();
        if count == 0 {
            ui.label(RichText::new("this model has no sensors").weak());
        }
        if count < MIN_FILTERED {
            return;
        }
        let width = ui.available_width();
        if layout::text_field(ui, &mut self.filter, "filter of the sensors", width).changed() {
            let wanted = self.filter.to_lowercase();
            for curve in sensors.iter_mut().flat_map(|plot| &mut plot.curves) {
                curve.is_found = curve.name.to_lowercase().contains(&wanted);
            }
        }
    }

    /// Shows the plots of a group that are not in windows, in a room of this height, points.
    fn show_group(&mut self, ui: &mut Ui, group: Group, room: f32) {
        let plots = self.curves.plots(group);
        let height = (room / plots.len().max(1) as f32 - TITLE_HEIGHT).clamp(MIN_HEIGHT, MAX_HEIGHT);
        for plot in plots.iter_mut().filter(|plot| plot.curves.iter().any(|curve| curve.is_found)) {
            let id = id_of(group, plot);
            if self.windows.contains(&id) {
                continue;
            }
            if ui.push_id(id, |ui| chart::show(ui, plot, height, false)).inner {
                self.windows.push(id);
            }
        }
    }

    /// Shows the plots that have windows.
    pub fn show_windows(&mut self, context: &Context) {
        for group in Group::ALL {
            for plot in self.curves.plots(group) {
                let id = id_of(group, plot);
                if !self.windows.contains(&id) {
                    continue;
                }
                let mut is_open = true;
                Window::new(&*plot.title).id(id.with("window")).open(&mut is_open).default_size(WINDOW_SIZE).show(
                    context,
                    |ui| {
                        let height = (ui.available_height() - TITLE_HEIGHT).max(MIN_HEIGHT);
                        chart::show(ui, plot, height, true);
                    },
                );
                if !is_open {
                    self.windows.retain(|other| *other != id);
                }
            }
        }
    }
}

/// Returns the id of a plot. Titles of different groups can be equal.
fn id_of(group: Group, plot: &Plot) -> Id {
    Id::unique((group, &plot.title))
}
