//! Index ranges of elements, and their parents.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use mujoco_safe::enums::JointType;
use mujoco_safe::{math, sample};

use crate::{simulation, zoo};

#[test]
fn a_joint_has_the_positions_and_dofs_of_its_type() {
    let model = zoo();
    let expected = [
        ("crate", JointType::Free, 0..7, 0..6),
        ("rail", JointType::Slide, 7..8, 6..7),
        ("shoulder", JointType::Ball, 8..12, 7..10),
        ("elbow", JointType::Hinge, 12..13, 10..11),
    ];
    for (name, joint_type, qpos, dofs) in expected {
        let joint = model.joint(name).unwrap();
        assert_eq!((joint.joint_type(), joint.qpos_range(), joint.dofs()), (joint_type, qpos, dofs), "{name}");
    }
    assert_eq!((model.nq(), model.nv()), (14, 12));
}

#[test]
fn the_ranges_of_all_joints_cover_each_index_once() {
    for model in [zoo(), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
        assert!(model.joints().flat_map(|joint| joint.qpos_range()).eq(0..model.nq()));
        assert!(model.joints().flat_map(|joint| joint.dofs()).eq(0..model.nv()));
        assert!(model.bodies().flat_map(|body| body.dofs()).eq(0..model.nv()));
        assert!(model.sensors().flat_map(|sensor| sensor.data_range()).eq(0..model.nsensordata()));
    }
}

#[test]
fn after_a_free_joint_joint_and_dof_indices_differ() {
    let model = sample::humanoid();
    let knee = model.joint("left_knee").unwrap();
    assert_eq!(knee.dofs(), knee.index() + 5..knee.index() + 6);
    assert_eq!(knee.qpos_range(), knee.index() + 6..knee.index() + 7);
}

#[test]
fn elements_have_their_parents() {
    let model = zoo();
    let body = |name: &str| model.body(name).unwrap();
    assert_eq!(body("elbow").parent(), body("shoulder").id());
    assert_eq!(body("elbow").root(), body("base").id());
    assert_eq!(body("world").parent(), body("world").id());
    assert_eq!(model.joint("shoulder").unwrap().body(), body("shoulder").id());
    assert_eq!(model.geom("pulley").unwrap().body(), body("base").id());
    assert_eq!(model.site("crate").unwrap().body(), body("crate").id());
    assert_eq!(model.camera("overview").unwrap().body(), body("world").id());
    assert_eq!((body("elbow").njnt(), body("base").ngeom()), (2, 2));
    assert_eq!([body("hand").mocap(), body("other_hand").mocap(), body("base").mocap()], [Some(0), Some(1), None]);
}

#[test]
fn only_the_last_actuators_have_activations() {
    let model = zoo();
    let activations: Vec<_> = model.actuators().map(|actuator| actuator.activation()).collect();
    assert_eq!(activations, [None, None, None, Some(0), Some(1), Some(2)]);
}

#[test]
fn free_and_ball_joints_have_an_orientation_that_the_mathematics_takes() {
    let mut data = simulation();
    for name in ["crate", "shoulder"] {
        let mut joint = data.joint_mut(name).unwrap();
        *joint.quat_mut().unwrap() = [1.0, 0.0, 0.0, 0.0];
        math::quat_integrate(joint.quat_mut().unwrap(), &[0.0, 0.0, FRAC_PI_2], 1.0);
        let joint = data.joint(name).unwrap();
        let quat = joint.quat().unwrap();
        let end = joint.in_model().qpos_range().end;
        assert_eq!(quat[..], data.qpos()[end - 4..end]);
        let turned = math::rot_vec_quat(&[1.0, 0.0, 0.0], quat);
        assert!((turned[1] - 1.0).abs() < 1e-12, "{name}: {turned:?}");
    }
    for name in ["rail", "elbow"] {
        assert_eq!(data.joint(name).unwrap().quat(), None);
        assert_eq!(data.joint_mut(name).unwrap().quat_mut(), None);
    }
}
