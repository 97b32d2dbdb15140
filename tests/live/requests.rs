//! States, and requests for pauses, steps, resets and controls.

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Data, Error, Model, StateSpec, sample};

use crate::browser::{Browser, State, ask};

pub fn humanoid() -> (Data, LivePage) {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand").unwrap();
    let page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    (data, page)
}

/// Checks a state against the arrays of the simulation.
fn assert_shows(state: &State, data: &Data) {
    assert_eq!(state.time, data.time());
    assert_eq!(state.ctrl, data.ctrl().iter().map(|&ctrl| ctrl as f32).collect::<Vec<_>>());
    for (body, pose) in state.poses[..data.model().nbody()].iter().enumerate() {
        let expected = [&data.xpos()[body][..], &data.xquat()[body][..]].concat();
        assert_eq!(pose[..], expected.iter().map(|&number| number as f32).collect::<Vec<_>>());
    }
}

#[test]
fn a_browser_receives_the_state_of_the_simulation() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_shows(&state, &data);
    assert!(!state.is_paused && state.problem.is_empty() && ticks.iter().all(|tick| tick.advance && !tick.reset));
    for step in 0..50 {
        data.ctrl_mut()[3] = 0.01 * f64::from(step);
        data.step().unwrap();
    }
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_shows(&state, &data);
    assert_eq!(page.browsers(), 1);
    let mut second = Browser::open(&page, &data);
    let (state, _) = ask(&mut page, &mut data, &mut second, &[]);
    assert_shows(&state, &data);
    assert_eq!(page.browsers(), 2);
}

#[test]
fn before_the_first_exchange_the_page_shows_the_initial_state() {
    let (mut data, page) = humanoid();
    data.reset().unwrap();
    data.forward().unwrap();
    assert_shows(&Browser::open(&page, &data).state(), &data);
}

#[test]
fn positions_that_have_not_been_computed_are_computed_without_a_change_of_the_state() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    data.reset_to_key("squat").unwrap();
    let before = data.state(StateSpec::INTEGRATION);
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[]);
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
    data.forward().unwrap();
    assert_shows(&state, &data);
}

#[test]
fn a_pause_stops_and_each_requested_step_advances_once() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[r#"{"pause":true}"#]);
    assert!(state.is_paused && page.is_paused());
    assert!(!ticks.last().unwrap().advance);
    let (_, ticks) = ask(&mut page, &mut data, &mut browser, &[r#"{"step":1}"#]);
    assert_eq!(ticks.iter().filter(|tick| tick.advance).count(), 1);
    let (_, ticks) = ask(&mut page, &mut data, &mut browser, &[r#"{"step":3}"#, r#"{"step":2}"#, r#"{"release":0}"#]);
    let rest = (0..10).filter(|_| page.exchange(&mut data).unwrap().advance).count();
    assert_eq!(ticks.iter().filter(|tick| tick.advance).count() + rest, 5);
    // Steps do not remain for a later pause.
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[r#"{"step":1000}"#, r#"{"pause":false}"#]);
    assert!(!state.is_paused && ticks.last().unwrap().advance);
    page.set_paused(true);
    assert!(!page.exchange(&mut data).unwrap().advance);
}

#[test]
fn a_reset_restores_the_state_of_the_first_exchange() {
    let (mut data, mut page) = humanoid();
    data.ctrl_mut()[0] = 0.25;
    let mut browser = Browser::open(&page, &data);
    page.exchange(&mut data).unwrap();
    let start = data.state(StateSpec::INTEGRATION);
    data.ctrl_mut()[0] = 0.5;
    data.step_n(20).unwrap();
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[r#"{"hold":[1,1]}"#, r#""reset""#]);
    assert_eq!(ticks.iter().filter(|tick| tick.reset).count(), 1);
    assert_eq!(data.state(StateSpec::INTEGRATION), start);
    assert_eq!(state.held, vec![0; data.model().nu()], "a reset releases the controls");
    let mut same = data.clone();
    same.forward().unwrap();
    assert_shows(&state, &same);
}

#[test]
fn a_held_control_replaces_that_of_the_program_until_its_release() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[r#"{"hold":[2,-0.5]}"#, r#"{"hold":[4,0.125]}"#]);
    assert_eq!((state.ctrl[2], state.held[2], state.ctrl[4], state.held[3]), (-0.5, 1, 0.125, 0));
    data.ctrl_mut().fill(0.75);
    page.exchange(&mut data).unwrap();
    assert_eq!(data.ctrl()[1..6], [0.75, -0.5, 0.75, 0.125, 0.75]);
    ask(&mut page, &mut data, &mut browser, &[r#"{"release":2}"#]);
    data.ctrl_mut().fill(0.75);
    page.exchange(&mut data).unwrap();
    assert_eq!(data.ctrl()[1..6], [0.75, 0.75, 0.75, 0.125, 0.75]);
    // In a step of the page, the user's value follows the controller's.
    let mut controller = |data: &mut Data| data.ctrl_mut().fill(0.3);
    assert!(page.step(&mut data, &mut controller).unwrap());
    assert_eq!(data.ctrl()[3..5], [0.3, 0.125]);
    page.let_go(&mut data);
    page.step(&mut data, &mut controller).unwrap();
    assert_eq!(data.ctrl()[3..5], [0.3, 0.3]);
}

#[test]
fn an_unusable_simulation_is_shown_and_can_be_reset() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    page.exchange(&mut data).unwrap();
    data.qfrc_applied_mut()[0] = f64::MAX;
    data.step().unwrap_err();
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[]);
    assert!(state.problem.contains("unusable") && !ticks.last().unwrap().advance, "{state:?}");
    let (state, ticks) = ask(&mut page, &mut data, &mut browser, &[r#""reset""#]);
    assert!(state.problem.is_empty() && ticks.last().unwrap().advance, "{state:?}");
    data.step().unwrap();
}

#[test]
fn data_of_another_model_are_an_error() {
    let (_, mut page) = humanoid();
    let mut other = Data::new(sample::humanoid()).unwrap();
    assert!(matches!(page.exchange(&mut other), Err(Error::OtherModel { .. })));
}

#[test]
fn an_address_or_a_camera_that_does_not_exist_is_an_error() {
    let model = sample::cartpole();
    let bind = |address: &str| LivePage::bind(model.clone(), &LiveOptions::default().with_address(address));
    let page = bind("127.0.0.1:0").unwrap();
    for address in [&*page.address().to_string(), "", "127.0.0.1", "127.0.0.1:65536", "192.0.2.1:0"] {
        let error = bind(address).unwrap_err();
        assert!(matches!(&error, Error::Serve { .. }), "{address}: {error}");
        assert!(error.to_string().contains(address), "{error}");
    }
    let camera = mujoco_safe::html::HtmlOptions::default().with_camera("none");
    let error = LivePage::bind(model, &LiveOptions::default().with_page(camera)).unwrap_err();
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
}

#[test]
fn models_without_anything_have_pages() {
    for text in ["<mujoco/>", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"] {
        let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
        let mut page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
        let mut browser = Browser::open(&page, &data);
        let (state, _) = ask(&mut page, &mut data, &mut browser, &[r#""reset""#]);
        assert_eq!(state.poses, [[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]);
    }
}

#[test]
fn a_dropped_page_ends_its_connections_and_frees_its_address() {
    let (mut data, mut page) = humanoid();
    let address = page.address();
    let mut browsers: Vec<_> = (0..3).map(|_| Browser::open(&page, &data)).collect();
    let (_, _) = ask(&mut page, &mut data, &mut browsers[0], &[]);
    let idle = crate::browser::connection(&page);
    drop(page);
    for browser in &mut browsers {
        browser.end();
    }
    drop((browsers, idle));
    let options = LiveOptions::default().with_address(address.to_string());
    LivePage::bind(data.model(), &options).unwrap();
}
