//! Single edits, with the values of `mj_recompile`, or with values that follow from the edit.

use std::sync::Arc;

use mujoco_safe::callback::Callbacks;
use mujoco_safe::enums::JointType;
use mujoco_safe::kind::{Joint, Kind};
use mujoco_safe::spec::{ActuatorElement, Spec};
use mujoco_safe::{Data, Error, Model, sample};

use super::numbers;

/// Model and state of the oracle.
const RECOMPILED: &str = "<mujoco><worldbody>
    <body name='a'><joint name='ja'/><geom size='.1'/></body>
    <body name='b' pos='1 0 0'><joint name='jb' axis='1 0 0'/><geom size='.1'/></body>
    <body name='c' pos='2 0 0'><joint type='free' name='jc'/><geom size='.1'/></body>
    <body name='m' mocap='true' pos='0 2 0'><geom size='.1' contype='0' conaffinity='0'/></body></worldbody>
    <equality><joint name='e' joint1='ja' joint2='jb' active='false'/></equality>
    <actuator><motor name='ma' joint='ja'/><general name='gb' joint='jb' dyntype='filter' dynprm='.1'/></actuator></mujoco>";

fn started(spec: &Spec) -> Data {
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.set_equality_active("e", true).unwrap();
    data.set_time(1.5);
    data.qpos_mut().copy_from_slice(&[0.1, 0.2, 3.0, 4.0, 5.0, 0.6, 0.8, 0.0, 0.0]);
    data.qvel_mut().copy_from_slice(&numbers(8, 1.0));
    data.act_mut()[0] = 0.7;
    data.ctrl_mut().copy_from_slice(&[0.3, 0.4]);
    data.mocap_pos_mut()[0] = [7.0, 8.0, 9.0];
    data.mocap_quat_mut()[0] = [0.0, 1.0, 0.0, 0.0];
    data.qacc_warmstart_mut().copy_from_slice(&numbers(8, 1.0));
    data.qfrc_applied_mut().copy_from_slice(&numbers(8, 11.0));
    data.xfrc_applied_mut().as_flattened_mut().copy_from_slice(&numbers(30, 0.0));
    data
}

/// Performs an edit, and compares the state with the one after `MjSpec.recompile` of MuJoCo 4.0.1
/// (Python bindings): positions, velocities, activations, controls, applied forces on joints,
/// first numbers of the applied forces on bodies, and active constraints. Warm starts are ten less
/// than the applied forces where these are not zero, and the mocap body keeps its pose.
#[track_caller]
fn recompiled(edit: impl FnOnce(&mut Spec), expected: [&[f64]; 7]) {
    let mut spec = Spec::from_xml_str(RECOMPILED).unwrap();
    let mut data = started(&spec);
    edit(&mut spec);
    data.adopt(spec.compile().unwrap()).unwrap();
    let forces: Vec<f64> = data.xfrc_applied().iter().map(|force| force[0]).collect();
    let active: Vec<f64> =
        (0..data.model().neq()).map(|id| f64::from(u8::from(data.equality(id).unwrap().active()))).collect();
    let found = [data.qpos(), data.qvel(), data.act(), data.ctrl(), data.qfrc_applied(), &forces, &active];
    assert_eq!(found, expected);
    let warmstart: Vec<f64> = expected[4].iter().map(|force| if *force == 0.0 { 0.0 } else { force - 10.0 }).collect();
    assert_eq!(data.qacc_warmstart(), warmstart);
    assert_eq!((data.mocap_pos()[0], data.mocap_quat()[0]), ([7.0, 8.0, 9.0], [0.0, 1.0, 0.0, 0.0]));
    assert_eq!(data.time(), 1.5);
}

#[test]
fn the_state_is_that_of_mj_recompile() {
    let free = [3.0, 4.0, 5.0, 0.6, 0.8, 0.0, 0.0];
    recompiled(
        |spec| {
            for id in [spec.equality("e").unwrap().id().any(), spec.actuator("ma").unwrap().id().any()] {
                spec.remove(id).unwrap();
            }
            let joint = spec.joint("ja").unwrap().id();
            spec.remove(joint).unwrap();
        },
        [
            &[&[0.2][..], &free].concat(),
            &numbers(7, 2.0),
            &[0.7],
            &[0.4],
            &numbers(7, 12.0),
            &[0.0, 6.0, 12.0, 18.0, 24.0],
            &[],
        ],
    );
    recompiled(
        |spec| {
            spec.joint_mut("ja").unwrap().set_type(JointType::Slide);
        },
        [
            &[&[0.0, 0.2][..], &free].concat(),
            &[&[0.0][..], &numbers(7, 2.0)].concat(),
            &[0.7],
            &[0.3, 0.4],
            &[&[0.0][..], &numbers(7, 12.0)].concat(),
            &[0.0, 6.0, 12.0, 18.0, 24.0],
            &[1.0],
        ],
    );
    // An integrator keeps the activation of the filter.
    recompiled(
        |spec| {
            spec.actuator_mut("gb").unwrap().set("dyntype", "integrator").unwrap();
        },
        [
            &[&[0.1, 0.2][..], &free].concat(),
            &numbers(8, 1.0),
            &[0.7],
            &[0.3, 0.4],
            &numbers(8, 11.0),
            &[0.0, 6.0, 12.0, 18.0, 24.0],
            &[1.0],
        ],
    );
    recompiled(
        |spec| {
            spec.joint_mut("jb").unwrap().set_name("renamed");
            let inner = spec.add_body(spec.body("a").unwrap().id()).set_pos([0.0, 0.0, 9.0]).id();
            spec.add_joint(inner).set_name("inner").set_ref(0.5);
            spec.add_geom(inner).set_size(&[0.1]);
            let last = spec.add_body(spec.world()).set_pos([0.0, 0.0, 9.0]).id();
            spec.add_freejoint(last);
            spec.add_geom(last).set_size(&[0.1]);
            spec.add_actuator(ActuatorElement::IntegratedVelocity)
                .set("actrange", [-1.0, 1.0])
                .unwrap()
                .set("joint", "ja")
                .unwrap();
        },
        [
            &[&[0.1, 0.5_f64.to_radians(), 0.2][..], &free, &[0.0, 0.0, 9.0, 1.0, 0.0, 0.0, 0.0]].concat(),
            &[&[1.0, 0.0][..], &numbers(7, 2.0), &[0.0; 6]].concat(),
            &[0.7, 0.0],
            &[0.3, 0.4, 0.0],
            &[&[11.0, 0.0][..], &numbers(7, 12.0), &[0.0; 6]].concat(),
            &[0.0, 6.0, 0.0, 12.0, 18.0, 24.0, 0.0],
            &[1.0],
        ],
    );
    // A body that is removed and added again is another one.
    recompiled(
        |spec| {
            let body = spec.body("b").unwrap().id();
            spec.remove_with_references(body).unwrap();
            let again = spec.add_body(spec.world()).set_name("b").set_pos([1.0, 0.0, 0.0]).id();
            spec.add_joint(again).set_name("jb").set_axis([1.0, 0.0, 0.0]);
            spec.add_geom(again).set_size(&[0.1]);
        },
        [
            &[&[0.1][..], &free, &[0.0]].concat(),
            &[&[1.0][..], &numbers(6, 3.0), &[0.0]].concat(),
            &[],
            &[0.3],
            &[&[11.0][..], &numbers(6, 13.0), &[0.0]].concat(),
            &[0.0, 6.0, 18.0, 24.0, 0.0],
            &[],
        ],
    );
}

#[test]
fn lost_and_new_elements_are_listed() {
    let mut spec = Spec::from_xml_str(RECOMPILED).unwrap();
    let mut data = started(&spec);
    let body = spec.body("b").unwrap().id();
    spec.remove_with_references(body).unwrap();
    let world = spec.world();
    let added = spec.add_body(world).set_name("d").id();
    spec.add_joint(added);
    spec.add_geom(added).set_size(&[0.1]);
    let adoption = data.adopt(spec.compile().unwrap()).unwrap();
    let texts = |elements: &[mujoco_safe::model::ChangedElement]| -> Vec<String> {
        elements.iter().map(ToString::to_string).collect()
    };
    assert_eq!(texts(&adoption.lost), ["body 'b'", "joint 'jb'", "actuator 'gb'", "equality 'e'"]);
    assert_eq!(texts(&adoption.new), ["body 'd'", "joint 2"]);
    assert_eq!((adoption.new[1].kind, adoption.new[1].index), (Kind::Joint, 2));
}

fn hinges(bodies: &[&str]) -> Model {
    let body = |attributes: &&str| format!("<body {attributes}><joint/><geom size='.1'/></body>");
    let bodies: String = bodies.iter().map(body).collect();
    Model::from_xml_str(&format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>")).unwrap()
}

/// Adopts a model, and returns the positions: 1, 2, … for joints that are kept, 0 for new ones.
fn kept(from: Model, to: Model) -> Vec<f64> {
    let mut data = Data::new(from).unwrap();
    let count = data.qpos().len();
    data.qpos_mut().copy_from_slice(&numbers(count, 1.0));
    data.adopt(to).unwrap();
    data.qpos().to_vec()
}

#[test]
fn elements_without_names_survive_in_files_only_where_their_order_leaves_no_doubt() {
    let (a, b, unnamed) = ("name='a'", "name='b'", "");
    assert_eq!(kept(hinges(&[unnamed, a, unnamed]), hinges(&[a, unnamed, unnamed])), [2.0, 1.0, 3.0]);
    assert_eq!(kept(hinges(&[unnamed, a, unnamed]), hinges(&[unnamed, a])), [0.0, 2.0]);
    assert_eq!(kept(hinges(&[unnamed, a, unnamed]), hinges(&[a, unnamed, unnamed, unnamed])), [2.0, 0.0, 0.0, 0.0]);
    assert_eq!(kept(hinges(&[a, b]), hinges(&[b, a])), [2.0, 1.0]);
    assert_eq!(kept(hinges(&[a]), hinges(&[unnamed])), [0.0]);
    let two = |first: &str, second: &str| {
        let text = format!(
            "<mujoco><worldbody><body><joint {first}/><joint {second} axis='1 0 0'/><geom size='.1'/></body></worldbody></mujoco>"
        );
        Model::from_xml_str(&text).unwrap()
    };
    assert_eq!(kept(two("", "type='slide'"), two("", "type='slide'")), [1.0, 2.0]);
    // The body without a name may be another one, because its joints are.
    assert_eq!(kept(two("", "type='slide'"), two("type='slide'", "")), [0.0, 0.0]);
    assert_eq!(kept(two("name='x'", ""), two("type='slide' name='x'", "")), [0.0, 0.0]);
    assert_eq!(kept(two("name='x'", "name='y'"), two("name='y'", "name='x'")), [2.0, 1.0]);
}

/// Actuators and constraints without names agree by the elements to which they refer.
#[test]
fn unnamed_actuators_and_constraints_survive_by_their_targets() {
    let model = |actuators: &str, equalities: &str| {
        Model::from_xml_str(&format!(
            "<mujoco><worldbody>
               <body name='a'><joint name='a'/><geom size='.1'/></body><body name='b'><joint name='b'/><geom size='.1'/></body>
             </worldbody><actuator>{actuators}</actuator><equality>{equalities}</equality></mujoco>"
        ))
        .unwrap()
    };
    let run = |from: (&str, &str), to: (&str, &str)| {
        let mut data = Data::new(model(from.0, from.1)).unwrap();
        let [controls, constraints] = [data.model().nu(), data.model().neq()];
        data.ctrl_mut().copy_from_slice(&numbers(controls, 1.0));
        (0..constraints).for_each(|index| data.set_equality_active(index, false).unwrap());
        data.adopt(model(to.0, to.1)).unwrap();
        let active: Vec<bool> = (0..data.model().neq()).map(|id| data.equality(id).unwrap().active()).collect();
        (data.ctrl().to_vec(), active)
    };
    let (first, second) = ("<motor joint='a'/>", "<motor joint='b'/>");
    let (both, swapped) = ([first, second].concat(), [second, first].concat());
    let (joints, bodies) = ("<joint joint1='a' joint2='b'/>", "<connect body1='a' body2='b' anchor='0 0 1'/>");
    assert_eq!(run((&both, joints), (&both, joints)), (vec![1.0, 2.0], vec![false]));
    assert_eq!(run((&both, joints), (&swapped, bodies)), (vec![0.0, 0.0], vec![true]));
    assert_eq!(run((&both, bodies), (first, bodies)), (vec![0.0], vec![false]));
    let reversed = "<connect body1='b' body2='a' anchor='0 0 1'/>";
    assert_eq!(run((first, bodies), (first, reversed)), (vec![1.0], vec![true]));
}

#[test]
fn a_named_joint_survives_in_another_body() {
    let text = |inner: &str, outer: &str| {
        format!(
            "<mujoco><worldbody><body name='a'><geom size='.1'/><joint name='x' axis='1 0 0'/>{inner}</body>{outer}</worldbody></mujoco>"
        )
    };
    let arm = "<body name='b' pos='1 0 0'><joint name='y'/><geom size='.1'/></body>";
    let [inside, outside] = [text(arm, ""), text("", arm)].map(|text| Model::from_xml_str(&text).unwrap());
    assert_eq!(kept(inside, outside), [1.0, 2.0]);
}

#[test]
fn an_unnamed_element_of_a_spec_survives_everywhere() {
    let mut spec = Spec::new("s");
    let mut hinges = Vec::new();
    for _ in 0..5 {
        let body = spec.add_body(spec.world()).id();
        spec.add_geom(body).set_size(&[0.1]);
        hinges.push((body, spec.add_joint(body).id()));
    }
    let from = spec.compile().unwrap();
    let mut edited = spec.clone();
    edited.remove(hinges[1].0).unwrap();
    edited.remove(hinges[4].1).unwrap();
    edited.add_joint(hinges[0].0).set_axis([1.0, 0.0, 0.0]);
    assert_eq!(kept(from, edited.compile().unwrap()), [1.0, 0.0, 3.0, 4.0]);
    // Both clones have a new joint without a name: another one.
    spec.add_joint(hinges[0].0).set_axis([1.0, 0.0, 0.0]);
    assert_eq!(kept(spec.compile().unwrap(), edited.compile().unwrap()), [1.0, 0.0, 4.0, 5.0]);
}

#[test]
fn what_the_compiler_creates_survives_by_its_name() {
    let grid = if cfg!(engine_since = "3.2.0") {
        "<flexcomp name='grid' type='grid' dim='2' count='3 3 1' spacing='.1 .1 .1' radius='.01' mass='1'/>"
    } else {
        "<composite type='grid' count='3 3 1' spacing='.1'><geom size='.01'/></composite>"
    };
    let body = "<body><joint type='slide'/><geom size='.1'/></body>";
    let text = format!(
        "<mujoco><worldbody>{body}<body name='base' pos='0 0 1'><geom size='.1'/>{body}{grid}{body}</body></worldbody></mujoco>"
    );
    let mut spec = Spec::from_xml_str(&text).unwrap();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    let count = data.qvel().len();
    assert!(count > 9);
    data.qvel_mut().copy_from_slice(&numbers(count, 1.0));
    let speeds = data.qvel().to_vec();
    let added = spec.add_body(spec.world()).id();
    spec.add_joint(added);
    spec.add_geom(added).set_size(&[0.1]);
    data.adopt(spec.compile().unwrap()).unwrap();
    assert_eq!(data.qvel()[..count], speeds);
    assert_eq!(data.qvel()[count..], [0.0]);
    // The elements without names beside those of the compiler are known, too.
    let last = spec.element(spec.body("base").unwrap().id()).children().last().unwrap();
    spec.remove(last).unwrap();
    data.adopt(spec.compile().unwrap()).unwrap();
    assert_eq!(data.qvel()[..count - 1], speeds[..count - 1]);
    assert_eq!(data.qvel().len(), count);
}

#[test]
fn bodies_without_names_that_the_compiler_may_fuse_are_not_confused() {
    let text = "<mujoco><compiler fusestatic='true'/><worldbody>
        <body pos='1 0 0'><geom size='.1'/><body><joint axis='0 1 0'/><geom size='.1' pos='1 0 0'/></body></body></worldbody></mujoco>";
    let mut spec = Spec::from_xml_str(text).unwrap();
    let outer = spec.ids::<mujoco_safe::kind::Body>()[1];
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    assert_eq!(data.model().nbody(), 2, "fused");
    data.xfrc_applied_mut()[1][0] = 1.0;
    spec.add_joint(outer).set_axis([1.0, 0.0, 0.0]);
    let inner = spec.element(outer).children().find_map(|id| spec.typed::<mujoco_safe::kind::Body>(id)).unwrap();
    let model = spec.compile().unwrap();
    data.adopt(model).unwrap();
    assert_eq!(data.model().nbody(), 3);
    // The body of the force is the inner one, or it is lost.
    assert_ne!(data.xfrc_applied()[1][0], 1.0, "{inner}");
}

#[cfg(engine_since = "3.2.0")]
#[test]
fn copies_survive_by_their_numbers() {
    let text = "<mujoco><worldbody><replicate count='3' offset='1 0 0'><body><joint/><geom size='.1'/></body></replicate></worldbody></mujoco>";
    let mut spec = Spec::from_xml_str(text).unwrap();
    let from = spec.compile().unwrap();
    let copies = spec.element(spec.world()).children().next().unwrap();
    spec.edit(copies).set("count", 5).unwrap();
    let more = spec.compile().unwrap();
    spec.edit(copies).set("count", 2).unwrap();
    let added = spec.add_body(spec.world()).id();
    spec.add_joint(added);
    spec.add_geom(added).set_size(&[0.1]);
    assert_eq!(kept(from.clone(), more), [1.0, 2.0, 3.0, 0.0, 0.0]);
    assert_eq!(kept(from, spec.compile().unwrap()), [1.0, 2.0, 0.0]);
}

#[test]
fn unrelated_and_empty_models_are_adopted_too() {
    let empty = || Model::from_xml_str("<mujoco/>").unwrap();
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.step_n(10).unwrap();
    let time = data.time();
    for model in [sample::cartpole(), empty(), empty(), sample::humanoid()] {
        data.adopt(model).unwrap();
        assert_eq!(data.time(), time);
    }
    assert_eq!(data.qpos(), data.model().qpos0());
    data.step().unwrap();
}

#[test]
fn ids_of_the_old_model_are_not_valid() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let id = data.model().id::<Joint>("hinge").unwrap();
    data.adopt(sample::cartpole()).unwrap();
    let read = std::panic::AssertUnwindSafe(|| data.joint(id).qpos()[0]);
    assert!(std::panic::catch_unwind(read).is_err());
}

#[test]
fn callbacks_and_poison_stay() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.set_callbacks(Callbacks::new().with_passive(|passive| passive.qfrc_passive_mut()[0] = 3.0));
    data.adopt(sample::humanoid()).unwrap();
    data.forward().unwrap();
    assert_eq!(data.qfrc_passive()[0], 3.0);
    // The scope ends for the new simulation, too.
    let other = Callbacks::new().with_passive(|passive| passive.qfrc_passive_mut()[0] = 4.0);
    let inside = data.with_callbacks(other, |data| {
        data.adopt(sample::cartpole()).unwrap();
        data.forward().unwrap();
        data.qfrc_passive()[0]
    });
    data.forward().unwrap();
    assert_eq!((inside, data.qfrc_passive()[0]), (4.0, 3.0));

    data.set_callbacks(Callbacks::new().with_passive(|_| panic!("fails")));
    assert!(data.step().is_err());
    data.set_callbacks(Callbacks::new());
    for model in [sample::cartpole(), sample::humanoid()] {
        data.adopt(model).unwrap();
        assert!(matches!(data.forward(), Err(Error::Poisoned { .. })));
    }
    data.reset().unwrap();
    data.step().unwrap();
}

#[test]
fn the_activity_of_a_constraint_does_not_change_a_shared_model() {
    let spec = Spec::from_xml_str(RECOMPILED).unwrap();
    let mut data = started(&spec);
    let model = Arc::new(spec.compile().unwrap());
    data.adopt(&model).unwrap();
    assert!(data.equality("e").unwrap().active());
    assert!(!Data::new(&model).unwrap().equality("e").unwrap().active());
    assert_eq!(Arc::ptr_eq(data.model(), &model), cfg!(engine_since = "3.0.0"));
}

/// The compiler puts the copies of an actuator behind the others.
#[cfg(engine_since = "3.17.0")]
#[test]
fn controls_beside_copies_are_not_confused() {
    let text = "<mujoco><worldbody><replicate count='1' offset='0 1 0'><body name='b'><joint name='j'/><geom size='.1'/></body></replicate>
           <body><joint name='k'/><geom size='.1'/></body></worldbody>
         <actuator><motor joint='j' gear='1'/><motor joint='k' gear='2'/></actuator></mujoco>";
    let mut spec = Spec::from_xml_str(text).unwrap();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.ctrl_mut().copy_from_slice(&[22.0, 11.0]);
    let of_k = spec.ids::<mujoco_safe::kind::Actuator>()[1];
    spec.remove(of_k).unwrap();
    let _ = data.adopt(spec.compile().unwrap()).unwrap();
    // Its actuator has no name, so it counts as new.
    assert_eq!(data.ctrl(), [0.0]);
}
