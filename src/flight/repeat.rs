//! Repetition of recordings.

use std::fmt;

use super::inputs::{self, Call};
use super::model_image;
use super::parts::invalid;
use super::recording::{Entry, Recording, Segment, shortened};
use crate::data::Data;
use crate::error::{Error, Outcome, Result};
use crate::model::Model;

/// Result of [`Recording::repeat`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Repeat {
    /// Number of calls that had the recorded results, bit for bit.
    pub calls: u64,
    /// The first call with other results, after which the repetition ended. `None` if all calls
    /// were repeated.
    pub difference: Option<Difference>,
}

/// Call that did not have its recorded results.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Difference {
    /// Number of the call.
    pub call: u64,
    /// Simulated time before the call, s.
    pub time: f64,
    /// The results that differ, and possible causes.
    pub reason: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "call {} at {} s: {}", self.call, self.time, self.reason)
    }
}

/// # Repetition
impl Recording {
    /// Makes all calls again, and compares the results of each with the recorded ones.
    ///
    /// # Errors
    ///
    /// [`Error::NotRepeated`] if this engine cannot load the model, [`Error::InvalidRecording`] if
    /// the recording contradicts itself.
    pub fn repeat(&self) -> Result<Repeat> {
        self.repeat_with(|_| ())
    }

    /// Makes all calls again as [`repeat`](Self::repeat) does, with simulations that `prepare` has
    /// prepared: it can give them [callbacks](Data::set_callbacks), which a recording does not
    /// contain. It is called for the first simulation, and for one after each change of the model.
    ///
    /// ```
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::flight::FlightRecorder;
    /// use mujoco_safe::{Data, sample};
    ///
    /// # use mujoco_safe::{Error, Model};
    /// # if matches!(Model::from_binary(b""), Err(Error::Unsupported(_))) {
    /// #     return Ok::<(), Error>(()); // an engine whose binary models are not loaded
    /// # }
    /// fn with_spring(data: &mut Data) {
    ///     data.set_callbacks(Callbacks::new().with_passive(|passive| {
    ///         let x = passive.qpos()[0];
    ///         passive.qfrc_passive_mut()[0] -= 20.0 * x;
    ///     }));
    /// }
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[0] = 0.5;
    /// with_spring(&mut data);
    /// let mut recorder = FlightRecorder::new(&data)?;
    /// recorder.step(&mut data)?;
    ///
    /// let recording = recorder.recording();
    /// let without = recording.repeat()?.difference.unwrap();
    /// assert!(without.reason.contains("callbacks"), "{without}");
    /// assert_eq!(recording.repeat_with(with_spring)?.difference, None);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`repeat`](Self::repeat), and the error of `prepare`.
    pub fn repeat_with<O: Outcome<Value = ()>>(&self, prepare: impl FnMut(&mut Data) -> O) -> Result<Repeat> {
        let mut player = Player::new(self, 0, prepare);
        let mut calls = 0;
        while player.play(|_, _| ())? {
            calls += 1;
        }
        Ok(Repeat { calls, difference: player.difference })
    }

    /// Returns the number of the first call after which a condition holds. Repeats the calls from
    /// the first one, so the condition may hold and cease to hold any number of times; it may also
    /// collect values, and return `false`.
    ///
    /// # Errors
    ///
    /// As for [`repeat`](Self::repeat), and [`Error::NotRepeated`] for a call with other results
    /// before the condition holds.
    pub fn first(&self, condition: impl FnMut(&Data) -> bool) -> Result<Option<u64>> {
        self.search(0, condition)
    }

    /// Returns the number of the first call after which a condition holds that continues to hold,
    /// such as "the robot has left the table", by bisection. It repeats the first call of a few
    /// segments, then the calls of one: about an eighth of the calls that [`first`](Self::first)
    /// repeats if the memory of the recorder is full and the model was not edited.
    ///
    /// If the condition ceases to hold, the call may be a later one of those that make it hold, or
    /// `None`.
    ///
    /// # Errors
    ///
    /// As for [`repeat`](Self::repeat), and [`Error::NotRepeated`] for a repeated call with other
    /// results.
    #[doc(alias = "bisect")]
    pub fn first_by_bisection(&self, mut condition: impl FnMut(&Data) -> bool) -> Result<Option<u64>> {
        let segments = &self.contents.segments;
        // After the first calls of the segments before `low` it does not hold, from `high` on it
        // does.
        let (mut low, mut high) = (0, segments.len());
        while low < high {
            let middle = low.midpoint(high);
            if condition(&self.data_after(segments[middle].first)?) { high = middle } else { low = middle + 1 }
        }
        self.search(low.saturating_sub(1), condition)
    }

    /// Returns the number of the first call of a segment or the later ones after which a condition
    /// holds.
    fn search(&self, segment: usize, mut condition: impl FnMut(&Data) -> bool) -> Result<Option<u64>> {
        let mut player = Player::new(self, segment, |_: &mut Data| ());
        while player.play_as_recorded(|_, _| ())? {
            if condition(player.data()) {
                return Ok(Some(player.next - 1));
            }
        }
        Ok(None)
    }

    /// Returns the simulation before a call, with the inputs of the call: the same call continues
    /// it as recorded.
    ///
    /// # Errors
    ///
    /// As for [`data_after`](Self::data_after).
    ///
    /// # Panics
    ///
    /// If the recording does not contain the call.
    pub fn data_before(&self, call: u64) -> Result<Data> {
        let mut player = self.player_before(call)?;
        player.prepare_call()?;
        Ok(player.into_data())
    }

    /// Returns the simulation after a call. If the call returned an error, the simulation is
    /// [poisoned](Error::Poisoned) as it was then.
    ///
    /// # Errors
    ///
    /// As for [`repeat`](Self::repeat), and [`Error::NotRepeated`] if this call or one before it in
    /// its segment has other results.
    ///
    /// # Panics
    ///
    /// If the recording does not contain the call.
    pub fn data_after(&self, call: u64) -> Result<Data> {
        let mut player = self.player_before(call)?;
        player.play_as_recorded(|_, _| ())?;
        Ok(player.into_data())
    }

    /// Repeats the calls before a call, from the begin of its segment.
    fn player_before(&self, call: u64) -> Result<Player<'_, impl FnMut(&mut Data)>> {
        let calls = self.calls();
        assert!(calls.contains(&call), "index out of range: call {call} of a recording of {calls:?}");
        let segment = self.contents.segments.partition_point(|segment| segment.first <= call) - 1;
        let mut player = Player::new(self, segment, |_: &mut Data| ());
        while player.next < call {
            player.play_as_recorded(|_, _| ())?;
        }
        Ok(player)
    }

    /// Loads the model of a segment.
    fn load(&self, segment: &Segment) -> Result<Model> {
        let base = self.contents.models.get(segment.model);
        let bytes = base.and_then(|base| model_image::bytes(base, &segment.edit, segment.length));
        let bytes = bytes.ok_or_else(|| invalid(&self.source_name, format!("model {} is damaged", segment.model)))?;
        let from_xml = |error| match self.xml() {
            None => Err(error),
            Some(xml) => {
                let model = Model::from_xml_str(xml)?;
                // The same model, which is then as good as the binary one.
                if model.to_binary()? == bytes { Ok(model) } else { Err(error) }
            }
        };
        Model::from_binary(&bytes).or_else(from_xml).map_err(|error| {
            let causes = self.origin().differences().join("; ");
            let separator = if causes.is_empty() { "" } else { "; " };
            Error::NotRepeated { call: segment.first, reason: format!("{error}{separator}{causes}") }
        })
    }
}

/// Repetition in progress.
pub(super) struct Player<'r, P> {
    recording: &'r Recording,
    prepare: P,
    /// The segment after the present one.
    next_segment: usize,
    /// The rest of the calls of the present segment.
    calls: &'r [f64],
    /// The simulation, and the segment from which its model was loaded.
    simulation: Option<(Data, &'r Segment)>,
    /// Values of the simulation.
    values: Vec<f64>,
    /// Number of the next call.
    next: u64,
    /// The call that ended the repetition.
    difference: Option<Difference>,
}

impl<'r, P: FnMut(&mut Data) -> O, O: Outcome<Value = ()>> Player<'r, P> {
    /// Starts before a segment.
    pub(super) fn new(recording: &'r Recording, segment: usize, prepare: P) -> Self {
        Self {
            recording,
            prepare,
            next_segment: segment,
            calls: &[],
            simulation: None,
            values: Vec::new(),
            next: recording.contents.segments.get(segment).map_or(0, |segment| segment.first),
            difference: None,
        }
    }

    fn data(&self) -> &Data {
        &self.simulation.as_ref().expect("Bug: a call was repeated").0
    }

    fn into_data(self) -> Data {
        self.simulation.expect("Bug: a call was repeated").0
    }

    /// Makes the next call, whose results must be the recorded ones. Returns `false` at the end.
    /// `before` receives the call and the simulation before it.
    pub(super) fn play_as_recorded(&mut self, before: impl FnOnce(Call, &Data)) -> Result<bool> {
        let is_repeated = self.play(before)?;
        match self.difference.take() {
            Some(Difference { call, reason, .. }) => Err(Error::NotRepeated { call, reason }),
            None => Ok(is_repeated),
        }
    }

    /// Makes the next call. Returns `false` at the end, and after a call with other results.
    fn play(&mut self, before: impl FnOnce(Call, &Data)) -> Result<bool> {
        let Some(entry) = self.prepare_call()? else { return Ok(false) };
        let (data, _) = self.simulation.as_mut().expect("Bug: the call was prepared");
        before(entry.call, data);
        let time = data.time();
        let error = entry.call.make(data).err().as_ref().map(shortened);
        let had_closures = entry.by_closures.is_some();
        let is_open = had_closures && !data.has_callbacks();
        let is_exchanged = inputs::count(data.model()) != self.values.len();
        let checksum = inputs::read_results(data, had_closures || is_exchanged, &mut self.values);
        let call = self.next;
        self.next += 1;
        let is_last = self.calls.is_empty();
        let recorded = self.recording.contents.segments[self.next_segment - 1].error.as_deref().filter(|_| is_last);
        let differs = if error.as_deref() != recorded {
            let text = |error: Option<&str>| error.map_or("succeeded".to_owned(), |error| format!("failed ({error})"));
            format!("it {} when recorded, but {} now", text(recorded), text(error.as_deref()))
        } else if checksum != entry.checksum {
            "the state after it has other bits".to_owned()
        } else {
            return Ok(true);
        };
        self.difference = Some(Difference { call, time, reason: format!("{differs}; {}", self.causes(is_open)) });
        Ok(false)
    }

    /// Returns possible causes of a difference.
    fn causes(&self, is_open: bool) -> String {
        let mut causes = self.recording.origin().differences();
        if is_open {
            causes.push("the simulation had callbacks, which Recording::repeat_with can set".to_owned());
        }
        if causes.is_empty() {
            causes.push(
                "possible causes are another build of the engine, memory of a plugin, unsafe code, or closures with a state"
                    .to_owned(),
            );
        }
        causes.join("; ")
    }

    /// Sets the inputs of the next call. Returns `None` at the end.
    fn prepare_call(&mut self) -> Result<Option<Entry<'r>>> {
        while self.calls.is_empty() {
            let Some(segment) = self.recording.contents.segments.get(self.next_segment) else { return Ok(None) };
            self.next_segment += 1;
            self.start(segment)?;
        }
        let entry = Entry::read(&mut self.calls, self.values.len()).expect("Bug: the calls were checked");
        let (data, _) = self.simulation.as_mut().expect("Bug: the segment has a simulation");
        if inputs::count(data.model()) != self.values.len() {
            let reason = format!("call {}: a closure has exchanged the simulation for another one", self.next);
            return Err(invalid(&self.recording.source_name, reason));
        }
        entry.before.iter().for_each(|run| run.set(&mut self.values));
        // The closures set these values themselves if the simulation has them.
        if !data.has_callbacks() {
            entry.by_closures.iter().flatten().for_each(|run| run.set(&mut self.values));
        }
        inputs::write(data, &self.values)?;
        Ok(Some(entry))
    }

    /// Starts a segment: loads its model, or resets the simulation.
    fn start(&mut self, segment: &'r Segment) -> Result<()> {
        match &mut self.simulation {
            Some((data, loaded)) if loaded.has_same_model(segment) => data.reset()?,
            _ => {
                let mut data = Data::new(self.recording.load(segment)?)?;
                (self.prepare)(&mut data).into_result()?;
                self.simulation = Some((data, segment));
            }
        }
        let needed = inputs::count(self.data().model());
        if needed != segment.values {
            let reason = format!("{} values of a model that has {needed}, from call {}", segment.values, segment.first);
            return Err(invalid(&self.recording.source_name, reason));
        }
        self.values.clear();
        self.values.resize(needed, 0.0);
        self.calls = &segment.calls;
        Ok(())
    }
}
