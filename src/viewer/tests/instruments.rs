//! Instruments of controllers and of programs: plotted values, parameters, and geoms in the scene.

use std::sync::Arc;

use allocation_counter::measure;

use super::Bench;
use crate::scene::{NewGeom, SceneGeomType};
use crate::viewer::handle::ViewerHandle;
use crate::viewer::instruments::{InstrumentedController, Instruments, WithInstruments};
use crate::viewer::link::{EndpointRequest, Event, Mode, Request, SimulationRequest, Snapshot, Status, link};
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
    let values: Vec<_> = snapshot.plotted.iter().map(|value| (&*value.plot, &*value.name, value.value)).collect();
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

#[test]
fn instruments_do_not_allocate_in_the_steady_state() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut force = 0.1;
    let mut frame = || {
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
