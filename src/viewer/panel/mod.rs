//! The panels over the picture. Each shows a snapshot and the view, and asks for what its user wants.
//!
//! | file | what is in it |
//! |---|---|
//! | `style.rs` | how they look |
//! | `layout.rs` | where they are |
//! | `message.rs` | notices and problems |
//! | `info.rs` | how the simulation stands (F2) |
//! | `help.rs` | what keys and mouse do (F1) |
//! | `simulation.rs` | pause, step, speed, mode, history |
//! | `trajectories.rs` | which moment of which trajectory |
//! | `keyframes.rs` | states to go to, and to keep |
//! | `watch.rs` | numbers by their names |
//! | `physics.rs`, `equality.rs` | what the simulation computes with |
//! | `visual.rs`, `groups.rs`, `rendering.rs` | what is shown, and how |
//! | `controls.rs`, `joints.rs` | actuators and joints |
//! | `selection.rs` | the selected body, and what pulls it |
//! | `plots.rs` | numbers over time |

mod controls;
mod equality;
mod groups;
mod help;
mod info;
mod joints;
mod keyframes;
mod layout;
mod message;
mod physics;
mod plots;
mod rendering;
mod selection;
mod simulation;
pub(super) mod style;
mod trajectories;
mod visual;
mod watch;

use egui::Ui;

use super::input::Action;
use super::request::Request as PhysicsRequest;
use super::snapshot::{Snapshot, Status};
use super::view::View;
use crate::model::Options;

/// What the user of a panel wants.
#[derive(Debug)]
pub(super) enum Request {
    Physics(Box<PhysicsRequest>),
    Act(Action),
    Vsync(bool),
}

/// What the panels have to know of the window.
#[derive(Debug)]
pub(super) struct Facts<'a> {
    /// Pixels.
    pub size: [u32; 2],
    /// Frames per second, where it is drawn all the time.
    pub rate: Option<f64>,
    /// Frames of the recording that runs.
    pub recording: Option<u64>,
    pub vsync: bool,
    pub full_screen: bool,
    /// What it is drawn with.
    pub gpu: &'a str,
}

/// What a panel shows and changes.
pub(super) struct Shown<'a> {
    pub snapshot: &'a Snapshot,
    pub view: &'a mut View,
    /// The physics options that an edit starts from.
    pub options: Options,
    pub facts: &'a Facts<'a>,
    pub requests: &'a mut Vec<Request>,
}

impl Shown<'_> {
    fn ask(&mut self, request: PhysicsRequest) {
        self.requests.push(Request::Physics(Box::new(request)));
    }

    fn act(&mut self, action: Action) {
        self.requests.push(Request::Act(action));
    }

    /// Whether states can be set without a running simulation overwriting them at once.
    fn is_editable(&self) -> bool {
        matches!(self.snapshot.status, Status::Paused | Status::Program)
    }
}

/// All panels, and what each remembers.
#[derive(Default)]
pub(super) struct Panels {
    messages: message::Messages,
    plots: plots::Plots,
    watch: watch::WatchPanel,
    keyframes: keyframes::KeyframesPanel,
}

impl Panels {
    /// Shows a text for a moment.
    pub fn notice(&mut self, text: String) {
        self.messages.notice(text);
    }

    /// Shows what went wrong, for a while.
    pub fn warn(&mut self, text: String) {
        log::warn!("{text}");
        self.messages.warn(text);
    }

    /// What is shown for a moment.
    pub fn messages(&self) -> Vec<String> {
        self.messages.texts()
    }

    /// There is another model: what was of the one before is forgotten.
    pub fn forget_model(&mut self) {
        self.plots = plots::Plots::default();
    }

    /// While nothing is there to be seen.
    pub fn wait(ui: &mut Ui) {
        layout::middle(ui.ctx(), "wait", |ui| {
            ui.label("Waiting for the program to show its simulation…");
        });
    }

    pub fn show(&mut self, ui: &mut Ui, shown: &mut Shown<'_>) {
        let context = ui.ctx().clone();
        self.plots.take(shown.snapshot, self.watch.watched());
        if shown.view.left_panel {
            layout::left(&context, |ui| self.left(ui, shown));
        }
        if shown.view.right_panel {
            layout::right(&context, |ui| Self::right(ui, shown));
        }
        if shown.view.info {
            layout::lower_left(&context, shown.view.left_panel, |ui| info::show(ui, shown));
        }
        self.plots.show(&context, shown);
        self.messages.show(&context, shown);
        if shown.view.help {
            help::show(&context, shown);
        }
    }

    fn left(&mut self, ui: &mut Ui, shown: &mut Shown<'_>) {
        layout::section(ui, "Simulation", true, |ui| simulation::show(ui, shown));
        if shown.snapshot.playback.is_some() {
            layout::section(ui, "Trajectories", true, |ui| trajectories::show(ui, shown));
        }
        layout::section(ui, "Keyframes", false, |ui| self.keyframes.show(ui, shown));
        layout::section(ui, "Visualisation", true, |ui| visual::show(ui, shown));
        layout::section(ui, "Groups", false, |ui| groups::show(ui, shown));
        layout::section(ui, "Rendering", false, |ui| rendering::show(ui, shown));
        layout::section(ui, "Physics", false, |ui| physics::show(ui, shown));
        if shown.snapshot.model.neq() > 0 {
            layout::section(ui, "Equality constraints", false, |ui| equality::show(ui, shown));
        }
        layout::section(ui, "Watch", false, |ui| self.watch.show(ui, shown, self.plots.watched()));
    }

    fn right(ui: &mut Ui, shown: &mut Shown<'_>) {
        layout::section(ui, "Selection", true, |ui| selection::show(ui, shown));
        if shown.snapshot.model.nu() > 0 {
            layout::section(ui, "Controls", true, |ui| controls::show(ui, shown));
        }
        layout::section(ui, "Joints", true, |ui| joints::show(ui, shown));
    }
}

/// What an element is called: its name, or its number.
fn name_of(name: Option<&str>, index: usize) -> String {
    name.map_or_else(|| index.to_string(), str::to_owned)
}
