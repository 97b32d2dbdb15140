//! Separation of the input to the panels from the input to the scene.

use std::path::PathBuf;

use mujoco_safe::{Data, sample};

use crate::display::Screen;
use crate::harness::{SIZE, press, settle, show, state};
use crate::input::wait_until;

pub fn panels() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    show(Data::new(sample::cartpole()).unwrap(), |input| {
        let [width, height] = SIZE.map(|pixels| pixels as i32);
        // The panel covers the scene.
        let right = [width as usize - 4, height as usize / 2];
        let before = Screen::read(&framebuffer).pixel(right);
        press(input, "ctrl+2", "the right panel is open", |state| state.panels[3]);
        wait_until("the panel is drawn", || Screen::read(&framebuffer).pixel(right) != before);

        // A panel receives the mouse events over it.
        let camera = state().camera;
        let on_panel = [width - 140, height / 2];
        input.drag(on_panel, [30, 0], 1, &[]);
        input.click(on_panel, 4, 1);
        settle(input);
        assert_eq!(state().camera, camera, "a drag on a panel does not move the camera");

        // The slider of the only actuator sets its control.
        let [rail, text_field] =
            state().sliders.first().copied().expect("the controls panel has a slider").map(|at| at.map(|at| at as i32));
        input.drag(rail, [25, 0], 1, &[]);
        wait_until("the slider sets the control", || state().ctrl[0] != 0.0);

        // Keys in a text field have no bindings.
        let before = state();
        input.click(text_field, 1, 1);
        wait_until("the text field is edited", || state().editing);
        input.write("0.25");
        input.key("Return");
        wait_until("the text field sets the control", || state().ctrl[0] == 0.25 && !state().editing);
        let now = state();
        assert_eq!((now.options, now.target_speed), (before.options, before.target_speed));

        // A drag that starts over the scene belongs to the scene until its end.
        let camera = state().camera;
        input.drag([60, rail[1]], [rail[0] - 60 + 20, 0], 1, &[]);
        wait_until("the camera rotates", || state().camera.azimuth != camera.azimuth);
        settle(input);
        assert_eq!(state().ctrl[0], 0.25);
        press(input, "ctrl+2", "the right panel is closed", |state| !state.panels[3]);
    });
}
