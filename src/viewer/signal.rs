//! Signals that the window plots: newest values, and ranges between two images.

use crate::data::Data;
use crate::model::Model;
use crate::viewer::endpoint::Watch;

/// Newest value of a signal, and the range of its values that no plot shows yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Signal {
    /// NaN before the first value.
    pub value: f64,
    /// Smallest and largest finite value. From infinity to minus infinity if there is none.
    pub range: [f64; 2],
}

impl Default for Signal {
    fn default() -> Self {
        Self { value: f64::NAN, range: Self::NO_RANGE }
    }
}

impl From<f64> for Signal {
    fn from(value: f64) -> Self {
        Self { value, ..Self::default() }
    }
}

impl Signal {
    pub const NO_RANGE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

    /// Sets the newest value.
    pub fn push(&mut self, value: f64) {
        self.value = value;
        if value.is_finite() {
            self.add_range([value; 2]);
        }
    }

    /// Extends the range.
    pub fn add_range(&mut self, range: [f64; 2]) {
        self.range = union(self.range, range);
    }
}

/// Returns the range that contains two ranges.
pub(crate) fn union(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    [one[0].min(other[0]), one[1].max(other[1])]
}

/// Watched value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WatchedSignal {
    pub watch: Watch,
    pub signal: Signal,
}

/// Signals of a simulation, without those of a controller or a program.
#[derive(Debug, Default)]
pub(crate) struct Signals {
    /// Number of iterations of the solver and of constraints; decimal logarithms of the improvement
    /// and the gradient of the last iteration; potential, kinetic and total energy, J, if they are
    /// computed.
    pub profile: [Signal; 7],
    /// Elements of the readings of the sensors.
    pub sensors: Vec<Signal>,
    /// In the order of the request. NaN for an index out of range.
    pub watched: Vec<WatchedSignal>,
}

impl Signals {
    /// Adds the current values of a simulation.
    pub fn sample(&mut self, data: &Data) {
        let solver = data.solver();
        let iterations = solver.len() as f64;
        let last = solver.last().map_or([f64::NAN; 2], |last| [last.improvement, last.gradient]);
        let [improvement, gradient] = last.map(f64::log10);
        let [potential, kinetic] = data.energy();
        let total = potential + kinetic;
        let profile = [iterations, data.nefc() as f64, improvement, gradient, potential, kinetic, total];
        self.sensors.resize(data.sensordata().len(), Signal::default());
        let signals = self.profile.iter_mut().chain(&mut self.sensors);
        signals.zip(profile.iter().chain(data.sensordata())).for_each(|(signal, value)| signal.push(*value));
        for WatchedSignal { watch, signal } in &mut self.watched {
            signal.push(watch.value(data));
        }
    }

    /// Watches other values.
    pub fn watch(&mut self, watches: Vec<Watch>) {
        self.watched = watches.into_iter().map(|watch| WatchedSignal { watch, signal: Signal::default() }).collect();
    }

    /// Discards the values of the previous model, and watches the values of the same names.
    pub fn adopt(&mut self, model: &Model) {
        self.profile = Default::default();
        self.sensors.clear();
        for WatchedSignal { watch, signal } in &mut self.watched {
            watch.resolve(model);
            *signal = Signal::default();
        }
    }

    /// Copies the signals, and reuses the memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.profile = other.profile;
        other.sensors.clone_into(&mut self.sensors);
        other.watched.clone_into(&mut self.watched);
    }

    /// Extends the ranges by those of older signals of the same model.
    pub fn add_ranges(&mut self, older: &Self) {
        let signals = self.profile.iter_mut().chain(&mut self.sensors);
        for (signal, older) in signals.zip(older.profile.iter().chain(&older.sensors)) {
            signal.add_range(older.range);
        }
        for watched in &mut self.watched {
            if let Some(older) = older.watched.iter().find(|older| older.watch == watched.watch) {
                watched.signal.add_range(older.signal.range);
            }
        }
    }

    /// Empties the ranges.
    pub fn clear_ranges(&mut self) {
        let watched = self.watched.iter_mut().map(|watched| &mut watched.signal);
        let signals = self.profile.iter_mut().chain(&mut self.sensors).chain(watched);
        signals.for_each(|signal| signal.range = Signal::NO_RANGE);
    }
}
