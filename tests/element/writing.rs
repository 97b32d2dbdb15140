//! Numbers written through a view reach the engine.

use mujoco_safe::{Data, Model};

use crate::{ZOO_XML, simulation, zoo};

#[test]
fn numbers_written_through_a_joint_reach_its_ranges() {
    let mut data = simulation();
    let model = data.model().clone();
    let shoulder = model.joint("shoulder").unwrap();
    data.joint_mut(shoulder).qpos_mut().copy_from_slice(&[0.6, 0.8, 0.0, 0.0]);
    data.joint_mut(shoulder).qvel_mut().copy_from_slice(&[1.0, 2.0, 3.0]);
    data.joint_mut(shoulder).qfrc_applied_mut()[1] = 5.0;
    data.joint_mut(shoulder).qacc_mut()[2] = 7.0;
    assert_eq!(data.qpos()[8..12], [0.6, 0.8, 0.0, 0.0]);
    assert_eq!(data.qvel()[7..10], [1.0, 2.0, 3.0]);
    assert_eq!(data.qfrc_applied()[7..10], [0.0, 5.0, 0.0]);
    assert_eq!(data.qacc()[9], 7.0);
    assert!(data.qvel().iter().enumerate().all(|(dof, value)| (7..10).contains(&dof) || *value == 0.0));
}

#[test]
fn numbers_written_to_a_simulation_affect_its_motion() {
    let mut data = simulation();
    let force = |data: &Data| data.joint("rail").unwrap().qfrc_actuator()[0];
    let before = force(&data);
    data.actuator_mut("rail").unwrap().set_ctrl(2.0);
    data.body_mut("crate").unwrap().xfrc_applied_mut()[2] = 100.0;
    data.forward().unwrap();
    assert_eq!(data.actuator("rail").unwrap().force(), 2.0);
    // The gear is 5. A muscle acts on the joint too, as before.
    assert!((force(&data) - before - 10.0).abs() < 1e-12, "{before} and {}", force(&data));
    let lift = data.joint("crate").unwrap().qacc()[2];
    let expected = 100.0 / 1.5 - 9.81;
    assert!((lift - expected).abs() < 0.5, "{lift} m/s², not {expected}");
}

#[test]
fn numbers_written_to_a_model_affect_the_next_step() {
    let mut data = simulation();
    let fall = |data: &mut Data| {
        data.forward().unwrap();
        data.joint("crate").unwrap().qfrc_passive().to_vec()
    };
    let before = fall(&mut data);
    data.edit_model(|model| {
        model.joint_mut("crate").unwrap().damping_mut().fill(3.0);
        model.body_mut("crate").unwrap().set_mass(2.5);
        model.geom_mut("crate").unwrap().rgba_mut()[1] = 0.25;
        model.keyframe_mut(1).unwrap().qpos_mut()[0] = -4.0;
        model.light_mut("lamp").unwrap().set_cutoff(30.0);
    })
    .unwrap();
    data.joint_mut("crate").unwrap().qvel_mut()[0] = 1.0;
    let after = fall(&mut data);
    assert!((after[0] - before[0] + 3.0).abs() < 0.1, "{before:?} {after:?}");
    let model = data.model();
    assert_eq!(model.body("crate").unwrap().mass(), 2.5);
    assert_eq!(model.body_mass()[3], 2.5);
    assert_eq!(model.geom("crate").unwrap().rgba(), &[1.0, 0.25, 0.0, 1.0]);
    assert_eq!(model.light("lamp").unwrap().cutoff(), 30.0);
    data.reset_to_key(1).unwrap();
    assert_eq!(data.qpos()[0], -4.0);
}

#[test]
fn editing_the_model_of_a_simulation_does_not_affect_others() {
    let model = zoo();
    let mut data = Data::new(model.clone()).unwrap();
    data.edit_model(|model| model.body_mut("crate").unwrap().set_mass(9.0)).unwrap();
    assert_eq!(model.body("crate").unwrap().mass(), 1.5);
    assert_eq!(data.model().body("crate").unwrap().mass(), 9.0);
}

#[test]
fn every_setter_of_a_tendon_and_an_actuator_writes_its_own_field() {
    let mut model = Model::from_xml_str(ZOO_XML).unwrap();
    let before = [model.tendon(1).unwrap().to_string(), model.actuator(1).unwrap().to_string()];
    let mut edit = model.edit();
    let mut rope = edit.tendon_mut("rope").unwrap();
    rope.set_width(1.0);
    rope.set_margin(2.0);
    rope.set_stiffness(3.0);
    rope.set_damping(4.0);
    rope.set_frictionloss(5.0);
    rope.set_lengthspring(6.0);
    rope.range_mut().copy_from_slice(&[7.0, 8.0]);
    rope.user_mut().copy_from_slice(&[9.0, 10.0]);
    let mut motor = edit.actuator_mut("rail").unwrap();
    motor.gear_mut()[5] = 11.0;
    motor.ctrlrange_mut()[0] = -12.0;
    motor.set_cranklength(13.0);
    motor.gainprm_mut()[9] = 14.0;
    let rope = model.tendon("rope").unwrap();
    let found = [
        rope.width(),
        rope.margin(),
        rope.stiffness(),
        rope.damping(),
        rope.frictionloss(),
        rope.lengthspring(),
        rope.range()[0],
        rope.range()[1],
        rope.user()[0],
        rope.user()[1],
    ];
    assert_eq!(found, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
    let motor = model.actuator("rail").unwrap();
    assert_eq!(
        [motor.gear()[5], motor.ctrlrange()[0], motor.cranklength(), motor.gainprm()[9]],
        [11.0, -12.0, 13.0, 14.0]
    );
    let after = [model.tendon(1).unwrap().to_string(), model.actuator(1).unwrap().to_string()];
    assert_eq!(before, after, "the other elements are unchanged");
}
