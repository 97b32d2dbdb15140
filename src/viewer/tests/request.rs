//! Requests and their effects.

use std::sync::Arc;

use super::{Bench, trajectories};
use crate::enums::Integrator;
use crate::model::EnableFlags;
use crate::scene::{Camera, CameraView, FrameMode, PerturbationFlags, Scene};
use crate::viewer::endpoint::Watch;
use crate::viewer::link::{
    EndpointRequest, Event, Kept, Mode, PaneView, PlaybackRequest, Request, SceneView, SharedModel, SimulationRequest,
    link,
};
use crate::viewer::view::{Pane, PaneKind};
use crate::{Data, Model, sample};

const TIED: &str = r#"<mujoco>
    <worldbody>
      <body name="hand" mocap="true" pos="0 0 2"><geom size="0.05"/></body>
      <body name="ball" pos="0 0 1"><freejoint name="free"/><geom size="0.1"/></body>
      <body name="pole" pos="1 0 1"><joint name="hinge" axis="0 1 0"/><geom size="0.1" pos="0.1 0 -0.3"/></body>
    </worldbody>
    <actuator><motor name="motor" joint="hinge"/></actuator>
    <sensor><jointpos name="angle" joint="hinge"/></sensor>
    <equality><weld name="tie" body1="ball" body2="hand" active="false"/></equality>
    <keyframe><key name="high" time="3" qpos="0 0 5 1 0 0 0 0.5"/></keyframe>
  </mujoco>"#;

fn tied() -> Bench {
    Bench::new(Data::new(Model::from_xml_str(TIED).unwrap()).unwrap())
}

#[test]
fn controls_and_positions_are_set_and_invalid_values_rejected() {
    let mut bench = tied();
    let model = bench.snapshot().model.clone();
    let (motor, hinge) = (model.actuator("motor").unwrap().id(), model.joint("hinge").unwrap().id());
    bench.send(EndpointRequest::SetControl(motor, 0, 0.25));
    assert_eq!(bench.snapshot().ctrl, [0.25]);
    bench.send(EndpointRequest::SetPosition(hinge, 0, 0.75));
    assert_eq!(bench.snapshot().qpos[7], 0.75);
    assert_eq!(bench.snapshot().signals.sensors[0].value, 0.75, "dependent quantities are recomputed");
    assert!(bench.events().is_empty());
    bench.send(EndpointRequest::SetControl(motor, 0, f64::NAN));
    bench.send(EndpointRequest::SetPosition(hinge, 0, f64::INFINITY));
    bench.send(EndpointRequest::SetPosition(hinge, 5, 1.0));
    assert_eq!((bench.snapshot().ctrl[0], bench.snapshot().qpos[7]), (0.25, 0.75));
    assert!(matches!(&bench.events()[..], [Event::Notice(_), Event::Notice(_)]));
    bench.send(EndpointRequest::ClearControls);
    assert_eq!(bench.snapshot().ctrl, [0.0]);
}

#[test]
fn setting_an_element_of_a_quaternion_normalises_it() {
    let mut bench = tied();
    let free = bench.snapshot().model.joint("free").unwrap().id();
    bench.send(EndpointRequest::SetPosition(free, 4, 1.0));
    let half = 0.5_f64.sqrt();
    let expected = [half, half, 0.0, 0.0];
    assert!(bench.snapshot().qpos[3..7].iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-15));
    bench.send(EndpointRequest::SetPosition(free, 2, 7.0));
    assert_eq!(bench.snapshot().qpos[2], 7.0, "metres are not normalised");
}

#[test]
fn keyframes_are_loaded_captured_and_deleted() {
    let mut bench = tied();
    let key = bench.snapshot().model.keyframe("high").unwrap().id();
    bench.send(EndpointRequest::LoadKey(key));
    assert_eq!((bench.snapshot().time, bench.snapshot().qpos[2], bench.snapshot().qpos[7]), (3.0, 5.0, 0.5));
    bench.send(EndpointRequest::SaveKey(Some("mine".to_owned())));
    bench.send(EndpointRequest::SaveKey(None));
    let names: Vec<_> = bench.snapshot().captured.iter().map(|key| key.name.clone()).collect();
    assert_eq!(names, ["mine", "captured_1"]);
    assert!(bench.snapshot().captured[0].xml.contains("name=\"mine\""));
    bench.send(Request::Reset);
    assert_eq!(bench.snapshot().qpos[2], 1.0);
    bench.send(EndpointRequest::LoadCaptured(0));
    assert_eq!((bench.snapshot().time, bench.snapshot().qpos[2]), (3.0, 5.0));
    bench.send(EndpointRequest::RemoveCaptured(0));
    bench.send(EndpointRequest::RemoveCaptured(7));
    bench.send(EndpointRequest::LoadCaptured(7));
    assert_eq!(bench.snapshot().captured.len(), 1);
    assert_eq!(bench.snapshot().problem, "");
}

#[test]
fn equalities_and_options_change_in_this_simulation_only() {
    let mut bench = tied();
    let before = bench.snapshot().model.clone();
    let tie = before.equality("tie").unwrap().id();
    bench.send(EndpointRequest::SetEquality(tie, true));
    assert!(bench.snapshot().model.equality(tie).active() && !before.equality(tie).active());
    assert!(bench.snapshot().signals.profile[1].value > 0.0, "the constraint is computed immediately");
    let mut options = before.options();
    options.integrator = Integrator::Rk4;
    options.gravity = [0.0, 0.0, 1.0];
    options.enable |= EnableFlags::ENERGY;
    bench.send(EndpointRequest::SetOptions(Box::new(options)));
    assert_eq!(bench.snapshot().model.options(), options);
    assert_ne!(bench.snapshot().signals.profile[4].value, 0.0);
    options.timestep = -1.0;
    bench.send(EndpointRequest::SetOptions(Box::new(options)));
    assert_eq!(bench.snapshot().model.options().timestep, before.timestep());
    let events = bench.events();
    assert!(matches!(&events[..], [Event::Notice(text)] if text.contains("timestep")), "{events:?}");
    assert_eq!(bench.snapshot().generation, 0, "the model was edited, not replaced");
    bench.send(Request::Pause(false));
    assert!(bench.pass(0.1).time > 0.05);
}

#[test]
fn history_is_scrubbed_and_continued() {
    let mut bench = Bench::humanoid();
    bench.send(SimulationRequest::Step(20));
    let newest = bench.snapshot().qpos.clone();
    assert_eq!((bench.snapshot().history_len, bench.snapshot().history_position), (20, 20));
    bench.send(SimulationRequest::Scrub(5));
    let timestep = bench.snapshot().model.timestep();
    assert!((bench.snapshot().time - 5.0 * timestep).abs() < 1e-12);
    assert_eq!((bench.snapshot().history_len, bench.snapshot().history_position), (21, 5));
    bench.send(SimulationRequest::Scrub(1000));
    assert_eq!(bench.snapshot().qpos, newest);
    bench.send(SimulationRequest::Scrub(5));
    bench.send(SimulationRequest::Step(15));
    assert_eq!(bench.snapshot().qpos, newest, "the steps are reproduced bit for bit");
    bench.send(Request::Pause(false));
    bench.send(SimulationRequest::Scrub(0));
    assert_eq!(bench.snapshot().time, 0.0);
    assert_eq!(bench.pass(1.0).time, 0.0, "scrubbing pauses");
}

#[test]
fn fifty_steps_forward_and_back_restore_the_state_bit_for_bit() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    let start = data.state(crate::StateSpec::INTEGRATION);
    let mut bench = Bench::new(data);
    for _ in 0..3 {
        bench.send(SimulationRequest::Step(50));
        bench.send(SimulationRequest::Step(-50));
    }
    assert_eq!(bench.simulation.into_data().state(crate::StateSpec::INTEGRATION), start);
}

#[test]
fn pull_preserves_applied_forces() {
    let mut data = Data::new(Model::from_xml_str(TIED).unwrap()).unwrap();
    let ball = data.model().body("ball").unwrap().id();
    let applied = [0.0, 0.0, 12.5, 0.0, 0.0, 0.0];
    data.xfrc_applied_mut()[ball.index()] = applied;
    let mut bench = Bench::new(data);
    bench.send(EndpointRequest::SelectBody(Some(ball)));
    bench.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    bench.send(Request::Pause(false));
    bench.send(EndpointRequest::MovePerturbation(crate::scene::MouseAction::MoveV, [0.3, 0.0]));
    bench.pass(0.2);
    assert_ne!(bench.snapshot().selected.unwrap().force, [0.0; 6]);
    assert_eq!(bench.simulation.into_data().xfrc_applied()[ball.index()], applied);
}

/// Returns the only watched value.
fn watched(bench: &mut Bench) -> f64 {
    let [watched] = &bench.snapshot().signals.watched[..] else { panic!("one watched value") };
    watched.signal.value
}

#[test]
fn mocap_body_is_dragged_while_running_and_while_paused() {
    let mut bench = tied();
    let hand = bench.snapshot().model.body("hand").unwrap().id();
    bench.send(EndpointRequest::SelectBody(Some(hand)));
    let height = Watch::parse("mocap_pos[2]", &bench.snapshot().model).unwrap();
    bench.send(EndpointRequest::Watch(height));
    assert_eq!(watched(&mut bench), 2.0);
    for paused in [true, false] {
        bench.send(Request::Pause(paused));
        let before = watched(&mut bench);
        bench.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
        bench.send(EndpointRequest::MovePerturbation(crate::scene::MouseAction::MoveV, [0.0, -0.1]));
        bench.pass(0.05);
        assert!(watched(&mut bench) > before, "paused: {paused}");
        bench.send(EndpointRequest::StopPerturbation);
    }
}

#[test]
fn world_cannot_be_pulled() {
    let mut bench = tied();
    let world = bench.snapshot().model.body(0).unwrap().id();
    bench.send(EndpointRequest::SelectBody(Some(world)));
    bench.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    bench.send(EndpointRequest::MovePerturbation(crate::scene::MouseAction::MoveV, [0.3, 0.0]));
    assert!(!bench.snapshot().selected.unwrap().active);
    bench.send(EndpointRequest::SelectParent);
    assert_eq!(bench.snapshot().selected.unwrap().body, world, "the world is its own parent");
    bench.send(EndpointRequest::SelectBody(None));
    bench.send(EndpointRequest::SelectParent);
    assert_eq!(bench.snapshot().selected, None);
}

#[test]
fn model_is_replaced_and_ids_of_the_old_model_are_ignored() {
    let mut bench = tied();
    let old = bench.snapshot().model.clone();
    bench.send(EndpointRequest::SelectBody(Some(old.body("ball").unwrap().id())));
    bench.send(SimulationRequest::Step(5));
    bench.view.camera = crate::scene::Camera::tracking(&old, "ball").unwrap();
    bench.tick();
    bench.send(SimulationRequest::Load(SharedModel(Arc::new(sample::humanoid())), Kept::Nothing));
    assert_eq!(bench.snapshot().model.nq(), 28);
    assert_eq!((bench.snapshot().generation, bench.snapshot().selected), (1, None));
    assert_eq!((bench.snapshot().history_len, bench.snapshot().time), (0, 0.0));
    for request in [
        EndpointRequest::SetControl(old.actuator("motor").unwrap().id(), 0, 1.0),
        EndpointRequest::SetPosition(old.joint("hinge").unwrap().id(), 0, 1.0),
        EndpointRequest::LoadKey(old.keyframe("high").unwrap().id()),
        EndpointRequest::SetEquality(old.equality("tie").unwrap().id(), true),
        EndpointRequest::SelectBody(Some(old.body("ball").unwrap().id())),
    ] {
        bench.send(request);
    }
    let snapshot = bench.snapshot();
    assert_eq!(snapshot.qpos, snapshot.model.qpos0());
    assert!(bench.events().is_empty());
    assert_eq!(bench.snapshot().problem, "");
    bench.view.camera = bench.snapshot().camera;
    bench.view.options.frame = FrameMode::Body;
    bench.send(Request::Pause(false));
    assert!(bench.pass(0.1).time > 0.05);
    bench.send(Request::Reset);
    assert!(bench.snapshot().time < 0.01);
}

#[test]
fn camera_and_selection_remain_after_the_file_is_loaded_again() {
    let text = |bodies: &str| format!("<mujoco><worldbody><camera name='side'/>{bodies}</worldbody></mujoco>");
    let ball = "<body name='ball' pos='0 0 1'><freejoint/><geom name='skin' size='.1'/></body>";
    let [first, edited] = [text(ball), text(&["<body name='block'><geom size='.2'/></body>", ball].concat())];
    let model = |text: &str| Arc::new(Model::from_xml_str(text).unwrap());
    for kept in [Kept::View, Kept::State] {
        let mut bench = Bench::with(Data::new(model(&first)).unwrap(), None, Vec::new());
        let old = bench.snapshot().model.clone();
        bench.view.camera = Camera { azimuth: 12.0, ..Camera::tracking(&old, "ball").unwrap() };
        bench.send(EndpointRequest::SelectBody(Some(old.body("ball").unwrap().id())));
        bench.send(SimulationRequest::Step(5));
        let time = bench.snapshot().time;
        bench.send(SimulationRequest::Load(SharedModel(model(&edited)), kept));
        let snapshot = bench.snapshot();
        let (ball, camera) = (snapshot.model.body("ball").unwrap().id(), snapshot.camera);
        assert_eq!((camera.view, camera.azimuth), (CameraView::Tracking(ball), 12.0));
        assert_eq!(snapshot.selected.unwrap().body, ball);
        assert_eq!(snapshot.time, if kept == Kept::State { time } else { 0.0 });

        bench.view.camera = camera;
        bench.send(SimulationRequest::Load(SharedModel(model(&text(""))), kept));
        assert_eq!((bench.snapshot().camera.view, bench.snapshot().selected), (CameraView::Free, None));
    }
}

#[test]
fn snapshots_have_the_viewpoints_of_panes_and_of_the_main_camera() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let side = data.model().camera("side").unwrap().id();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    scene.update_camera(&data, &mut Camera::fixed(data.model(), side)).unwrap();
    let mut bench = Bench::new(data);
    let main = bench.snapshot().scene.viewpoints();
    bench.view.panes = vec![Pane { camera: side, kind: PaneKind::Depth }];
    let snapshot = bench.tick();
    assert_eq!(snapshot.panes, [PaneView { camera: side, viewpoints: scene.viewpoints() }]);
    assert_eq!(snapshot.scene.viewpoints(), main);
    bench.view.panes.clear();
    assert_eq!(bench.tick().panes, []);
}

#[test]
fn trajectories_of_another_model_are_dropped() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    bench.send(SimulationRequest::Load(SharedModel(Arc::new(sample::cartpole())), Kept::Nothing));
    assert_eq!(bench.mode(), Mode::Trajectory);
    bench.send(SimulationRequest::Load(SharedModel(Arc::new(sample::humanoid())), Kept::Nothing));
    assert_eq!((bench.mode(), bench.snapshot().modes.len()), (Mode::Passive, 1));
    bench.send(PlaybackRequest::CycleTrajectory(1));
    bench.send(SimulationRequest::SetMode(Mode::Controller));
    assert_eq!(bench.mode(), Mode::Passive);
}

#[test]
fn copied_camera_has_the_same_viewpoint_in_a_model() {
    let mut bench = tied();
    bench.view.camera.azimuth = 33.0;
    bench.view.camera.elevation = -21.0;
    bench.tick();
    bench.send(EndpointRequest::CopyCamera);
    let events = bench.events();
    let [Event::Copied(camera)] = &events[..] else { panic!("{events:?}") };
    let text = TIED.replace("<worldbody>", &format!("<worldbody>{camera}"));
    let free = bench.snapshot().scene.viewpoint();
    let mut with = Bench::new(Data::new(Model::from_xml_str(&text).unwrap()).unwrap());
    let camera = with.snapshot().model.camera(0).unwrap().id();
    with.view.camera.view = crate::scene::CameraView::Fixed(camera);
    let fixed = with.tick().scene.viewpoint();
    for (one, other) in [(free.pos, fixed.pos), (free.forward, fixed.forward), (free.up, fixed.up)] {
        assert!((0..3).all(|axis| (one[axis] - other[axis]).abs() < 1e-5), "{one:?}, {other:?}");
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer engines ignore njmax")]
fn engine_warning_is_reported_once() {
    let text = r#"<mujoco><size nconmax="1"/><worldbody>
        <geom type="plane" size="5 5 1"/>
        <body pos="0 0 0.1"><freejoint/><geom size="0.1"/></body>
        <body pos="1 0 0.1"><freejoint/><geom size="0.1"/></body>
      </worldbody></mujoco>"#;
    let mut bench = Bench::new(Data::new(Model::from_xml_str(text).unwrap()).unwrap());
    let events = bench.events();
    assert!(matches!(&events[..], [Event::Notice(text)] if text.contains("nconmax")), "{events:?}");
    for _ in 0..5 {
        bench.send(SimulationRequest::Step(1));
    }
    assert!(bench.events().is_empty());
}

#[test]
fn pausing_and_publishing_do_not_change_the_simulation() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut alone = data.clone();
    let mut bench = Bench::new(data);
    bench.view.options.flags |= crate::scene::VisualFlags::CONTACTFORCE;
    for paused in [false, true, false, true, false, true] {
        bench.send(Request::Pause(paused));
        bench.pass(0.1);
        bench.send(SimulationRequest::Step(3));
    }
    let data = bench.simulation.into_data();
    while alone.time() < data.time() {
        alone.step().unwrap();
    }
    assert!(data.time() > 0.25);
    assert_eq!(alone.state(crate::StateSpec::INTEGRATION), data.state(crate::StateSpec::INTEGRATION));
}

#[test]
fn queued_motions_are_merged() {
    let (mut window, physics) = link(|| ());
    let motion = |x| EndpointRequest::MovePerturbation(crate::scene::MouseAction::MoveV, [x, 0.25]);
    for _ in 0..100 {
        window.send(motion(0.5));
    }
    assert!(matches!(physics.next(), Some(Request::Endpoint(EndpointRequest::MovePerturbation(_, [50.0, 25.0])))));
    assert!(physics.next().is_none());
    // The queue is bounded.
    for _ in 0..100_000 {
        window.send(Request::TogglePause);
    }
    assert!(std::iter::from_fn(|| physics.next()).count() <= 4096);
    window.set_view(&SceneView::default());
    assert!(physics.take_view().is_some());
    window.set_view(&SceneView::default());
    assert!(physics.take_view().is_none(), "an unchanged view is not sent again");
}
