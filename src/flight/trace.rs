//! Traces: the inputs of calls and the quantities that one engine computes from them, as a stream
//! of records that another engine reads.
//!
//! The first record is the origin of the trace, and the last has the number of calls, so a missing
//! end is detected. A model precedes the calls that use it.

use std::io::{Read, Write};
use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::inputs::{self, Call};
use super::origin::Origin;
use super::quantities::{self, QUANTITIES, Quantity, Series};
use super::recording::Recording;
use super::repeat::Player;
use super::{model_difference, parts};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;

const MAGIC: [u8; 8] = *b"MJ_TRACE";
/// Begin of the names of quantities of a solver that converges further.
pub(super) const CONVERGED: &str = "converged ";
/// Name of the trace in errors.
pub(super) const NAME: &str = "the trace";

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
        parts::put_begin(&mut out, MAGIC).map_err(Error::file(NAME))?;
        let mut tracer = Self { out, probe: None, calls: 0 };
        let xml = xml.unwrap_or_default().to_owned();
        tracer.put(&Record::Begin { origin: Origin::here(), xml })?;
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
        self.put(&Record::End { calls: self.calls })?;
        self.out.flush().map_err(Error::file(NAME))?;
        Ok(self.out)
    }

    /// Writes the quantities of a call from the present inputs.
    fn put_call(&mut self, call: Call, data: &Data) -> Result<()> {
        let revision = data.model().revision();
        if self.probe.as_ref().is_none_or(|(_, known)| *known != revision) {
            let binary = if cfg!(validates_binaries) { data.model().to_binary()? } else { Vec::new() };
            self.put(&Record::Model(TracedModel { fields: model_difference::fields(data.model())?, binary }))?;
            self.probe = Some(([Data::new(data.model().clone())?, converging(data.model())?], revision));
        }
        let ([probe, converging], _) = self.probe.as_mut().expect("Bug: there is a simulation");
        let mut values = Vec::new();
        inputs::read(data, &mut values);
        let input = |(name, place): (String, Range<usize>)| Series { name, columns: 1, values: values[place].to_vec() };
        let inputs = quantities::inputs(data.model()).map(input).collect();
        let mut results = evaluate(probe, call, &values);
        for mut series in evaluate(converging, call, &values).values {
            let is_series = |quantity: &&Quantity| quantity.name == series.name;
            if QUANTITIES.iter().find(is_series).is_some_and(Quantity::depends_on_solver) {
                series.name.insert_str(0, CONVERGED);
                results.values.push(series);
            }
        }
        self.calls += 1;
        self.put(&Record::Call(TracedCall { call, inputs, results }))
    }

    fn put(&mut self, record: &Record) -> Result<()> {
        parts::put(&mut self.out, record).map_err(Error::file(NAME))
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

/// Results of a call.
#[derive(Serialize, Deserialize)]
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
        quantities::read(data, false, &mut values);
        if matches!(call, Call::Step | Call::Step2) {
            inputs::write(data, inputs)?;
            data.step()?;
            quantities::read(data, true, &mut values);
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
#[derive(Serialize, Deserialize)]
pub(super) struct TracedModel {
    /// Sizes, options and arrays.
    pub(super) fields: Vec<Series>,
    /// The binary form, which another build of the engine loads.
    pub(super) binary: Vec<u8>,
}

/// Call of a trace.
#[derive(Serialize, Deserialize)]
pub(super) struct TracedCall {
    pub(super) call: Call,
    pub(super) inputs: Vec<Series>,
    pub(super) results: Results,
}

/// Part of a trace.
#[derive(Serialize, Deserialize)]
pub(super) enum Record {
    Begin {
        origin: Origin,
        /// The model as MJCF, or empty.
        xml: String,
    },
    Model(TracedModel),
    Call(TracedCall),
    End {
        calls: u64,
    },
}

/// Reader of a trace, which is not trusted.
pub(super) struct Trace<R> {
    source: R,
    /// Number of calls so far.
    calls: u64,
}

impl<R: Read> Trace<R> {
    pub(super) fn open(mut source: R) -> Result<Self> {
        parts::read_begin(&mut source, MAGIC, NAME)?;
        Ok(Self { source, calls: 0 })
    }

    /// Returns the next part.
    pub(super) fn next(&mut self) -> Result<Record> {
        let name = format!("{NAME} after {} calls", self.calls);
        let record = parts::read(&mut self.source, &name)?;
        let series = match &record {
            Record::Begin { .. } | Record::End { .. } => Vec::new(),
            Record::Model(model) => vec![&model.fields],
            Record::Call(call) => vec![&call.inputs, &call.results.values],
        };
        for Series { name: field, columns, values } in series.into_iter().flatten() {
            if !values.len().is_multiple_of(*columns) || *columns == 0 {
                let reason = format!("{} values of {field} in {columns} columns", values.len());
                return Err(parts::invalid(&name, reason));
            }
        }
        match record {
            Record::End { calls } if calls != self.calls => {
                Err(parts::invalid(&name, format!("it ends after {} calls instead of {calls}", self.calls)))
            }
            record => {
                self.calls += u64::from(matches!(record, Record::Call(_)));
                Ok(record)
            }
        }
    }
}
