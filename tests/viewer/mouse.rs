//! Every gesture of the mouse.

use mujoco_safe::scene::CameraView;
use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Model};

use crate::case::{SIZE, press, settle, show, state};
use crate::hand::{Hand, wait_until};

/// A box that floats before the camera, so that the middle of the window is on it.
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
    show(Viewer::new(), data, |hand| {
        // Without the info panel nothing lies over the picture.
        press(hand, "F2", "the whole picture", |state| !state.panels[1]);
        camera(hand);
        selection(hand);
        paused(hand);
        running(hand);
    });
}

fn camera(hand: &Hand) {
    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [60, 40], 1, &[]);
    wait_until("a left drag turns", || {
        let camera = state().camera;
        camera.azimuth != before.azimuth && camera.elevation != before.elevation
    });
    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [60, 0], 1, &["shift"]);
    wait_until("a left drag with Shift turns it too", || state().camera.azimuth != before.azimuth);

    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [0, 40], 3, &[]);
    wait_until("a right drag moves up and down", || state().camera.lookat[2] != before.lookat[2]);
    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [40, 40], 3, &["shift"]);
    wait_until("a right drag with Shift moves over the ground", || state().camera.lookat[..2] != before.lookat[..2]);
    settle(hand);
    assert!((state().camera.lookat[2] - before.lookat[2]).abs() < 1e-6, "and only there");

    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [0, 50], 2, &[]);
    wait_until("a middle drag zooms", || state().camera.distance != before.distance);
    settle(hand);
    let before = state().camera;
    hand.drag(MIDDLE, [0, 50], 2, &["shift"]);
    wait_until("and so it does with Shift", || state().camera.distance != before.distance);
    settle(hand);
    let before = state().camera.distance;
    hand.click(MIDDLE, 4, 1);
    wait_until("the wheel zooms", || state().camera.distance != before);
    let far = state().camera.distance;
    hand.click(MIDDLE, 5, 2);
    wait_until("the wheel zooms back", || (state().camera.distance < far) == (before < far));
    press(hand, "ctrl+a", "from the start", |state| state.camera.lookat == [0.0, 0.0, 1.0]);
}

fn selection(hand: &Hand) {
    hand.double_click(MIDDLE, 1);
    wait_until("a double-click selects", || state().selected.is_some_and(|(body, _)| body == 2));
    press(hand, "Page_Up", "the parent", |state| state.selected.is_some_and(|(body, _)| body == 1));
    hand.double_click([5, 5], 1);
    wait_until("a double-click on nothing unselects", || state().selected.is_none());

    settle(hand);
    let before = state().camera.lookat;
    hand.double_click([MIDDLE[0] + 30, MIDDLE[1]], 3);
    wait_until("a right double-click looks there", || state().camera.lookat != before);
    press(hand, "ctrl+a", "from the start", |state| state.camera.lookat == [0.0, 0.0, 1.0]);

    hand.press(MIDDLE, 1, &[]);
    hand.release(1, &[]);
    hand.hold(&["ctrl"]);
    hand.double_click(MIDDLE, 3);
    hand.let_go(&["ctrl"]);
    wait_until("with Ctrl it follows the body", || matches!(state().camera.view, CameraView::Tracking(_)));
    press(hand, "ctrl+a", "from the start", |state| state.camera.view == CameraView::Free);
    hand.double_click(MIDDLE, 1);
    wait_until("selected again", || state().selected.is_some());
    press(hand, "Page_Up", "the body that floats", |state| state.selected.is_some_and(|(body, _)| body == 1));
}

/// While paused a body is moved and turned where it is.
fn paused(hand: &Hand) {
    settle(hand);
    let before = state().qpos;
    hand.press(MIDDLE, 3, &["ctrl"]);
    hand.pull([40, 20]);
    wait_until("a right drag with Ctrl moves the body", || state().qpos[..3] != before[..3]);
    wait_until("which is seen", || state().selected.is_some_and(|(_, active)| active));
    hand.release(3, &["ctrl"]);
    wait_until("and let go", || state().selected.is_some_and(|(_, active)| !active));
    settle(hand);
    let before = state().qpos;
    hand.drag(MIDDLE, [40, 20], 1, &["ctrl"]);
    wait_until("a left drag with Ctrl turns it", || state().qpos[3..] != before[3..]);
    settle(hand);
    let before = state().qpos;
    hand.drag(MIDDLE, [40, 20], 3, &["ctrl", "shift"]);
    wait_until("a right drag with Ctrl and Shift moves it over the ground", || state().qpos[..2] != before[..2]);
    settle(hand);
    assert!((state().qpos[2] - before[2]).abs() < 1e-6, "and only there");
    let before = state().qpos;
    hand.drag(MIDDLE, [40, 0], 1, &["ctrl", "shift"]);
    wait_until("a left drag with Ctrl and Shift turns it", || state().qpos[3..] != before[3..]);
    assert_eq!(state().time, 0.0);
}

/// While it runs a body is pulled and turned by forces.
fn running(hand: &Hand) {
    press(hand, "BackSpace", "the start", |state| state.qpos[0] == 0.0);
    press(hand, "space", "it runs", |state| state.time > 0.0);
    hand.press(MIDDLE, 3, &["ctrl"]);
    hand.pull([40, 0]);
    wait_until("the body is pulled", || state().force[..3].iter().any(|force| *force != 0.0));
    wait_until("and follows", || state().qpos[0].abs() + state().qpos[1].abs() > 1e-3);
    hand.release(3, &["ctrl"]);
    wait_until("until it is let go", || state().force == [0.0; 6]);
    hand.press(MIDDLE, 1, &["ctrl"]);
    hand.pull([40, 0]);
    wait_until("the body is turned", || state().force[3..].iter().any(|torque| *torque != 0.0));
    hand.release(1, &["ctrl"]);
    wait_until("until it is let go", || state().force == [0.0; 6]);
}
