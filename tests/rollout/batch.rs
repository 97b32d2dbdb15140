//! A batch equals the same number of plain loops in lockstep.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::{Batch, Controller, Data, Error, RandomController, Result, StateSpec, sample};

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
            let mut batch = Batch::new(sample::humanoid(), count).unwrap().with_substeps(SUBSTEPS).with_chunk(chunk);
            batch.reset_where(|_| true, |index, _, data| start(index, data)).unwrap();
            let mut states = vec![Vec::new(); count];
            for step in 0..STEPS {
                if step == 20 {
                    batch.reset_where(|index| index % 3 == 1, |index, _, data| start(index + 1, data)).unwrap();
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
    let mut batch = Batch::new(sample::cartpole(), 4).unwrap().with_chunk(1);
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
    assert!((batch.data(2).unwrap().time() - 0.03).abs() < 1e-12, "the simulation has stopped");
    for index in [0, 1, 3] {
        assert_eq!(bits(batch.observations().row(index)), bits(&alone.physics_state()));
    }
    assert!(batch.observations().row(2).iter().all(|value| value.is_nan()));

    batch.reset(2).unwrap();
    assert!(batch.failure(2).is_none());
    assert_eq!(batch.observations().row(2), batch.data(2).unwrap().physics_state());
    batch.step(|_, controls| controls.as_mut_slice().fill(0.1)).unwrap();
    assert!((batch.data(2).unwrap().time() - 0.01).abs() < 1e-12);
    assert_eq!(batch.controls().as_slice(), [0.1; 4]);
}

#[test]
fn an_error_in_the_initial_state_stops_only_its_simulations() {
    let mut batch = Batch::new(sample::cartpole(), 5).unwrap().with_chunk(1);
    let error = batch
        .reset_where(
            |index| index != 0,
            |index, _, data| if index >= 3 { data.reset_to_key(10 + index) } else { Ok(()) },
        )
        .unwrap_err();
    assert!(matches!(error, Error::NoSuchIndex { index: 13, .. }), "{error}");
    assert_eq!(batch.failures().map(|(index, _)| index).collect::<Vec<_>>(), [3, 4]);
    assert!(batch.failure(4).unwrap().to_string().contains("keyframe 14"));
    batch.reset_where(|_| true, |_, _, data| data.reset_to_key(0)).unwrap();
    assert!(batch.failures().next().is_none());
    assert_eq!(batch.data(4).unwrap().qpos(), [0.0, 1.57]);
}

#[test]
fn an_error_of_the_policy_advances_no_simulation() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    let error = batch.step(|_, _| Err(Error::Unsupported("no idea".to_owned()))).unwrap_err();
    assert_eq!(error.to_string(), "no idea");
    assert!((0..3).all(|index| batch.data(index).unwrap().time() == 0.0));
}

#[test]
fn a_panic_propagates_and_the_batch_remains_usable() {
    let late = 0.05;
    let mut batch = Batch::new(sample::cartpole(), 6).unwrap().with_chunk(1).with_observations(1, |data, row| {
        assert!(data.time() < late, "too late");
        row[0] = data.time();
    });
    assert!(catch_unwind(AssertUnwindSafe(|| batch.step(|_, _| assert!(late > 1.0, "no policy")))).is_err());
    assert!((0..6).all(|index| batch.data(index).unwrap().time() == 0.0));
    let caught = pool(2).install(|| {
        catch_unwind(AssertUnwindSafe(|| {
            for _ in 0..10 {
                batch.step(|_, _| ()).unwrap();
            }
        }))
    });
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"too late"));
    batch.reset_where(|_| true, |_, _, _| ()).unwrap();
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
    batch.reset_where(|_| true, |index, _, data| edit(index, data)).unwrap();
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
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap().with_chunk(3);
    let error =
        batch.reset_where(|index| index == 1, |_, _, data| *data = Data::new(sample::humanoid()).unwrap()).unwrap_err();
    assert!(matches!(error, Error::OtherModel { .. }), "{error}");
    batch.step(|_, controls| controls.as_mut_slice().fill(0.1)).unwrap();
    assert_eq!(batch.failures().map(|(index, _)| index).collect::<Vec<_>>(), [1]);
    let mut alone = Data::new(sample::cartpole()).unwrap();
    alone.ctrl_mut()[0] = 0.1;
    alone.step().unwrap();
    for index in [0, 2] {
        assert_eq!(bits(batch.observations().row(index)), bits(&alone.physics_state()));
    }
    assert!(matches!(batch.load(0, &mut Data::new(sample::humanoid()).unwrap()), Err(Error::OtherModel { .. })));
}

#[test]
fn a_simulation_left_unusable_by_a_closure_has_failed() {
    let mut batch = Batch::new(sample::cartpole(), 2).unwrap();
    let error = batch
        .reset_where(
            |index| index == 0,
            |_, _, data| {
                data.qfrc_applied_mut()[0] = 1e300;
                assert!(data.step().is_err());
            },
        )
        .unwrap_err();
    assert!(matches!(error, Error::Poisoned { .. }), "{error}");
    batch.step(|_, _| ()).unwrap();
    assert_eq!(batch.failures().map(|(index, _)| index).collect::<Vec<_>>(), [0]);
}

#[test]
fn a_panic_of_a_closure_keeps_the_edited_model_of_its_simulation() {
    let mut batch = Batch::new(sample::cartpole(), 2).unwrap().with_chunk(2);
    let heavier = |data: &mut Data| data.edit_model(|model| model.body_mass_mut()[2] *= 2.0);
    batch.reset_where(|index| index == 1, |_, _, data| heavier(data)).unwrap();
    let panics = |_: usize, _: &mut Data| -> Result<()> { panic!("no edit") };
    let caught = catch_unwind(AssertUnwindSafe(|| batch.edit_where(|index| index == 1, panics)));
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"no edit"));
    let mut alone = Data::new(sample::cartpole()).unwrap();
    heavier(&mut alone).unwrap();
    alone.ctrl_mut()[0] = 0.1;
    alone.step().unwrap();
    batch.step(|_, controls| controls.as_mut_slice().fill(0.1)).unwrap();
    assert_eq!(bits(batch.observations().row(1)), bits(&alone.physics_state()));
    assert_ne!(batch.observations().row(0), batch.observations().row(1));
}

#[test]
fn controls_start_from_zero_after_a_reset() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    batch.step(|_, controls| controls.as_mut_slice().fill(0.5)).unwrap();
    batch
        .reset_where(|index| index != 0, |index, _, data| data.ctrl_mut()[0] = if index == 2 { 0.25 } else { 0.0 })
        .unwrap();
    assert_eq!(batch.controls().as_slice(), [0.5, 0.0, 0.25]);
    let mut expected = Data::new(sample::cartpole()).unwrap();
    expected.ctrl_mut()[0] = 0.25;
    expected.step().unwrap();
    batch.step(|_, _| ()).unwrap();
    assert_eq!(bits(batch.observations().row(2)), bits(&expected.physics_state()));
}

#[test]
fn the_number_of_an_episode_counts_the_resets_of_its_simulation() {
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    let episodes = |batch: &Batch<'_>| [batch.episode(0), batch.episode(1), batch.episode(2)];
    assert_eq!(episodes(&batch), [0, 0, 0]);
    batch.reset_where(|_| true, |_, _, _| ()).unwrap();
    batch.step(|_, _| ()).unwrap();
    batch.reset_where(|index| index == 1, |_, _, _| ()).unwrap();
    batch.reset(2).unwrap();
    batch.reset(2).unwrap();
    assert_eq!(episodes(&batch), [1, 2, 3]);
    // A reset whose closure fails has started an episode, so that the next attempt has another
    // seed.
    let seen = std::sync::Mutex::new(Vec::new());
    let result = batch.reset_where(
        |_| true,
        |index, episode, data| {
            seen.lock().unwrap().push((index, episode));
            if index == 0 { data.reset_to_key("nothing") } else { Ok(()) }
        },
    );
    assert!(result.is_err());
    let mut seen = seen.into_inner().unwrap();
    seen.sort_unstable();
    assert_eq!(seen, [(0, 2), (1, 3), (2, 4)]);
    assert_eq!(episodes(&batch), [2, 3, 4]);
}

/// Sets a state that depends on the index and the episode only.
fn random_start(index: usize, episode: u64, data: &mut Data) -> mujoco_safe::Result<()> {
    let mut random = RandomController::new(1000 * index as u64 + episode);
    for _ in 0..3 {
        random.control(data)?;
        data.step()?;
    }
    Ok(())
}

/// Returns `true` if a call resets the simulation of an index.
type Order = fn(usize, usize) -> bool;

#[test]
fn episodes_start_alike_for_any_threads_and_any_order_of_resets() {
    const EPISODES: u64 = 4;
    let count = 5;
    // Each episode in a separate simulation, without a batch.
    let alone = |index, episode| {
        let mut data = Data::new(sample::humanoid()).unwrap();
        random_start(index, episode, &mut data).unwrap();
        bits(&data.state(StateSpec::INTEGRATION))
    };
    let expected: Vec<Vec<_>> =
        (0..count).map(|index| (1..=EPISODES).map(|episode| alone(index, episode)).collect()).collect();
    // All together, one after the other, and simulation by simulation.
    let orders: [(usize, Order); 3] =
        [(4, |_, _| true), (20, |call, index| call % 5 == index), (20, |call, index| call / 4 == index)];
    for ((calls, which), (threads, chunk)) in
        orders.into_iter().flat_map(|order| [(1, 1), (1, 2), (3, 1), (3, 2)].map(|division| (order, division)))
    {
        pool(threads).install(|| {
            let mut batch = Batch::new(sample::humanoid(), count).unwrap().with_chunk(chunk);
            for call in 0..calls {
                batch.reset_where(|index| which(call, index), random_start).unwrap();
                for index in (0..count).filter(|&index| which(call, index)) {
                    let state = bits(&batch.data(index).unwrap().state(StateSpec::INTEGRATION));
                    assert!(
                        state == expected[index][batch.episode(index) as usize - 1],
                        "simulation {index}, reset {call}"
                    );
                }
                // Motion between the resets has no effect on the next start.
                batch.step(|_, controls| controls.as_mut_slice().fill(0.3)).unwrap();
            }
            assert!((0..count).all(|index| batch.episode(index) == EPISODES));
        });
    }
}
