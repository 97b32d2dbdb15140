//! That what is written through a view arrives where the engine reads it.

use mujoco_safe::{Data, Model};

use crate::{ZOO_XML, simulation, zoo};

#[test]
fn positions_velocities_and_forces_of_a_joint_arrive_in_its_ranges() {
    let mut data = simulation();
    let model = data.model().clone();
    let shoulder = model.joint("shoulder").expect("there is a shoulder");
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
fn what_is_written_in_a_simulation_moves_it() {
    let mut data = simulation();
    let force = |data: &Data| data.joint("rail").expect("a joint").qfrc_actuator()[0];
    let before = force(&data);
    data.actuator_mut("rail").expect("a motor").set_ctrl(2.0);
    data.body_mut("crate").expect("a crate").xfrc_applied_mut()[2] = 100.0;
    data.forward().expect("forward dynamics");
    assert_eq!(data.actuator("rail").expect("a motor").force(), 2.0);
    // The gear is 5. A muscle pulls at the joint too, as before.
    assert!((force(&data) - before - 10.0).abs() < 1e-12, "{before} and {}", force(&data));
    let lift = data.joint("crate").expect("a joint").qacc()[2];
    let expected = 100.0 / 1.5 - 9.81;
    assert!((lift - expected).abs() < 0.5, "{lift} m/s², not {expected}");
}

#[test]
fn what_is_written_to_a_model_changes_the_next_step() {
    let mut data = simulation();
    let fall = |data: &mut Data| {
        data.forward().expect("forward dynamics");
        data.joint("crate").expect("a crate").qfrc_passive().to_vec()
    };
    let before = fall(&mut data);
    data.edit_model(|model| {
        model.joint_mut("crate").expect("a crate").damping_mut().fill(3.0);
        model.body_mut("crate").expect("a crate").set_mass(2.5);
        model.geom_mut("crate").expect("a crate").rgba_mut()[1] = 0.25;
        model.keyframe_mut(1).expect("a keyframe").qpos_mut()[0] = -4.0;
        model.light_mut("lamp").expect("a lamp").set_cutoff(30.0);
    })
    .expect("there is memory");
    data.joint_mut("crate").expect("a crate").qvel_mut()[0] = 1.0;
    let after = fall(&mut data);
    assert!((after[0] - before[0] + 3.0).abs() < 0.1, "{before:?} {after:?}");
    let model = data.model();
    assert_eq!(model.body("crate").expect("a crate").mass(), 2.5);
    assert_eq!(model.body_mass()[3], 2.5);
    assert_eq!(model.geom("crate").expect("a crate").rgba(), &[1.0, 0.25, 0.0, 1.0]);
    assert_eq!(model.light("lamp").expect("a lamp").cutoff(), 30.0);
    data.reset_to_key(1).expect("a keyframe");
    assert_eq!(data.qpos()[0], -4.0);
}

#[test]
fn a_simulation_that_changes_its_model_leaves_that_of_others_as_it_is() {
    let model = zoo();
    let mut data = Data::new(model.clone()).expect("there is memory");
    data.edit_model(|model| model.body_mut("crate").expect("a crate").set_mass(9.0)).expect("there is memory");
    assert_eq!(model.body("crate").expect("a crate").mass(), 1.5);
    assert_eq!(data.model().body("crate").expect("a crate").mass(), 9.0);
}

#[test]
fn every_setter_of_a_tendon_and_an_actuator_writes_its_own_field() {
    let mut model = Model::from_xml_str(ZOO_XML).expect("the zoo loads");
    let before = [model.tendon(1).expect("three").to_string(), model.actuator(1).expect("six").to_string()];
    let mut edit = model.edit();
    let mut rope = edit.tendon_mut("rope").expect("a rope");
    rope.set_width(1.0);
    rope.set_margin(2.0);
    rope.set_stiffness(3.0);
    rope.set_damping(4.0);
    rope.set_frictionloss(5.0);
    rope.set_lengthspring(6.0);
    rope.range_mut().copy_from_slice(&[7.0, 8.0]);
    rope.user_mut().copy_from_slice(&[9.0, 10.0]);
    let mut motor = edit.actuator_mut("rail").expect("a motor");
    motor.gear_mut()[5] = 11.0;
    motor.ctrlrange_mut()[0] = -12.0;
    motor.set_cranklength(13.0);
    motor.gainprm_mut()[9] = 14.0;
    let rope = model.tendon("rope").expect("a rope");
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
    let motor = model.actuator("rail").expect("a motor");
    assert_eq!(
        [motor.gear()[5], motor.ctrlrange()[0], motor.cranklength(), motor.gainprm()[9]],
        [11.0, -12.0, 13.0, 14.0]
    );
    let after = [model.tendon(1).expect("three").to_string(), model.actuator(1).expect("six").to_string()];
    assert_eq!(before, after, "the neighbours are as they were");
}
