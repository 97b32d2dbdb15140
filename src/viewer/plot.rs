//! Numbers over time, for plots.

use std::collections::VecDeque;

use super::snapshot::Snapshot;
use crate::data::{Timer, TimerCount};

/// How many points a curve has at most.
const MOST_POINTS: usize = 1000;

/// A curve: the newest points of a number over simulated time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub name: String,
    points: VecDeque<[f64; 2]>,
}

impl Curve {
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), points: VecDeque::with_capacity(MOST_POINTS) }
    }

    /// Adds a point. Where time went back, what was after it is forgotten; what is no number leaves a gap.
    pub fn push(&mut self, time: f64, value: f64) {
        while self.points.back().is_some_and(|[last, _]| *last >= time) {
            self.points.pop_back();
        }
        if self.points.len() == MOST_POINTS {
            self.points.pop_front();
        }
        self.points.push_back([time, value]);
    }

    /// The points, the oldest first.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.points.iter().copied()
    }
}

/// The curves of a viewer, fed from snapshots.
#[derive(Debug, Default)]
pub(crate) struct Plots {
    begun: bool,
    generation: u64,
    /// Readings of the sensors, by their names and where there are several numbers an index.
    pub sensors: Vec<Curve>,
    /// Potential, kinetic and total energy, J.
    pub energy: Vec<Curve>,
    /// The solver's iterations and constraints, and the logarithm of its last improvement.
    pub solver: Vec<Curve>,
    /// How long parts of a step take, ms.
    pub timing: Vec<Curve>,
    /// What the user watches.
    pub watched: Vec<Curve>,
    timers: [TimerCount; Timer::ALL.len()],
}

impl Plots {
    /// The parts of a step whose time is plotted.
    const TIMED: [(Timer, &'static str); 5] = [
        (Timer::Step, "step"),
        (Timer::Position, "position"),
        (Timer::PositionCollision, "collision"),
        (Timer::Velocity, "velocity"),
        (Timer::Constraint, "constraint"),
    ];

    /// Adds what a new snapshot says. `watched` are the names of what it watches.
    pub fn take(&mut self, snapshot: &Snapshot, watched: impl ExactSizeIterator<Item = String>) {
        if !self.begun || self.generation != snapshot.generation {
            self.begin(snapshot);
        }
        let time = snapshot.time;
        for (curve, value) in self.sensors.iter_mut().zip(&snapshot.sensordata) {
            curve.push(time, *value);
        }
        let [potential, kinetic] = snapshot.energy;
        for (curve, value) in self.energy.iter_mut().zip([potential, kinetic, potential + kinetic]) {
            curve.push(time, value);
        }
        let improvement = snapshot.solver.last().map_or(f64::NAN, |last| last.improvement.log10());
        let solver = [snapshot.solver.len() as f64, snapshot.nefc as f64, improvement];
        for (curve, value) in self.solver.iter_mut().zip(solver) {
            curve.push(time, value);
        }
        self.take_timers(snapshot);
        if self.watched.len() != snapshot.watched.len() {
            self.watched.clear();
        }
        for (index, (name, value)) in watched.zip(&snapshot.watched).enumerate() {
            match self.watched.get_mut(index) {
                Some(curve) if curve.name == name => {}
                Some(curve) => *curve = Curve::new(name),
                None => self.watched.push(Curve::new(name)),
            }
            self.watched[index].push(time, *value);
        }
    }

    fn begin(&mut self, snapshot: &Snapshot) {
        let curves = |names: &[&str]| names.iter().copied().map(Curve::new).collect();
        let mut sensors = Vec::with_capacity(snapshot.sensordata.len());
        for sensor in snapshot.model.sensors() {
            let name = sensor.name().map_or_else(|| format!("sensor {}", sensor.index()), str::to_owned);
            let range = sensor.data_range();
            sensors.extend(range.clone().map(|index| match range.len() {
                1 => Curve::new(name.clone()),
                _ => Curve::new(format!("{name}[{}]", index - range.start)),
            }));
        }
        *self = Self {
            begun: true,
            generation: snapshot.generation,
            sensors,
            energy: curves(&["potential", "kinetic", "total"]),
            solver: curves(&["iterations", "constraints", "log10(improvement)"]),
            timing: curves(&Self::TIMED.map(|(_, name)| name)),
            watched: Vec::new(),
            timers: snapshot.timers,
        };
    }

    /// The mean time of each part since the snapshot before, ms.
    fn take_timers(&mut self, snapshot: &Snapshot) {
        for (curve, (timer, _)) in self.timing.iter_mut().zip(Self::TIMED) {
            let index = Timer::ALL.iter().position(|other| *other == timer).expect("Bug: a timer that there is not");
            let (now, before) = (snapshot.timers[index], self.timers[index]);
            // After a reset they begin anew.
            let before = if now.number < before.number { TimerCount::default() } else { before };
            let number = now.number - before.number;
            if number > 0 {
                curve.push(snapshot.time, 1e3 * (now.duration - before.duration) / number as f64);
            }
        }
        self.timers = snapshot.timers;
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, MOST_POINTS, Plots};
    use crate::viewer::handle::Handle;
    use crate::viewer::link::link;
    use crate::viewer::request::Request;
    use crate::viewer::watch::Watch;
    use crate::{Data, EnableFlags, sample};

    #[test]
    fn a_curve_keeps_the_newest_points_and_forgets_what_was_undone() {
        let mut curve = Curve::new("x");
        for index in 0..3 * MOST_POINTS {
            curve.push(index as f64, -(index as f64));
        }
        assert_eq!(curve.points().len(), MOST_POINTS);
        assert_eq!(curve.points().next(), Some([2.0 * MOST_POINTS as f64, -2.0 * MOST_POINTS as f64]));
        // Back in time, as after steps back.
        let back = 2.5 * MOST_POINTS as f64;
        curve.push(back, 7.0);
        assert_eq!((curve.points().len(), curve.points().last()), (MOST_POINTS / 2 + 1, Some([back, 7.0])));
        curve.push(0.0, 1.0);
        assert_eq!(curve.points().collect::<Vec<_>>(), [[0.0, 1.0]]);
    }

    #[test]
    fn curves_follow_the_simulation_and_have_its_names() {
        let (mut front, back) = link(|| ());
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.edit_model(|model| model.options(|options| options.enable |= EnableFlags::ENERGY)).unwrap().unwrap();
        data.reset_to_key("stand").unwrap();
        let (mut handle, mut plots) = (Handle::new(back), Plots::default());
        let mut watches: Vec<Watch> = vec!["qpos[2]".parse().unwrap(), "time".parse().unwrap()];
        front.ask(Request::Watch(watches.clone()));
        let mut heights = Vec::new();
        for step in 0..20 {
            if step == 10 {
                watches.truncate(1);
                front.ask(Request::Watch(watches.clone()));
            }
            handle.sync(&mut data).unwrap();
            heights.push([data.time(), data.qpos()[2]]);
            let snapshot = front.latest().unwrap().0;
            plots.take(snapshot, watches.iter().map(Watch::to_string));
            data.step().unwrap();
        }
        let [potential, kinetic, total] = &plots.energy[..] else { panic!("three energies") };
        let [potential, kinetic, total] = [potential, kinetic, total].map(|curve| curve.points().last().unwrap()[1]);
        assert_eq!(total, potential + kinetic);
        assert!(potential > 0.0);
        assert_eq!(plots.sensors.len(), data.model().nsensordata());
        assert_eq!(plots.solver.len(), 3);
        let [height] = &plots.watched[..] else { panic!("one is watched") };
        assert_eq!(height.name, "qpos[2]");
        assert_eq!(height.points().collect::<Vec<_>>(), heights[10..]);
        // Another model has other sensors.
        let mut other = Data::new(sample::cartpole()).unwrap();
        handle.sync(&mut other).unwrap();
        plots.take(front.latest().unwrap().0, std::iter::empty());
        assert_eq!(plots.sensors.len(), other.model().nsensordata());
        assert_eq!(plots.energy[0].points().len(), 1);
    }
}
