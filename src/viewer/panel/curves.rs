//! Curves of values over simulated time.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::data::{Timer, TimerCount};
use crate::viewer::instruments::PlottedValue;
use crate::viewer::link::Snapshot;

/// Maximum number of points of a curve.
const MAX_POINTS: usize = 1000;

/// Newest points of a value over simulated time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub name: String,
    points: VecDeque<[f64; 2]>,
}

impl Curve {
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), points: VecDeque::with_capacity(MAX_POINTS) }
    }

    /// Appends a point, and removes points at or after its time, which decreases after a step back.
    /// NaN leaves a gap.
    pub fn push(&mut self, time: f64, value: f64) {
        while self.points.back().is_some_and(|[last, _]| *last >= time) {
            self.points.pop_back();
        }
        if self.points.len() == MAX_POINTS {
            self.points.pop_front();
        }
        self.points.push_back([time, value]);
    }

    /// Returns the points from the oldest to the newest.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.points.iter().copied()
    }
}

/// Plot of the instruments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct InstrumentPlot {
    pub title: Arc<str>,
    pub curves: Vec<Curve>,
}

/// Curves of all plots, updated from snapshots.
#[derive(Debug, Default)]
pub(super) struct Curves {
    /// Generation of the model; `None` before the first snapshot.
    generation: Option<u64>,
    /// Sensor readings, one curve for each element.
    pub sensors: Vec<Curve>,
    /// Potential, kinetic and total energy, J.
    pub energy: Vec<Curve>,
    /// Solver iterations, number of constraints, and the decimal logarithm of the last improvement.
    pub solver: Vec<Curve>,
    /// Computing times of the stages of a step, ms.
    pub timing: Vec<Curve>,
    /// Watched values.
    pub watched: Vec<Curve>,
    /// Plots of the instruments.
    pub instruments: Vec<InstrumentPlot>,
    timers: [TimerCount; Timer::ALL.len()],
}

impl Curves {
    /// Stages of a step whose computing time is plotted.
    const TIMED: [(Timer, &'static str); 5] = [
        (Timer::Step, "step"),
        (Timer::Position, "position"),
        (Timer::PositionCollision, "collision"),
        (Timer::Velocity, "velocity"),
        (Timer::Constraint, "constraint"),
    ];

    /// Adds the values of a new snapshot. `watched` are the names of its watched values.
    pub fn update(&mut self, snapshot: &Snapshot, watched: impl ExactSizeIterator<Item = String>) {
        if self.generation != Some(snapshot.generation) {
            self.restart(snapshot);
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
        self.update_timers(snapshot);
        self.update_instruments(time, &snapshot.plotted);
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

    /// Adds the values of the instruments. Other plots or curves than in the last snapshot replace
    /// all plots.
    fn update_instruments(&mut self, time: f64, values: &[PlottedValue]) {
        let number: usize = self.instruments.iter().map(|plot| plot.curves.len()).sum();
        let curve_of = |plots: &mut [InstrumentPlot], value: &PlottedValue| {
            let plot = plots.iter_mut().find(|plot| plot.title == value.plot)?;
            let curve = plot.curves.iter_mut().find(|curve| *curve.name == *value.name)?;
            curve.push(time, value.value);
            Some(())
        };
        let is_same = values.iter().all(|value| curve_of(&mut self.instruments, value).is_some());
        if is_same && number == values.len() {
            return;
        }
        self.instruments.clear();
        for value in values {
            let title = &value.plot;
            let index = self.instruments.iter().position(|plot| plot.title == *title).unwrap_or_else(|| {
                self.instruments.push(InstrumentPlot { title: title.clone(), curves: Vec::new() });
                self.instruments.len() - 1
            });
            let mut curve = Curve::new(&*value.name);
            curve.push(time, value.value);
            self.instruments[index].curves.push(curve);
        }
    }

    /// Replaces all curves by empty curves for the model of the snapshot.
    fn restart(&mut self, snapshot: &Snapshot) {
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
            generation: Some(snapshot.generation),
            sensors,
            energy: curves(&["potential", "kinetic", "total"]),
            solver: curves(&["iterations", "constraints", "log10(improvement)"]),
            timing: curves(&Self::TIMED.map(|(_, name)| name)),
            watched: Vec::new(),
            instruments: Vec::new(),
            timers: snapshot.timers,
        };
    }

    /// Adds the mean computing time of each stage since the previous snapshot, ms.
    fn update_timers(&mut self, snapshot: &Snapshot) {
        for (curve, (timer, _)) in self.timing.iter_mut().zip(Self::TIMED) {
            let index = Timer::ALL.iter().position(|other| *other == timer).expect("Bug: unknown timer");
            let (now, before) = (snapshot.timers[index], self.timers[index]);
            // A reset clears the timers.
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
    use super::{Curve, Curves, MAX_POINTS};
    use crate::model::EnableFlags;
    use crate::viewer::endpoint::Watch;
    use crate::viewer::handle::ViewerHandle;
    use crate::viewer::link::{EndpointRequest, link};
    use crate::{Data, sample};

    #[test]
    fn curve_keeps_the_newest_points_and_discards_undone_steps() {
        let mut curve = Curve::new("x");
        for index in 0..3 * MAX_POINTS {
            curve.push(index as f64, -(index as f64));
        }
        assert_eq!(curve.points().len(), MAX_POINTS);
        assert_eq!(curve.points().next(), Some([2.0 * MAX_POINTS as f64, -2.0 * MAX_POINTS as f64]));
        // Time decreases after steps back.
        let back = 2.5 * MAX_POINTS as f64;
        curve.push(back, 7.0);
        assert_eq!((curve.points().len(), curve.points().last()), (MAX_POINTS / 2 + 1, Some([back, 7.0])));
        curve.push(0.0, 1.0);
        assert_eq!(curve.points().collect::<Vec<_>>(), [[0.0, 1.0]]);
    }

    #[test]
    fn plots_of_instruments_group_the_values_by_title() {
        let (mut window, physics) = link(|| ());
        let mut data = Data::new(sample::cartpole()).unwrap();
        let (mut handle, mut curves) = (ViewerHandle::new(physics), Curves::default());
        let mut show = |plots: &[(&str, &str, f64)]| {
            handle.instruments(|instruments| {
                for (plot, name, value) in plots {
                    instruments.value(plot, name, *value);
                }
            });
            handle.sync(&mut data).unwrap();
            data.step().unwrap();
            curves.update(window.latest().unwrap().0, std::iter::empty());
            let values = |plot: &super::InstrumentPlot| {
                let last = |curve: &Curve| (curve.name.clone(), curve.points().map(|[_, value]| value).collect());
                (plot.title.to_string(), plot.curves.iter().map(last).collect::<Vec<(_, Vec<f64>)>>())
            };
            curves.instruments.iter().map(values).collect::<Vec<_>>()
        };
        show(&[("cost", "a", 1.0), ("speed", "v", 2.0), ("cost", "b", 3.0)]);
        let plots = show(&[("cost", "a", 4.0), ("speed", "v", 5.0), ("cost", "b", 6.0)]);
        let [cost, speed] = &plots[..] else { panic!("two plots") };
        assert_eq!(*cost, ("cost".into(), vec![("a".into(), vec![1.0, 4.0]), ("b".into(), vec![3.0, 6.0])]));
        assert_eq!(*speed, ("speed".into(), vec![("v".into(), vec![2.0, 5.0])]));
        // Other curves start again.
        assert_eq!(show(&[("cost", "a", 7.0)]), [("cost".into(), vec![("a".into(), vec![7.0])])]);
        assert_eq!(show(&[]), []);
    }

    #[test]
    fn curves_record_the_simulation() {
        let (mut window, physics) = link(|| ());
        let mut data = Data::new(sample::humanoid()).unwrap();
        data.edit_model(|model| model.edit_options(|options| options.enable |= EnableFlags::ENERGY)).unwrap();
        data.reset_to_key("stand").unwrap();
        let (mut handle, mut curves) = (ViewerHandle::new(physics), Curves::default());
        let mut watches: Vec<Watch> = vec!["qpos[2]".parse().unwrap(), "time".parse().unwrap()];
        window.send(EndpointRequest::Watch(watches.clone()));
        let mut heights = Vec::new();
        for step in 0..20 {
            if step == 10 {
                watches.truncate(1);
                window.send(EndpointRequest::Watch(watches.clone()));
            }
            handle.sync(&mut data).unwrap();
            heights.push([data.time(), data.qpos()[2]]);
            let snapshot = window.latest().unwrap().0;
            curves.update(snapshot, watches.iter().map(Watch::to_string));
            data.step().unwrap();
        }
        let [potential, kinetic, total] = &curves.energy[..] else { panic!("three energies") };
        let [potential, kinetic, total] = [potential, kinetic, total].map(|curve| curve.points().last().unwrap()[1]);
        assert_eq!(total, potential + kinetic);
        assert!(potential > 0.0);
        assert_eq!(curves.sensors.len(), data.model().nsensordata());
        assert_eq!(curves.solver.len(), 3);
        let [height] = &curves.watched[..] else { panic!("one watched value") };
        assert_eq!(height.name, "qpos[2]");
        assert_eq!(height.points().collect::<Vec<_>>(), heights[10..]);
        // Another model has other sensors.
        let mut other = Data::new(sample::cartpole()).unwrap();
        handle.sync(&mut other).unwrap();
        curves.update(window.latest().unwrap().0, std::iter::empty());
        assert_eq!(curves.sensors.len(), other.model().nsensordata());
        assert_eq!(curves.energy[0].points().len(), 1);
    }
}
