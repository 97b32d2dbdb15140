//! States to go back to.

use crate::data::{Data, StateSpec};
use crate::model::Model;

/// How many states are kept at most, how much memory they may take, and how many there are however large they are.
const MOST_STATES: usize = 20_000;
const MOST_BYTES: usize = 64 << 20;
const LEAST_STATES: usize = 100;

/// The states before the steps that were taken: a ring, where the oldest make room for the newest. A state is all that the next
/// step depends on, so a simulation that goes back goes on bit for bit as it did.
#[derive(Debug)]
pub(crate) struct History {
    /// Numbers in a state.
    size: usize,
    /// States that there is room for.
    room: usize,
    /// Grows to its room, and no further.
    numbers: Vec<f64>,
    /// Where the oldest is, and how many there are.
    first: usize,
    len: usize,
    /// At which of them the simulation is; `None` if at none, but after them.
    moment: Option<usize>,
}

impl History {
    pub const SPEC: StateSpec = StateSpec::INTEGRATION;

    /// An empty one.
    pub fn new(model: &Model) -> Self {
        let size = model.state_size(Self::SPEC);
        let room = (MOST_BYTES / (size * size_of::<f64>())).clamp(LEAST_STATES, MOST_STATES);
        Self::with_room(model, room)
    }

    fn with_room(model: &Model, room: usize) -> Self {
        let size = model.state_size(Self::SPEC);
        Self { size, room, numbers: Vec::new(), first: 0, len: 0, moment: None }
    }

    /// How many states there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// At which of them the simulation is; their number if it is after them.
    pub fn moment(&self) -> usize {
        self.moment.unwrap_or(self.len)
    }

    /// Keeps the present state, before a step. What was after it is forgotten: there is one past.
    pub fn record(&mut self, data: &Data) {
        if let Some(moment) = self.moment.take() {
            self.len = moment;
        }
        self.push(data);
    }

    /// Goes so many states back, or to the oldest. `false` if it is there already.
    pub fn back(&mut self, steps: usize, data: &mut Data) -> bool {
        self.go_to(self.moment().saturating_sub(steps), data)
    }

    /// Goes to a state, or to the newest. `false` if it is there already.
    pub fn go_to(&mut self, index: usize, data: &mut Data) -> bool {
        if self.len == 0 || (self.moment.is_none() && index >= self.len) {
            return false;
        }
        let mut index = index;
        if self.moment.is_none() {
            // It is kept, to come back to. The oldest may have to make room for it.
            index = index.saturating_sub(usize::from(self.len == self.room));
            self.push(data);
        }
        let index = index.min(self.len - 1);
        if self.moment.replace(index) == Some(index) {
            return false;
        }
        let start = self.place(index);
        // The size is that of the model, which a history is made for.
        data.set_state(Self::SPEC, &self.numbers[start..start + self.size]).is_ok()
    }

    /// Takes the newest state back, before a step that failed.
    pub fn take_back(&mut self, data: &mut Data) {
        if let Some(last) = self.len.checked_sub(1) {
            let start = self.place(last);
            // As above.
            let _ = data.set_state(Self::SPEC, &self.numbers[start..start + self.size]);
            (self.len, self.moment) = (last, None);
        }
    }

    fn push(&mut self, data: &Data) {
        if self.len == self.room {
            self.first = (self.first + 1) % self.room;
            self.len -= 1;
        }
        let start = self.place(self.len);
        if self.numbers.len() < start + self.size {
            self.numbers.resize(start + self.size, 0.0);
        }
        // As above.
        let _ = data.state_into(Self::SPEC, &mut self.numbers[start..start + self.size]);
        self.len += 1;
    }

    fn place(&self, index: usize) -> usize {
        (self.first + index) % self.room * self.size
    }
}

#[cfg(test)]
mod tests {
    use super::History;
    use crate::{Data, sample};

    fn stepped(history: &mut History, data: &mut Data, steps: usize) {
        for _ in 0..steps {
            history.record(data);
            data.step().unwrap();
        }
    }

    #[test]
    fn going_back_restores_every_state_bit_for_bit_and_the_future_follows_again() {
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
            assert_eq!(history.moment(), back);
        }
        assert!(!history.back(1, &mut data), "the oldest has nothing before it");
        assert!(history.go_to(50, &mut data));
        assert_eq!(data.state(History::SPEC), last);
        history.go_to(0, &mut data);
        stepped(&mut history, &mut data, 50);
        assert_eq!(data.state(History::SPEC), last);
    }

    #[test]
    fn a_step_from_the_past_forgets_what_came_after() {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut history = History::new(data.model());
        stepped(&mut history, &mut data, 10);
        history.go_to(3, &mut data);
        data.ctrl_mut()[0] = 1.0;
        stepped(&mut history, &mut data, 1);
        assert_eq!((history.len(), history.moment()), (4, 4));
    }

    #[test]
    fn memory_is_bounded_and_the_newest_states_are_kept() {
        let mut data = Data::new(sample::cartpole()).unwrap();
        let mut history = History::with_room(data.model(), 8);
        stepped(&mut history, &mut data, 100);
        assert_eq!(history.len(), 8);
        assert_eq!(history.numbers.len(), 8 * history.size);
        let newest = data.time();
        assert!(history.back(3, &mut data));
        assert!((newest - data.time() - 3.0 * data.model().timestep()).abs() < 1e-9);
        assert!(history.back(100, &mut data));
        assert!((newest - data.time() - 7.0 * data.model().timestep()).abs() < 1e-9);
        assert_eq!(history.numbers.len(), 8 * history.size);
        for model in [sample::cartpole(), sample::humanoid()] {
            let history = History::new(&model);
            assert!(history.room * history.size * size_of::<f64>() <= super::MOST_BYTES);
        }
    }
}
