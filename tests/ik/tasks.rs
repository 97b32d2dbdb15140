//! Tasks: convergence, priorities, weights, moving frames.

use mujoco_safe::control::residual::{
    Frame, FramePose, FramePosition, Gaze, JointCoupling, JointPosition, JointVelocity,
};
use mujoco_safe::ik::{Ik, Task};
use mujoco_safe::{Data, Model};

use crate::{arm, humanoid};

const DT: f64 = 0.01;

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[test]
fn a_pose_of_a_robot_from_urdf_is_reached() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    // The pose of known positions.
    data.qpos_mut().copy_from_slice(&[0.3, 0.5, -0.4, 0.9, 0.2, -0.7, 0.1]);
    data.forward().unwrap();
    let link = data.body("link6").unwrap();
    let target = [link.xpos().as_slice(), link.xquat()].concat();
    data.reset().unwrap();
    data.qpos_mut().fill(0.1);
    let mut ik = Ik::new(&model);
    let hand = ik.add_task(Task::new(FramePose::new(Frame::body(&model, "link6").unwrap())).with_damping(1e-2));
    ik.set_target(hand, &target).unwrap();
    for _ in 0..100 {
        assert!(ik.step(&mut data, DT).unwrap().is_solved());
    }
    ik.solve(&mut data, DT).unwrap();
    assert!(ik.error(hand).unwrap().iter().all(|value| value.abs() < 1e-9), "{:?}", ik.error(hand));
}

#[test]
fn lower_priorities_do_not_change_the_higher_ones() {
    let (mut data, _, _) = humanoid();
    let model = data.model().clone();
    let mut alone = Ik::new(&model);
    let mut both = Ik::new(&model);
    let hand = FramePosition::body(&model, "hand_left").unwrap().with_target([0.4, 0.3, 1.1]);
    let foot = FramePosition::body(&model, "foot_left").unwrap().with_target([0.0, 0.2, 0.3]);
    let first = alone.add_task(Task::new(hand.clone()));
    both.add_task(Task::new(hand));
    // The second task asks for the opposite, with a large weight.
    let against = FramePosition::body(&model, "lower_arm_left").unwrap().with_target([-0.4, 0.9, 0.2]);
    both.add_task(Task::new(against).with_weight(1e3).with_priority(1));
    both.add_task(Task::new(foot).with_priority(7));
    let expected = alone.solve(&mut data, DT).unwrap().velocity().to_vec();
    let tick = both.solve(&mut data, DT).unwrap();
    assert!(tick.is_solved());
    let jacobian = data.jac_body("hand_left").unwrap().linear;
    let velocity = tick.velocity();
    assert!(distance(velocity, &expected) > 0.1, "the other tasks use the freedom");
    for row in jacobian.rows() {
        let speed = |velocity: &[f64]| row.iter().zip(velocity).map(|(row, rate)| row * rate).sum::<f64>();
        assert!((speed(velocity) - speed(&expected)).abs() < 1e-6);
    }
    assert_eq!(alone.error(first).unwrap().len(), 3);
}

#[test]
fn priorities_stay_solvable_at_limits() {
    let (mut data, _, _) = humanoid();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.set_velocity_limits(0.5).unwrap();
    let pose = |name: &str| FramePose::new(Frame::body(&model, name).unwrap());
    let hand = ik.add_task(Task::new(pose("hand_left")).with_priority(1));
    let head = ik.add_task(Task::new(pose("head")).with_priority(2));
    ik.add_task(Task::new(FramePosition::body(&model, "foot_left").unwrap()));
    ik.add_task(Task::new(JointPosition::all(&model)).with_priority(3));
    ik.add_task(Task::rate(JointVelocity::all(&model)).with_priority(4));
    for step in 0..300 {
        let phase = 0.05 * f64::from(step);
        ik.set_target(hand, &[phase.sin(), 1.0, 1.0 + phase.cos(), 1.0, 0.0, 0.0, 0.0]).unwrap();
        ik.set_target(head, &[-phase.sin(), 0.0, 2.0, 0.0, 1.0, 0.0, 0.0]).unwrap();
        let tick = ik.step(&mut data, DT).unwrap();
        assert!(tick.is_solved(), "{tick:?}");
        assert!(tick.velocity()[6..].iter().all(|rate| rate.abs() <= 0.5 + 1e-9));
    }
}

#[test]
fn a_replaced_task_is_used() {
    let (mut data, mut ik, tasks) = humanoid();
    let model = data.model().clone();
    ik.step(&mut data, DT).unwrap();
    *ik.task_mut(tasks[0]).unwrap() = Task::new(JointPosition::all(&model)).with_priority(3);
    assert!(ik.step(&mut data, DT).unwrap().is_solved());
    assert_eq!(ik.error(tasks[0]).unwrap().len(), model.nv());
}

#[test]
fn weights_of_zero_leave_components_free_and_tasks_out() {
    let (mut data, _, _) = humanoid();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let target = [9.0, 9.0, 1.2];
    let hand = FramePosition::body(&model, "hand_left").unwrap().with_target(target);
    ik.add_task(Task::new(hand).with_weights([0.0, 0.0, 1.0]));
    ik.add_task(Task::new(JointPosition::all(&model)).with_weight(0.0));
    for _ in 0..50 {
        ik.step(&mut data, DT).unwrap();
    }
    data.kinematics().unwrap();
    let position = data.body("hand_left").unwrap().xpos();
    assert!((position[2] - 1.2).abs() < 1e-9 && position[0] < 1.0);
}

#[test]
fn gaze_and_coupling_are_fulfilled_together() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    data.qpos_mut().fill(0.2);
    let mut ik = Ik::new(&model);
    let target = [0.8, 0.5, 0.6];
    let camera = Gaze::new(Frame::body(&model, "link6").unwrap(), [0.0, 0.0, 1.0]).unwrap().with_target(target);
    let gaze = ik.add_task(Task::new(camera));
    let coupling = JointCoupling::new(&model, &[("joint1", 1.0), ("joint3", -2.0)]).unwrap().with_target(0.1);
    let coupling = ik.add_task(Task::new(coupling));
    ik.add_task(Task::rate(JointVelocity::all(&model)).with_weight(1e-9));
    for _ in 0..200 {
        assert!(ik.step(&mut data, DT).unwrap().is_solved());
    }
    ik.solve(&mut data, DT).unwrap();
    for task in [gaze, coupling] {
        assert!(ik.error(task).unwrap().iter().all(|value| value.abs() < 1e-6), "{:?}", ik.error(task));
    }
}

#[test]
fn targets_on_a_mocap_body_are_followed() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody><body name="table" mocap="true" pos="0 0 .2"/>
             <body><freejoint name="base"/><geom size=".1"/></body></worldbody></mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let frame = |body: usize| Frame::body(&model, body).unwrap();
    let above = FramePose::new(frame(2)).relative_to(frame(1)).with_target([0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.0]);
    ik.add_task(Task::new(above));
    for step in 0..40 {
        data.mocap_pos_mut()[0] = [0.02 * f64::from(step), 0.1, 0.2];
        ik.step(&mut data, DT).unwrap();
    }
    data.kinematics().unwrap();
    assert!(distance(&data.xpos()[2], &[0.78, 0.1, 0.7]) < 1e-6);
}

#[test]
fn an_edited_model_is_used() {
    let mut data = Data::new(arm()).unwrap();
    let mut ik = Ik::new(data.model());
    let model = data.model().clone();
    ik.add_task(Task::new(JointPosition::all(&model).with_target(&[2.0; 7]).unwrap()));
    ik.step(&mut data, DT).unwrap();
    assert!((data.qpos()[0] - 2.0).abs() < 1e-6);
    data.edit_model(|model| model.jnt_range_mut()[0] = [-1.0, 1.0]).unwrap();
    ik.step(&mut data, DT).unwrap();
    assert_eq!(data.qpos()[0], 1.0);
}
