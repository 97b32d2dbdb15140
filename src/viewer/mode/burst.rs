//! Other moments of a trajectory in the same picture: which, and how they look.

use std::ops::RangeInclusive;

/// How other moments of a trajectory are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    pub on: bool,
    /// Past moments red, future ones blue.
    pub doppler: bool,
    /// How many there are, and how slowly they fade with their distance in time. Each from 1 to 40; a touchpad turns them by
    /// fractions, which add up.
    pub factor: f64,
    pub gamma: f64,
}

impl Default for Burst {
    fn default() -> Self {
        Self { on: false, doppler: false, factor: 20.0, gamma: 20.0 }
    }
}

/// A trajectory, as far as its moments are concerned: how many records it has, and the time from one to the next, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Records {
    pub count: usize,
    pub interval: f64,
}

impl Burst {
    /// What `factor` and `gamma` may be.
    pub const NOTCHES: RangeInclusive<f64> = 1.0..=40.0;

    /// Turned by so many notches.
    pub fn turned(value: f64, notches: f64) -> f64 {
        if notches.is_finite() { (value + notches).clamp(*Self::NOTCHES.start(), *Self::NOTCHES.end()) } else { value }
    }

    /// Where a value is between the least and the largest notch: 0 to 1.
    fn fraction(value: f64) -> f64 {
        (value.round() - Self::NOTCHES.start()) / (Self::NOTCHES.end() - Self::NOTCHES.start())
    }

    /// Which records are shown besides `present`: spread over the whole trajectory, at most `room` of them.
    pub(super) fn moments(&self, records: Records, present: usize, room: usize) -> impl Iterator<Item = usize> {
        let Records { count, interval } = records;
        // At the most one every 20 ms, so that as many fit in a second whatever the step.
        let most = (50.0 * (count as f64 / 100.0) * (interval / 0.01)).round().max(1.0);
        let wanted = 1.0 + Self::fraction(self.factor) * (most - 1.0);
        let number = (wanted.round() as usize).min(count).min(room);
        let spacing = if number > 1 { (count - 1) as f64 / (number - 1) as f64 } else { 0.0 };
        (0..number).map(move |index| (index as f64 * spacing).round() as usize).filter(move |&record| record != present)
    }

    /// How a geom of another moment looks: by how much of its opacity, red and blue are multiplied. Green is gone where there
    /// are red and blue.
    pub(super) fn shade(&self, rgba: [f32; 4], records: Records, present: usize, record: usize) -> [f32; 4] {
        let [mut r, mut g, mut b, a] = rgba;
        let distance = record.abs_diff(present) as f64;
        let slowest = 0.85_f64.powf(records.interval / 0.01);
        let gamma = slowest + Self::fraction(self.gamma) * (1.0 - slowest);
        if self.doppler {
            // From a half next to the present moment to a whole at the ends.
            let (ahead, whole) =
                if record < present { (false, present + 1) } else { (true, records.count.saturating_sub(present)) };
            let beta = ((distance + 1.0) / whole.max(1) as f64 / 2.0 + 0.5).min(1.0) as f32;
            let (red, blue) = if ahead { (1.0 - beta, beta) } else { (beta, 1.0 - beta) };
            (r, g, b) = (r * red, 0.0, b * blue);
        }
        [r, g, b, a * gamma.powf(distance) as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::{Burst, Records};

    fn with(factor: f64, gamma: f64) -> Burst {
        Burst { on: true, factor, gamma, ..Burst::default() }
    }

    #[test]
    fn moments_are_spread_from_the_first_to_the_last_record() {
        let records = Records { count: 100, interval: 0.01 };
        let all: Vec<_> = with(40.0, 20.0).moments(records, 7, 1000).collect();
        assert_eq!((all.first(), all.last()), (Some(&0), Some(&99)));
        assert_eq!(all.len(), 50);
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(with(1.0, 20.0).moments(records, 7, 1000).collect::<Vec<_>>(), [0]);
        assert!(!with(40.0, 20.0).moments(records, 99, 1000).any(|record| record == 99));
    }

    #[test]
    fn no_trajectory_is_too_short_and_no_scene_too_full() {
        for count in 1..20 {
            for interval in [1e-4, 0.01, 0.1, 10.0] {
                for factor in [1.0, 2.5, 20.0, 40.0] {
                    for room in [0, 1, 3, 1000] {
                        let moments: Vec<_> =
                            with(factor, 20.0).moments(Records { count, interval }, 0, room).collect();
                        assert!(moments.iter().all(|&record| record < count), "{moments:?} of {count}");
                        assert!(moments.len() <= room.min(count));
                        assert!(moments.windows(2).all(|pair| pair[0] < pair[1]), "{moments:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn opacity_fades_with_the_distance_in_time() {
        let records = Records { count: 100, interval: 0.01 };
        let opacity = |gamma, record| with(20.0, gamma).shade([1.0, 1.0, 1.0, 0.8], records, 50, record)[3];
        assert!((opacity(1.0, 51) - 0.8 * 0.85).abs() < 1e-6);
        assert!((opacity(1.0, 48) - 0.8 * 0.85 * 0.85).abs() < 1e-6);
        assert_eq!(opacity(40.0, 99), 0.8);
        assert_eq!(with(20.0, 1.0).shade([0.1, 0.2, 0.3, 1.0], records, 50, 51)[..3], [0.1, 0.2, 0.3]);
    }

    #[test]
    fn doppler_makes_the_past_red_and_the_future_blue() {
        let records = Records { count: 11, interval: 0.01 };
        let burst = Burst { doppler: true, ..with(40.0, 40.0) };
        let shade = |record| burst.shade([1.0, 1.0, 1.0, 1.0], records, 5, record);
        let [r, g, b, _] = shade(0);
        assert!((r, g, b) == (1.0, 0.0, 0.0), "{:?}", shade(0));
        let [r, g, b, _] = shade(10);
        assert!((r, g, b) == (0.0, 0.0, 1.0), "{:?}", shade(10));
        let ([past, _, _, _], [older, _, _, _]) = (shade(4), shade(2));
        assert!(0.5 < past && past < older && older < 1.0);
    }

    #[test]
    fn notches_are_clamped_and_may_be_fractions() {
        assert_eq!(Burst::turned(20.0, 0.25), 20.25);
        assert_eq!(Burst::turned(39.5, 7.0), 40.0);
        assert_eq!(Burst::turned(1.0, -0.1), 1.0);
        assert_eq!(Burst::turned(5.0, f64::NAN), 5.0);
    }
}
