//! Gestures during a slow frame. The window processes their events late and all at once.

use std::thread;
use std::time::Duration;

use mujoco_safe::viewer::test_hooks;
use mujoco_safe::{Data, Model, sample};

use crate::harness::{press, press_marker, settle, show, show_sized, state};
use crate::input::{Input, wait_until};
use crate::mouse::{FLOATING, MIDDLE};
use crate::panels;

/// Performs input during a frame that takes longer than a double-click.
pub fn during_a_frame(input: &Input, act: impl FnOnce()) {
    settle(input);
    test_hooks::hold();
    press_marker(input);
    wait_until("a frame starts", test_hooks::is_held);
    act();
    thread::sleep(Duration::from_millis(400));
    test_hooks::release();
}

pub fn gestures() {
    scene();
    panels();
}

fn scene() {
    let mut data = Data::new(Model::from_xml_str(FLOATING).unwrap()).unwrap();
    data.forward().unwrap();
    show(data, |input| {
        settle(input);
        // The second click arrives during the frame that the first click causes.
        test_hooks::hold();
        input.click(MIDDLE, 1, 1);
        wait_until("a frame starts", test_hooks::is_held);
        input.click(MIDDLE, 1, 1);
        thread::sleep(Duration::from_millis(400));
        test_hooks::release();
        wait_until("a double-click selects a body", || state().selected.is_some());
        during_a_frame(input, || input.double_click([5, 5], 1));
        wait_until("a double-click on the background unselects", || state().selected.is_none());

        // The drag starts before the physics has processed the double-click.
        settle(input);
        let before = state();
        during_a_frame(input, || {
            input.double_click(MIDDLE, 1);
            input.key("Page_Up");
            input.drag(MIDDLE, [40, 20], 3, &["ctrl"]);
        });
        wait_until("a body is selected and moved", || state().qpos[..3] != before.qpos[..3]);
        settle(input);
        assert_eq!(state().camera, before.camera);
        assert!(state().selected.is_some_and(|(body, active)| body == 1 && !active));
    });
}

fn panels() {
    show_sized(panels::SIZE, Data::new(sample::cartpole()).unwrap(), |input| {
        press(input, "ctrl+2", "the right panel is open", |state| state.panels[3]);
        let mut before = Vec::new();
        wait_until("the panel has its final size", || {
            let last = std::mem::replace(&mut before, state().sliders);
            settle(input);
            last == before && !before.is_empty()
        });
        let [rail, text_field] = state().sliders[0].map(|at| at.map(|at| at as i32));
        during_a_frame(input, || input.drag(rail, [25, 0], 1, &[]));
        wait_until("the slider sets the control", || state().ctrl[0] != 0.0);

        let before = state();
        during_a_frame(input, || {
            input.click(text_field, 1, 1);
            input.write("0.25");
            input.key("Return");
        });
        wait_until("the text field sets the control", || state().ctrl[0] == 0.25 && !state().editing);
        let now = state();
        assert_eq!(
            (now.options, now.target_speed),
            (before.options, before.target_speed),
            "keys in a text field have no bindings"
        );

        // A drag from the scene to the slider belongs to the scene, even if the pointer is over the
        // slider before the panels process the press.
        during_a_frame(input, || {
            input.press([60, rail[1]], 1, &[]);
            input.move_by([rail[0] - 60 + 20, 0]);
        });
        settle(input);
        input.release(1, &[]);
        wait_until("the camera rotates", || state().camera.azimuth != before.camera.azimuth);
        settle(input);
        assert_eq!(state().ctrl[0], 0.25, "the slider is unchanged");
    });
}
