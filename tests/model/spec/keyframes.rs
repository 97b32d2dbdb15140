//! Keyframes of edited and attached specs. The expected values are those of `mjSpec` of 4.0.1.

use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use mujoco_safe::{Error, Model};

use super::parse;

const TWO: &str = "<mujoco><worldbody>
    <body name='b1'><joint name='j1'/><geom size='.1'/></body>
    <body name='b2' pos='1 0 0'><joint name='j2'/><geom size='.1'/></body>
  </worldbody>
  <actuator><motor name='m1' joint='j1'/><motor name='m2' joint='j2'/></actuator>
  <keyframe><key name='home' time='2' qpos='.1 .2' qvel='.3 .4' ctrl='.5 .6'/></keyframe></mujoco>";

#[track_caller]
fn key(model: &Model, name: &str, qpos: &[f64], qvel: &[f64], ctrl: &[f64]) {
    let key = model.keyframe(name).unwrap().id().index();
    for (found, expected) in [(model.key_qpos(), qpos), (model.key_qvel(), qvel), (model.key_ctrl(), ctrl)] {
        assert_eq!(found.row(key), expected);
    }
}

fn remove_first(spec: &mut Spec) {
    let body = spec.body("b1").unwrap().id();
    spec.remove_with_references(body).unwrap();
}

fn add_hinge(spec: &mut Spec, name: &str) {
    let body = spec.add_body(spec.world()).set_name(name).id();
    spec.add_joint(body).set_name(name);
    spec.add_geom(body).set_size(&[0.1]);
    spec.add_actuator(ActuatorElement::Motor).set_joint(name);
}

#[test]
fn removed_elements_take_their_values_along_and_new_ones_have_the_defaults() {
    let mut spec = parse(TWO);
    remove_first(&mut spec);
    key(&spec.compile().unwrap(), "home", &[0.2], &[0.4], &[0.6]);
    add_hinge(&mut spec, "j4");
    let model = spec.compile().unwrap();
    key(&model, "home", &[0.2, 0.0], &[0.4, 0.0], &[0.6, 0.0]);
    assert_eq!(model.key_time(), [2.0]);
    let home = spec.keyframe("home").unwrap();
    assert_eq!((home.numbers("qpos").unwrap().unwrap(), home.attribute("qpos")), (vec![0.2, 0.0], Some(".1 .2")));

    // An object beside the robot.
    let mut spec = parse(TWO);
    let cube = spec.add_body(spec.world()).set_pos([1.0, 2.0, 3.0]).id();
    spec.add_freejoint(cube);
    spec.add_geom(cube).set_size(&[0.1]);
    let qpos = [0.1, 0.2, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0];
    key(&spec.compile().unwrap(), "home", &qpos, &[0.3, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.5, 0.6]);
}

/// Values that are set later belong to the elements of that time.
#[test]
fn values_belong_to_the_elements_at_the_time_at_which_they_are_set() {
    let mut spec = parse(TWO);
    remove_first(&mut spec);
    spec.keyframe_mut("home").unwrap().set_qpos(&[0.7]);
    add_hinge(&mut spec, "j4");
    spec.keyframe_mut("home").unwrap().set_ctrl(&[0.8, 0.9]);
    key(&spec.compile().unwrap(), "home", &[0.7, 0.0], &[0.4, 0.0], &[0.8, 0.9]);
    assert_eq!(parse(&spec.to_xml()).keyframe("home").unwrap().attribute("ctrl"), Some("0.8 0.9"));

    // Too many: perhaps they were meant for elements that come later.
    let mut spec = Spec::new("late");
    spec.add_keyframe().set_name("home").set_qpos(&[0.7]);
    add_hinge(&mut spec, "j");
    let error = spec.compile().unwrap_err();
    assert!(error.to_string().contains("1 values, set when the spec had 0"), "{error}");
    assert!(matches!(error, Error::Invalid { .. }));
    assert!(Model::from_xml_str(&spec.to_xml()).is_err());
    spec.keyframe_mut("home").unwrap().set_qpos(&[0.7]);
    key(&spec.compile().unwrap(), "home", &[0.7], &[0.0], &[0.0]);
}

/// Newer compilers pad short vectors.
#[test]
fn missing_values_at_the_end_are_the_defaults() {
    let mut spec = parse(&TWO.replace("qpos='.1 .2'", "qpos='.1'"));
    add_hinge(&mut spec, "j4");
    key(&spec.compile().unwrap(), "home", &[0.1, 0.0, 0.0], &[0.3, 0.4, 0.0], &[0.5, 0.6, 0.0]);
}

#[test]
fn keyframes_of_attached_specs_are_kept_with_the_prefix() {
    let host = "<mujoco><worldbody><body><freejoint/><geom size='.1'/></body><body mocap='true' pos='1 2 3'/>
        <body><joint ref='10'/><geom size='.1'/></body></worldbody>
        <keyframe><key name='hk' qpos='9 8 7 1 0 0 0 .5'/></keyframe></mujoco>";
    let mut spec = parse(host);
    let mount = Mount::body(spec.world());
    spec.attach(&parse(TWO), mount.with_pos([0.0, 0.0, 1.0]), "r_").unwrap();
    let model = spec.compile().unwrap();
    key(&model, "hk", &[9.0, 8.0, 7.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0], &[0.0; 9], &[0.0; 2]);
    let qpos = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 10.0 * (std::f64::consts::PI / 180.0), 0.1, 0.2];
    key(&model, "r_home", &qpos, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.4], &[0.5, 0.6]);
    assert_eq!((model.key_time(), model.key_mpos().row(1)), (&[0.0, 2.0][..], &[1.0, 2.0, 3.0][..]));

    let error = spec.attach(&parse(host), mount, "").unwrap_err();
    assert!(error.to_string().contains("keyframe 'hk'"), "{error}");
    let mut twice = Spec::new("twice");
    let mount = Mount::body(twice.world());
    for prefix in ["a_", "b_"] {
        twice.attach(&parse(TWO), mount, prefix).unwrap();
    }
    let model = twice.compile().unwrap();
    key(&model, "a_home", &[0.1, 0.2, 0.0, 0.0], &[0.3, 0.4, 0.0, 0.0], &[0.5, 0.6, 0.0, 0.0]);
    key(&model, "b_home", &[0.0, 0.0, 0.1, 0.2], &[0.0, 0.0, 0.3, 0.4], &[0.0, 0.0, 0.5, 0.6]);
}
