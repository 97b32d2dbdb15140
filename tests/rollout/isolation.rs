//! An error affects only its rollout. A panic or a cancellation ends the run without lasting
//! effects.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

use mujoco_safe::rollout::{Rollout, RolloutBuffers, RolloutError, RolloutResult, Workers};
use mujoco_safe::{Data, Error, StateSpec, sample};

use super::{Case, bits, pool, trouble};

/// Asserts that the rows of a rollout are finite up to this step, and NaN afterwards.
#[track_caller]
fn assert_marked(result: &RolloutResult, rollout: usize, step: usize) {
    let rows = |view: mujoco_safe::MatrixView<'_>| -> Vec<bool> {
        view.rows().filter(|row| !row.is_empty()).map(|row| row.iter().all(|value| value.is_nan())).collect()
    };
    let expected = |written: usize, rows: usize| (0..rows).map(|row| row >= written).collect::<Vec<_>>();
    let steps = result.steps();
    assert_eq!(rows(result.states_of(rollout)), expected(step + 1, steps + 1));
    assert_eq!(rows(result.outputs_of(rollout)), expected(step, steps));
    if !result.sensordata().is_empty() {
        assert_eq!(rows(result.sensordata_of(rollout)), expected(step, steps));
    }
}

#[test]
fn a_nan_ends_its_own_rollout_at_its_step() {
    let mut case = Case::new(sample::humanoid(), 6, 12);
    let expected = case.expected();
    let nu = case.model.nu();
    case.controls[(2 * 12 + 7) * nu + 3] = f64::NAN;
    let velocity = case.model.state_size(StateSpec::TIME | StateSpec::QPOS);
    let size = case.model.state_size(case.spec);
    case.initial[4 * size + velocity] = f64::INFINITY;
    for chunk in [1, 2, 6] {
        let result = Rollout::new(case.model.clone(), case.count, case.steps)
            .with_initial_states(case.spec, &case.initial)
            .with_controls(&case.controls)
            .with_outputs(1, |data, row| row[0] = data.time())
            .with_chunk(chunk)
            .run()
            .unwrap();
        for (index, outcome) in result.outcomes().iter().enumerate() {
            let block = &expected.states[index * 13 * 55..][..13 * 55];
            match (index, outcome) {
                (2, Err(RolloutError::Failed { step: 7, error: Error::Unstable(unstable) })) => {
                    assert_eq!(unstable.index, 3);
                    assert_marked(&result, 2, 7);
                    assert_eq!(bits(&result.states_of(2).as_slice()[..8 * 55]), bits(&block[..8 * 55]));
                }
                (4, Err(RolloutError::Failed { step: 0, error: Error::Unstable(_) })) => assert_marked(&result, 4, 0),
                (_, Ok(())) if index != 2 && index != 4 => {
                    assert_eq!(bits(result.states_of(index).as_slice()), bits(block));
                }
                _ => panic!("rollout {index}: {outcome:?}"),
            }
        }
    }
}

#[test]
fn an_engine_error_ends_its_own_rollout_at_its_step() {
    // Balls from several heights, and a stack too small for contacts: each rollout fails when its
    // ball lands.
    let model = std::sync::Arc::new(trouble::overflowing());
    let heights: Vec<f64> = (0..6).flat_map(|index| [0.0, 0.0, 0.15 + 0.3 * f64::from(index)]).collect();
    let initial: Vec<f64> = heights.chunks(3).flat_map(|place| [place, &[1.0, 0.0, 0.0, 0.0]].concat()).collect();
    let steps = 150;
    let landing = |index: usize| {
        let mut data = Data::new(model.clone()).unwrap();
        data.qpos_mut().copy_from_slice(&initial[index * 7..][..7]);
        (0..steps).find(|_| data.step().is_err())
    };
    let expected: Vec<Option<usize>> = (0..6).map(landing).collect();
    assert!(expected[0].is_some() && expected[5].is_none(), "some land and some do not: {expected:?}");
    for chunk in [1, 6] {
        let result = Rollout::new(model.clone(), 6, steps)
            .with_initial_states(StateSpec::QPOS, &initial)
            .with_outputs(1, |data, row| row[0] = data.time())
            .with_chunk(chunk)
            .run()
            .unwrap();
        for (index, (outcome, expected)) in result.outcomes().iter().zip(&expected).enumerate() {
            match (outcome, expected) {
                (Ok(()), None) => assert_marked(&result, index, steps),
                (Err(RolloutError::Failed { step, error: Error::Engine { .. } }), Some(landing)) => {
                    assert_eq!(step, landing);
                    assert_marked(&result, index, *step);
                }
                _ => panic!("rollout {index}: {outcome:?}, but {expected:?}"),
            }
        }
    }
}

#[test]
fn an_error_of_a_controller_has_its_step() {
    let result = Rollout::new(sample::cartpole(), 4, 10)
        .with_controllers(|index| {
            let mut calls = 0;
            move |data: &mut Data| {
                calls += 1;
                if index == 1 && calls == 5 { data.reset_to_key("no such key") } else { Ok(()) }
            }
        })
        .with_outputs(1, |data, row| row[0] = data.time())
        .run()
        .unwrap();
    let error = result.outcomes()[1].as_ref().unwrap_err();
    assert_eq!(error.step(), 4);
    assert!(error.to_string().starts_with("step 4: there is no keyframe named 'no such key'"), "{error}");
    assert_marked(&result, 1, 4);
    assert_eq!(result.outcomes().iter().filter(|outcome| outcome.is_ok()).count(), 3);
}

#[test]
fn replacing_the_simulation_is_an_error_of_that_rollout() {
    let result = Rollout::new(sample::humanoid(), 3, 5)
        .with_controllers(|index| {
            move |data: &mut Data| {
                if index == 1 {
                    *data = Data::new(sample::cartpole()).unwrap();
                }
            }
        })
        .run()
        .unwrap();
    let failed: Vec<bool> = result.outcomes().iter().map(Result::is_err).collect();
    assert_eq!(failed, [false, true, false]);
    assert!(matches!(result.outcomes()[1], Err(RolloutError::Failed { step: 0 | 1, error: Error::Shape { .. } })));
}

#[test]
fn the_progress_hook_counts_every_rollout_once() {
    let counts = Mutex::new(Vec::new());
    let rollout = Rollout::new(sample::cartpole(), 25, 5).with_chunk(2).with_progress(|done| {
        counts.lock().unwrap().push(done);
        ControlFlow::Continue(())
    });
    pool(3).install(|| rollout.run()).unwrap();
    drop(rollout);
    let mut counts = counts.into_inner().unwrap();
    counts.sort_unstable();
    assert_eq!(counts, (1..=25).collect::<Vec<_>>());
}

#[test]
fn a_cancelled_run_keeps_finished_rollouts_and_marks_the_rest() {
    let case = Case::new(sample::cartpole(), 20, 30);
    let expected = case.expected();
    for threads in [1, 3] {
        let rollout = Rollout::new(case.model.clone(), case.count, case.steps)
            .with_initial_states(case.spec, &case.initial)
            .with_controls(&case.controls)
            .with_chunk(2)
            .with_progress(|done| if done == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) });
        let result = pool(threads).install(|| rollout.run()).unwrap();
        let mut done = 0;
        for (index, outcome) in result.outcomes().iter().enumerate() {
            match outcome {
                Ok(()) => {
                    done += 1;
                    let block = &expected.states[index * 31 * 4..][..31 * 4];
                    assert_eq!(bits(result.states_of(index).as_slice()), bits(block));
                }
                Err(RolloutError::Cancelled { step }) => {
                    assert!(*step < 30);
                    assert!(result.state(index, 30).iter().all(|value| value.is_nan()));
                }
                Err(error) => panic!("rollout {index}: {error}"),
            }
        }
        // Other rollouts may end before the hook returns.
        assert!((5..5 + threads).contains(&done), "{done} rollouts with {threads} threads");
    }
}

#[test]
fn a_running_rollout_can_be_cancelled() {
    let rollout = Rollout::new(sample::cartpole(), 2, 100_000_000)
        .with_controllers(|index| {
            move |_: &mut Data| if index == 0 { Err(Error::Unsupported("given up".to_owned())) } else { Ok(()) }
        })
        .with_chunk(1)
        .with_progress(|_| ControlFlow::Break(()));
    let outcomes = pool(2).install(|| rollout.run_into(RolloutBuffers::default())).unwrap();
    assert!(matches!(outcomes[0], Err(RolloutError::Failed { step: 0, error: Error::Unsupported(_) })));
    assert!(matches!(outcomes[1], Err(RolloutError::Cancelled { .. })));
}

#[test]
fn a_panic_propagates_without_lasting_effects() {
    let case = Case::new(sample::cartpole(), 12, 20);
    let expected = case.expected();
    let workers = Workers::new(case.model.clone());
    let new = || Rollout::on(&workers, case.count, case.steps).with_initial_states(case.spec, &case.initial);
    let panicking = |index: usize| move |_: &mut Data| assert!(index != 3, "rollout 3 of many panics");
    let panicking: [Rollout<'_>; 4] = [
        new().with_controllers(panicking),
        new()
            .with_controls(&case.controls)
            .with_outputs(1, |data, _| assert!(data.time() < 0.15, "rollout 3 of many panics")),
        new()
            .with_controls(&case.controls)
            .with_model_edits(|index, _| assert!(index != 3, "rollout 3 of many panics")),
        new().with_controls(&case.controls).with_progress(|_| panic!("rollout 3 of many panics")),
    ];
    for threads in [1, 3] {
        let pool = pool(threads);
        for rollout in &panicking {
            let caught = pool.install(|| catch_unwind(AssertUnwindSafe(|| rollout.run()))).unwrap_err();
            assert_eq!(caught.downcast_ref::<&str>(), Some(&"rollout 3 of many panics"));
            let result = pool.install(|| new().with_controls(&case.controls).run()).unwrap();
            assert_eq!(bits(result.states()), bits(&expected.states));
        }
    }
}
