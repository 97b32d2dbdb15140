//! The recorder, which makes the calls and keeps the last ones.

use std::collections::{HashMap, VecDeque};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::inputs::{self, Call};
use super::model_image::ModelImage;
use super::origin::Origin;
use super::recording::{Contents, Entry, MAGIC, Recording, Segment};
use super::{change, parts, recording};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::file;
use crate::model::Model;

/// Default of [`FlightRecorder::with_memory`].
const MEMORY: usize = 16 << 20;
/// Number of segments that the memory has at least.
const SEGMENTS: usize = 8;

/// Reason why there is a last segment.
const PRESENT: &str = "Bug: the call has a segment";

/// Recorder of everything that enters a simulation, in bounded memory: call its
/// [`step`](Self::step) instead of [`Data::step`]. See the [module](crate::flight).
///
/// It holds no simulation: the program changes the simulation freely between the calls. A recorder
/// can follow several simulations in turn; a file for each is easier to read.
///
/// If the thread panics while the recorder exists, its destructor writes the
/// [file](Self::with_file). A program with `panic = "abort"` gets no file.
pub struct FlightRecorder {
    /// The segments with their models, which a file shares.
    segments: VecDeque<(Segment, Arc<ModelImage>)>,
    /// Number of words of the complete calls of the last segment.
    complete: usize,
    /// Number of words that the segments may have together.
    capacity: usize,
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
        let mut recorder = Self {
            segments: VecDeque::new(),
            complete: 0,
            capacity: 0,
            before: Vec::new(),
            after: Vec::new(),
            image,
            revision: data.model().revision(),
            values: inputs::count(data.model()),
            is_interrupted: true,
            previous: None,
            next: 0,
            memory: MEMORY,
            file: None,
            xml: String::new(),
            note: String::new(),
        };
        recorder.clear();
        Ok(recorder)
    }

    /// Sets the memory for calls in bytes, and forgets the calls so far. It is at least that of 128
    /// states. Beside it, the recorder holds binary models: that of the present simulation, and
    /// earlier ones up to this size.
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

    /// Returns the number of words of the segments.
    fn needed_capacity(&self) -> usize {
        (self.memory / size_of::<f64>()).max(4 * SEGMENTS * self.bound())
    }

    /// Returns a bound of the number of words of a call.
    #[inline]
    fn bound(&self) -> usize {
        2 * change::bound(self.values) + 2
    }

    fn image_of(model: &Model, base: Option<&Arc<[f64]>>) -> Result<ModelImage> {
        model.check_without_sleep("a flight recorder")?;
        Ok(ModelImage::new(&model.to_binary()?, base))
    }

    /// Forgets all calls. The memory belongs to empty segments until calls need it.
    fn clear(&mut self) {
        self.capacity = self.needed_capacity();
        // Memory of zeros would be mapped in the steps that write to it first.
        let memory = vec![1.0; self.capacity / SEGMENTS];
        let empty = || {
            let mut calls = memory.clone();
            calls.clear();
            (Segment { calls, ..Segment::default() }, self.image.clone())
        };
        self.segments = (0..SEGMENTS).map(|_| empty()).collect();
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
        if let Some((present, _)) = self.segments.back_mut()
            && present.calls.len() > self.complete
        {
            // The previous call has panicked.
            present.calls.truncate(self.complete);
            self.is_interrupted = true;
        }
        // Both halves of a step are in one segment.
        let is_second_half = call == Call::Step2 && self.previous.is_some_and(Call::is_first_half);
        let begins = self.is_interrupted || !(is_second_half || self.has_room());
        if begins {
            self.begin_segment();
        }
        let (Segment { calls, .. }, _) = self.segments.back_mut().expect(PRESENT);
        calls.push(Entry::kind(call, data.has_callbacks()));
        let after = &mut self.after;
        if begins {
            inputs::read(data, after);
            change::put_run(calls, 0, after);
        } else {
            inputs::parts(data, |place, values| {
                if !values.is_empty() {
                    put_changes(calls, place, values, &mut after[place..][..values.len()]);
                }
            });
        }
        calls.push(change::END);
        self.before.clear();
        if data.has_callbacks() {
            self.before.extend_from_slice(after);
        }
        Ok(())
    }

    /// Returns `true` if two further calls fit into the present segment.
    #[inline]
    fn has_room(&self) -> bool {
        self.complete + 2 * self.bound() <= self.capacity / SEGMENTS
    }

    /// Begins a segment in the memory of the oldest ones.
    #[cold]
    fn begin_segment(&mut self) {
        // An interrupted segment keeps no more memory than its calls need.
        if let Some((present, _)) = self.segments.back_mut()
            && self.complete > 0
            && self.is_interrupted
        {
            present.calls.shrink_to_fit();
        }
        let (room, mut calls) = (self.capacity / SEGMENTS, Vec::new());
        let mut used: usize = self.segments.iter().map(|(segment, _)| segment.calls.capacity()).sum();
        while used + room > self.capacity
            && let Some((oldest, _)) = self.segments.pop_front()
        {
            used -= oldest.calls.capacity();
            calls = oldest.calls;
        }
        calls.clear();
        calls.reserve_exact(room);
        let segment = Segment { calls, first: self.next, values: self.values, ..Segment::default() };
        self.segments.push_back((segment, self.image.clone()));
        self.complete = 0;
        self.is_interrupted = false;
    }

    /// Stores the results of a call.
    fn end(&mut self, call: Call, data: &Data, error: Option<&Error>) {
        let has_closures = !self.before.is_empty();
        let checksum = inputs::read_results(data, has_closures, &mut self.after);
        let (segment, _) = self.segments.back_mut().expect(PRESENT);
        if has_closures {
            // A closure may have exchanged the simulation for another one.
            if self.after.len() == self.before.len() {
                let user = data.model().state_range(StateSpec::INTEGRATION, StateSpec::USER);
                let (after, before) = (&self.after[user.clone()], &self.before[user.clone()]);
                change::runs(after, before, |start, values| {
                    change::put_run(&mut segment.calls, user.start + start, values);
                });
            }
            segment.calls.push(change::END);
        }
        segment.calls.push(f64::from_bits(checksum));
        self.complete = segment.calls.len();
        segment.error = error.map(recording::shortened);
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
        if self.needed_capacity() > self.capacity {
            self.clear();
        }
        while self.held_models() > self.memory && self.segments.pop_front().is_some() {}
        Ok(())
    }

    /// Returns the size of the models of the segments in bytes.
    fn held_models(&self) -> usize {
        let images = self.segments.iter().map(|(_, image)| &**image);
        let parts = images.flat_map(|image| [&image.base[..], &image.edit]);
        let different: HashMap<_, _> = parts.map(|words| (words.as_ptr(), size_of_val(words))).collect();
        different.values().sum()
    }
}

/// # Files
impl FlightRecorder {
    /// Writes the calls that the recorder has to a file.
    ///
    /// # Errors
    ///
    /// [`Error::File`]; an existing file is then unchanged.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        self.write_with(path.as_ref(), "on request")
    }

    /// Returns the calls that the recorder has.
    pub fn recording(&self) -> Recording {
        Recording::new(self.contents("on request"), "the recorder".to_owned())
            .expect("Bug: a recorder has an invalid recording")
    }

    /// Returns the number of calls so far, also of those that it no longer has.
    pub fn calls(&self) -> u64 {
        self.next
    }

    fn write_with(&self, path: &Path, reason: &str) -> Result<()> {
        let contents = self.contents(reason);
        file::replace(path, |out| {
            parts::put_begin(out, MAGIC)?;
            parts::put(out, &contents)
        })
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

    fn contents(&self, reason: &str) -> Contents {
        let mut bases: Vec<&Arc<[f64]>> = Vec::new();
        let mut segments = Vec::new();
        for (segment, image) in &self.segments {
            let known = bases.iter().position(|base| Arc::ptr_eq(base, &image.base));
            let model = known.unwrap_or_else(|| {
                bases.push(&image.base);
                bases.len() - 1
            });
            segments.push(Segment { model, edit: image.edit.clone(), length: image.length, ..segment.clone() });
        }
        if let Some(present) = segments.last_mut() {
            present.calls.truncate(self.complete);
        }
        segments.retain(|segment| !segment.calls.is_empty());
        Contents {
            origin: Origin::here(),
            reason: reason.to_owned(),
            note: self.note.clone(),
            xml: self.xml.clone(),
            models: bases.into_iter().map(|base| base.to_vec()).collect(),
            segments,
        }
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
        write!(f, "FlightRecorder after {} calls", self.next)
    }
}

/// Stores the runs of values that differ from those after the previous call, which it replaces.
#[inline(never)]
fn put_changes(calls: &mut Vec<f64>, place: usize, values: &[f64], after: &mut [f64]) {
    if !change::is_same(values, after) {
        change::runs(values, after, |start, values| change::put_run(calls, place + start, values));
        after.copy_from_slice(values);
    }
}
