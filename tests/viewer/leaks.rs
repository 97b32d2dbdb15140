//! Memory consumption over many frames.

use std::fs;

use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Model};

use crate::harness::{press, show_with, state};
use crate::input::{Input, wait_until};

/// Frames in a period, which consists of rounds of at least 25 frames.
const FRAMES: u64 = 1000;
/// Maximum number of periods.
const PERIODS: usize = 4;
/// Growth in a period that counts as a leak, in MB. The smallest frame occupies 0.1 MB, and the
/// texture of a model 3 MB.
const MAX_GROWTH: f64 = 20.0;

/// Returns the resident memory of this process, MB.
fn resident() -> f64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux has /proc");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("the resident memory");
    line.split_whitespace().nth(1).and_then(|size| size.parse::<f64>().ok()).expect("a number") / 1024.0
}

/// Resizes the window, reloads the model, and changes the mode and the panels.
fn run_round(input: &Input, number: u32) {
    let size = [200 + 40 * (number % 4), 160 + 30 * (number % 3)];
    input.resize(size);
    wait_until("the window is resized", || state().size == size);
    let generation = state().generation;
    press(input, "ctrl+l", "the model is reloaded", |state| {
        state.generation > generation && state.mode == "Controller"
    });
    if state().status == "Paused" {
        press(input, "space", "the simulation runs", |state| state.status == "Forward Simulation");
    }
    let frame = state().frame;
    wait_until("25 frames are drawn", || state().frame > frame + 25);
    press(input, "ctrl+Right", "the passive mode is selected", |state| state.mode == "Passive Dynamics");
    press(input, "ctrl+Left", "the controller mode is selected", |state| state.mode == "Controller");
    press(input, "ctrl+1", "the left panel is open", |state| state.panels[2]);
    press(input, "ctrl+1", "the left panel is closed", |state| !state.panels[2]);
}

pub fn memory_does_not_leak() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.xml");
    fs::write(
        &file,
        r#"<mujoco><asset><texture name="t" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 1 0" width="1024" height="1024"/>
        <material name="m" texture="t"/></asset><worldbody><light pos="0 0 2"/><geom type="plane" size="1 1 .1" material="m"/>
        <body pos="0 0 .5"><joint name="j"/><geom size=".1"/></body></worldbody>
        <actuator><motor joint="j"/></actuator></mujoco>"#,
    )
    .unwrap();
    let data = Data::new(Model::from_xml_path(&file).unwrap()).unwrap();
    let controller = |data: &mut Data| data.ctrl_mut().fill(0.1);
    let options = ViewerOptions::default().with_file(file);
    show_with(options, Viewer::new().with_controller(controller), data, |input| {
        // Warms up the caches of the driver.
        (0..6).for_each(|number| run_round(input, number));
        // A leak grows in every period. Memory that allocators and drivers retain grows only in
        // some periods.
        let mut growth = Vec::new();
        while growth.len() < PERIODS && growth.iter().all(|&grown| grown >= MAX_GROWTH) {
            let (memory, frame) = (resident(), state().frame);
            let mut number = 0;
            while state().frame < frame + FRAMES {
                run_round(input, number);
                number += 1;
            }
            growth.push(resident() - memory);
        }
        assert!(
            growth.iter().any(|&grown| grown < MAX_GROWTH),
            "memory grows by {growth:.1?} MB in periods of {FRAMES} frames"
        );
    });
}
