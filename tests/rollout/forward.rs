//! `with_forward_after_step` updates what closures read, and changes no simulation.

use std::sync::Arc;

use mujoco_safe::enums::{Cone, Integrator, Solver};
use mujoco_safe::rollout::{Rollout, RolloutError};
use mujoco_safe::{Batch, Controller, Data, Error, Model, RandomController, StateSpec, sample};

use super::{bits, pool};
use crate::cases::cases;

const SPEC: StateSpec = StateSpec::INTEGRATION;
const COUNT: usize = 3;
const STEPS: usize = 40;

/// Returns models with contacts, friction and all kinds of elements, for the integrators, the
/// solvers and the noslip solver: every third one unless all cases run.
fn models() -> Vec<Arc<Model>> {
    let file =
        |name: &str| Model::from_xml_path(format!("{}/tests/models/{name}.xml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let mut models = Vec::new();
    for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
        for (solver, cone, noslip) in [
            (Solver::Newton, Cone::Pyramidal, 0),
            (Solver::Cg, Cone::Elliptic, 0),
            (Solver::Pgs, Cone::Pyramidal, 0),
            (Solver::Newton, Cone::Elliptic, 3),
            (Solver::Pgs, Cone::Elliptic, 3),
        ] {
            let mut model = sample::humanoid();
            let options = model.edit().edit_options(|options| {
                (options.integrator, options.solver, options.cone) = (integrator, solver, cone);
                options.noslip_iterations = noslip;
                // The solver stops early, so that its result depends on the initial guess.
                options.iterations = 4;
            });
            options.unwrap();
            models.push(Arc::new(model));
        }
    }
    models.extend(["every_element", "zoo"].map(|name| Arc::new(file(name))));
    models.into_iter().step_by(cases(3, 1)).collect()
}

/// Returns a simulation in an initial state in which the humanoid touches the floor.
fn start(model: &Arc<Model>) -> Data {
    let mut data = Data::new(model.clone()).unwrap();
    if model.keyframe("squat").is_ok() {
        data.reset_to_key("squat").unwrap();
    }
    data
}

/// Writes what a closure reads: the state, poses, contacts, forces and sensor readings.
fn read(data: &Data, row: &mut [f64]) {
    read_both(data, data, row);
}

/// Writes the state of one simulation and the computed quantities of another. (The engine's forward
/// dynamics normalises the quaternions of the state.)
fn read_both(state: &Data, computed: &Data, row: &mut [f64]) {
    let parts = [state.qpos(), computed.xpos().as_flattened(), computed.qfrc_constraint(), computed.sensordata()];
    row[0] = computed.ncon() as f64;
    for (to, from) in row[1..].iter_mut().zip(parts.into_iter().flatten()) {
        *to = *from;
    }
}

fn width(model: &Model) -> usize {
    1 + 3 * model.nbody() + model.nv() + model.nsensordata() + model.nq()
}

/// Values after each step of a plain loop.
#[derive(Default)]
struct Expected {
    states: Vec<f64>,
    sensordata: Vec<f64>,
    /// Values that a closure reads from a copy of the simulation after `forward`.
    current: Vec<f64>,
    /// Values that it reads from the simulation after a step.
    lagging: Vec<f64>,
}

impl Expected {
    fn of(model: &Arc<Model>, index: usize) -> Self {
        let (mut data, mut random) = (start(model), RandomController::new(index as u64));
        let mut expected = Self { states: data.state(SPEC), ..Self::default() };
        let mut row = vec![0.0; width(model)];
        for _ in 0..STEPS {
            random.control(&mut data).unwrap();
            data.step().unwrap();
            expected.sensordata.extend_from_slice(data.sensordata());
            expected.states.extend(data.state(SPEC));
            read(&data, &mut row);
            expected.lagging.extend_from_slice(&row);
            let mut copy = data.clone();
            copy.forward().unwrap();
            read_both(&data, &copy, &mut row);
            expected.current.extend_from_slice(&row);
        }
        expected
    }
}

#[test]
fn rollouts_are_bit_for_bit_the_same_and_their_outputs_are_those_of_the_new_state() {
    let mut contacts = 0.0;
    for model in models() {
        let rollout = || {
            Rollout::new(model.clone(), COUNT, STEPS)
                .with_controllers(|index| RandomController::new(index as u64))
                .with_recorded_states(SPEC)
                .with_outputs(width(&model), read)
        };
        let initial = start(&model).state(SPEC);
        let (without, with) =
            (rollout().with_initial_state(SPEC, &initial), rollout().with_initial_state(SPEC, &initial));
        let (without, with) = (without.run().unwrap(), with.with_forward_after_step().run().unwrap());
        assert!(with.outcomes().iter().all(Result::is_ok));
        for index in 0..COUNT {
            let expected = Expected::of(&model, index);
            for result in [&without, &with] {
                assert!(bits(result.states_of(index).as_slice()) == bits(&expected.states), "{:?}", model.options());
                assert!(bits(result.sensordata_of(index).as_slice()) == bits(&expected.sensordata));
            }
            assert!(bits(without.outputs_of(index).as_slice()) == bits(&expected.lagging));
            assert!(bits(with.outputs_of(index).as_slice()) == bits(&expected.current), "{:?}", model.options());
            assert!(expected.current != expected.lagging);
            contacts += expected.current.chunks(width(&model)).map(|row| row[0]).sum::<f64>();
        }
    }
    assert!(contacts > 0.0);
}

#[test]
fn batches_are_bit_for_bit_the_same_and_their_observations_are_those_of_the_present_state() {
    const SUBSTEPS: usize = 2;
    for model in models() {
        let batch = || Batch::new(model.clone(), COUNT).unwrap().with_substeps(SUBSTEPS).with_chunk(1);
        let mut plain = batch();
        // The order of the options does not matter.
        let mut batches = [
            batch().with_observations(width(&model), read).with_forward_after_step(),
            batch().with_forward_after_step().with_observations(width(&model), read),
        ];
        let initial = start(&model).state(SPEC);
        let mut random = RandomController::new(7);
        let mut source = start(&model);
        for step in 0..STEPS / SUBSTEPS {
            random.control(&mut source).unwrap();
            for batch in batches.iter_mut().chain([&mut plain]) {
                if step % 8 == 0 {
                    let which = |index: usize| step == 0 || index == 1;
                    batch.reset_where(which, |_, _, data| data.set_state(SPEC, &initial)).unwrap();
                }
                batch
                    .step(|_, controls| {
                        controls.as_mut_slice()[model.nu()..][..model.nu()].copy_from_slice(source.ctrl());
                    })
                    .unwrap();
            }
            for index in 0..COUNT {
                let expected = plain.data(index).unwrap();
                let mut copy = expected.clone();
                copy.forward().unwrap();
                let mut row = vec![0.0; width(&model)];
                read_both(&expected, &copy, &mut row);
                for batch in &batches {
                    assert!(
                        bits(&batch.data(index).unwrap().state(SPEC)) == bits(&expected.state(SPEC)),
                        "{:?}",
                        model.options()
                    );
                    assert!(bits(batch.observations().row(index)) == bits(&row), "{:?}", model.options());
                }
            }
        }
    }
}

#[test]
fn observations_after_a_reset_are_those_of_the_initial_state() {
    let model = sample::cartpole();
    let cart = model.body("cart").unwrap().id();
    let mut batch = pool(2).install(|| {
        Batch::new(model, 4)
            .unwrap()
            .with_observations(1, |data, row| row[0] = data.body(cart).xpos()[0])
            .with_forward_after_step()
    });
    assert_eq!(batch.observations().as_slice(), [0.0; 4]);
    batch.reset_where(|_| true, |index, _, data| data.qpos_mut()[0] = 0.25 * index as f64).unwrap();
    assert_eq!(batch.observations().as_slice(), [0.0, 0.25, 0.5, 0.75]);
    batch.reset(3).unwrap();
    assert_eq!(batch.observations().as_slice(), [0.0, 0.25, 0.5, 0.0]);
}

#[test]
fn a_quaternion_of_another_length_is_kept() {
    let model = Arc::new(sample::humanoid());
    let quat = [2.0, 0.2, 0.0, 0.0];
    let mut batch = Batch::new(model, 1).unwrap().with_forward_after_step();
    batch.reset_where(|_| true, |_, _, data| data.qpos_mut()[3..7].copy_from_slice(&quat)).unwrap();
    assert_eq!(batch.data(0).unwrap().qpos()[3..7], quat);
    assert_eq!(batch.observations().row(0)[3..7], quat);
}

#[test]
fn controllers_read_quantities_of_the_present_state() {
    let model = sample::cartpole();
    let cart = model.body("cart").unwrap().id();
    let result = Rollout::new(model, 2, 30)
        .with_controllers(|_| {
            let mut step = 0;
            move |data: &mut Data| {
                if step > 0 {
                    assert_eq!(data.body(cart).xpos()[0], data.qpos()[0]);
                }
                step += 1;
                data.ctrl_mut()[0] = 1.0;
            }
        })
        .with_forward_after_step()
        .run()
        .unwrap();
    assert!(result.state(0, 30)[0] > 0.1);
}

/// A mass without forces, which leaves the range of positions in step 2.
fn runaway() -> (Model, [f64; 2]) {
    let xml = r#"<mujoco><option gravity="0 0 0" timestep="0.01"/><worldbody>
        <body><joint type="slide"/><geom size=".1"/></body></worldbody></mujoco>"#;
    (Model::from_xml_str(xml).unwrap(), [1e10 - 2.5e6, 1e8])
}

#[test]
fn an_error_of_forward_ends_a_rollout_after_its_step() {
    let (model, initial) = runaway();
    let run = |steps: usize, forward: bool| {
        let rollout = Rollout::new(model.clone(), 1, steps)
            .with_initial_state(StateSpec::PHYSICS, &initial)
            .with_outputs(1, |data, row| row[0] = data.time());
        if forward { rollout.with_forward_after_step().run() } else { rollout.run() }.unwrap()
    };
    for steps in [3, 5] {
        let (without, with) = (run(steps, false), run(steps, true));
        assert_eq!(bits(with.states()), bits(without.states()));
        assert!(with.state(0, 3)[0] > 1e10);
        assert!(
            matches!(with.outcomes()[0], Err(RolloutError::Failed { step: 3, error: Error::Unstable(_) })),
            "{:?}",
            with.outcomes()
        );
        assert_eq!(with.outputs()[..2], without.outputs()[..2]);
        assert!(with.outputs()[2..].iter().all(|value| value.is_nan()));
    }
    // Without the call, the error occurs in the next step.
    assert!(run(3, false).outcomes()[0].is_ok());
}

#[test]
fn an_error_of_forward_stops_a_simulation_of_a_batch() {
    let (model, initial) = runaway();
    let mut batch = Batch::new(model, 2).unwrap().with_forward_after_step();
    batch.reset_where(|index| index == 0, |_, _, data| data.set_state(StateSpec::PHYSICS, &initial)).unwrap();
    for _ in 0..3 {
        assert!(batch.failures().next().is_none());
        batch.step(|_, _| ()).unwrap();
    }
    assert!(matches!(batch.failure(0), Some(Error::Unstable(_))));
    assert!(batch.observations().row(0).iter().all(|value| value.is_nan()));
    assert_eq!(batch.observations().row(1), [0.0, 0.0]);
}
