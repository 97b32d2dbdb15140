//! Curves of values over simulated time, grouped in plots of one unit.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use super::names;
use super::quantity::Quantity;
use crate::data::{Timer, TimerCount};
use crate::viewer::endpoint::Watch;
use crate::viewer::instruments::PlottedValue;
use crate::viewer::link::Snapshot;

/// Maximum number of points of a curve.
const MAX_POINTS: usize = 1000;

/// Newest points of a value over simulated time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub name: String,
    /// Part of the name that differs from the names of the other curves of a plot.
    short: Range<usize>,
    /// The user has hidden the curve.
    pub is_hidden: bool,
    /// The name contains the text of the filter.
    pub is_found: bool,
    points: VecDeque<[f64; 2]>,
}

impl Curve {
    pub fn new(name: impl Into<String>) -> Self {
        let name = name.into();
        let short = 0..name.len();
        Self { name, short, is_hidden: false, is_found: true, points: VecDeque::with_capacity(MAX_POINTS) }
    }

    /// Returns the part of the name that differs from the names of the other curves of the plot.
    pub fn short_name(&self) -> &str {
        &self.name[self.short.clone()]
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
    #[cfg(test)]
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.points.iter().copied()
    }

    /// Returns the times of the oldest and the newest point, s.
    pub fn times(&self) -> Option<[f64; 2]> {
        Some([self.points.front()?[0], self.points.back()?[0]])
    }

    /// Returns the points, in parts that are separated by values that are not finite. Of the points
    /// in a column of this width, s, only the lowest and the highest are left. The columns start at
    /// the time zero, so that old parts of a curve keep their points.
    pub fn parts(&self, column: f64) -> Vec<Vec<[f64; 2]>> {
        let mut parts = vec![Vec::new()];
        let mut extremes: Option<[[f64; 2]; 2]> = None;
        let finish = |part: &mut Vec<[f64; 2]>, extremes: &mut Option<[[f64; 2]; 2]>| {
            let Some([low, high]) = extremes.take() else { return };
            part.push(if low[0] < high[0] { low } else { high });
            if low != high {
                part.push(if low[0] < high[0] { high } else { low });
            }
        };
        for &point in &self.points {
            let part = parts.last_mut().expect("Bug: a curve without parts");
            if !point[1].is_finite() {
                finish(part, &mut extremes);
                parts.push(Vec::new());
                continue;
            }
            let index = |point: [f64; 2]| (point[0] / column).floor();
            match &mut extremes {
                Some([low, high]) if index(*low) == index(point) => {
                    if point[1] < low[1] {
                        *low = point;
                    } else if point[1] > high[1] {
                        *high = point;
                    }
                }
                _ => {
                    finish(part, &mut extremes);
                    extremes = Some([point; 2]);
                }
            }
        }
        finish(parts.last_mut().expect("Bug: a curve without parts"), &mut extremes);
        parts.retain(|part| !part.is_empty());
        parts
    }
}

/// Curves of one unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plot {
    pub title: Arc<str>,
    /// Empty if there is none, or if the title contains it.
    pub unit: &'static str,
    /// The values are decimal logarithms.
    pub is_log: bool,
    /// The curves are over the iterations of the solver instead of the time.
    pub is_over_iterations: bool,
    pub curves: Vec<Curve>,
}

impl Plot {
    fn new(title: impl Into<Arc<str>>, unit: &'static str, names: &[&str]) -> Self {
        let curves = names.iter().copied().map(Curve::new).collect();
        Self { title: title.into(), unit, is_log: false, is_over_iterations: false, curves }
    }

    /// Determines the short names of the curves of several sensors with one value each, or of their
    /// elements.
    fn shorten_names(&mut self) {
        let mut sensors: Vec<&str> =
            self.curves.iter().map(|curve| curve.name.split('[').next().unwrap_or_default()).collect();
        sensors.dedup();
        let [start, end] = names::common(&sensors);
        for curve in &mut self.curves {
            // The end is followed by the number of the element.
            let end = if curve.name.ends_with(']') { 0 } else { end };
            curve.short = start..curve.name.len() - end;
        }
    }

    /// Appends a value to each curve.
    fn push(&mut self, time: f64, values: impl IntoIterator<Item = f64>) {
        for (curve, value) in self.curves.iter_mut().zip(values) {
            curve.push(time, value);
        }
    }
}

/// Group of plots that are shown together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Group {
    /// Values of the controller or the program.
    Instruments,
    /// Readings of the sensors, one curve for each element.
    Sensors,
    /// Solver, computing times of a step, and energy.
    Profile,
    Watched,
}

impl Group {
    pub const ALL: [Self; 4] = [Self::Instruments, Self::Sensors, Self::Profile, Self::Watched];
}

/// Curves of all plots, updated from snapshots.
#[derive(Debug, Default)]
pub(super) struct Curves {
    /// Generation of the model; `None` before the first snapshot.
    generation: Option<u64>,
    plots: [Vec<Plot>; Group::ALL.len()],
    /// Plot and curve of each element of the readings of the sensors.
    sensors: Vec<[usize; 2]>,
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

    /// Returns the plots of a group.
    pub fn plots(&mut self, group: Group) -> &mut Vec<Plot> {
        &mut self.plots[group as usize]
    }

    /// Adds the values of a new snapshot. `watched` are its watched values.
    pub fn update(&mut self, snapshot: &Snapshot, watched: &[Watch]) {
        if self.generation != Some(snapshot.generation) {
            self.restart(snapshot);
        }
        let time = snapshot.time;
        let plots = &mut self.plots[Group::Sensors as usize];
        for (&[plot, curve], value) in self.sensors.iter().zip(&snapshot.sensordata) {
            plots[plot].curves[curve].push(time, *value);
        }
        self.update_profile(snapshot);
        self.update_instruments(time, &snapshot.plotted);
        self.update_watched(snapshot, watched);
    }

    /// Adds the statistics of the solver, the mean computing time of each stage since the previous
    /// snapshot, and the energy.
    fn update_profile(&mut self, snapshot: &Snapshot) {
        let time = snapshot.time;
        let [iterations, constraints, solver, convergence, timing, energy] =
            &mut self.plots[Group::Profile as usize][..]
        else {
            return;
        };
        iterations.push(time, [snapshot.solver.len() as f64]);
        constraints.push(time, [snapshot.nefc as f64]);
        let last = snapshot.solver.last().map_or([f64::NAN; 2], |last| [last.improvement, last.gradient]);
        solver.push(time, last.map(f64::log10));
        convergence.curves.iter_mut().for_each(|curve| curve.points.clear());
        for (number, iteration) in (1_u32..).zip(&snapshot.solver) {
            convergence.push(number.into(), [iteration.improvement, iteration.gradient].map(f64::log10));
        }
        let [potential, kinetic] = snapshot.energy;
        energy.push(time, [potential, kinetic, potential + kinetic]);
        for (curve, (timer, _)) in timing.curves.iter_mut().zip(Self::TIMED) {
            let index = Timer::ALL.iter().position(|other| *other == timer).expect("Bug: unknown timer");
            let (now, before) = (snapshot.timers[index], self.timers[index]);
            // A reset clears the timers.
            let before = if now.number < before.number { TimerCount::default() } else { before };
            let number = now.number - before.number;
            if number > 0 {
                curve.push(time, 1e3 * (now.duration - before.duration) / number as f64);
            }
        }
        self.timers = snapshot.timers;
    }

    /// Adds the values of the instruments. Other plots or curves than in the last snapshot replace
    /// all plots.
    fn update_instruments(&mut self, time: f64, values: &[PlottedValue]) {
        let plots = self.plots(Group::Instruments);
        let number: usize = plots.iter().map(|plot| plot.curves.len()).sum();
        let curve_of = |plots: &mut [Plot], value: &PlottedValue| {
            let plot = plots.iter_mut().find(|plot| plot.title == value.plot)?;
            let curve = plot.curves.iter_mut().find(|curve| *curve.name == *value.name)?;
            curve.push(time, value.value);
            Some(())
        };
        let is_same = values.iter().all(|value| curve_of(plots, value).is_some());
        if is_same && number == values.len() {
            return;
        }
        plots.clear();
        for value in values {
            let index = plots.iter().position(|plot| plot.title == value.plot).unwrap_or_else(|| {
                plots.push(Plot::new(value.plot.clone(), "", &[]));
                plots.len() - 1
            });
            let mut curve = Curve::new(&*value.name);
            curve.push(time, value.value);
            plots[index].curves.push(curve);
        }
    }

    /// Adds the watched values, in a plot for each field.
    fn update_watched(&mut self, snapshot: &Snapshot, watched: &[Watch]) {
        let plots = self.plots(Group::Watched);
        // A new list has not reached the snapshots yet.
        if watched.len() != snapshot.watched.len() {
            return;
        }
        let is_watched = |name: &str| watched.iter().any(|watch| watch.name() == name);
        for plot in plots.iter_mut() {
            plot.curves.retain(|curve| is_watched(&curve.name));
        }
        plots.retain(|plot| !plot.curves.is_empty());
        for (watch, value) in watched.iter().zip(&snapshot.watched) {
            let Quantity { name: title, unit } = Quantity::of_watch(&snapshot.model, watch);
            let plot = plots.iter().position(|plot| *plot.title == *title).unwrap_or_else(|| {
                plots.push(Plot::new(title, unit, &[]));
                plots.len() - 1
            });
            let curves = &mut plots[plot].curves;
            let curve = curves.iter().position(|curve| curve.name == watch.name()).unwrap_or_else(|| {
                curves.push(Curve::new(watch.name()));
                curves.len() - 1
            });
            curves[curve].push(snapshot.time, *value);
        }
    }

    /// Replaces all curves by empty curves for the model of the snapshot.
    fn restart(&mut self, snapshot: &Snapshot) {
        let mut plots: Vec<Plot> = Vec::new();
        let mut places = Vec::with_capacity(snapshot.sensordata.len());
        for sensor in snapshot.model.sensors() {
            let name = sensor.name().map_or_else(|| format!("sensor {}", sensor.index()), str::to_owned);
            let Quantity { name: title, unit } = Quantity::of_sensor(&snapshot.model, &sensor);
            let plot = plots.iter().position(|plot| *plot.title == *title).unwrap_or_else(|| {
                plots.push(Plot::new(title, unit, &[]));
                plots.len() - 1
            });
            let range = sensor.data_range();
            for index in range.clone() {
                places.push([plot, plots[plot].curves.len()]);
                plots[plot].curves.push(Curve::new(match range.len() {
                    1 => name.clone(),
                    _ => format!("{name}[{}]", index - range.start),
                }));
            }
        }
        plots.iter_mut().for_each(Plot::shorten_names);
        let mut solver = Plot::new("last iteration", "", &["improvement", "gradient"]);
        solver.is_log = true;
        let mut convergence = Plot { title: "convergence of the last step".into(), ..solver.clone() };
        convergence.is_over_iterations = true;
        let profile = vec![
            Plot::new("solver", "", &["iterations"]),
            Plot::new("constraints", "", &["number"]),
            solver,
            convergence,
            Plot::new("time of a step", "ms", &Self::TIMED.map(|(_, name)| name)),
            Plot::new("energy", "J", &["potential", "kinetic", "total"]),
        ];
        *self =
            Self { generation: Some(snapshot.generation), sensors: places, timers: snapshot.timers, ..Self::default() };
        *self.plots(Group::Sensors) = plots;
        *self.plots(Group::Profile) = profile;
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Curves, Group, MAX_POINTS, Plot};
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
    fn parts_of_a_curve_are_separated_by_gaps_and_keep_the_extremes() {
        let mut curve = Curve::new("x");
        let values = [0.0, 5.0, -3.0, 1.0, f64::NAN, 2.0, 2.0, 9.0, f64::INFINITY];
        for (index, value) in values.into_iter().enumerate() {
            curve.push(index as f64, value);
        }
        // Every point has a column.
        let all: Vec<Vec<f64>> =
            curve.parts(0.5).iter().map(|part| part.iter().map(|[_, value]| *value).collect()).collect();
        assert_eq!(all, [&[0.0, 5.0, -3.0, 1.0][..], &[2.0, 2.0, 9.0]]);
        // Columns of four points.
        assert_eq!(curve.parts(4.0), [vec![[1.0, 5.0], [2.0, -3.0]], vec![[5.0, 2.0], [7.0, 9.0]]]);
        assert!(Curve::new("empty").parts(1.0).is_empty());
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
            curves.update(window.latest().unwrap().0, &[]);
            let values = |plot: &Plot| {
                let last = |curve: &Curve| (curve.name.clone(), curve.points().map(|[_, value]| value).collect());
                (plot.title.to_string(), plot.curves.iter().map(last).collect::<Vec<(_, Vec<f64>)>>())
            };
            curves.plots(Group::Instruments).iter().map(values).collect::<Vec<_>>()
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
        let parse = |text: &str| Watch::parse(text, &sample::humanoid()).unwrap().remove(0);
        let mut watches = vec![parse("qpos[2]"), parse("time")];
        window.send(EndpointRequest::Watch(watches.clone()));
        let mut heights = Vec::new();
        for step in 0..20 {
            if step == 10 {
                watches.truncate(1);
                window.send(EndpointRequest::Watch(watches.clone()));
            }
            handle.sync(&mut data).unwrap();
            heights.push([data.time(), data.qpos()[2]]);
            curves.update(window.latest().unwrap().0, &watches);
            data.step().unwrap();
        }
        let energy = curves.plots(Group::Profile).last().unwrap();
        let [potential, kinetic, total] = &energy.curves[..] else { panic!("three energies") };
        let [potential, kinetic, total] = [potential, kinetic, total].map(|curve| curve.points().last().unwrap()[1]);
        assert_eq!(total, potential + kinetic);
        assert!(potential > 0.0);
        let sensors = |curves: &mut Curves| {
            let plots = curves.plots(Group::Sensors);
            plots.iter().map(|plot| (plot.unit, plot.curves.len())).collect::<Vec<_>>()
        };
        let of_humanoid = sensors(&mut curves);
        assert_eq!(of_humanoid.iter().map(|(_, count)| count).sum::<usize>(), data.model().nsensordata());
        for unit in ["m/s²", "rad/s", "m", "N"] {
            assert_eq!(of_humanoid.iter().filter(|(other, _)| *other == unit).count(), 1, "{unit}");
        }
        let [heights_plot] = &curves.plots(Group::Watched)[..] else { panic!("one plot") };
        let [height] = &heights_plot.curves[..] else { panic!("one watched value") };
        assert_eq!((&*heights_plot.title, &*height.name), ("qpos", "qpos[2]"));
        assert_eq!(height.points().collect::<Vec<_>>(), heights);
        // Another model has other sensors.
        let mut other = Data::new(sample::cartpole()).unwrap();
        handle.sync(&mut other).unwrap();
        curves.update(window.latest().unwrap().0, &watches);
        let sensors = sensors(&mut curves);
        assert_eq!(sensors.iter().map(|(_, count)| count).sum::<usize>(), other.model().nsensordata());
        assert_eq!(curves.plots(Group::Profile)[0].curves[0].points().len(), 1);
    }
}
