//! Pictures of the panels, to be looked at.

use std::path::{Path, PathBuf};

use mujoco_safe::viewer::{Viewer, ViewerOptions, probe};
use mujoco_safe::{Data, PdController, Trajectory, sample};

use crate::case::{fresh_title, or_exit, press, settle, state};
use crate::display::Screen;
use crate::hand::{Hand, wait_until};

const SIZE: [u32; 2] = [1280, 720];

pub fn draw(directory: &Path) {
    std::fs::create_dir_all(directory).unwrap();
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    let mut data = Data::new(sample::humanoid()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    let mut controller = PdController::new(data.model(), 5.0, 0.5);
    trajectory.record(&mut data, &mut controller, 400).unwrap();
    data.reset().unwrap();
    probe::start();
    let title = fresh_title();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            or_exit(|| {
                wait_until("it is drawn", || probe::latest().is_some());
                let hand = Hand::at(&title);
                let shoot = |name: &str| {
                    let frame = state().frame;
                    hand.move_to([640, 20]);
                    hand.keys(&["F24"]);
                    wait_until("another frame", || state().frame > frame);
                    std::thread::sleep(std::time::Duration::from_millis(300));
                    Screen::look(&framebuffer).save(&directory.join(format!("{name}.png")), SIZE);
                };
                shoot("start");
                press(&hand, "F1", "help", |state| state.panels[0]);
                shoot("help");
                press(&hand, "F1", "no help", |state| !state.panels[0]);
                press(&hand, "ctrl+1", "left", |state| state.panels[2]);
                press(&hand, "ctrl+2", "right", |state| state.panels[3]);
                press(&hand, "space", "running", |state| state.time > 0.4);
                shoot("panels");
                press(&hand, "F3", "profile", |state| state.panels[4]);
                press(&hand, "F4", "sensors", |state| state.panels[5]);
                wait_until("it runs for a while", || state().time > 2.0);
                shoot("plots");
                press(&hand, "space", "paused", |state| state.status == "Paused");
                // The sections, from below, so that those above stay where they are.
                for section in [617, 594, 571, 548, 207, 184] {
                    hand.click([40, section], 1, 1);
                    settle(&hand);
                    settle(&hand);
                }
                shoot("sections");
                hand.click([100, 400], 5, 30);
                shoot("sections_below");
                hand.click([1100, 400], 5, 30);
                shoot("joints");
                press(&hand, "F3", "no profile", |state| !state.panels[4]);
                press(&hand, "F4", "no sensors", |state| !state.panels[5]);
                // Close the first sections, open the others.
                press(&hand, "ctrl+Right", "trajectory", |state| state.mode == "Trajectory");
                press(&hand, "ctrl+b", "burst", |state| state.playing[1]);
                hand.double_click([640, 380], 1);
                press(&hand, "ctrl+p", "saved", |state| !state.messages.is_empty());
                shoot("trajectory");
                hand.key("Escape");
            });
        });
        let options = ViewerOptions { screenshots: directory.join("screenshot.png"), ..ViewerOptions::default() };
        let viewer = Viewer::new().options(options).title(&*title).size(SIZE);
        viewer.controller(controller).trajectories([trajectory]).run(data).expect("a window");
    });
}
