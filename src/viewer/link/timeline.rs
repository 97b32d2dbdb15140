//! States in the order of their times: those of the history, or the records of a trajectory.

/// Maximum number of states whose times a snapshot contains.
const MAX_SAMPLES: usize = 200;

/// States in the order of their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Timeline {
    /// Number of states.
    len: usize,
    /// Times of states that are equally far apart, from the first to the last state, s.
    times: Vec<f64>,
}

/// Mark of a timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// Position from 0 for the first to 1 for the last state.
    pub position: f64,
    /// Time, s. After a reset, the time of the first state after it.
    pub time: f64,
}

impl Timeline {
    /// Sets the number of states, and the times of some of them. Reuses the memory.
    pub fn set(&mut self, len: usize, time: impl Fn(usize) -> f64) {
        self.len = len;
        self.times.clear();
        let samples = len.min(MAX_SAMPLES);
        let index =
            |sample: usize| if samples > 1 { (sample * (len - 1) + (samples - 1) / 2) / (samples - 1) } else { 0 };
        self.times.extend((0..samples).map(|sample| time(index(sample))));
    }

    /// Returns the number of states.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns the state at a position from 0 to 1.
    pub fn index(&self, position: f64) -> usize {
        let last = self.len.saturating_sub(1);
        (position.clamp(0.0, 1.0) * last as f64).round() as usize
    }

    /// Returns the position of a state from 0 to 1.
    pub fn position(&self, index: usize) -> f64 {
        let last = self.len.saturating_sub(1);
        if last == 0 { 0.0 } else { index.min(last) as f64 / last as f64 }
    }

    /// Returns the time at a position, interpolated between states, s.
    pub fn time(&self, position: f64) -> Option<f64> {
        let place = position.clamp(0.0, 1.0) * self.times.len().saturating_sub(1) as f64;
        let (before, part) = (place.floor() as usize, place.fract());
        let start = *self.times.get(before)?;
        let end = *self.times.get(before + 1).unwrap_or(&start);
        // There is no time between the states before and after a reset.
        Some(if end < start { [start, end][usize::from(part >= 0.5)] } else { start + part * (end - start) })
    }

    /// Returns the duration of all states, without the jumps back of resets, s.
    pub fn duration(&self) -> f64 {
        self.steps().map(|(_, [start, end])| end - start).filter(|step| *step > 0.0).sum()
    }

    /// Returns the multiples of an interval in the order of their positions. The interval must be
    /// positive.
    pub fn ticks(&self, interval: f64) -> impl Iterator<Item = Mark> + '_ {
        // Times are sums of time steps, with rounding errors.
        let tolerance = 1e-6 * interval;
        self.steps().flat_map(move |(position, [start, end])| {
            let first = if position[0] == 0.0 { start - tolerance } else { start + tolerance };
            let numbers = [first, end + tolerance].map(|time| (time / interval).floor());
            let count = if end > start && numbers.iter().all(|number| number.is_finite()) {
                (numbers[1] - numbers[0]).clamp(0.0, MAX_SAMPLES as f64) as usize
            } else {
                0
            };
            (1..=count).map(move |number| {
                let time = (numbers[0] + number as f64) * interval;
                let part = ((time - start) / (end - start)).clamp(0.0, 1.0);
                Mark { position: position[0] + part * (position[1] - position[0]), time }
            })
        })
    }

    /// Returns the resets, after which the time is smaller.
    pub fn resets(&self) -> impl Iterator<Item = Mark> + '_ {
        let resets = self.steps().filter(|(_, [start, end])| end < start);
        resets.map(|(position, [_, time])| Mark { position: position[1], time })
    }

    /// Returns the first position of a time, s, if it is among the states.
    pub fn find(&self, time: f64) -> Option<f64> {
        let tolerance = 1e-9 * time.abs().max(1.0);
        let contains = |step: &([f64; 2], [f64; 2])| step.1[0] - tolerance <= time && time <= step.1[1] + tolerance;
        let (position, [start, end]) = self.steps().find(contains)?;
        let part = if end > start { ((time - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        Some(position[0] + part * (position[1] - position[0]))
    }

    /// Iterates over the positions and the times of adjacent samples.
    fn steps(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let last = self.times.len().saturating_sub(1) as f64;
        let position = move |sample: usize| sample as f64 / last;
        let pairs = self.times.windows(2).enumerate();
        pairs.map(move |(sample, pair)| ([position(sample), position(sample + 1)], [pair[0], pair[1]]))
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_SAMPLES, Mark, Timeline};

    fn timeline(times: &[f64]) -> Timeline {
        let mut timeline = Timeline::default();
        timeline.set(times.len(), |index| times[index]);
        timeline
    }

    fn marks(marks: impl Iterator<Item = Mark>) -> Vec<[f64; 2]> {
        marks.map(|Mark { position, time }| [position, time].map(|part| (1e6 * part).round() / 1e6)).collect()
    }

    #[test]
    fn positions_and_indices_are_inverse() {
        let timeline = timeline(&[0.0, 1.0, 2.0, 3.0, 4.0]);
        for index in 0..5 {
            assert_eq!(timeline.index(timeline.position(index)), index);
            assert_eq!(timeline.time(timeline.position(index)), Some(index as f64));
        }
        assert_eq!((timeline.index(-1.0), timeline.index(0.6), timeline.index(7.0)), (0, 2, 4));
        assert_eq!(timeline.time(0.125), Some(0.5));
    }

    #[test]
    fn ticks_are_at_multiples_of_the_interval() {
        let steps: Vec<f64> = (0..=50).map(|step| 0.1 + f64::from(step) * 0.01).collect();
        assert_eq!(marks(timeline(&steps).ticks(0.2)), [[0.2, 0.2], [0.6, 0.4], [1.0, 0.6]]);
        let uneven = timeline(&[0.0, 1.0, 4.0]);
        assert_eq!(marks(uneven.ticks(1.0)), [[0.0, 0.0], [0.5, 1.0], [0.666_667, 2.0], [0.833_333, 3.0], [1.0, 4.0]]);
    }

    #[test]
    fn time_starts_again_after_a_reset() {
        let timeline = timeline(&[0.0, 1.0, 2.0, 0.0, 1.0]);
        assert_eq!(marks(timeline.resets()), [[0.75, 0.0]]);
        assert_eq!(marks(timeline.ticks(1.0)), [[0.0, 0.0], [0.25, 1.0], [0.5, 2.0], [1.0, 1.0]]);
        assert_eq!(timeline.duration(), 3.0);
        assert_eq!((timeline.time(0.6), timeline.time(0.7)), (Some(2.0), Some(0.0)));
        assert_eq!((timeline.find(1.5), timeline.find(3.0)), (Some(0.375), None));
    }

    #[test]
    fn many_states_have_the_times_of_some() {
        let times: Vec<f64> = (0..12_345).map(|index| 0.002 * f64::from(index)).collect();
        let timeline = timeline(&times);
        assert_eq!((timeline.len(), timeline.times.len()), (12_345, MAX_SAMPLES));
        for position in [0.0, 0.1, 0.777, 1.0] {
            let exact = times[timeline.index(position)];
            assert!((timeline.time(position).unwrap() - exact).abs() < 0.002);
        }
    }

    #[test]
    fn empty_and_invalid_times_have_no_ticks() {
        for times in [&[][..], &[1.0], &[f64::NAN, 1.0], &[0.0, f64::INFINITY], &[f64::NAN; 4]] {
            let timeline = timeline(times);
            assert_eq!(timeline.ticks(1.0).count(), 0, "{times:?}");
            assert!(timeline.index(0.3) < times.len().max(1));
        }
    }
}
