//! Reading of MCAP files of unknown origin.
//!
//! The crate `mcap` reads the records. Two of its parsers would panic: that of records which are
//! longer than their chunk, and that of attachments. That of texts allocates the length that the
//! file states, up to 4 GiB. So this module checks the lengths in records and chunks first, and
//! does not parse attachments.

use std::collections::HashMap;
use std::io::{self, BufReader, Read};
use std::path::Path;

use ::mcap::McapResult;
use ::mcap::read::{ChunkReader, parse_record};
use ::mcap::records::{Channel, Record, op};
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::background::error;
use super::protobuf;
use crate::file;

/// Contents of a message of a record.
pub(crate) enum Part<'m> {
    /// Time, then `qpos`, `qvel`, `act` and `ctrl`.
    State(f64, [&'m [f64]; 4]),
    /// Readings of all sensors.
    Sensors(&'m [f64]),
}

/// Reads the states of a log. `put` returns the reason if a state does not fit.
pub(crate) fn read_states(path: &Path, mut put: impl FnMut(Part<'_>) -> Result<(), String>) -> io::Result<()> {
    let (mut values, mut sequence) = (<[Vec<f64>; 5]>::default(), None);
    read(path, |message| {
        let is_state = match (message.topic, message.schema) {
            ("/state", "mujoco.State") => true,
            ("/sensors", "mujoco.Sensors") => false,
            _ => return Ok(()),
        };
        values.iter_mut().for_each(Vec::clear);
        let mut fields = message.data;
        while !fields.is_empty() {
            let (number, bytes) = protobuf::take_field(&mut fields).ok_or("is not a protobuf message")?;
            // The readings of all sensors are one array.
            let index = if is_state { number.wrapping_sub(1) } else { 0 };
            let part = usize::try_from(index).ok().and_then(|index| values.get_mut(index));
            let Some(part) = part else { continue };
            let Some((numbers, [])) = bytes.map(<[u8]>::as_chunks) else {
                return Err("has a field without numbers of double precision".to_owned());
            };
            part.extend(numbers.iter().map(|number| f64::from_le_bytes(*number)));
        }
        let [time, qpos, qvel, act, ctrl] = &values;
        if is_state {
            let &[time] = &time[..] else { return Err("does not have one time".to_owned()) };
            sequence = Some(message.sequence);
            return put(Part::State(time, [qpos, qvel, act, ctrl]));
        }
        if sequence.take() != Some(message.sequence) {
            return Err("does not follow the state with its number".to_owned());
        }
        put(Part::Sensors(time))
    })
}

/// Message of a file.
pub(super) struct Message<'m> {
    pub(super) topic: &'m str,
    /// Name of the schema, or empty.
    pub(super) schema: &'m str,
    pub(super) encoding: &'m str,
    pub(super) sequence: u32,
    pub(super) data: &'m [u8],
}

/// Reads the messages of a file in their order. `put` returns the reason if it does not accept a
/// message. Memory is allocated for a record at a time, which is no longer than the file.
pub(super) fn read(path: &Path, put: impl FnMut(Message<'_>) -> Result<(), String>) -> io::Result<()> {
    let file = file::open_regular(path)?;
    let length = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
    let mut file = BufReader::new(file);
    let options = LinearReaderOptions::default().with_record_length_limit(length).with_emit_chunks(true);
    let mut reader = LinearReader::new_with_options(options);
    let mut messages = Messages { schemas: HashMap::new(), channels: HashMap::new(), put };
    let mut place = 0;
    while let Some(event) = reader.next_event() {
        let read = messages.take_event(event);
        let located = |error: io::Error| io::Error::new(error.kind(), format!("{error}, before byte {place}"));
        if let Some(count) = read.map_err(located)? {
            let count = file.read(reader.insert(count))?;
            reader.notify_read(count);
            place += count as u64;
        }
    }
    Ok(())
}

/// Checks that the records of an uncompressed chunk fill it, and are of the types that chunks have.
fn check_chunk(mut data: &[u8]) -> io::Result<()> {
    while let Some((opcode, rest)) = data.split_first() {
        if !matches!(*opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Err(invalid(format!("a chunk has a record of type {opcode:#04x}")));
        }
        let record = rest.split_first_chunk().and_then(|(length, rest)| {
            let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
            rest.split_at_checked(length)
        });
        let (record, rest) = record.ok_or_else(|| invalid("a record is longer than its chunk".to_owned()))?;
        check_lengths(*opcode, record)?;
        data = rest;
    }
    Ok(())
}

/// Checks that the texts and other parts of a record are no longer than the record.
fn check_lengths(opcode: u8, record: &[u8]) -> io::Result<()> {
    // Bytes before the parts, and the number of parts.
    let (before, parts) = match opcode {
        op::SCHEMA => (2, 3),
        op::CHANNEL => (4, 3),
        op::CHUNK => (28, 1),
        _ => return Ok(()),
    };
    let check = || {
        let (mut rest, mut part) = (record.get(before..)?, &[][..]);
        for _ in 0..parts {
            part = take_part(&mut rest)?;
        }
        // The last part of a channel consists of texts.
        while opcode == op::CHANNEL && !part.is_empty() {
            take_part(&mut part)?;
        }
        Some(())
    };
    check().ok_or_else(|| invalid(format!("a part of a record of type {opcode:#04x} is longer than the record")))
}

fn take_part<'b>(rest: &mut &'b [u8]) -> Option<&'b [u8]> {
    let length = u32::from_le_bytes(*rest.split_off(..4)?.first_chunk()?);
    rest.split_off(..length as usize)
}

/// Schemas and channels so far, and the receiver of messages.
struct Messages<P> {
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    put: P,
}

impl<P: FnMut(Message<'_>) -> Result<(), String>> Messages<P> {
    /// Takes the records of an event. Returns the number of bytes that the reader needs next.
    fn take_event(&mut self, event: McapResult<LinearReadEvent<'_>>) -> io::Result<Option<usize>> {
        match event.map_err(error)? {
            LinearReadEvent::ReadRequest(count) => return Ok(Some(count)),
            LinearReadEvent::Record { opcode: op::CHUNK, data } => {
                check_lengths(op::CHUNK, data)?;
                if let Record::Chunk { header, data } = parse_record(op::CHUNK, data).map_err(error)? {
                    if header.compression.is_empty() {
                        check_chunk(&data)?;
                    }
                    for record in ChunkReader::new(header, &data).map_err(error)? {
                        self.take(record.map_err(error)?)?;
                    }
                }
            }
            LinearReadEvent::Record { opcode: opcode @ (op::SCHEMA | op::CHANNEL | op::MESSAGE), data } => {
                check_lengths(opcode, data)?;
                self.take(parse_record(opcode, data).map_err(error)?)?;
            }
            LinearReadEvent::Record { .. } => (),
        }
        Ok(None)
    }

    /// Stores a schema or a channel, or passes a message on.
    fn take(&mut self, record: Record<'_>) -> io::Result<()> {
        match record {
            Record::Schema { header, .. } => _ = self.schemas.insert(header.id, header.name),
            Record::Channel(channel) => _ = self.channels.insert(channel.id, channel),
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(&header.channel_id) else {
                    return Err(invalid(format!("a message has the unknown channel {}", header.channel_id)));
                };
                let schema = self.schemas.get(&channel.schema_id).map_or("", |name| name);
                let Channel { topic, message_encoding: encoding, .. } = channel;
                let message = Message { topic, schema, encoding, sequence: header.sequence, data: &data };
                (self.put)(message)
                    .map_err(|reason| invalid(format!("message {} of the topic {topic} {reason}", header.sequence)))?;
            }
            _ => (),
        }
        Ok(())
    }
}

fn invalid(reason: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason)
}
