//! Rollouts equal plain loops bit for bit, independent of threads, chunks and buffers.

use mujoco_safe::data::{Timer, Warning};
use mujoco_safe::rollout::{Rollout, RolloutBuffers, Workers};
use mujoco_safe::{Controller, Data, RandomController, StateSpec, rayon, sample};

use super::{Case, Expected, bits, pool};

/// Returns every readable value of a simulation as text.
fn everything(data: &Data) -> Vec<(&'static str, String)> {
    macro_rules! read {
        ($($field:ident)*) => { vec![$((stringify!($field), format!("{:?}", data.$field()))),*] };
    }
    let mut all = data_readers! { read };
    all.push(("energy", format!("{:?}", data.energy())));
    all.push(("stage", format!("{:?} {}", data.stage(), data.contacts().len())));
    all.push(("solver", format!("{:?}", data.solver().collect::<Vec<_>>())));
    all.extend(Timer::ALL.map(|timer| ("timer", format!("{:?}", data.timer(timer)))));
    let warnings = [Warning::Inertia, Warning::ContactFull, Warning::ConstraintFull, Warning::BadQacc];
    all.extend(warnings.map(|warning| ("warning", format!("{:?}", data.warning(warning)))));
    all
}

#[test]
fn a_rollout_does_not_depend_on_the_previous_rollout() {
    for case in Case::all() {
        let new = everything(&Data::new(case.model.clone()).unwrap());
        // All rollouts run in one worker, each ending after steps with controls.
        let result = Rollout::new(case.model.clone(), case.count, case.steps)
            .with_chunk(case.count)
            .with_controllers(|index| {
                let (case, new) = (&case, &new);
                let mut step = 0;
                move |data: &mut Data| {
                    if step == 0 {
                        for (found, expected) in everything(data).iter().zip(new) {
                            assert_eq!(found, expected, "at the start of rollout {index}");
                        }
                        data.set_state(case.spec, case.initial_of(index)).unwrap();
                        data.mocap_pos_mut().fill([0.5; 3]);
                        data.mocap_quat_mut().fill([0.0, 1.0, 0.0, 0.0]);
                    }
                    data.ctrl_mut().copy_from_slice(case.controls_of(index, step));
                    step += 1;
                }
            })
            .run()
            .unwrap();
        assert!(result.outcomes().iter().all(Result::is_ok));
    }
}

fn rollout(case: &Case) -> Rollout<'_> {
    Rollout::new(case.model.clone(), case.count, case.steps)
        .with_initial_states(case.spec, &case.initial)
        .with_controls(&case.controls)
}

#[track_caller]
fn assert_gives(rollout: &Rollout<'_>, expected: &Expected) {
    let result = rollout.run().unwrap();
    for (index, outcome) in result.outcomes().iter().enumerate() {
        assert!(outcome.is_ok(), "rollout {index}: {outcome:?}");
    }
    assert!(bits(result.states()) == bits(&expected.states), "different states");
    assert!(bits(result.sensordata()) == bits(&expected.sensordata), "different sensor readings");
}

#[test]
fn rollouts_equal_plain_loops_for_any_threads_and_chunks() {
    for case in Case::all() {
        let expected = case.expected();
        assert_gives(&rollout(&case), &expected);
        for threads in [1, 2, 3, 5] {
            let pool = pool(threads);
            for chunk in [1, 2, 3, 5, usize::MAX] {
                pool.install(|| assert_gives(&rollout(&case).with_chunk(chunk), &expected));
            }
        }
    }
}

#[test]
fn shared_states_and_controls_apply_to_each_rollout() {
    let case = Case::new(sample::humanoid(), 1, 20);
    let one = case.expected();
    let result = Rollout::new(case.model.clone(), 5, 20)
        .with_initial_state(case.spec, &case.initial)
        .with_shared_controls(&case.controls)
        .with_chunk(2)
        .run()
        .unwrap();
    assert_eq!(result.len(), 5);
    for index in 0..5 {
        assert_eq!(bits(result.states_of(index).as_slice()), bits(&one.states));
        assert_eq!(bits(result.sensordata_of(index).as_slice()), bits(&one.sensordata));
    }
}

#[test]
fn controllers_act_as_in_a_plain_loop() {
    let (count, steps) = (6, 30);
    let model = std::sync::Arc::new(sample::humanoid());
    let make = |index: usize| {
        let mut random = RandomController::new(index as u64);
        move |data: &mut Data| {
            random.control(data)?;
            // Feedback from the state and from results of the previous step.
            let lean = data.qvel()[4] + 0.01 * data.qfrc_constraint()[3];
            data.ctrl_mut()[0] -= 0.1 * lean.clamp(-1.0, 1.0);
            Ok(())
        }
    };
    let mut expected = Vec::new();
    for index in 0..count {
        let mut data = Data::new(model.clone()).unwrap();
        let mut controller = make(index);
        for _ in 0..steps {
            controller.control(&mut data).unwrap();
            data.step().unwrap();
            expected.extend_from_slice(data.ctrl());
            expected.push(data.qfrc_constraint()[3]);
            expected.push(data.time());
        }
    }
    for chunk in [1, 4, 6] {
        let result = Rollout::new(model.clone(), count, steps)
            .with_controllers(make)
            .with_outputs(model.nu() + 2, |data, row| {
                let (ctrl, rest) = row.split_at_mut(data.ctrl().len());
                ctrl.copy_from_slice(data.ctrl());
                rest.copy_from_slice(&[data.qfrc_constraint()[3], data.time()]);
            })
            .with_chunk(chunk)
            .run()
            .unwrap();
        assert_eq!(bits(result.outputs()), bits(&expected));
        assert_eq!(result.outputs_of(5).row(29), &expected[expected.len() - model.nu() - 2..]);
    }
}

#[test]
fn the_requested_parts_of_the_state_are_recorded() {
    let case = Case::new(sample::cartpole(), 3, 10);
    let spec = StateSpec::TIME | StateSpec::QVEL | StateSpec::CTRL;
    let result = rollout(&case).with_recorded_states(spec).run().unwrap();
    let expected = case.expected();
    for index in 0..3 {
        let states = result.states_of(index);
        assert_eq!(states.shape(), (11, 4));
        for step in 0..=10 {
            let whole = &expected.states[(index * 11 + step) * 4..][..4];
            assert_eq!(&states.row(step)[1..3], &whole[2..]);
        }
        for step in 0..10 {
            assert_eq!(states.row(step + 1)[3], case.controls_of(index, step)[0]);
        }
        assert!((states[(10, 0)] - states[(0, 0)] - 0.1).abs() < 1e-12);
    }
}

#[test]
fn run_into_fills_any_subset_of_the_buffers() {
    let case = Case::new(sample::humanoid(), 4, 10);
    let expected = case.expected();
    let (mut states, mut sensordata) = (vec![7.0; expected.states.len()], vec![7.0; expected.sensordata.len()]);
    let all = RolloutBuffers { states: Some(&mut states), sensordata: Some(&mut sensordata), outputs: None };
    assert!(rollout(&case).run_into(all).unwrap().iter().all(Result::is_ok));
    assert_eq!((bits(&states), bits(&sensordata)), (bits(&expected.states), bits(&expected.sensordata)));
    states.fill(7.0);
    let some = RolloutBuffers { states: Some(&mut states), ..Default::default() };
    assert!(rollout(&case).with_chunk(1).run_into(some).unwrap().iter().all(Result::is_ok));
    assert_eq!(bits(&states), bits(&expected.states));
    assert_eq!(rollout(&case).run_into(RolloutBuffers::default()).unwrap().len(), 4);
}

#[test]
fn earlier_use_of_a_worker_has_no_effect() {
    let case = Case::new(sample::humanoid(), 6, 15);
    let expected = case.expected();
    let workers = Workers::new(case.model.clone());
    let again = || {
        Rollout::on(&workers, case.count, case.steps)
            .with_initial_states(case.spec, &case.initial)
            .with_controls(&case.controls)
    };
    let dirty: [fn(&mut Data); 6] = [
        |data| {
            data.xfrc_applied_mut().fill([1.0; 6]);
            data.qfrc_applied_mut().fill(1.0);
            data.qacc_warmstart_mut().fill(3.0);
            data.ctrl_mut().fill(0.5);
            data.set_time(9.0);
        },
        |data| data.qvel_mut().fill(f64::NAN),
        |data| data.qvel_mut().fill(1e9),
        |data| data.edit_model(|model| model.body_mass_mut().fill(3.0)).unwrap(),
        |data| *data = Data::new(sample::cartpole()).unwrap(),
        |data| *data = Data::new(sample::humanoid()).unwrap(),
    ];
    for (number, soil) in dirty.into_iter().enumerate() {
        let outcomes = Rollout::on(&workers, 3, 5).with_controllers(|_| soil).with_chunk(3).run().unwrap();
        assert_eq!(outcomes.len(), 3, "misuse {number} must not be an error of the run");
        assert_gives(&again().with_chunk(usize::MAX), &expected);
        assert_gives(&again().with_chunk(1), &expected);
    }
}

#[test]
fn concurrent_runs_on_the_same_workers_are_independent() {
    let case = Case::new(sample::cartpole(), 8, 50);
    let expected = case.expected();
    let rollout = rollout(&case).with_chunk(2);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_gives(&rollout, &expected));
        }
    });
}

#[test]
fn a_controller_may_use_parallelism() {
    let run = |parallel: bool| {
        let rollout = Rollout::new(sample::cartpole(), 40, 20).with_chunk(1).with_controllers(move |index| {
            move |data: &mut Data| {
                let half = |value: usize| value as f64 / 2.0;
                let (a, b) =
                    if parallel { rayon::join(|| half(index), || half(index)) } else { (half(index), half(index)) };
                data.ctrl_mut()[0] = (a + b) / 40.0;
            }
        });
        let result = pool(3).install(|| rollout.run()).unwrap();
        assert!(result.outcomes().iter().all(Result::is_ok));
        bits(result.states())
    };
    assert_eq!(run(true), run(false));
}
