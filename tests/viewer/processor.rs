//! Processor time of the window, printed for comparison between versions.

use std::time::Instant;

use mujoco_safe::viewer::{Viewer, ViewerOptions, test_hooks};
use mujoco_safe::{Data, sample};

use crate::errors::processor_time;
use crate::harness::{exit_on_panic, press, settle, state, unique_title};
use crate::input::{Input, wait_until};

const SIZE: [u32; 2] = [1066, 666];

/// Prints the processor time of this process and the frames, both per second, in several situations.
pub fn measure() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    test_hooks::start();
    let title = unique_title();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                wait_until("the window is drawn", || test_hooks::latest().is_some());
                let input = Input::at(&title);
                let wait = || std::thread::sleep(std::time::Duration::from_secs(4));
                // A hundred positions per second, as of a usual mouse.
                let circle = |center: [f64; 2], radius: f64| {
                    let point = move |step: i32| {
                        let (sin, cos) = (f64::from(step) / 15.0).sin_cos();
                        [center[0] + radius * cos, center[1] + radius * sin].map(|part| part as i32)
                    };
                    input.move_along((0..400).map(point), 0.01);
                };
                let over_scene = || circle([530.0, 330.0], 150.0);
                let over_panel = || circle([150.0, 330.0], 120.0);
                settle(&input);
                wait();
                println!("{:40} {:>9} {:>9} {:>9} {:>9}", "", "core, %", "frames/s", "passes/s", "ms/frame");
                report("paused", wait);
                report("paused, pointer over the scene", over_scene);
                press(&input, "ctrl+1", "the left panel is open", |state| state.panels[2]);
                press(&input, "ctrl+2", "the right panel is open", |state| state.panels[3]);
                report("paused, panels", wait);
                report("paused, panels, pointer over the scene", over_scene);
                report("paused, panels, pointer over a panel", over_panel);
                press(&input, "space", "the simulation runs", |state| state.time > 0.0);
                report("running, panels", wait);
                press(&input, "ctrl+1", "the left panel is closed", |state| !state.panels[2]);
                press(&input, "ctrl+2", "the right panel is closed", |state| !state.panels[3]);
                report("running", wait);
                report("running, pointer over the scene", over_scene);
                press(&input, "Return", "slow motion", |state| state.target_speed < 1.0);
                report("running at a tenth of real time", wait);
                input.key("ctrl+q");
            });
        });
        let options = ViewerOptions::default().with_title(&*title).with_size(SIZE);
        Viewer::new().options(options).run(data).expect("the window opens");
    });
}

/// Prints the processor time, the frames and the passes of the panels during an activity, per second, and the processor time per frame.
fn report(name: &str, act: impl Fn()) {
    let counts = || (test_hooks::passes(), state().frame);
    let (start, used, (passes, frames)) = (Instant::now(), processor_time(), counts());
    act();
    let (seconds, used) = (start.elapsed().as_secs_f64(), processor_time() - used);
    let (passes, frames) = ((counts().0 - passes) as f64, (counts().1 - frames) as f64);
    println!(
        "{name:40} {:9.1} {:9.1} {:9.1} {:9.1}",
        100.0 * used / seconds,
        frames / seconds,
        passes / seconds,
        1e3 * used / frames
    );
}
