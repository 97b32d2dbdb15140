//! Recordings: calls with their inputs, read from a file.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::change::{self, Checksum};
use super::format::{Invalid, Reader};
use super::inputs::Call;
use super::model_image::ModelImage;
use super::origin::Origin;
use crate::error::{Error, Result};
use crate::file;

/// Begin of a file.
pub(super) const MAGIC: &[u8; 8] = b"MJFLIGHT";
/// Version of the format.
pub(super) const VERSION: u32 = 2;
/// Flag of a call: it returned an error, whose text follows.
pub(super) const FAILED: u8 = 1;
/// Flag of a call: the simulation had callbacks.
pub(super) const CLOSURES: u8 = 2;

/// Calls of a simulation with everything that entered them, from a
/// [`FlightRecorder`](super::FlightRecorder). See the [module](crate::flight).
///
/// Calls have numbers, counted from the creation of the recorder. A recording begins at the oldest
/// call that was still in the ring.
pub struct Recording {
    pub(super) origin: Origin,
    reason: String,
    note: String,
    pub(super) xml: String,
    pub(super) segments: Vec<Segment>,
    calls: Range<u64>,
    pub(super) source_name: String,
}

/// Calls that begin with all values.
pub(super) struct Segment {
    pub(super) image: ModelImage,
    /// Number of the first call.
    pub(super) first: u64,
    /// Number of values.
    pub(super) values: usize,
    pub(super) calls: Vec<u8>,
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
        Self::parse(&bytes, &path.display().to_string())
    }

    /// Reads the contents of a file.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidRecording`] as for [`read`](Self::read).
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        Self::parse(bytes, "the given buffer")
    }

    /// Returns the program and the machine that made the recording.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Returns the reason why the file was written: the error, a panic, or a request.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// Returns the [note](super::FlightRecorder::with_note) of the program.
    pub fn note(&self) -> &str {
        &self.note
    }

    /// Returns the model as [MJCF](super::FlightRecorder::with_xml), if the program has set it.
    pub fn xml(&self) -> Option<&str> {
        (!self.xml.is_empty()).then_some(&self.xml)
    }

    /// Returns the numbers of the recorded calls.
    pub fn calls(&self) -> Range<u64> {
        self.calls.clone()
    }

    fn parse(bytes: &[u8], source_name: &str) -> Result<Self> {
        let parsed = Self::try_parse(bytes).map_err(|invalid| invalid.of(source_name))?;
        Ok(Self { source_name: source_name.to_owned(), ..parsed })
    }

    fn try_parse(bytes: &[u8]) -> Result<Self, Invalid> {
        let mut reader = Reader::new(bytes);
        if reader.take(MAGIC.len(), "the header")? != MAGIC {
            return Err(reader.invalid("it does not begin with MJFLIGHT"));
        }
        let version = reader.u32()?;
        if version != VERSION {
            return Err(reader.invalid(format!("format {version}, but this version of the crate reads {VERSION}")));
        }
        // The checksum finds accidental damage. Every value is checked besides.
        let Some((content, checksum)) = bytes.split_last_chunk::<8>() else {
            return Err(reader.invalid("the checksum is missing"));
        };
        if u64::from_le_bytes(*checksum) != Checksum::of_bytes(content) {
            return Err(Invalid { reason: "the checksum at its end is wrong: it is incomplete or damaged".to_owned() });
        }
        Self::parse_content(&mut Reader::new(content))
    }

    fn parse_content(reader: &mut Reader<'_>) -> Result<Self, Invalid> {
        reader.take(MAGIC.len() + size_of_val(&VERSION), "the header")?;
        let origin = Origin::read(reader)?;
        let mut text = |what| reader.text(what).map(str::to_owned);
        let (reason, note, xml) = (text("the reason")?, text("the note")?, text("the MJCF")?);
        let mut bases: Vec<Arc<[u8]>> = Vec::new();
        for _ in 0..reader.u32()? {
            bases.push(reader.block("a model")?.into());
        }
        let (mut segments, mut calls) = (Vec::new(), None::<Range<u64>>);
        for _ in 0..reader.u32()? {
            let base = reader.u32()?;
            let Some(base) = bases.get(base as usize) else {
                return Err(reader.invalid(format!("model {base} of {}", bases.len())));
            };
            let image = ModelImage { base: base.clone(), edit: reader.block("an edit of a model")?.to_vec() };
            let (first, values) = (reader.u64()?, reader.u32()? as usize);
            let mut end = calls.as_ref().map_or(first, |calls| calls.end);
            if first != end {
                return Err(reader.invalid(format!("a segment begins with call {first} instead of {end}")));
            }
            let content = reader.block("the calls of a segment")?;
            let mut entries = Reader::new(content);
            while !entries.is_at_end() {
                let entry = Entry::read(&mut entries, values);
                let entry = entry.map_err(|invalid| Invalid { reason: format!("call {end}: {}", invalid.reason) })?;
                if end == first && !entry.sets_all(values) {
                    return Err(Invalid { reason: format!("call {end} begins a segment without all values") });
                }
                end = end.checked_add(1).ok_or_else(|| reader.invalid("too many calls"))?;
            }
            calls = Some(calls.map_or(first, |calls| calls.start)..end);
            segments.push(Segment { image, first, values, calls: content.to_vec() });
        }
        if !reader.is_at_end() {
            return Err(reader.invalid("more bytes than its parts have"));
        }
        let source_name = String::new();
        Ok(Self { origin, reason, note, xml, segments, calls: calls.unwrap_or(0..0), source_name })
    }
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { calls, reason, .. } = self;
        write!(f, "Recording: calls {} to {}, written: {reason}", calls.start, calls.end)
    }
}

/// Run of values: its start, and its words.
pub(super) type Run<'b> = (usize, &'b [[u8; 8]]);

/// Recorded call.
pub(super) struct Entry<'b> {
    pub(super) call: Call,
    /// Values that differ from those after the previous call.
    pub(super) before: Vec<Run<'b>>,
    /// Values that closures have changed during the call.
    pub(super) by_closures: Vec<Run<'b>>,
    pub(super) has_closures: bool,
    pub(super) checksum: u64,
    pub(super) error: Option<&'b str>,
}

impl<'b> Entry<'b> {
    pub(super) fn read(reader: &mut Reader<'b>, values: usize) -> Result<Self, Invalid> {
        let code = reader.u8()?;
        let call = Call::of_code(code).ok_or_else(|| reader.invalid(format!("there is no kind of call {code}")))?;
        let before = Self::read_runs(reader, values)?;
        let flags = reader.u8()?;
        if flags & !(FAILED | CLOSURES) != 0 {
            return Err(reader.invalid(format!("unknown flags {flags}")));
        }
        let by_closures = Self::read_runs(reader, values)?;
        let checksum = reader.u64()?;
        let error = if flags & FAILED != 0 { Some(reader.text("the text of an error")?) } else { None };
        Ok(Self { call, before, by_closures, has_closures: flags & CLOSURES != 0, checksum, error })
    }

    fn read_runs(reader: &mut Reader<'b>, values: usize) -> Result<Vec<Run<'b>>, Invalid> {
        let mut runs = Vec::new();
        loop {
            let start = reader.u32()?;
            if start == change::END {
                return Ok(runs);
            }
            let (start, count) = (start as usize, reader.u32()? as usize);
            if start.checked_add(count).is_none_or(|end| end > values) {
                return Err(reader.invalid(format!("{count} values from {start} of {values}")));
            }
            let (words, _) = reader.take(8 * count, "a run of values")?.as_chunks();
            runs.push((start, words));
        }
    }

    /// Returns `true` if the call sets all values.
    fn sets_all(&self, values: usize) -> bool {
        matches!(self.before[..], [(0, words)] if words.len() == values)
    }
}
