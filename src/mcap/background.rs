//! Writing of a file in another thread, so that a step of the simulation only copies its messages.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::mem;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{McapError, Writer};

/// Size of the messages of a buffer, bytes. A full buffer is passed to the thread, which costs up
/// to a step of time for waking it: with buffers of 64 KiB, 2 % of all steps of a humanoid.
const BUFFER: usize = 512 << 10;
/// Number of messages for which a buffer has memory at the start.
const MESSAGES: usize = BUFFER / 256;
/// Number of buffers. If the thread has all, a step waits.
const BUFFERS: usize = 4;

/// Writer of a file.
pub(super) type FileWriter = Writer<NoSeek<BufWriter<File>>>;

/// Messages of a thread that writes them.
pub(super) struct Background {
    buffer: Buffer,
    /// Empty buffers.
    empty: Receiver<Buffer>,
    /// `None` after the end.
    thread: Option<Thread>,
}

/// Thread that writes.
struct Thread {
    full: SyncSender<Buffer>,
    handle: JoinHandle<io::Result<()>>,
}

#[derive(Default)]
struct Buffer {
    /// Channels that are added before the messages.
    channels: Vec<Channel>,
    /// Headers and lengths of the messages.
    messages: Vec<(MessageHeader, usize)>,
    /// The messages, one after another.
    bytes: Vec<u8>,
}

struct Channel {
    topic: String,
    schema: String,
    descriptors: Vec<u8>,
}

impl Background {
    /// Starts the thread.
    pub(super) fn new(mut writer: FileWriter) -> io::Result<Self> {
        let ((full, received), (returned, empty)) = (sync_channel::<Buffer>(BUFFERS), channel());
        let buffer = || Buffer {
            bytes: Vec::with_capacity(BUFFER),
            messages: Vec::with_capacity(MESSAGES),
            channels: Vec::new(),
        };
        for _ in 1..BUFFERS {
            returned.send(buffer()).expect("Bug: the receiver exists");
        }
        let handle = Builder::new().name("mcap".to_owned()).spawn(move || {
            for mut buffer in received {
                write(&mut writer, &mut buffer)?;
                // The receiver is dropped before the last buffers are written.
                returned.send(buffer).ok();
            }
            writer.finish().map_err(error)?;
            writer.into_inner().flush()
        })?;
        Ok(Self { buffer: buffer(), empty, thread: Some(Thread { full, handle }) })
    }

    /// Adds a channel of protobuf messages, whose id is the number of channels.
    pub(super) fn add_channel(&mut self, topic: &str, schema: &str, descriptors: Vec<u8>) {
        self.buffer.channels.push(Channel { topic: topic.to_owned(), schema: schema.to_owned(), descriptors });
    }

    /// Writes a message.
    #[inline]
    pub(super) fn send(&mut self, header: MessageHeader, message: &[u8]) -> io::Result<()> {
        if !self.buffer.bytes.is_empty() && self.buffer.bytes.len() + message.len() > BUFFER {
            self.pass()?;
        }
        self.buffer.messages.push((header, message.len()));
        self.buffer.bytes.extend_from_slice(message);
        Ok(())
    }

    /// Passes the buffer to the thread.
    #[cold]
    fn pass(&mut self) -> io::Result<()> {
        let Some(Thread { full, .. }) = &self.thread else { return Err(ended()) };
        if full.send(mem::take(&mut self.buffer)).is_ok()
            && let Ok(empty) = self.empty.recv()
        {
            self.buffer = empty;
            return Ok(());
        }
        self.end().and(Err(ended()))
    }

    /// Waits for the end of the thread, and returns its error.
    pub(super) fn end(&mut self) -> io::Result<()> {
        let Some(Thread { full, handle }) = self.thread.take() else { return Ok(()) };
        let last = mem::take(&mut self.buffer);
        // An error of the thread, which its result has, has closed the channel.
        full.send(last).ok();
        drop(full);
        handle.join().unwrap_or_else(|_| Err(ended()))
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        // `finish` of the log returns errors.
        self.end().ok();
    }
}

/// Writes the messages of a buffer, and empties it.
fn write(writer: &mut FileWriter, buffer: &mut Buffer) -> io::Result<()> {
    for Channel { topic, schema, descriptors } in buffer.channels.drain(..) {
        let schema = writer.add_schema(&schema, "protobuf", &descriptors).map_err(error)?;
        writer.add_channel(schema, &topic, "protobuf", &BTreeMap::new()).map_err(error)?;
    }
    let mut rest = &buffer.bytes[..];
    for (header, length) in buffer.messages.drain(..) {
        let (message, after) = rest.split_at(length);
        writer.write_to_known_channel(&header, message).map_err(error)?;
        rest = after;
    }
    buffer.bytes.clear();
    Ok(())
}

fn ended() -> io::Error {
    io::Error::other("the thread that writes the log has ended")
}

/// Converts an error of the crate `mcap`.
pub(super) fn error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::new(io::ErrorKind::InvalidData, error.to_string()),
    }
}
