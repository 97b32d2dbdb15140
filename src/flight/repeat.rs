//! Repetition of recordings.

use std::fmt;
use std::sync::Arc;

use super::format::Reader;
use super::inputs::{self, Call};
use super::recorder::shortened;
use super::recording::{Entry, Recording, Run, Segment};
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
        let mut repeat = Repeat { calls: 0, difference: None };
        loop {
            match player.play(|_, _| ())? {
                Played::AsRecorded => repeat.calls += 1,
                Played::Differs(difference) => {
                    repeat.difference = Some(difference);
                    break;
                }
                Played::End => break,
            }
        }
        Ok(repeat)
    }

    /// Returns the number of the first call after which a condition holds. Repeats the calls from
    /// the first one, so the condition may hold and cease to hold any number of times; it may also
    /// collect values, and return `false`.
    ///
    /// # Errors
    ///
    /// As for [`repeat`](Self::repeat), and [`Error::NotRepeated`] for a call with other results
    /// before the condition holds.
    pub fn first(&self, mut condition: impl FnMut(&Data) -> bool) -> Result<Option<u64>> {
        let mut player = Player::new(self, 0, |_: &mut Data| ());
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
        let segment = self.segments.partition_point(|segment| segment.first <= call) - 1;
        let mut player = Player::new(self, segment, |_: &mut Data| ());
        while player.next < call {
            player.play_as_recorded(|_, _| ())?;
        }
        Ok(player)
    }

    /// Loads the model of a segment.
    fn load(&self, segment: &Segment) -> Result<Model> {
        let bytes = segment.image.bytes().map_err(|invalid| invalid.of(&self.source_name))?;
        let from_xml = |error| match self.xml() {
            None => Err(error),
            Some(xml) => {
                let model = Model::from_xml_str(xml)?;
                // The same model, which is then as good as the binary one.
                if model.to_binary()? == bytes { Ok(model) } else { Err(error) }
            }
        };
        Model::from_binary(&bytes).or_else(from_xml).map_err(|error| {
            let causes = self.origin.differences().join("; ");
            let separator = if causes.is_empty() { "" } else { "; " };
            Error::NotRepeated { call: segment.first, reason: format!("{error}{separator}{causes}") }
        })
    }
}

/// Result of a repeated call.
enum Played {
    AsRecorded,
    Differs(Difference),
    /// The recording has no more calls.
    End,
}

/// Repetition in progress.
pub(super) struct Player<'r, P> {
    recording: &'r Recording,
    prepare: P,
    /// The segment after the present one.
    next_segment: usize,
    /// The rest of the present segment.
    calls: Reader<'r>,
    /// The simulation, and the segment from which its model was loaded.
    simulation: Option<(Data, &'r Segment)>,
    /// Values of the simulation.
    values: Vec<f64>,
    /// Number of the next call.
    next: u64,
}

impl<'r, P: FnMut(&mut Data) -> O, O: Outcome<Value = ()>> Player<'r, P> {
    /// Starts before a segment.
    pub(super) fn new(recording: &'r Recording, segment: usize, prepare: P) -> Self {
        let next = recording.segments.get(segment).map_or(0, |segment| segment.first);
        Self {
            recording,
            prepare,
            next_segment: segment,
            calls: Reader::new(&[]),
            simulation: None,
            values: Vec::new(),
            next,
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
        match self.play(before)? {
            Played::AsRecorded => Ok(true),
            Played::Differs(Difference { call, reason, .. }) => Err(Error::NotRepeated { call, reason }),
            Played::End => Ok(false),
        }
    }

    /// Makes the next call, and compares its results.
    fn play(&mut self, before: impl FnOnce(Call, &Data)) -> Result<Played> {
        let Some(entry) = self.prepare_call()? else { return Ok(Played::End) };
        let (data, _) = self.simulation.as_mut().expect("Bug: the call was prepared");
        before(entry.call, data);
        let time = data.time();
        let result = entry.call.make(data);
        let is_open = entry.has_closures && !data.has_callbacks();
        let is_exchanged = inputs::count(data.model()) != self.values.len();
        let checksum = inputs::read_results(data, entry.has_closures || is_exchanged, &mut self.values);
        let call = self.next;
        self.next += 1;
        let error = result.err().map(|error| shortened(error.to_string()));
        let differs = if error.as_deref() != entry.error {
            let text = |error: Option<&str>| error.map_or("succeeded".to_owned(), |error| format!("failed ({error})"));
            Some(format!("it {} when recorded, but {} now", text(entry.error), text(error.as_deref())))
        } else if checksum != entry.checksum {
            Some("the state after it has other bits".to_owned())
        } else {
            None
        };
        Ok(differs.map_or(Played::AsRecorded, |differs| {
            let reason = format!("{differs}; {}", self.causes(is_open));
            Played::Differs(Difference { call, time, reason })
        }))
    }

    /// Returns possible causes of a difference.
    fn causes(&self, is_open: bool) -> String {
        let mut causes = self.recording.origin.differences();
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
        while self.calls.is_at_end() {
            let Some(segment) = self.recording.segments.get(self.next_segment) else { return Ok(None) };
            self.next_segment += 1;
            self.start(segment)?;
        }
        let invalid = |reason: String| Error::InvalidRecording {
            source_name: self.recording.source_name.clone(),
            reason: format!("call {}: {reason}", self.next),
        };
        let entry = Entry::read(&mut self.calls, self.values.len()).map_err(|error| invalid(error.reason))?;
        let (data, _) = self.simulation.as_mut().expect("Bug: the segment has a simulation");
        if inputs::count(data.model()) != self.values.len() {
            return Err(invalid("a closure has exchanged the simulation for another one".to_owned()));
        }
        set(&mut self.values, &entry.before);
        // The closures set these values themselves if the simulation has them.
        if !data.has_callbacks() {
            set(&mut self.values, &entry.by_closures);
        }
        inputs::write(data, &self.values)?;
        Ok(Some(entry))
    }

    /// Starts a segment: loads its model, or resets the simulation.
    fn start(&mut self, segment: &'r Segment) -> Result<()> {
        let is_same = |other: &Segment| {
            Arc::ptr_eq(&other.image.base, &segment.image.base) && other.image.edit == segment.image.edit
        };
        match &mut self.simulation {
            Some((data, loaded)) if is_same(loaded) => data.reset()?,
            _ => {
                let mut data = Data::new(self.recording.load(segment)?)?;
                (self.prepare)(&mut data).into_result()?;
                self.simulation = Some((data, segment));
            }
        }
        let needed = inputs::count(self.data().model());
        if needed != segment.values {
            let reason = format!("{} values of a model that has {needed}, from call {}", segment.values, segment.first);
            return Err(Error::InvalidRecording { source_name: self.recording.source_name.clone(), reason });
        }
        self.values.clear();
        self.values.resize(needed, 0.0);
        self.calls = Reader::new(&segment.calls);
        Ok(())
    }
}

fn set(values: &mut [f64], runs: &[Run<'_>]) {
    for (start, words) in runs {
        values[*start..].iter_mut().zip(*words).for_each(|(value, word)| *value = f64::from_le_bytes(*word));
    }
}
