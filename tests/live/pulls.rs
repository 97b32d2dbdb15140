//! Pulls of bodies.

use mujoco_safe::live::{LiveOptions, LivePage};
use mujoco_safe::{Data, Model, StateSpec};

use crate::browser::{Browser, ask};
use crate::requests::humanoid;

fn pull(body: usize, point: [f64; 3], target: [f64; 3]) -> String {
    format!(r#"{{"pull":{{"body":{body},"point":{point:?},"target":{target:?}}}}}"#)
}

const LET_GO: &str = r#""let_go""#;

#[test]
fn a_pull_accelerates_the_body_towards_the_target_and_adds_to_other_forces() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    data.forward().unwrap();
    let torso = data.model().body("torso").unwrap().id().index();
    let own = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    data.xfrc_applied_mut()[torso] = own;
    let ([x, y, z], centre) = (data.xipos()[torso], data.model().body_ipos()[torso]);
    ask(&mut page, &mut data, &mut browser, &[&pull(torso, centre, [x + 0.1, y, z])]);
    let [fx, fy, fz, ..] = data.xfrc_applied()[torso];
    // At rest, the force of the spring has the direction of the displacement.
    assert!(fx > 1.0 && fy.abs() < 1e-9 && (fz - 1.0).abs() < 1e-9, "{fx} {fy} {fz}");
    // Half the way has half the force: a spring.
    ask(&mut page, &mut data, &mut browser, &[&pull(torso, centre, [x + 0.05, y, z])]);
    let half = data.xfrc_applied()[torso][0];
    assert!((half / fx - 0.5).abs() < 1e-9, "{half} {fx}");
    for _ in 0..20 {
        page.exchange(&mut data).unwrap();
        data.step().unwrap();
    }
    assert!(data.xipos()[torso][0] > x + 1e-3);
    ask(&mut page, &mut data, &mut browser, &[LET_GO]);
    assert_eq!(data.xfrc_applied()[torso], own, "the force of the pull is removed exactly");
}

#[test]
fn the_reach_of_a_pull_is_limited() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    data.forward().unwrap();
    let body = data.model().body("hand_left").unwrap().id().index();
    let ([x, y, z], centre) = (data.xipos()[body], data.model().body_ipos()[body]);
    let reach = 2.0 * data.model().statistics().extent;
    let mut forces = Vec::new();
    for way in [reach, 1e8] {
        ask(&mut page, &mut data, &mut browser, &[&pull(body, centre, [x, y + way, z])]);
        forces.push(data.xfrc_applied()[body][1]);
    }
    assert!(forces[0] > 0.0 && (forces[1] / forces[0] - 1.0).abs() < 1e-6, "{forces:?}");
}

#[test]
fn a_browser_that_leaves_lets_go() {
    let (mut data, mut page) = humanoid();
    let mut browsers = [Browser::open(&page, &data), Browser::open(&page, &data)];
    let text = pull(1, [0.0; 3], [1.0, 0.0, 2.0]);
    ask(&mut page, &mut data, &mut browsers[0], &[&text]);
    assert_ne!(data.xfrc_applied()[1], [0.0; 6]);
    let [first, mut second] = browsers;
    ask(&mut page, &mut data, &mut second, &[LET_GO]);
    assert_ne!(data.xfrc_applied()[1], [0.0; 6], "the pull of another browser stays");
    drop(first);
    while page.browsers() > 1 {
        std::thread::yield_now();
    }
    ask(&mut page, &mut data, &mut second, &[]);
    assert_eq!(data.xfrc_applied()[1], [0.0; 6]);
}

#[test]
fn the_end_of_a_pull_is_the_choice_of_the_program_too() {
    let (mut data, mut page) = humanoid();
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[&pull(1, [0.0; 3], [1.0, 0.0, 2.0])]);
    assert_ne!(data.xfrc_applied()[1], [0.0; 6]);
    page.let_go(&mut data);
    assert_eq!(data.xfrc_applied()[1], [0.0; 6]);
}

const MODEL: &str = "<mujoco><worldbody>
    <body name='hand' mocap='true' pos='0 0 1'><geom size='.1' contype='0' conaffinity='0'/></body>
    <body name='ball' pos='1 0 1'><freejoint/><geom size='.1'/></body>
    <body name='pole' pos='2 0 1'><joint/><geom size='.1' pos='0 0 -.5'/></body></worldbody></mujoco>";

#[test]
fn while_paused_a_pull_moves_a_free_body_and_nothing_else() {
    let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[r#"{"pause":true}"#]);
    let before = data.state(StateSpec::INTEGRATION);
    // The point on the ball's surface moves by (0.4, 0.3, 0.2), and so does the ball.
    let (state, _) = ask(&mut page, &mut data, &mut browser, &[&pull(2, [0.0, 0.0, 0.1], [1.4, 0.3, 1.3])]);
    let expected = [1.4, 0.3, 1.2];
    assert!(data.qpos()[..3].iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12));
    assert!(
        state.poses[2][..3].iter().zip(expected).all(|(found, expected)| (f64::from(*found) - expected).abs() < 1e-6)
    );
    assert_eq!(data.xfrc_applied()[2], [0.0; 6]);
    ask(&mut page, &mut data, &mut browser, &[&pull(3, [0.0; 3], [2.0, 1.0, 1.0])]);
    assert_eq!(data.qpos()[7], 0.0, "a jointed body does not move");
    ask(&mut page, &mut data, &mut browser, &[r#""reset""#]);
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
}

#[test]
fn a_pull_moves_a_mocap_body() {
    let mut data = Data::new(Model::from_xml_str(MODEL).unwrap()).unwrap();
    let mut page = LivePage::bind(data.model(), &LiveOptions::default()).unwrap();
    let mut browser = Browser::open(&page, &data);
    ask(&mut page, &mut data, &mut browser, &[&pull(1, [0.1, 0.0, 0.0], [0.4, 0.0, 1.0])]);
    let [x, y, z] = data.mocap_pos()[0];
    assert!((x - 0.3).abs() < 1e-12 && y.abs() < 1e-12 && (z - 1.0).abs() < 1e-12, "{x} {y} {z}");
    assert_eq!(data.xfrc_applied()[1], [0.0; 6]);
}
