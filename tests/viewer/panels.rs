//! The panels: what is done in them is done, and what is done in the picture is not done to them.

use std::path::PathBuf;

use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, sample};

use crate::case::{SIZE, press, settle, show, state};
use crate::display::Screen;
use crate::hand::wait_until;

pub fn panels() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |hand| {
        let [width, height] = SIZE.map(|pixels| pixels as i32);
        // A panel is seen where the picture was.
        let right = [width as usize - 4, height as usize / 2];
        let before = Screen::look(&framebuffer).pixel(right);
        press(hand, "ctrl+2", "a panel at the right", |state| state.panels[3]);
        wait_until("its ground is seen", || Screen::look(&framebuffer).pixel(right) != before);

        // The pointer over a panel belongs to it.
        let camera = state().camera;
        let on_panel = [width - 140, height / 2];
        hand.drag(on_panel, [30, 0], 1, &[]);
        hand.click(on_panel, 4, 1);
        settle(hand);
        assert_eq!(state().camera, camera, "a drag on a panel does not move the camera");

        // A slider moves a control: that of the only actuator.
        let [rail, number] = state().sliders.first().copied().expect("a slider").map(|at| at.map(|at| at as i32));
        hand.drag(rail, [25, 0], 1, &[]);
        wait_until("the slider sets the control", || state().ctrl[0] != 0.0);

        // A number is typed; its keys are no commands.
        let before = state();
        hand.click(number, 1, 1);
        wait_until("the number is edited", || state().editing);
        hand.write("0.25");
        hand.key("Return");
        wait_until("it is set", || state().ctrl[0] == 0.25 && !state().editing);
        let now = state();
        assert_eq!((now.options, now.wanted), (before.options, before.wanted));

        // A drag that began in the picture stays there, wherever it goes.
        let camera = state().camera;
        hand.drag([60, rail[1]], [rail[0] - 60 + 20, 0], 1, &[]);
        wait_until("the camera turns", || state().camera.azimuth != camera.azimuth);
        settle(hand);
        assert_eq!(state().ctrl[0], 0.25);
        press(hand, "ctrl+2", "no panel at the right", |state| !state.panels[3]);
    });
}
