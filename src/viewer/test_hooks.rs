//! Hooks of the integration tests: state of the window that was drawn last, and control over its
//! frames. Compiled only with the feature `_test-hooks`, which the tests enable. Not part of the
//! public API.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use egui::epaint::ClippedShape;
use egui::{Rect, Shape};

use super::input::Key;
use super::link::Snapshot;
use super::panel::WindowStatus;
use super::view::View;
use crate::scene::{Camera, RenderFlags, SceneOptions};

static SURFACE_LOSS_REQUESTED: AtomicBool = AtomicBool::new(false);
static HOLD_REQUESTED: AtomicBool = AtomicBool::new(false);
static LOADING_HELD: AtomicBool = AtomicBool::new(false);
static HELD: AtomicBool = AtomicBool::new(false);
static MARKERS: AtomicU64 = AtomicU64::new(0);
static SCENES: AtomicU64 = AtomicU64::new(0);
static PASSES: AtomicU64 = AtomicU64::new(0);
static REPAINTED: AtomicU64 = AtomicU64::new(0);
static REPAINT_REQUESTED: AtomicBool = AtomicBool::new(false);
static PANICKING: Mutex<Option<String>> = Mutex::new(None);
static SLIDERS: Mutex<Vec<[[f32; 2]; 2]>> = Mutex::new(Vec::new());
static PLOTS: Mutex<Vec<(String, Vec<String>)>> = Mutex::new(Vec::new());
static TEXTS: Mutex<Vec<(String, [f32; 2])>> = Mutex::new(Vec::new());
static LATEST: Mutex<Option<WindowState>> = Mutex::new(None);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// State of a window in its last frame.
#[derive(Clone, Debug)]
pub struct WindowState {
    /// Number of frames since [`start`].
    pub frame: u64,
    /// Number of times that the scene was rendered in this process. Other frames draw only the
    /// panels.
    pub scenes: u64,
    /// Number of pixels that were repainted in this process. A frame repaints only the parts of the
    /// window that have changed.
    pub repainted: u64,
    /// The simulation has executed all requests of the window.
    pub answered: bool,
    /// Number of times that the model was replaced.
    pub generation: u64,
    /// Camera of the view.
    pub camera: Camera,
    /// Scene options of the view.
    pub options: SceneOptions,
    /// Rendering effects of the view.
    pub render: RenderFlags,
    /// Open panels: help, details of the info panel, left, right, profile, sensors, instruments.
    pub panels: [bool; 7],
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Upper left corner and size of the area that shows the scene, pixels.
    pub picture: [[u32; 2]; 2],
    /// Upper left and lower right corner of the visible panels, pixels.
    pub panel_rects: Vec<(&'static str, [[f32; 2]; 2])>,
    /// Name of the mode.
    pub mode: String,
    /// Status as in the info panel.
    pub status: String,
    /// Simulated time, s.
    pub time: f64,
    /// Target of simulated over real time.
    pub target_speed: f64,
    /// Message of the last error.
    pub problem: String,
    /// Index of the selected body, and `true` while it is pulled or rotated.
    pub selected: Option<(usize, bool)>,
    /// Force, N, and torque, N m, on the selected body.
    pub force: [f64; 6],
    /// Positions.
    pub qpos: Vec<f64>,
    /// Controls.
    pub ctrl: Vec<f64>,
    /// Index of the trajectory and of the record.
    pub playback: Option<[usize; 2]>,
    /// Reverse playback, burst, Doppler.
    pub playback_flags: [bool; 3],
    /// Burst factor and gamma.
    pub burst: [f64; 2],
    /// Number of captured keyframes.
    pub captured: usize,
    /// Number of frames of the running recording.
    pub recording: Option<u64>,
    /// Path of the model file that is being loaded.
    pub loading: Option<String>,
    /// Geoms in the scene.
    pub ngeom: usize,
    /// Bodies of the model.
    pub nbody: usize,
    /// The user edits a text.
    pub editing: bool,
    /// Number of presses of F12, which has no binding.
    pub markers: u64,
    /// The window fills the screen.
    pub full_screen: bool,
    /// Notices and problems on the screen.
    pub messages: Vec<String>,
    /// Positions of the rails of the sliders of the parameters and then of the controls, and of the
    /// numbers beside them, pixels.
    pub sliders: Vec<[[f32; 2]; 2]>,
    /// Plots of the instruments on the screen: title, and names of the curves.
    pub plots: Vec<(String, Vec<String>)>,
    /// Names and values of the parameters of the instruments.
    pub parameters: Vec<(String, f64)>,
    /// Visible texts of the panels, in the order in which they were drawn, and their centres,
    /// pixels.
    pub texts: Vec<(String, [f32; 2])>,
}

/// Discards the state of previous windows.
pub fn start() {
    *lock(&LATEST) = None;
}

/// Returns the state of the window that was drawn last.
pub fn latest() -> Option<WindowState> {
    lock(&LATEST).clone()
}

/// Makes the next frame lose its surface.
pub fn lose_surface() {
    SURFACE_LOSS_REQUESTED.store(true, Ordering::Relaxed);
}

/// Makes the next frame of the window with this title panic.
pub fn panic_in_frame(title: &str) {
    *lock(&PANICKING) = Some(title.to_owned());
}

/// Panics once after [`panic_in_frame`] with the title of the window that is drawn.
pub(super) fn panic_if_requested(title: &str) {
    let is_requested = lock(&PANICKING).take_if(|requested| requested == title).is_some();
    assert!(!is_requested, "a panic of the test");
}

/// Blocks the window thread in its next frame until [`release`], so that events wait in the queue.
pub fn hold() {
    HOLD_REQUESTED.store(true, Ordering::Release);
}

/// Returns `true` while the window thread is blocked.
pub fn is_held() -> bool {
    HELD.load(Ordering::Acquire)
}

/// Resumes the window thread after [`hold`].
pub fn release() {
    HOLD_REQUESTED.store(false, Ordering::Release);
}

/// Blocks the loading of models (`true`) or continues it (`false`).
pub fn hold_loading(hold: bool) {
    LOADING_HELD.store(hold, Ordering::Release);
}

pub(super) fn wait_while_loading_is_held() {
    while LOADING_HELD.load(Ordering::Acquire) {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
}

pub(super) fn wait_while_held() {
    while HOLD_REQUESTED.load(Ordering::Acquire) {
        HELD.store(true, Ordering::Release);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    HELD.store(false, Ordering::Release);
}

/// Returns `true` once after [`lose_surface`].
pub(super) fn take_surface_loss() -> bool {
    SURFACE_LOSS_REQUESTED.swap(false, Ordering::Relaxed)
}

/// Counts the images of the scene.
pub(super) fn count_scene() {
    SCENES.fetch_add(1, Ordering::Relaxed);
}

/// Counts repainted pixels.
pub(super) fn count_repainted(pixels: u64) {
    REPAINTED.fetch_add(pixels, Ordering::Relaxed);
}

/// Makes the next frame repaint the window completely.
pub fn repaint_all() {
    REPAINT_REQUESTED.store(true, Ordering::Relaxed);
}

/// Returns `true` once after [`repaint_all`].
pub(super) fn take_repaint() -> bool {
    REPAINT_REQUESTED.swap(false, Ordering::Relaxed)
}

/// Counts the passes of the panels.
pub(super) fn count_pass() {
    PASSES.fetch_add(1, Ordering::Relaxed);
}

/// Returns the number of passes of the panels in this process, with or without a frame.
pub fn passes() -> u64 {
    PASSES.load(Ordering::Relaxed)
}

/// Counts presses of F12.
pub(super) fn count_marker(key: Key) {
    if key == Key::Function(12) {
        MARKERS.fetch_add(1, Ordering::Relaxed);
    }
}

/// Discards the positions of the sliders and the plots before a pass of the panels.
pub(super) fn clear_widgets() {
    lock(&PLOTS).clear();
    lock(&SLIDERS).clear();
}

/// Adds the positions of a slider of the current pass.
pub(super) fn add_slider(slider: &egui::Response, ui: &egui::Ui) {
    // The rail is at the left, the number at the right.
    let rail = slider.rect.left_center() + egui::vec2(ui.spacing().slider_width / 2.0, 0.0);
    let number = slider.rect.right_center() - egui::vec2(10.0, 0.0);
    let scale = ui.pixels_per_point();
    lock(&SLIDERS).push([rail, number].map(|position| [position.x * scale, position.y * scale]));
}

/// Sets the plots of the instruments that the current pass shows: title, and names of the curves.
pub(super) fn set_plots(plots: Vec<(String, Vec<String>)>) {
    *lock(&PLOTS) = plots;
}

/// Sets the visible texts of a pass of the panels.
pub(super) fn set_texts(shapes: &[ClippedShape], scale: f32) {
    let mut texts = lock(&TEXTS);
    texts.clear();
    for ClippedShape { clip_rect, shape, .. } in shapes {
        add_texts(shape, *clip_rect, scale, &mut texts);
    }
}

fn add_texts(shape: &Shape, clip_rect: Rect, scale: f32, texts: &mut Vec<(String, [f32; 2])>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| add_texts(shape, clip_rect, scale, texts)),
        Shape::Text(text) => {
            let centre = text.visual_bounding_rect().center();
            if clip_rect.contains(centre) {
                texts.push((text.galley.text().to_owned(), [centre.x * scale, centre.y * scale]));
            }
        }
        _ => {}
    }
}

/// Frame that was drawn.
pub(super) struct Frame<'a> {
    pub snapshot: &'a Snapshot,
    pub view: &'a View,
    pub status: &'a WindowStatus<'a>,
    /// Number of requests that the window has sent.
    pub queued: u64,
    pub full_screen: bool,
    pub editing: bool,
    pub messages: Vec<String>,
    pub picture: [[u32; 2]; 2],
    pub panel_rects: Vec<(&'static str, [[f32; 2]; 2])>,
}

/// Records the state of a window after a frame.
pub(super) fn record(frame: Frame<'_>) {
    let Frame { snapshot, view, status, queued, full_screen, editing, messages, picture, panel_rects } = frame;
    let (sliders, plots) = (lock(&SLIDERS).clone(), lock(&PLOTS).clone());
    let mut latest = lock(&LATEST);
    let playback = snapshot.playback;
    *latest = Some(WindowState {
        frame: latest.as_ref().map_or(0, |state| state.frame) + 1,
        scenes: SCENES.load(Ordering::Relaxed),
        repainted: REPAINTED.load(Ordering::Relaxed),
        answered: snapshot.executed >= queued,
        generation: snapshot.generation,
        camera: view.camera,
        options: view.options.clone(),
        render: view.render,
        panels: [
            view.help,
            view.details,
            view.left_panel,
            view.right_panel,
            view.profile,
            view.sensors,
            view.instruments,
        ],
        size: status.size,
        picture,
        panel_rects,
        mode: snapshot.mode.to_string(),
        status: snapshot.status.text().to_owned(),
        time: snapshot.time,
        target_speed: snapshot.speed.target(),
        problem: snapshot.problem.clone(),
        selected: snapshot.selected.map(|selected| (selected.body.index(), selected.active)),
        force: snapshot.selected.map_or([0.0; 6], |selected| selected.force),
        qpos: snapshot.qpos.clone(),
        ctrl: snapshot.ctrl.clone(),
        playback: playback.map(|playback| [playback.trajectory, playback.frame]),
        playback_flags: playback
            .map_or([false; 3], |playback| [playback.reversed, playback.burst.on, playback.burst.doppler]),
        burst: playback.map_or([0.0; 2], |playback| [playback.burst.factor, playback.burst.gamma]),
        captured: snapshot.captured.len(),
        recording: status.recording,
        loading: status.loading.clone(),
        ngeom: snapshot.scene.ngeom(),
        nbody: snapshot.model.nbody(),
        editing,
        markers: MARKERS.load(Ordering::Relaxed),
        full_screen,
        messages,
        sliders,
        plots,
        texts: lock(&TEXTS).clone(),
        parameters: snapshot.parameters.iter().map(|parameter| (parameter.name.to_string(), parameter.value)).collect(),
    });
}
