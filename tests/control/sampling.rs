//! Predictive control by sampling.

use std::sync::{Arc, LazyLock};

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{QuadraticCost, TrajectoryCost};
use mujoco_safe::control::predictive::{
    Interpolation, PlanReport, Planner, PredictiveController, SamplingOptions, SamplingPlanner,
    ThreadedPredictiveController,
};
use mujoco_safe::{Controller, Data, Error, Lqr, LqrWeights, Matrix, Model, Result, sample};
use nalgebra::DMatrix;

use super::{cartpole, springs};

const HORIZON: usize = 40;

/// Distance of the pole from upright and of the cart from the centre, velocities and effort. It has
/// no derivatives.
struct Upright;

impl TrajectoryCost for Upright {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        let [x, angle, velocity, rate] = *state else { panic!("a state of the cart-pole has four values") };
        let effort = controls.map_or(0.0, |controls| 0.02 * controls[0] * controls[0]);
        let height = 1.0 - angle.cos();
        // Velocity is needed below, and unwanted at the top.
        let calm = (1.0 - height).max(0.0);
        Ok(height + 0.4 * x * x + 0.02 * velocity * velocity + 0.02 * calm * rate * rate + effort)
    }
}

/// Returns a simulation of one model, so that all planners accept it.
fn tilted() -> Data {
    static MODEL: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(sample::cartpole()));
    let mut data = Data::new(&*MODEL).unwrap();
    data.qpos_mut()[1] = 0.3;
    data
}

fn planner(data: &Data, options: SamplingOptions) -> SamplingPlanner {
    SamplingPlanner::new(data.model(), HORIZON, options).unwrap()
}

/// Plans repeatedly, every third step. Returns the plans with the controls and the final states.
fn plans(mut planner: SamplingPlanner, count: usize) -> Vec<(PlanReport, Vec<f64>)> {
    let mut data = tilted();
    let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
    let mut plan = || {
        let report = planner.plan(&data, &Upright, &mut policy).unwrap();
        for _ in 0..3 {
            policy.control(&mut data).unwrap();
            data.step().unwrap();
        }
        (report, [policy.controls().as_slice(), &data.physics_state()].concat())
    };
    (0..count).map(|_| plan()).collect()
}

#[test]
fn a_plan_depends_on_the_seed_but_not_on_the_number_of_threads() {
    for temperature in [0.0, 0.5] {
        let options = SamplingOptions::default().with_samples(12).with_iterations(2).with_temperature(temperature);
        let run = |options: &SamplingOptions| plans(planner(&tilted(), options.clone()), 5);
        let first = run(&options);
        for threads in [1, 2, 5] {
            assert_eq!(run(&options.clone().with_threads(threads)), first, "{threads} threads");
        }
        assert_ne!(run(&options.clone().with_seed(1)), first);
    }
}

#[test]
fn iterations_of_predictive_sampling_never_increase_the_cost() {
    for interpolation in [Interpolation::Zero, Interpolation::Linear, Interpolation::Cubic] {
        let options = SamplingOptions::default().with_samples(8).with_interpolation(interpolation);
        let reports = plans(planner(&tilted(), options.clone()), 20);
        assert!(reports.iter().all(|(report, _)| report.cost <= report.initial_cost), "{reports:?}");
        assert!(reports.iter().any(|(report, _)| report.cost < report.initial_cost));
        // The same plan with one iteration more starts with the same random numbers.
        let cost = |iterations| {
            let mut planner = planner(&tilted(), options.clone().with_iterations(iterations));
            let data = tilted();
            let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
            planner.plan(&data, &Upright, &mut policy).unwrap().cost
        };
        let costs: Vec<f64> = (1..=8).map(cost).collect();
        assert!(costs.windows(2).all(|pair| pair[1] <= pair[0]), "{costs:?}");
        assert!(costs[7] < costs[0]);
    }
}

#[test]
fn the_cost_of_the_plan_is_that_of_its_trajectory() {
    for temperature in [0.0, 0.2] {
        let mut data = tilted();
        let mut planner = planner(&data, SamplingOptions::default().with_temperature(temperature));
        let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
        let report = planner.plan(&data, &Upright, &mut policy).unwrap();
        let mut states = Matrix::zeros(HORIZON + 1, 4);
        for step in 0..=HORIZON {
            states.row_mut(step).copy_from_slice(&data.physics_state());
            policy.control(&mut data).unwrap();
            data.step().unwrap();
        }
        assert_eq!(policy.states(), &states);
        assert_eq!(Upright.total(states.view(), policy.controls().view()).unwrap(), report.cost);
    }
}

/// Distance of the controls from those of a plan some steps earlier. The plan is optimal.
struct Keep(Matrix, usize);

impl TrajectoryCost for Keep {
    fn value(&self, step: usize, _state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        let row = (step + self.1).min(HORIZON - 1);
        Ok(controls.map_or(0.0, |controls| (controls[0] - self.0.row(row)[0]).abs().min(1.0)))
    }
}

#[test]
fn an_optimal_plan_is_kept_without_interpolation() {
    for interpolation in [Interpolation::Zero, Interpolation::Linear] {
        let options = SamplingOptions::default().with_samples(1).with_interpolation(interpolation);
        let (mut data, deviations) = (tilted(), SamplingOptions::default().with_interpolation(interpolation));
        let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
        let mut noisy = planner(&data, deviations.with_samples(16));
        noisy.plan(&data, &Upright, &mut policy).unwrap();
        let before = policy.controls().clone();
        for _ in 0..7 {
            data.step().unwrap();
        }
        let report = noisy.plan(&data, &Keep(before.clone(), 7), &mut policy).unwrap();
        let kept = HORIZON - 7;
        assert_eq!(policy.controls().as_slice()[..kept], before.as_slice()[7..], "{interpolation:?}");
        assert!(report.initial_cost < 7.0, "{report:?}");
        // One candidate, without noise: the initial controls.
        let mut still = planner(&data, options).with_initial_controls(&[0.25]).unwrap();
        let report = still.plan(&data, &Upright, &mut policy).unwrap();
        assert_eq!(policy.controls().as_slice(), [0.25; HORIZON]);
        assert_eq!(report.initial_cost, report.cost);
    }
}

#[test]
fn controls_stay_within_their_ranges() {
    let mut data = tilted();
    let options = SamplingOptions::default().with_deviations([5.0]).with_interpolation(Interpolation::Cubic);
    let mut wild = planner(&data, options);
    let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
    wild.plan(&data, &Upright, &mut policy).unwrap();
    assert!(policy.controls().as_slice().iter().all(|ctrl| ctrl.abs() <= 1.0));
    assert!(policy.controls().as_slice().iter().any(|ctrl| ctrl.abs() == 1.0));
    // The next plan follows an edit of the range.
    data.edit_model(|model| model.actuator_ctrlrange_mut()[0] = [-0.05, 0.02]).unwrap();
    wild.plan(&data, &Upright, &mut policy).unwrap();
    assert!(policy.controls().as_slice().iter().all(|ctrl| (-0.05..=0.02).contains(ctrl)));
}

/// Squared difference of the only control of the springs from a value, in the first step.
struct FirstControl(f64);

impl TrajectoryCost for FirstControl {
    fn value(&self, step: usize, _state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        let first = controls.filter(|_| step == 0);
        Ok(first.map_or(0.0, |controls| (controls[0] - self.0).powi(2)))
    }
}

#[test]
fn a_high_temperature_averages_and_a_low_one_selects_the_best_candidate() {
    let data = Data::new(springs()).unwrap();
    let plan = |temperature: f64, target: f64| {
        let options = SamplingOptions::default()
            .with_samples(4000)
            .with_knots(1)
            .with_interpolation(Interpolation::Zero)
            .with_deviations([1.0])
            .with_temperature(temperature);
        let mut planner = SamplingPlanner::new(data.model(), 1, options).unwrap();
        let mut policy = TimeVaryingLqr::hold_controls(&data, 1).unwrap();
        let report = planner.plan(&data, &FirstControl(target), &mut policy).unwrap();
        (policy.controls().row(0)[0], report)
    };
    assert!(plan(1e9, 1.0).0.abs() < 0.06, "the mean of the noise is 0");
    assert_eq!(plan(1e-9, 1.0).0.to_bits(), plan(0.0, 1.0).0.to_bits());
    assert!((plan(0.0, 1.0).0 - 1.0).abs() < 0.01);
    // The product of the densities of the noise, exp(−u²/2), and of the weights, exp(−(u − 1)²/λ),
    // has its mean at 2/(λ + 2).
    for temperature in [0.5, 1.0, 4.0] {
        let (found, expected) = (plan(temperature, 1.0).0, 2.0 / (temperature + 2.0));
        assert!((found - expected).abs() < 0.06, "temperature {temperature}: {found} instead of {expected}");
    }
}

#[test]
fn with_a_regulator_and_no_noise_the_plan_is_the_regulator() {
    let mut data = Data::new(springs()).unwrap();
    let weights = LqrWeights::diagonal(&[1.0, 2.0, 0.1, 0.2], &[0.05, 0.1]);
    let mut lqr = Lqr::at_present_state(&mut data, &weights).unwrap();
    data.set_physics_state(&[0.3, -0.2, 0.1, 0.4]).unwrap();
    let cost = QuadraticCost::new(data.model(), &[0.0; 4], weights, DMatrix::zeros(4, 4)).unwrap();
    let options = SamplingOptions::default().with_samples(2);
    let planner = SamplingPlanner::new(data.model(), 10, options).unwrap().with_regulator(lqr.clone()).unwrap();
    let mut controller = PredictiveController::new(&data, planner, cost, 10).unwrap();
    for step in 0..10 {
        // The gains correct a disturbance that the plan does not contain.
        data.qvel_mut()[0] += 0.1;
        controller.control(&mut data).unwrap();
        let found = data.ctrl().to_vec();
        lqr.control(&mut data).unwrap();
        for (found, expected) in found.iter().zip(data.ctrl()) {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "step {step}: {found}, {expected}");
        }
        data.step().unwrap();
    }
}

#[test]
fn the_pole_is_swung_up_by_sampling() {
    let mut data = cartpole();
    data.qpos_mut()[1] = 3.0;
    let options =
        SamplingOptions::default().with_samples(24).with_knots(6).with_deviations([0.6, 0.2, 0.05]).with_threads(2);
    let planner = SamplingPlanner::new(data.model(), 100, options).unwrap();
    let mut controller = PredictiveController::new(&data, planner, Upright, 4).unwrap();
    for _ in 0..600 {
        controller.control(&mut data).unwrap();
        data.step().unwrap();
    }
    let [x, angle] = [data.qpos()[0], data.qpos()[1]];
    assert!(x.abs() < 0.7 && angle.cos() > 0.98, "{:?}", data.physics_state());
}

#[test]
fn a_reset_repeats_the_plans() {
    let mut repeated = planner(&tilted(), SamplingOptions::default());
    let mut run = |data: &Data| {
        let mut policy = TimeVaryingLqr::hold_controls(data, HORIZON).unwrap();
        let first = repeated.plan(data, &Upright, &mut policy).unwrap();
        let second = repeated.plan(data, &Upright, &mut policy).unwrap();
        repeated.reset();
        (first, second, policy.controls().clone())
    };
    let first = run(&tilted());
    assert_eq!(run(&tilted()), first);
    assert!(first.1.cost <= first.0.cost);
}

#[test]
fn errors_are_reported_and_the_planner_is_usable_after_them() {
    /// Cost that fails, or is not a number.
    struct Faulty(bool);
    impl TrajectoryCost for Faulty {
        fn value(&self, _step: usize, _state: &[f64], _controls: Option<&[f64]>) -> Result<f64> {
            if self.0 { Err(Error::Unsupported("this cost".to_owned())) } else { Ok(f64::NAN) }
        }
    }
    let mut data = tilted();
    let mut planner = planner(&data, SamplingOptions::default());
    let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
    let expected = planner.plan(&data, &Upright, &mut policy).unwrap();
    assert!(matches!(planner.plan(&data, &Faulty(true), &mut policy), Err(Error::Unsupported(_))));
    assert!(matches!(planner.plan(&data, &Faulty(false), &mut policy), Err(Error::Invalid { .. })));
    data.qvel_mut()[0] = f64::NAN;
    assert!(matches!(planner.plan(&data, &Upright, &mut policy), Err(Error::Unstable(_))));
    assert!(matches!(
        planner.plan(&Data::new(springs()).unwrap(), &Upright, &mut policy),
        Err(Error::OtherModel { .. })
    ));
    assert_eq!(planner.plan(&tilted(), &Upright, &mut policy).unwrap(), expected);
    // iLQR needs the derivatives that this cost lacks.
    let mut expansion = mujoco_safe::control::ilqr::CostExpansion::zeros(data.model());
    let unsupported = Upright.expand(0, &[0.0; 4], None, &mut expansion);
    assert!(matches!(unsupported, Err(Error::Unsupported(_))));
}

#[test]
fn a_planner_thread_delivers_plans_by_sampling() {
    let mut data = tilted();
    let options = SamplingOptions::default().with_samples(8);
    let planner = planner(&data, options);
    let mut controller = ThreadedPredictiveController::new(&data, planner, Upright).unwrap();
    for _ in 0..20 {
        controller.control(&mut data).unwrap();
        data.step().unwrap();
        controller.wait().unwrap();
    }
    assert!(controller.plans() > 1);
}

#[test]
fn invalid_options_are_errors() {
    let data = cartpole();
    let default = SamplingOptions::default;
    for options in [
        default().with_samples(0),
        default().with_iterations(0),
        default().with_knots(0),
        default().with_threads(0),
        default().with_deviations([]),
        default().with_deviations([-0.1]),
        default().with_deviations([f64::NAN]),
        default().with_temperature(-1.0),
        default().with_temperature(f64::INFINITY),
    ] {
        let planner = SamplingPlanner::new(data.model(), 5, options.clone());
        assert!(matches!(planner, Err(Error::Invalid { .. })), "{options:?}");
    }
    assert!(matches!(SamplingPlanner::new(data.model(), 0, default()), Err(Error::Invalid { .. })));
    let wrong = planner(&data, default()).with_initial_controls(&[0.0; 2]);
    assert!(matches!(wrong, Err(Error::Shape { .. })));
    let mut other = Data::new(springs()).unwrap();
    let weights = LqrWeights::diagonal(&[1.0; 4], &[1.0; 2]);
    let lqr = Lqr::at_present_state(&mut other, &weights).unwrap();
    assert!(matches!(planner(&data, default()).with_regulator(lqr), Err(Error::Shape { .. })));
}
