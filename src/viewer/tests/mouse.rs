//! Every gesture does what it says.

use std::time::Duration;

use super::Bench;
use crate::scene::{CameraView, MouseAction, PerturbationFlags};
use crate::viewer::input::{Gesture, Modifiers, Moment, Mouse, MouseButton};
use crate::viewer::link::{Mode, Request};
use crate::viewer::view::Effect;
use crate::{Data, sample};

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;
const START: Duration = Duration::from_secs(10);

fn mouse() -> Mouse {
    let mut mouse = Mouse::default();
    mouse.resize([800.0, 400.0]);
    mouse.moved([400.0, 200.0], NONE);
    mouse
}

#[test]
fn drags_move_the_camera_in_heights_of_the_window() {
    for (button, modifiers, action) in [
        (MouseButton::Left, NONE, MouseAction::RotateV),
        (MouseButton::Left, SHIFT, MouseAction::RotateH),
        (MouseButton::Right, NONE, MouseAction::MoveV),
        (MouseButton::Right, SHIFT, MouseAction::MoveH),
        (MouseButton::Middle, NONE, MouseAction::Zoom),
        // Nothing is selected, so there is nothing to pull.
        (MouseButton::Left, COMMAND, MouseAction::RotateV),
        (MouseButton::Right, COMMAND, MouseAction::MoveV),
    ] {
        let mut mouse = mouse();
        assert_eq!(mouse.moved([404.0, 200.0], modifiers), Gesture::None, "no button is held");
        assert_eq!(mouse.press(button, modifiers, START, false), Gesture::None);
        assert_eq!(mouse.moved([408.0, 180.0], modifiers), Gesture::Camera(action, [0.01, -0.05]));
        assert_eq!(mouse.moved([408.0, 180.0], modifiers), Gesture::None, "it has not moved");
        assert_eq!(mouse.release(button), Gesture::None);
        assert_eq!(mouse.moved([500.0, 180.0], modifiers), Gesture::None);
    }
}

#[test]
fn with_the_command_key_drags_turn_and_pull_the_selected_body() {
    for (button, flags, vertical, horizontal) in [
        (MouseButton::Left, PerturbationFlags::ROTATE, MouseAction::RotateV, MouseAction::RotateH),
        (MouseButton::Right, PerturbationFlags::TRANSLATE, MouseAction::MoveV, MouseAction::MoveH),
    ] {
        let mut mouse = mouse();
        assert_eq!(mouse.press(button, COMMAND, START, true), Gesture::StartPerturbation(flags));
        assert_eq!(mouse.moved([400.0, 240.0], COMMAND), Gesture::Perturbation(vertical, [0.0, 0.1]));
        assert_eq!(mouse.moved([440.0, 240.0], COMMAND | SHIFT), Gesture::Perturbation(horizontal, [0.1, 0.0]));
        // Letting the key go does not let the body go.
        assert_eq!(mouse.moved([400.0, 240.0], NONE), Gesture::Perturbation(vertical, [-0.1, 0.0]));
        assert_eq!(mouse.press(MouseButton::Middle, NONE, START, true), Gesture::None, "one hand pulls");
        assert_eq!(mouse.release(MouseButton::Middle), Gesture::None);
        assert_eq!(mouse.release(button), Gesture::StopPerturbation);
    }
    let mut mouse = mouse();
    mouse.press(MouseButton::Left, COMMAND, START, true);
    assert_eq!(mouse.leave(), Gesture::StopPerturbation, "a window that has lost the mouse holds nothing");
    assert_eq!(mouse.leave(), Gesture::None);
}

#[test]
fn double_clicks_within_a_quarter_of_a_second_select_look_and_follow() {
    let click = |button, modifiers, after: u64| {
        let mut mouse = mouse();
        mouse.moved([200.0, 100.0], NONE);
        mouse.press(button, modifiers, START, false);
        mouse.release(button);
        mouse.press(button, modifiers, START + Duration::from_millis(after), false)
    };
    let place = Place { aspectratio: 2.0, at: [0.25, 0.75] };
    assert_eq!(click(MouseButton::Left, NONE, 200), Gesture::Select(place));
    assert_eq!(click(MouseButton::Right, NONE, 200), Gesture::LookAt(place));
    assert_eq!(click(MouseButton::Right, COMMAND, 200), Gesture::Track(place));
    assert_eq!(click(MouseButton::Left, SHIFT, 200), Gesture::None);
    assert_eq!(click(MouseButton::Left, NONE, 260), Gesture::None);
    // Three clicks are one double-click.
    let mut mouse = mouse();
    let press =
        |mouse: &mut Mouse, button, after| mouse.press(button, NONE, START + Duration::from_millis(after), false);
    press(&mut mouse, MouseButton::Left, 0);
    assert!(matches!(press(&mut mouse, MouseButton::Left, 100), Gesture::Select(_)));
    assert_eq!(press(&mut mouse, MouseButton::Left, 200), Gesture::None);
    // Two buttons are no double-click.
    assert_eq!(press(&mut mouse, MouseButton::Right, 250), Gesture::None);
}

#[test]
fn clicks_that_wait_while_a_frame_is_drawn_are_a_double_click() {
    let after = |milliseconds| START + Duration::from_millis(milliseconds);
    // A frame is drawn from 1 ms to 801 ms after the first click.
    let second = |earliest, latest| {
        let mut mouse = mouse();
        mouse.press(MouseButton::Left, NONE, START, false);
        mouse.release(MouseButton::Left);
        let moment = Moment { earliest: after(earliest), latest: after(latest) };
        matches!(mouse.press(MouseButton::Left, NONE, moment, false), Gesture::Select(_))
    };
    assert!(second(1, 801), "it came during the frame");
    assert!(!second(801, 801), "it came after the frame");
    assert!(!second(300, 801), "it came after another frame");
}

#[test]
fn a_drag_is_no_half_of_a_double_click() {
    for (motion, double) in [(3.0, true), (60.0, false)] {
        let mut mouse = mouse();
        mouse.press(MouseButton::Left, COMMAND, START, true);
        mouse.moved([400.0 + motion, 200.0], COMMAND);
        mouse.moved([400.0, 200.0], COMMAND);
        mouse.release(MouseButton::Left);
        let again = mouse.press(MouseButton::Left, COMMAND, START, true);
        assert_eq!(again != Gesture::StartPerturbation(PerturbationFlags::ROTATE), double, "{again:?}");
    }
}

#[test]
fn the_wheel_zooms_as_in_the_engines_programs_and_turns_the_burst_by_fractions_too() {
    let mouse = mouse();
    let zoom = |dy| Gesture::Camera(MouseAction::Zoom, [0.0, dy]);
    assert_eq!(mouse.scroll(1.0, NONE, Mode::Passive), zoom(-0.05));
    assert_eq!(mouse.scroll(-0.3, NONE, Mode::Trajectory), zoom(0.015));
    assert_eq!(mouse.scroll(0.3, COMMAND, Mode::Trajectory), Gesture::BurstFactor(0.3));
    assert_eq!(mouse.scroll(-2.0, SHIFT, Mode::Trajectory), Gesture::BurstGamma(-2.0));
    assert_eq!(mouse.scroll(1.0, COMMAND, Mode::Passive), Gesture::None);
    assert_eq!(mouse.scroll(0.0, NONE, Mode::Passive), Gesture::None);
    assert_eq!(mouse.scroll(f64::NAN, NONE, Mode::Passive), Gesture::None);
}

/// Does a gesture as the window would.
fn done(bench: &mut Bench, gesture: Gesture) {
    let snapshot = bench.window.latest().unwrap().0;
    match bench.view.gesture(gesture, snapshot).unwrap() {
        Effect::Ask(request) => _ = bench.send(request),
        Effect::Done => _ = bench.tick(),
        Effect::Window(action) => panic!("a gesture is no {action:?}"),
    }
}

const MIDDLE: Place = Place { aspectratio: 1.5, at: [0.5, 0.5] };

fn looking_at_the_torso() -> Bench {
    let mut bench = Bench::humanoid();
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    bench.view.camera.lookat = *data.body("torso").unwrap().xpos();
    bench.tick();
    bench
}

#[test]
fn a_body_is_selected_and_unselected() {
    let mut bench = looking_at_the_torso();
    done(&mut bench, Gesture::Select(MIDDLE));
    let selected = bench.snapshot().selected.expect("the torso");
    assert_eq!(bench.snapshot().model.body(selected.body).name(), Some("torso"));
    assert!(selected.geom.is_some() && !selected.active);
    assert!(selected.localpos.iter().all(|number| number.abs() < 0.5));
    bench.view.camera.lookat[2] += 50.0; // to the sky
    bench.view.camera.elevation = 10.0;
    done(&mut bench, Gesture::Select(MIDDLE));
    assert_eq!(bench.snapshot().selected, None);
}

#[test]
fn the_camera_looks_at_a_point_and_follows_a_body() {
    let mut bench = looking_at_the_torso();
    bench.view.camera.lookat[0] += 0.02;
    let before = bench.view.camera;
    done(&mut bench, Gesture::LookAt(MIDDLE));
    bench.events();
    assert_ne!(bench.view.camera.lookat, before.lookat);
    assert_eq!(bench.view.camera.view, CameraView::Free);
    done(&mut bench, Gesture::Track(MIDDLE));
    bench.events();
    let torso = bench.snapshot().model.body("torso").unwrap().id();
    assert_eq!(bench.view.camera.view, CameraView::Tracking(torso));
    bench.send(Request::Pause(false));
    bench.pass(1.0);
    bench.send(Request::Pause(true));
    // While it stands the camera still comes nearer, and then rests.
    bench.pass(2.0);
    let lookat = bench.snapshot().camera.lookat;
    let number = bench.snapshot().number;
    bench.pass(2.0);
    assert_eq!(bench.snapshot().number, number, "nothing moves, so nothing is shown anew");
    let com = {
        let snapshot = bench.snapshot();
        let mut data = Data::new(snapshot.model.clone()).unwrap();
        data.qpos_mut().copy_from_slice(&snapshot.qpos);
        data.forward().unwrap();
        data.subtree_com()[torso.index()]
    };
    for axis in 0..3 {
        assert!((lookat[axis] - com[axis]).abs() < 0.01, "{lookat:?} is not at {com:?}");
    }
}

#[test]
fn drags_reach_the_camera_and_the_wheel_zooms_out() {
    let mut bench = looking_at_the_torso();
    let before = bench.view.camera;
    done(&mut bench, Gesture::Camera(MouseAction::RotateH, [0.1, 0.0]));
    assert_ne!(bench.view.camera.azimuth, before.azimuth);
    let zoom = mouse().scroll(1.0, NONE, Mode::Passive);
    done(&mut bench, zoom);
    assert!(bench.view.camera.distance > before.distance);
    let seen_from = bench.snapshot().camera;
    assert_eq!(seen_from, bench.view.camera);
}

#[test]
fn a_picture_follows_the_mouse_though_the_physics_does_nothing() {
    let mut bench = looking_at_the_torso();
    bench.view.camera.azimuth += 30.0;
    let (snapshot, _) = bench.window.latest().unwrap();
    let before = snapshot.scene.viewpoint();
    bench.view.update_snapshot(snapshot).unwrap();
    let at_once = snapshot.scene.viewpoint();
    assert_ne!(at_once, before);
    bench.tick();
    assert_eq!(bench.snapshot().scene.viewpoint(), at_once, "the same as the physics makes of it");
}

#[test]
fn a_body_is_pulled_while_it_runs_and_the_force_is_told() {
    let mut bench = looking_at_the_torso();
    done(&mut bench, Gesture::Select(MIDDLE));
    bench.send(Request::Pause(false));
    done(&mut bench, Gesture::StartPerturbation(PerturbationFlags::TRANSLATE));
    done(&mut bench, Gesture::Perturbation(MouseAction::MoveV, [0.0, -0.5]));
    bench.pass(0.05);
    let selected = bench.snapshot().selected.unwrap();
    assert!(selected.active && selected.force[2] > 1.0, "{selected:?}");
    bench.pass(0.5);
    let height = bench.snapshot().qpos[2];
    done(&mut bench, Gesture::StopPerturbation);
    bench.pass(0.05);
    assert_eq!(bench.snapshot().selected.unwrap().force, [0.0; 6]);
    let mut alone = Bench::humanoid();
    alone.send(Request::Pause(false));
    assert!(height > alone.pass(0.55).qpos[2] + 0.05, "{height}");
}

#[test]
fn a_floating_body_is_moved_while_it_stands() {
    let mut bench = looking_at_the_torso();
    done(&mut bench, Gesture::Select(MIDDLE));
    let before = bench.snapshot().qpos.clone();
    done(&mut bench, Gesture::StartPerturbation(PerturbationFlags::TRANSLATE));
    assert_eq!(bench.snapshot().qpos, before, "it moves with the mouse, not with the button");
    done(&mut bench, Gesture::Perturbation(MouseAction::MoveV, [0.0, -0.2]));
    let moved = bench.snapshot().clone_numbers();
    assert!(moved.0[2] > before[2] + 0.05 && moved.1 == 0.0, "{moved:?}");
    done(&mut bench, Gesture::StopPerturbation);
    assert_eq!(bench.tick().qpos, moved.0);
}

impl crate::viewer::snapshot::Snapshot {
    fn clone_numbers(&self) -> (Vec<f64>, f64) {
        (self.qpos.clone(), self.time)
    }
}
