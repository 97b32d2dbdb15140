//! Memory over many frames.

use std::fs;

use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Model};

use crate::case::{press, show, state};
use crate::hand::{Hand, wait_until};

/// Frames in a period, drawn in rounds of 25 and a few more.
const FRAMES: u64 = 400;
/// The most periods.
const PERIODS: usize = 4;
/// More than this, in MB, is a leak: a frame of the smallest size has 0.1 MB, and the texture of a model 3 MB.
const MOST: f64 = 20.0;

/// What of this process is in memory, MB.
fn resident() -> f64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("its memory");
    line.split_whitespace().nth(1).and_then(|size| size.parse::<f64>().ok()).expect("a number") / 1024.0
}

/// Sizes, model and mode change once each.
fn round(hand: &Hand, number: u32) {
    let size = [200 + 40 * (number % 4), 160 + 30 * (number % 3)];
    hand.resize(size);
    wait_until("another size", || state().size == size);
    let generation = state().generation;
    press(hand, "ctrl+l", "the model is loaded again", |state| {
        state.generation > generation && state.mode == "Controller"
    });
    if state().status == "Paused" {
        press(hand, "space", "it runs", |state| state.status == "Forward Simulation");
    }
    let frame = state().frame;
    wait_until("it is drawn for a while", || state().frame > frame + 25);
    press(hand, "ctrl+Right", "another mode", |state| state.mode == "Passive Dynamics");
    press(hand, "ctrl+Left", "and back", |state| state.mode == "Controller");
    press(hand, "ctrl+1", "panels", |state| state.panels[2]);
    press(hand, "ctrl+1", "and none", |state| !state.panels[2]);
}

pub fn nothing_leaks() {
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
    let options = ViewerOptions { file: Some(file), ..ViewerOptions::default() };
    show(Viewer::new().options(options).controller(controller), data, |hand| {
        // Caches fill, drivers compile.
        (0..6).for_each(|number| round(hand, number));
        // A leak grows in every period; allocators and drivers keep memory in one or the other.
        let mut growth = Vec::new();
        while growth.len() < PERIODS && growth.iter().all(|&grown| grown >= MOST) {
            let (memory, frame) = (resident(), state().frame);
            let mut number = 0;
            while state().frame < frame + FRAMES {
                round(hand, number);
                number += 1;
            }
            growth.push(resident() - memory);
        }
        assert!(growth.iter().any(|&grown| grown < MOST), "{growth:.1?} MB more in periods of {FRAMES} frames");
    });
}
