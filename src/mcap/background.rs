//! Writing of a file in another thread, so that a step of the simulation only copies its messages.

use std::io::{self, Write};
use std::mem;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use ::mcap::Writer;
use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;

use super::channels::{Sink, error};

/// Size of a buffer, bytes. A full buffer is passed to the thread, which costs up to a step of time
/// for waking it: with buffers of 64 KiB, 2 % of all steps of a humanoid.
const BUFFER: usize = 512 << 10;
/// Number of buffers. If the thread has all, a step waits.
const BUFFERS: usize = 4;
/// Id that no channel has, for messages to the thread: a channel to add, its schema and its topic.
const ADD_CHANNEL: u16 = 0;
/// Bytes of the header of a message in a buffer: channel, sequence, time and length.
const HEADER: usize = 2 + 4 + 8 + 4;

/// Messages of a thread that writes them.
pub(super) struct Background {
    buffer: Vec<u8>,
    /// Empty buffers.
    empty: Receiver<Vec<u8>>,
    /// `None` after the end.
    thread: Option<Thread>,
}

/// Thread that writes.
struct Thread {
    full: SyncSender<Vec<u8>>,
    handle: JoinHandle<io::Result<()>>,
}

impl Background {
    /// Starts the thread.
    pub(super) fn new<W: Write + Send + 'static>(writer: Writer<NoSeek<W>>) -> io::Result<Self> {
        let ((full, received), (returned, empty)) = (sync_channel::<Vec<u8>>(BUFFERS), channel());
        for _ in 1..BUFFERS {
            returned.send(Vec::with_capacity(BUFFER)).expect("Bug: the receiver exists");
        }
        let handle = Builder::new().name("mcap".to_owned()).spawn(move || {
            let mut writer = writer;
            for mut buffer in received {
                write(&mut writer, &buffer)?;
                buffer.clear();
                // The receiver is dropped before the last buffers are written.
                returned.send(buffer).ok();
            }
            Sink::finish(writer)
        })?;
        Ok(Self { buffer: Vec::with_capacity(BUFFER), empty, thread: Some(Thread { full, handle }) })
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
    fn end(&mut self) -> io::Result<()> {
        let Some(Thread { full, handle }) = self.thread.take() else { return Ok(()) };
        let last = mem::take(&mut self.buffer);
        // An error of the thread, which its result has, has closed the channel.
        full.send(last).ok();
        drop(full);
        handle.join().unwrap_or_else(|_| Err(ended()))
    }
}

impl Sink for Background {
    fn add_channel(&mut self, topic: &str, schema: &str) -> io::Result<()> {
        let header = MessageHeader { channel_id: ADD_CHANNEL, sequence: 0, log_time: 0, publish_time: 0 };
        self.send(&header, format!("{schema} {topic}").as_bytes())
    }

    #[inline]
    fn send(&mut self, header: &MessageHeader, message: &[u8]) -> io::Result<()> {
        if !self.buffer.is_empty() && self.buffer.len() + HEADER + message.len() > BUFFER {
            self.pass()?;
        }
        let &MessageHeader { channel_id, sequence, log_time, .. } = header;
        self.buffer.extend_from_slice(&channel_id.to_le_bytes());
        self.buffer.extend_from_slice(&sequence.to_le_bytes());
        self.buffer.extend_from_slice(&log_time.to_le_bytes());
        self.buffer.extend_from_slice(&(message.len() as u32).to_le_bytes());
        self.buffer.extend_from_slice(message);
        Ok(())
    }

    fn finish(mut self) -> io::Result<()> {
        self.end()
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        // `finish` returns errors.
        self.end().ok();
    }
}

/// Writes the messages of a buffer.
fn write<W: Write>(writer: &mut Writer<NoSeek<W>>, mut buffer: &[u8]) -> io::Result<()> {
    const WHOLE: &str = "Bug: a buffer has a part of a message";
    while let Some((header, rest)) = buffer.split_first_chunk::<HEADER>() {
        let (channel, header) = header.split_first_chunk().expect(WHOLE);
        let (sequence, header) = header.split_first_chunk().expect(WHOLE);
        let (time, length) = header.split_first_chunk().expect(WHOLE);
        let length = u32::from_le_bytes(*length.first_chunk().expect(WHOLE)) as usize;
        let (message, rest) = rest.split_at(length);
        let time = u64::from_le_bytes(*time);
        let (channel_id, sequence) = (u16::from_le_bytes(*channel), u32::from_le_bytes(*sequence));
        if channel_id == ADD_CHANNEL {
            let text = str::from_utf8(message).expect(WHOLE);
            let (schema, topic) = text.split_once(' ').expect(WHOLE);
            Sink::add_channel(writer, topic, schema)?;
        } else {
            let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, message).map_err(error)?;
        }
        buffer = rest;
    }
    Ok(())
}

fn ended() -> io::Error {
    io::Error::other("the thread that writes the log has ended")
}
