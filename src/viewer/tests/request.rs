//! Every request does what it says.

use std::sync::Arc;

use super::{Bench, trajectories};
use crate::scene::{FrameMode, PerturbationFlags};
use crate::viewer::event::Event;
use crate::viewer::mode::Mode;
use crate::viewer::request::Request;
use crate::{Data, EnableFlags, Integrator, Model, sample};

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
fn controls_and_positions_are_set_and_wrong_ones_are_refused() {
    let mut bench = tied();
    let model = bench.shown().model.clone();
    let (motor, hinge) = (model.actuator("motor").unwrap().id(), model.joint("hinge").unwrap().id());
    bench.ask(Request::SetControl(motor, 0.25));
    assert_eq!(bench.shown().ctrl, [0.25]);
    bench.ask(Request::SetPosition(hinge, 0, 0.75));
    assert_eq!(bench.shown().qpos[7], 0.75);
    assert_eq!(bench.shown().sensordata, [0.75], "what depends on it is up to date");
    assert!(bench.events().is_empty());
    bench.ask(Request::SetControl(motor, f64::NAN));
    bench.ask(Request::SetPosition(hinge, 0, f64::INFINITY));
    bench.ask(Request::SetPosition(hinge, 5, 1.0));
    assert_eq!((bench.shown().ctrl[0], bench.shown().qpos[7]), (0.25, 0.75));
    assert!(matches!(&bench.events()[..], [Event::Notice(_), Event::Notice(_)]));
    bench.ask(Request::ClearControls);
    assert_eq!(bench.shown().ctrl, [0.0]);
}

#[test]
fn a_part_of_a_quaternion_that_is_set_leaves_it_a_rotation() {
    let mut bench = tied();
    let free = bench.shown().model.joint("free").unwrap().id();
    bench.ask(Request::SetPosition(free, 4, 1.0));
    let half = 0.5_f64.sqrt();
    let expected = [half, half, 0.0, 0.0];
    assert!(bench.shown().qpos[3..7].iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-15));
    bench.ask(Request::SetPosition(free, 2, 7.0));
    assert_eq!(bench.shown().qpos[2], 7.0, "metres are not normalised");
}

#[test]
fn keyframes_are_loaded_kept_and_loaded_again() {
    let mut bench = tied();
    let key = bench.shown().model.keyframe("high").unwrap().id();
    bench.ask(Request::LoadKey(key));
    assert_eq!((bench.shown().time, bench.shown().qpos[2], bench.shown().qpos[7]), (3.0, 5.0, 0.5));
    bench.ask(Request::SaveKey(Some("mine".to_owned())));
    bench.ask(Request::SaveKey(None));
    let names: Vec<_> = bench.shown().captured.iter().map(|key| key.name.clone()).collect();
    assert_eq!(names, ["mine", "captured_1"]);
    assert!(bench.shown().captured[0].xml.contains("name=\"mine\""));
    bench.ask(Request::Reset);
    assert_eq!(bench.shown().qpos[2], 1.0);
    bench.ask(Request::LoadCaptured(0));
    assert_eq!((bench.shown().time, bench.shown().qpos[2]), (3.0, 5.0));
    bench.ask(Request::RemoveCaptured(0));
    bench.ask(Request::RemoveCaptured(7));
    bench.ask(Request::LoadCaptured(7));
    assert_eq!(bench.shown().captured.len(), 1);
    assert_eq!(bench.shown().problem, "");
}

#[test]
fn equalities_and_options_are_switched_for_this_simulation_only() {
    let mut bench = tied();
    let before = bench.shown().model.clone();
    let tie = before.equality("tie").unwrap().id();
    bench.ask(Request::SetEquality(tie, true));
    assert!(bench.shown().model.equality(tie).active() && !before.equality(tie).active());
    assert!(bench.shown().nefc > 0, "it is computed at once");
    let mut options = before.options();
    options.integrator = Integrator::Rk4;
    options.gravity = [0.0, 0.0, 1.0];
    options.enable |= EnableFlags::ENERGY;
    bench.ask(Request::SetOptions(Box::new(options)));
    assert_eq!(bench.shown().model.options(), options);
    assert_ne!(bench.shown().energy[0], 0.0);
    options.timestep = -1.0;
    bench.ask(Request::SetOptions(Box::new(options)));
    assert_eq!(bench.shown().model.options().timestep, before.timestep());
    let events = bench.events();
    assert!(matches!(&events[..], [Event::Notice(text)] if text.contains("timestep")), "{events:?}");
    assert_eq!(bench.shown().generation, 0, "it is the same model");
    bench.ask(Request::Pause(false));
    assert!(bench.pass(0.1).time > 0.05);
}

#[test]
fn the_past_is_gone_through_and_gone_on_from() {
    let mut bench = Bench::humanoid();
    bench.ask(Request::Step(20));
    let newest = bench.shown().qpos.clone();
    assert_eq!((bench.shown().history, bench.shown().moment), (20, 20));
    bench.ask(Request::Scrub(5));
    let timestep = bench.shown().model.timestep();
    assert!((bench.shown().time - 5.0 * timestep).abs() < 1e-12);
    assert_eq!((bench.shown().history, bench.shown().moment), (21, 5));
    bench.ask(Request::Scrub(1000));
    assert_eq!(bench.shown().qpos, newest);
    bench.ask(Request::Scrub(5));
    bench.ask(Request::Step(15));
    assert_eq!(bench.shown().qpos, newest, "it happens again, bit for bit");
    bench.ask(Request::Pause(false));
    bench.ask(Request::Scrub(0));
    assert_eq!(bench.shown().time, 0.0);
    assert_eq!(bench.pass(1.0).time, 0.0, "who looks at the past has paused");
}

#[test]
fn fifty_steps_forward_and_fifty_back_restore_everything_bit_for_bit() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    let start = data.state(crate::StateSpec::INTEGRATION);
    let mut bench = Bench::new(data);
    for _ in 0..3 {
        bench.ask(Request::Step(50));
        bench.ask(Request::Step(-50));
    }
    assert_eq!(bench.simulation.into_data().state(crate::StateSpec::INTEGRATION), start);
}

#[test]
fn forces_that_the_program_applies_survive_a_pull() {
    let mut data = Data::new(Model::from_xml_str(TIED).unwrap()).unwrap();
    let ball = data.model().body("ball").unwrap().id();
    let applied = [0.0, 0.0, 12.5, 0.0, 0.0, 0.0];
    data.xfrc_applied_mut()[ball.index()] = applied;
    let mut bench = Bench::new(data);
    bench.ask(Request::SelectBody(Some(ball)));
    bench.ask(Request::StartPerturbation(PerturbationFlags::TRANSLATE));
    bench.ask(Request::Pause(false));
    bench.ask(Request::MovePerturbation(crate::scene::MouseAction::MoveV, [0.3, 0.0]));
    bench.pass(0.2);
    assert_ne!(bench.shown().selected.unwrap().force, [0.0; 6]);
    assert_eq!(bench.simulation.into_data().xfrc_applied()[ball.index()], applied);
}

#[test]
fn a_mocap_body_is_dragged_while_it_runs_and_while_it_stands() {
    let mut bench = tied();
    let hand = bench.shown().model.body("hand").unwrap().id();
    bench.ask(Request::SelectBody(Some(hand)));
    bench.ask(Request::Watch(vec!["mocap_pos[2]".parse().unwrap()]));
    assert_eq!(bench.shown().watched, [2.0]);
    for paused in [true, false] {
        bench.ask(Request::Pause(paused));
        let before = bench.shown().watched[0];
        bench.ask(Request::StartPerturbation(PerturbationFlags::TRANSLATE));
        bench.ask(Request::MovePerturbation(crate::scene::MouseAction::MoveV, [0.0, -0.1]));
        bench.pass(0.05);
        assert!(bench.shown().watched[0] > before, "paused: {paused}");
        bench.ask(Request::StopPerturbation);
    }
}

#[test]
fn the_world_is_not_pulled_and_nothing_follows_it() {
    let mut bench = tied();
    let world = bench.shown().model.body(0).unwrap().id();
    bench.ask(Request::SelectBody(Some(world)));
    bench.ask(Request::StartPerturbation(PerturbationFlags::TRANSLATE));
    bench.ask(Request::MovePerturbation(crate::scene::MouseAction::MoveV, [0.3, 0.0]));
    assert!(!bench.shown().selected.unwrap().active);
    bench.ask(Request::SelectParent);
    assert_eq!(bench.shown().selected.unwrap().body, world, "the world has no parent but itself");
    bench.ask(Request::SelectBody(None));
    bench.ask(Request::SelectParent);
    assert_eq!(bench.shown().selected, None);
}

#[test]
fn another_model_is_gone_on_with_and_ids_of_the_old_one_are_ignored() {
    let mut bench = tied();
    let old = bench.shown().model.clone();
    bench.ask(Request::SelectBody(Some(old.body("ball").unwrap().id())));
    bench.ask(Request::Step(5));
    bench.view.camera = crate::scene::Camera::tracking(&old, old.body("ball").unwrap().id());
    bench.turn();
    bench.ask(Request::Reload(Arc::new(sample::humanoid())));
    assert_eq!(bench.shown().model.nq(), 28);
    assert_eq!((bench.shown().generation, bench.shown().selected), (1, None));
    assert_eq!((bench.shown().history, bench.shown().time), (0, 0.0));
    for request in [
        Request::SetControl(old.actuator("motor").unwrap().id(), 1.0),
        Request::SetPosition(old.joint("hinge").unwrap().id(), 0, 1.0),
        Request::LoadKey(old.keyframe("high").unwrap().id()),
        Request::SetEquality(old.equality("tie").unwrap().id(), true),
        Request::SelectBody(Some(old.body("ball").unwrap().id())),
    ] {
        bench.ask(request);
    }
    let snapshot = bench.shown();
    assert_eq!(snapshot.qpos, snapshot.model.qpos0());
    assert!(bench.events().is_empty());
    assert_eq!(bench.shown().problem, "");
    let model = bench.shown().model.clone();
    bench.view.model_replaced(&model);
    bench.view.options.frame = FrameMode::Body;
    bench.ask(Request::Pause(false));
    assert!(bench.pass(0.1).time > 0.05);
    bench.ask(Request::Reset);
    assert!(bench.shown().time < 0.01);
}

#[test]
fn trajectories_that_do_not_fit_another_model_are_left_out() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    bench.ask(Request::Reload(Arc::new(sample::cartpole())));
    assert_eq!(bench.mode(), Mode::Trajectory);
    bench.ask(Request::Reload(Arc::new(sample::humanoid())));
    assert_eq!((bench.mode(), bench.shown().modes.len()), (Mode::Passive, 1));
    bench.ask(Request::CycleTrajectory(1));
    bench.ask(Request::SetMode(Mode::Controller));
    assert_eq!(bench.mode(), Mode::Passive);
}

#[test]
fn a_copied_camera_sees_the_same_when_a_model_has_it() {
    let mut bench = tied();
    bench.view.camera.azimuth = 33.0;
    bench.view.camera.elevation = -21.0;
    bench.turn();
    bench.ask(Request::CopyCamera);
    let events = bench.events();
    let [Event::Copied(camera)] = &events[..] else { panic!("{events:?}") };
    let text = TIED.replace("<worldbody>", &format!("<worldbody>{camera}"));
    let free = bench.shown().scene.viewpoint();
    let mut with = Bench::new(Data::new(Model::from_xml_str(&text).unwrap()).unwrap());
    let camera = with.shown().model.camera(0).unwrap().id();
    with.view.camera.view = crate::scene::CameraView::Fixed(camera);
    let fixed = with.turn().scene.viewpoint();
    for (one, other) in [(free.pos, fixed.pos), (free.forward, fixed.forward), (free.up, fixed.up)] {
        assert!((0..3).all(|axis| (one[axis] - other[axis]).abs() < 1e-5), "{one:?}, {other:?}");
    }
}

#[test]
fn a_warning_of_the_engine_is_told_once() {
    let text = r#"<mujoco><size nconmax="1"/><worldbody>
        <geom type="plane" size="5 5 1"/>
        <body pos="0 0 0.1"><freejoint/><geom size="0.1"/></body>
        <body pos="1 0 0.1"><freejoint/><geom size="0.1"/></body>
      </worldbody></mujoco>"#;
    let mut bench = Bench::new(Data::new(Model::from_xml_str(text).unwrap()).unwrap());
    let events = bench.events();
    assert!(matches!(&events[..], [Event::Notice(text)] if text.contains("nconmax")), "{events:?}");
    for _ in 0..5 {
        bench.ask(Request::Step(1));
    }
    assert!(bench.events().is_empty());
}

#[test]
fn pausing_and_looking_on_do_not_change_what_happens() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut alone = data.clone();
    let mut bench = Bench::new(data);
    bench.view.options.flags |= crate::scene::VisualFlags::CONTACTFORCE;
    for paused in [false, true, false, true, false, true] {
        bench.ask(Request::Pause(paused));
        bench.pass(0.1);
        bench.ask(Request::Step(3));
    }
    let data = bench.simulation.into_data();
    while alone.time() < data.time() {
        alone.step().unwrap();
    }
    assert!(data.time() > 0.25);
    assert_eq!(alone.state(crate::StateSpec::INTEGRATION), data.state(crate::StateSpec::INTEGRATION));
}

#[test]
fn motions_that_wait_become_one() {
    let (mut front, back) = crate::viewer::link::link(|| ());
    let motion = |x| Request::MovePerturbation(crate::scene::MouseAction::MoveV, [x, 0.25]);
    for _ in 0..100 {
        front.ask(motion(0.5));
    }
    assert!(matches!(back.next(), Some(Request::MovePerturbation(_, [50.0, 25.0]))));
    assert!(back.next().is_none());
    // A program that never looks is not handed all that was ever asked for.
    for _ in 0..100_000 {
        front.ask(Request::TogglePause);
    }
    assert!(std::iter::from_fn(|| back.next()).count() <= 4096);
    front.look(&crate::viewer::link::Look::default());
    assert!(back.look().is_some());
    front.look(&crate::viewer::link::Look::default());
    assert!(back.look().is_none(), "what was said is not said again");
}
