//! Order of the values of keyframes: copies of actuators, attachments, and elements whose number of
//! values only the compiler knows.

use mujoco_safe::Error;
#[cfg(engine_since = "3.17.0")]
use mujoco_safe::Model;
use mujoco_safe::spec::{Mount, Spec};

#[cfg(engine_since = "3.17.0")]
use super::keyframes::add_hinge;
use super::keyframes::{TWO, key};
use super::parse;

/// The compiler puts the copies of an actuator behind the others. Each value stays with its
/// actuator and copy, which the compiled model names.
#[cfg(engine_since = "3.17.0")]
#[test]
fn values_follow_the_copies_of_actuators() {
    let mut spec = parse(
        "<mujoco><worldbody>
           <body name='a'><joint name='ja'/><geom size='.1'/><site name='sa'/></body>
           <replicate count='2' sep='_' offset='0 1 0'><body name='b'><joint name='jb'/><geom size='.1'/><site name='sb'/>
             <replicate count='3' sep='-' offset='0 0 1'><body name='c'><joint name='jc'/><geom size='.1'/><site name='sc'/></body></replicate>
             <body name='d'><joint name='jd'/><geom size='.1'/></body></body></replicate>
           <body name='e'><joint name='je'/><geom size='.1'/></body></worldbody>
         <tendon><fixed name='tb'><joint joint='jb' coef='1'/><joint joint='jc' coef='1'/></fixed>
           <fixed name='td'><joint joint='jb' coef='1'/><joint joint='jd' coef='1'/></fixed>
           <spatial name='ts'><site site='sc'/><site site='sb'/></spatial></tendon>
         <actuator>
           <motor name='mc' joint='jc'/><general name='mb' joint='jb' dyntype='integrator'/><motor name='me' joint='je'/>
           <motor name='mt' tendon='td'/><cylinder name='cc' joint='jc'/><motor name='ms' site='sc' refsite='sa' gear='1 0 0 0 0 0'/>
           <motor name='mx' tendon='ts'/><motor name='m1' joint='jb_1'/><motor name='ma' joint='ja'/><motor name='mr' site='sb'/>
         </actuator></mujoco>",
    );
    let names = |model: &Model| model.names(mujoco_safe::kind::Kind::Actuator).map(str::to_owned).collect::<Vec<_>>();
    let model = spec.compile().unwrap();
    let before = names(&model);
    // One that refers to elements inside and outside is not copied, and has no original.
    assert_eq!((before.len(), before.iter().any(|name| name.starts_with("ms"))), (27, false), "{before:?}");
    let value = |name: &str| 1.0 + before.iter().position(|known| known == name).unwrap() as f64;
    let controls: Vec<f64> = before.iter().map(|name| value(name)).collect();
    let activations: Vec<f64> = (0..model.na()).map(|number| 1.0 + number as f64).collect();
    let of_activation = |model: &Model, id: mujoco_safe::id::ActuatorId| {
        let index = id.index();
        (model.actuator_actnum()[index] > 0).then(|| model.actuator_actadr()[index] as usize)
    };
    spec.add_keyframe().set_name("k").set_ctrl(&controls).set_act(&activations);
    let check = |spec: &Spec| {
        let edited = spec.compile().unwrap();
        let key = edited.keyframe("k").unwrap();
        for actuator in edited.actuators() {
            let name = actuator.name().unwrap_or_default();
            let is_new = !before.iter().any(|known| known == name);
            assert_eq!(key.ctrl()[actuator.index()], if is_new { 0.0 } else { value(name) }, "{name}");
            if let Some(place) = of_activation(&edited, actuator.id()) {
                let expected = if is_new {
                    0.0
                } else {
                    activations[of_activation(&model, model.actuator(name).unwrap().id()).unwrap()]
                };
                assert_eq!(key.act()[place], expected, "{name}");
            }
        }
    };
    check(&spec);
    for removed in ["mc", "me", "mt"] {
        let removed = spec.actuator(removed).unwrap().id();
        spec.remove(removed).unwrap();
        check(&spec);
    }
    add_hinge(&mut spec, "last");
    check(&spec);
    for (body, count) in [("c", 2), ("b", 3)] {
        let body = spec.body(body).unwrap().id();
        let replicate = spec.element(body).parent().unwrap();
        spec.edit(replicate).set("count", count).unwrap();
        check(&spec);
    }
    let mut outer = parse(
        "<mujoco><worldbody><body><joint name='h'/><geom size='.1'/></body></worldbody>
           <actuator><motor name='h' joint='h'/></actuator></mujoco>",
    );
    let mount = Mount::body(outer.world());
    outer.attach(&parse(&spec.to_xml().replace("'jb_1'", "'ja'").replace("\"jb_1\"", "\"ja\"")), mount, "").unwrap();
    check(&outer);
}

/// A joint that an element creates may be in a copy or not.
#[cfg(engine_since = "3.17.0")]
#[test]
fn controls_beside_copies_of_unknown_elements_are_an_error() {
    let mut spec = parse(
        "<mujoco><worldbody><replicate count='1' offset='0 1 0'>
             <composite type='cable' curve='s' count='4 1 1' size='1' initial='none' prefix='c'><geom type='capsule' size='.01'/></composite>
           </replicate><body><joint name='k'/><geom size='.1'/></body></worldbody>
         <actuator><motor joint='cJ_1' gear='1'/><motor name='m' joint='k' gear='2'/></actuator>
         <keyframe><key name='home' ctrl='22 11'/></keyframe></mujoco>",
    );
    let removed = spec.actuator("m").unwrap().id();
    spec.remove(removed).unwrap();
    assert!(spec.compile().unwrap_err().to_string().contains("'ctrl' of key 'home'"));
}

/// Values that are set after attachments are in the order of the compiled model: the elements of
/// the spec, then those of each attached spec in the order of the attachments.
#[test]
fn attached_elements_come_after_those_of_the_spec_in_the_order_of_attachment() {
    for prefixes in [["a_", "b_"], ["b_", "a_"]] {
        let mut spec = parse(TWO);
        let mount = Mount::body(spec.world());
        for prefix in prefixes {
            spec.attach(&parse(TWO), mount, prefix).unwrap();
        }
        spec.add_keyframe()
            .set_name("set")
            .set_qpos(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
            .set_ctrl(&[6.0, 5.0, 4.0, 3.0, 2.0, 1.0]);
        let model = spec.compile().unwrap();
        let names: Vec<&str> = model.names(mujoco_safe::kind::Kind::Joint).collect();
        let first = prefixes[0];
        let expected = ["", prefixes[0], prefixes[1]].map(|prefix| ["j1", "j2"].map(|name| format!("{prefix}{name}")));
        assert_eq!(names, expected.as_flattened());
        key(&model, "set", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &[0.0; 6], &[6.0, 5.0, 4.0, 3.0, 2.0, 1.0]);
        // Without the first one, the values of the others stay.
        let body = spec.body(&format!("{first}b1")[..]).unwrap().id();
        spec.remove_with_references(body).unwrap();
        key(&spec.compile().unwrap(), "set", &[1.0, 2.0, 4.0, 5.0, 6.0], &[0.0; 5], &[6.0, 5.0, 3.0, 2.0, 1.0]);
    }
}

/// An element whose number of values only the compiler knows counts as new after a change that may
/// change this number, also of its class, and not after one of names, places and looks.
#[test]
fn an_element_of_unknown_size_is_new_after_a_change_of_its_make_up() {
    let text = if cfg!(engine_since = "4.0.0") {
        "<mujoco><default><default class='c'><pid kp='1'/></default></default>
           <worldbody><body name='b'><joint name='j'/><geom size='.1'/></body></worldbody>
           <actuator><pid name='p' class='c' joint='j'/><motor name='m' joint='j'/></actuator></mujoco>"
    } else if cfg!(not(engine_since = "3.0.0")) {
        "<mujoco><worldbody><body name='rB2' pos='0 0 1'><composite type='rope' count='5 1 1' spacing='.1' prefix='r'>
             <joint kind='main' damping='.1'/><geom type='capsule' size='.01 .02'/></composite><geom size='.01'/></body>
           <body name='b'><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"
    } else {
        return;
    };
    let is_actuator = cfg!(engine_since = "4.0.0");
    let spec = || {
        let mut spec = parse(text);
        let model = spec.compile().unwrap();
        let count = if is_actuator { model.nu() } else { model.nq() };
        let values: Vec<f64> = (0..count).map(|number| number as f64).collect();
        let mut key = spec.add_keyframe();
        key.set_name("k");
        if is_actuator {
            key.set_ctrl(&values)
        } else {
            key.set_qpos(&values)
        };
        let id = if is_actuator {
            spec.actuator("p").unwrap().id().any()
        } else {
            let body = spec.body("rB2").unwrap().id();
            let first = spec.element(body).children().next();
            first.unwrap()
        };
        (spec, id, values)
    };
    let values_of = |spec: &Spec| {
        let model = spec.compile()?;
        let key = model.keyframe("k").unwrap();
        Ok::<_, Error>(if is_actuator { key.ctrl().to_vec() } else { key.qpos().to_vec() })
    };
    let (same, other) = if is_actuator {
        ([("group", "1"), ("name", "q")], [("dyntype", "filter"), ("kp", "2")])
    } else {
        ([("spacing", ".2"), ("prefix", "r")], [("count", "4 1 1"), ("type", "cable")])
    };
    for (attribute, value) in same {
        let (mut spec, id, values) = spec();
        spec.edit(id).set(attribute, value).unwrap();
        assert_eq!(values_of(&spec).unwrap(), values, "{attribute}");
    }
    for (attribute, value) in other {
        let (mut spec, id, _) = spec();
        if spec.edit(id).set(attribute, value).is_ok() {
            let error = spec.compile().unwrap_err().to_string();
            assert!(error.contains("of key 'k'"), "{attribute}: {error}");
        }
    }
    if is_actuator {
        let (mut spec, _, _) = spec();
        spec.default_mut("c", "pid").unwrap().set("kp", 3.0).unwrap();
        assert!(spec.compile().unwrap_err().to_string().contains("of key 'k'"));
    }
}
