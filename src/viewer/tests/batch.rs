//! Requests that reach the simulation in one batch, because its thread was busy or preempted.

use super::{Bench, trajectories};
use crate::scene::{MouseAction, PerturbationFlags};
use crate::viewer::handle::ViewerHandle;
use crate::viewer::link::{EndpointRequest, Mode, Request, SimulationRequest, Status, ViewportPoint, link};
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

/// Executes requests in one tick.
fn batch<R: Into<Request>>(bench: &mut Bench, requests: impl IntoIterator<Item = R>) {
    for request in requests {
        bench.window.send(request);
    }
    bench.tick();
}

/// Returns the requests of a drag from the press of the mouse button to its release.
fn drag(flags: PerturbationFlags, action: MouseAction, motion: [f64; 2]) -> [EndpointRequest; 3] {
    [
        EndpointRequest::StartPerturbation(flags),
        EndpointRequest::MovePerturbation(action, motion),
        EndpointRequest::StopPerturbation,
    ]
}

fn lift() -> [EndpointRequest; 3] {
    drag(PerturbationFlags::TRANSLATE, MouseAction::MoveV, [0.0, -0.2])
}

fn rotate() -> [EndpointRequest; 3] {
    drag(PerturbationFlags::ROTATE, MouseAction::RotateV, [0.2, 0.1])
}

#[test]
fn drag_within_one_tick_moves_and_rotates_the_body() {
    let mut bench = bench();
    let ball = bench.snapshot().model.body("ball").unwrap().id();
    bench.send(EndpointRequest::SelectBody(Some(ball)));
    let before = bench.snapshot().qpos.clone();
    batch(&mut bench, lift());
    let lifted = bench.snapshot().qpos.clone();
    assert!(lifted[2] > before[2] + 0.01, "{lifted:?}");
    batch(&mut bench, rotate());
    let rotated = bench.snapshot().qpos.clone();
    assert_ne!(rotated[3..7], lifted[3..7]);
    assert!(!bench.snapshot().selected.unwrap().active, "the body is released");
    assert_eq!(bench.snapshot().time, 0.0);
}

#[test]
fn batch_has_the_same_effect_as_single_requests() {
    let model = bench().snapshot().model.clone();
    let [ball, hand] = ["ball", "hand"].map(|name| Some(model.body(name).unwrap().id()));
    let select = |body| Request::from(EndpointRequest::SelectBody(body));
    let drag = |requests: [EndpointRequest; 3]| requests.into_iter().map(Request::from);
    let key = || EndpointRequest::LoadKey(model.keyframe("high").unwrap().id()).into();
    let step = |steps| Request::from(SimulationRequest::Step(steps));
    let scrub = |index| Request::from(SimulationRequest::Scrub(index));
    let save = || Request::from(EndpointRequest::SaveKey(None));
    let motor = model.actuator("motor").unwrap().id();
    let hinge = model.joint("hinge").unwrap().id();
    let batches: Vec<Box<dyn Fn() -> Vec<Request>>> = vec![
        // Drags of two bodies.
        Box::new(|| {
            let requests =
                [ball, hand].map(|body| [select(body)].into_iter().chain(drag(lift())).chain(drag(rotate())));
            requests.into_iter().flatten().collect()
        }),
        // Drag that a selection ends.
        Box::new(|| {
            let mut requests = vec![select(ball)];
            requests.extend(drag(lift()).take(2));
            requests.push(select(None));
            requests
        }),
        // Drags before and after a keyframe is loaded.
        Box::new(|| [select(ball)].into_iter().chain(drag(lift())).chain([key()]).chain(drag(lift())).collect()),
        // Runs, pauses and steps.
        Box::new(|| vec![Request::TogglePause, Request::TogglePause]),
        Box::new(|| vec![Request::Pause(false), Request::Pause(true), step(3), step(-1)]),
        Box::new(|| vec![step(5), Request::TogglePause, scrub(2)]),
        Box::new(|| vec![step(5), scrub(2), save(), step(2), Request::Reset]),
        // Controls and positions.
        Box::new(|| {
            vec![
                EndpointRequest::SetControl(motor, 0, 3.0).into(),
                step(4),
                EndpointRequest::ClearControls.into(),
                step(1),
            ]
        }),
        Box::new(|| {
            let set = EndpointRequest::SetPosition(hinge, 0, 0.3);
            vec![set.into(), save(), Request::Reset, EndpointRequest::LoadCaptured(0).into()]
        }),
        Box::new(|| {
            use SimulationRequest::{Faster, Slower, ToggleSpeed};
            [Faster, Faster, ToggleSpeed, ToggleSpeed, Slower].map(Request::from).to_vec()
        }),
    ];
    for (number, requests) in batches.iter().enumerate() {
        let [mut at_once, mut one_at_a_time] = [(); 2].map(|()| Bench::new(Data::new(model.clone()).unwrap()));
        batch(&mut at_once, requests());
        for request in requests() {
            one_at_a_time.send(request);
        }
        let [found, expected] = [&mut at_once, &mut one_at_a_time].map(|bench| {
            let shown = bench.snapshot();
            let numbers = (shown.time, shown.qpos.clone(), shown.qvel.clone(), shown.ctrl.clone());
            let rest =
                (shown.status, shown.speed.target(), shown.history_len, shown.history_position, shown.captured.len());
            (numbers, rest, shown.selected.map(|selected| (selected.body, selected.active)))
        });
        assert_eq!(found, expected, "batch {number}");
    }
}

#[test]
fn click_refers_to_the_view_at_its_time() {
    let mut bench = bench();
    let ball = bench.snapshot().model.body("ball").unwrap().id();
    let middle = ViewportPoint { aspectratio: 1.5, position: [0.5, 0.5] };
    for (before, after, selected) in [(1.0, 50.0, Some(ball)), (50.0, 1.0, None)] {
        bench.view.camera.lookat = [0.0, 0.0, before];
        bench.window.set_view(&bench.view.scene_view());
        bench.window.send(EndpointRequest::Select(middle));
        bench.view.camera.lookat[2] = after;
        bench.tick();
        assert_eq!(bench.snapshot().selected.map(|selected| selected.body), selected);
        assert_eq!(bench.snapshot().camera.lookat[2], after, "the snapshot has the newest view");
    }
}

#[test]
fn deleting_a_keyframe_twice_deletes_no_other() {
    let mut bench = bench();
    batch(&mut bench, [EndpointRequest::SaveKey(None), EndpointRequest::SaveKey(None), EndpointRequest::SaveKey(None)]);
    let second = bench.snapshot().captured[1].number;
    batch(&mut bench, [EndpointRequest::RemoveCaptured(second), EndpointRequest::RemoveCaptured(second)]);
    let names: Vec<_> = bench.snapshot().captured.iter().map(|key| key.name.clone()).collect();
    assert_eq!(names, ["captured_1", "captured_3"]);
}

#[test]
fn pull_within_one_tick_acts_for_one_step() {
    let run = |pulls: bool| {
        let mut bench = bench();
        let ball = bench.snapshot().model.body("ball").unwrap().id();
        bench.send(EndpointRequest::SelectBody(Some(ball)));
        bench.send(Request::Pause(false));
        bench.pass(0.1);
        if pulls {
            batch(&mut bench, lift());
        }
        bench.pass(0.1);
        assert_eq!(bench.snapshot().selected.unwrap().force, [0.0; 6], "the body is released");
        // Velocity that is not due to gravity.
        let (time, speed) = (bench.snapshot().time, bench.snapshot().qvel[2]);
        (time, speed + 9.81 * time)
    };
    let ((time, falls), (pulled_time, rises)) = (run(false), run(true));
    assert!(falls.abs() < 1e-9 && rises > 1e-3, "{falls}, {rises}");
    let timestep = bench().snapshot().model.timestep();
    assert!(
        (pulled_time - time).abs() < 3.5 * timestep,
        "the pull does not change the speed of the simulation: {pulled_time}, {time}"
    );
}

#[test]
fn run_and_pause_within_one_tick_take_a_step() {
    let mut bench = bench();
    let timestep = bench.snapshot().model.timestep();
    for step in 1..4 {
        batch(&mut bench, [Request::TogglePause, Request::TogglePause]);
        assert!((bench.snapshot().time - f64::from(step) * timestep).abs() < 1e-12);
        assert_eq!(bench.snapshot().status, Status::Paused);
    }
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    assert_eq!(bench.mode(), Mode::Trajectory);
    batch(&mut bench, [Request::TogglePause, Request::TogglePause]);
    assert_eq!(bench.snapshot().playback.unwrap().frame, 1);
}

#[test]
fn program_sees_a_pull_and_a_pause_before_the_same_batch_ends_them() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
    let ball = data.model().body("ball").unwrap().id();
    let mut handle = ViewerHandle::new(physics);
    handle.sync(&mut data).unwrap();

    // Pull.
    window.send(EndpointRequest::SelectBody(Some(ball)));
    for request in lift() {
        window.send(request);
    }
    handle.sync(&mut data).unwrap();
    assert!(data.xfrc_applied()[ball.index()][2] > 0.0);
    handle.sync(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[ball.index()], [0.0; 6]);

    // Pause.
    window.send(Request::TogglePause);
    window.send(Request::TogglePause);
    handle.sync(&mut data).unwrap();
    assert!(handle.is_paused());
    handle.sync(&mut data).unwrap();
    assert!(!handle.is_paused());

    // Drag while paused.
    handle.set_paused(true);
    let height = data.qpos()[2];
    for request in lift() {
        window.send(request);
    }
    handle.sync(&mut data).unwrap();
    assert!(data.qpos()[2] > height + 0.01);
    assert_eq!(window.latest().unwrap().0.qpos, data.qpos());
}
