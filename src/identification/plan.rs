//! The steps, segments and samples of an experiment.

use super::Experiment;
use super::column::Column;
use super::experiment::Source;
use super::unknown::{Correction, Kind, Unknown};
use crate::data::{Data, StateSpec};
use crate::error::{Error, InvalidKind, Result};
use crate::memory;

/// Difference of times that counts as rounding, relative to a time step.
const SAME: f64 = 1e-6;

/// Parts of a state that a step of the simulation changes or reads.
pub(super) const STEP: StateSpec =
    StateSpec::TIME.union(StateSpec::PHYSICS).union(StateSpec::CTRL).union(StateSpec::WARMSTART);
/// Number of states that one thread differentiates by formulas at a time.
pub(super) const PART: usize = 128;

/// Experiment with the layout of its simulation.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) experiment: Experiment,
    /// Steps at which segments start, and the number of all steps.
    pub(super) nodes: Vec<usize>,
    /// Coordinates of the state that are identified: at the start, and of any other segment.
    states: [Vec<usize>; 2],
    pub(super) channels: Vec<Channel>,
    /// Number of values of a simulated reading of all measurements.
    pub(super) width: usize,
    /// Unknowns whose columns have formulas, as those of the state do, if formulas apply.
    pub(super) formulas: Option<Vec<usize>>,
}

/// Layout of a measurement.
#[derive(Debug)]
pub(super) struct Channel {
    /// Place of its first value in a simulated reading.
    pub(super) first: usize,
    /// Samples that the simulation reaches with all delays between the bounds.
    pub(super) samples: std::ops::Range<usize>,
    /// Unknowns that correct the measurement.
    pub(super) delay: Option<usize>,
    pub(super) gain: Option<usize>,
    pub(super) bias: Option<usize>,
}

impl Plan {
    pub(super) fn new(experiment: Experiment, unknowns: &[Unknown]) -> Result<Self> {
        experiment.check()?;
        let h = experiment.model.timestep();
        let start = experiment.start_time;
        let mut channels = Vec::new();
        let (mut width, mut end) = (0, start);
        for measurement in &experiment.measurements {
            let [delay, gain, bias] = [Correction::Delay, Correction::Gain, Correction::Bias].map(|correction| {
                unknowns.iter().position(|unknown| match &unknown.kind {
                    Kind::Correction(kind, name) => *kind == correction && *name == measurement.name,
                    _ => false,
                })
            });
            let [least, largest] = match delay {
                Some(index) => [unknowns[index].lower, unknowns[index].upper],
                None => [measurement.delay; 2],
            };
            let times = measurement.signal.times();
            let first = times.partition_point(|time| time - largest < start - SAME * h);
            if first == times.len() {
                return Err(Error::invalid(
                    InvalidKind::OutOfRange,
                    format!("the last reading of {} in {}", measurement.name, experiment.name),
                    format!("at {} s", times[times.len() - 1]),
                    format!("at least {largest} s, the largest delay, after the start at {start} s"),
                ));
            }
            end = end.max(times[times.len() - 1] - least);
            let count = measurement.signal.width();
            channels.push(Channel { first: width, samples: first..times.len(), delay, gain, bias });
            width += count;
        }
        let steps = ((end - start) / h - SAME).ceil().max(1.0);
        let what = format_args!("the number of steps of the experiment {}", experiment.name);
        Error::check_range(steps <= 1e9, what, steps, "at most 1e9")?;
        let steps = steps as usize;
        // Derivatives keep the readings of all steps, and points their states.
        let columns = 1 + experiment.uncertainty.len() + unknowns.len();
        let numbers = width * columns + 2 * experiment.model.state_size(STEP);
        memory::check(&format!("steps of the experiment {}", experiment.name), steps + 1, size_of::<f64>() * numbers)?;
        let length = (experiment.segment / h).round().clamp(1.0, steps as f64) as usize;
        // A short rest belongs to the segment before it.
        let mut nodes: Vec<usize> = (0..steps).step_by(length).filter(|node| steps - node > length / 2).collect();
        if nodes.is_empty() {
            nodes.push(0);
        }
        nodes.push(steps);
        let all = 0..experiment.uncertainty.len();
        let states = [all.clone().filter(|&index| experiment.uncertainty[index] > 0.0).collect(), all.collect()];
        Ok(Self { experiment, nodes, states, channels, width, formulas: None })
    }

    pub(super) fn segments(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Returns `true` if the derivative by a column has a formula.
    pub(super) fn has_formula(&self, column: Column) -> bool {
        self.formulas.as_ref().is_some_and(|unknowns| match column {
            Column::Unknown(index) => unknowns.contains(&index),
            Column::State(_) => true,
        })
    }

    /// Returns the number of steps of a segment.
    pub(super) fn steps(&self, segment: usize) -> usize {
        self.nodes[segment + 1] - self.nodes[segment]
    }

    /// Returns the coordinates of the state at the start of a segment that are identified.
    pub(super) fn states(&self, segment: usize) -> &[usize] {
        &self.states[segment.min(1)]
    }

    /// Returns the place of a column among those of a segment: first the state, then the unknowns.
    pub(super) fn column(&self, segment: usize, column: Column) -> usize {
        let states = self.states(segment);
        match column {
            Column::State(coordinate) => {
                states.iter().position(|&state| state == coordinate).expect("Bug: a column of a known coordinate")
            }
            Column::Unknown(index) => states.len() + index,
        }
    }

    /// Returns the time of a step.
    pub(super) fn time(&self, step: usize) -> f64 {
        self.experiment.start_time + step as f64 * self.experiment.model.timestep()
    }

    /// Returns the samples of a measurement, with this delay, that belong to a segment.
    pub(super) fn samples(&self, segment: usize, channel: usize, delay: f64) -> std::ops::Range<usize> {
        let samples = self.channels[channel].samples.clone();
        let times = &self.experiment.measurements[channel].signal.times()[samples.clone()];
        let before = |step: usize| samples.start + times.partition_point(|time| time - delay < self.time(step));
        let first = if segment == 0 { samples.start } else { before(self.nodes[segment]) };
        let last = if segment + 1 == self.segments() { samples.end } else { before(self.nodes[segment + 1]) };
        first..last
    }

    /// Sets the time and the controls of a step.
    pub(super) fn set_inputs(&self, step: usize, data: &mut Data) {
        data.set_time(self.time(step));
        if let Some(controls) = &self.experiment.controls {
            // Half a step later, so that rounding does not choose the control.
            let time = self.time(step) + 0.5 * data.model().timestep();
            data.ctrl_mut().copy_from_slice(controls.held(time));
        }
    }

    /// Returns `true` if a measurement needs the results of [`forward`](crate::Data::forward).
    pub(super) fn needs_forward(&self) -> bool {
        self.experiment.measurements.iter().any(|measurement| matches!(measurement.source, Source::Read(_)))
    }
}
