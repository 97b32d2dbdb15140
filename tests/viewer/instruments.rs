//! Instruments of a controller: plots, sliders of its parameters, and its drawings in the scene.

use mujoco_safe::viewer::{Instruments, Viewer, ViewerOptions};
use mujoco_safe::{Controller, Data, Result, sample};

use crate::display::Screen;
use crate::harness::{press, settle, show_window, state};
use crate::input::wait_until;

const SIZE: [u32; 2] = [640, 400];

/// Sets the only control to a constant force.
struct Push {
    force: f64,
}

impl Controller for Push {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut()[0] = self.force;
        Ok(())
    }
}

/// Colour of the path. Nothing else in the scene has it.
const GREEN: [f32; 4] = [0.0, 1.0, 0.0, 1.0];

fn declare(push: &mut Push, data: &Data, instruments: &mut Instruments) {
    instruments.value("cart", "position", data.qpos()[0]);
    instruments.value("cart", "speed", data.qvel()[0]);
    instruments.value("control", "force", push.force);
    instruments.parameter("force", &mut push.force, -1.0..=1.0);
    instruments.path((-5..=5).map(|point| [0.1 * f64::from(point), 0.0, -0.3]), 0.05, GREEN);
}

/// Returns a viewer whose controller has instruments.
pub fn viewer(force: f64) -> Viewer {
    Viewer::new().with_instrumented_controller(Push { force }, declare)
}

/// Returns the number of green pixels in the picture.
fn green_pixels() -> usize {
    let screen = Screen::read(std::env::var_os("FRAMEBUFFER").expect("set by this test").as_ref());
    let [[left, _], [width, height]] = state().picture.map(|part| part.map(|pixels| pixels as usize));
    let pixels = (0..height).flat_map(|y| (left..left + width).map(move |x| [x, y]));
    let is_green = |[red, green, blue]: [u8; 3]| green > 100 && red < green / 2 && blue < green / 2;
    pixels.filter(|&at| is_green(screen.pixel(at))).count()
}

pub fn instruments() {
    let data = Data::new(sample::cartpole()).unwrap();
    show_window(SIZE, ViewerOptions::default(), viewer(0.0), data, |input| {
        let plots = [("cart", ["position", "speed"].as_slice()), ("control", ["force"].as_slice())];
        let expected: Vec<(String, Vec<String>)> = plots
            .into_iter()
            .map(|(title, names)| (title.to_owned(), names.iter().map(|&name| name.to_owned()).collect()))
            .collect();
        wait_until("the plots are shown", || state().plots == expected);
        assert_eq!(state().parameters, [("force".to_owned(), 0.0)]);
        let [[left, _], [width, _]] = state().picture;
        assert!(left == 0 && width < SIZE[0], "the instruments are beside the picture");
        wait_until("the path is in the picture", || green_pixels() > 50);

        // The slider changes the force, which the next step applies. The first frames move it.
        let mut before = Vec::new();
        wait_until("the slider stays in one place", || {
            settle(input);
            let now = state().sliders;
            !now.is_empty() && std::mem::replace(&mut before, now.clone()) == now
        });
        let [rail, text] = state().sliders.first().copied().expect("a slider").map(|at| at.map(|part| part as i32));
        input.drag(rail, [30, 0], 1, &[]);
        wait_until("the slider changes the parameter", || state().parameters[0].1 > 0.1);
        settle(input);
        let force = state().parameters[0].1;
        assert_eq!(state().ctrl, [0.0], "the simulation is paused");
        press(input, "Right", "a step is taken", |state| state.time > 0.0);
        assert_eq!(state().ctrl, [force]);

        // While the simulation runs, a number in the text field acts too.
        press(input, "space", "the simulation runs", |state| state.status == "Forward Simulation");
        input.click(text, 1, 1);
        wait_until("the text field is edited", || state().editing);
        input.key("ctrl+a");
        input.write("0.25");
        input.key("Return");
        wait_until("the controller uses the number", || state().ctrl == [0.25]);
        wait_until("the text field is closed", || !state().editing);

        press(input, "shift+F3", "the instruments are hidden", |state| {
            !state.panels[6] && state.plots.is_empty() && state.picture[1][0] == SIZE[0]
        });
        press(input, "shift+F3", "the instruments are shown", |state| state.panels[6] && !state.plots.is_empty());
        press(input, "ctrl+Right", "the passive mode has no instruments", |state| {
            state.mode == "Passive Dynamics" && state.plots.is_empty() && state.parameters.is_empty()
        });
        wait_until("the path is gone", || green_pixels() == 0);
    });
}
