//! Traces: the inputs of calls and the quantities that one engine computes from them, as a stream
//! of records that another engine reads.
//!
//! A record is its kind (`u8`), a block of contents and their checksum (`u64`). The first is the
//! origin of the trace, and the last has the number of calls, so a missing end is detected. A model
//! precedes the calls that use it.

use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;

use super::change::Checksum;
use super::format::{Block, Invalid, Reader};
use super::inputs::{self, Call};
use super::origin::Origin;
use super::quantities::{self, Series};
use super::recording::Recording;
use super::repeat::Player;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::field_docs::FieldDoc;
use crate::model::Model;
use crate::model::save::{Arrays, settings, sizes};

const MAGIC: &[u8] = b"MJTRACE1";
/// Largest size of a record in bytes.
const MOST_BYTES: u64 = 1 << 31;
/// Begin of the names of quantities of a solver that converges further.
pub(super) const CONVERGED: &str = "converged ";
/// Name of the trace in errors.
const NAME: &str = "the trace";

const ORIGIN: u8 = b'O';
const MODEL: u8 = b'M';
const CALL: u8 = b'C';
const END: u8 = b'E';

/// Writes a trace of a simulation: for each step its inputs, and the quantities of each stage. A
/// [`Comparison`](super::Comparison) in a program with another engine, or another build of it,
/// reads the trace. A step takes several times as long as [`Data::step`].
///
/// [`Recording::trace`] writes the trace of recorded calls.
///
/// ```
/// use mujoco_safe::flight::{Comparison, Tracer};
/// use mujoco_safe::{Data, Model, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut tracer = Tracer::new(Vec::new(), None)?;
/// for step in 0..10 {
///     data.ctrl_mut()[0] = f64::from(step);
///     tracer.step(&mut data)?;
/// }
/// let trace = tracer.finish()?;
///
/// // In another program.
/// let comparison = Comparison::new(&trace[..], Some(&sample::cartpole()))?;
/// assert!(comparison.divergences.is_empty(), "{comparison}");
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct Tracer<W: Write> {
    out: W,
    /// Simulation that computes the quantities, one whose solver converges further, and the
    /// revision of their model.
    probe: Option<([Data; 2], u64)>,
    calls: u64,
}

impl<W: Write> Tracer<W> {
    /// Begins a trace. The other program can load the model from `xml`, a complete MJCF text
    /// without files.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if `out` cannot be written.
    pub fn new(mut out: W, xml: Option<&str>) -> Result<Self> {
        out.write_all(MAGIC).map_err(Error::file(NAME))?;
        let mut contents = Vec::new();
        Origin::here().put(&mut contents);
        contents.put_block(xml.unwrap_or_default().as_bytes());
        contents.put_block(fields().collect::<Vec<_>>().join(" ").as_bytes());
        let mut tracer = Self { out, probe: None, calls: 0 };
        tracer.put(ORIGIN, &contents)?;
        Ok(tracer)
    }

    /// Writes the quantities of a step, and makes it.
    ///
    /// # Errors
    ///
    /// As for [`Data::step`], which the trace contains; [`Error::File`], and [`Error::Unsupported`]
    /// for a simulation with [callbacks](Data::set_callbacks), which another program does not have.
    pub fn step(&mut self, data: &mut Data) -> Result<()> {
        data.check_usable()?;
        if data.has_callbacks() {
            return Err(Error::Unsupported("a trace of a simulation with callbacks".to_owned()));
        }
        self.put_call(Call::Step, data)?;
        data.step()
    }

    /// Ends the trace, and returns the target.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if `out` cannot be written.
    pub fn finish(mut self) -> Result<W> {
        self.put(END, &self.calls.to_le_bytes())?;
        self.out.flush().map_err(Error::file(NAME))?;
        Ok(self.out)
    }

    /// Writes the quantities of a call from the present inputs.
    fn put_call(&mut self, call: Call, data: &Data) -> Result<()> {
        let revision = data.model().revision();
        if self.probe.as_ref().is_none_or(|(_, known)| *known != revision) {
            self.put_model(data.model())?;
            self.probe = Some(([Data::new(data.model().clone())?, converging(data.model())?], revision));
        }
        let ([probe, converging], _) = self.probe.as_mut().expect("Bug: there is a simulation");
        let mut values = Vec::new();
        inputs::read(data, &mut values);
        let mut contents = vec![call.code()];
        let names = quantities::inputs(data.model());
        contents.extend((names.len() as u32).to_le_bytes());
        let mut rest = &values[..];
        for (name, length) in names {
            let (part, after) = rest.split_at(length);
            put_values(&mut contents, &name, 1, part);
            rest = after;
        }
        let mut results = evaluate(probe, call, &values);
        let after_solver = quantities::all().filter(|quantity| quantities::AFTER_SOLVER.contains(&quantity.stage));
        let after_solver: Vec<&str> = after_solver.map(|quantity| quantity.name).collect();
        let converged = evaluate(converging, call, &values).values.into_iter();
        let converged = converged.filter(|series| after_solver.contains(&&*series.name));
        let renamed = |series: Series| Series { name: format!("{CONVERGED}{}", series.name), ..series };
        results.values.extend(converged.map(renamed));
        contents.extend((results.values.len() as u32).to_le_bytes());
        results.values.iter().for_each(|of| put_values(&mut contents, &of.name, of.columns, &of.values));
        contents.put_block(results.error.unwrap_or_default().as_bytes());
        self.calls += 1;
        self.put(CALL, &contents)
    }

    fn put_model(&mut self, model: &Model) -> Result<()> {
        let mut contents = Vec::new();
        let sizes = sizes(model).map(|(name, size)| (name, vec![size as f64]));
        let settings: Vec<_> = sizes.chain(settings(model)).collect();
        contents.extend((settings.len() as u32).to_le_bytes());
        for (name, values) in settings {
            put_values(&mut contents, name, 1, &values);
        }
        let arrays = Arrays::of(model)?;
        let fields: Vec<_> = Model::fields().filter(|field| field.is_array).collect();
        contents.extend((fields.len() as u32).to_le_bytes());
        for field in fields {
            contents.put_block(field.name.as_bytes());
            contents.put_block(field.ctype.as_bytes());
            contents.put_block(arrays.bytes(field.name));
        }
        // Another build of this engine loads it.
        let binary = if cfg!(validates_binaries) { model.to_binary()? } else { Vec::new() };
        contents.put_block(&binary);
        self.put(MODEL, &contents)
    }

    fn put(&mut self, kind: u8, contents: &[u8]) -> Result<()> {
        let mut begin = vec![kind];
        begin.extend((contents.len() as u64).to_le_bytes());
        let checksum = Checksum::of_bytes(contents).to_le_bytes();
        [&begin[..], contents, &checksum]
            .iter()
            .try_for_each(|part| self.out.write_all(part))
            .map_err(Error::file(NAME))
    }
}

impl Recording {
    /// Repeats all calls, and writes a trace of them. See [`Tracer`].
    ///
    /// ```no_run
    /// use mujoco_safe::flight::Recording;
    ///
    /// let recording = Recording::read("failure.flight")?;
    /// recording.trace(std::fs::File::create("failure.trace").unwrap())?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`first`](Self::first), and [`Error::File`] if `out` cannot be written.
    pub fn trace<W: Write>(&self, out: W) -> Result<W> {
        let mut tracer = Tracer::new(out, self.xml())?;
        let mut player = Player::new(self, 0, |_: &mut Data| ());
        loop {
            let mut result = Ok(());
            let more = player.play_as_recorded(|call, data| result = tracer.put_call(call, data))?;
            result?;
            if !more {
                return tracer.finish();
            }
        }
    }
}

/// Returns the names of the fields of the engine's structs.
pub(super) fn fields() -> impl Iterator<Item = String> {
    let names = |structure| FieldDoc::all(structure).map(move |field| format!("mj{structure}.{}", field.name));
    ["Data", "Model", "Option"].into_iter().flat_map(names)
}

fn put_values(contents: &mut Vec<u8>, name: &str, columns: usize, values: &[f64]) {
    contents.put_block(name.as_bytes());
    contents.extend((columns as u32).to_le_bytes());
    contents.extend((8 * values.len() as u64).to_le_bytes());
    contents.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// Results of a call.
pub(super) struct Results {
    pub(super) values: Vec<Series>,
    /// Text of the error.
    pub(super) error: Option<String>,
}

/// Computes the quantities of a call with these inputs.
pub(super) fn evaluate(data: &mut Data, call: Call, inputs: &[f64]) -> Results {
    let mut values = Vec::new();
    let mut compute = || {
        data.reset()?;
        inputs::write(data, inputs)?;
        data.forward()?;
        quantities::read(quantities::QUANTITIES, data, &mut values);
        if matches!(call, Call::Step | Call::Step2) {
            inputs::write(data, inputs)?;
            data.step()?;
            quantities::read(quantities::NEXT_STATE, data, &mut values);
        }
        Ok(())
    };
    let error = compute().err().map(|error: Error| error.to_string());
    Results { values, error }
}

/// Returns a simulation of a model whose solver converges further.
pub(super) fn converging(model: &Arc<Model>) -> Result<Data> {
    let mut data = Data::new(model.clone())?;
    data.edit_model(|model| {
        model.edit_options(|options| {
            options.tolerance = 0.0;
            options.iterations = options.iterations.clamp(20, 100_000) * 10;
        })
    })?;
    Ok(data)
}

/// Model of a trace.
pub(super) struct TracedModel {
    /// Sizes, options and other values that are not in arrays.
    pub(super) settings: Vec<Series>,
    /// Name, C type and values of the arrays.
    pub(super) arrays: Vec<(String, String, Vec<u8>)>,
    pub(super) binary: Vec<u8>,
}

/// Call of a trace.
pub(super) struct TracedCall {
    pub(super) call: Call,
    pub(super) inputs: Vec<Series>,
    pub(super) results: Results,
}

/// Part of a trace after its begin.
pub(super) enum Record {
    Model(TracedModel),
    Call(TracedCall),
    End,
}

/// Reader of a trace, which is not trusted.
pub(super) struct Trace<R> {
    source: R,
    pub(super) origin: Origin,
    pub(super) xml: String,
    /// Names of the fields of the engine.
    pub(super) fields: Vec<String>,
    calls: u64,
}

impl<R: Read> Trace<R> {
    pub(super) fn open(mut source: R) -> Result<Self> {
        let mut magic = [0; MAGIC.len()];
        let begins = source.read_exact(&mut magic).is_ok() && magic == MAGIC;
        if !begins {
            return Err(Invalid { reason: "it does not begin with MJTRACE1".to_owned() }.of(NAME));
        }
        let mut trace = Self { source, origin: Origin::here(), xml: String::new(), fields: Vec::new(), calls: 0 };
        let (kind, contents) = trace.record()?;
        if kind != ORIGIN {
            return Err(Invalid { reason: "its first record is not its origin".to_owned() }.of(NAME));
        }
        trace.parse_origin(&mut Reader::new(&contents)).map_err(|invalid| invalid.of(NAME))?;
        Ok(trace)
    }

    fn parse_origin(&mut self, reader: &mut Reader<'_>) -> Result<(), Invalid> {
        self.origin = Origin::read(reader)?;
        reader.text("the MJCF")?.clone_into(&mut self.xml);
        self.fields = reader.text("the fields")?.split(' ').map(str::to_owned).collect();
        Ok(())
    }

    /// Returns the next part.
    pub(super) fn next(&mut self) -> Result<Record> {
        let (kind, contents) = self.record()?;
        let mut reader = Reader::new(&contents);
        let parsed = match kind {
            MODEL => parse_model(&mut reader).map(Record::Model),
            CALL => parse_call(&mut reader).map(Record::Call),
            END => reader.u64().and_then(|calls| {
                let is_complete = calls == self.calls;
                let reason = || reader.invalid(format!("{} calls instead of {calls}", self.calls));
                if is_complete { Ok(Record::End) } else { Err(reason()) }
            }),
            kind => Err(reader.invalid(format!("there is no kind of record {kind}"))),
        };
        let part = parsed.map_err(|Invalid { reason }| self.invalid(&reason))?;
        if !reader.is_at_end() {
            return Err(self.invalid("a record is longer than its parts"));
        }
        self.calls += u64::from(kind == CALL);
        Ok(part)
    }

    fn invalid(&self, reason: &str) -> Error {
        Invalid { reason: format!("{reason}, after {} calls", self.calls) }.of(NAME)
    }

    /// Reads a record. Memory grows with the bytes that the source has.
    fn record(&mut self) -> Result<(u8, Vec<u8>)> {
        let mut begin = [0; 9];
        self.read_exact(&mut begin)?;
        let (kind, length) = (begin[0], u64::from_le_bytes(begin[1..].try_into().expect("Bug: eight bytes")));
        if length > MOST_BYTES {
            return Err(self.invalid(&format!("a record of {length} bytes, more than {MOST_BYTES}")));
        }
        let mut contents = Vec::new();
        self.source.by_ref().take(length).read_to_end(&mut contents).map_err(Error::file(NAME))?;
        if (contents.len() as u64) < length {
            return Err(self.incomplete());
        }
        let mut checksum = [0; 8];
        self.read_exact(&mut checksum)?;
        if u64::from_le_bytes(checksum) != Checksum::of_bytes(&contents) {
            return Err(self.invalid("the checksum of a record is wrong: it is damaged"));
        }
        Ok((kind, contents))
    }

    fn read_exact(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.source.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => self.incomplete(),
            _ => Error::file(NAME)(error),
        })
    }

    fn incomplete(&self) -> Error {
        self.invalid("it is incomplete")
    }
}

fn parse_model(reader: &mut Reader<'_>) -> Result<TracedModel, Invalid> {
    let settings = parse_values(reader)?;
    let mut arrays = Vec::new();
    for _ in 0..reader.u32()? {
        let (name, ctype) = (reader.text("the name of an array")?, reader.text("a type")?);
        arrays.push((name.to_owned(), ctype.to_owned(), reader.block("an array")?.to_vec()));
    }
    Ok(TracedModel { settings, arrays, binary: reader.block("a model")?.to_vec() })
}

fn parse_call(reader: &mut Reader<'_>) -> Result<TracedCall, Invalid> {
    let code = reader.u8()?;
    let call = Call::of_code(code).ok_or_else(|| reader.invalid(format!("there is no kind of call {code}")))?;
    let (inputs, values) = (parse_values(reader)?, parse_values(reader)?);
    let error = Some(reader.text("the text of an error")?.to_owned()).filter(|text| !text.is_empty());
    Ok(TracedCall { call, inputs, results: Results { values, error } })
}

fn parse_values(reader: &mut Reader<'_>) -> Result<Vec<Series>, Invalid> {
    let mut parsed = Vec::new();
    for _ in 0..reader.u32()? {
        let name = reader.text("a name")?.to_owned();
        let columns = reader.u32()? as usize;
        let (words, rest) = reader.block("values")?.as_chunks::<8>();
        if columns == 0 || words.len() % columns != 0 || !rest.is_empty() {
            return Err(reader.invalid(format!("{} values of {name} in {columns} columns", words.len())));
        }
        let values = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        parsed.push(Series { name, columns, values });
    }
    Ok(parsed)
}
