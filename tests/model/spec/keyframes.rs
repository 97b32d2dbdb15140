//! Keyframes of edited and attached specs. The expected values are those of `mjSpec` of 4.0.1.

#[cfg(engine_since = "3.2.5")]
use mujoco_safe::enums::GeomType;
use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use mujoco_safe::{Error, Model};

use super::parse;
use crate::cases::cases;

pub(super) const TWO: &str = "<mujoco><worldbody>
    <body name='b1'><joint name='j1'/><geom size='.1'/></body>
    <body name='b2' pos='1 0 0'><joint name='j2'/><geom size='.1'/></body>
  </worldbody>
  <actuator><motor name='m1' joint='j1'/><motor name='m2' joint='j2'/></actuator>
  <keyframe><key name='home' time='2' qpos='.1 .2' qvel='.3 .4' ctrl='.5 .6'/></keyframe></mujoco>";

#[track_caller]
pub(super) fn key(model: &Model, name: &str, qpos: &[f64], qvel: &[f64], ctrl: &[f64]) {
    let key = model.keyframe(name).unwrap().id().index();
    for (found, expected) in [(model.key_qpos(), qpos), (model.key_qvel(), qvel), (model.key_ctrl(), ctrl)] {
        assert_eq!(found.row(key), expected);
    }
}

fn remove_first(spec: &mut Spec) {
    let body = spec.body("b1").unwrap().id();
    spec.remove_with_references(body).unwrap();
}

pub(super) fn add_hinge(spec: &mut Spec, name: &str) {
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

/// Elements whose number of values only the compiler knows: composites and flexes.
#[cfg(engine_since = "3.5.0")]
#[test]
fn values_beside_elements_of_unknown_size_are_placed_or_an_error() {
    let cloth = "<flexcomp name='f' type='grid' count='3 3 1' spacing='.1 .1 .1' mass='1' radius='.01'/>";
    // Newer compilers pad the values of the cloth.
    let mut spec = parse(TWO);
    let world = spec.world();
    spec.edit(world).add("flexcomp").unwrap();
    let mut spec = parse(&spec.to_xml().replace("<flexcomp/>", cloth));
    let model = spec.compile().unwrap();
    assert_eq!(model.key_qpos().row(0)[..3], [0.1, 0.2, 0.0]);

    // Its values belong together, and those before it follow their elements.
    let qpos: Vec<f64> = (0..model.nq()).map(|number| number as f64).collect();
    spec.keyframe_mut("home").unwrap().set_qpos(&qpos);
    remove_first(&mut spec);
    assert_eq!(spec.compile().unwrap().key_qpos().row(0), &qpos[1..]);
    let mut outer = parse("<mujoco><worldbody><body><joint/><geom size='.1'/></body></worldbody></mujoco>");
    let mount = Mount::body(outer.world());
    outer.attach(&spec, mount, "c_").unwrap();
    assert_eq!(outer.compile().unwrap().key_qpos().row(0), [&[0.0], &qpos[1..]].concat());
    add_hinge(&mut outer, "last");
    assert_eq!(outer.compile().unwrap().key_qpos().row(0), [&[0.0], &qpos[1..], &[0.0]].concat());

    // A cloth before an element with values.
    let mut spec = parse(TWO);
    let body = spec.body("b1").unwrap().id();
    spec.edit(body).add("flexcomp").unwrap().set_name("f").set("count", [3, 3, 1]).unwrap();
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("flexcomp 'f'") && error.contains("'qpos' of key 'home'"), "{error}");
    assert!(spec.keyframe("home").unwrap().numbers("qpos").is_err());
    assert!(Model::from_xml_str(&spec.to_xml()).is_err());
    spec.keyframe_mut("home").unwrap().unset("qpos");
    assert!(spec.compile().unwrap_err().to_string().contains("'qvel' of key 'home'"));
}

/// A cloth of another size before a joint would give the joint one of its values.
#[cfg(engine_since = "3.0.0")]
#[test]
fn a_change_of_a_size_that_only_the_compiler_knows_is_an_error() {
    let text = |count: &str| {
        format!(
            "<mujoco><worldbody>
               <flexcomp name='f' type='grid' count='{count}' spacing='.1 .1 .1' mass='1' radius='.01'/>
               <body name='b' pos='0 0 1'><joint/><geom size='.1'/></body></worldbody></mujoco>"
        )
    };
    let size = |count: &str| parse(&text(count)).compile().unwrap().nq();
    let values: Vec<f64> = (0..size("3 3 1")).map(|number| number as f64).collect();
    let mut spec = parse(&text("3 3 1"));
    spec.add_keyframe().set_name("k").set_qpos(&values);
    let flex = spec.element(spec.world()).children().next().unwrap();
    // Attributes that do not change it.
    spec.edit(flex).set("rgba", [1.0, 0.0, 0.0, 1.0]).unwrap().set("spacing", [0.2, 0.2, 0.2]).unwrap();
    assert_eq!(spec.compile().unwrap().keyframe("k").unwrap().qpos(), values);
    spec.edit(flex).set("count", [2, 3, 1]).unwrap();
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("'qpos' of key 'k'"), "{error}");
    spec.edit(flex).set("count", [3, 3, 1]).unwrap();
    assert_eq!(spec.compile().unwrap().keyframe("k").unwrap().qpos(), values);
}

/// An element decides between its units when the key is read, as when it is compiled.
#[test]
fn numbers_of_a_key_have_the_reference_of_an_attached_slide() {
    let child = parse(
        "<mujoco><compiler angle='radian'/><default><joint type='slide' ref='.5'/></default>
           <worldbody><body name='b'><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>",
    );
    let mut spec = parse(TWO);
    let mount = Mount::body(spec.world());
    spec.attach(&child, mount, "c_").unwrap();
    let model = spec.compile().unwrap();
    assert_eq!(model.keyframe("home").unwrap().qpos(), [0.1, 0.2, 0.5]);
    assert_eq!(spec.keyframe("home").unwrap().numbers("qpos").unwrap().unwrap(), [0.1, 0.2, 0.5]);
}

/// The engine turns a new free body to its inertia.
#[cfg(engine_since = "3.2.5")]
#[test]
fn the_pose_of_an_aligned_free_body_is_left_to_the_compiler() {
    for align in [None, Some("auto")] {
        let mut spec = parse(&TWO.replace("<mujoco>", "<mujoco><compiler alignfree='true'/>"));
        let body = spec.add_body(spec.world()).set_name("b").set("euler", [0.0, 0.0, 30.0]).unwrap().id();
        let mut body_mut = spec.edit(body);
        let mut joint = body_mut.add("freejoint").unwrap();
        if let Some(align) = align {
            joint.set("align", align).unwrap();
        }
        spec.add_geom(body).set_type(GeomType::Box).set_size(&[0.3, 0.2, 0.1]).set_pos([1.0, 0.0, 0.0]);
        if !cfg!(engine_since = "3.17.0") {
            // These compilers put it at the origin.
            assert!(spec.compile().unwrap_err().to_string().contains("'qpos' of key 'home'"));
            continue;
        }
        let model = spec.compile().unwrap();
        let aligned = &model.qpos0()[2..];
        assert!(aligned[0] > 0.8, "{aligned:?}");
        assert_eq!(&model.keyframe("home").unwrap().qpos()[2..], aligned, "{align:?}");
    }
}

/// The copies of an element have values each. The compiler of 3.5.0 compares the keyframes with
/// the model before it is copied.
#[cfg(engine_since = "3.17.0")]
#[test]
fn values_follow_the_copies_of_elements() {
    let mut spec = parse(
        "<mujoco><worldbody><body name='a'><joint/><geom size='.1'/></body>
           <replicate count='2' sep='_'><body name='b'><joint name='j'/><geom size='.1'/></body>
             <body name='c'><joint name='k' type='slide'/><geom size='.1'/></body></replicate>
           <body name='d'><joint/><geom size='.1'/></body></worldbody>
         <keyframe><key name='home' qpos='1 2 3 4 5 6' qvel='1 2 3 4 5 6'/></keyframe></mujoco>",
    );
    let first = spec.body("a").unwrap().id();
    spec.remove(first).unwrap();
    key(&spec.compile().unwrap(), "home", &[2.0, 3.0, 4.0, 5.0, 6.0], &[2.0, 3.0, 4.0, 5.0, 6.0], &[]);
    let copied = spec.body("b").unwrap().id();
    let replicate = spec.element(copied).parent().unwrap();
    spec.edit(replicate).set("count", 3).unwrap();
    let expected = [2.0, 3.0, 4.0, 5.0, 0.0, 0.0, 6.0];
    key(&spec.compile().unwrap(), "home", &expected, &expected, &[]);
    spec.remove(copied).unwrap();
    key(&spec.compile().unwrap(), "home", &[3.0, 5.0, 0.0, 6.0], &[3.0, 5.0, 0.0, 6.0], &[]);
}

/// These have two and three controls.
#[cfg(engine_since = "4.0.0")]
#[test]
fn actuators_of_unknown_size_end_the_known_controls() {
    let text = TWO
        .replace("<motor name='m2'", "<pid name='p' joint='j1'/><motor name='m2'")
        .replace("ctrl='.5 .6'", "ctrl='.5 .1 .2 .6'");
    let mut spec = parse(&text);
    add_hinge(&mut spec, "j3");
    let model = spec.compile().unwrap();
    key(&model, "home", &[0.1, 0.2, 0.0], &[0.3, 0.4, 0.0], &[0.5, 0.1, 0.2, 0.6, 0.0]);
    let first = spec.actuator("m1").unwrap().id();
    spec.remove(first).unwrap();
    key(&spec.compile().unwrap(), "home", &[0.1, 0.2, 0.0], &[0.3, 0.4, 0.0], &[0.1, 0.2, 0.6, 0.0]);
    let pid = spec.actuator("p").unwrap().id();
    spec.remove(pid).unwrap();
    let error = spec.compile().unwrap_err().to_string();
    assert!(error.contains("'ctrl' of key 'home'"), "{error}");
}

/// The engine compiles each actuator beside one with an activation, which must keep its value.
#[test]
fn the_activations_of_every_actuator_in_every_class_are_known() {
    const ELEMENTS: [&str; 16] = [
        "general",
        "general dyntype='none'",
        "general dyntype='integrator'",
        "general dyntype='filter'",
        "general dyntype='filterexact'",
        "general dyntype='user'",
        "motor",
        "position",
        "position timeconst='0'",
        "position timeconst='.1'",
        "velocity",
        "intvelocity actrange='0 1'",
        "damper ctrlrange='0 1'",
        "cylinder",
        "muscle lengthrange='0 1'",
        "adhesion ctrlrange='0 1' body='b'",
    ];
    let of_class = |element: &str| format!("<{}/>", element.replace(" body='b'", "").replace(" lengthrange='0 1'", ""));
    let (mut compiled, mut unknown, mut failures) = (0, 0, Vec::new());
    let combinations = ELEMENTS.len() * (ELEMENTS.len() + 1) * ELEMENTS.len();
    for number in (0..combinations).step_by(cases(13, 5)) {
        let outer = of_class(ELEMENTS[number % ELEMENTS.len()]);
        let inner = ELEMENTS.get(number / ELEMENTS.len() % (ELEMENTS.len() + 1)).map(|element| of_class(element));
        let element = ELEMENTS[number / ELEMENTS.len() / (ELEMENTS.len() + 1)];
        let target = if element.starts_with("adhesion") { "" } else { "joint='j'" };
        let text = |values: &str| {
            format!(
                "<mujoco><default><default class='o'>{outer}<default class='i'>{}</default></default></default>
                   <worldbody><body name='b'><joint name='j'/><geom size='.1'/></body></worldbody>
                   <actuator><{element} name='a' class='i' {target}/><general joint='j' dyntype='integrator'/></actuator>
                   <keyframe><key name='k' {values}/></keyframe></mujoco>",
                inner.clone().unwrap_or_default()
            )
        };
        let Ok(model) = parse(&text("")).compile() else { continue };
        compiled += 1;
        let values = if model.na() == 1 { "act='5'" } else { "act='4 5'" };
        let mut spec = parse(&text(values));
        let actuator = spec.actuator("a").unwrap().id();
        spec.remove(actuator).unwrap();
        let found = spec.compile().map(|model| model.keyframe("k").unwrap().act().to_vec());
        // Rare, because it depends on the engine.
        if matches!(&found, Err(error) if error.to_string().contains("cannot be placed")) {
            unknown += 1;
        } else if !matches!(&found, Ok(values) if values[..] == [5.0]) {
            failures.push(format!("{found:?}: {}", text(values)));
        }
    }
    assert!(unknown < compiled / 10, "{unknown} of {compiled}");
    assert!(failures.is_empty(), "{} of {compiled}: {failures:#?}", failures.len());
    assert!(compiled > combinations / cases(13, 5) / 3, "{compiled}");
}

/// Sizes of which no array can be made, and the time of texts with many copies.
#[test]
fn huge_sizes_in_texts_are_harmless() {
    let geoms = "<geom size='.1'/>".repeat(1000);
    let copies = format!(
        "<mujoco><worldbody><replicate count='900000'>{geoms}</replicate><body><joint/><geom size='.1'/></body></worldbody>
           <keyframe><key qpos='0'/></keyframe></mujoco>"
    );
    let _ = Spec::from_xml_str(&copies).unwrap().to_xml();
    let actuator = "<general joint='j' dyntype='user' actdim='9223372036854775807'/>";
    let mut spec = parse(&format!(
        "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
           <actuator>{}</actuator><keyframe><key name='k' act='1'/></keyframe></mujoco>",
        actuator.repeat(3)
    ));
    spec.add_actuator(ActuatorElement::Motor).set_joint("j");
    let _ = (spec.to_xml(), spec.compile(), spec.keyframe("k").unwrap().numbers("act"));
    let references = format!("<mujoco model='{}'/>", "&".repeat(1_000_000));
    let _ = Spec::from_xml_str(&references);
}

/// The values of mocap bodies are in the frame of the world.
#[test]
fn values_in_the_frame_of_the_world_stay_at_a_mount_with_a_pose() {
    let child = parse(
        "<mujoco><worldbody><body name='m' mocap='true' pos='1 2 3'/></worldbody>
           <keyframe><key name='k' mpos='4 5 6' mquat='0 1 0 0'/></keyframe></mujoco>",
    );
    let mut spec = parse(TWO);
    let mount = Mount::body(spec.world()).with_pos([0.0, 0.0, 10.0]);
    spec.attach(&child, mount, "c_").unwrap();
    let model = spec.compile().unwrap();
    let key = model.keyframe("c_k").unwrap().id().index();
    assert_eq!(model.body_pos()[model.body("c_m").unwrap().index()], [1.0, 2.0, 13.0]);
    assert_eq!(model.key_mpos().row(key), [4.0, 5.0, 6.0]);
    assert_eq!(model.key_mquat().row(key), [0.0, 1.0, 0.0, 0.0]);
}
