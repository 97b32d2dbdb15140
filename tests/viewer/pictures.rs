//! Pictures of the panels for visual inspection.

use std::path::{Path, PathBuf};

use mujoco_safe::viewer::{Viewer, ViewerOptions, test_hooks};
use mujoco_safe::{Data, PdController, Trajectory, sample};

use crate::display::Screen;
use crate::harness::{exit_on_panic, press, settle, state, unique_title};
use crate::input::{Input, wait_until};

const SIZE: [u32; 2] = [1280, 720];

pub fn draw(directory: &Path) {
    std::fs::create_dir_all(directory).unwrap();
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    let mut controller = PdController::new(data.model(), 5.0, 0.5);
    trajectory.record(&mut data, &mut controller, 400).unwrap();
    data.reset().unwrap();
    test_hooks::start();
    let title = unique_title();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                wait_until("it is drawn", || test_hooks::latest().is_some());
                let input = Input::at(&title);
                let shoot = |name: &str| {
                    let frame = state().frame;
                    input.move_to([640, 20]);
                    input.keys(&["F24"]);
                    wait_until("another frame", || state().frame > frame);
                    std::thread::sleep(std::time::Duration::from_millis(300));
                    Screen::read(&framebuffer).save(&directory.join(format!("{name}.png")), SIZE);
                };
                shoot("start");
                press(&input, "F1", "help", |state| state.panels[0]);
                shoot("help");
                press(&input, "F1", "no help", |state| !state.panels[0]);
                press(&input, "ctrl+1", "left", |state| state.panels[2]);
                press(&input, "ctrl+2", "right", |state| state.panels[3]);
                press(&input, "space", "running", |state| state.time > 0.4);
                shoot("panels");
                press(&input, "F3", "profile", |state| state.panels[4]);
                press(&input, "F4", "sensors", |state| state.panels[5]);
                wait_until("it runs for a while", || state().time > 2.0);
                shoot("plots");
                press(&input, "space", "paused", |state| state.status == "Paused");
                // Opens the sections from the bottom up, so that the upper headings keep their positions.
                for section in [617, 594, 571, 548, 207, 184] {
                    input.click([40, section], 1, 1);
                    settle(&input);
                    settle(&input);
                }
                shoot("sections");
                input.click([100, 400], 5, 30);
                shoot("sections_below");
                input.click([1100, 400], 5, 30);
                shoot("joints");
                press(&input, "F3", "no profile", |state| !state.panels[4]);
                press(&input, "F4", "no sensors", |state| !state.panels[5]);

                press(&input, "ctrl+Right", "trajectory", |state| state.mode == "Trajectory");
                press(&input, "ctrl+b", "burst", |state| state.playback_flags[1]);
                input.double_click([640, 380], 1);
                press(&input, "ctrl+p", "saved", |state| !state.messages.is_empty());
                shoot("trajectory");
                input.key("Escape");
            });
        });
        let options = ViewerOptions { screenshots: directory.join("screenshot.png"), ..ViewerOptions::default() };
        let viewer = Viewer::new().options(options).title(&*title).size(SIZE);
        viewer.controller(controller).trajectories([trajectory]).run(data).expect("a window");
    });
}
