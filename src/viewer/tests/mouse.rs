//! Mouse gestures and their effects.

use std::time::Duration;

use super::Bench;
use crate::scene::{CameraView, MouseAction, PerturbationFlags};
use crate::viewer::input::{EventTime, Gesture, Modifiers, Mouse, MouseButton};
use crate::viewer::link::{EndpointRequest, Mode, PlaybackRequest, Request, ViewportPoint};

use crate::{Data, sample};

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND: Modifiers = Modifiers::COMMAND;
const START: Duration = Duration::from_secs(10);

fn mouse() -> Mouse {
    let mut mouse = Mouse::default();
    mouse.set_area([0.0; 2], [800.0, 400.0]);
    mouse.moved([400.0, 200.0], NONE);
    mouse
}

#[test]
fn drags_move_the_camera_relative_to_the_window_height() {
    for (button, modifiers, action) in [
        (MouseButton::Left, NONE, MouseAction::RotateV),
        (MouseButton::Left, SHIFT, MouseAction::RotateH),
        (MouseButton::Right, NONE, MouseAction::MoveV),
        (MouseButton::Right, SHIFT, MouseAction::MoveH),
        (MouseButton::Middle, NONE, MouseAction::Zoom),
        // Without a selected body, Ctrl has no effect.
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
fn drags_with_the_command_key_perturb_the_selected_body() {
    for (button, flags, vertical, horizontal) in [
        (MouseButton::Left, PerturbationFlags::ROTATE, MouseAction::RotateV, MouseAction::RotateH),
        (MouseButton::Right, PerturbationFlags::TRANSLATE, MouseAction::MoveV, MouseAction::MoveH),
    ] {
        let mut mouse = mouse();
        assert_eq!(mouse.press(button, COMMAND, START, true), EndpointRequest::StartPerturbation(flags).into());
        assert_eq!(
            mouse.moved([400.0, 240.0], COMMAND),
            EndpointRequest::MovePerturbation(vertical, [0.0, 0.1]).into()
        );
        assert_eq!(
            mouse.moved([440.0, 240.0], COMMAND | SHIFT),
            EndpointRequest::MovePerturbation(horizontal, [0.1, 0.0]).into()
        );
        // Releasing the key does not release the body.
        assert_eq!(mouse.moved([400.0, 240.0], NONE), EndpointRequest::MovePerturbation(vertical, [-0.1, 0.0]).into());
        assert_eq!(mouse.press(MouseButton::Middle, NONE, START, true), Gesture::None, "a perturbation is in progress");
        assert_eq!(mouse.release(MouseButton::Middle), Gesture::None);
        assert_eq!(mouse.release(button), EndpointRequest::StopPerturbation.into());
    }
    let mut mouse = mouse();
    mouse.press(MouseButton::Left, COMMAND, START, true);
    assert_eq!(mouse.leave(), EndpointRequest::StopPerturbation.into(), "losing the focus releases the button");
    assert_eq!(mouse.leave(), Gesture::None);
}

#[test]
fn double_clicks_within_a_quarter_of_a_second_select_look_and_track() {
    let click = |button, modifiers, after: u64| {
        let mut mouse = mouse();
        mouse.moved([200.0, 100.0], NONE);
        mouse.press(button, modifiers, START, false);
        mouse.release(button);
        mouse.press(button, modifiers, START + Duration::from_millis(after), false)
    };
    let point = ViewportPoint { aspectratio: 2.0, position: [0.25, 0.75] };
    assert_eq!(click(MouseButton::Left, NONE, 200), EndpointRequest::Select(point).into());
    assert_eq!(click(MouseButton::Right, NONE, 200), EndpointRequest::LookAt(point).into());
    assert_eq!(click(MouseButton::Right, COMMAND, 200), EndpointRequest::Track(point).into());
    assert_eq!(click(MouseButton::Left, SHIFT, 200), Gesture::None);
    assert_eq!(click(MouseButton::Left, NONE, 260), Gesture::None);
    // Three clicks are one double-click.
    let mut mouse = mouse();
    let press =
        |mouse: &mut Mouse, button, after| mouse.press(button, NONE, START + Duration::from_millis(after), false);
    press(&mut mouse, MouseButton::Left, 0);
    assert!(matches!(
        press(&mut mouse, MouseButton::Left, 100),
        Gesture::Send(Request::Endpoint(EndpointRequest::Select(_)))
    ));
    assert_eq!(press(&mut mouse, MouseButton::Left, 200), Gesture::None);
    // Presses of two buttons are not a double-click.
    assert_eq!(press(&mut mouse, MouseButton::Right, 250), Gesture::None);
}

#[test]
fn clicks_queued_during_a_frame_are_a_double_click() {
    let after = |milliseconds| START + Duration::from_millis(milliseconds);
    // A frame is drawn from 1 ms to 801 ms after the first click.
    let second = |earliest, latest| {
        let mut mouse = mouse();
        mouse.press(MouseButton::Left, NONE, START, false);
        mouse.release(MouseButton::Left);
        let time = EventTime { earliest: after(earliest), latest: after(latest) };
        matches!(
            mouse.press(MouseButton::Left, NONE, time, false),
            Gesture::Send(Request::Endpoint(EndpointRequest::Select(_)))
        )
    };
    assert!(second(1, 801), "the event may have arrived during the frame");
    assert!(!second(801, 801), "the event has arrived after the frame");
    assert!(!second(300, 801), "the event has arrived after another frame");
}

#[test]
fn drag_is_not_part_of_a_double_click() {
    for (motion, double) in [(3.0, true), (60.0, false)] {
        let mut mouse = mouse();
        mouse.press(MouseButton::Left, COMMAND, START, true);
        mouse.moved([400.0 + motion, 200.0], COMMAND);
        mouse.moved([400.0, 200.0], COMMAND);
        mouse.release(MouseButton::Left);
        let again = mouse.press(MouseButton::Left, COMMAND, START, true);
        let start = Gesture::from(EndpointRequest::StartPerturbation(PerturbationFlags::ROTATE));
        assert_eq!(again != start, double, "{again:?}");
    }
}

#[test]
fn wheel_zooms_and_changes_the_burst() {
    let mouse = mouse();
    let zoom = |dy| Gesture::Camera(MouseAction::Zoom, [0.0, dy]);
    assert_eq!(mouse.scroll(1.0, NONE, Mode::Passive), zoom(-0.05));
    assert_eq!(mouse.scroll(-0.3, NONE, Mode::Trajectory), zoom(0.015));
    assert_eq!(mouse.scroll(0.3, COMMAND, Mode::Trajectory), PlaybackRequest::ChangeBurstFactor(0.3).into());
    assert_eq!(mouse.scroll(-2.0, SHIFT, Mode::Trajectory), PlaybackRequest::ChangeBurstGamma(-2.0).into());
    assert_eq!(mouse.scroll(1.0, COMMAND, Mode::Passive), Gesture::None);
    assert_eq!(mouse.scroll(0.0, NONE, Mode::Passive), Gesture::None);
    assert_eq!(mouse.scroll(f64::NAN, NONE, Mode::Passive), Gesture::None);
}

/// Performs a gesture as the window does.
fn perform(bench: &mut Bench, gesture: impl Into<Gesture>) {
    let snapshot = bench.window.latest().unwrap().0;
    match gesture.into() {
        Gesture::None => {}
        Gesture::Camera(action, motion) => {
            bench.view.move_camera(action, motion, snapshot).unwrap();
            bench.tick();
        }
        Gesture::Send(request) => _ = bench.send(request),
    }
}

const CENTER: ViewportPoint = ViewportPoint { aspectratio: 1.5, position: [0.5, 0.5] };

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
fn double_click_selects_and_unselects() {
    let mut bench = looking_at_the_torso();
    perform(&mut bench, EndpointRequest::Select(CENTER));
    let selected = bench.snapshot().selected.expect("the torso");
    assert_eq!(bench.snapshot().model.body(selected.body).name(), Some("torso"));
    assert!(selected.geom.is_some() && !selected.active);
    assert!(selected.localpos.iter().all(|number| number.abs() < 0.5));
    bench.view.camera.lookat[2] += 50.0; // to the sky
    bench.view.camera.elevation = 10.0;
    perform(&mut bench, EndpointRequest::Select(CENTER));
    assert_eq!(bench.snapshot().selected, None);
}

#[test]
fn camera_looks_at_a_point_and_tracks_a_body() {
    let mut bench = looking_at_the_torso();
    bench.view.camera.lookat[0] += 0.02;
    let before = bench.view.camera;
    perform(&mut bench, EndpointRequest::LookAt(CENTER));
    bench.events();
    assert_ne!(bench.view.camera.lookat, before.lookat);
    assert_eq!(bench.view.camera.view, CameraView::Free);
    perform(&mut bench, EndpointRequest::Track(CENTER));
    bench.events();
    let torso = bench.snapshot().model.body("torso").unwrap().id();
    assert_eq!(bench.view.camera.view, CameraView::Tracking(torso));
    bench.send(Request::Pause(false));
    bench.pass(1.0);
    bench.send(Request::Pause(true));
    // While paused, the camera still approaches the body, and then stops.
    bench.pass(2.0);
    let lookat = bench.snapshot().camera.lookat;
    let number = bench.snapshot().number;
    bench.pass(2.0);
    assert_eq!(bench.snapshot().number, number, "nothing moves, so no snapshot is published");
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
fn drags_move_the_camera_and_the_wheel_zooms_out() {
    let mut bench = looking_at_the_torso();
    let before = bench.view.camera;
    perform(&mut bench, Gesture::Camera(MouseAction::RotateH, [0.1, 0.0]));
    assert_ne!(bench.view.camera.azimuth, before.azimuth);
    let zoom = mouse().scroll(1.0, NONE, Mode::Passive);
    perform(&mut bench, zoom);
    assert!(bench.view.camera.distance > before.distance);
    let seen_from = bench.snapshot().camera;
    assert_eq!(seen_from, bench.view.camera);
}

#[test]
fn viewpoint_follows_the_mouse_without_the_physics() {
    let mut bench = looking_at_the_torso();
    bench.view.camera.azimuth += 30.0;
    let (snapshot, _) = bench.window.latest().unwrap();
    let before = snapshot.scene.viewpoint();
    bench.view.update_snapshot(snapshot).unwrap();
    let at_once = snapshot.scene.viewpoint();
    assert_ne!(at_once, before);
    bench.tick();
    assert_eq!(bench.snapshot().scene.viewpoint(), at_once, "the physics computes the same viewpoint");
}

#[test]
fn running_body_is_pulled_and_the_force_is_shown() {
    let mut bench = looking_at_the_torso();
    perform(&mut bench, EndpointRequest::Select(CENTER));
    bench.send(Request::Pause(false));
    perform(&mut bench, EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    perform(&mut bench, EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.5]));
    bench.pass(0.05);
    let selected = bench.snapshot().selected.unwrap();
    assert!(selected.active && selected.force[2] > 1.0, "{selected:?}");
    bench.pass(0.5);
    let height = bench.snapshot().qpos[2];
    perform(&mut bench, EndpointRequest::StopPerturbation);
    bench.pass(0.05);
    assert_eq!(bench.snapshot().selected.unwrap().force, [0.0; 6]);
    let mut alone = Bench::humanoid();
    alone.send(Request::Pause(false));
    assert!(height > alone.pass(0.55).qpos[2] + 0.05, "{height}");
}

#[test]
fn paused_floating_body_is_moved() {
    let mut bench = looking_at_the_torso();
    perform(&mut bench, EndpointRequest::Select(CENTER));
    let before = bench.snapshot().qpos.clone();
    perform(&mut bench, EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    assert_eq!(bench.snapshot().qpos, before, "the press of the button does not move the body");
    perform(&mut bench, EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.2]));
    let (moved, time) = (bench.snapshot().qpos.clone(), bench.snapshot().time);
    assert!(moved[2] > before[2] + 0.05 && time == 0.0, "{moved:?}");
    perform(&mut bench, EndpointRequest::StopPerturbation);
    assert_eq!(bench.tick().qpos, moved);
}
