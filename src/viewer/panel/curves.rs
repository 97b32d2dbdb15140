//! Curves of values over simulated time, grouped in plots of one unit.

use std::sync::Arc;

use super::curve::Curve;
use super::names;
use crate::data::{Timer, TimerCount};
use crate::element::quantity::{Quantity, quantity};
use crate::model::Model;
use crate::viewer::endpoint::Watch;
use crate::viewer::instruments::PlottedValue;
use crate::viewer::link::Snapshot;
use crate::viewer::signal::{Signal, WatchedSignal};

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
    fn push(&mut self, time: f64, values: impl IntoIterator<Item = impl Into<Signal>>) {
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

    /// Adds the values of a new snapshot.
    pub fn update(&mut self, snapshot: &Snapshot) {
        if self.generation != Some(snapshot.generation) {
            self.restart(snapshot);
        }
        let time = snapshot.time;
        let plots = &mut self.plots[Group::Sensors as usize];
        for (&[plot, curve], signal) in self.sensors.iter().zip(&snapshot.signals.sensors) {
            plots[plot].curves[curve].push(time, *signal);
        }
        self.update_profile(snapshot);
        self.update_instruments(time, &snapshot.plotted);
        self.update_watched(snapshot);
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
        let signals = snapshot.signals.profile;
        let mut curves = [iterations, constraints, solver, energy].into_iter().flat_map(|plot| &mut plot.curves);
        curves.by_ref().zip(signals).for_each(|(curve, signal)| curve.push(time, signal));
        convergence.curves.iter_mut().for_each(Curve::clear);
        for (number, iteration) in (1_u32..).zip(&snapshot.solver) {
            convergence.push(number.into(), [iteration.improvement, iteration.gradient].map(f64::log10));
        }
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
            curve.push(time, value.signal);
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
            curve.push(time, value.signal);
            plots[index].curves.push(curve);
        }
    }

    /// Adds the watched values, in a plot for each field.
    fn update_watched(&mut self, snapshot: &Snapshot) {
        let plots = self.plots(Group::Watched);
        let watched = &snapshot.signals.watched;
        let is_watched = |name: &str| watched.iter().any(|other| other.watch.name() == name);
        for plot in plots.iter_mut() {
            plot.curves.retain(|curve| is_watched(&curve.name));
        }
        plots.retain(|plot| !plot.curves.is_empty());
        for WatchedSignal { watch, signal } in watched {
            let Quantity { name: title, unit } = quantity_of_watch(&snapshot.model, watch);
            let plot = plots.iter().position(|plot| *plot.title == *title).unwrap_or_else(|| {
                plots.push(Plot::new(title, unit, &[]));
                plots.len() - 1
            });
            let curves = &mut plots[plot].curves;
            let curve = curves.iter().position(|curve| curve.name == watch.name()).unwrap_or_else(|| {
                curves.push(Curve::new(watch.name()));
                curves.len() - 1
            });
            curves[curve].push(snapshot.time, *signal);
        }
    }

    /// Replaces all curves by empty curves for the model of the snapshot.
    fn restart(&mut self, snapshot: &Snapshot) {
        let mut plots: Vec<Plot> = Vec::new();
        let mut places = Vec::with_capacity(snapshot.signals.sensors.len());
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

/// Returns the quantity of a watched value: of the sensor, or named after the field.
fn quantity_of_watch(model: &Model, watch: &Watch) -> Quantity {
    let sensor = (watch.field() == "sensordata")
        .then(|| model.sensors().find(|sensor| sensor.data_range().contains(&watch.index())))
        .flatten();
    match (sensor, watch.field()) {
        (Some(sensor), _) => Quantity::of_sensor(model, &sensor),
        (None, "time") => quantity("time", "s"),
        (None, "energy") => quantity("energy", "J"),
        (None, field) => quantity(field, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Curves, Group, Plot};
    use crate::model::EnableFlags;
    use crate::viewer::endpoint::Watch;
    use crate::viewer::handle::ViewerHandle;
    use crate::viewer::link::{EndpointRequest, link};
    use crate::{Data, sample};

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
            curves.update(window.latest().unwrap().0);
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
            curves.update(window.latest().unwrap().0);
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
        curves.update(window.latest().unwrap().0);
        let sensors = sensors(&mut curves);
        assert_eq!(sensors.iter().map(|(_, count)| count).sum::<usize>(), other.model().nsensordata());
        assert_eq!(curves.plots(Group::Profile)[0].curves[0].points().len(), 1);
    }
}
