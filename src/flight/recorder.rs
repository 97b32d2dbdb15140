//! The recorder, which makes the calls and keeps the last ones.

use std::collections::VecDeque;
use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::change::{self, Checksum};
use super::format::Block;
use super::inputs::{self, Call};
use super::model_image::ModelImage;
use super::origin::Origin;
use super::recording::{CLOSURES, FAILED, MAGIC, Recording, VERSION};
use super::ring::Ring;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

/// Default of [`FlightRecorder::with_memory`].
const MEMORY: usize = 16 << 20;
/// Number of segments that the ring has at least.
const SEGMENTS: u64 = 8;
/// Bound of the size of an error's text in bytes.
const MOST_TEXT: usize = 1000;

/// Recorder of everything that enters a simulation, in a ring of bounded memory: call its
/// [`step`](Self::step) instead of [`Data::step`]. See the [module](crate::flight).
///
/// It holds no simulation: the program changes the simulation freely between the calls. A recorder
/// can follow several simulations in turn; a file for each is easier to read.
///
/// If the thread panics while the recorder exists, its destructor writes the
/// [file](Self::with_file). A program with `panic = "abort"` gets no file.
pub struct FlightRecorder {
    ring: Ring,
    segments: VecDeque<Segment>,
    /// End of the last complete call in the ring.
    complete: u64,
    /// Values before the present call of a simulation with closures.
    before: Vec<f64>,
    /// Values after the previous call. During a call without closures, those before it.
    after: Vec<f64>,
    image: Arc<ModelImage>,
    /// Revision of the model of `image`.
    revision: u64,
    /// Number of values of this model.
    values: usize,
    /// `true` if the next call begins a segment.
    is_interrupted: bool,
    previous: Option<Call>,
    /// Number of the next call.
    next: u64,
    memory: usize,
    file: Option<PathBuf>,
    xml: String,
    note: String,
}

/// Calls that begin with all values.
struct Segment {
    /// Place in the ring.
    start: u64,
    /// End of its last complete call.
    end: u64,
    /// Number of the first call.
    first: u64,
    /// Number of values.
    values: usize,
    image: Arc<ModelImage>,
}

/// # Creation
impl FlightRecorder {
    /// Creates a recorder for a simulation, with 16 MiB of memory. The humanoid of
    /// [`sample`](crate::sample::humanoid) fills them in about 80,000 steps if all its controls
    /// change in each.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] for a model with the option `sleep`, and the errors of
    /// [`Model::to_binary`].
    pub fn new(data: &Data) -> Result<Self> {
        let image = Arc::new(Self::image_of(data.model(), None)?);
        let values = inputs::count(data.model());
        Ok(Self {
            ring: Ring::new(Self::capacity(MEMORY, values)),
            segments: VecDeque::new(),
            complete: 0,
            before: Vec::new(),
            after: Vec::new(),
            image,
            revision: data.model().revision(),
            values,
            is_interrupted: true,
            previous: None,
            next: 0,
            memory: MEMORY,
            file: None,
            xml: String::new(),
            note: String::new(),
        })
    }

    /// Sets the size of the ring in bytes, and forgets the calls so far. The ring has at least the
    /// size of 32 states. Beside it, the recorder holds binary models: that of the present
    /// simulation, and earlier ones up to this size.
    #[must_use]
    pub fn with_memory(mut self, bytes: usize) -> Self {
        self.memory = bytes;
        self.clear();
        self
    }

    /// Sets the file that is written if a call returns an error or the thread panics. It replaces
    /// an earlier file. If it cannot be written, the error is logged.
    #[must_use]
    pub fn with_file(mut self, path: impl Into<PathBuf>) -> Self {
        self.file = Some(path.into());
        self
    }

    /// Sets a text that the file contains, such as the seeds of the program.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Sets the model as MJCF, for example [`Model::to_xml`]. Another version of the engine reads
    /// it instead of the binary form.
    #[must_use]
    pub fn with_xml(mut self, xml: impl Into<String>) -> Self {
        self.xml = xml.into();
        self
    }

    fn capacity(memory: usize, values: usize) -> usize {
        memory.max(4 * SEGMENTS as usize * Self::bound(values))
    }

    /// Returns a bound of the size of a call in bytes.
    fn bound(values: usize) -> usize {
        2 * change::bound(values, inputs::SHORT_PARTS) + MOST_TEXT + 64
    }

    fn image_of(model: &Model, base: Option<&Arc<[u8]>>) -> Result<ModelImage> {
        model.check_without_sleep("a flight recorder")?;
        Ok(ModelImage::new(model.to_binary()?, base))
    }

    /// Forgets all calls.
    fn clear(&mut self) {
        self.ring = Ring::new(Self::capacity(self.memory, self.values));
        self.segments.clear();
        self.complete = 0;
        self.is_interrupted = true;
    }
}

/// # Recorded calls
///
/// They return the errors of the methods of [`Data`], and in addition those of
/// [`new`](FlightRecorder::new) if the model has changed; the simulation is unchanged then.
impl FlightRecorder {
    /// Makes and records a [`Data::step`].
    ///
    /// # Errors
    ///
    /// As for [`Data::step`] and [`new`](Self::new).
    #[inline]
    pub fn step(&mut self, data: &mut Data) -> Result<()> {
        self.record(Call::Step, data)
    }

    /// Makes and records a [`Data::step1`].
    ///
    /// # Errors
    ///
    /// As for [`Data::step1`] and [`new`](Self::new).
    #[inline]
    pub fn step1(&mut self, data: &mut Data) -> Result<()> {
        self.record(Call::Step1, data)
    }

    /// Makes and records a [`Data::step2`]. The recorder must also have made the
    /// [`step1`](Self::step1) or [`forward`](Self::forward) before it.
    ///
    /// # Errors
    ///
    /// As for [`Data::step2`] and [`new`](Self::new).
    #[inline]
    pub fn step2(&mut self, data: &mut Data) -> Result<()> {
        self.record(Call::Step2, data)
    }

    /// Makes and records a [`Data::forward`].
    ///
    /// # Errors
    ///
    /// As for [`Data::forward`] and [`new`](Self::new).
    #[inline]
    pub fn forward(&mut self, data: &mut Data) -> Result<()> {
        self.record(Call::Forward, data)
    }

    fn record(&mut self, call: Call, data: &mut Data) -> Result<()> {
        data.check_usable()?;
        self.begin(call, data)?;
        let result = call.make(data);
        self.end(call, data, result.as_ref().err());
        result
    }

    /// Stores the inputs of a call.
    fn begin(&mut self, call: Call, data: &Data) -> Result<()> {
        if data.model().revision() != self.revision {
            self.change_model(data.model())?;
        }
        if self.ring.end() != self.complete {
            // The previous call has panicked.
            self.ring.rewind(self.complete);
            self.segments.retain(|segment| segment.start < self.complete);
            self.is_interrupted = true;
        }
        // Both halves of a step are in one segment.
        let is_second_half = call == Call::Step2 && self.previous.is_some_and(Call::is_first_half);
        let begins = self.is_interrupted || !(is_second_half || self.has_room());
        if begins {
            self.begin_segment();
        }
        let (ring, after) = (&mut self.ring, &mut self.after);
        ring.put(&[call.code()]);
        if begins {
            inputs::read(data, after);
            put_run(ring, 0, after);
        } else {
            inputs::parts(data, |place, values| {
                if !values.is_empty() {
                    put_changes(ring, place, values, &mut after[place..][..values.len()]);
                }
            });
        }
        ring.put(&change::END.to_le_bytes());
        self.before.clear();
        if data.has_callbacks() {
            self.before.extend_from_slice(after);
        }
        Ok(())
    }

    /// Returns `true` if two further calls fit into the present segment.
    #[inline]
    fn has_room(&self) -> bool {
        let length = |segment: &Segment| self.ring.end() - segment.start + 2 * Self::bound(self.values) as u64;
        self.segments.back().is_some_and(|present| length(present) <= self.ring.capacity() / SEGMENTS)
    }

    /// Begins a segment, for which it makes room.
    #[cold]
    fn begin_segment(&mut self) {
        let room = self.ring.capacity() / SEGMENTS;
        if !self.ring.has_room(room as usize) {
            self.ring.wrap();
        }
        let (start, image) = (self.ring.end(), self.image.clone());
        while self.segments.front().is_some_and(|oldest| start + room - oldest.start > self.ring.capacity()) {
            self.segments.pop_front();
        }
        self.segments.push_back(Segment { start, end: start, first: self.next, values: self.values, image });
        self.is_interrupted = false;
    }

    /// Stores the results of a call.
    fn end(&mut self, call: Call, data: &Data, error: Option<&Error>) {
        let has_closures = !self.before.is_empty();
        let checksum = inputs::read_results(data, has_closures, &mut self.after);
        let flags = if error.is_some() { FAILED } else { 0 } | if has_closures { CLOSURES } else { 0 };
        let ring = &mut self.ring;
        ring.put(&[flags]);
        // A closure may have exchanged the simulation for another one.
        if self.after.len() == self.before.len() {
            let user = data.model().state_range(StateSpec::INTEGRATION, StateSpec::USER);
            let (after, before) = (&self.after[user.clone()], &self.before[user.clone()]);
            change::runs(after, before, |start, values| put_run(ring, user.start + start, values));
        }
        ring.put(&change::END.to_le_bytes());
        ring.put(&checksum.to_le_bytes());
        if let Some(error) = error {
            let text = shortened(error.to_string());
            ring.put(&(text.len() as u64).to_le_bytes());
            ring.put(text.as_bytes());
        }
        self.complete = ring.end();
        self.segments.back_mut().expect("Bug: the call has a segment").end = self.complete;
        self.next += 1;
        self.previous = Some(call);
        self.is_interrupted |= error.is_some() || self.after.len() != self.values;
        if let Some(error) = error {
            self.write_after_failure(&error.to_string());
        }
    }

    /// Stores an edited or another model.
    #[cold]
    fn change_model(&mut self, model: &Model) -> Result<()> {
        self.image = Arc::new(Self::image_of(model, Some(&self.image.base))?);
        self.revision = model.revision();
        self.is_interrupted = true;
        self.values = inputs::count(model);
        if Self::capacity(self.memory, self.values) as u64 > self.ring.capacity() {
            self.clear();
        }
        while self.held_models() > self.memory && self.segments.pop_front().is_some() {}
        Ok(())
    }

    /// Returns the size of the models of the segments in bytes.
    fn held_models(&self) -> usize {
        let images = self.segments.iter().map(|segment| &segment.image);
        let mut previous: Option<&Arc<ModelImage>> = None;
        images.fold(0, |size, image| {
            let before = previous.replace(image);
            let is_new = !before.is_some_and(|before| Arc::ptr_eq(before, image));
            let has_base = before.is_some_and(|before| Arc::ptr_eq(&before.base, &image.base));
            size + if is_new { image.edit.len() } else { 0 } + if has_base { 0 } else { image.base.len() }
        })
    }
}

/// # Files
impl FlightRecorder {
    /// Writes the calls that the ring contains to a file.
    ///
    /// # Errors
    ///
    /// [`Error::File`]; an existing file is then unchanged.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        self.write_with(path.as_ref(), "on request")
    }

    /// Returns the calls that the ring contains.
    pub fn recording(&self) -> Recording {
        Recording::from_bytes(&self.to_bytes("on request")).expect("Bug: a recorder writes an invalid recording")
    }

    /// Returns the number of calls so far, also of those that are no longer in the ring.
    pub fn calls(&self) -> u64 {
        self.next
    }

    fn write_with(&self, path: &Path, reason: &str) -> Result<()> {
        let bytes = self.to_bytes(reason);
        file::replace(path, |out| out.write_all(&bytes))
    }

    /// Writes the file after an error or a panic.
    #[cold]
    fn write_after_failure(&self, reason: &str) {
        if let Some(path) = &self.file
            && let Err(error) = self.write_with(path, reason)
        {
            log::error!("the flight recorder cannot write its file: {error}");
        }
    }

    fn to_bytes(&self, reason: &str) -> Vec<u8> {
        let segments: Vec<&Segment> = self.segments.iter().filter(|segment| segment.start < self.complete).collect();
        let mut bases: Vec<&Arc<[u8]>> = Vec::new();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        Origin::here().put(&mut bytes);
        for text in [reason, &self.note, &self.xml] {
            bytes.put_block(text.as_bytes());
        }
        for segment in &segments {
            if !bases.iter().any(|base| Arc::ptr_eq(base, &segment.image.base)) {
                bases.push(&segment.image.base);
            }
        }
        bytes.extend((bases.len() as u32).to_le_bytes());
        for base in &bases {
            bytes.put_block(base);
        }
        bytes.extend((segments.len() as u32).to_le_bytes());
        for segment in &segments {
            let base = bases.iter().position(|base| Arc::ptr_eq(base, &segment.image.base));
            bytes.extend((base.expect("Bug: all bases are collected") as u32).to_le_bytes());
            bytes.put_block(&segment.image.edit);
            bytes.extend(segment.first.to_le_bytes());
            bytes.extend((segment.values as u32).to_le_bytes());
            bytes.put_block(self.ring.part(segment.start..segment.end));
        }
        bytes.extend(Checksum::of_bytes(&bytes).to_le_bytes());
        bytes
    }
}

impl Drop for FlightRecorder {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.write_after_failure("the thread panicked");
        }
    }
}

impl fmt::Debug for FlightRecorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.segments.front().map_or(self.next, |oldest| oldest.first);
        write!(f, "FlightRecorder: calls {first} to {} in {} bytes", self.next, self.ring.capacity())
    }
}

/// Stores the runs of values that differ from those after the previous call, which it replaces.
#[inline(never)]
fn put_changes(ring: &mut Ring, place: usize, values: &[f64], after: &mut [f64]) {
    if !change::is_same(values, after) {
        change::runs(values, after, |start, values| put_run(ring, place + start, values));
        after.copy_from_slice(values);
    }
}

#[inline]
fn put_run(ring: &mut Ring, start: usize, values: &[f64]) {
    ring.put(&(start as u32).to_le_bytes());
    ring.put(&(values.len() as u32).to_le_bytes());
    ring.put_numbers(values);
}

/// Shortens the text of an error to the bytes for which there is room.
pub(super) fn shortened(mut text: String) -> String {
    let end = (0..=MOST_TEXT.min(text.len())).rev().find(|&end| text.is_char_boundary(end));
    text.truncate(end.unwrap_or(0));
    text
}
