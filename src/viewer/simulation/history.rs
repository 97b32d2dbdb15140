//! History of states for stepping back and scrubbing.

use crate::data::{Data, StateSpec};
use crate::model::Model;
use crate::viewer::link::Timeline;

/// Limits of the capacity: the number of states, their memory, and the number that is allowed
/// regardless of the memory.
const MAX_STATES: usize = 20_000;
const MAX_BYTES: usize = 64 << 20;
const MIN_STATES: usize = 100;

/// Ring buffer of the states before each step. A state contains everything that the next step
/// depends on, so a simulation continues bit for bit from a restored state.
#[derive(Debug)]
pub(super) struct History {
    /// Number of elements of a state.
    size: usize,
    /// Capacity in states.
    capacity: usize,
    /// Storage of the states. Grows up to the capacity.
    values: Vec<f64>,
    /// Slot of the oldest state.
    first: usize,
    len: usize,
    /// Index of the current state; `None` if it is newer than all states of the history.
    position: Option<usize>,
}

impl History {
    pub const SPEC: StateSpec = StateSpec::INTEGRATION;

    /// Creates an empty history.
    pub fn new(model: &Model) -> Self {
        let size = model.state_size(Self::SPEC);
        let capacity = (MAX_BYTES / (size * size_of::<f64>())).clamp(MIN_STATES, MAX_STATES);
        Self::with_capacity(model, capacity)
    }

    fn with_capacity(model: &Model, capacity: usize) -> Self {
        let size = model.state_size(Self::SPEC);
        Self { size, capacity, values: Vec::new(), first: 0, len: 0, position: None }
    }

    /// Returns the number of states.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns the index of the current state, or [`len`](Self::len) if it is newer than all states
    /// of the history.
    pub fn position(&self) -> usize {
        self.position.unwrap_or(self.len)
    }

    /// Sets the states of a timeline, with the current state of the simulation as the last if the
    /// history does not contain it.
    pub fn describe(&self, data: &Data, timeline: &mut Timeline) {
        let count = self.len + usize::from(self.position.is_none());
        // The time is the first element of a state.
        timeline.set(count, |index| if index < self.len { self.values[self.offset(index)] } else { data.time() });
    }

    /// Appends the current state before a step. Discards the states after it.
    pub fn record(&mut self, data: &Data) {
        if let Some(position) = self.position.take() {
            self.len = position;
        }
        self.push(data);
    }

    /// Restores the state this number of steps ago, or the oldest. Returns `false` if it is the
    /// current state already.
    pub fn back(&mut self, steps: usize, data: &mut Data) -> bool {
        self.go_to(self.position().saturating_sub(steps), data)
    }

    /// Restores a state, or the newest if the index is too large. Returns `false` if it is the
    /// current state already.
    pub fn go_to(&mut self, index: usize, data: &mut Data) -> bool {
        if self.len == 0 || (self.position.is_none() && index >= self.len) {
            return false;
        }
        let mut index = index;
        if self.position.is_none() {
            // Appends the current state, so that the user can return to it. A full ring loses its
            // oldest state.
            index = index.saturating_sub(usize::from(self.len == self.capacity));
            self.push(data);
        }
        let index = index.min(self.len - 1);
        if self.position.replace(index) == Some(index) {
            return false;
        }
        let start = self.offset(index);
        // `false` only for data of another model.
        data.set_state(Self::SPEC, &self.values[start..start + self.size]).is_ok()
    }

    /// Restores and removes the newest state after a step that failed.
    pub fn undo(&mut self, data: &mut Data) {
        if let Some(last) = self.len.checked_sub(1) {
            let start = self.offset(last);
            // Fails only for data of another model.
            let _ = data.set_state(Self::SPEC, &self.values[start..start + self.size]);
            (self.len, self.position) = (last, None);
        }
    }

    fn push(&mut self, data: &Data) {
        if self.len == self.capacity {
            self.first = (self.first + 1) % self.capacity;
            self.len -= 1;
        }
        let start = self.offset(self.len);
        if self.values.len() < start + self.size {
            self.values.resize(start + self.size, 0.0);
        }
        // Fails only for data of another model.
        let _ = data.state_into(Self::SPEC, &mut self.values[start..start + self.size]);
        self.len += 1;
    }

    /// Returns the offset of a state in `values`.
    fn offset(&self, index: usize) -> usize {
        (self.first + index) % self.capacity * self.size
    }
}

#[cfg(test)]
mod tests {
    use super::History;
    use crate::viewer::link::Timeline;
    use crate::{Data, sample};

    fn stepped(history: &mut History, data: &mut Data, steps: usize) {
        for _ in 0..steps {
            history.record(data);
            data.step().unwrap();
        }
    }

    #[test]
    fn states_are_restored_bit_for_bit_and_steps_are_reproducible() {
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.reset_to_key("squat").unwrap();
        let mut history = History::new(data.model());
        let mut states = Vec::new();
        for _ in 0..50 {
            states.push(data.state(History::SPEC));
            stepped(&mut history, &mut data, 1);
        }
        let last = data.state(History::SPEC);
        for back in (0..50).rev() {
            assert!(history.back(1, &mut data));
            assert_eq!(data.state(History::SPEC), states[back]);
            assert_eq!(history.position(), back);
        }
        assert!(!history.back(1, &mut data), "there is no state before the oldest");
        assert!(history.go_to(50, &mut data));
        assert_eq!(data.state(History::SPEC), last);
        history.go_to(0, &mut data);
        stepped(&mut history, &mut data, 50);
        assert_eq!(data.state(History::SPEC), last);
    }

    #[test]
    fn step_from_a_restored_state_discards_the_later_states() {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut history = History::new(data.model());
        stepped(&mut history, &mut data, 10);
        history.go_to(3, &mut data);
        data.ctrl_mut()[0] = 1.0;
        stepped(&mut history, &mut data, 1);
        assert_eq!((history.len(), history.position()), (4, 4));
    }

    #[test]
    fn timeline_has_the_times_of_the_states_and_of_the_current_state() {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut history = History::with_capacity(data.model(), 8);
        let mut timeline = Timeline::default();
        stepped(&mut history, &mut data, 20);
        let (newest, step) = (data.time(), data.model().timestep());
        history.describe(&data, &mut timeline);
        let ends = |timeline: &Timeline| [timeline.time(0.0).unwrap(), timeline.time(1.0).unwrap()];
        let is_near = |[one, other]: [f64; 2], [a, b]: [f64; 2]| (one - a).abs() < 1e-9 && (other - b).abs() < 1e-9;
        assert_eq!((timeline.len(), timeline.index(1.0)), (9, history.position()));
        assert!(is_near(ends(&timeline), [newest - 8.0 * step, newest]));
        history.back(3, &mut data);
        history.describe(&data, &mut timeline);
        assert_eq!(timeline.len(), 8);
        assert!(is_near(ends(&timeline), [newest - 7.0 * step, newest]));
        assert!((timeline.time(timeline.position(history.position())).unwrap() - data.time()).abs() < 1e-9);
    }

    #[test]
    fn memory_is_bounded_and_the_oldest_states_are_dropped() {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut history = History::with_capacity(data.model(), 8);
        stepped(&mut history, &mut data, 100);
        assert_eq!(history.len(), 8);
        assert_eq!(history.values.len(), 8 * history.size);
        let newest = data.time();
        assert!(history.back(3, &mut data));
        assert!((newest - data.time() - 3.0 * data.model().timestep()).abs() < 1e-9);
        assert!(history.back(100, &mut data));
        assert!((newest - data.time() - 7.0 * data.model().timestep()).abs() < 1e-9);
        assert_eq!(history.values.len(), 8 * history.size);
        for model in [sample::cartpole(), sample::humanoid()] {
            let history = History::new(&model);
            assert!(history.capacity * history.size * size_of::<f64>() <= super::MAX_BYTES);
        }
    }
}
