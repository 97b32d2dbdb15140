//! How the windows of this process stand, for the tests of this crate. No part of what is promised.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::input::Key;
use super::panel::Facts;
use super::snapshot::Snapshot;
use super::view::View;

static ON: AtomicBool = AtomicBool::new(false);
static LOSES_SURFACE: AtomicBool = AtomicBool::new(false);
static HOLDS: AtomicBool = AtomicBool::new(false);
static HELD: AtomicBool = AtomicBool::new(false);
static MARKS: AtomicU64 = AtomicU64::new(0);
static SLIDERS: Mutex<Vec<[[f32; 2]; 2]>> = Mutex::new(Vec::new());
static LATEST: Mutex<Option<State>> = Mutex::new(None);

/// How a window stood when it was drawn last.
#[derive(Clone, Debug)]
pub struct State {
    /// Counts the frames.
    pub frame: u64,
    /// Whether the simulation has executed all requests of the window.
    pub answered: bool,
    /// Counts the models that have replaced another.
    pub generation: u64,
    /// What the window looks at, as its debug text.
    pub view: String,
    /// Free, tracking or fixed.
    pub camera: crate::scene::Camera,
    /// What is shown.
    pub options: crate::scene::SceneOptions,
    /// The effects.
    pub render: crate::scene::RenderFlags,
    /// Help, info, left panel, right panel, profile, sensors.
    pub panels: [bool; 6],
    /// Pixels.
    pub size: [u32; 2],
    /// The mode's name.
    pub mode: String,
    /// What it does, as the info panel says.
    pub status: String,
    /// s.
    pub time: f64,
    /// Simulated over real time, as wanted.
    pub wanted: f64,
    /// As in the info panel.
    pub info: Vec<(String, String)>,
    /// The problem that is shown.
    pub problem: String,
    /// The selected body, and whether it is pulled.
    pub selected: Option<(usize, bool)>,
    /// Force and torque on it.
    pub force: [f64; 6],
    /// Positions.
    pub qpos: Vec<f64>,
    /// Controls.
    pub ctrl: Vec<f64>,
    /// Trajectory and record, if any.
    pub playback: Option<[usize; 2]>,
    /// Reversed, burst, Doppler.
    pub playing: [bool; 3],
    /// Burst factor and gamma.
    pub burst: [f64; 2],
    /// States to go back to, and at which it stands.
    pub history: [usize; 2],
    /// How many keyframes were kept.
    pub captured: usize,
    /// Frames of the recording that runs.
    pub recording: Option<u64>,
    /// Geoms in the scene.
    pub ngeom: usize,
    /// Bodies of the model.
    pub nbody: usize,
    /// Whether a text is being edited.
    pub editing: bool,
    /// Counts the presses of F12, which does nothing.
    pub marks: u64,
    /// Whether the window fills the screen.
    pub full_screen: bool,
    /// What is shown for a moment.
    pub messages: Vec<String>,
    /// Where the sliders of the controls are, and the numbers beside them, pixels.
    pub sliders: Vec<[[f32; 2]; 2]>,
}

/// Begins to note how windows stand, and forgets those before.
pub fn start() {
    *LATEST.lock().unwrap_or_else(PoisonError::into_inner) = None;
    ON.store(true, Ordering::Relaxed);
}

/// How the window that was drawn last stands.
pub fn latest() -> Option<State> {
    LATEST.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Takes the surface from the window that is drawn next.
pub fn lose_surface() {
    LOSES_SURFACE.store(true, Ordering::Relaxed);
}

/// Holds the thread of the windows at its next frame until [`release`]: events wait in their queue.
pub fn hold() {
    HOLDS.store(true, Ordering::Release);
}

/// Whether the thread of the windows is held.
pub fn is_held() -> bool {
    HELD.load(Ordering::Acquire)
}

/// Ends a [`hold`].
pub fn release() {
    HOLDS.store(false, Ordering::Release);
}

pub(super) fn wait_while_held() {
    while HOLDS.load(Ordering::Acquire) {
        HELD.store(true, Ordering::Release);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    HELD.store(false, Ordering::Release);
}

pub(super) fn takes_surface() -> bool {
    LOSES_SURFACE.swap(false, Ordering::Relaxed)
}

/// Notes that a key was pressed.
pub(super) fn note_key(key: Key) {
    if key == Key::Function(12) {
        MARKS.fetch_add(1, Ordering::Relaxed);
    }
}

/// Notes where a slider of a control is, points.
pub(super) fn note_slider(rail: egui::Pos2, number: egui::Pos2) {
    if is_on() {
        SLIDERS.lock().unwrap_or_else(PoisonError::into_inner).push([[rail.x, rail.y], [number.x, number.y]]);
    }
}

pub(super) fn is_on() -> bool {
    ON.load(Ordering::Relaxed)
}

pub(super) fn put(
    snapshot: &Snapshot,
    asked: u64,
    view: &View,
    facts: &Facts<'_>,
    messages: Vec<String>,
    editing: bool,
) {
    let sliders = std::mem::take(&mut *SLIDERS.lock().unwrap_or_else(PoisonError::into_inner));
    let mut latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
    let frame = latest.as_ref().map_or(0, |state| state.frame) + 1;
    let playback = snapshot.playback;
    *latest = Some(State {
        frame,
        answered: snapshot.executed >= asked,
        generation: snapshot.generation,
        view: format!("{view:?}"),
        camera: view.camera,
        options: view.options.clone(),
        render: view.render,
        panels: [view.help, view.info, view.left_panel, view.right_panel, view.profile, view.sensors],
        size: facts.size,
        mode: snapshot.mode.to_string(),
        status: snapshot.status.text().to_owned(),
        time: snapshot.time,
        wanted: snapshot.pace.wanted(),
        info: snapshot.info.iter().map(|line| (line.name.to_owned(), line.value.clone())).collect(),
        problem: snapshot.problem.clone(),
        selected: snapshot.selected.map(|selected| (selected.body.index(), selected.active)),
        force: snapshot.selected.map_or([0.0; 6], |selected| selected.force),
        qpos: snapshot.qpos.clone(),
        ctrl: snapshot.ctrl.clone(),
        playback: playback.map(|playback| [playback.trajectory, playback.frame]),
        playing: playback.map_or([false; 3], |playback| [playback.reversed, playback.burst.on, playback.burst.doppler]),
        burst: playback.map_or([0.0; 2], |playback| [playback.burst.factor, playback.burst.gamma]),
        history: [snapshot.history, snapshot.moment],
        captured: snapshot.captured.len(),
        recording: facts.recording,
        ngeom: snapshot.scene.ngeom(),
        nbody: snapshot.model.nbody(),
        editing,
        marks: MARKS.load(Ordering::Relaxed),
        full_screen: facts.full_screen,
        messages,
        sliders,
    });
}
