//! Frames of the window, and its processor time, which is printed for comparison between versions.

use std::time::Instant;

use mujoco_safe::viewer::{Viewer, ViewerOptions, test_hooks};
use mujoco_safe::{Data, Model, sample};

use crate::errors::processor_time;
use crate::harness::{exit_on_panic, press, settle, show, state, unique_title};
use crate::input::{Input, wait_until};

const SIZE: [u32; 2] = [1066, 666];

/// Checks that a window is not drawn more often than the state changes or than the display shows,
/// and not for a motion of the pointer over the scene.
pub fn frames() {
    let text = r#"<mujoco><option timestep="0.25"/><worldbody><light pos="0 0 3"/>
        <body><joint/><geom type="box" size=".1 .2 .3"/></body></worldbody></mujoco>"#;
    show(Data::new(Model::from_xml_str(text).unwrap()).unwrap(), |input| {
        press(input, "space", "the simulation runs", |state| state.time > 1.0);
        let first = state();
        wait_until("ten steps are taken", || state().time >= first.time + 2.5);
        let last = state();
        let steps = (4.0 * (last.time - first.time)).round();
        let frames = (last.frame - first.frame) as f64;
        assert!(frames <= steps + 2.0, "{frames} frames for {steps} steps");
        assert!((last.scenes - first.scenes) as f64 <= steps, "{} images of the scene", last.scenes - first.scenes);

        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        let mut frame = state().frame;
        wait_until("no frame is drawn for a second", || {
            let last = std::mem::replace(&mut frame, state().frame);
            std::thread::sleep(std::time::Duration::from_secs(1));
            last == state().frame
        });
        input.move_along((0..80).map(|step| [200 + step, 100 + step]), 0.02);
        std::thread::sleep(std::time::Duration::from_millis(500));
        assert_eq!(state().frame, frame, "no frame is drawn while the pointer moves over the scene");
    });
    // This simulation has far more steps per second than the display has frames.
    show(Data::new(sample::cartpole()).unwrap(), |input| {
        press(input, "space", "the simulation runs", |state| state.time > 0.1);
        let (frame, start) = (state().frame, Instant::now());
        std::thread::sleep(std::time::Duration::from_secs(2));
        let (frames, seconds) = ((state().frame - frame) as f64, start.elapsed().as_secs_f64());
        assert!(frames <= 60.5 * seconds + 2.0, "{frames} frames in {seconds} s");
    });
}

/// Prints the processor time of this process and the frames, both per second, in several
/// situations.
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
                press(&input, "F3", "the profile is open", |state| state.panels[4]);
                press(&input, "F4", "the sensor plot is open", |state| state.panels[5]);
                report("running, panels and plots", wait);
                press(&input, "F3", "the profile is closed", |state| !state.panels[4]);
                press(&input, "F4", "the sensor plot is closed", |state| !state.panels[5]);
                press(&input, "ctrl+1", "the left panel is closed", |state| !state.panels[2]);
                press(&input, "ctrl+2", "the right panel is closed", |state| !state.panels[3]);
                report("running", wait);
                report("running, pointer over the scene", over_scene);
                press(&input, "Return", "slow motion", |state| state.target_speed < 1.0);
                report("running at a tenth of real time", wait);
                input.key("ctrl+q");
            });
        });
        let options = ViewerOptions::default()
            .with_title(&*title)
            .with_size(SIZE.map(|pixels| pixels as usize))
            .with_panels(false);
        Viewer::new().with_options(options).run(data).expect("the window opens");
    });
}

/// Prints the processor time, the frames and the passes of the panels during an activity, per
/// second, and the processor time per frame.
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
