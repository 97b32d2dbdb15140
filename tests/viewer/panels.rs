//! Separation of the input of the panels and of the picture.

use std::path::PathBuf;

use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, sample};

use crate::display::Screen;
use crate::harness::{SIZE, press, settle, show, state};
use crate::input::wait_until;

pub fn panels() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    show(Viewer::new(), Data::new(sample::cartpole()).unwrap(), |input| {
        let [width, height] = SIZE.map(|pixels| pixels as i32);
        // The panel covers the picture.
        let right = [width as usize - 4, height as usize / 2];
        let before = Screen::read(&framebuffer).pixel(right);
        press(input, "ctrl+2", "a panel at the right", |state| state.panels[3]);
        wait_until("its ground is seen", || Screen::read(&framebuffer).pixel(right) != before);

        // Over a panel, the pointer belongs to the panel.
        let camera = state().camera;
        let on_panel = [width - 140, height / 2];
        input.drag(on_panel, [30, 0], 1, &[]);
        input.click(on_panel, 4, 1);
        settle(input);
        assert_eq!(state().camera, camera, "a drag on a panel does not move the camera");

        // The slider of the only actuator sets its control.
        let [rail, number] = state().sliders.first().copied().expect("a slider").map(|at| at.map(|at| at as i32));
        input.drag(rail, [25, 0], 1, &[]);
        wait_until("the slider sets the control", || state().ctrl[0] != 0.0);

        // Keys in a text field have no bindings.
        let before = state();
        input.click(number, 1, 1);
        wait_until("the number is edited", || state().editing);
        input.write("0.25");
        input.key("Return");
        wait_until("it is set", || state().ctrl[0] == 0.25 && !state().editing);
        let now = state();
        assert_eq!((now.options, now.target_speed), (before.options, before.target_speed));

        // A drag that starts in the picture belongs to the picture until its end.
        let camera = state().camera;
        input.drag([60, rail[1]], [rail[0] - 60 + 20, 0], 1, &[]);
        wait_until("the camera turns", || state().camera.azimuth != camera.azimuth);
        settle(input);
        assert_eq!(state().ctrl[0], 0.25);
        press(input, "ctrl+2", "no panel at the right", |state| !state.panels[3]);
    });
}
