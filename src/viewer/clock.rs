//! Real time: when the next step is due.

use std::time::Duration;

/// How far a simulation may fall behind real time and catch up, s. What is more is given up, so that a simulation which is slower
/// than real time does not run after it for ever.
const MOST_BEHIND: f64 = 0.1;

/// How long the speed is measured before it is told anew.
const WINDOW: Duration = Duration::from_millis(500);

/// When the next step is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Due {
    Now,
    At(Duration),
}

/// Keeps simulated time at a multiple of real time. Real time is what the caller says: any clock's, since whenever.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock {
    /// Where both times were the same, unless it stands.
    since: Option<Since>,
    meter: Meter,
    dropped: f64,
}

#[derive(Clone, Debug)]
struct Since {
    now: Duration,
    speed: f64,
    /// Simulated since then, s.
    simulated: f64,
}

impl Clock {
    /// When the next step is due, at a speed: simulated over real time. It begins where it stood; a new speed counts from now.
    pub fn due(&mut self, now: Duration, speed: f64) -> Due {
        let fresh = Since { now, speed, simulated: 0.0 };
        let Some(since) = self.since.as_mut().filter(|since| since.speed == speed) else {
            self.since = Some(fresh);
            self.meter.add(0.0, now);
            return Due::Now;
        };
        let ahead = since.simulated / speed - now.saturating_sub(since.now).as_secs_f64();
        if ahead < -MOST_BEHIND {
            self.dropped += -ahead;
            *since = fresh;
            return Due::Now;
        }
        // A duration has no less than a nanosecond.
        if ahead < 1e-9 {
            return Due::Now;
        }
        // Nobody waits for longer; and the sum must not overflow.
        Due::At(now + Duration::from_secs_f64(ahead.min(3600.0)))
    }

    /// A step of this simulated duration was taken, s.
    pub fn stepped(&mut self, simulated: f64, now: Duration) {
        if let Some(since) = &mut self.since {
            since.simulated += simulated;
        }
        self.meter.add(simulated, now);
    }

    /// It stands.
    pub fn stop(&mut self) {
        (self.since, self.meter) = (None, Meter::default());
    }

    /// Simulated over real time, as measured in the last half second. Zero before it is known.
    pub fn measured(&self) -> f64 {
        self.meter.measured()
    }

    /// How much real time was given up, s.
    pub fn dropped(&self) -> f64 {
        self.dropped
    }
}

/// Measures simulated over real time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    start: Option<Duration>,
    simulated: f64,
    measured: f64,
}

impl Meter {
    /// So much was simulated, s. The first call begins.
    pub fn add(&mut self, simulated: f64, now: Duration) {
        let start = *self.start.get_or_insert(now);
        self.simulated += simulated;
        let passed = now.saturating_sub(start);
        if passed >= WINDOW {
            self.measured = self.simulated / passed.as_secs_f64();
            (self.start, self.simulated) = (Some(now), 0.0);
        }
    }

    /// As measured in the last half second. Zero before it is known.
    pub fn measured(&self) -> f64 {
        self.measured
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{Clock, Due};

    /// Runs for so many real seconds a simulation whose steps of 2 ms take `cost` seconds of real time; tells the simulated time.
    fn run(clock: &mut Clock, now: &mut Duration, seconds: f64, speed: f64, cost: f64) -> f64 {
        let end = *now + Duration::from_secs_f64(seconds);
        let mut simulated = 0.0;
        while *now < end {
            match clock.due(*now, speed) {
                Due::Now => {
                    *now += Duration::from_secs_f64(cost);
                    clock.stepped(0.002, *now);
                    simulated += 0.002;
                }
                Due::At(at) => *now = at,
            }
        }
        simulated
    }

    #[test]
    fn simulated_time_goes_at_the_wanted_multiple_of_real_time() {
        for speed in [0.01, 0.1, 1.0, 2.0, 8.0] {
            let (mut clock, mut now) = (Clock::default(), Duration::from_secs(100));
            let simulated = run(&mut clock, &mut now, 5.0, speed, 1e-4);
            assert!((simulated / (5.0 * speed) - 1.0).abs() < 0.05, "{simulated} at {speed}");
            assert!((clock.measured() / speed - 1.0).abs() < 0.1, "{} at {speed}", clock.measured());
            assert_eq!(clock.dropped(), 0.0);
        }
    }

    #[test]
    fn a_short_delay_is_caught_up_with() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        let mut simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        now += Duration::from_millis(90);
        simulated += run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - now.as_secs_f64()).abs() < 0.003, "{simulated} after {now:?}");
        assert_eq!(clock.dropped(), 0.0);
    }

    #[test]
    fn a_long_delay_is_given_up() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        now += Duration::from_secs(10);
        let simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - 1.0).abs() < 0.01, "{simulated}");
        assert!((clock.dropped() - 10.0).abs() < 0.01, "{}", clock.dropped());
    }

    #[test]
    fn what_is_slower_than_real_time_never_has_more_than_the_limit_to_catch_up_with() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        let simulated = run(&mut clock, &mut now, 20.0, 1.0, 0.004);
        assert!((simulated - 10.0).abs() < 0.01, "{simulated}");
        assert!((clock.measured() - 0.5).abs() < 0.01);
        // As soon as it is fast enough, it is in time at once: 0.1 s are caught up with, not 10.
        let after = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((1.0..1.11).contains(&after), "{after}");
    }

    #[test]
    fn another_speed_counts_from_the_moment_it_is_set() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 2.0, 1.0, 1e-4);
        let slow = run(&mut clock, &mut now, 2.0, 0.1, 1e-4);
        assert!((slow - 0.2).abs() < 0.005, "{slow}");
    }

    #[test]
    fn what_stood_has_nothing_to_catch_up_with() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        clock.stop();
        assert_eq!(clock.measured(), 0.0);
        now += Duration::from_millis(80);
        let simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - 1.0).abs() < 0.004, "{simulated}");
        assert_eq!(clock.dropped(), 0.0);
    }

    #[test]
    fn a_step_that_is_longer_than_the_limit_keeps_its_time() {
        let (mut clock, mut now) = (Clock::default(), Duration::ZERO);
        let mut steps = 0;
        while now < Duration::from_secs(60) {
            match clock.due(now, 1.0) {
                Due::Now => {
                    clock.stepped(0.5, now);
                    steps += 1;
                }
                Due::At(at) => now = at,
            }
        }
        assert!((120..=121).contains(&steps), "{steps}");
    }
}
