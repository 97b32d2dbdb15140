//! Joint states of ROS 2 bags: messages `sensor_msgs/msg/JointState` in the encoding CDR.

use std::collections::BTreeMap;
use std::path::Path;

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

/// Appends the values of a message. Returns `None` if it is damaged.
fn append(joints: &mut BTreeMap<String, JointSeries>, message: &[u8]) -> Option<()> {
    let mut cdr = Cdr::new(message)?;
    let (seconds, nanoseconds) = (i64::from(cdr.u32()?.cast_signed()), i64::from(cdr.u32()?));
    cdr.text()?;
    let count = cdr.u32()?;
    let mut names = Vec::new();
    for _ in 0..count {
        names.push(cdr.text()?);
    }
    let [position, velocity, effort] = [cdr.doubles()?, cdr.doubles()?, cdr.doubles()?];
    if [&position, &velocity, &effort].iter().any(|values| !values.is_empty() && values.len() != names.len()) {
        return None;
    }
    for (index, name) in names.into_iter().enumerate() {
        let series = joints.entry(name.to_owned()).or_default();
        let value = |values: &[f64]| values.get(index).copied().unwrap_or(f64::NAN);
        series.times.push(seconds * 1_000_000_000 + nanoseconds);
        series.position.push(value(&position));
        series.velocity.push(value(&velocity));
        series.effort.push(value(&effort));
    }
    Some(())
}

/// Reader of a message in CDR, whose numbers are aligned to their size.
struct Cdr<'b> {
    bytes: &'b [u8],
    place: usize,
    is_little_endian: bool,
}

impl<'b> Cdr<'b> {
    /// Reads the header of four bytes.
    fn new(bytes: &'b [u8]) -> Option<Self> {
        let ([first, order, ..], bytes) = bytes.split_first_chunk::<4>()?;
        (*first == 0 && *order <= 1).then_some(Self { bytes, place: 0, is_little_endian: *order == 1 })
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.place = self.place.next_multiple_of(N);
        let mut number = *self.bytes.get(self.place..)?.first_chunk::<N>()?;
        self.place += N;
        if !self.is_little_endian {
            number.reverse();
        }
        Some(number)
    }

    fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    /// Reads a text, which ends with a zero.
    fn text(&mut self) -> Option<&'b str> {
        let length = self.u32()? as usize;
        let text = self.bytes.get(self.place..)?.get(..length)?;
        self.place += length;
        str::from_utf8(text.strip_suffix(&[0]).unwrap_or(text)).ok()
    }

    fn doubles(&mut self) -> Option<Vec<f64>> {
        let count = self.u32()? as usize;
        let mut values = Vec::new();
        for _ in 0..count {
            values.push(f64::from_le_bytes(self.number()?));
        }
        Some(values)
    }
}
