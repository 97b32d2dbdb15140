//! Gestures that come while a frame is drawn: the window processes them late and all at once.

use std::thread;
use std::time::Duration;

use mujoco_safe::viewer::{Viewer, probe};
use mujoco_safe::{Data, Model, sample};

use crate::case::{mark, press, settle, show, state};
use crate::hand::{Hand, wait_until};
use crate::mouse::{FLOATING, MIDDLE};

/// Acts while the window draws a frame that takes longer than a double-click may.
pub fn during_a_frame(hand: &Hand, act: impl FnOnce()) {
    settle(hand);
    probe::hold();
    mark(hand);
    wait_until("a frame begins", probe::is_held);
    act();
    thread::sleep(Duration::from_millis(400));
    probe::release();
}

pub fn gestures() {
    picture();
    panels();
}

fn picture() {
    let mut data = Data::new(Model::from_xml_str(FLOATING).unwrap()).unwrap();
    data.forward().unwrap();
    show(Viewer::new(), data, |hand| {
        press(hand, "F2", "the whole picture", |state| !state.panels[1]);
        settle(hand);
        // The second click comes during the frame that the first one leads to.
        probe::hold();
        hand.click(MIDDLE, 1, 1);
        wait_until("a frame begins", probe::is_held);
        hand.click(MIDDLE, 1, 1);
        thread::sleep(Duration::from_millis(400));
        probe::release();
        wait_until("a double-click selects", || state().selected.is_some());
        during_a_frame(hand, || hand.double_click([5, 5], 1));
        wait_until("a double-click on nothing unselects", || state().selected.is_none());

        // The window has no answer to the double-click when the drag begins.
        settle(hand);
        let before = state();
        during_a_frame(hand, || {
            hand.double_click(MIDDLE, 1);
            hand.key("Page_Up");
            hand.drag(MIDDLE, [40, 20], 3, &["ctrl"]);
        });
        wait_until("a body is selected and moved", || state().qpos[..3] != before.qpos[..3]);
        settle(hand);
        assert_eq!(state().camera, before.camera);
        assert!(state().selected.is_some_and(|(body, active)| body == 1 && !active));
    });
}

fn panels() {
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |hand| {
        press(hand, "ctrl+2", "a panel at the right", |state| state.panels[3]);
        let mut before = Vec::new();
        wait_until("the panel has found its size", || {
            let last = std::mem::replace(&mut before, state().sliders);
            settle(hand);
            last == before && !before.is_empty()
        });
        let [rail, number] = state().sliders[0].map(|at| at.map(|at| at as i32));
        during_a_frame(hand, || hand.drag(rail, [25, 0], 1, &[]));
        wait_until("the slider sets the control", || state().ctrl[0] != 0.0);

        let before = state();
        during_a_frame(hand, || {
            hand.click(number, 1, 1);
            hand.write("0.25");
            hand.key("Return");
        });
        wait_until("the number sets it", || state().ctrl[0] == 0.25 && !state().editing);
        let now = state();
        assert_eq!((now.options, now.wanted), (before.options, before.wanted), "its keys are no commands");

        // A drag from the picture to the slider belongs to the picture, even if the pointer is over the slider before the panels
        // hear of the press.
        during_a_frame(hand, || {
            hand.press([60, rail[1]], 1, &[]);
            hand.pull([rail[0] - 60 + 20, 0]);
        });
        settle(hand);
        hand.release(1, &[]);
        wait_until("the camera turns", || state().camera.azimuth != before.camera.azimuth);
        settle(hand);
        assert_eq!(state().ctrl[0], 0.25, "the slider stays");
    });
}
