//! Size checks, one wrong size at a time.

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, QuadraticCost, TrajectoryCost};
use mujoco_safe::control::riccati::RiccatiError;
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::{Controller, Data, Error, Lineariser, LqrWeights, Matrix, sample};
use nalgebra::DMatrix;

use super::{cartpole, weights};

#[track_caller]
fn assert_shape<T>(result: Result<T, Error>, expected: (usize, usize), found: (usize, usize)) {
    match result {
        Err(Error::Shape { expected: should, found: is, .. }) => assert_eq!((should, is), (expected, found)),
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("{found:?} was accepted instead of {expected:?}"),
    }
}

#[test]
fn a_gain_table_checks_sizes() {
    let data = cartpole();
    let table = |states: (usize, usize), controls: (usize, usize), count: usize, gain: (usize, usize)| {
        let gains = vec![Matrix::zeros(gain.0, gain.1); count];
        TimeVaryingLqr::with_gains(
            &data,
            Matrix::zeros(states.0, states.1),
            Matrix::zeros(controls.0, controls.1),
            gains,
        )
    };
    table((4, 4), (3, 1), 3, (1, 4)).unwrap();
    assert_shape(table((3, 4), (3, 1), 3, (1, 4)), (4, 4), (3, 4));
    assert_shape(table((4, 5), (3, 1), 3, (1, 4)), (4, 4), (4, 5));
    assert_shape(table((4, 4), (3, 2), 3, (1, 4)), (3, 1), (3, 2));
    assert_shape(table((4, 4), (3, 1), 2, (1, 4)), (3, 1), (2, 1));
    assert_shape(table((4, 4), (3, 1), 3, (2, 4)), (1, 4), (2, 4));
    assert_shape(table((4, 4), (3, 1), 3, (1, 3)), (1, 4), (1, 3));
    let error = table((1, 4), (0, 1), 0, (1, 4)).unwrap_err();
    assert!(error.to_string().contains("must be at least 1"), "{error}");
}

#[test]
fn a_time_varying_regulator_checks_sizes() {
    let data = cartpole();
    let mut transition = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let mut along = |states: (usize, usize), controls: (usize, usize), weights: LqrWeights, end: (usize, usize)| {
        let (states, controls) = (Matrix::zeros(states.0, states.1), Matrix::zeros(controls.0, controls.1));
        TimeVaryingLqr::along(&mut transition, &data, states, controls, &weights, &DMatrix::zeros(end.0, end.1))
    };
    along((4, 4), (3, 1), weights(), (4, 4)).unwrap();
    assert_shape(along((3, 4), (3, 1), weights(), (4, 4)), (4, 4), (3, 4));
    assert_shape(along((4, 3), (3, 1), weights(), (4, 4)), (4, 4), (4, 3));
    assert_shape(along((4, 4), (3, 2), weights(), (4, 4)), (3, 1), (3, 2));
    assert!(matches!(along((1, 4), (0, 1), weights(), (4, 4)), Err(Error::Invalid { .. })));
    for (weights, end) in [
        (weights(), (3, 3)),
        (weights(), (4, 3)),
        (LqrWeights::diagonal(&[1.0; 3], &[1.0]), (4, 4)),
        (LqrWeights::diagonal(&[1.0; 4], &[1.0; 2]), (4, 4)),
        (LqrWeights { s: Some(Matrix::zeros(4, 2)), ..weights() }, (4, 4)),
    ] {
        let error = along((4, 4), (3, 1), weights, end).expect_err("the weights do not fit");
        assert!(matches!(error.solver(), Some(RiccatiError::WrongShape { .. })), "{error}");
    }
}

#[test]
fn a_regulator_checks_the_simulation() {
    let data = cartpole();
    let gains = vec![Matrix::zeros(1, 4)];
    let mut follow = TimeVaryingLqr::with_gains(&data, Matrix::zeros(2, 4), Matrix::zeros(1, 1), gains).unwrap();
    let mut other = Data::new(sample::humanoid()).unwrap();
    assert_shape(follow.control(&mut other), (55, 1), (4, 1));
    // Two motors on two joints.
    let mut two_motors = Data::new(super::springs()).unwrap();
    assert_shape(follow.control(&mut two_motors), (2, 1), (1, 1));
}

#[test]
fn a_quadratic_cost_checks_sizes() {
    let cost = |state: usize, weights: LqrWeights, end: (usize, usize)| {
        QuadraticCost::new(sample::cartpole(), &vec![0.0; state], weights, DMatrix::zeros(end.0, end.1))
    };
    let good = cost(4, weights(), (4, 4)).unwrap();
    assert_shape(good.with_controls(&[0.0; 2]), (1, 1), (2, 1));
    assert_shape(cost(3, weights(), (4, 4)), (4, 1), (3, 1));
    assert_shape(cost(4, LqrWeights::diagonal(&[1.0; 5], &[1.0]), (4, 4)), (4, 4), (5, 5));
    assert_shape(cost(4, LqrWeights::diagonal(&[1.0; 4], &[1.0; 2]), (4, 4)), (1, 1), (2, 2));
    assert_shape(cost(4, LqrWeights { s: Some(Matrix::zeros(1, 4)), ..weights() }, (4, 4)), (4, 1), (1, 4));
    assert_shape(cost(4, weights(), (4, 3)), (4, 4), (4, 3));
}

#[test]
fn a_quadratic_cost_checks_states_and_controls() {
    let cost = QuadraticCost::new(sample::cartpole(), &[0.0; 4], weights(), DMatrix::zeros(4, 4)).unwrap();
    assert_shape(cost.value(0, &[0.0; 3], None), (4, 1), (3, 1));
    assert_shape(cost.value(0, &[0.0; 4], Some(&[0.0; 2])), (1, 1), (2, 1));
    let (states, controls) = (Matrix::zeros(3, 4), Matrix::zeros(3, 1));
    assert_shape(cost.total(states.view(), controls.view()), (4, 1), (3, 1));
}

#[test]
fn ilqr_checks_sizes() {
    let data = cartpole();
    let cost = QuadraticCost::new(data.model().clone(), &[0.0; 4], weights(), DMatrix::zeros(4, 4)).unwrap();
    let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default()).unwrap();
    assert_shape(solver.solve(&data, &Matrix::zeros(3, 2), &cost), (3, 1), (3, 2));
    assert!(matches!(solver.solve(&data, &Matrix::zeros(0, 1), &cost), Err(Error::Invalid { .. })));
    assert!(matches!(solver.solve(&cartpole(), &Matrix::zeros(3, 1), &cost), Err(Error::OtherModel { .. })));
}

#[test]
fn invalid_options_are_errors() {
    let good = IlqrOptions::default;
    for options in [
        good().with_threads(0),
        good().with_tolerance(-1.0),
        good().with_tolerance(f64::NAN),
        good().with_step_sizes(vec![]),
        good().with_step_sizes(vec![1.0, 0.0]),
        good().with_step_sizes(vec![1.5]),
        good().with_step_sizes(vec![f64::NAN]),
        good().with_sufficient_decrease(0.0),
        good().with_sufficient_decrease(f64::NAN),
    ] {
        assert!(matches!(Ilqr::new(sample::cartpole(), options), Err(Error::Invalid { .. })));
    }
    let options = good().with_iterations(7);
    assert_eq!(Ilqr::new(sample::cartpole(), options.clone()).unwrap().options(), &options);
}

#[test]
fn a_horizon_without_memory_is_an_error() {
    use mujoco_safe::control::predictive::IlqrPlanner;

    for horizon in [usize::MAX, usize::MAX / 2, 1 << 61, 1 << 48, 1 << 40] {
        match IlqrPlanner::new(sample::cartpole(), horizon, IlqrOptions::default()) {
            Err(Error::Invalid { what, .. }) => assert_eq!(what, "the number of steps"),
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("a horizon of {horizon} steps"),
        }
    }
    IlqrPlanner::new(sample::cartpole(), 1000, IlqrOptions::default()).unwrap();
}
