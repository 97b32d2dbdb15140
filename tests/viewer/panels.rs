//! Separation of the input to the panels from the input to the scene.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use mujoco_safe::viewer::test_hooks::{self, WindowState};
use mujoco_safe::viewer::{Theme, Viewer, ViewerOptions};
use mujoco_safe::{Data, sample};

use crate::contents::{click, place};
use crate::display::Screen;
use crate::harness::{double_click, press, settle, show_options, show_sized, show_window, state};
use crate::input::{Input, wait_until};

/// Size of a window that shows a panel in its full width.
pub const SIZE: [u32; 2] = [640, 400];

/// Height of the timeline, pixels.
const TIMELINE: u32 = 34;

pub fn panels() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    let options = ViewerOptions::default().with_theme(Theme::Light).with_scale(1.25);
    show_window(SIZE, options, Viewer::new(), Data::new(sample::cartpole()).unwrap(), |input| {
        let [width, height] = SIZE.map(|pixels| pixels as i32);
        // The panel covers the scene, which is darker. The screen shows the frame that opens the
        // panel after frames of the scene.
        let is_light = || {
            let pixel = Screen::read(&framebuffer).pixel([width as usize - 4, height as usize / 2]);
            pixel.iter().all(|&part| part > 200)
        };
        assert!(!is_light(), "the scene is not light");
        press(input, "ctrl+2", "the right panel is open", |state| state.panels[3]);
        wait_until("the panel is light", is_light);
        // The frame after the one that opens a panel gives it the events over it.
        settle(input);

        // A side panel of 286 points would leave less than 264 points to the picture.
        assert_eq!(state().picture[1][0], (1.25 * 264.0) as u32, "the panel is scaled");

        // A panel receives the mouse events over it.
        let camera = state().camera;
        let on_panel = [width - 140, height - 60];
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

fn humanoid() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data
}

/// Shows a simulation in a window of this size whose side panels are closed at the start.
fn show_closed(size: [u32; 2], data: Data, act: impl FnOnce(&Input) + Send) -> Data {
    show_window(size, ViewerOptions::default().with_panels(false), Viewer::new(), data, act)
}

/// A window with place for both side panels and the picture has them at the start, unless the
/// options close them.
pub fn start() {
    let sides = || [state().panels[2], state().panels[3]];
    for (width, scale, panels, expected) in [
        (1066, 1.0, true, true),
        (1066, 1.0, false, false),
        (780, 1.0, true, false),
        (1066, 1.5, true, false),
        (780, 0.8, true, true),
    ] {
        let options = ViewerOptions::default().with_panels(panels).with_scale(scale);
        show_window([width, 400], options, Viewer::new(), humanoid(), |input| {
            settle(input);
            assert_eq!(sides(), [expected; 2], "width {width}, scale {scale}, panels {panels}");
            input.key("Tab");
            wait_until("Tab switches the left panel", || sides() == [!expected, expected]);
        });
    }
}

/// A window has the layout that the user has given to the previous window.
pub fn remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/viewer.txt");
    let show = |options: ViewerOptions, act: &(dyn Fn(&Input) + Sync)| {
        let options = options.with_layout(path.clone());
        show_options(options, Viewer::new(), Data::new(sample::cartpole()).unwrap(), act);
    };
    let options = ViewerOptions::default;
    // The screen has 1920 × 1200 pixels.
    show(options(), &|_| assert_eq!((state().size, state().panels[2]), ([1632, 1020], true)));
    assert!(!path.exists(), "nothing was changed");
    let model = folder.path().join("cart.xml");
    show(options().with_file(model.clone()), &|input| {
        input.resize([640, 400]);
        wait_until("the window is resized", || state().size == [640, 400]);
        press(input, "shift+Tab", "the right panel is closed", |state| !state.panels[3]);
        press(input, "F2", "the details are open", |state| state.panels[1]);
        // Ctrl+Q closes the window also from a text field.
        press(input, "ctrl+o", "the path of a file is edited", |state| state.editing);
    });
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("right = closed") && !text.contains("left = "), "{text}");
    let recent = format!("recent = {}\n", model.display());
    assert!(text.contains(&recent), "{text}");
    std::fs::write(&path, text + "theme = light\n").unwrap();
    show(options(), &|_| {
        assert_eq!((state().size, &state().panels[1..4]), ([640, 400], &[true, true, false][..]));
        let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
        wait_until("the panel is light", || Screen::read(&framebuffer).pixel([2, 397]).iter().all(|&part| part > 200));
    });
    assert!(std::fs::read_to_string(&path).unwrap().contains(&recent));
    // The program sets the layout itself.
    show(options().with_size([500, 300]), &|input| {
        assert_eq!((state().size, &state().panels[1..4]), ([500, 300], &[false; 3][..]));
        press(input, "F2", "the details are open", |state| state.panels[1]);
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
    });
    assert!(!std::fs::read_to_string(&path).unwrap().contains("left = "));
}

/// Opens the side panels and the plots.
fn open_all(input: &Input) {
    for (key, part) in [("Tab", 2), ("shift+Tab", 3), ("F3", 4), ("F4", 5)] {
        press(input, key, "a panel is open", |state| state.panels[part]);
    }
}

pub fn layout() {
    for [width, height] in [[640, 480], [1066, 666]] {
        show_closed([width, height], humanoid(), |input| {
            // Above the timeline.
            let height = height - TIMELINE;
            assert_eq!(state().picture, [[0, 0], [width, height]]);
            open_all(input);
            settle(input);
            let now = state();
            let [[left, top], [pictured, full]] = now.picture;
            assert_eq!((top, full), (0, height));
            assert!(pictured >= 264, "{pictured} pixels for the picture");
            let rect = |name: &str| {
                let found = now.panel_rects.iter().find(|(known, _)| *known == name);
                found.unwrap_or_else(|| panic!("no panel {name}")).1
            };
            let right = left + pictured;
            assert_eq!(rect("left"), [[0.0, 0.0], [left as f32, height as f32]]);
            assert_eq!(rect("right"), [[right as f32, 0.0], [width as f32, height as f32]]);
            let [[info_left, info_top], [info_right, info_bottom]] = rect("info");
            assert!(left as f32 <= info_left && info_right <= right as f32, "the info panel is in the picture");
            assert!(0.0 <= info_top && info_bottom <= height as f32, "the info panel is in the window");

            // A window that is narrower than the panels.
            input.resize([120, 90]);
            wait_until("the frame has the size of the window", || state().size == [120, 90]);
            input.resize([60, 90]);
            wait_until("the picture has a pixel", || state().picture == [[59, 0], [1, 90]]);
            input.resize([width, height + TIMELINE]);
            wait_until("the initial size is restored", || state().size == [width, height + TIMELINE]);

            // The mouse refers to the picture: its centre shows the humanoid.
            let centre = [(left + pictured / 2) as i32, height as i32 / 2];
            double_click(input, centre, 1, "a body is selected", |state| {
                state.selected.is_some_and(|(body, _)| body > 0)
            });
        });
    }
}

pub fn style() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    let [width, height] = [1066, 666];
    show_closed([width, height], humanoid(), |input| {
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        for heading in ["Visualisation", "Window"] {
            click(input, heading);
        }
        let [light, larger] = ["light", "+"].map(|text| place(input, text));
        let corner = || Screen::read(&framebuffer).pixel([2, height as usize - 3]);
        assert!(corner().iter().all(|&part| part < 60), "the panel is dark");
        let left = state().picture[0][0];
        // A frame between press and release, and none after it but those that the panels request. A
        // long press is a click: on a loaded machine the release arrives late.
        input.press(light, 1, &[]);
        std::thread::sleep(Duration::from_secs(1));
        input.release(1, &[]);
        wait_until("the panel is light", || corner().iter().all(|&part| part > 200));
        input.click(larger, 1, 1);
        wait_until("the panel is wider", || state().picture[0][0] == (1.1 * f64::from(left)).round() as u32);
    });
}

pub fn no_edits() {
    let data = humanoid();
    let [qpos, ctrl] = [data.qpos().to_vec(), data.ctrl().to_vec()];
    assert!(qpos.iter().any(|qpos| (1e3 * qpos).fract() != 0.0), "some positions have more than three decimals");
    show_closed([1066, 666], data, |input| {
        open_all(input);
        settle(input);
        // A speed beyond the range of its slider.
        for _ in 0..8 {
            press(input, "equal", "the speed factor is doubled", |_| true);
        }
        settle(input);
        let frame = state().frame;
        input.move_along((0..40).map(|step| [100 + step, 100 + 5 * step]), 0.02);
        wait_until("the panels are drawn again", || state().frame > frame);
        settle(input);
        let now = state();
        assert_eq!((now.qpos, now.ctrl), (qpos.clone(), ctrl.clone()));
        assert_eq!(now.target_speed, 25.6);
    });
}

pub fn redraws() {
    let framebuffer = PathBuf::from(std::env::var_os("FRAMEBUFFER").expect("set by this test"));
    show_sized(SIZE, humanoid(), |input| {
        // The screen shows a frame some time after the window has drawn it.
        let screen = |columns: Range<usize>, height: usize| {
            let screen = Screen::read(&framebuffer);
            (0..height)
                .flat_map(|y| columns.clone().map(move |x| [x, y]))
                .map(|at| screen.pixel(at))
                .collect::<Vec<_>>()
        };
        // Above the info panel.
        let corner = || screen(0..100, 100);
        wait_until("the scene is on the screen", || corner().iter().any(|pixel| *pixel != [0; 3]));
        let without_panel = corner();
        press(input, "Tab", "the left panel is open", |state| state.panels[2]);
        settle(input);
        wait_until("the left panel is on the screen", || corner() != without_panel);
        let picture = || {
            let [[left, _], [width, height]] = state().picture.map(|part| part.map(|pixels| pixels as usize));
            // The right half, beside the info panel.
            screen(left + width / 2..left + width, height)
        };
        let highlight_widgets = || {
            let frame = state().frame;
            input.move_along((0..80).map(|step| [100, 20 + 4 * step]), 0.02);
            wait_until("the panels are drawn again", || state().frame > frame + 3);
        };
        // Frames reach the screen in order: after later ones, the first frame with the panel is
        // complete.
        highlight_widgets();
        let mut before = picture();
        wait_until("all of the frame is on the screen", || std::mem::replace(&mut before, picture()) == before);
        assert!(before.iter().any(|pixel| *pixel != before[0]), "the picture shows the humanoid");

        let first = state();
        let pixels = u64::from(SIZE[0] * SIZE[1]);
        let repainted = |first: &WindowState| {
            let last = state();
            (last.repainted - first.repainted) as f64 / (pixels * (last.frame - first.frame)) as f64
        };
        highlight_widgets();
        assert_eq!(state().scenes, first.scenes, "the scene is not rendered again");
        assert!(picture() == before, "the picture is the same");
        assert!(repainted(&first) < 0.2, "a highlight repaints {} of the window", repainted(&first));

        // A motion within one widget does not change the panels.
        let slider = |step: i32| [100 + step % 40, 86];
        input.move_to(slider(0));
        let mut frame = state().frame;
        wait_until("no frame is drawn for a second", || {
            let last = std::mem::replace(&mut frame, state().frame);
            std::thread::sleep(std::time::Duration::from_secs(1));
            last == state().frame
        });
        input.move_along((0..80).map(slider), 0.02);
        std::thread::sleep(std::time::Duration::from_millis(500));
        assert_eq!(state().frame, frame, "no frame is drawn");

        // Changes of the camera, of an effect and of the state change the scene.
        let still = state();
        input.drag([500, 100], [40, 0], 1, &[]);
        wait_until("the scene follows the camera", || state().scenes > first.scenes && picture() != before);
        settle(input);
        assert!(repainted(&still) < 0.7, "a motion of the camera repaints {} of the window", repainted(&still));
        for key in ["w", "Right"] {
            settle(input);
            let scenes = state().scenes;
            input.key(key);
            wait_until("the scene is rendered again", || state().scenes > scenes);
        }

        // The parts that were repainted form the same image as a complete repaint. If the screen
        // did not show the last frame yet, the next attempt succeeds.
        let image = || {
            std::thread::sleep(std::time::Duration::from_millis(300));
            screen(0..SIZE[0] as usize, SIZE[1] as usize)
        };
        wait_until("the screen is the same after a complete repaint", || {
            press(input, "F2", "the details are open", |state| state.panels[1]);
            press(input, "F2", "the details are closed", |state| !state.panels[1]);
            settle(input);
            let (partial, last) = (image(), state());
            test_hooks::repaint_all();
            settle(input);
            wait_until("the window is repainted", || state().repainted >= last.repainted + pixels);
            image() == partial
        });
    });
}
