//! Regulators along trajectories.

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::{Controller, Data, Differences, Error, Lineariser, Lqr, Matrix, StateSpace, StateSpec, sample};
use nalgebra::DMatrix;

use super::{Random, assert_close, cartpole, weights};

/// Simulates without controls from the present state, and restores the state. Returns the
/// trajectory.
fn passive(data: &mut Data, steps: usize) -> (Matrix, Matrix) {
    let begin = data.state(StateSpec::INTEGRATION);
    let mut states = Matrix::zeros(steps + 1, data.model().state_size(StateSpec::PHYSICS));
    for step in 0..=steps {
        data.physics_state_into(states.row_mut(step)).unwrap();
        data.step().unwrap();
    }
    data.set_state(StateSpec::INTEGRATION, &begin).unwrap();
    (states, Matrix::zeros(steps, data.model().nu()))
}

fn transition(data: &Data) -> Lineariser {
    Lineariser::new(data.model().clone(), TransitionOptions::default().with_threads(2)).unwrap()
}

/// Returns the regulator along a pole that swings down and up twice.
fn swinging(data: &mut Data) -> TimeVaryingLqr {
    data.qpos_mut()[1] = 0.6;
    let (states, controls) = passive(data, 200);
    let terminal = DMatrix::identity(4, 4) * 10.0;
    TimeVaryingLqr::along(&mut transition(data), data, states, controls, &weights(), &terminal).unwrap()
}

#[test]
fn the_gains_are_those_of_the_systems_along_the_trajectory() {
    let mut data = cartpole();
    let follow = swinging(&mut data);
    assert_eq!((follow.steps(), follow.states().shape(), follow.controls().shape()), (200, (201, 4), (200, 1)));
    // The engine linearises the states one at a time.
    let systems: Vec<StateSpace> = (0..200)
        .map(|step| {
            data.set_physics_state(follow.states().row(step)).unwrap();
            data.transition_fd(1e-6, Differences::Central).unwrap()
        })
        .collect();
    let expected = TimeVaryingLqr::solve(systems.iter(), &weights(), &(DMatrix::identity(4, 4) * 10.0)).unwrap();
    for (found, expected) in follow.gains().iter().zip(&expected) {
        assert_close(&found.to_nalgebra(), &expected.to_nalgebra(), 1e-5);
    }
    // The gains change along the trajectory.
    assert!((follow.gains()[0].to_nalgebra() - follow.gains()[60].to_nalgebra()).norm() > 0.1);
}

#[test]
fn far_from_the_end_the_gain_at_a_set_point_is_that_of_the_regulator() {
    let mut data = cartpole();
    let lqr = Lqr::at_present_state(&mut data, &weights()).unwrap();
    let (states, controls) = (Matrix::zeros(3001, 4), Matrix::zeros(3000, 1));
    let follow =
        TimeVaryingLqr::along(&mut transition(&data), &data, states, controls, &weights(), &DMatrix::zeros(4, 4))
            .unwrap();
    assert_close(&follow.gains()[0].to_nalgebra(), &lqr.gain().to_nalgebra(), 1e-6);
    assert!(follow.gains()[2999].to_nalgebra().norm() < 1e-9, "the last control cannot reduce the cost");
}

#[test]
fn a_disturbed_simulation_returns_to_the_trajectory() {
    let mut data = cartpole();
    let mut follow = swinging(&mut data);
    let deviation = |follow: Option<&mut TimeVaryingLqr>| {
        let mut data = cartpole();
        data.qpos_mut().copy_from_slice(&[0.1, 0.5]);
        let mut controller: Box<dyn Controller + '_> = match follow {
            Some(follow) => Box::new(|data: &mut Data| follow.control(data)),
            None => Box::new(|_: &mut Data| ()),
        };
        for _ in 0..200 {
            controller.control(&mut data).unwrap();
            data.step().unwrap();
        }
        data.qpos().to_vec()
    };
    let end = follow.states().row(200).to_vec();
    let (with, without) = (deviation(Some(&mut follow)), deviation(None));
    let error = |qpos: &[f64]| (qpos[0] - end[0]).abs() + (qpos[1] - end[1]).abs();
    assert!(error(&with) < 0.02, "{with:?} instead of {end:?}");
    assert!(error(&without) > 0.2, "{without:?} is where {end:?} is without control");
}

#[test]
fn the_row_is_determined_by_the_time() {
    let mut data = cartpole();
    data.set_time(5.0);
    let mut follow = swinging(&mut data);
    assert_eq!(follow.start(), 5.0);
    for (time, row) in [
        (-1e300, 0),
        (0.0, 0),
        (4.994, 0),
        (5.0, 0),
        (5.004, 0),
        (5.006, 1),
        (5.01, 1),
        (6.0, 100),
        (6.99, 199),
        (7.0, 200),
        (7.01, 200),
        (1e300, 200),
        (f64::NAN, 0),
    ] {
        data.set_time(time);
        assert_eq!(follow.row(&data), row, "at {time} s");
    }
    follow.set_start(0.0);
    data.set_time(1.0);
    assert_eq!(follow.row(&data), 100);
    // Time accumulated over steps has rounding errors.
    data.set_time(0.0);
    for step in 0..150 {
        assert_eq!(follow.row(&data), step);
        data.step().unwrap();
    }
}

#[test]
fn times_outside_of_the_table_use_the_first_or_last_row() {
    let mut data = cartpole();
    let mut random = Random::new(3);
    let mut matrix = |rows: usize, columns: usize| {
        Matrix::from_row_major(rows, columns, (0..rows * columns).map(|_| 0.01 * random.number()).collect())
    };
    let (states, controls) = (matrix(4, 4), matrix(3, 1));
    let gains: Vec<Matrix> = (0..3).map(|_| matrix(1, 4)).collect();
    let mut follow = TimeVaryingLqr::with_gains(&data, states.clone(), controls.clone(), gains.clone()).unwrap();
    data.qpos_mut().copy_from_slice(&[0.02, -0.03]);
    data.qvel_mut().copy_from_slice(&[0.05, 0.01]);
    for (time, row, step) in [(-3.0, 0, 0), (0.0, 0, 0), (0.01, 1, 1), (0.02, 2, 2), (0.03, 3, 2), (9.0, 3, 2)] {
        data.set_time(time);
        follow.control(&mut data).unwrap();
        let state = [data.qpos()[0], data.qpos()[1], data.qvel()[0], data.qvel()[1]];
        let feedback: f64 = (0..4).map(|i| gains[step][(0, i)] * (state[i] - states[(row, i)])).sum();
        let expected = controls[(step, 0)] - feedback;
        assert!((data.ctrl()[0] - expected).abs() < 1e-15, "at {time} s");
    }
}

#[test]
fn a_table_of_one_row_is_the_regulator_about_a_set_point() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let (nx, nu) = (54, 21);
    let mut random = Random::new(5);
    let gain = Matrix::from_row_major(nu, nx, (0..nu * nx).map(|_| 0.01 * random.number()).collect());
    let mut lqr = Lqr::with_gain(&data, gain.clone()).unwrap();
    let state = data.physics_state();
    let states = Matrix::from_row_major(2, state.len(), [state.clone(), state].concat());
    let controls = Matrix::from_row_major(1, nu, data.ctrl().to_vec());
    let mut follow = TimeVaryingLqr::with_gains(&data, states, controls, vec![gain]).unwrap();
    for _ in 0..20 {
        data.step().unwrap();
    }
    lqr.control(&mut data).unwrap();
    let expected: Vec<f64> = data.ctrl().iter().map(|ctrl| ctrl.clamp(-1.0, 1.0)).collect();
    follow.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), expected);
    assert!(expected.iter().any(|ctrl| *ctrl != 0.0));
}

#[test]
fn controls_stay_within_their_ranges() {
    let mut data = cartpole();
    let mut follow = swinging(&mut data);
    for position in [1e3, -1e3] {
        data.qpos_mut()[0] = position;
        follow.control(&mut data).unwrap();
        assert_eq!(data.ctrl()[0], -(follow.gains()[0][(0, 0)] * position).signum());
    }
    // A range with reversed limits does not panic.
    data.edit_model(|model| model.actuator_ctrlrange_mut()[0] = [1.0, -1.0]).unwrap();
    follow.control(&mut data).unwrap();
    // Without a range, controls are not clamped.
    let springs = super::springs();
    let mut data = Data::new(springs).unwrap();
    let far = Matrix::from_rows(&[[100.0, 0.0, 0.0, 0.0], [100.0, 0.0, 0.0, 0.0]]);
    let gains = vec![Matrix::from_rows(&[[1.0, 0.0, 0.0, 0.0], [0.0; 4]])];
    let mut pull = TimeVaryingLqr::with_gains(&data, far, Matrix::zeros(1, 2), gains).unwrap();
    pull.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), [100.0, 0.0]);
}

#[test]
fn a_table_that_exceeds_the_memory_is_an_error() {
    let data = Data::new(sample::cartpole()).unwrap();
    for steps in [0, 1 << 40, usize::MAX] {
        let error = TimeVaryingLqr::hold_controls(&data, steps).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
}
