//! Inverse kinematics: Jacobians, ticks, limits, closed chains, searches, and the numbers of mink.

mod chains;
mod distances;
mod hostile;
mod jacobians;
mod limits;
mod mink;
mod robots;
mod search;
mod tasks;

use std::sync::Arc;

use mujoco_safe::control::residual::{Frame, FramePose, JointPosition, Subtree};
use mujoco_safe::ik::{Ik, Task, TaskId};
use mujoco_safe::{Data, Model, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn random(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

/// Writes positions within the ranges of hinges and slides; others keep theirs.
fn randomise(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    let model = data.model().clone();
    for (joint, &[from, to]) in model.jnt_range().iter().enumerate() {
        if from < to {
            data.qpos_mut()[model.jnt_qposadr()[joint] as usize] = random.random_range(from..to);
        }
    }
}

/// An arm of seven hinges with ranges, as an URDF file.
fn arm() -> Model {
    let mut urdf = String::from(r#"<robot name="arm"><link name="base"/>"#);
    for joint in 0..7 {
        let parent = if joint == 0 { "base".to_owned() } else { format!("link{}", joint - 1) };
        let axis = ["0 0 1", "0 1 0"][joint % 2];
        let link = format!(
            r#"<link name="link{joint}"><inertial><mass value="1"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>
                 <collision><origin xyz="0 0 .1"/><geometry><sphere radius=".05"/></geometry></collision></link>
               <joint name="joint{joint}" type="revolute"><parent link="{parent}"/><child link="link{joint}"/>
                 <origin xyz="{} 0 .2"/><axis xyz="{axis}"/><limit lower="-2.4" upper="2.4" effort="10" velocity="2"/></joint>"#,
            0.02 * joint as f64
        );
        urdf += &link;
    }
    Model::from_xml_str(&(urdf + "</robot>")).unwrap()
}

/// The tasks of the comparison with mink: both feet, both hands, the centre of mass and a posture.
fn humanoid() -> (Data, Ik, [TaskId; 6]) {
    let model = Arc::new(sample::humanoid());
    let mut ik = Ik::new(&model);
    let pose = |name: &str| FramePose::new(Frame::body(&model, name).unwrap());
    let full = [1.0, 1.0, 1.0, 0.25, 0.25, 0.25];
    let hand = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let tasks = [
        ik.add_task(Task::new(pose("foot_left")).with_weights(full)),
        ik.add_task(Task::new(pose("foot_right")).with_weights(full)),
        ik.add_task(Task::new(pose("hand_left")).with_weights(hand)),
        ik.add_task(Task::new(pose("hand_right")).with_weights(hand)),
        ik.add_task(Task::new(Subtree::com(&model, "torso").unwrap())),
        ik.add_task(Task::new(JointPosition::all(&model)).with_weight(1e-4)),
    ];
    let mut data = Data::new(&model).unwrap();
    data.reset_to_key("stand").unwrap();
    data.forward().unwrap();
    for (task, body) in tasks.into_iter().zip(["foot_left", "foot_right", "hand_left", "hand_right"]) {
        let body = data.body(body).unwrap();
        ik.set_target(task, &[body.xpos().as_slice(), body.xquat()].concat()).unwrap();
    }
    ik.set_target(tasks[4], data.body("torso").unwrap().subtree_com()).unwrap();
    ik.set_target(tasks[5], data.qpos()).unwrap();
    (data, ik, tasks)
}
