//! Pictures of the panels and modes, for the documentation and for visual inspection.

use std::path::{Path, PathBuf};
use std::time::Duration;

use mujoco_safe::scene::NewGeom;
use mujoco_safe::viewer::{self, Theme, Viewer, ViewerError, ViewerOptions, test_hooks};
use mujoco_safe::{Data, Model, PdController, Trajectory, sample};

use crate::balance;
use crate::contents::click;
use crate::display::Screen;
use crate::harness::{double_click, exit_on_panic, press, settle, show_window, state, unique_title};
use crate::input::{Input, wait_until};
use crate::instruments;

const SIZE: [u32; 2] = [1000, 700];
/// Size of a window that shows several sections of a panel at once.
const TALL: [u32; 2] = [600, 1080];
/// Size of the window in the README.
const WIDE: [u32; 2] = [1280, 720];
/// Simulated time of the pictures of a running simulation, s.
const RUN_TIME: f64 = 1.0;

/// Saves the pictures of a group in a directory.
type Draw = fn(&Path);

/// Groups of pictures.
const GROUPS: &[(&str, Draw)] = &[
    ("panes", draw_panes),
    ("balance", draw_balance),
    ("modes", draw_modes),
    ("left_panel", draw_left_panel),
    ("physics", draw_physics),
    ("appearance", draw_appearance),
    ("controller", draw_controller),
    ("program", draw_program),
    ("light", draw_light),
    (SIZES, draw_sizes),
];
/// Group that only inspection needs.
const SIZES: &str = "sizes";

/// Saves the pictures of some groups in a directory, or those of the documentation if no group is
/// given.
pub fn draw(directory: &Path, groups: &[&str]) {
    std::fs::create_dir_all(directory).unwrap();
    let is_wanted = |name: &str| if groups.is_empty() { name != SIZES } else { groups.contains(&name) };
    GROUPS.iter().filter(|(name, _)| is_wanted(name)).for_each(|(_, draw)| draw(directory));
}

/// Saves a picture of the window after its last event.
fn save(directory: &Path, name: &str) {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this program"));
    wait_for_idle();
    // The screen shows a frame some time after the window has drawn it.
    std::thread::sleep(Duration::from_millis(300));
    Screen::read(&framebuffer).save(&directory.join(format!("{name}.png")), state().size);
}

/// Waits until no frame is drawn for a moment, for example after scrolling. A running simulation is
/// drawn continuously.
fn wait_for_idle() {
    for _ in 0..10 {
        let frame = state().frame;
        std::thread::sleep(Duration::from_millis(300));
        if state().frame == frame {
            return;
        }
    }
}

/// Moves the pointer to a place without a tooltip.
fn park(input: &Input) {
    let [[left, _], [width, _]] = state().picture.map(|part| part.map(|pixels| pixels as i32));
    input.move_to([left + width / 2, 20]);
}

fn humanoid() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data
}

/// The picture of the README: a humanoid on one leg that regains its balance, with plots.
fn draw_balance(directory: &Path) {
    let (mut data, _, lqr) = balance::humanoid().unwrap();
    data.qvel_mut()[1] = -0.15; // m/s, to the right
    show_window(WIDE, ViewerOptions::default(), Viewer::new().with_controller(lqr), data, |input| {
        press(input, "shift+Tab", "the right panel is closed", |state| !state.panels[3]);
        press(input, "F3", "the profile is open", |state| state.panels[4]);
        press(input, "F4", "the sensor plot is open", |state| state.panels[5]);
        press(input, "space", "the simulation runs", |state| state.time > 3.0 * RUN_TIME);
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        park(input);
        save(directory, "balance");
    });
}

/// The start, the help, a running simulation, plots, the search, and the trajectory mode.
fn draw_modes(directory: &Path) {
    let mut data = humanoid();
    let controller = PdController::new(data.model(), 5.0, 0.5);
    let mut trajectory = Trajectory::new(data.model());
    trajectory.record(&mut data, &mut controller.clone(), 400).unwrap();
    data.reset_to_key("squat").unwrap();
    // The notice in the last picture has this path.
    let folder = std::env::temp_dir().join("humanoid");
    std::fs::create_dir_all(&folder).unwrap();
    let options = ViewerOptions::default().with_screenshots(folder.join("screenshot.png"));
    let viewer = Viewer::new().with_controller(controller).with_trajectories([trajectory]);
    show_window(SIZE, options, viewer, data, |input| {
        save(directory, "start");
        press(input, "F1", "the help is open", |state| state.panels[0]);
        save(directory, "help");
        press(input, "F1", "the help is closed", |state| !state.panels[0]);
        press(input, "ctrl+Left", "the passive mode is selected", |state| state.mode == "Passive Dynamics");
        let [[left, top], [width, height]] = state().picture.map(|part| part.map(|pixels| pixels as i32));
        let middle = [left + width / 2, top + height / 2];
        double_click(input, middle, 1, "a body is selected", |state| state.selected.is_some_and(|(body, _)| body > 0));
        press(input, "space", "the simulation runs", |state| state.time > RUN_TIME);
        input.press(middle, 3, &["ctrl"]);
        input.move_by([40, -30]);
        wait_until("a force is applied", || state().force[..3].iter().any(|force| *force != 0.0));
        save(directory, "pull");
        input.release(3, &["ctrl"]);
        press(input, "shift+Tab", "the right panel is closed", |state| !state.panels[3]);
        press(input, "F3", "the profile is open", |state| state.panels[4]);
        press(input, "F4", "the sensor plot is open", |state| state.panels[5]);
        let time = state().time;
        wait_until("the plots have curves", || state().time > time + RUN_TIME);
        save(directory, "plots");
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        press(input, "F3", "the profile is closed", |state| !state.panels[4]);
        press(input, "F4", "the sensor plot is closed", |state| !state.panels[5]);

        press(input, "shift+Tab", "the right panel is open", |state| state.panels[3]);
        click(input, "Controls");
        click(input, "name of an element");
        wait_until("the search is edited", || state().editing);
        input.write("knee");
        save(directory, "find");
        park(input);
        input.click([left + width / 2, 20], 1, 1);
        wait_until("the search is finished", || !state().editing);
        press(input, "shift+Tab", "the right panel is closed", |state| !state.panels[3]);

        press(input, "ctrl+Left", "the trajectory mode is selected", |state| state.mode == "Trajectory");
        press(input, "ctrl+b", "the burst is on", |state| state.playback_flags[1]);
        press(input, "ctrl+d", "the Doppler shading is on", |state| state.playback_flags[2]);
        press(input, "ctrl+p", "the screenshot is saved", |state| !state.messages.is_empty());
        save(directory, "trajectory");
    });
    std::fs::remove_dir_all(folder).unwrap();
}

/// Keyframes, groups, rendering, watched values, and the theme.
fn draw_left_panel(directory: &Path) {
    show_window(TALL, ViewerOptions::default(), Viewer::new(), humanoid(), |input| {
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        click(input, "Visualisation");
        click(input, "Simulation");
        press(input, "ctrl+s", "a keyframe is captured", |state| state.captured == 1);
        for section in ["Window", "Watch", "Rendering", "Groups", "Keyframes"] {
            click(input, section);
        }
        settle(input);
        click(input, "qpos[2] or joint knee");
        wait_until("the watched value is edited", || state().editing);
        input.write("qpos[2]");
        input.key("Return");
        wait_until("the value is watched", || !state().editing);
        press(input, "space", "the simulation runs", |state| state.time > RUN_TIME);
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        park(input);
        save(directory, "left_panel");
    });
}

/// Panes of a camera, labels, the name of the camera, and the panel of files.
fn draw_panes(directory: &Path) {
    let text = r#"<mujoco><statistic center="0 0 .4" extent="2"/><visual><headlight ambient=".4 .4 .4"/></visual>
        <worldbody><light pos="0 -1 2" dir="0 .5 -1"/><geom name="Boden" type="plane" size="1 1 .1" rgba=".9 .8 .2 1"/>
          <camera name="nah" pos="0 -1 .6" xyaxes="1 0 0 0 .3 1"/>
          <body name="Körper" pos="0 0 .4"><joint axis="0 1 0"/><geom name="Körper λ Жук" size=".2" rgba=".05 .05 .05 1"/></body>
          <body name="g13" pos=".5 0 .3"><geom name="g13" type="box" size=".1 .1 .1"/></body>
        </worldbody></mujoco>"#;
    let data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    let options = ViewerOptions::default().with_scale(1.25);
    show_window([1200, 800], options, Viewer::new(), data, |input| {
        click(input, "Visualisation");
        click(input, "Simulation");
        click(input, "Rendering");
        click(input, "camera panes");
        click(input, "colour");
        click(input, "depth");
        (0..3).for_each(|_| input.key("F7"));
        settle(input);
        (0..2).for_each(|_| input.key("bracketright"));
        save(directory, "panes");
        input.key("ctrl+o");
        wait_until("the panel of files is open", || state().editing);
        input.key("ctrl+a");
        input.write("/usr/share/mujoco/model/");
        save(directory, "files");
        // The text field receives the keys.
        input.key("Escape");
        wait_until("the panel of files is closed", || !state().editing);
    });
}

/// Physics options and equality constraints.
fn draw_physics(directory: &Path) {
    let text = r#"<mujoco><statistic center="0.1 0 0.4" extent="2.4"/><visual><headlight ambient=".4 .4 .4"/></visual>
        <asset><texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".3 .4 .5" width="200" height="200"/>
          <material name="grid" texture="grid" texrepeat="4 4" texuniform="true"/></asset>
        <worldbody><light pos="0 -1 2" dir="0 .5 -1"/><geom type="plane" size="1 1 .1" material="grid"/>
          <body name="arm" pos="0 0 .5"><joint name="shoulder" axis="0 1 0"/>
            <geom type="capsule" fromto="0 0 0 .3 0 0" size=".04" rgba=".8 .5 .2 1"/>
            <body name="hand" pos=".3 0 0"><joint name="wrist" axis="0 1 0"/><geom size=".06" rgba=".8 .5 .2 1"/></body></body>
          <body name="cup" pos=".4 0 .5"><freejoint/><geom type="cylinder" size=".04 .06" rgba=".2 .6 .8 1"/></body>
        </worldbody>
        <equality><weld body1="hand" body2="cup"/><joint joint1="shoulder" joint2="wrist"/></equality></mujoco>"#;
    let data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    show_window(TALL, ViewerOptions::default(), Viewer::new(), data, |input| {
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        for section in ["Visualisation", "Equality constraints", "Physics", "Simulation"] {
            click(input, section);
        }
        press(input, "Right", "a step is taken", |state| state.time > 0.0);
        park(input);
        save(directory, "physics");
    });
}

/// Groups of settings of the appearance.
fn draw_appearance(directory: &Path) {
    show_window(TALL, ViewerOptions::default(), Viewer::new(), humanoid(), |input| {
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        for section in ["Visualisation", "Simulation", "Appearance"] {
            click(input, section);
        }
        for group in ["statistic", "rgba", "headlight"] {
            click(input, group);
        }
        park(input);
        save(directory, "appearance");
    });
}

/// Plots, parameters and the path of a controller.
fn draw_controller(directory: &Path) {
    let data = Data::new(sample::cartpole()).unwrap();
    show_window(SIZE, ViewerOptions::default().with_panels(false), instruments::viewer(0.02), data, |input| {
        press(input, "space", "the simulation runs", |state| state.time > RUN_TIME);
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        save(directory, "controller");
    });
}

/// A program that steps the simulation and adds a geom.
fn draw_program(directory: &Path) {
    test_hooks::start();
    let title = unique_title();
    let options =
        ViewerOptions::default().with_title(&*title).with_size(SIZE.map(|pixels| pixels as usize)).with_panels(false);
    let mut data = humanoid();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            exit_on_panic(|| {
                wait_until("the window is drawn", || test_hooks::latest().is_some());
                let input = Input::at(&title);
                press(&input, "Tab", "the left panel is open", |state| state.panels[2]);
                wait_until("the simulation runs", || state().time > RUN_TIME);
                save(directory, "program");
                input.key("ctrl+q");
            });
        });
        let goal = NewGeom::sphere(0.1).with_pos([0.0, 0.8, 0.8]).with_rgba([0.9, 0.2, 0.1, 0.7]);
        let result = viewer::run(options, |handle| -> Result<(), ViewerError> {
            handle.geoms_mut().push(goal);
            while handle.is_running() {
                if !handle.is_paused() {
                    data.step()?;
                }
                handle.sync(&mut data)?;
                handle.wait(Duration::from_millis(5));
            }
            Ok(())
        });
        result.expect("the window opens");
    });
}

/// The panels in windows of several sizes, in pixels, and at a scale of 2.
fn draw_sizes(directory: &Path) {
    for ([width, height], scale) in [([800, 600], 1.0), ([1280, 720], 1.0), ([1920, 1080], 1.0), ([1920, 1080], 2.0)] {
        let options = ViewerOptions::default().with_scale(scale);
        show_window([width, height], options, Viewer::new(), humanoid(), |input| {
            wait_until("the panels are open", || state().panels[2] && state().panels[3]);
            press(input, "space", "the simulation runs", |state| state.time > 0.3 * RUN_TIME);
            press(input, "F4", "the sensor plot is open", |state| state.panels[5]);
            press(input, "space", "the simulation is paused", |state| state.status == "Paused");
            park(input);
            save(directory, &format!("{width}x{height}_scale_{scale}"));
        });
    }
}

/// The light theme, with larger text.
fn draw_light(directory: &Path) {
    let options = ViewerOptions::default().with_theme(Theme::Light).with_scale(1.25).with_panels(false);
    show_window(SIZE, options, Viewer::new(), humanoid(), |input| {
        press(input, "shift+Tab", "the right panel is open", |state| state.panels[3]);
        press(input, "space", "the simulation runs", |state| state.time > RUN_TIME);
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        save(directory, "light");
    });
}
