//! Joint states of ROS 2 bags: messages `sensor_msgs/msg/JointState` in the encoding CDR.

use std::collections::BTreeMap;
use std::path::Path;

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use serde::Deserialize;

use super::read::{Message, read};
use crate::error::{Error, Result};

/// Recorded values of a joint, one for each message that has the joint.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointSeries {
    /// Times of the messages' headers since the start of the clock, ns.
    pub times: Vec<i64>,
    /// Positions, rad or m. NaN for a message without positions.
    pub position: Vec<f64>,
    /// Velocities, rad/s or m/s. NaN for a message without velocities.
    pub velocity: Vec<f64>,
    /// Torques, N·m, or forces, N. NaN for a message without efforts.
    pub effort: Vec<f64>,
}

/// Reads the joint states of a topic of a ROS 2 bag, an MCAP file, by the names of the joints.
/// Messages may have different joints.
///
/// # Errors
///
/// [`Error::File`] if the file cannot be read, is a pipe or a device, is damaged or has compressed
/// chunks (`mcap decompress` of the program `mcap` unpacks them), if the topic does not exist or
/// has other messages, or if the arrays of a message have different lengths.
///
/// ```no_run
/// use mujoco_safe::mcap::read_joint_states;
/// use mujoco_safe::sample;
///
/// let joints = read_joint_states("robot.mcap", "/joint_states")?;
/// let knee = &joints["left_knee"];
/// println!("{} states, from {} rad", knee.times.len(), knee.position[0]);
///
/// // The positions of a model in the first state.
/// let model = sample::humanoid();
/// let mut qpos = model.qpos0().to_vec();
/// for (name, series) in &joints {
///     qpos[model.joint(name.as_str())?.qpos_range().start] = series.position[0];
/// }
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "rosbag")]
#[doc(alias = "sensor_msgs")]
pub fn read_joint_states(path: impl AsRef<Path>, topic: &str) -> Result<BTreeMap<String, JointSeries>> {
    let (mut joints, mut found) = (BTreeMap::new(), false);
    let path = path.as_ref();
    let put = |message: Message<'_>| {
        if message.topic != topic {
            return Ok(());
        }
        found = true;
        if message.schema != "sensor_msgs/msg/JointState" || message.encoding != "cdr" {
            let (schema, encoding) = (message.schema, message.encoding);
            return Err(format!("is {schema:?} in {encoding:?}, not sensor_msgs/msg/JointState in CDR"));
        }
        append(&mut joints, message.data).ok_or_else(|| "is damaged, or has arrays of different lengths".to_owned())
    };
    read(path, put).map_err(Error::file(path))?;
    if found {
        return Ok(joints);
    }
    let error = std::io::Error::new(std::io::ErrorKind::NotFound, format!("there is no message of the topic {topic}"));
    Err(Error::file(path)(error))
}

/// Message `sensor_msgs/msg/JointState`.
#[derive(Deserialize)]
struct JointState {
    header: Header,
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}

#[derive(Deserialize)]
struct Header {
    seconds: i32,
    nanoseconds: u32,
    _frame_id: String,
}

/// Decodes a message in CDR: four bytes with the order of bytes, and the fields.
fn decode(message: &[u8]) -> Option<JointState> {
    let ([0, order, ..], fields) = message.split_first_chunk::<4>()? else { return None };
    let decoded = match order {
        0 => from_bytes::<_, BigEndian>(fields),
        1 => from_bytes::<_, LittleEndian>(fields),
        _ => return None,
    };
    decoded.ok().map(|(state, _)| state)
}

/// Appends the values of a message. Returns `None` if it is damaged.
fn append(joints: &mut BTreeMap<String, JointSeries>, message: &[u8]) -> Option<()> {
    let JointState { header, name, position, velocity, effort } = decode(message)?;
    if [&position, &velocity, &effort].iter().any(|values| !values.is_empty() && values.len() != name.len()) {
        return None;
    }
    let time = i64::from(header.seconds) * 1_000_000_000 + i64::from(header.nanoseconds);
    for (index, name) in name.into_iter().enumerate() {
        let series = joints.entry(name).or_default();
        let value = |values: &[f64]| values.get(index).copied().unwrap_or(f64::NAN);
        series.times.push(time);
        series.position.push(value(&position));
        series.velocity.push(value(&velocity));
        series.effort.push(value(&effort));
    }
    Some(())
}
