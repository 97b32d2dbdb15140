//! Which picture belongs to which frame.

use crate::error::{Error, Result};

/// Turns simulation times into frame numbers. Frame `n` shows the first picture from `n` intervals after the start on, so that
/// errors do not add up; where there is none for more than an interval, the picture before stays.
#[derive(Debug)]
pub(super) struct Clock {
    /// From one frame to the next, s of the simulation.
    interval: f64,
    /// The picture that was taken last.
    last: Option<Taken>,
}

#[derive(Clone, Copy, Debug)]
struct Taken {
    time: f64,
    frame: u64,
    /// When frame 0 would have been.
    start: f64,
}

impl Clock {
    /// Sums of timesteps are a little off: so much of an interval may be missing.
    const TOLERANCE: f64 = 1e-3;
    /// A longer gap between two pictures is taken for a mistake.
    const LONGEST_GAP: f64 = 100_000.0;

    pub(super) fn new(interval: f64) -> Self {
        Self { interval, last: None }
    }

    pub(super) fn is_due(&self, time: f64) -> bool {
        self.last.is_none_or(|last| time < last.time || self.frame(last, time) >= last.frame as f64 + 1.0)
    }

    /// Takes a picture that is due. Returns for how many frames the one before was shown.
    pub(super) fn take(&mut self, time: f64) -> Result<u64> {
        let Some(last) = self.last else {
            self.last = Some(Taken { time, frame: 0, start: time });
            return Ok(0);
        };
        if time < last.time {
            // The simulation was reset: the recording goes on.
            let frame = last.frame + 1;
            self.last = Some(Taken { time, frame, start: time - frame as f64 * self.interval });
            return Ok(1);
        }
        let shown = self.gap(last, time)?;
        self.last = Some(Taken { time, frame: last.frame + shown, ..last });
        Ok(shown)
    }

    /// Returns the number of frames that the last picture is shown for if the recording ends at this time: at least one.
    pub(super) fn until(&self, time: f64) -> Result<u64> {
        match self.last {
            Some(last) if time >= last.time => Ok(self.gap(last, time)?.max(1)),
            // The simulation was reset, or there is no picture.
            _ => Ok(1),
        }
    }

    /// Returns the number of frames from the last picture to this time.
    fn gap(&self, last: Taken, time: f64) -> Result<u64> {
        let frames = self.frame(last, time) - last.frame as f64;
        if frames <= Self::LONGEST_GAP {
            return Ok(frames as u64);
        }
        Err(Error::invalid(
            "the time of a picture",
            format!("{time} s"),
            format!("at most {} s after the one before", Self::LONGEST_GAP * self.interval),
        ))
    }

    fn frame(&self, last: Taken, time: f64) -> f64 {
        ((time - last.start) / self.interval + Self::TOLERANCE).floor()
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;

    /// For each frame the time of the picture that it shows.
    fn frames(clock: &mut Clock, times: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let (mut shown, mut held) = (Vec::new(), None);
        for time in times {
            if clock.is_due(time) {
                let count = clock.take(time).unwrap();
                shown.extend(held.into_iter().flat_map(|held| std::iter::repeat_n(held, count as usize)));
                held = Some(time);
            }
        }
        shown.extend(held);
        shown
    }

    #[test]
    fn steps_that_do_not_divide_a_frame_do_not_add_up() {
        let times = (0..=2000).map(|step| f64::from(step) * 0.005);
        let shown = frames(&mut Clock::new(1.0 / 30.0), times);
        assert_eq!(shown.len(), 301);
        for (frame, time) in shown.iter().enumerate() {
            let late = time - frame as f64 / 30.0;
            assert!((-1e-4..0.005 + 1e-9).contains(&late), "frame {frame} is {late} s late");
        }
    }

    #[test]
    fn times_that_are_sums_of_timesteps_are_not_a_step_late() {
        let mut time = 0.0;
        let sums = (0..5000).map(|_| {
            time += 0.002;
            time
        });
        let shown = frames(&mut Clock::new(0.02), sums);
        assert_eq!(shown.len(), 500);
        assert!((shown[499] - (0.002 + 499.0 * 0.02)).abs() < 1e-9);
    }

    #[test]
    fn long_steps_repeat_pictures_and_a_reset_goes_on() {
        assert_eq!(frames(&mut Clock::new(0.1), [0.0, 0.25, 0.3]), [0.0, 0.0, 0.25, 0.3]);
        assert_eq!(frames(&mut Clock::new(0.1), [5.0, 5.1, 0.0, 0.05, 0.1]), [5.0, 5.1, 0.0, 0.1]);
    }

    #[test]
    fn the_last_picture_lasts_until_the_end() {
        let mut clock = Clock::new(0.1);
        assert_eq!(clock.until(5.0).unwrap(), 1, "there is no picture");
        clock.take(2.0).unwrap();
        let frames = [0.0, 2.0, 2.05, 2.1, 2.15, 5.0].map(|time| clock.until(time).unwrap());
        assert_eq!(frames, [1, 1, 1, 1, 1, 30]);
        clock.until(1e9).unwrap_err();
    }

    #[test]
    fn a_leap_in_time_is_an_error_and_changes_nothing() {
        let mut clock = Clock::new(0.1);
        clock.take(0.0).unwrap();
        clock.take(1e9).unwrap_err();
        clock.take(f64::MAX).unwrap_err();
        assert_eq!(clock.take(0.1).unwrap(), 1);
    }
}
