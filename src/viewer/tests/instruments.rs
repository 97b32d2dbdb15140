//! Instruments of controllers and of programs: plotted values, parameters, and geoms in the scene.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use allocation_counter::measure;

use super::Bench;
use crate::scene::{NewGeom, SceneGeomType};
use crate::viewer::endpoint::Watch;
use crate::viewer::handle::ViewerHandle;
use crate::viewer::instruments::{InstrumentedController, Instruments, WithInstruments};
use crate::viewer::link::{
    EndpointRequest, Event, Mode, Request, SimulationRequest, Snapshot, Status, WindowEnd, link,
};
use crate::viewer::signal::Signal;
use crate::{Controller, Data, Error, Result, sample};

/// Sets the only control to a constant force.
struct Push {
    force: f64,
}

impl Controller for Push {
    fn control(&mut self, data: &mut Data) -> Result<()> {
        data.ctrl_mut()[0] = self.force;
        Ok(())
    }
}

fn push(declare: impl FnMut(&mut Push, &Data, &mut Instruments) + Send + 'static) -> Bench {
    instrumented(WithInstruments { controller: Push { force: 0.1 }, declare })
}

fn instrumented(controller: impl InstrumentedController + 'static) -> Bench {
    Bench::instrumented(Data::new(sample::cartpole()).unwrap(), controller)
}

fn set(name: &str, value: f64) -> EndpointRequest {
    EndpointRequest::SetParameter(Arc::from(name), value)
}

fn parameters(snapshot: &Snapshot) -> Vec<(&str, f64)> {
    snapshot.parameters.iter().map(|parameter| (&*parameter.name, parameter.value)).collect()
}

#[test]
fn values_of_a_controller_follow_the_simulation() {
    let mut bench = push(|push, data, instruments| {
        instruments.value("state", "time", data.time());
        instruments.value("force", "push", push.force);
        instruments.value("state", "cart", data.qpos()[0]);
    });
    bench.send(SimulationRequest::Step(7));
    let snapshot = bench.snapshot();
    let values: Vec<_> =
        snapshot.plotted.iter().map(|value| (&*value.plot, &*value.name, value.signal.value)).collect();
    let (time, cart) = (snapshot.time, snapshot.qpos[0]);
    assert!(time > 0.0 && cart > 0.0);
    assert_eq!(values, [("state", "time", time), ("force", "push", 0.1), ("state", "cart", cart)]);
}

#[test]
fn changed_parameter_acts_from_the_next_step() {
    let mut bench = push(|push, _, instruments| {
        instruments.parameter("force", &mut push.force, -0.5..=0.5);
    });
    assert_eq!(parameters(bench.snapshot()), [("force", 0.1)]);
    // Both requests are executed in the same tick.
    bench.window.send(set("force", -0.3));
    assert_eq!(bench.send(SimulationRequest::Step(1)).ctrl, [-0.3]);
    assert_eq!(parameters(bench.snapshot()), [("force", -0.3)]);
    // While it runs, too.
    bench.send(Request::Pause(false));
    bench.pass(0.1);
    bench.send(set("force", 0.2));
    bench.pass(0.1);
    assert_eq!(bench.snapshot().ctrl, [0.2]);
}

#[test]
fn parameters_receive_numbers_in_their_range_only() {
    let mut bench = push(|push, _, instruments| {
        instruments.parameter("force", &mut push.force, -0.5..=0.5);
    });
    for (value, received) in [(7.0, 0.5), (-7.0, -0.5), (f64::NAN, -0.5), (f64::INFINITY, -0.5)] {
        bench.send(set("force", value));
        assert_eq!(bench.send(SimulationRequest::Step(1)).ctrl, [received]);
    }
    let notices = bench.events().into_iter().filter(|event| matches!(event, Event::Notice(_))).count();
    assert_eq!(notices, 2, "the window reports numbers that are not finite");
    bench.send(set("no such parameter", 0.3));
    assert_eq!(bench.send(SimulationRequest::Step(1)).ctrl, [-0.5]);
}

#[test]
fn return_value_of_a_parameter_is_true_after_a_change_only() {
    let (sender, changes) = std::sync::mpsc::channel();
    let mut bench = push(move |push, _, instruments| {
        if instruments.parameter("force", &mut push.force, -0.5..=0.5) {
            sender.send(push.force).unwrap();
        }
    });
    bench.send(SimulationRequest::Step(3));
    bench.send(set("force", 0.4));
    bench.send(SimulationRequest::Step(3));
    assert_eq!(changes.try_iter().collect::<Vec<_>>(), [0.4]);
}

#[test]
fn instruments_are_those_of_the_last_declaration() {
    let mut bench = push(|push, data, instruments| {
        if data.time() == 0.0 {
            instruments.parameter("force", &mut push.force, 0.0..=1.0);
            instruments.value("old", "x", 1.0);
            instruments.geom(NewGeom::sphere(0.1));
        }
        instruments.value("new", "x", 2.0);
    });
    assert_eq!((bench.snapshot().plotted.len(), bench.snapshot().parameters.len()), (2, 1));
    let ngeom = bench.snapshot().scene.ngeom();
    bench.send(SimulationRequest::Step(1));
    assert_eq!((bench.snapshot().plotted.len(), bench.snapshot().parameters.len()), (1, 0));
    assert_eq!(&*bench.snapshot().plotted[0].plot, "new");
    assert_eq!(bench.snapshot().scene.ngeom(), ngeom - 1);
}

#[test]
fn path_connects_its_finite_points_by_capsules() {
    let red = [1.0, 0.0, 0.0, 1.0];
    let mut bench = push(move |_, _, instruments| {
        let points = [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 2.0, 1.0], [f64::NAN; 3], [3.0; 3], [3.0; 3]];
        instruments.path(points, 0.01, red);
    });
    assert_eq!(bench.snapshot().problem, "");
    let scene = &bench.snapshot().scene;
    let capsules: Vec<_> = scene.geoms().filter(|geom| geom.rgba() == red).collect();
    let found: Vec<_> = capsules.iter().map(|geom| (geom.geom_type(), geom.pos(), geom.size())).collect();
    let capsule = SceneGeomType::Capsule;
    assert_eq!(found.len(), 3, "no capsule ends at the point that is not finite");
    assert_eq!(found[0], (capsule, [0.0, 0.0, 0.5], [0.01, 0.01, 0.5]));
    assert_eq!(found[1], (capsule, [0.0, 1.0, 1.0], [0.01, 0.01, 1.0]));
    assert_eq!(found[2].1, [3.0; 3]);
}

#[test]
fn instruments_belong_to_the_controller_mode() {
    let mut bench = push(|push, _, instruments| {
        instruments.parameter("force", &mut push.force, 0.0..=1.0);
        instruments.value("force", "push", push.force);
        instruments.geom(NewGeom::sphere(0.1));
    });
    let ngeom = bench.snapshot().scene.ngeom();
    assert!(bench.snapshot().has_instruments());
    bench.send(SimulationRequest::SetMode(Mode::Passive));
    assert!(!bench.snapshot().has_instruments());
    assert_eq!(bench.snapshot().scene.ngeom(), ngeom - 1);
    bench.send(SimulationRequest::SetMode(Mode::Controller));
    assert!(bench.snapshot().has_instruments());
}

#[test]
fn failure_of_the_closure_pauses_and_is_shown() {
    for panics in [false, true] {
        let declare = move |_: &mut Push, data: &Data, instruments: &mut Instruments| {
            instruments.value("time", "t", data.time());
            if data.time() > 0.01 {
                assert!(!panics, "a panic");
                return Err(Error::Unsupported("an error".to_owned()));
            }
            Ok(())
        };
        let mut bench = instrumented(WithInstruments { controller: Push { force: 0.1 }, declare });
        bench.send(Request::Pause(false));
        bench.pass(0.5);
        let expected = if panics { "the closure for instruments panicked: a panic" } else { "an error" };
        let snapshot = bench.snapshot();
        assert_eq!((snapshot.problem.as_str(), snapshot.status), (expected, Status::Paused));
        assert!(!snapshot.has_instruments());
        bench.send(Request::Reset);
        assert_eq!(bench.snapshot().problem, "");
        assert!(bench.snapshot().has_instruments());
    }
}

#[test]
fn invalid_range_and_geoms_are_shown_as_problems() {
    let mut bench = push(|push, _, instruments| {
        instruments.parameter("force", &mut push.force, 1.0..=0.0);
    });
    assert!(bench.snapshot().problem.contains("the range of the parameter 'force' is 1 to 0"));
    let mut bench = push(|_, _, instruments| instruments.geom(NewGeom::sphere(f64::NAN)));
    bench.tick();
    assert!(bench.snapshot().problem.contains("the size of a new geom"), "{}", bench.snapshot().problem);
    // A mesh of another model.
    let text = "<mujoco><asset><mesh name='m' vertex='0 0 0  1 0 0  0 1 0  0 0 1'/></asset></mujoco>";
    let other = crate::Model::from_xml_str(text).unwrap();
    let mesh = other.mesh("m").unwrap().id();
    let mut bench = push(move |_, _, instruments| instruments.geom(NewGeom::mesh(mesh)));
    bench.tick();
    assert!(bench.snapshot().problem.contains("another model"), "{}", bench.snapshot().problem);
}

#[test]
fn program_declares_instruments_until_the_next_call() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut force = 0.1;
    handle.instruments(|instruments| instruments.parameter("force", &mut force, 0.0..=1.0));
    for _ in 0..2 {
        handle.sync(&mut data).unwrap();
        assert_eq!(parameters(window.latest().unwrap().0), [("force", 0.1)]);
    }
    window.send(set("force", 0.7));
    handle.sync(&mut data).unwrap();
    assert_eq!(parameters(window.latest().unwrap().0), [("force", 0.7)], "the slider stays where the user moved it");
    assert!(handle.instruments(|instruments| instruments.parameter("force", &mut force, 0.0..=1.0)));
    assert_eq!(force, 0.7);
    handle.instruments(|instruments| instruments.value("cart", "x", data.qpos()[0]));
    handle.sync(&mut data).unwrap();
    let snapshot = window.latest().unwrap().0;
    assert_eq!((snapshot.parameters.len(), snapshot.plotted.len()), (0, 1));
}

/// Returns the values and the ranges of the plotted values, by name.
fn plotted(snapshot: &Snapshot) -> Vec<(&str, Signal)> {
    snapshot.plotted.iter().map(|value| (&*value.name, value.signal)).collect()
}

#[test]
fn extremes_between_two_images_are_kept() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut image = |values: &[f64]| {
        for value in values {
            handle.instruments(|instruments| instruments.value("plot", "x", *value));
        }
        data.step().unwrap();
        handle.sync(&mut data).unwrap();
    };
    // Returns the range, and clears it as the plots do.
    let recorded = |window: &mut WindowEnd| {
        let snapshot = window.latest().unwrap().0;
        let [(_, signal)] = plotted(snapshot)[..] else { panic!("one value") };
        snapshot.clear_ranges();
        (signal.value, signal.range)
    };
    // A sine with a period of one image.
    let sine: Vec<f64> = (1..=10).map(|index| (0.2 * PI * f64::from(index)).sin()).collect();
    for _ in 0..3 {
        image(&sine);
        let (value, [low, high]) = recorded(&mut window);
        assert!(value.abs() < 1e-12);
        assert!((low + (0.4 * PI).sin()).abs() < 1e-12 && (high - (0.4 * PI).sin()).abs() < 1e-12, "{low} {high}");
    }
    // A spike.
    image(&[0.0, 7.0, 0.0]);
    assert_eq!(recorded(&mut window), (0.0, [0.0, 7.0]));
    image(&[0.0, 0.0]);
    assert_eq!(recorded(&mut window), (0.0, [0.0, 0.0]));
    // The window takes no image of some spikes, and the plots do not record another.
    image(&[0.0, -3.0, 0.0]);
    image(&[0.0, 2.0, 0.0]);
    window.take_events();
    image(&[5.0, 1.0]);
    image(&[1.0]);
    assert_eq!(recorded(&mut window), (1.0, [-3.0, 5.0]));
    // A value of the last declaration only.
    image(&[]);
    assert_eq!(recorded(&mut window), (1.0, Signal::NO_RANGE));
    // Values that are not finite.
    image(&[2.0, f64::NEG_INFINITY, f64::INFINITY, f64::NAN]);
    let (value, range) = recorded(&mut window);
    assert!(value.is_nan() && range == [2.0, 2.0], "{value} {range:?}");
    image(&[f64::NAN]);
    assert_eq!(recorded(&mut window).1, Signal::NO_RANGE);
}

#[test]
fn extremes_belong_to_names() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut declare = |values: &[(&str, f64)]| {
        handle.instruments(|instruments| values.iter().for_each(|(name, value)| instruments.value("p", name, *value)));
        handle.sync(&mut data).unwrap();
    };
    // Without an image, one disappears and both return in another order.
    declare(&[("a", 1.0), ("b", 5.0)]);
    declare(&[("b", 6.0)]);
    declare(&[("b", 0.0), ("a", 3.0)]);
    let of = |value, range| Signal { value, range };
    assert_eq!(plotted(window.latest().unwrap().0), [("b", of(0.0, [0.0, 6.0])), ("a", of(3.0, [3.0, 3.0]))]);
    window.current_mut().unwrap().clear_ranges();
    // An image without a value that has just had an extreme.
    declare(&[("b", -9.0), ("a", 3.0)]);
    declare(&[("a", 4.0)]);
    assert_eq!(plotted(window.latest().unwrap().0), [("a", of(4.0, [3.0, 4.0]))]);
    declare(&[("a", 4.0), ("b", 1.0)]);
    assert_eq!(plotted(window.latest().unwrap().0)[1], ("b", of(1.0, [1.0, 1.0])));
}

#[test]
fn controller_declares_values_in_each_step_and_geoms_for_each_image() {
    let (drawn, count) = (Arc::new(AtomicUsize::new(0)), 20);
    let points = drawn.clone();
    let mut bench = push(move |_, data, instruments| {
        // A spike at a single step between two images.
        let step = (data.time() / data.model().timestep()).round();
        instruments.value("plot", "spike", if step == 7.0 { 5.0 } else { 0.0 });
        instruments.value("plot", "step", step);
        let count = |point: i32| {
            points.fetch_add(1, Ordering::Relaxed);
            [0.0, 0.0, f64::from(point)]
        };
        instruments.path((0..2).map(count), 0.01, [1.0; 4]);
    });
    bench.window.current_mut().unwrap().clear_ranges();
    let (before, ngeom) = (drawn.load(Ordering::Relaxed), bench.snapshot().scene.ngeom());
    let snapshot = bench.send(SimulationRequest::Step(count));
    let expected = [("spike", 0.0, [0.0, 5.0]), ("step", f64::from(count), [0.0, f64::from(count)])];
    assert_eq!(plotted(snapshot), expected.map(|(name, value, range)| (name, Signal { value, range })));
    assert_eq!(snapshot.scene.ngeom(), ngeom);
    assert_eq!(drawn.load(Ordering::Relaxed) - before, 2, "one image was made");
}

#[test]
fn extremes_of_sensors_and_watched_values_are_kept() {
    let mut bench = Bench::humanoid();
    bench.send(EndpointRequest::Watch(Watch::parse("qvel[2]", &sample::humanoid()).unwrap()));
    bench.window.current_mut().unwrap().clear_ranges();
    let steps = 150;
    let snapshot = bench.send(SimulationRequest::Step(steps));

    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    // The first two are those of the velocity and of the constraints.
    let mut ranges = vec![Signal::NO_RANGE; 2 + data.model().nsensordata()];
    let extend = |ranges: &mut [[f64; 2]], data: &Data| {
        let values = [data.qvel()[2], data.nefc() as f64].into_iter().chain(data.sensordata().iter().copied());
        for (range, value) in ranges.iter_mut().zip(values) {
            *range = [range[0].min(value), range[1].max(value)];
        }
    };
    for _ in 0..steps {
        data.step().unwrap();
        extend(&mut ranges, &data);
    }
    // The image shows the last state.
    data.forward_between_steps(&mut Vec::new()).unwrap();
    extend(&mut ranges, &data);
    assert_eq!(snapshot.qpos, data.qpos());
    let signals = &snapshot.signals;
    let [watched] = &signals.watched[..] else { panic!("one watched value") };
    let found = [&watched.signal, &signals.profile[1]].into_iter().chain(&signals.sensors);
    assert_eq!(found.map(|signal| signal.range).collect::<Vec<_>>(), ranges);
    assert!(ranges[1][1] > data.nefc() as f64, "the number of constraints has a maximum between the images");
}

#[test]
fn instruments_do_not_allocate_in_the_steady_state() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut force = 0.1;
    let mut frame = || {
        // Several declarations for each image, in which a value disappears and returns.
        for number in 0..4 {
            handle.instruments(|instruments| {
                if number == 1 {
                    instruments.value("state", "pole", data.qpos()[1]);
                }
                instruments.value("state", "cart", data.qpos()[0]);
            });
        }
        handle.instruments(|instruments| {
            instruments.parameter("force", &mut force, 0.0..=1.0);
            instruments.value("state", "cart", data.qpos()[0]);
            instruments.path((0..20).map(|point| [0.0, 0.0, f64::from(point)]), 0.01, [1.0; 4]);
        });
        data.step().unwrap();
        handle.sync(&mut data).unwrap();
        assert_eq!(window.latest().unwrap().0.plotted.len(), 1);
    };
    (0..10).for_each(|_| frame());
    let allocated = measure(|| (0..100).for_each(|_| frame()));
    assert_eq!(allocated.count_total, 0);
}
