//! Requests that reach the simulation in one batch, because its thread was busy or had no processor.

use super::{Bench, trajectories};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::handle::Handle;
use crate::viewer::link::link;
use crate::viewer::mode::Mode;
use crate::viewer::request::{Place, Request};
use crate::viewer::snapshot::Status;
use crate::{Data, Model, sample};

const MODEL: &str = r#"<mujoco>
    <worldbody>
      <body name="ball" pos="0 0 1"><freejoint/><geom size="0.1"/></body>
      <body name="hand" mocap="true" pos="0 0 2"><geom type="box" size="0.1 0.1 0.1"/></body>
      <body name="arm" pos="1 0 1"><joint name="hinge" axis="0 1 0"/><geom size="0.1" pos="0 0 -0.5"/></body>
    </worldbody>
    <actuator><motor name="motor" joint="hinge"/></actuator>
    <keyframe><key name="high" time="3" qpos="0 0 5 1 0 0 0 0.5"/></keyframe>
  </mujoco>"#;

fn bench() -> Bench {
    Bench::new(Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap())
}

/// Has the simulation execute all requests in one turn.
fn batch(bench: &mut Bench, requests: impl IntoIterator<Item = Request>) {
    for request in requests {
        bench.front.ask(request);
    }
    bench.turn();
}

/// A drag of the mouse from the press of its button to the release.
fn drag(flags: PerturbationFlags, action: MouseAction, motion: [f64; 2]) -> [Request; 3] {
    [Request::StartPerturbation(flags), Request::MovePerturbation(action, motion), Request::StopPerturbation]
}

fn lift() -> [Request; 3] {
    drag(PerturbationFlags::TRANSLATE, MouseAction::MoveV, [0.0, -0.2])
}

fn turn() -> [Request; 3] {
    drag(PerturbationFlags::ROTATE, MouseAction::RotateV, [0.2, 0.1])
}

#[test]
fn a_drag_that_ends_before_the_next_turn_moves_and_turns_the_body() {
    let mut bench = bench();
    let ball = bench.shown().model.body("ball").unwrap().id();
    bench.ask(Request::SelectBody(Some(ball)));
    let before = bench.shown().qpos.clone();
    batch(&mut bench, lift());
    let lifted = bench.shown().qpos.clone();
    assert!(lifted[2] > before[2] + 0.01, "{lifted:?}");
    batch(&mut bench, turn());
    let turned = bench.shown().qpos.clone();
    assert_ne!(turned[3..7], lifted[3..7]);
    assert!(!bench.shown().selected.unwrap().active, "the body was let go");
    assert_eq!(bench.shown().time, 0.0);
}

#[test]
fn a_batch_has_the_same_effect_as_its_requests_one_at_a_time() {
    let model = bench().shown().model.clone();
    let [ball, hand] = ["ball", "hand"].map(|name| Request::SelectBody(Some(model.body(name).unwrap().id())));
    let key = || Request::LoadKey(model.keyframe("high").unwrap().id());
    let motor = model.actuator("motor").unwrap().id();
    let hinge = model.joint("hinge").unwrap().id();
    let batches: Vec<Box<dyn Fn() -> Vec<Request>>> = vec![
        // Two drags of two bodies.
        Box::new(|| {
            let requests = [&ball, &hand].map(|select| {
                let Request::SelectBody(body) = select else { unreachable!() };
                [Request::SelectBody(*body)].into_iter().chain(lift()).chain(turn())
            });
            requests.into_iter().flatten().collect()
        }),
        // A drag that the next selection ends.
        Box::new(|| {
            let Request::SelectBody(body) = &ball else { unreachable!() };
            let mut requests = vec![Request::SelectBody(*body)];
            requests.extend(lift().into_iter().take(2));
            requests.push(Request::SelectBody(None));
            requests
        }),
        // A drag before and after a state is loaded.
        Box::new(|| {
            let Request::SelectBody(body) = &ball else { unreachable!() };
            [Request::SelectBody(*body)].into_iter().chain(lift()).chain([key()]).chain(lift()).collect()
        }),
        // Runs and pauses.
        Box::new(|| vec![Request::TogglePause, Request::TogglePause]),
        Box::new(|| vec![Request::Pause(false), Request::Pause(true), Request::Step(3), Request::Step(-1)]),
        Box::new(|| vec![Request::Step(5), Request::TogglePause, Request::Scrub(2)]),
        Box::new(|| {
            vec![Request::Step(5), Request::Scrub(2), Request::SaveKey(None), Request::Step(2), Request::Reset]
        }),
        // Numbers that are set, and what follows from them.
        Box::new(|| vec![Request::SetControl(motor, 3.0), Request::Step(4), Request::ClearControls, Request::Step(1)]),
        Box::new(|| {
            vec![Request::SetPosition(hinge, 0, 0.3), Request::SaveKey(None), Request::Reset, Request::LoadCaptured(0)]
        }),
        Box::new(|| {
            vec![Request::Faster, Request::Faster, Request::ToggleSpeed, Request::ToggleSpeed, Request::Slower]
        }),
    ];
    for (number, requests) in batches.iter().enumerate() {
        let [mut at_once, mut one_at_a_time] = [(); 2].map(|()| Bench::new(Data::new(model.clone()).unwrap()));
        batch(&mut at_once, requests());
        for request in requests() {
            one_at_a_time.ask(request);
        }
        let [found, expected] = [&mut at_once, &mut one_at_a_time].map(|bench| {
            let shown = bench.shown();
            let numbers = (shown.time, shown.qpos.clone(), shown.qvel.clone(), shown.ctrl.clone());
            let rest = (shown.status, shown.pace.wanted(), shown.history, shown.moment, shown.captured.len());
            (numbers, rest, shown.selected.map(|selected| (selected.body, selected.active)))
        });
        assert_eq!(found, expected, "batch {number}");
    }
}

#[test]
fn a_place_is_in_the_picture_that_the_user_has_clicked_on() {
    let mut bench = bench();
    let ball = bench.shown().model.body("ball").unwrap().id();
    let middle = Place { aspectratio: 1.5, at: [0.5, 0.5] };
    for (before, after, selected) in [(1.0, 50.0, Some(ball)), (50.0, 1.0, None)] {
        bench.view.camera.lookat = [0.0, 0.0, before];
        bench.front.look(&bench.view.look());
        bench.front.ask(Request::Select(middle));
        bench.view.camera.lookat[2] = after;
        bench.turn();
        assert_eq!(bench.shown().selected.map(|selected| selected.body), selected);
        assert_eq!(bench.shown().camera.lookat[2], after, "the next picture is the newest");
    }
}

#[test]
fn a_state_that_is_forgotten_twice_takes_no_other_with_it() {
    let mut bench = bench();
    batch(&mut bench, [Request::SaveKey(None), Request::SaveKey(None), Request::SaveKey(None)]);
    let second = bench.shown().captured[1].number;
    batch(&mut bench, [Request::RemoveCaptured(second), Request::RemoveCaptured(second)]);
    let names: Vec<_> = bench.shown().captured.iter().map(|key| key.name.clone()).collect();
    assert_eq!(names, ["captured_1", "captured_3"]);
}

#[test]
fn a_pull_that_ends_before_the_next_step_acts_for_a_step() {
    let run = |pulls: bool| {
        let mut bench = bench();
        let ball = bench.shown().model.body("ball").unwrap().id();
        bench.ask(Request::SelectBody(Some(ball)));
        bench.ask(Request::Pause(false));
        bench.pass(0.1);
        if pulls {
            batch(&mut bench, lift());
        }
        bench.pass(0.1);
        assert_eq!(bench.shown().selected.unwrap().force, [0.0; 6], "the body was let go");
        // The speed that is not gravity's.
        let (time, speed) = (bench.shown().time, bench.shown().qvel[2]);
        (time, speed + 9.81 * time)
    };
    let ((time, falls), (pulled_time, rises)) = (run(false), run(true));
    assert!(falls.abs() < 1e-9 && rises > 1e-3, "{falls}, {rises}");
    let timestep = bench().shown().model.timestep();
    assert!((pulled_time - time).abs() < 3.5 * timestep, "the pace stays: {pulled_time}, {time}");
}

#[test]
fn a_run_that_is_paused_before_the_next_turn_takes_a_step() {
    let mut bench = bench();
    let timestep = bench.shown().model.timestep();
    for step in 1..4 {
        batch(&mut bench, [Request::TogglePause, Request::TogglePause]);
        assert!((bench.shown().time - f64::from(step) * timestep).abs() < 1e-12);
        assert_eq!(bench.shown().status, Status::Paused);
    }
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    assert_eq!(bench.mode(), Mode::Trajectory);
    batch(&mut bench, [Request::TogglePause, Request::TogglePause]);
    assert_eq!(bench.shown().playback.unwrap().frame, 1);
}

#[test]
fn a_program_sees_what_a_batch_begins_before_the_batch_ends_it() {
    let (mut front, back) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
    let ball = data.model().body("ball").unwrap().id();
    let mut handle = Handle::new(back);
    handle.sync(&mut data).unwrap();

    // A pull.
    front.ask(Request::SelectBody(Some(ball)));
    for request in lift() {
        front.ask(request);
    }
    handle.sync(&mut data).unwrap();
    assert!(data.xfrc_applied()[ball.index()][2] > 0.0);
    handle.sync(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[ball.index()], [0.0; 6]);

    // A pause.
    front.ask(Request::TogglePause);
    front.ask(Request::TogglePause);
    handle.sync(&mut data).unwrap();
    assert!(handle.is_paused());
    handle.sync(&mut data).unwrap();
    assert!(!handle.is_paused());

    // A drag while paused.
    handle.set_paused(true);
    let height = data.qpos()[2];
    for request in lift() {
        front.ask(request);
    }
    handle.sync(&mut data).unwrap();
    assert!(data.qpos()[2] > height + 0.01);
    assert_eq!(front.latest().unwrap().0.qpos, data.qpos());
}
