//! Synchronisation of simulated time with real time.

use std::time::Duration;

/// Maximum lag behind real time that is caught up, s. The excess is dropped, so that a simulation
/// that is slower than real time does not accumulate an unbounded lag.
const MAX_LAG: f64 = 0.1;

/// Interval over which the speed is measured.
const METER_INTERVAL: Duration = Duration::from_millis(500);

/// Time of the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Due {
    Now,
    At(Duration),
}

/// Clock that keeps simulated time at a multiple of real time. The caller provides real time, from
/// any monotonic clock.
#[derive(Clone, Debug, Default)]
pub(super) struct RealTimeClock {
    /// Start of the synchronisation; `None` while stopped.
    origin: Option<Origin>,
    meter: SpeedMeter,
    /// Real time that was dropped, s.
    dropped: f64,
}

#[derive(Clone, Debug)]
struct Origin {
    /// Real time at the origin.
    time: Duration,
    speed: f64,
    /// Time simulated since the origin, s.
    simulated: f64,
}

impl RealTimeClock {
    /// Returns the time of the next step at a speed: simulated over real time. The first call, and
    /// a call with a new speed, set the origin.
    pub fn due(&mut self, now: Duration, speed: f64) -> Due {
        let fresh = Origin { time: now, speed, simulated: 0.0 };
        let Some(origin) = self.origin.as_mut().filter(|origin| origin.speed == speed) else {
            self.origin = Some(fresh);
            self.meter.add(0.0, now);
            return Due::Now;
        };
        let ahead = origin.simulated / speed - now.saturating_sub(origin.time).as_secs_f64();
        if ahead < -MAX_LAG {
            self.dropped += -ahead;
            *origin = fresh;
            return Due::Now;
        }
        // The resolution of `Duration` is 1 ns.
        if ahead < 1e-9 {
            return Due::Now;
        }
        // The limit prevents an overflow of the sum.
        Due::At(now + Duration::from_secs_f64(ahead.min(3600.0)))
    }

    /// Records a step of this simulated duration, s.
    pub fn stepped(&mut self, simulated: f64, now: Duration) {
        if let Some(origin) = &mut self.origin {
            origin.simulated += simulated;
        }
        self.meter.add(simulated, now);
    }

    /// Stops the clock while the simulation is paused.
    pub fn stop(&mut self) {
        (self.origin, self.meter) = (None, SpeedMeter::default());
    }

    /// Returns simulated over real time, measured in the last half second. Zero before the first
    /// measurement.
    pub fn measured(&self) -> f64 {
        self.meter.measured()
    }

    /// Returns the real time that was dropped, s.
    pub fn dropped(&self) -> f64 {
        self.dropped
    }
}

/// Meter of simulated over real time.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpeedMeter {
    start: Option<Duration>,
    simulated: f64,
    measured: f64,
}

impl SpeedMeter {
    /// Adds a simulated duration, s. The first call starts the measurement.
    pub fn add(&mut self, simulated: f64, now: Duration) {
        let start = *self.start.get_or_insert(now);
        self.simulated += simulated;
        let passed = now.saturating_sub(start);
        if passed >= METER_INTERVAL {
            self.measured = self.simulated / passed.as_secs_f64();
            (self.start, self.simulated) = (Some(now), 0.0);
        }
    }

    /// Returns simulated over real time, measured in the last half second. Zero before the first
    /// measurement.
    pub fn measured(&self) -> f64 {
        self.measured
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{Due, RealTimeClock};

    /// Runs a simulation with a time step of 2 ms for a real time. A step costs `cost` seconds.
    /// Returns the simulated time, s.
    fn run(clock: &mut RealTimeClock, now: &mut Duration, seconds: f64, speed: f64, cost: f64) -> f64 {
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
    fn simulated_time_is_the_target_multiple_of_real_time() {
        for speed in [0.01, 0.1, 1.0, 2.0, 8.0] {
            let (mut clock, mut now) = (RealTimeClock::default(), Duration::from_secs(100));
            let simulated = run(&mut clock, &mut now, 5.0, speed, 1e-4);
            assert!((simulated / (5.0 * speed) - 1.0).abs() < 0.05, "{simulated} at {speed}");
            assert!((clock.measured() / speed - 1.0).abs() < 0.1, "{} at {speed}", clock.measured());
            assert_eq!(clock.dropped(), 0.0);
        }
    }

    #[test]
    fn short_delay_is_caught_up() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
        let mut simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        now += Duration::from_millis(90);
        simulated += run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - now.as_secs_f64()).abs() < 0.003, "{simulated} after {now:?}");
        assert_eq!(clock.dropped(), 0.0);
    }

    #[test]
    fn long_delay_is_dropped() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        now += Duration::from_secs(10);
        let simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - 1.0).abs() < 0.01, "{simulated}");
        assert!((clock.dropped() - 10.0).abs() < 0.01, "{}", clock.dropped());
    }

    #[test]
    fn lag_of_a_slow_simulation_is_bounded() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
        let simulated = run(&mut clock, &mut now, 20.0, 1.0, 0.004);
        assert!((simulated - 10.0).abs() < 0.01, "{simulated}");
        assert!((clock.measured() - 0.5).abs() < 0.01);
        // Once steps are fast enough, 0.1 s are caught up, not 10 s.
        let after = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((1.0..1.11).contains(&after), "{after}");
    }

    #[test]
    fn new_speed_applies_from_the_time_of_the_change() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 2.0, 1.0, 1e-4);
        let slow = run(&mut clock, &mut now, 2.0, 0.1, 1e-4);
        assert!((slow - 0.2).abs() < 0.005, "{slow}");
    }

    #[test]
    fn pause_causes_no_lag() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
        run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        clock.stop();
        assert_eq!(clock.measured(), 0.0);
        now += Duration::from_millis(80);
        let simulated = run(&mut clock, &mut now, 1.0, 1.0, 1e-4);
        assert!((simulated - 1.0).abs() < 0.004, "{simulated}");
        assert_eq!(clock.dropped(), 0.0);
    }

    #[test]
    fn time_step_longer_than_the_maximum_lag_keeps_real_time() {
        let (mut clock, mut now) = (RealTimeClock::default(), Duration::ZERO);
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
