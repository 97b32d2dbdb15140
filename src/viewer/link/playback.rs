//! State of the playback of trajectories.

use std::ops::RangeInclusive;

/// State of the playback for the panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaybackState {
    /// Index of the current record in its trajectory, from 0.
    pub frame: usize,
    /// Number of records of the trajectory.
    pub frames: usize,
    /// Index of the current trajectory, from 0.
    pub trajectory: usize,
    /// Number of trajectories.
    pub trajectories: usize,
    pub reversed: bool,
    pub burst: Burst,
}

/// Display of several records of a trajectory in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    pub on: bool,
    /// Shades past records red and future records blue.
    pub doppler: bool,
    /// Number of records, on a scale from 1 to 40. A touchpad changes it by fractions.
    pub factor: f64,
    /// Time constant of the fading, on a scale from 1 to 40. A touchpad changes it by fractions.
    pub gamma: f64,
}

impl Default for Burst {
    fn default() -> Self {
        Self { on: false, doppler: false, factor: 20.0, gamma: 20.0 }
    }
}

/// Sampling of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sampling {
    /// Number of records.
    pub count: usize,
    /// Mean time between records, s.
    pub interval: f64,
}

impl Burst {
    /// Range of `factor` and `gamma`.
    pub const RANGE: RangeInclusive<f64> = 1.0..=40.0;

    /// Returns `factor` or `gamma` after a turn of the mouse wheel.
    pub fn adjusted(value: f64, notches: f64) -> f64 {
        if notches.is_finite() { (value + notches).clamp(*Self::RANGE.start(), *Self::RANGE.end()) } else { value }
    }

    /// Maps a value from its range to 0..1.
    fn fraction(value: f64) -> f64 {
        (value.round() - Self::RANGE.start()) / (Self::RANGE.end() - Self::RANGE.start())
    }

    /// Returns the records that are shown besides `present`: at most `room`, evenly spaced over the
    /// whole trajectory.
    pub fn records(&self, sampling: Sampling, present: usize, room: usize) -> impl Iterator<Item = usize> {
        let Sampling { count, interval } = sampling;
        // The maximum is one record every 20 ms, for any time step.
        let most = (50.0 * (count as f64 / 100.0) * (interval / 0.01)).round().max(1.0);
        let wanted = 1.0 + Self::fraction(self.factor) * (most - 1.0);
        let number = (wanted.round() as usize).min(count).min(room);
        let spacing = if number > 1 { (count - 1) as f64 / (number - 1) as f64 } else { 0.0 };
        (0..number).map(move |index| (index as f64 * spacing).round() as usize).filter(move |&record| record != present)
    }

    /// Returns the colour of a geom of another record: opacity fades with the distance in time, and
    /// the Doppler effect scales red and blue and removes green.
    pub fn shade(&self, rgba: [f32; 4], sampling: Sampling, present: usize, record: usize) -> [f32; 4] {
        let [mut r, mut g, mut b, a] = rgba;
        let distance = record.abs_diff(present) as f64;
        let slowest = 0.85_f64.powf(sampling.interval / 0.01);
        let gamma = slowest + Self::fraction(self.gamma) * (1.0 - slowest);
        if self.doppler {
            // From one half next to the current record to one at the ends of the trajectory.
            let (ahead, whole) =
                if record < present { (false, present + 1) } else { (true, sampling.count.saturating_sub(present)) };
            let beta = ((distance + 1.0) / whole.max(1) as f64 / 2.0 + 0.5).min(1.0) as f32;
            let (red, blue) = if ahead { (1.0 - beta, beta) } else { (beta, 1.0 - beta) };
            (r, g, b) = (r * red, 0.0, b * blue);
        }
        [r, g, b, a * gamma.powf(distance) as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::{Burst, Sampling};

    fn with(factor: f64, gamma: f64) -> Burst {
        Burst { on: true, factor, gamma, ..Burst::default() }
    }

    #[test]
    fn burst_is_evenly_spaced_from_the_first_to_the_last_record() {
        let sampling = Sampling { count: 100, interval: 0.01 };
        let all: Vec<_> = with(40.0, 20.0).records(sampling, 7, 1000).collect();
        assert_eq!((all.first(), all.last()), (Some(&0), Some(&99)));
        assert_eq!(all.len(), 50);
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(with(1.0, 20.0).records(sampling, 7, 1000).collect::<Vec<_>>(), [0]);
        assert!(!with(40.0, 20.0).records(sampling, 99, 1000).any(|record| record == 99));
    }

    #[test]
    fn burst_respects_short_trajectories_and_full_scenes() {
        for count in 1..20 {
            for interval in [1e-4, 0.01, 0.1, 10.0] {
                for factor in [1.0, 2.5, 20.0, 40.0] {
                    for room in [0, 1, 3, 1000] {
                        let records: Vec<_> =
                            with(factor, 20.0).records(Sampling { count, interval }, 0, room).collect();
                        assert!(records.iter().all(|&record| record < count), "{records:?} of {count}");
                        assert!(records.len() <= room.min(count));
                        assert!(records.windows(2).all(|pair| pair[0] < pair[1]), "{records:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn opacity_fades_with_the_distance_in_time() {
        let sampling = Sampling { count: 100, interval: 0.01 };
        let opacity = |gamma, record| with(20.0, gamma).shade([1.0, 1.0, 1.0, 0.8], sampling, 50, record)[3];
        assert!((opacity(1.0, 51) - 0.8 * 0.85).abs() < 1e-6);
        assert!((opacity(1.0, 48) - 0.8 * 0.85 * 0.85).abs() < 1e-6);
        assert_eq!(opacity(40.0, 99), 0.8);
        assert_eq!(with(20.0, 1.0).shade([0.1, 0.2, 0.3, 1.0], sampling, 50, 51)[..3], [0.1, 0.2, 0.3]);
    }

    #[test]
    fn doppler_shades_the_past_red_and_the_future_blue() {
        let sampling = Sampling { count: 11, interval: 0.01 };
        let burst = Burst { doppler: true, ..with(40.0, 40.0) };
        let shade = |record| burst.shade([1.0, 1.0, 1.0, 1.0], sampling, 5, record);
        let [r, g, b, _] = shade(0);
        assert!((r, g, b) == (1.0, 0.0, 0.0), "{:?}", shade(0));
        let [r, g, b, _] = shade(10);
        assert!((r, g, b) == (0.0, 0.0, 1.0), "{:?}", shade(10));
        let ([past, _, _, _], [older, _, _, _]) = (shade(4), shade(2));
        assert!(0.5 < past && past < older && older < 1.0);
    }

    #[test]
    fn adjusted_values_are_clamped_and_may_be_fractions() {
        assert_eq!(Burst::adjusted(20.0, 0.25), 20.25);
        assert_eq!(Burst::adjusted(39.5, 7.0), 40.0);
        assert_eq!(Burst::adjusted(1.0, -0.1), 1.0);
        assert_eq!(Burst::adjusted(5.0, f64::NAN), 5.0);
    }
}
