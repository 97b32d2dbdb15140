//! Screenshots of the panels for visual inspection.

use std::path::{Path, PathBuf};

use mujoco_safe::viewer::{Theme, Viewer, ViewerOptions, test_hooks};
use mujoco_safe::{Data, PdController, Trajectory, sample};

use crate::display::Screen;
use crate::harness::{exit_on_panic, press, settle, show_window, state, unique_title};
use crate::input::{Input, wait_until};
use crate::instruments;

const SIZE: [u32; 2] = [1280, 720];

pub fn draw(directory: &Path) {
    std::fs::create_dir_all(directory).unwrap();
    draw_light(directory);
    draw_appearance(directory);
    draw_instruments(directory);
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
                wait_until("the window is drawn", || test_hooks::latest().is_some());
                let input = Input::at(&title);
                let save = |name: &str| {
                    let frame = state().frame;
                    input.move_to([state().size[0] as i32 / 2, 20]);
                    input.keys(&["F24"]);
                    wait_until("another frame is drawn", || state().frame > frame);
                    wait_for_idle();
                    Screen::read(&framebuffer).save(&directory.join(format!("{name}.png")), state().size);
                };
                save("start");
                press(&input, "F1", "the help is open", |state| state.panels[0]);
                save("help");
                press(&input, "F1", "the help is closed", |state| !state.panels[0]);
                press(&input, "ctrl+1", "the left panel is open", |state| state.panels[2]);
                press(&input, "ctrl+2", "the right panel is open", |state| state.panels[3]);
                press(&input, "space", "the simulation runs", |state| state.time > 0.4);
                save("panels");
                press(&input, "F3", "the profile is open", |state| state.panels[4]);
                press(&input, "F4", "the sensor plot is open", |state| state.panels[5]);
                wait_until("the simulation runs for two seconds", || state().time > 2.0);
                save("plots");
                press(&input, "space", "the simulation is paused", |state| state.status == "Paused");
                // Opens the sections from the bottom up, so that the upper headings keep their positions.
                for section in [686, 663, 640, 617, 594, 253, 230] {
                    input.click([40, section], 1, 1);
                    settle(&input);
                    settle(&input);
                }
                save("sections");
                input.click([100, 400], 5, 6);
                save("appearance");
                input.click([100, 400], 5, 30);
                save("sections_below");
                input.click([1100, 400], 5, 30);
                save("joints");
                press(&input, "F3", "the profile is closed", |state| !state.panels[4]);
                press(&input, "F4", "the sensor plot is closed", |state| !state.panels[5]);
                input.click([1100, 400], 4, 60);
                input.click([1100, 41], 1, 1);
                wait_until("the search is edited", || state().editing);
                input.keys(&["k", "n", "e", "e"]);
                save("find");
                input.click([640, 100], 1, 1);
                wait_until("the search is finished", || !state().editing);

                press(&input, "ctrl+Right", "the trajectory mode is selected", |state| state.mode == "Trajectory");
                press(&input, "ctrl+b", "the burst is on", |state| state.playback_flags[1]);
                input.double_click([640, 380], 1);
                input.click([100, 400], 4, 60);
                press(&input, "ctrl+p", "the screenshot is saved", |state| !state.messages.is_empty());
                save("trajectory");
                press(&input, "F3", "the profile is open", |state| state.panels[4]);
                press(&input, "F4", "the sensor plot is open", |state| state.panels[5]);
                for (name, size) in [("small", [640, 480]), ("default", [1066, 666])] {
                    input.resize(size);
                    wait_until("the frame has the size of the window", || state().size == size);
                    save(name);
                }
                input.key("ctrl+q");
            });
        });
        let options = ViewerOptions::default().with_screenshots(directory.join("screenshot.png"));
        let viewer = Viewer::new().options(options.with_title(&*title).with_size(SIZE));
        viewer.controller(controller).trajectories([trajectory]).run(data).expect("the window opens");
    });
}

/// Saves screenshots of all settings of the appearance.
fn draw_appearance(directory: &Path) {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    let data = Data::new(sample::humanoid()).unwrap();
    show_window(SIZE, ViewerOptions::default(), Viewer::new(), data, |input| {
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        // Closes the visualisation, and opens the appearance and its groups from the bottom up.
        for heading in [253, 322, 483, 460, 437, 414, 391, 368, 345] {
            settle(input);
            input.click([40, heading], 1, 1);
        }
        for name in ["appearance_groups", "appearance_colours"] {
            settle(input);
            wait_for_idle();
            Screen::read(&framebuffer).save(&directory.join(format!("{name}.png")), SIZE);
            input.click([100, 500], 5, 40);
        }
    });
}

/// Saves a screenshot of a controller's plots, sliders and path.
fn draw_instruments(directory: &Path) {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    show_window(
        SIZE,
        ViewerOptions::default(),
        instruments::viewer(0.02),
        Data::new(sample::cartpole()).unwrap(),
        |input| {
            press(input, "space", "the simulation runs", |state| state.time > 1.0);
            std::thread::sleep(std::time::Duration::from_millis(500));
            Screen::read(&framebuffer).save(&directory.join("instruments.png"), SIZE);
        },
    );
}

/// Waits until no frame is drawn for a moment, for example after scrolling. A running simulation is drawn continuously.
fn wait_for_idle() {
    for _ in 0..10 {
        let frame = state().frame;
        std::thread::sleep(std::time::Duration::from_millis(300));
        if state().frame == frame {
            return;
        }
    }
}

/// Saves a screenshot of the light theme, with larger text.
fn draw_light(directory: &Path) {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    let options = ViewerOptions::default().with_theme(Theme::Light).with_scale(1.25);
    show_window(SIZE, options, Viewer::new(), Data::new(sample::humanoid()).unwrap(), |input| {
        for (key, part) in [("Tab", 2), ("shift+Tab", 3), ("F4", 5)] {
            press(input, key, "a panel is open", |state| state.panels[part]);
        }
        press(input, "space", "the simulation runs", |state| state.time > 1.0);
        press(input, "ctrl+l", "a notice is shown", |state| !state.messages.is_empty());
        std::thread::sleep(std::time::Duration::from_millis(500));
        Screen::read(&framebuffer).save(&directory.join("light.png"), SIZE);
    });
}
