//! Recordings: calls with their inputs, read from a file.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::change::{self, Run};
use super::inputs::Call;
use super::origin::Origin;
use super::parts;
use crate::error::{Error, Result};
use crate::file;

/// Begin of a file.
pub(super) const MAGIC: [u8; 8] = *b"MJFLIGHT";

/// Calls of a simulation with everything that entered them, from a
/// [`FlightRecorder`](super::FlightRecorder). See the [module](crate::flight).
///
/// Calls have numbers, counted from the creation of the recorder. A recording begins at the oldest
/// call that the recorder still had.
pub struct Recording {
    pub(super) contents: Contents,
    calls: Range<u64>,
    pub(super) source_name: String,
}

/// Contents of a file.
#[derive(Serialize, Deserialize)]
pub(super) struct Contents {
    pub(super) origin: Origin,
    pub(super) reason: String,
    pub(super) note: String,
    pub(super) xml: String,
    /// Binary models as words.
    pub(super) models: Vec<Vec<f64>>,
    pub(super) segments: Vec<Segment>,
}

/// Calls that begin with all values.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Segment {
    /// Index of the model, and the words that an edit has changed.
    pub(super) model: usize,
    pub(super) edit: Vec<f64>,
    /// Number of bytes of the model.
    pub(super) length: usize,
    /// Number of the first call.
    pub(super) first: u64,
    /// Number of values.
    pub(super) values: usize,
    /// The calls, each an [`Entry`].
    pub(super) calls: Vec<f64>,
    /// Text of the error of the last call.
    pub(super) error: Option<String>,
}

/// Returns the text of an error, or its start if it is long.
pub(super) fn shortened(error: &Error) -> String {
    error.to_string().chars().take(1000).collect()
}

impl Segment {
    pub(super) fn has_same_model(&self, other: &Self) -> bool {
        let has_same_length = self.length == other.length && self.edit.len() == other.edit.len();
        self.model == other.model && has_same_length && change::is_same(&self.edit, &other.edit)
    }
}

/// # Files and contents
impl Recording {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if it cannot be read or is larger than 2 GiB, [`Error::InvalidRecording`] if
    /// it is damaged or has another version of the format.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = file::read_regular(path).map_err(Error::file(path))?;
        Self::parse(&bytes, path.display().to_string())
    }

    /// Reads the contents of a file.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidRecording`] as for [`read`](Self::read).
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        Self::parse(bytes, "the given buffer".to_owned())
    }

    /// Returns the program and the machine that made the recording.
    pub fn origin(&self) -> &Origin {
        &self.contents.origin
    }

    /// Returns the reason why the file was written: the error, a panic, or a request.
    pub fn reason(&self) -> &str {
        &self.contents.reason
    }

    /// Returns the [note](super::FlightRecorder::with_note) of the program.
    pub fn note(&self) -> &str {
        &self.contents.note
    }

    /// Returns the model as [MJCF](super::FlightRecorder::with_xml), if the program has set it.
    pub fn xml(&self) -> Option<&str> {
        Some(&*self.contents.xml).filter(|xml| !xml.is_empty())
    }

    /// Returns the numbers of the recorded calls.
    pub fn calls(&self) -> Range<u64> {
        self.calls.clone()
    }

    fn parse(mut bytes: &[u8], source_name: String) -> Result<Self> {
        parts::read_begin(&mut bytes, MAGIC, &source_name)?;
        let contents = parts::read(&mut bytes, &source_name)?;
        if !bytes.is_empty() {
            return Err(parts::invalid(&source_name, format!("{} bytes follow its end", bytes.len())));
        }
        Self::new(contents, source_name)
    }

    /// Checks the contents.
    pub(super) fn new(contents: Contents, source_name: String) -> Result<Self> {
        let mut calls = contents.segments.first().map_or(0..0, |segment| segment.first..segment.first);
        for segment in &contents.segments {
            if segment.first != calls.end {
                let reason = format!("a segment begins with call {} instead of {}", segment.first, calls.end);
                return Err(parts::invalid(&source_name, reason));
            }
            let mut words = &segment.calls[..];
            while !words.is_empty() {
                let entry = Entry::read(&mut words, segment.values);
                let is_whole = |entry: &Entry<'_>| matches!(&entry.before[..], [run] if run.is_whole(segment.values));
                let entry = entry.filter(|entry| calls.end > segment.first || is_whole(entry));
                let next = entry.and_then(|_| calls.end.checked_add(1));
                calls.end =
                    next.ok_or_else(|| parts::invalid(&source_name, format!("call {} is damaged", calls.end)))?;
            }
        }
        Ok(Self { contents, calls, source_name })
    }
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Range { start, end } = self.calls;
        write!(f, "Recording: calls {start} to {end}, written: {}", self.reason())
    }
}

/// Recorded call: its kind, the changes before it, the changes that closures made, and the checksum
/// of its results.
pub(super) struct Entry<'w> {
    pub(super) call: Call,
    /// Values that differ from those after the previous call.
    pub(super) before: Vec<Run<'w>>,
    /// Values that closures have changed during the call. `None` if the simulation had none.
    pub(super) by_closures: Option<Vec<Run<'w>>>,
    pub(super) checksum: u64,
}

impl<'w> Entry<'w> {
    /// Returns the first word of a call, its kind.
    pub(super) fn kind(call: Call, has_closures: bool) -> f64 {
        f64::from_bits(2 * call as u64 + u64::from(has_closures))
    }

    /// Reads words of unknown origin. Returns `None` if they are no call.
    pub(super) fn read(words: &mut &'w [f64], values: usize) -> Option<Self> {
        let kind = words.split_off_first()?.to_bits();
        let call = *Call::ALL.get(usize::try_from(kind / 2).ok()?)?;
        let before = change::take_runs(words, values)?;
        let by_closures = if kind % 2 == 1 { Some(change::take_runs(words, values)?) } else { None };
        Some(Self { call, before, by_closures, checksum: words.split_off_first()?.to_bits() })
    }
}
