//! The channels of a log, and their messages.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io::{self, BufWriter};

use ::mcap::records::MessageHeader;
use ::mcap::write::{Metadata, NoSeek};
use ::mcap::{Attachment, WriteOptions};

use super::background::{Background, FileWriter, error};
use super::deformable::Deformables;
use super::protobuf::Message;
use super::{geometry, schema};
use crate::data::{ContactSide, Data};
use crate::engine::engine_version;
use crate::enums::JointType;
use crate::model::Model;

/// Uncompressed size of a chunk, bytes. A chunk is written as a whole.
const CHUNK: u64 = 256 << 10;

/// Schema of the sensors, which depends on the model.
const SENSORS: &str = "mujoco.Sensors";

/// Writer of the file, and the messages that it writes next.
pub(crate) struct Channels {
    pub(super) output: Output,
    state: Message,
    sensors: Message,
    names: Names,
    joints: Message,
    frames: Message,
    contacts: Message,
    scene: Message,
    /// `None` for a model without deformable shapes.
    deformables: Option<Deformables>,
}

/// Writer of messages by their topics.
pub(crate) struct Output {
    sink: Background,
    /// Topics whose channels have been added. The id of a channel is its number, counted from 1.
    topics: Vec<String>,
    /// Text of the schema of the sensors.
    sensors: String,
    /// Number of the present record.
    sequence: u32,
}

impl Output {
    /// Writes a message of the present record. A topic is added at its first message.
    pub(super) fn send(&mut self, time: f64, topic: &str, schema: &str, message: &mut Message) -> io::Result<()> {
        let index = self.topics.iter().position(|known| known == topic).unwrap_or_else(|| {
            let of_sensors = [("sensors.proto", &*self.sensors)];
            let files = if schema == SENSORS { &of_sensors[..] } else { &schema::COMMON };
            self.sink.add_channel(topic, schema, schema::descriptors(files));
            self.topics.push(topic.to_owned());
            self.topics.len() - 1
        });
        let channel_id = u16::try_from(index + 1).map_err(|_| io::Error::other("the file has 65,535 topics"))?;
        let log_time = nanoseconds(time);
        message.set_stamps(log_time);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.sink.send(header, message.bytes())
    }
}

/// Names of the elements in messages.
struct Names {
    bodies: Vec<String>,
    geoms: Vec<String>,
    joints: Vec<Joint>,
}

/// Joint with one degree of freedom.
struct Joint {
    name: String,
    qpos: usize,
    dof: usize,
}

/// Writes the start of a file: metadata and the model.
fn start(file: File, model: &Model) -> io::Result<FileWriter> {
    let options = WriteOptions::new().disable_seeking(true).chunk_size(Some(CHUNK)).compression(None);
    let mut writer = options.create(NoSeek::new(BufWriter::new(file))).map_err(error)?;
    let (metadata, xml) = describe(model);
    writer.write_metadata(&metadata).map_err(error)?;
    if let Some(xml) = xml {
        let (name, media_type) = ("model.xml".to_owned(), "application/xml".to_owned());
        let data = Cow::Owned(xml.into_bytes());
        writer.attach(&Attachment { log_time: 0, create_time: 0, name, media_type, data }).map_err(error)?;
    }
    Ok(writer)
}

impl Channels {
    /// Writes the start of a file, and prepares the messages.
    pub(crate) fn create(file: File, model: &Model) -> io::Result<Self> {
        let mut state = Message::default();
        state.put_double(1, 0.0);
        for (field, count) in (2..).zip([model.nq(), model.nv(), model.na(), model.nu()]) {
            state.put_doubles(field, count);
        }
        let mut readings = Message::default();
        for (index, sensor) in model.sensors().enumerate() {
            readings.put_doubles(field_number(index), sensor.dim());
        }
        let mut channels = Self {
            output: Output {
                sink: Background::new(start(file, model)?)?,
                topics: Vec::new(),
                sensors: sensors_schema(model),
                sequence: 0,
            },
            state,
            sensors: readings,
            names: Names { bodies: Vec::new(), geoms: Vec::new(), joints: Vec::new() },
            joints: Message::default(),
            frames: Message::default(),
            contacts: Message::default(),
            scene: Message::default(),
            deformables: Deformables::of(model).map_err(io::Error::other)?,
        };
        channels.set_model(model);
        Ok(channels)
    }

    /// Prepares the messages with names and shapes. Returns `true` if the shapes differ from those
    /// of the previous model.
    pub(crate) fn set_model(&mut self, model: &Model) -> bool {
        self.names = Names::of(model);
        self.joints = self.names.joint_states();
        self.frames = self.names.frame_transforms();
        let scene = geometry::scene(model, &self.names.bodies);
        self.scene.set_stamps(0);
        let differs = scene.bytes() != self.scene.bytes();
        self.scene = scene;
        differs
    }

    /// Writes the first message of a record, its state.
    pub(crate) fn write_state(&mut self, time: f64, state: [&[f64]; 4]) -> io::Result<()> {
        self.output.sequence = self.output.sequence.wrapping_add(1);
        let [qpos, qvel, act, ctrl] = state;
        self.state.fill([std::slice::from_ref(&time), qpos, qvel, act, ctrl]);
        self.output.send(time, "/state", "mujoco.State", &mut self.state)
    }

    /// Writes the readings of all sensors of the present record.
    pub(crate) fn write_sensors(&mut self, time: f64, model: &Model, readings: &[f64]) -> io::Result<()> {
        let (starts, counts) = (model.sensor_adr(), model.sensor_dim());
        self.sensors
            .fill(starts.iter().zip(counts).map(|(&start, &count)| &readings[start as usize..][..count as usize]));
        self.output.send(time, "/sensors", SENSORS, &mut self.sensors)
    }

    /// Writes the shapes of the model.
    pub(crate) fn write_scene(&mut self, time: f64) -> io::Result<()> {
        self.output.send(time, "/scene", "foxglove.SceneUpdate", &mut self.scene)
    }

    /// Writes the poses, joint states, contacts and deformable shapes of the present record. The
    /// forces must have been computed.
    pub(crate) fn write_display(&mut self, time: f64, qpos: &[f64], qvel: &[f64], data: &Data) -> io::Result<()> {
        let forces = data.qfrc_actuator();
        self.joints.fill(self.names.joints.iter().flat_map(|&Joint { qpos: position, dof, .. }| {
            [&qpos[position..=position], &qvel[dof..=dof], &forces[dof..=dof]]
        }));
        self.output.send(time, "/joints", "foxglove.JointStates", &mut self.joints)?;
        let poses = data.xpos().iter().zip(data.xquat()).skip(1);
        self.frames
            .fill(poses.flat_map(|([x, y, z], [w, qx, qy, qz])| [x, y, z, qx, qy, qz, w]).map(std::slice::from_ref));
        self.output.send(time, "/tf", "foxglove.FrameTransforms", &mut self.frames)?;
        self.encode_contacts(data);
        self.output.send(time, "/contacts", "mujoco.Contacts", &mut self.contacts)?;
        let Some(deformables) = &mut self.deformables else { return Ok(()) };
        let message = deformables.encode(data, &self.names.bodies[0]).map_err(io::Error::other)?;
        self.output.send(time, "/scene/deformable", "foxglove.SceneUpdate", message)
    }

    fn encode_contacts(&mut self, data: &Data) {
        let Self { contacts, names, .. } = self;
        contacts.clear();
        contacts.put_stamp(1);
        for contact in data.contacts() {
            let force = contact.force_in_world().expect("Bug: the caller has not checked the forces");
            contacts.put_message(2, |message| {
                for (field, side) in (1..).zip(contact.sides()) {
                    match side {
                        ContactSide::Geom(geom) => message.put_text(field, &names.geoms[geom.index()]),
                        ContactSide::FlexElement { flex, element } => {
                            message.put_text(field, &format!("flex{flex} element {element}"));
                        }
                        ContactSide::FlexVertex { flex, vertex } => {
                            message.put_text(field, &format!("flex{flex} vertex {vertex}"));
                        }
                    }
                }
                message.put_tuple(3, contact.pos());
                message.put_tuple(4, contact.normal());
                message.put_tuple(5, &force);
                message.put_double(6, contact.dist());
            });
        }
    }

    /// Writes the end of the file.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.output.sink.end()
    }
}

impl Names {
    fn of(model: &Model) -> Self {
        let joints = model.joints().zip(unique(model.joints().map(|joint| joint.name()), "joint", str::to_owned));
        let scalar = joints.filter(|(joint, _)| matches!(joint.joint_type(), JointType::Hinge | JointType::Slide));
        let joints =
            scalar.map(|(joint, name)| Joint { name, qpos: joint.qpos_range().start, dof: joint.dofs().start });
        Self {
            joints: joints.collect(),
            bodies: unique(model.bodies().map(|body| body.name()), "body", str::to_owned),
            geoms: unique(model.geoms().map(|geom| geom.name()), "geom", str::to_owned),
        }
    }

    /// Returns the `JointStates`, whose numbers are position, velocity and effort of each joint.
    fn joint_states(&self) -> Message {
        let mut message = Message::default();
        message.put_stamp(1);
        for Joint { name, .. } in &self.joints {
            message.put_message(2, |joint| {
                joint.put_text(1, name);
                for field in [2, 3, 5] {
                    joint.put_double(field, 0.0);
                }
            });
        }
        message
    }

    /// Returns the `FrameTransforms` from each body to the world, whose numbers are those of the
    /// position and of the quaternion.
    fn frame_transforms(&self) -> Message {
        let mut message = Message::default();
        for body in &self.bodies[1..] {
            message.put_message(1, |transform| {
                transform.put_stamp(1);
                transform.put_text(2, &self.bodies[0]);
                transform.put_text(3, body);
                transform.put_tuple(4, &[0.0; 3]);
                transform.put_tuple(5, &[0.0; 4]);
            });
        }
        message
    }
}

/// Returns the metadata of a model, and its text if the engine can write it.
fn describe(model: &Model) -> (Metadata, Option<String>) {
    let xml = model.to_xml();
    let (nq, nv, na, nu, nsensordata) = (model.nq(), model.nv(), model.na(), model.nu(), model.nsensordata());
    let sizes = format!("nq {nq}, nv {nv}, na {na}, nu {nu}, nsensordata {nsensordata}");
    let mut entries = BTreeMap::from([
        ("crate".to_owned(), concat!("mujoco-safe ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("engine".to_owned(), engine_version().to_string()),
        ("sizes".to_owned(), sizes),
        ("options".to_owned(), format!("{:?}", model.options())),
    ]);
    if let Err(error) = &xml {
        entries.insert("model.xml".to_owned(), format!("missing: {error}"));
    }
    (Metadata { name: "mujoco".to_owned(), metadata: entries }, xml.ok())
}

/// Returns the text of the message of the sensors: a field for each.
fn sensors_schema(model: &Model) -> String {
    let names = model.sensors().map(|sensor| sensor.name().map(identifier));
    // The names in JSON must also be different: they lack underscores.
    let key = |name: &str| name.replace('_', "").to_lowercase();
    let mut text = "package mujoco;\nmessage Sensors {\n".to_owned();
    for (index, name) in unique(names, "sensor", key).into_iter().enumerate() {
        text.extend(["repeated double ", &name, " = ", &field_number(index).to_string(), ";\n"]);
    }
    text + "}\n"
}

/// Returns the number of the field of a sensor. The format reserves the numbers from 19000 to
/// 19999.
fn field_number(index: usize) -> u32 {
    let number = index as u32 + 1;
    if number < 19000 { number } else { number + 1000 }
}

/// Returns a name of letters, digits and underscores.
fn identifier(name: &str) -> String {
    let name: String = name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
    if name.starts_with(|letter: char| letter.is_ascii_digit()) { format!("_{name}") } else { name }
}

/// Returns a name for each element. No two have the same `key`.
fn unique<N: Into<String>>(
    names: impl Iterator<Item = Option<N>>,
    kind: &str,
    key: impl Fn(&str) -> String,
) -> Vec<String> {
    let names: Vec<Option<String>> = names.map(|name| name.map(Into::into)).collect();
    let mut taken: HashSet<String> = names.iter().flatten().map(|name| key(name)).collect();
    let mut seen = HashSet::new();
    let name = |(index, name): (usize, Option<String>)| {
        let name = match name {
            Some(name) if seen.insert(key(&name)) => return name,
            Some(name) => name,
            None => format!("{kind}{index}"),
        };
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let mut candidates = std::iter::once(name.clone()).chain(numbered);
        candidates.find(|name| taken.insert(key(name))).expect("Bug: the numbers are exhausted")
    };
    names.into_iter().enumerate().map(name).collect()
}

/// Converts a time to nanoseconds. Negative times and NaN become zero.
fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}
