//! Scheduling of the frames of a window, and of passes of the panels between them: a frame follows
//! each change, at most at the refresh rate of the screen. A pass determines if the panels have
//! changed, for example after a motion of the pointer.

use std::time::{Duration, Instant};

/// Refresh rate of a screen that does not report it, Hz.
const DEFAULT_RATE: f64 = 60.0;

/// Time without a frame after which the window counts as idle.
const IDLE_TIME: Duration = Duration::from_millis(500);

/// Scheduler of the frames of a window.
#[derive(Debug)]
pub(super) struct FrameScheduler {
    /// Minimum time between two frames.
    interval: Duration,
    last: Option<Instant>,
    /// End of the last frame.
    finished: Option<Instant>,
    /// Time of the next frame, if one was requested.
    due: Option<Instant>,
    last_pass: Option<Instant>,
    /// Time of the next pass of the panels, if one was requested.
    pass_due: Option<Instant>,
    /// Moving average of the time between frames, s.
    average: Option<f64>,
}

impl FrameScheduler {
    /// Creates a scheduler for a screen with this refresh rate, in Hz.
    pub fn new(rate: Option<f64>) -> Self {
        let rate = rate.filter(|rate| (1.0..=1000.0).contains(rate)).unwrap_or(DEFAULT_RATE);
        Self {
            interval: Duration::from_secs_f64(1.0 / rate),
            last: None,
            finished: None,
            due: None,
            last_pass: None,
            pass_due: None,
            average: None,
        }
    }

    /// Requests a frame as soon as possible.
    pub fn request(&mut self, now: Instant) {
        self.request_after(now, Duration::ZERO);
    }

    /// Requests a frame after a delay.
    pub fn request_after(&mut self, now: Instant, delay: Duration) {
        // Delays of an hour or more mean never.
        let Some(time) = now.checked_add(delay).filter(|_| delay < Duration::from_secs(3600)) else { return };
        let time = self.last.map_or(time, |last| time.max(last + self.interval));
        self.due = Some(self.due.map_or(time, |due| due.min(time)));
    }

    /// Requests a pass of the panels after a delay.
    pub fn request_pass_after(&mut self, now: Instant, delay: Duration) {
        let Some(time) = now.checked_add(delay).filter(|_| delay < Duration::from_secs(3600)) else { return };
        self.pass_due = Some(self.pass_due.map_or(time, |due| due.min(time)));
    }

    /// Requests a pass of the panels that starts at least this time after the last pass.
    pub fn request_pass_spaced(&mut self, now: Instant, spacing: Duration) {
        let earliest = self.last_pass.map_or(now, |last| last + spacing);
        self.request_pass_after(now, earliest.saturating_duration_since(now));
    }

    /// Returns the time of the next frame, if one was requested.
    pub fn due(&self) -> Option<Instant> {
        self.due
    }

    /// Returns the time of the next pass of the panels, if one was requested.
    pub fn pass_due(&self) -> Option<Instant> {
        self.pass_due
    }

    /// Records a pass of the panels.
    pub fn pass_started(&mut self, now: Instant) {
        (self.last_pass, self.pass_due) = (Some(now), None);
    }

    /// Returns the time since the last pass of the panels; [`Duration::MAX`] before the first.
    pub fn since_pass(&self, now: Instant) -> Duration {
        self.last_pass.map_or(Duration::MAX, |last| now.saturating_duration_since(last))
    }

    /// Records the start of a frame.
    pub fn frame_started(&mut self, now: Instant) {
        if let Some(last) = self.last {
            let passed = now.saturating_duration_since(last).as_secs_f64();
            // An idle period does not lower the rate. A frame that takes a long time is not an idle
            // period.
            let waited = now.saturating_duration_since(self.finished.unwrap_or(last));
            if waited < IDLE_TIME {
                self.average = Some(self.average.map_or(passed, |average| 0.9 * average + 0.1 * passed));
            } else {
                self.average = None;
            }
        }
        self.last = Some(now);
        self.due = None;
    }

    /// Records the end of a frame.
    pub fn frame_finished(&mut self, now: Instant) {
        self.finished = Some(now);
    }

    /// Returns the mean frame rate, in Hz, unless the window is idle or was idle before the last
    /// frame.
    pub fn rate(&self, now: Instant) -> Option<f64> {
        let active = self.last.max(self.finished).is_some_and(|last| now.saturating_duration_since(last) < IDLE_TIME);
        self.average.filter(|average| active && *average > 0.0).map(|average| 1.0 / average)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_limited_to_the_refresh_rate() {
        let mut scheduler = FrameScheduler::new(Some(50.0));
        let start = Instant::now();
        assert_eq!(scheduler.due(), None);
        scheduler.request(start);
        assert_eq!(scheduler.due(), Some(start));
        scheduler.frame_started(start);
        assert_eq!(scheduler.due(), None);
        scheduler.request(start + Duration::from_millis(5));
        assert_eq!(scheduler.due(), Some(start + Duration::from_millis(20)));
        scheduler.request_after(start, Duration::from_secs(1));
        assert_eq!(scheduler.due(), Some(start + Duration::from_millis(20)), "the earlier request takes precedence");
    }

    #[test]
    fn infinite_delay_schedules_no_frame() {
        let mut scheduler = FrameScheduler::new(None);
        scheduler.request_after(Instant::now(), Duration::MAX);
        assert_eq!(scheduler.due(), None);
    }

    #[test]
    fn rate_is_the_mean_rate_of_consecutive_frames() {
        let mut scheduler = FrameScheduler::new(None);
        let start = Instant::now();
        for frame in 0..100 {
            scheduler.frame_started(start + Duration::from_millis(25) * frame);
        }
        let end = start + Duration::from_millis(25 * 99);
        assert!((scheduler.rate(end).unwrap() - 40.0).abs() < 1e-6);
        assert_eq!(scheduler.rate(end + IDLE_TIME), None, "the window is idle");
        scheduler.frame_started(start + Duration::from_secs(60));
        assert_eq!(scheduler.rate(start + Duration::from_secs(60)), None, "the rate is unknown after an idle period");
    }

    #[test]
    fn slow_frames_have_a_rate() {
        let mut scheduler = FrameScheduler::new(None);
        let start = Instant::now();
        for frame in 0..10 {
            let started = start + Duration::from_secs(2) * frame;
            scheduler.frame_started(started);
            scheduler.frame_finished(started + Duration::from_millis(1900));
        }
        let end = start + Duration::from_secs(18) + Duration::from_millis(1900);
        assert!((scheduler.rate(end).unwrap() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn spaced_passes_follow_the_last_pass_after_the_spacing() {
        let mut scheduler = FrameScheduler::new(Some(50.0));
        let start = Instant::now();
        let spacing = Duration::from_millis(100);
        scheduler.request_pass_spaced(start, spacing);
        assert_eq!(scheduler.pass_due(), Some(start), "the first pass is due at once");
        scheduler.pass_started(start);
        for milliseconds in [10, 30, 90] {
            scheduler.request_pass_spaced(start + Duration::from_millis(milliseconds), spacing);
            assert_eq!(scheduler.pass_due(), Some(start + spacing));
        }
        scheduler.pass_started(start + spacing);
        assert_eq!(scheduler.pass_due(), None);
        let later = start + 5 * spacing;
        scheduler.request_pass_spaced(later, spacing);
        assert_eq!((scheduler.pass_due(), scheduler.due()), (Some(later), None), "a pass is no frame");
    }
}
