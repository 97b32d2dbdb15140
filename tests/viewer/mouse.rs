//! Mouse gestures.

use mujoco_safe::scene::CameraView;
use mujoco_safe::viewer::test_hooks::WindowState;
use mujoco_safe::{Data, Model};

use crate::harness::{SIZE, double_click, press, settle, show, state};
use crate::input::{Input, wait_until};

/// Box that floats in front of the camera, in the centre of the window.
pub const FLOATING: &str = r#"
<mujoco>
  <option gravity="0 0 0"/>
  <statistic center="0 0 1" extent="1"/>
  <worldbody>
    <light pos="0 0 3"/>
    <geom type="plane" size="2 2 .1"/>
    <body name="outer" pos="0 0 1">
      <freejoint/>
      <geom type="box" size=".2 .2 .2" mass="1"/>
      <body name="inner">
        <geom type="sphere" size=".35" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>"#;

pub const MIDDLE: [i32; 2] = [SIZE[0] as i32 / 2, SIZE[1] as i32 / 2];

pub fn gestures() {
    let mut data = Data::new(Model::from_xml_str(FLOATING).unwrap()).unwrap();
    data.forward().unwrap();
    show(data, |input| {
        camera(input);
        selection(input);
        paused(input);
        running(input);
    });
}

fn camera(input: &Input) {
    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [60, 40], 1, &[]);
    wait_until("a left drag rotates the camera", || {
        let camera = state().camera;
        camera.azimuth != before.azimuth && camera.elevation != before.elevation
    });
    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [60, 0], 1, &["shift"]);
    wait_until("a left drag with Shift rotates the camera", || state().camera.azimuth != before.azimuth);

    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [0, 40], 3, &[]);
    wait_until("a right drag moves the camera vertically", || state().camera.lookat[2] != before.lookat[2]);
    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [40, 40], 3, &["shift"]);
    wait_until("a right drag with Shift moves the camera horizontally", || {
        state().camera.lookat[..2] != before.lookat[..2]
    });
    settle(input);
    assert!((state().camera.lookat[2] - before.lookat[2]).abs() < 1e-6, "the height is unchanged");

    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [0, 50], 2, &[]);
    wait_until("a middle drag zooms", || state().camera.distance != before.distance);
    settle(input);
    let before = state().camera;
    input.drag(MIDDLE, [0, 50], 2, &["shift"]);
    wait_until("a middle drag with Shift zooms", || state().camera.distance != before.distance);
    settle(input);
    let before = state().camera.distance;
    input.click(MIDDLE, 4, 1);
    wait_until("the wheel zooms", || state().camera.distance != before);
    let far = state().camera.distance;
    input.click(MIDDLE, 5, 2);
    wait_until("the wheel zooms back", || (state().camera.distance < far) == (before < far));
    press(input, "ctrl+a", "the camera is reset", |state| state.camera.lookat == [0.0, 0.0, 1.0]);
}

fn selection(input: &Input) {
    let is_selected = |index: usize| move |state: &WindowState| state.selected.is_some_and(|(body, _)| body == index);
    double_click(input, MIDDLE, 1, "a double-click selects a body", is_selected(2));
    press(input, "Page_Up", "the parent is selected", is_selected(1));
    double_click(input, [5, 5], 1, "a double-click on the background unselects", |state| state.selected.is_none());

    settle(input);
    let before = state().camera.lookat;
    double_click(input, [MIDDLE[0] + 30, MIDDLE[1]], 3, "a right double-click moves the look-at point", |state| {
        state.camera.lookat != before
    });
    press(input, "ctrl+a", "the camera is reset", |state| state.camera.lookat == [0.0, 0.0, 1.0]);

    input.press(MIDDLE, 1, &[]);
    input.release(1, &[]);
    input.hold(&["ctrl"]);
    double_click(input, MIDDLE, 3, "a right double-click with Ctrl tracks the body", |state| {
        matches!(state.camera.view, CameraView::Tracking(_))
    });
    input.release_modifiers(&["ctrl"]);
    press(input, "ctrl+a", "the camera is free", |state| state.camera.view == CameraView::Free);
    double_click(input, MIDDLE, 1, "the body is selected again", |state| state.selected.is_some());
    press(input, "Page_Up", "the floating body is selected", is_selected(1));
}

/// Checks that a drag moves and rotates a body while paused.
fn paused(input: &Input) {
    settle(input);
    let before = state().qpos;
    input.press(MIDDLE, 3, &["ctrl"]);
    input.move_by([40, 20]);
    wait_until("a right drag with Ctrl moves the body", || state().qpos[..3] != before[..3]);
    wait_until("the snapshot shows the drag", || state().selected.is_some_and(|(_, active)| active));
    input.release(3, &["ctrl"]);
    wait_until("the body is released", || state().selected.is_some_and(|(_, active)| !active));
    settle(input);
    let before = state().qpos;
    input.drag(MIDDLE, [40, 20], 1, &["ctrl"]);
    wait_until("a left drag with Ctrl rotates the body", || state().qpos[3..] != before[3..]);
    settle(input);
    let before = state().qpos;
    input.drag(MIDDLE, [40, 20], 3, &["ctrl", "shift"]);
    wait_until("a right drag with Ctrl and Shift moves the body horizontally", || state().qpos[..2] != before[..2]);
    settle(input);
    assert!((state().qpos[2] - before[2]).abs() < 1e-6, "the height is unchanged");
    let before = state().qpos;
    input.drag(MIDDLE, [40, 0], 1, &["ctrl", "shift"]);
    wait_until("a left drag with Ctrl and Shift rotates the body", || state().qpos[3..] != before[3..]);
    assert_eq!(state().time, 0.0);
}

/// Checks that a drag applies forces and torques to a body while running.
fn running(input: &Input) {
    press(input, "BackSpace", "the start state is restored", |state| state.qpos[0] == 0.0);
    press(input, "space", "the simulation runs", |state| state.time > 0.0);
    input.press(MIDDLE, 3, &["ctrl"]);
    input.move_by([40, 0]);
    wait_until("a force is applied", || state().force[..3].iter().any(|force| *force != 0.0));
    wait_until("the body moves", || state().qpos[0].abs() + state().qpos[1].abs() > 1e-3);
    input.release(3, &["ctrl"]);
    wait_until("the body is released", || state().force == [0.0; 6]);
    input.press(MIDDLE, 1, &["ctrl"]);
    input.move_by([40, 0]);
    wait_until("a torque is applied", || state().force[3..].iter().any(|torque| *torque != 0.0));
    input.release(1, &["ctrl"]);
    wait_until("the body is released", || state().force == [0.0; 6]);
}
