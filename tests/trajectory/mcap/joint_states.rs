//! Joint states of a ROS 2 bag, which the official writer for Python has written
//! (`joint_states.py`).

use std::fs;
use std::path::PathBuf;

use mujoco_safe::mcap::read_joint_states;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::chunk_crc::clear_chunk_crc;

fn bag() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/trajectory/mcap/joint_states.mcap"))
}

#[test]
fn joint_states_of_a_bag_are_series_by_name() {
    let joints = read_joint_states(bag(), "/joint_states").unwrap();
    assert_eq!(joints.keys().collect::<Vec<_>>(), ["a", "gripper", "hip", "left_knee"]);
    let start = 1_700_000_000_000_000_000;
    let knee = &joints["left_knee"];
    assert_eq!(knee.times, [start + 5, start + 1_000_000_000]);
    assert_eq!((&knee.position[..], knee.velocity[0], knee.effort[0]), (&[-0.2, -0.25][..], 2.0, 0.0));
    assert!(knee.velocity[1].is_nan() && knee.effort[1].is_nan());
    assert_eq!(joints["hip"].position, [0.1, 0.15]);
    assert_eq!((joints["gripper"].times[0], joints["gripper"].position[0]), (start + 10_000_005, 0.04));
    assert_eq!((joints["a"].position[0], joints["a"].effort[0]), (1e-300, 7.0));
}

#[test]
fn other_topics_and_messages_are_errors() {
    let error = read_joint_states(bag(), "/other").unwrap_err().to_string();
    assert!(error.contains("there is no message of the topic /other"), "{error}");
    let error = read_joint_states(bag(), "/chatter").unwrap_err().to_string();
    let expected =
        r#"message 0 of the topic /chatter is "std_msgs/msg/String" in "cdr", not sensor_msgs/msg/JointState in CDR"#;
    assert!(error.contains(expected), "{error}");
}

#[test]
fn changed_bytes_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let bytes = fs::read(bag()).unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut read, mut rejected) = (0, 0);
    for _ in 0..3000 {
        let mut damaged = bytes.clone();
        let place = random.random_range(0..damaged.len());
        damaged[place] = random.random();
        clear_chunk_crc(&mut damaged);
        damaged.truncate(random.random_range(0..4 * bytes.len()));
        fs::write(&path, &damaged).unwrap();
        match read_joint_states(&path, "/joint_states") {
            Ok(_) => read += 1,
            Err(_) => rejected += 1,
        }
    }
    assert!(read > 100 && rejected > 100, "{read} read, {rejected} rejected");
}
