//! Execution of rollouts.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::result::Sizes;
use super::workers::{Worker, prepare};
use super::{Controls, Initial, Rollout, RolloutBuffers, RolloutError};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::parallel::{Lease, Split, StopOnPanic, default_chunk, in_chunks};

/// Runs all rollouts. The lengths of the buffers must be correct.
pub(super) fn all(rollout: &Rollout<'_>, buffers: RolloutBuffers<'_>, outcomes: &mut [Result<(), RolloutError>]) {
    let run = Run { rollout, sizes: rollout.sizes(), done: AtomicUsize::new(0), stop: AtomicBool::new(false) };
    let chunk = rollout.chunk.unwrap_or_else(|| default_chunk(rollout.count));
    let records = Records { sizes: run.sizes, buffers, outcomes };
    in_chunks(records, 0, chunk, &|first, records| run.chunk(first, records));
}

/// Outputs of a chunk of rollouts.
struct Records<'b> {
    sizes: Sizes,
    buffers: RolloutBuffers<'b>,
    outcomes: &'b mut [Result<(), RolloutError>],
}

impl Split for Records<'_> {
    fn count(&self) -> usize {
        self.outcomes.len()
    }

    fn split(self, first: usize) -> (Self, Self) {
        let Self { sizes, buffers, outcomes } = self;
        let (states, other_states) = split(buffers.states, first, sizes.states_of_one());
        let (sensordata, other_sensordata) = split(buffers.sensordata, first, sizes.sensordata_of_one());
        let (outputs, other_outputs) = split(buffers.outputs, first, sizes.outputs_of_one());
        let (low, high) = outcomes.split_at_mut(first);
        let others = RolloutBuffers { states: other_states, sensordata: other_sensordata, outputs: other_outputs };
        (
            Self { sizes, buffers: RolloutBuffers { states, sensordata, outputs }, outcomes: low },
            Self { sizes, buffers: others, outcomes: high },
        )
    }
}

type Buffer<'b> = Option<&'b mut [f64]>;

/// Splits an optional buffer with `width` values per rollout.
fn split(buffer: Buffer<'_>, first: usize, width: usize) -> (Buffer<'_>, Buffer<'_>) {
    buffer.map(|buffer| buffer.split_at_mut(first * width)).unzip()
}

/// Returns one of the parts of this length of a buffer.
fn part<'p>(buffer: &'p mut Buffer<'_>, index: usize, length: usize) -> Buffer<'p> {
    buffer.as_deref_mut().map(|buffer| &mut buffer[index * length..][..length])
}

/// State of a run, shared by its threads.
struct Run<'r, 'a> {
    rollout: &'r Rollout<'a>,
    sizes: Sizes,
    /// Number of completed rollouts.
    done: AtomicUsize,
    /// Flag that ends the run early.
    stop: AtomicBool,
}

impl Run<'_, '_> {
    /// Runs rollouts one after another in one simulation.
    fn chunk(&self, first: usize, mut records: Records<'_>) {
        let guard = StopOnPanic::new(&self.stop);
        let mut lease = self.rollout.workers.0.lease();
        for (index, outcome) in records.outcomes.iter_mut().enumerate() {
            let record = RolloutBuffers {
                states: part(&mut records.buffers.states, index, self.sizes.states_of_one()),
                sensordata: part(&mut records.buffers.sensordata, index, self.sizes.sensordata_of_one()),
                outputs: part(&mut records.buffers.outputs, index, self.sizes.outputs_of_one()),
            };
            *outcome = self.one(first + index, &mut lease, record);
            if !matches!(outcome, Err(RolloutError::Cancelled { .. })) {
                self.report();
            }
        }
        guard.disarm();
    }

    /// Counts a completed rollout, and calls the progress hook.
    fn report(&self) {
        if let Some(hook) = &self.rollout.progress
            && hook(self.done.fetch_add(1, Ordering::Relaxed) + 1).is_break()
        {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    /// Runs one rollout, and fills its remaining rows with NaN if it ends early.
    fn one(&self, index: usize, lease: &mut Lease<'_, Worker>, record: RolloutBuffers<'_>) -> Result<(), RolloutError> {
        let mut recorder = Recorder { record, sizes: self.sizes, states: 0, steps: 0, outputs: 0 };
        let result = self.simulate(index, lease, &mut recorder);
        let step = recorder.steps;
        let outcome = match result {
            Ok(()) if step == self.sizes.steps && recorder.states == step + 1 => Ok(()),
            Ok(()) => Err(RolloutError::Cancelled { step }),
            Err(error) => Err(RolloutError::Failed { step, error }),
        };
        recorder.fill_rest();
        outcome
    }

    /// Simulates until the end, an error, or a stop.
    fn simulate(&self, index: usize, lease: &mut Lease<'_, Worker>, recorder: &mut Recorder<'_>) -> Result<()> {
        let Rollout { workers, initial, controls, edit, record, outputs, forward, steps, .. } = self.rollout;
        if self.stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let (Worker { data, saved }, model) = (lease.get()?, workers.model());
        prepare(data, model, index, edit.as_deref())?;
        match *initial {
            Initial::Reference => {}
            Initial::Shared(spec, state) => data.set_state(spec, state)?,
            Initial::Each(spec, states) => {
                let size = model.state_size(spec);
                data.set_state(spec, &states[index * size..][..size])?;
            }
        }
        recorder.state(data, *record)?;

        let nu = model.nu();
        let mut controller = match controls {
            Controls::From(make) => Some(make(index)),
            _ => None,
        };
        for step in 0..*steps {
            if self.stop.load(Ordering::Relaxed) {
                break;
            }
            match controls {
                Controls::None => {}
                Controls::Shared(controls) => data.set_state(StateSpec::CTRL, &controls[step * nu..][..nu])?,
                Controls::Each(controls) => {
                    data.set_state(StateSpec::CTRL, &controls[(index * steps + step) * nu..][..nu])?;
                }
                Controls::From(_) => {
                    if let Some(controller) = &mut controller {
                        controller.control(data)?;
                    }
                }
            }
            data.step()?;
            recorder.sensordata(data)?;
            let mut computed = if *forward { data.forward_between_steps(saved) } else { Ok(()) };
            if let Some((_, read)) = outputs {
                computed = computed.and_then(|()| recorder.outputs(data, read));
            }
            recorder.steps += 1;
            recorder.state(data, *record)?;
            computed?;
        }
        Ok(())
    }
}

/// Writes the rows of one rollout.
struct Recorder<'b> {
    record: RolloutBuffers<'b>,
    sizes: Sizes,
    /// Number of recorded states.
    states: usize,
    /// Number of recorded steps.
    steps: usize,
    /// Number of recorded outputs, which is lower than the number of steps if the last outputs
    /// could not be computed.
    outputs: usize,
}

impl Recorder<'_> {
    fn state(&mut self, data: &Data, spec: StateSpec) -> Result<()> {
        if let Some(row) = part(&mut self.record.states, self.states, self.sizes.state) {
            data.state_into(spec, row)?;
        }
        self.states += 1;
        Ok(())
    }

    fn sensordata(&mut self, data: &Data) -> Result<()> {
        if let Some(row) = part(&mut self.record.sensordata, self.steps, self.sizes.sensordata) {
            let values = data.sensordata();
            // A controller may have replaced the simulation by one of another model.
            Error::check_length("the sensor readings of a rollout", values.len(), row.len())?;
            row.copy_from_slice(values);
        }
        Ok(())
    }

    fn outputs(&mut self, data: &Data, read: &super::Read<'_>) -> Result<()> {
        if let Some(row) = part(&mut self.record.outputs, self.outputs, self.sizes.output) {
            row.fill(0.0);
            read(data, row)?;
        }
        self.outputs += 1;
        Ok(())
    }

    /// Fills the remaining rows with NaN.
    fn fill_rest(&mut self) {
        let Self { record, sizes, states, steps, outputs } = self;
        for (buffer, written) in [
            (&mut record.states, *states * sizes.state),
            (&mut record.sensordata, *steps * sizes.sensordata),
            (&mut record.outputs, *outputs * sizes.output),
        ] {
            if let Some(buffer) = buffer {
                buffer[written..].fill(f64::NAN);
            }
        }
    }
}
