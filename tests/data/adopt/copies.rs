//! Elements that the compiler copies for a `replicate`, or that stand beside such copies.

use mujoco_safe::Data;
use mujoco_safe::kind::{Actuator, Equality, Joint};
use mujoco_safe::model::{Adoption, ChangedElement};
use mujoco_safe::spec::{ActuatorElement, Spec};

use super::DELAY;

/// Three copies of a body with a hinge, and motors of the copies and of another joint.
fn copied(motor_of_j: &str) -> Spec {
    let text = format!(
        "<mujoco><worldbody><replicate count='3' sep='_' offset='0 1 0'><body name='b'><joint name='j'/><geom size='.1'/></body></replicate>
           <body><joint name='k'/><geom size='.1'/></body></worldbody>
         <actuator><motor {motor_of_j} joint='j'/><motor joint='k'/></actuator></mujoco>"
    );
    Spec::from_xml_str(&text).unwrap()
}

/// Returns a simulation in which the velocities and the controls are 1, 2, 3 and so on.
fn started(spec: &Spec) -> Data {
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    let count = |values: &mut [f64]| values.iter_mut().zip(1..).for_each(|(value, number)| *value = f64::from(number));
    count(data.qvel_mut());
    count(data.ctrl_mut());
    data
}

/// Returns the controls by the joints of the actuators.
fn controls(data: &Data) -> Vec<(String, f64)> {
    let model = data.model();
    let joint = |actuator: usize| model.id::<Joint>(model.actuator_trnid()[actuator][0] as usize).unwrap();
    let name = |actuator| model.name(joint(actuator)).unwrap().to_owned();
    let mut found: Vec<_> = (0..model.nu()).map(|actuator| (name(actuator), data.ctrl()[actuator])).collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

fn names(elements: &[ChangedElement]) -> Vec<String> {
    elements.iter().map(ToString::to_string).collect()
}

fn adopt(data: &mut Data, spec: &Spec) -> Adoption {
    data.adopt(spec.compile().unwrap()).unwrap()
}

#[test]
fn elements_beside_copies_survive_other_edits() {
    for motor_of_j in ["", "name='m'"] {
        let mut spec = copied(motor_of_j);
        let mut data = started(&spec);
        let before = controls(&data);
        let mut added = spec.add_body(spec.world());
        let added = added.set_name("added").id();
        spec.add_joint(added).set_name("l");
        spec.add_geom(added).set_size(&[0.1]);
        let adoption = adopt(&mut data, &spec);
        assert_eq!(controls(&data), before, "{motor_of_j}");
        assert_eq!(
            (names(&adoption.lost), names(&adoption.new)),
            (vec![], vec!["body 'added'".into(), "joint 'l'".into()])
        );
    }
}

#[test]
fn an_actuator_that_replaces_one_of_copies_is_new() {
    for motor_of_j in ["", "name='m'"] {
        let mut spec = copied(motor_of_j);
        let mut data = started(&spec);
        let of_k = controls(&data)[3].clone();
        let joint = spec.joint("j").unwrap().id();
        let replaced = spec.ids::<Actuator>()[0];
        spec.remove(replaced).unwrap();
        let mut motor = spec.add_actuator(ActuatorElement::Motor);
        motor.set_joint(joint);
        if !motor_of_j.is_empty() {
            motor.set_name("m");
        }
        adopt(&mut data, &spec);
        // The motor of `k` has no name, so it counts as new when another unnamed one is replaced.
        let of_k = if motor_of_j.is_empty() { 0.0 } else { of_k.1 };
        let expected = [("j_0", 0.0), ("j_1", 0.0), ("j_2", 0.0), ("k", of_k)];
        assert_eq!(controls(&data), expected.map(|(name, control)| (name.to_owned(), control)), "{motor_of_j}");
    }
}

#[test]
fn a_joint_that_replaces_one_of_copies_is_new() {
    let mut spec = copied("");
    let mut data = started(&spec);
    assert_eq!(data.qvel(), [1.0, 2.0, 3.0, 4.0]);
    let (body, joint) = (spec.body("b").unwrap().id(), spec.joint("j").unwrap().id());
    spec.remove_with_references(joint).unwrap();
    spec.add_joint(body).set_name("j");
    adopt(&mut data, &spec);
    assert_eq!(data.qvel(), [0.0, 0.0, 0.0, 4.0]);
}

#[test]
fn constraints_beside_those_of_a_flexcomp_survive() {
    let text = "<mujoco><worldbody>
        <flexcomp name='grid' type='grid' dim='2' count='3 3 1' spacing='.1 .1 .1' radius='.01' mass='1'><edge equality='true'/></flexcomp>
        <body name='b' pos='1 0 0'><joint name='j'/><geom size='.1'/></body><body name='c' pos='2 0 0'><joint name='k'/><geom size='.1'/></body></worldbody>
        <equality><joint joint1='j' active='false'/><joint joint1='k'/></equality></mujoco>";
    let mut spec = Spec::from_xml_str(text).unwrap();
    let mut data = started(&spec);
    let ids: Vec<_> = (0..data.model().neq()).map(|id| data.model().id::<Equality>(id).unwrap()).collect();
    assert_eq!(ids.len(), 3);
    for id in ids {
        let is_active = data.equality(id).active();
        data.set_equality_active(id, !is_active).unwrap();
    }
    let activity = |data: &Data| {
        let model = data.model();
        let of = |id| data.equality(model.id::<Equality>(id).unwrap()).active();
        (0..model.neq()).map(of).collect::<Vec<_>>()
    };
    let before = activity(&data);
    assert_eq!(before.iter().filter(|active| **active).count(), 1);
    spec.add_body(spec.world()).set_pos([0.0, 0.0, 3.0]);
    adopt(&mut data, &spec);
    assert_eq!(activity(&data), before);
}

/// Samples of a sensor without a name are not those of one that measures in another frame.
#[cfg(engine_since = "3.5.0")]
#[test]
fn samples_of_sensors_in_files_need_the_same_frame() {
    let model = |reference: &str| {
        let text = format!(
            "<mujoco><worldbody><body name='a'><joint/><geom size='.1'/></body><body name='b' pos='1 0 0'><joint/><geom size='.1'/></body></worldbody>
             <sensor><framepos objtype='body' objname='a' {reference}{DELAY}/></sensor></mujoco>"
        );
        mujoco_safe::Model::from_xml_str(&text).unwrap()
    };
    let kept = |from: &str, to: &str| {
        let mut data = Data::new(model(from)).unwrap();
        data.init_sensor_history(0, &[0.1, 0.2, 0.3, 0.4], &[7.0; 12], 0.0).unwrap();
        let adoption = data.adopt(model(to)).unwrap();
        let is_kept = data.state(mujoco_safe::StateSpec::HISTORY).contains(&7.0);
        assert_eq!(is_kept, adoption.new.is_empty());
        is_kept
    };
    let [world, body, xbody, other] =
        ["", "reftype='body' refname='b'", "reftype='xbody' refname='b'", "reftype='body' refname='a'"];
    assert!(kept(body, body));
    assert!(kept(world, world));
    for to in [world, xbody, other] {
        assert!(!kept(body, to), "{to}");
    }
}
