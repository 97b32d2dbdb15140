//! Programs that have a loop of their own.

use std::time::{Duration, Instant};

use crate::scene::{Camera, CameraView, FrameMode, MouseAction, NewGeom, PerturbationFlags, SceneOptions};
use crate::viewer::handle::Handle;
use crate::viewer::input::{Key, KeyPress, Modifiers};
use crate::viewer::link::{
    Asset, EndpointRequest, Event, Request, SimulationRequest, Snapshot, Status, WindowEnd, link,
};
use crate::viewer::view::View;
use crate::{Data, Error, Model, sample};

fn shown(window: &mut WindowEnd) -> &mut Snapshot {
    window.latest().expect("a snapshot").0
}

fn squatting() -> (WindowEnd, Handle, Data) {
    let (window, physics) = link(|| ());
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut handle = Handle::new(physics);
    handle.sync(&mut data).unwrap();
    (window, handle, data)
}

#[test]
fn the_window_sees_what_the_program_does() {
    let (mut window, mut handle, mut data) = squatting();
    for _ in 0..10 {
        data.step().unwrap();
        handle.sync(&mut data).unwrap();
        assert_eq!(shown(&mut window).time, data.time());
        assert_eq!(shown(&mut window).qpos, data.qpos());
    }
    assert_eq!(shown(&mut window).status, Status::Program);
    assert!(shown(&mut window).scene.ngeom() > 10);
}

#[test]
fn looking_on_does_not_change_what_happens() {
    let (_front, mut handle, mut data) = squatting();
    let mut alone = Data::new(data.model().clone()).unwrap();
    alone.reset_to_key("squat").unwrap();
    for _ in 0..100 {
        alone.step().unwrap();
        data.step().unwrap();
        handle.sync(&mut data).unwrap();
    }
    assert_eq!(data.state(crate::StateSpec::INTEGRATION), alone.state(crate::StateSpec::INTEGRATION));
}

#[test]
fn what_the_user_asks_for_is_done_to_the_programs_simulation() {
    let (mut window, mut handle, mut data) = squatting();
    let start = data.qpos().to_vec();
    let actuator = data.model().actuator(0).unwrap().id();
    window.send(EndpointRequest::SetControl(actuator, 0.5));
    handle.sync(&mut data).unwrap();
    assert_eq!(data.ctrl()[0], 0.5);
    for _ in 0..20 {
        data.step().unwrap();
    }
    window.send(Request::Reset);
    handle.sync(&mut data).unwrap();
    assert_eq!((data.qpos(), data.time()), (&start[..], 0.0), "the state in which the window saw it first");
    window.send(EndpointRequest::CopyState);
    window.send(SimulationRequest::Step(1));
    handle.sync(&mut data).unwrap();
    let events = window.take_events();
    assert!(matches!(&events[..], [Event::Copied(_), Event::Notice(_)]), "{events:?}");
    assert_eq!(data.time(), 0.0, "steps are the program's");
    assert_eq!(shown(&mut window).qpos, start);
}

#[test]
fn pausing_is_told_to_the_program() {
    let (mut window, mut handle, mut data) = squatting();
    assert!(!handle.is_paused());
    window.send(Request::TogglePause);
    handle.sync(&mut data).unwrap();
    assert!(handle.is_paused());
    assert_eq!(shown(&mut window).status, Status::Paused);
    handle.set_paused(false);
    handle.sync(&mut data).unwrap();
    assert_eq!(shown(&mut window).status, Status::Program);
}

#[test]
fn a_body_is_pulled_and_forces_of_the_program_stay() {
    let (mut window, mut handle, mut data) = squatting();
    let torso = data.model().body("torso").unwrap().id();
    let own = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0];
    data.xfrc_applied_mut()[torso.index()] = own;
    window.send(EndpointRequest::SelectBody(Some(torso)));
    window.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    window.send(EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.5]));
    for _ in 0..5 {
        handle.sync(&mut data).unwrap();
        let force = shown(&mut window).selected.unwrap().force;
        assert!(force[2] > 1.0);
        assert_eq!(data.xfrc_applied()[torso.index()], std::array::from_fn(|i| own[i] + force[i]));
        data.step().unwrap();
    }
    assert_eq!(handle.selected(), Some(torso));
    window.send(EndpointRequest::StopPerturbation);
    handle.sync(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[torso.index()], own);
    // While it stands, it is moved.
    handle.set_paused(true);
    let height = data.qpos()[2];
    window.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    window.send(EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.2]));
    handle.sync(&mut data).unwrap();
    assert!(data.qpos()[2] > height + 0.05);
    assert_eq!(data.xfrc_applied()[torso.index()], own);
}

#[test]
fn a_window_that_is_closed_lets_the_body_go() {
    let (window, mut handle, mut data) = squatting();
    let torso = data.model().body("torso").unwrap().id();
    window.send(EndpointRequest::SelectBody(Some(torso)));
    window.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    window.send(EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.5]));
    handle.sync(&mut data).unwrap();
    assert_ne!(data.xfrc_applied()[torso.index()], [0.0; 6]);
    handle.set_paused(true);
    drop(window);
    assert!(!handle.is_running());
    handle.sync(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[torso.index()], [0.0; 6]);
    assert!(!handle.is_paused(), "a program that waits for the user goes on");
}

#[test]
fn what_the_program_has_changed_is_drawn_anew_once() {
    let text = r#"<mujoco><asset><hfield name="ground" nrow="2" ncol="2" size="1 1 1 1"/></asset>
        <worldbody><geom type="hfield" hfield="ground"/></worldbody></mujoco>"#;
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    let mut handle = Handle::new(physics);
    handle.sync(&mut data).unwrap();
    let ground = data.model().height_field("ground").unwrap().id();
    data.edit_model(|model| model.hfield_data_mut()[0] = 0.5).unwrap();
    handle.update_height_field(ground);
    handle.sync(&mut data).unwrap();
    assert_eq!(window.take_events(), [Event::Asset(Asset::HeightField(ground))]);
    assert_eq!(shown(&mut window).model.hfield_data()[0], 0.5);
    assert_eq!(shown(&mut window).generation, 0);
    handle.sync(&mut data).unwrap();
    assert!(window.take_events().is_empty());
    // What is said of a model is said of the one that is there, or not at all.
    let mut other = Data::new(sample::cartpole()).unwrap();
    handle.update_height_field(ground);
    handle.sync(&mut other).unwrap();
    assert!(window.take_events().is_empty());
    assert_eq!(window.current().unwrap().model.nq(), 2, "the newest snapshot comes with the events");
    assert!(window.latest().unwrap().1, "and is new still");
    assert!(!window.latest().unwrap().1);
}

#[test]
fn geoms_of_the_program_are_shown_until_they_are_taken_out() {
    let (mut window, mut handle, mut data) = squatting();
    let before = shown(&mut window).scene.ngeom();
    handle.geoms_mut().push(NewGeom::sphere(0.1).label("goal").unwrap());
    for _ in 0..3 {
        handle.sync(&mut data).unwrap();
        let scene = &shown(&mut window).scene;
        assert_eq!((scene.ngeom(), scene.geom(before).label()), (before + 1, "goal"));
    }
    handle.geoms_mut().clear();
    handle.sync(&mut data).unwrap();
    assert_eq!(shown(&mut window).scene.ngeom(), before);
    handle.geoms_mut().push(NewGeom::sphere(f64::NAN));
    assert!(matches!(handle.sync(&mut data), Err(Error::Invalid { .. })));
    handle.geoms_mut().clear();
    handle.geoms_mut().resize(20_000, NewGeom::sphere(0.1));
    handle.sync(&mut data).unwrap();
    handle.sync(&mut data).unwrap();
    let events = window.take_events();
    assert!(matches!(&events[..], [Event::Notice(text)] if text.contains("room")), "told once: {events:?}");
}

#[test]
fn camera_and_options_are_read_and_set() {
    let (mut window, physics) = link(|| ());
    let mut handle = Handle::new(physics);
    assert_eq!(handle.camera(), None);
    let options = SceneOptions { frame: FrameMode::Body, ..SceneOptions::default() };
    handle.set_options(options.clone());
    let mut data = Data::new(sample::humanoid()).unwrap();
    let torso = data.model().body("torso").unwrap().id();
    handle.sync(&mut data).unwrap();
    assert_eq!(handle.options(), options);
    let mut view = View::new(data.model());
    handle.set_camera(Camera::tracking(data.model(), torso));
    handle.sync(&mut data).unwrap();
    for event in window.take_events() {
        view.handle_event(&event);
    }
    assert_eq!(view.camera.view, CameraView::Tracking(torso));
    assert_eq!(view.options, options, "the window knows");
    view.camera.azimuth = 12.0;
    window.set_view(&view.scene_view());
    handle.sync(&mut data).unwrap();
    assert_eq!(handle.camera().unwrap().azimuth, 12.0, "the user has turned it");
    assert_eq!(shown(&mut window).camera.view, CameraView::Tracking(torso));
}

#[test]
#[should_panic(expected = "of another model")]
fn a_camera_of_another_model_is_a_mistake() {
    let (_front, mut handle, _data) = squatting();
    let other = sample::cartpole();
    handle.set_camera(Camera::tracking(&other, other.body("cart").unwrap().id()));
}

#[test]
fn keys_that_the_viewer_has_no_use_for_are_the_programs() {
    let (window, mut handle, mut data) = squatting();
    let press = KeyPress { key: Key::Home, modifiers: Modifiers::ALT, repeat: false };
    window.send(EndpointRequest::ForwardKey(press));
    assert!(handle.keys().is_empty());
    handle.sync(&mut data).unwrap();
    assert_eq!(handle.keys(), [press]);
    assert!(handle.keys().is_empty());
    for _ in 0..10_000 {
        window.send(EndpointRequest::ForwardKey(press));
    }
    handle.sync(&mut data).unwrap();
    assert!(handle.keys().len() <= 256, "a program that does not ask is not drowned");
}

#[test]
fn a_simulation_that_has_failed_is_told_of_and_reset_from_the_window() {
    let text = r#"<mujoco><option timestep="0.1"/>
        <worldbody><body><joint type="slide" stiffness="1e6"/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.qpos_mut()[0] = 1.0;
    let mut handle = Handle::new(physics);
    handle.sync(&mut data).unwrap();
    while data.step().is_ok() {}
    handle.sync(&mut data).unwrap();
    assert!(shown(&mut window).problem.contains("unusable"), "{}", shown(&mut window).problem);
    window.send(Request::Reset);
    handle.sync(&mut data).unwrap();
    assert_eq!((data.qpos(), shown(&mut window).problem.as_str()), (&[1.0][..], ""));
    data.step().unwrap();
}

#[test]
fn another_simulation_may_be_shown_with_the_next_look() {
    let (mut window, mut handle, _) = squatting();
    let mut other = Data::new(sample::cartpole()).unwrap();
    handle.sync(&mut other).unwrap();
    assert_eq!((shown(&mut window).generation, shown(&mut window).qpos.len()), (1, 2));
    other.qpos_mut()[0] = 0.3;
    window.send(Request::Reset);
    handle.sync(&mut other).unwrap();
    assert_eq!(other.qpos()[0], 0.0, "its own start");
}

#[test]
fn waiting_ends_when_the_user_asks_for_something_or_closes_the_window() {
    let (window, mut handle, mut data) = squatting();
    window.send(Request::TogglePause);
    let start = Instant::now();
    handle.wait(Duration::from_secs(600));
    handle.sync(&mut data).unwrap();
    handle.wait(Duration::from_millis(1));
    window.close();
    handle.wait(Duration::MAX);
    assert!(!handle.is_running());
    assert!(start.elapsed() < Duration::from_secs(60));
    // It does no harm any more.
    handle.sync(&mut data).unwrap();
}
