//! Programs that step their simulation themselves.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use crate::scene::{Camera, CameraView, FrameMode, MouseAction, NewGeom, PerturbationFlags, SceneOptions};
use crate::viewer::handle::ViewerHandle;
use crate::viewer::input::{Key, KeyPress, Modifiers};
use crate::viewer::link::{
    Asset, EndpointRequest, Event, Request, SimulationRequest, Snapshot, Status, WindowEnd, link,
};
use crate::viewer::view::View;
use crate::{Data, Error, Model, sample};

fn newest(window: &mut WindowEnd) -> &mut Snapshot {
    window.latest().expect("a snapshot").0
}

fn squatting() -> (WindowEnd, ViewerHandle, Data) {
    let (window, physics) = link(|| ());
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut handle = ViewerHandle::new(physics);
    handle.sync(&mut data).unwrap();
    (window, handle, data)
}

#[test]
fn window_shows_the_state_of_the_program() {
    let (mut window, mut handle, mut data) = squatting();
    for _ in 0..10 {
        data.step().unwrap();
        handle.sync(&mut data).unwrap();
        assert_eq!(newest(&mut window).time, data.time());
        assert_eq!(newest(&mut window).qpos, data.qpos());
    }
    assert_eq!(newest(&mut window).status, Status::Program);
    assert!(newest(&mut window).scene.ngeom() > 10);
}

#[test]
fn sync_does_not_change_the_simulation() {
    let (_window, mut handle, mut data) = squatting();
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
fn requests_are_executed_on_the_programs_simulation() {
    let (mut window, mut handle, mut data) = squatting();
    let start = data.qpos().to_vec();
    let actuator = data.model().actuator(0).unwrap().id();
    window.send(EndpointRequest::SetControl(actuator, 0, 0.5));
    handle.sync(&mut data).unwrap();
    assert_eq!(data.ctrl()[0], 0.5);
    for _ in 0..20 {
        data.step().unwrap();
    }
    window.send(Request::Reset);
    handle.sync(&mut data).unwrap();
    assert_eq!((data.qpos(), data.time()), (&start[..], 0.0), "the state of the first sync");
    window.send(EndpointRequest::CopyState);
    window.send(SimulationRequest::Step(1));
    handle.sync(&mut data).unwrap();
    let events = window.take_events();
    assert!(matches!(&events[..], [Event::Copied(_), Event::Notice(_)]), "{events:?}");
    assert_eq!(data.time(), 0.0, "only the program steps the simulation");
    assert_eq!(newest(&mut window).qpos, start);
}

#[test]
fn program_can_read_and_end_a_pause() {
    let (mut window, mut handle, mut data) = squatting();
    assert!(!handle.is_paused());
    window.send(Request::TogglePause);
    handle.sync(&mut data).unwrap();
    assert!(handle.is_paused());
    assert_eq!(newest(&mut window).status, Status::Paused);
    handle.set_paused(false);
    handle.sync(&mut data).unwrap();
    assert_eq!(newest(&mut window).status, Status::Program);
}

#[test]
fn pull_is_added_to_the_forces_of_the_program() {
    let (mut window, mut handle, mut data) = squatting();
    let torso = data.model().body("torso").unwrap().id();
    let own = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0];
    data.xfrc_applied_mut()[torso.index()] = own;
    window.send(EndpointRequest::SelectBody(Some(torso)));
    window.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    window.send(EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.5]));
    for _ in 0..5 {
        handle.sync(&mut data).unwrap();
        let force = newest(&mut window).selected.unwrap().force;
        assert!(force[2] > 1.0);
        assert_eq!(data.xfrc_applied()[torso.index()], std::array::from_fn(|i| own[i] + force[i]));
        data.step().unwrap();
    }
    assert_eq!(handle.selected(), Some(torso));
    window.send(EndpointRequest::StopPerturbation);
    handle.sync(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[torso.index()], own);
    // While paused, the drag moves the body.
    handle.set_paused(true);
    let height = data.qpos()[2];
    window.send(EndpointRequest::StartPerturbation(PerturbationFlags::TRANSLATE));
    window.send(EndpointRequest::MovePerturbation(MouseAction::MoveV, [0.0, -0.2]));
    handle.sync(&mut data).unwrap();
    assert!(data.qpos()[2] > height + 0.05);
    assert_eq!(data.xfrc_applied()[torso.index()], own);
}

#[test]
fn closing_the_window_releases_the_body_and_the_pause() {
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
    assert!(!handle.is_paused(), "a program that waits for the user resumes");
}

#[test]
fn modified_assets_are_uploaded_once() {
    let text = r#"<mujoco><asset><hfield name="ground" nrow="2" ncol="2" size="1 1 1 1"/></asset>
        <worldbody><geom type="hfield" hfield="ground"/></worldbody></mujoco>"#;
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    handle.sync(&mut data).unwrap();
    let ground = data.model().height_field("ground").unwrap().id();
    data.edit_model(|model| model.hfield_data_mut()[0] = 0.5).unwrap();
    handle.update_height_field(ground);
    handle.sync(&mut data).unwrap();
    assert_eq!(window.take_events(), [Event::Asset(Asset::HeightField(ground))]);
    assert_eq!(newest(&mut window).model.hfield_data()[0], 0.5);
    assert_eq!(newest(&mut window).generation, 0);
    handle.sync(&mut data).unwrap();
    assert!(window.take_events().is_empty());
    // Events about a replaced model are discarded.
    let mut other = Data::new(sample::cartpole()).unwrap();
    handle.update_height_field(ground);
    handle.sync(&mut other).unwrap();
    assert!(window.take_events().is_empty());
    assert_eq!(window.current().unwrap().model.nq(), 2, "the newest snapshot comes with the events");
    assert!(window.latest().unwrap().1, "and counts as new");
    assert!(!window.latest().unwrap().1);
}

#[test]
fn geoms_of_the_program_are_shown_until_removed() {
    let (mut window, mut handle, mut data) = squatting();
    let before = newest(&mut window).scene.ngeom();
    handle.geoms_mut().push(NewGeom::sphere(0.1).with_label("goal").unwrap());
    for _ in 0..3 {
        handle.sync(&mut data).unwrap();
        let scene = &newest(&mut window).scene;
        assert_eq!((scene.ngeom(), scene.geom(before).label()), (before + 1, "goal"));
    }
    handle.geoms_mut().clear();
    handle.sync(&mut data).unwrap();
    assert_eq!(newest(&mut window).scene.ngeom(), before);
    handle.geoms_mut().push(NewGeom::sphere(f64::NAN));
    assert!(matches!(handle.sync(&mut data), Err(Error::Invalid { .. })));
    handle.geoms_mut().clear();
    handle.geoms_mut().resize(20_000, NewGeom::sphere(0.1));
    handle.sync(&mut data).unwrap();
    handle.sync(&mut data).unwrap();
    let events = window.take_events();
    assert!(
        matches!(&events[..], [Event::Notice(text)] if text.contains("has capacity for only")),
        "reported once: {events:?}"
    );
}

#[test]
fn camera_and_options_are_read_and_set() {
    let (mut window, physics) = link(|| ());
    let mut handle = ViewerHandle::new(physics);
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
    assert_eq!(view.options, options, "the window adopts the options");
    view.camera.azimuth = 12.0;
    window.set_view(&view.scene_view());
    handle.sync(&mut data).unwrap();
    assert_eq!(handle.camera().unwrap().azimuth, 12.0, "the user has rotated the camera");
    assert_eq!(newest(&mut window).camera.view, CameraView::Tracking(torso));
}

#[test]
fn camera_of_another_model_is_an_error() {
    let (mut window, mut handle, mut data) = squatting();
    let camera = handle.camera();
    let other = sample::cartpole();
    handle.set_camera(Camera::tracking(&other, "cart").unwrap());
    let options = SceneOptions { frame: FrameMode::Body, ..SceneOptions::default() };
    handle.set_options(options.clone());
    data.step().unwrap();
    assert!(matches!(handle.sync(&mut data), Err(Error::OtherModel { .. })));
    // The window keeps its camera, and shows the simulation with the options.
    assert_eq!((handle.camera(), handle.options()), (camera, options));
    assert_eq!(newest(&mut window).time, data.time());
    handle.sync(&mut data).unwrap();
}

#[test]
fn options_of_the_program_keep_the_users_camera() {
    let (mut window, mut handle, mut data) = squatting();
    let mut view = View::new(data.model());
    view.camera.azimuth = 12.0;
    window.set_view(&view.scene_view());
    handle.set_options(SceneOptions { frame: FrameMode::Body, ..SceneOptions::default() });
    handle.sync(&mut data).unwrap();
    assert_eq!(handle.camera().unwrap().azimuth, 12.0);
    let mut views = window.take_events().into_iter().filter_map(|event| match event {
        Event::View(view) => Some((view.camera.unwrap().azimuth, view.options.frame)),
        _ => None,
    });
    assert_eq!(views.next_back(), Some((12.0, FrameMode::Body)));
}

#[test]
fn a_handle_works_after_a_panic_in_sync() {
    let (mut window, mut handle, mut data) = squatting();
    let text = "<mujoco><asset><mesh name='m' vertex='0 0 0  1 0 0  0 1 0  0 0 1'/></asset></mujoco>";
    let other = Model::from_xml_str(text).unwrap();
    handle.geoms_mut().push(NewGeom::mesh(other.mesh("m").unwrap()));
    let panicked = catch_unwind(AssertUnwindSafe(|| handle.sync(&mut data)));
    assert!(panicked.is_err(), "a mesh of another model");
    handle.geoms_mut().clear();
    data.step().unwrap();
    handle.sync(&mut data).unwrap();
    assert_eq!(newest(&mut window).time, data.time());
    assert!(handle.is_running());
}

#[test]
fn keys_without_a_binding_reach_the_program() {
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
    assert!(handle.keys().len() <= 256, "the queue is bounded");
}

#[test]
fn failed_simulation_is_reported_and_reset_from_the_window() {
    let text = r#"<mujoco><option timestep="0.1"/>
        <worldbody><body><joint type="slide" stiffness="1e6"/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.qpos_mut()[0] = 1.0;
    let mut handle = ViewerHandle::new(physics);
    handle.sync(&mut data).unwrap();
    while data.step().is_ok() {}
    handle.sync(&mut data).unwrap();
    assert!(newest(&mut window).problem.contains("unusable"), "{}", newest(&mut window).problem);
    window.send(Request::Reset);
    handle.sync(&mut data).unwrap();
    assert_eq!((data.qpos(), newest(&mut window).problem.as_str()), (&[1.0][..], ""));
    data.step().unwrap();
}

#[test]
fn sync_accepts_data_of_another_model() {
    let (mut window, mut handle, _) = squatting();
    let mut other = Data::new(sample::cartpole()).unwrap();
    handle.sync(&mut other).unwrap();
    assert_eq!((newest(&mut window).generation, newest(&mut window).qpos.len()), (1, 2));
    other.qpos_mut()[0] = 0.3;
    window.send(Request::Reset);
    handle.sync(&mut other).unwrap();
    assert_eq!(other.qpos()[0], 0.0, "the start state of the new data");
}

#[test]
fn wait_ends_with_a_request_or_with_the_window() {
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
    // Without effect on a closed window.
    handle.sync(&mut data).unwrap();
}
