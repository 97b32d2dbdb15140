//! A batch equals the same number of plain loops in lockstep.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::{Batch, Data, Error, StateSpec, sample};

use super::{bits, pool};

/// A policy on the observation of one simulation: arbitrary state feedback, different for each.
fn policy(observation: &[f64], controls: &mut [f64]) {
    for (index, control) in controls.iter_mut().enumerate() {
        *control = (observation[3 + index] * 3.0 + observation[30 + index % 20]).sin() * 0.4;
    }
}

fn start(index: usize, data: &mut Data) {
    data.qpos_mut()[2] = 1.2 + 0.05 * index as f64;
    data.qvel_mut()[index % 27] = 0.5;
}

const STEPS: usize = 30;
const SUBSTEPS: usize = 2;

/// Returns the states after each step, simulation by simulation.
fn plain_loop(count: usize) -> Vec<Vec<f64>> {
    let model = Arc::new(sample::humanoid());
    (0..count)
        .map(|index| {
            let mut data = Data::new(model.clone()).unwrap();
            start(index, &mut data);
            let mut states = Vec::new();
            for step in 0..STEPS {
                if step == 20 && index % 3 == 1 {
                    data.reset().unwrap();
                    start(index + 1, &mut data);
                }
                let observation = data.physics_state();
                policy(&observation, data.ctrl_mut());
                for _ in 0..SUBSTEPS {
                    data.step().unwrap();
                }
                states.extend(data.physics_state());
            }
            states
        })
        .collect()
}

#[test]
fn batches_equal_plain_loops_for_any_threads_and_chunks() {
    let count = 7;
    let expected = plain_loop(count);
    for (threads, chunk) in [(1, 1), (2, 1), (3, 2), (2, 3), (1, 7), (4, usize::MAX)] {
        let states = pool(threads).install(|| {
            let mut batch = Batch::new(sample::humanoid(), count).unwrap().substeps(SUBSTEPS).chunk(chunk);
            batch.reset_where(|_| true, start).unwrap();
            let mut states = vec![Vec::new(); count];
            for step in 0..STEPS {
                if step == 20 {
                    batch.reset_where(|index| index % 3 == 1, |index, data| start(index + 1, data)).unwrap();
                }
                batch
                    .step(|observations, controls| {
                        assert_eq!((observations.shape(), controls.shape()), ((7, 55), (7, 21)));
                        for (observation, row) in observations.rows().zip(controls.as_mut_slice().chunks_mut(21)) {
                            policy(observation, row);
                        }
                    })
                    .unwrap();
                for (states, row) in states.iter_mut().zip(batch.observations().rows()) {
                    states.extend_from_slice(row);
                }
            }
            states
        });
        for (index, (states, expected)) in states.iter().zip(&expected).enumerate() {
            assert!(bits(states) == bits(expected), "simulation {index}, {threads} threads, chunks of {chunk}");
        }
    }
}

#[test]
fn a_failure_stops_one_simulation_until_its_reset() {
    let mut batch = Batch::new(sample::cartpole(), 4).unwrap().chunk(1);
    let mut alone = Data::new(sample::cartpole()).unwrap();
    for step in 0..10 {
        batch
            .step(|_, controls| {
                controls.as_mut_slice().fill(0.1);
                if step == 3 {
                    controls.as_mut_slice()[2] = f64::NAN;
                }
            })
            .unwrap();
        alone.ctrl_mut()[0] = 0.1;
        alone.step().unwrap();
    }
    assert!(matches!(batch.failure(2), Some(Error::Unstable(_))));
    assert_eq!(batch.failures().map(|(index, _)| index).collect::<Vec<_>>(), [2]);
    assert!((batch.data(2).time() - 0.03).abs() < 1e-12, "the simulation has stopped");
    for index in [0, 1, 3] {
        assert_eq!(bits(batch.observations().row(index)), bits(&alone.physics_state()));
    }
    assert!(batch.observations().row(2).iter().all(|value| value.is_nan()));

    batch.reset(2).unwrap();
    assert!(batch.failure(2).is_none());
    assert_eq!(batch.observations().row(2), batch.data(2).physics_state());
    batch.step(|_, controls| controls.as_mut_slice().fill(0.1)).unwrap();
    assert!((batch.data(2).time() - 0.01).abs() < 1e-12);
    assert_eq!(batch.controls().as_slice(), [0.1; 4]);
}

#[test]
fn an_error_in_the_initial_state_stops_only_its_simulations() {
    let mut batch = Batch::new(sample::cartpole(), 5).unwrap().chunk(1);
    let error = batch
        .reset_where(|index| index != 0, |index, data| if index >= 3 { data.reset_to_key(10 + index) } else { Ok(()) })
        .unwrap_err();
    assert!(matches!(error, Error::NoSuchIndex { index: 13, .. }), "{error}");
    assert_eq!(batch.failures().map(|(index, _)| index).collect::<Vec<_>>(), [3, 4]);
    assert!(batch.failure(4).unwrap().to_string().contains("keyframe 14"));
    batch.reset_where(|_| true, |_, data| data.reset_to_key(0)).unwrap();
    assert!(batch.failures().next().is_none());
    assert_eq!(batch.data(4).qpos(), [0.0, 1.57]);
}

#[test]
fn an_error_of_the_policy_advances_no_simulation() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    let error = batch.step(|_, _| Err(Error::Unsupported("no idea".to_owned()))).unwrap_err();
    assert_eq!(error.to_string(), "no idea");
    assert!((0..3).all(|index| batch.data(index).time() == 0.0));
}

#[test]
fn a_panic_propagates_and_the_batch_remains_usable() {
    let late = 0.05;
    let mut batch = Batch::new(sample::cartpole(), 6).unwrap().chunk(1).observe(1, |data, row| {
        assert!(data.time() < late, "too late");
        row[0] = data.time();
    });
    assert!(catch_unwind(AssertUnwindSafe(|| batch.step(|_, _| assert!(late > 1.0, "no policy")))).is_err());
    assert!((0..6).all(|index| batch.data(index).time() == 0.0));
    let caught = pool(2).install(|| {
        catch_unwind(AssertUnwindSafe(|| {
            for _ in 0..10 {
                batch.step(|_, _| ()).unwrap();
            }
        }))
    });
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"too late"));
    batch.reset_where(|_| true, |_, _| ()).unwrap();
    batch.step(|_, _| ()).unwrap();
    assert_eq!(batch.observations().as_slice(), [0.01; 6]);
}

#[test]
fn each_simulation_may_have_its_own_edited_model() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    let edit = |index: usize, data: &mut Data| {
        data.qpos_mut()[1] = 0.2;
        data.edit_model(|model| model.body_mass_mut()[2] += index as f64)
    };
    batch.reset_where(|_| true, edit).unwrap();
    for _ in 0..20 {
        batch.step(|_, _| ()).unwrap();
    }
    for index in 0..3 {
        let mut data = Data::new(sample::cartpole()).unwrap();
        edit(index, &mut data).unwrap();
        (0..20).for_each(|_| data.step().unwrap());
        assert_eq!(bits(batch.observations().row(index)), bits(&data.state(StateSpec::PHYSICS)));
    }
    assert_eq!(batch.model().body_mass(), sample::cartpole().body_mass());
}

#[test]
fn replacing_a_simulation_is_a_failure_of_that_simulation() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    batch.reset_where(|index| index == 1, |_, data| *data = Data::new(sample::humanoid()).unwrap()).unwrap();
    batch.step(|_, _| ()).unwrap();
    assert!(matches!(batch.failure(1), Some(Error::Shape { .. })));
    assert_eq!(batch.failures().count(), 1);
}
