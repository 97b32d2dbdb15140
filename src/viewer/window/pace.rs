//! When a window is drawn: when something has changed, and not more often than the screen shows.

use std::time::{Duration, Instant};

/// Frames of a screen that does not tell how often it shows one, per second.
const USUAL_RATE: f64 = 60.0;

/// A window that was not drawn for so long, in s, has rested.
const REST: f64 = 0.5;

#[derive(Debug)]
pub(super) struct Pace {
    /// The least time between two frames.
    interval: Duration,
    last: Option<Instant>,
    /// When there is something new to be seen.
    due: Option<Instant>,
    /// The time between frames, averaged.
    average: Option<f64>,
}

impl Pace {
    /// For a screen that shows so many frames per second.
    pub fn new(rate: Option<f64>) -> Self {
        let rate = rate.filter(|rate| (1.0..=1000.0).contains(rate)).unwrap_or(USUAL_RATE);
        Self { interval: Duration::from_secs_f64(1.0 / rate), last: None, due: None, average: None }
    }

    /// Something has changed.
    pub fn ask(&mut self, now: Instant) {
        self.ask_after(now, Duration::ZERO);
    }

    /// Something will have changed.
    pub fn ask_after(&mut self, now: Instant, delay: Duration) {
        // As good as never.
        let Some(wanted) = now.checked_add(delay).filter(|_| delay < Duration::from_secs(3600)) else { return };
        let wanted = self.last.map_or(wanted, |last| wanted.max(last + self.interval));
        self.due = Some(self.due.map_or(wanted, |due| due.min(wanted)));
    }

    /// When to draw next, if ever.
    pub fn due(&self) -> Option<Instant> {
        self.due
    }

    /// A frame begins.
    pub fn drawn(&mut self, now: Instant) {
        if let Some(last) = self.last {
            let passed = now.saturating_duration_since(last).as_secs_f64();
            // A window that rested was not slow.
            if passed < REST {
                self.average = Some(self.average.map_or(passed, |average| 0.9 * average + 0.1 * passed));
            } else {
                self.average = None;
            }
        }
        self.last = Some(now);
        self.due = None;
    }

    /// Frames per second lately, if it was drawn all the time.
    pub fn rate(&self) -> Option<f64> {
        self.average.filter(|average| *average > 0.0).map(|average| 1.0 / average)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_drawn_when_something_changed_and_not_before_the_screen_can_show_it() {
        let mut pace = Pace::new(Some(50.0));
        let start = Instant::now();
        assert_eq!(pace.due(), None);
        pace.ask(start);
        assert_eq!(pace.due(), Some(start));
        pace.drawn(start);
        assert_eq!(pace.due(), None);
        pace.ask(start + Duration::from_millis(5));
        assert_eq!(pace.due(), Some(start + Duration::from_millis(20)));
        pace.ask_after(start, Duration::from_secs(1));
        assert_eq!(pace.due(), Some(start + Duration::from_millis(20)), "the sooner one counts");
    }

    #[test]
    fn never_is_never() {
        let mut pace = Pace::new(None);
        pace.ask_after(Instant::now(), Duration::MAX);
        assert_eq!(pace.due(), None);
    }

    #[test]
    fn a_rate_is_that_of_frames_in_a_row() {
        let mut pace = Pace::new(None);
        let start = Instant::now();
        for frame in 0..100 {
            pace.drawn(start + Duration::from_millis(25) * frame);
        }
        assert!((pace.rate().unwrap() - 40.0).abs() < 1e-6);
        pace.drawn(start + Duration::from_secs(60));
        assert_eq!(pace.rate(), None, "after a rest nothing is known");
    }
}
