//! Sampling of simulation times at a constant frame rate.

use crate::error::{Error, Result};

/// Converts simulation times to frame numbers.
///
/// Frame `n` shows the first image at or after `n` intervals from the start, so that rounding
/// errors do not accumulate. If images are further apart than one interval, the previous image is
/// repeated.
#[derive(Debug)]
pub(super) struct Clock {
    /// Simulation time between two frames, s.
    interval: f64,
    /// Most recently accepted image.
    last: Option<Accepted>,
}

#[derive(Clone, Copy, Debug)]
struct Accepted {
    time: f64,
    frame: u64,
    /// Simulation time of frame 0, s.
    start: f64,
}

impl Clock {
    /// Tolerance as a fraction of an interval. Sums of timesteps have rounding errors.
    const TOLERANCE: f64 = 1e-3;
    /// Longest accepted gap between two images, in frames. A longer gap is treated as an error of
    /// the caller.
    const MAX_GAP: f64 = 100_000.0;

    pub(super) fn new(interval: f64) -> Self {
        Self { interval, last: None }
    }

    pub(super) fn is_due(&self, time: f64) -> bool {
        self.last.is_none_or(|last| time < last.time || self.frame(last, time) >= last.frame as f64 + 1.0)
    }

    /// Accepts an image that is due. Returns the number of frames that show the previous image.
    pub(super) fn accept(&mut self, time: f64) -> Result<u64> {
        let Some(last) = self.last else {
            self.last = Some(Accepted { time, frame: 0, start: time });
            return Ok(0);
        };
        if time < last.time {
            // The simulation was reset. The recording continues with the next frame.
            let frame = last.frame + 1;
            self.last = Some(Accepted { time, frame, start: time - frame as f64 * self.interval });
            return Ok(1);
        }
        let shown = self.gap(last, time)?;
        self.last = Some(Accepted { time, frame: last.frame + shown, ..last });
        Ok(shown)
    }

    /// Returns the number of frames that show the last image if the recording ends at this time: at
    /// least one.
    pub(super) fn until(&self, time: f64) -> Result<u64> {
        match self.last {
            Some(last) if time >= last.time => Ok(self.gap(last, time)?.max(1)),
            // The simulation was reset, or the recording contains no image.
            _ => Ok(1),
        }
    }

    /// Returns the number of frames from the last image to this time.
    fn gap(&self, last: Accepted, time: f64) -> Result<u64> {
        let frames = self.frame(last, time) - last.frame as f64;
        if frames <= Self::MAX_GAP {
            return Ok(frames as u64);
        }
        Err(Error::out_of_range(
            "the time of an image",
            format!("{time} s"),
            format!("at most {} s after the previous image", Self::MAX_GAP * self.interval),
        ))
    }

    fn frame(&self, last: Accepted, time: f64) -> f64 {
        ((time - last.start) / self.interval + Self::TOLERANCE).floor()
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;

    /// Returns the time of the image that each frame shows.
    fn frames(clock: &mut Clock, times: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let (mut shown, mut held) = (Vec::new(), None);
        for time in times {
            if clock.is_due(time) {
                let count = clock.accept(time).unwrap();
                shown.extend(held.into_iter().flat_map(|held| std::iter::repeat_n(held, count as usize)));
                held = Some(time);
            }
        }
        shown.extend(held);
        shown
    }

    #[test]
    fn timesteps_that_do_not_divide_the_interval_accumulate_no_error() {
        let times = (0..=2000).map(|step| f64::from(step) * 0.005);
        let shown = frames(&mut Clock::new(1.0 / 30.0), times);
        assert_eq!(shown.len(), 301);
        for (frame, time) in shown.iter().enumerate() {
            let late = time - frame as f64 / 30.0;
            assert!((-1e-4..0.005 + 1e-9).contains(&late), "frame {frame} is {late} s late");
        }
    }

    #[test]
    fn rounding_errors_of_summed_timesteps_do_not_delay_a_frame() {
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
    fn long_steps_repeat_images_and_a_reset_continues_the_recording() {
        assert_eq!(frames(&mut Clock::new(0.1), [0.0, 0.25, 0.3]), [0.0, 0.0, 0.25, 0.3]);
        assert_eq!(frames(&mut Clock::new(0.1), [5.0, 5.1, 0.0, 0.05, 0.1]), [5.0, 5.1, 0.0, 0.1]);
    }

    #[test]
    fn the_last_image_is_shown_until_the_end() {
        let mut clock = Clock::new(0.1);
        assert_eq!(clock.until(5.0).unwrap(), 1, "no image was accepted");
        clock.accept(2.0).unwrap();
        let frames = [0.0, 2.0, 2.05, 2.1, 2.15, 5.0].map(|time| clock.until(time).unwrap());
        assert_eq!(frames, [1, 1, 1, 1, 1, 30]);
        clock.until(1e9).unwrap_err();
    }

    #[test]
    fn a_jump_in_time_is_an_error_without_effect() {
        let mut clock = Clock::new(0.1);
        clock.accept(0.0).unwrap();
        clock.accept(1e9).unwrap_err();
        clock.accept(f64::MAX).unwrap_err();
        assert_eq!(clock.accept(0.1).unwrap(), 1);
    }
}
