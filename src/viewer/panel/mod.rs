//! Panels over the scene. They display a snapshot and the view, and turn the user's input into
//! actions.

mod appearance;
mod chart;
mod curve;
mod curves;
mod files;
mod find;
mod instruments;
mod layout;
mod names;
mod panes;
mod physics;
mod plots;
mod simulation;
mod state;
mod status;
mod style;
mod timeline;
mod tree;
mod visual;
mod watch;

use std::path::{Path, PathBuf};

use egui::Ui;

pub(super) use self::layout::{Sections, has_place_for_sides, side_widths};
pub(super) use self::style::{apply_style, limited_scale, style_of};
pub(super) use self::timeline::timeline_height;
use super::input::{Action, Key};
use super::link::{PredictedState, Request, Snapshot, Status};
use super::view::View;
use super::window::PaneImage;
use crate::model::Model;
use crate::scene::Camera;

/// Properties of the window that the panels show.
#[derive(Debug)]
pub(super) struct WindowStatus<'a> {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Frames per second while the window is drawn continuously.
    pub rate: Option<f64>,
    /// Number of frames of the running recording.
    pub recording: Option<u64>,
    /// Path of the model file that is being loaded.
    pub loading: Option<String>,
    pub vsync: bool,
    /// Name of the GPU.
    pub gpu: &'a str,
}

/// Input and output of the panels.
pub(super) struct PanelContext<'a> {
    pub snapshot: &'a Snapshot,
    pub view: &'a mut View,
    /// Values on which edits are based.
    pub predicted: &'a PredictedState,
    pub status: &'a WindowStatus<'a>,
    /// Images of the camera panes.
    pub panes: &'a [PaneImage],
    /// Keys that the program receives.
    pub released_keys: &'a [Key],
    /// Actions of the user.
    pub actions: &'a mut Vec<Action>,
}

impl PanelContext<'_> {
    fn send(&mut self, request: impl Into<Request>) {
        self.actions.push(Action::Send(request.into()));
    }

    /// Returns `true` if states can be edited. A simulation that the viewer runs would overwrite
    /// them immediately.
    fn is_editable(&self) -> bool {
        matches!(self.snapshot.status, Status::Paused | Status::Program)
    }
}

/// All panels and their state.
#[derive(Default)]
pub(super) struct Panels {
    messages: status::Messages,
    plots: plots::PlotPanel,
    watch: watch::WatchPanel,
    controls: state::ControlsPanel,
    joints: state::JointsPanel,
    keyframes: state::KeyframesPanel,
    find: find::FindPanel,
    files: files::FilesPanel,
    tree: tree::TreePanel,
}

impl Panels {
    /// Shows a notice for a few seconds.
    pub fn notice(&mut self, text: String) {
        self.messages.notice(text);
    }

    /// Shows the name of the camera for two seconds.
    pub fn announce_camera(&mut self, camera: &Camera, model: &Model) {
        self.messages.announce(format!("camera: {}", visual::camera_name(camera, model)));
    }

    /// Shows and logs a problem.
    pub fn warn(&mut self, text: String) {
        log::warn!("{text}");
        self.messages.warn(text);
    }

    /// Returns the messages that are currently shown.
    #[cfg(feature = "_test-hooks")]
    pub fn messages(&self) -> Vec<String> {
        self.messages.texts()
    }

    /// Discards the state that belongs to the previous model.
    pub fn reset_model(&mut self) {
        self.plots = plots::PlotPanel::default();
    }

    /// Creates the panels of a window with the recent files of an earlier window.
    pub fn new(recent: Vec<PathBuf>) -> Self {
        Self { files: files::FilesPanel::new(recent), ..Self::default() }
    }

    /// Returns the recent files, the newest first.
    pub fn recent(&self) -> &[PathBuf] {
        self.files.recent()
    }

    /// Adds a file to the recent files.
    pub fn loaded(&mut self, path: &Path) {
        self.files.loaded(path);
    }

    /// Shows a placeholder before the first snapshot.
    pub fn show_waiting(ui: &mut Ui) {
        layout::center(ui.ctx(), "wait", |ui| {
            ui.label("Waiting for the program to show its simulation…");
        });
    }

    /// Moves the ranges of the signals of a snapshot to the plots, and adds their values.
    pub fn record(&mut self, snapshot: &mut Snapshot) {
        self.plots.update(snapshot);
    }

    pub fn show(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        let context = ui.ctx().clone();
        let widths = side_widths(cx.view, cx.snapshot.has_instruments(), context.content_rect().width());
        let [left, right] = widths;
        if left > 0.0
            && let Some(width) = layout::left(&context, widths, |ui| self.show_left(ui, cx))
        {
            cx.view.side_widths[0] = width;
        }
        if right > 0.0
            && let Some(width) = layout::right(&context, widths, |ui| self.show_right(ui, cx))
        {
            cx.view.side_widths[1] = width;
        }
        self.plots.show_windows(&context);
        layout::lower_left(&context, left, |ui| status::show_info(ui, cx));
        self.messages.show(&context, cx, widths);
        panes::show(&context, cx, right);
        timeline::show(&context, cx);
        self.files.show(&context, cx);
        if cx.view.help {
            status::show_help(&context, cx);
        }
    }

    fn show_left(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        layout::section(ui, "Simulation", true, |ui| simulation::show(ui, cx));
        if cx.snapshot.playback.is_some() {
            layout::section(ui, "Trajectories", true, |ui| simulation::show_playback(ui, cx));
        }
        layout::section(ui, "Keyframes", false, |ui| self.keyframes.show(ui, cx));
        layout::section(ui, "Visualisation", true, |ui| visual::show(ui, cx));
        layout::section(ui, "Groups", false, |ui| visual::show_groups(ui, cx));
        layout::section(ui, "Rendering", false, |ui| visual::show_rendering(ui, cx));
        layout::section(ui, "Appearance", false, |ui| appearance::show(ui, cx));
        layout::section(ui, "Physics", false, |ui| physics::show(ui, cx));
        if cx.snapshot.model.neq() > 0 {
            layout::section(ui, "Equality constraints", false, |ui| physics::show_equalities(ui, cx));
        }
        layout::section(ui, "Watch", false, |ui| self.watch.show(ui, cx, &mut self.plots));
        layout::section(ui, "Window", false, style::show);
    }

    fn show_right(&mut self, ui: &mut Ui, cx: &mut PanelContext<'_>) {
        if cx.view.instruments {
            self.plots.show_instruments(ui);
            instruments::show(ui, cx);
        }
        self.plots.show(ui, cx);
        if !cx.view.right_panel {
            return;
        }
        layout::section(ui, "Find", true, |ui| self.find.show(ui, cx));
        layout::section(ui, "Selection", true, |ui| state::show_selection(ui, cx));
        if cx.snapshot.model.nu() > 0 {
            layout::section(ui, "Controls", true, |ui| self.controls.show(ui, cx));
        }
        layout::section(ui, "Joints", true, |ui| self.joints.show(ui, cx));
        layout::section(ui, "Model", false, |ui| self.tree.show(ui, cx));
    }
}

/// Returns the name of an element, or its index if it has no name.
fn display_name(name: Option<&str>, index: usize) -> String {
    name.map_or_else(|| index.to_string(), str::to_owned)
}
