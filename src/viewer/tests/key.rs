//! Key bindings and their effects.

use super::{Bench, Pressed, trajectories};
use crate::scene::{Camera, CameraView, FrameMode, LabelMode, RenderFlags, VisualFlags};
use crate::viewer::input::{
    Action, BINDINGS, Key, KeyPress, Modifiers, Section, ViewAction, WindowAction, find_action, help_sections,
    help_text,
};
use crate::viewer::link::{EndpointRequest, Event, Mode, Status};
use crate::{Data, Model, sample};

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;

fn character(character: char) -> Key {
    Key::Character(character)
}

#[test]
fn keys_are_unique_in_each_mode() {
    for (index, one) in BINDINGS.iter().enumerate() {
        for other in &BINDINGS[index + 1..] {
            let same_press = one.press() == other.press();
            let same_mode = one.mode.is_none() || other.mode.is_none() || one.mode == other.mode;
            assert!(!(same_press && same_mode), "{} is {:?} and {:?}", one.press(), one.action, other.action);
        }
    }
}

#[test]
fn modifiers_are_exact() {
    let all = [SHIFT, COMMAND, Modifiers::ALT, Modifiers::OTHER];
    for binding in BINDINGS {
        let mode = binding.mode.unwrap_or(Mode::Passive);
        for more in all.into_iter().filter(|more| !binding.modifiers.contains(*more)) {
            let press = KeyPress { modifiers: binding.modifiers | more, ..binding.press() };
            let found = find_action(press, mode, &[]);
            let same = |found: &Action| format!("{found:?}") == format!("{:?}", binding.action);
            assert!(!found.is_some_and(same), "{press} has the effect of {}", binding.press());
        }
    }
}

#[test]
fn only_repeating_bindings_react_to_held_keys() {
    let once: Vec<String> =
        BINDINGS.iter().filter(|binding| !binding.repeats).map(|binding| binding.press().to_string()).collect();
    for binding in BINDINGS {
        let mode = binding.mode.unwrap_or(Mode::Passive);
        let held = find_action(KeyPress { repeat: true, ..binding.press() }, mode, &[]);
        assert_eq!(held.is_some(), binding.repeats, "{}", binding.press());
    }
    for press in ["F8", "Shift+F8", "F9", "Shift+F9", "F10", "F11", "Tab", "Shift+Tab"] {
        assert!(once.contains(&press.to_owned()), "{press}");
    }
}

#[test]
fn keys_of_the_trajectory_mode_are_limited_to_it() {
    for binding in BINDINGS.iter().filter(|binding| binding.mode == Some(Mode::Trajectory)) {
        for mode in [Mode::Controller, Mode::Passive] {
            let found = find_action(binding.press(), mode, &[]);
            let same = |found: &Action| format!("{found:?}") == format!("{:?}", binding.action);
            assert!(!found.is_some_and(same), "{}", binding.press());
        }
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer engines have other flags")]
fn flags_have_the_keys_of_the_engine() {
    let of = |key: char, modifiers| {
        let press = KeyPress { key: character(key.to_ascii_lowercase()), modifiers, repeat: false };
        match find_action(press, Mode::Passive, &[]) {
            Some(Action::View(action)) => Some(*action),
            _ => None,
        }
    };
    // Keys in mjVISSTRING and mjRNDSTRING of the engine, in the order of the flags.
    let visual = "HXJQU,ZVYNI'BOCFPTAMED;";
    for (bit, key) in visual.chars().enumerate() {
        let flag = VisualFlags::from_bits(1 << bit).unwrap();
        assert_eq!(of(key, NONE), Some(ViewAction::Visual(flag)), "{key}");
    }
    let render = "SWRLKG/,.";
    for (bit, key) in render.chars().enumerate() {
        let flag = RenderFlags::from_bits(1 << bit).unwrap();
        // The engine assigns the comma twice.
        let modifiers = if key == ',' { SHIFT } else { NONE };
        assert_eq!(of(key, modifiers), Some(ViewAction::Render(flag)), "{key}");
    }
}

#[test]
fn flags_are_toggled() {
    let mut bench = Bench::humanoid();
    for binding in BINDINGS {
        let before = bench.view.clone();
        match binding.action {
            Action::View(ViewAction::Visual(flag)) => {
                bench.press(binding.key, binding.modifiers);
                assert_eq!(bench.view.options.flags, before.options.flags ^ flag);
            }
            Action::View(ViewAction::Render(flag)) => {
                bench.press(binding.key, binding.modifiers);
                assert_eq!(bench.view.render, before.render ^ flag);
            }
            _ => continue,
        }
        assert_ne!(bench.view, before);
        bench.press(binding.key, binding.modifiers);
        assert_eq!(bench.view, before);
    }
}

#[test]
fn view_reaches_the_scene() {
    let mut bench = Bench::humanoid();
    let geoms = bench.snapshot().scene.ngeom();
    bench.press(character('j'), NONE);
    let with_joints = bench.snapshot().scene.ngeom();
    assert!(with_joints > geoms);
    bench.press(character('j'), NONE);
    assert_eq!(bench.snapshot().scene.ngeom(), geoms);
    bench.press(character('w'), NONE);
    let (snapshot, _) = bench.window.latest().unwrap();
    bench.view.update_snapshot(snapshot).unwrap();
    assert!(snapshot.scene.render_flags().contains(RenderFlags::WIREFRAME));
}

#[test]
fn digits_toggle_groups_of_geoms_and_with_shift_of_sites() {
    let mut bench = Bench::humanoid();
    for group in 0..6 {
        let key = character(char::from(b'0' + group as u8));
        let before = bench.view.options.clone();
        bench.press(key, NONE);
        assert_eq!(bench.view.options.geomgroup[group], !before.geomgroup[group]);
        assert_eq!(bench.view.options.sitegroup, before.sitegroup);
        bench.press(key, SHIFT);
        assert_eq!(bench.view.options.sitegroup[group], !before.sitegroup[group]);
    }
}

#[test]
fn labels_and_frames_are_cyclic() {
    let mut bench = Bench::humanoid();
    bench.press(Key::Function(7), SHIFT);
    let last = if cfg!(engine_since = "3.0.0") { LabelMode::Island } else { LabelMode::ContactForce };
    assert_eq!(bench.view.options.label, last);
    for _ in 0..mujoco_sys::mjNLABEL {
        bench.press(Key::Function(7), NONE);
    }
    assert_eq!(bench.view.options.label, last);
    bench.press(Key::Function(7), NONE);
    assert_eq!(bench.view.options.label, LabelMode::None);
    bench.press(Key::Function(6), SHIFT);
    assert_eq!(bench.view.options.frame, FrameMode::World);
    for _ in 0..8 {
        bench.press(Key::Function(6), NONE);
    }
    assert_eq!(bench.view.options.frame, FrameMode::World);
    bench.press(Key::Function(6), NONE);
    assert_eq!(bench.view.options.frame, FrameMode::None);
}

#[test]
fn brackets_cycle_through_the_cameras() {
    let text = r#"<mujoco><worldbody>
        <camera name="a" pos="0 -2 1"/><camera name="b" pos="0 -3 1"/><geom size="0.1"/>
      </worldbody></mujoco>"#;
    let mut bench = Bench::new(Data::new(Model::from_xml_str(text).unwrap()).unwrap());
    let index = |bench: &mut Bench, key| {
        bench.press(character(key), NONE);
        let seen_from = bench.snapshot().camera.view;
        assert_eq!(seen_from, bench.view.camera.view);
        match bench.view.camera.view {
            CameraView::Fixed(camera) => Some(camera.index()),
            _ => None,
        }
    };
    assert_eq!([']'; 4].map(|key| index(&mut bench, key)), [Some(0), Some(1), None, Some(0)]);
    assert_eq!(['['; 3].map(|key| index(&mut bench, key)), [None, Some(1), Some(0)]);
    bench.press(character('a'), COMMAND);
    assert_eq!(bench.view.camera.view, CameraView::Free);
}

#[test]
fn escape_selects_the_free_camera_at_the_present_point() {
    let mut bench = Bench::humanoid();
    let model = bench.snapshot().model.clone();
    bench.view.camera.view = CameraView::Tracking(model.body("torso").unwrap().id());
    bench.tick();
    let (snapshot, _) = bench.window.latest().unwrap();
    bench.view.update_snapshot(snapshot).unwrap();
    let tracking = bench.view.camera;
    assert_ne!(tracking.lookat, Camera::free(&model).lookat);
    assert_eq!(bench.press(Key::Escape, NONE), Pressed::Done);
    assert_eq!(bench.view.camera, Camera { view: CameraView::Free, ..tracking });
}

#[test]
fn align_shows_the_whole_model() {
    let mut bench = Bench::humanoid();
    let before = bench.view.camera;
    (bench.view.camera.lookat, bench.view.camera.distance) = ([5.0; 3], 0.1);
    bench.press(character('a'), COMMAND);
    assert_eq!(bench.view.camera, before);
}

#[test]
fn panels_and_plots_are_toggled() {
    type Shown = fn(&Bench) -> bool;
    let mut bench = Bench::humanoid();
    let panels: [(Key, Modifiers, Shown); 8] = [
        (Key::Function(2), NONE, |bench| bench.view.details),
        (Key::Function(3), NONE, |bench| bench.view.profile),
        (Key::Function(4), NONE, |bench| bench.view.sensors),
        (Key::Function(3), SHIFT, |bench| bench.view.instruments),
        (Key::Tab, NONE, |bench| bench.view.left_panel),
        (Key::Tab, SHIFT, |bench| bench.view.right_panel),
        (character('1'), COMMAND, |bench| bench.view.left_panel),
        (character('2'), COMMAND, |bench| bench.view.right_panel),
    ];
    for (key, modifiers, shown) in panels {
        let before = shown(&bench);
        bench.press(key, modifiers);
        assert_eq!(shown(&bench), !before, "{key}");
        bench.press(key, modifiers);
        assert_eq!(shown(&bench), before, "{key}");
    }
}

#[test]
fn help_is_shown_on_the_screen_and_on_the_terminal() {
    let mut bench = Bench::humanoid();
    assert_eq!(bench.press(Key::Function(1), NONE), Pressed::Window(WindowAction::PrintHelp));
    assert!(bench.view.help);
    assert_eq!(bench.press(Key::Function(1), NONE), Pressed::Done);
    assert!(!bench.view.help);
}

#[test]
fn window_actions_are_passed_to_the_window() {
    let mut bench = Bench::humanoid();
    for (key, modifiers, window) in [
        (character('q'), COMMAND, WindowAction::Quit),
        (Key::Function(8), NONE, WindowAction::Resize([1024, 768])),
        (Key::Function(8), SHIFT, WindowAction::Resize([1280, 1024])),
        (Key::Function(9), NONE, WindowAction::Resize([1280, 720])),
        (Key::Function(9), SHIFT, WindowAction::Resize([1920, 1080])),
        (Key::Function(10), NONE, WindowAction::DefaultSize),
        (Key::Function(11), NONE, WindowAction::FullScreen),
        (Key::Function(5), NONE, WindowAction::FullScreen),
        (character('v'), COMMAND, WindowAction::Record),
        (character('p'), COMMAND, WindowAction::Screenshot),
        (character('l'), COMMAND, WindowAction::Reload),
    ] {
        assert_eq!(bench.press(key, modifiers), Pressed::Window(window), "{key}");
    }
}

#[test]
fn space_resumes_and_pauses() {
    let mut bench = Bench::humanoid();
    assert_eq!(bench.snapshot().status, Status::Paused, "a viewer starts paused");
    bench.press(Key::Space, NONE);
    assert_eq!(bench.snapshot().status, Status::Running);
    assert!(bench.pass(0.5).time > 0.45);
    bench.press(Key::Space, NONE);
    let time = bench.snapshot().time;
    assert_eq!(bench.snapshot().status, Status::Paused);
    assert_eq!(bench.pass(1.0).time, time);
}

#[test]
fn arrows_step_forward_and_back_while_paused() {
    let mut bench = Bench::humanoid();
    let timestep = bench.snapshot().model.timestep();
    let start = bench.snapshot().qpos.clone();
    let steps = |bench: &mut Bench| (bench.snapshot().time / timestep).round() as i64;
    for (key, modifiers, expected) in [
        (Key::Right, NONE, 1),
        (Key::Right, SHIFT, 51),
        (Key::Left, NONE, 50),
        (Key::Left, SHIFT, 0),
        (Key::Left, NONE, 0),
    ] {
        bench.press(key, modifiers);
        assert_eq!(steps(&mut bench), expected, "{modifiers}{key}");
    }
    assert_eq!(bench.snapshot().qpos, start, "bit for bit");
    // Ctrl selects another binding.
    bench.press(Key::Right, COMMAND);
    assert_eq!(steps(&mut bench), 0);
    // Ignored while running.
    bench.press(Key::Space, NONE);
    bench.pass(0.1);
    let before = steps(&mut bench);
    bench.press(Key::Right, SHIFT);
    assert!(steps(&mut bench) <= before + 1);
}

#[test]
fn speed_factor_is_toggled_doubled_and_halved() {
    let mut bench = Bench::humanoid();
    let speed = |bench: &mut Bench| (bench.snapshot().speed.target(), bench.snapshot().speed.text());
    assert_eq!(speed(&mut bench), (1.0, "1".to_owned()));
    bench.press(Key::Enter, NONE);
    assert_eq!(speed(&mut bench), (0.1, "10x (slower)".to_owned()));
    bench.press(Key::Enter, NONE);
    assert_eq!(speed(&mut bench).0, 1.0);
    // A change of the factor applies it.
    bench.press(Key::Up, SHIFT);
    assert_eq!(speed(&mut bench), (0.2, "5x (slower)".to_owned()));
    bench.press(Key::Down, SHIFT);
    assert_eq!(speed(&mut bench).0, 0.1);
    bench.press(character('='), NONE);
    assert_eq!(speed(&mut bench).0, 0.2);
    bench.press(character('-'), NONE);
    assert_eq!(speed(&mut bench).0, 0.1);
    for _ in 0..5 {
        bench.press(Key::Up, SHIFT);
    }
    assert_eq!(speed(&mut bench), (3.2, "3.2x (faster)".to_owned()));
    for _ in 0..100 {
        bench.press(Key::Up, SHIFT);
    }
    assert!(speed(&mut bench).0.is_finite());
    for _ in 0..200 {
        bench.press(Key::Down, SHIFT);
    }
    assert!(speed(&mut bench).0 > 0.0);
}

#[test]
fn slow_motion_reaches_its_target_speed() {
    let mut bench = Bench::humanoid();
    bench.press(Key::Enter, NONE);
    bench.press(Key::Space, NONE);
    let snapshot = bench.pass(5.0);
    assert!((snapshot.time - 0.5).abs() < 0.01, "{}", snapshot.time);
    assert!((snapshot.speed.measured - 0.1).abs() < 0.02, "{:?}", snapshot.speed);
}

#[test]
fn backspace_restores_the_start_state() {
    let mut bench = Bench::humanoid();
    let start = bench.snapshot().qpos.clone();
    assert_ne!(start, bench.snapshot().model.qpos0());
    bench.press(Key::Space, NONE);
    assert_ne!(bench.pass(0.5).qpos, start);
    bench.press(Key::Space, NONE);
    bench.press(Key::Backspace, NONE);
    assert_eq!(bench.snapshot().qpos, start);
    assert_eq!(bench.snapshot().time, 0.0);
}

#[test]
fn modes_are_cyclic() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.qpos_mut()[1] = 0.2;
    let controller = |data: &mut Data| data.ctrl_mut()[0] = 1.0;
    let mut bench = Bench::with(data, Some(Box::new(controller)), trajectories());
    assert_eq!(bench.snapshot().modes, [Mode::Controller, Mode::Trajectory, Mode::Passive]);
    let mut modes = Vec::new();
    for key in [Key::Right, Key::Right, Key::Right, Key::Left, Key::Left] {
        modes.push(bench.mode());
        bench.press(key, COMMAND);
    }
    modes.push(bench.mode());
    let [first, second, last] = [Mode::Controller, Mode::Trajectory, Mode::Passive];
    assert_eq!(modes, [first, second, last, first, last, second]);
}

#[test]
fn page_up_selects_the_parent() {
    let mut bench = Bench::humanoid();
    let model = bench.snapshot().model.clone();
    let foot = model.body("foot_left").unwrap();
    bench.send(EndpointRequest::SelectBody(Some(foot.id())));
    assert_eq!(bench.snapshot().selected.unwrap().body, foot.id());
    bench.press(Key::PageUp, NONE);
    assert_eq!(bench.snapshot().selected.unwrap().body, foot.parent());
}

#[test]
fn keys_copy_and_capture_the_state_and_clear_the_controls() {
    let mut bench = Bench::humanoid();
    let model = bench.snapshot().model.clone();
    bench.send(EndpointRequest::SetControl(model.actuator(0).unwrap().id(), 0, 0.5));
    bench.press(character('c'), COMMAND);
    let events = bench.events();
    assert!(matches!(&events[..], [Event::Copied(text)] if text.starts_with("<key time=\"0\" qpos=\"")), "{events:?}");
    bench.press(character('s'), COMMAND);
    assert_eq!(bench.snapshot().captured.len(), 1);
    bench.press(Key::Backspace, COMMAND);
    assert!(bench.snapshot().ctrl.iter().all(|&ctrl| ctrl == 0.0));
}

#[test]
fn keys_of_the_trajectory_mode() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    let playback = |bench: &mut Bench| bench.snapshot().playback.unwrap();
    assert_eq!(bench.mode(), Mode::Trajectory);
    assert_eq!((playback(&mut bench).frame, playback(&mut bench).trajectory), (0, 0));
    bench.press(Key::Up, NONE);
    assert_eq!((playback(&mut bench).trajectory, playback(&mut bench).frames), (1, 10));
    bench.press(Key::Down, NONE);
    bench.press(Key::Down, NONE);
    assert_eq!((playback(&mut bench).trajectory, playback(&mut bench).frames), (2, 200));
    bench.press(Key::Left, NONE);
    assert_eq!(playback(&mut bench).frame, 199);
    bench.press(Key::Left, SHIFT);
    assert_eq!(playback(&mut bench).frame, 149);
    bench.press(Key::Right, SHIFT);
    bench.press(Key::Right, NONE);
    assert_eq!(playback(&mut bench).frame, 0);
    bench.press(character('r'), COMMAND);
    assert!(playback(&mut bench).reversed);
    bench.press(character('b'), COMMAND);
    assert!(playback(&mut bench).burst.on);
    bench.press(character('d'), COMMAND);
    assert!(playback(&mut bench).burst.doppler);
    bench.press(Key::Backspace, NONE);
    assert_eq!(playback(&mut bench).frame, 0);
}

#[test]
fn help_lists_every_binding_of_the_mode() {
    for mode in [Mode::Passive, Mode::Controller, Mode::Trajectory] {
        let sections = help_sections(mode, &[]);
        for binding in BINDINGS {
            let listed = sections.iter().filter(|section| section.title == binding.section.title()).any(|section| {
                section.lines.iter().any(|(keys, help)| {
                    *help == binding.help && keys.split(", ").any(|key| key == binding.press().to_string())
                })
            });
            // The comma separates keys and is a key itself.
            let comma = binding.key == character(',');
            let here = binding.mode.is_none_or(|only| only == mode);
            assert!(comma || listed == here, "{} in {mode}", binding.press());
        }
        for section in &sections {
            for (index, (_, help)) in section.lines.iter().enumerate() {
                assert!(section.lines[..index].iter().all(|(_, other)| other != help), "{help} is listed twice");
            }
        }
        assert!(Section::ALL.iter().all(|section| !section.title().is_empty()));
    }
}

#[test]
fn help_fits_the_terminal() {
    for columns in [40, 60, 80, 200] {
        let text = help_text(Mode::Trajectory, &[], columns);
        for line in text.lines() {
            assert!(line.chars().count() <= columns, "{columns}: {line}");
        }
    }
    let wide = help_text(Mode::Passive, &[], 120);
    assert!(wide.contains("While paused: 50 steps back"), "{wide}");
    assert!(wide.lines().any(|line| line.contains("left double-click") && line.contains("Select a body")));
}

#[test]
fn released_keys_have_no_binding_except_with_ctrl() {
    let released = [Key::Left, Key::Character('a')];
    for binding in BINDINGS {
        let mode = binding.mode.unwrap_or(Mode::Passive);
        let is_found = find_action(binding.press(), mode, &released).is_some();
        let is_kept = !released.contains(&binding.key) || binding.modifiers.contains(Modifiers::COMMAND);
        assert_eq!(is_found, is_kept, "{}", binding.press());
    }
    let help = help_text(Mode::Passive, &released, 80);
    assert!(help_text(Mode::Passive, &[], 80).contains("one step back") && !help.contains("one step back"));
    assert!(help.contains("Previous mode") && help.contains("one step forward"));
}
