//! Checks of sizes, one wrong size at a time, and empty rollouts.

use mujoco_safe::rollout::{Rollout, RolloutBuffers};
use mujoco_safe::{Batch, Error, Result, StateSpec, sample};

const NROLL: usize = 3;
const NSTEP: usize = 4;

fn new<'a>() -> Rollout<'a> {
    // One joint with one position and one velocity, and one motor.
    Rollout::new(sample::cartpole(), NROLL, NSTEP).with_outputs(5, |_, _| ())
}

#[track_caller]
fn assert_rejected<T>(result: Result<T>, argument: &str, expected: usize, found: usize) {
    match result {
        Err(Error::Shape { what, expected: (rows, 1), found: (wrong, 1) }) => {
            assert!(what.contains(argument), "{what}");
            assert_eq!((rows, wrong), (expected, found));
        }
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("a wrong length was accepted"),
    }
}

#[test]
fn inputs_of_a_wrong_length_are_rejected() {
    let values = [0.0; 40];
    for wrong in [0, 3, 5] {
        let rollout = new().with_initial_state(StateSpec::PHYSICS, &values[..wrong]);
        assert_rejected(rollout.run(), "the initial state (nstate)", 4, wrong);
    }
    for wrong in [0, 4, 11, 13] {
        let rollout = new().with_initial_states(StateSpec::PHYSICS, &values[..wrong]);
        assert_rejected(rollout.run(), "the initial states (nroll × nstate)", 12, wrong);
        let rollout = new().with_controls(&values[..wrong]);
        assert_rejected(rollout.run(), "the controls (nroll × nstep × nu)", 12, wrong);
        let rollout = new().with_controls(&values[..wrong]);
        assert_rejected(rollout.run_into(RolloutBuffers::default()), "the controls", 12, wrong);
    }
    for wrong in [0, 3, 5, 12] {
        let rollout = new().with_shared_controls(&values[..wrong]);
        assert_rejected(rollout.run(), "the shared controls (nstep × nu)", 4, wrong);
    }
}

#[test]
fn buffers_of_a_wrong_length_are_rejected() {
    let mut values = vec![0.0; 100];
    let states = NROLL * (NSTEP + 1) * 4;
    for wrong in [0, states - 1, states + 1] {
        let buffers = RolloutBuffers { states: Some(&mut values[..wrong]), ..Default::default() };
        assert_rejected(new().run_into(buffers), "states", states, wrong);
    }
    let outputs = NROLL * NSTEP * 5;
    for wrong in [0, outputs - 1, outputs + 1] {
        let buffers = RolloutBuffers { outputs: Some(&mut values[..wrong]), ..Default::default() };
        assert_rejected(new().run_into(buffers), "outputs", outputs, wrong);
    }
    let nsensordata = sample::cartpole().nsensordata();
    let buffers = RolloutBuffers { sensordata: Some(&mut values[..13]), ..Default::default() };
    assert_rejected(new().run_into(buffers), "sensor readings", NROLL * NSTEP * nsensordata, 13);
}

#[test]
fn zero_rollouts_and_zero_steps_are_valid() {
    let result = Rollout::new(sample::humanoid(), 0, 10).run().unwrap();
    assert!(result.is_empty() && result.states().is_empty() && result.outcomes().is_empty());
    let result = Rollout::new(sample::humanoid(), 2, 0).run().unwrap();
    assert_eq!(result.states_of(1).shape(), (1, 55));
    assert_eq!(result.state(1, 0)[..28], *sample::humanoid().qpos0());
    assert!(result.outcomes().iter().all(Result::is_ok) && result.sensordata().is_empty());
    let result =
        Rollout::new(sample::cartpole(), 2, 3).with_recorded_states(StateSpec::empty()).with_chunk(0).run().unwrap();
    assert_eq!(result.states_of(1).shape(), (4, 0));

    let mut batch = Batch::new(sample::cartpole(), 0).unwrap();
    batch.step(|observations, controls| assert_eq!((observations.nrows(), controls.shape()), (0, (0, 1)))).unwrap();
    batch.reset_where(|_| true, |_, _, _| ()).unwrap();
    assert!(batch.is_empty() && batch.failures().next().is_none());
}

#[test]
fn running_out_of_memory_is_an_error() {
    for (nroll, nstep) in [(usize::MAX, 1), (1, usize::MAX), (1 << 40, 1 << 40), (1 << 61, 0)] {
        let error = Rollout::new(sample::cartpole(), nroll, nstep).run().unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
    let error = Rollout::new(sample::cartpole(), usize::MAX, 1).run_into(RolloutBuffers::default()).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    // A product that overflows is not a valid length either.
    let rollout = Rollout::new(sample::cartpole(), 1 << 63, 2).with_controls(&[]);
    assert!(matches!(rollout.run(), Err(Error::Shape { .. })));
}

#[test]
fn too_many_simulations_for_memory_are_an_error_before_the_first() {
    for count in [usize::MAX, usize::MAX / 2, 1 << 61, 1 << 48, 1 << 40] {
        for model in [sample::cartpole(), sample::humanoid()] {
            match Batch::new(model, count) {
                Err(Error::Invalid { what, .. }) => assert_eq!(what, "the number of simulations"),
                Err(error) => panic!("{error}"),
                Ok(_) => panic!("{count} simulations"),
            }
        }
    }
    // A rollout that records no numbers takes memory for its outcome only.
    let model = mujoco_safe::Model::from_xml_str("<mujoco/>").unwrap();
    for count in [usize::MAX, 1 << 60, 1 << 48] {
        let error = Rollout::new(model.clone(), count, 0).run().unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        let rollout = Rollout::new(model.clone(), 1, 1).with_outputs(count, |_, _| ());
        assert!(matches!(rollout.run(), Err(Error::Invalid { .. })));
    }
}

#[test]
fn an_impossible_capacity_of_a_trajectory_is_ignored() {
    let mut data = mujoco_safe::Data::new(sample::humanoid()).unwrap();
    for records in [usize::MAX, usize::MAX / 55, 1 << 61, 1 << 48] {
        let mut trajectory = mujoco_safe::Trajectory::with_capacity(data.model(), records);
        trajectory.record(&mut data, &mut mujoco_safe::ZeroController, 2).unwrap();
        assert_eq!(trajectory.len(), 2);
    }
}

#[test]
#[should_panic(expected = "there is not enough memory for a matrix")]
fn a_matrix_without_memory_panics_and_does_not_abort() {
    mujoco_safe::Matrix::zeros(1 << 45, 2);
}

#[test]
#[should_panic(expected = "there is no rollout 3, only 3")]
fn a_rollout_index_out_of_range_panics() {
    let result = new().run().unwrap();
    result.states_of(NROLL);
}

#[test]
#[should_panic(expected = "row 5 of a matrix with 5 rows")]
fn a_step_index_out_of_range_panics() {
    let result = new().run().unwrap();
    result.state(0, NSTEP + 1);
}

#[test]
fn vector_environments_without_memory_are_errors() {
    use mujoco_safe::environment::{Hopper, VectorEnvironment};

    for count in [usize::MAX, usize::MAX / 2, 1 << 61, 1 << 48, 1 << 40] {
        let error = VectorEnvironment::new(Hopper::model(), Hopper, count, 1).map(|_| ()).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{count}: {error}");
        let two = VectorEnvironment::new(Hopper::model(), Hopper, 2, 1).unwrap();
        match two.with_action_delay(0..=count) {
            Err(Error::Invalid { what, .. }) => assert_eq!(what, "the number of steps of the delay"),
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("a delay of {count} steps"),
        }
    }
}

#[test]
#[should_panic(expected = "there is not enough memory for a matrix")]
fn observations_without_memory_panic_and_do_not_abort() {
    let _ = Batch::new(sample::cartpole(), 2).unwrap().with_observations(1 << 45, |_, _| ());
}
