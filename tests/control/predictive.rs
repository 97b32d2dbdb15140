//! Predictive control: planning over a receding horizon.

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{IlqrOptions, QuadraticCost, TrajectoryCost};
use mujoco_safe::control::predictive::{IlqrPlanner, Planner, PredictiveController};
use mujoco_safe::control::residual::{Controls, JointPosition, JointVelocity, Needs, Residual, ResidualCost, Term};
use mujoco_safe::{Controller, Data, Differences, Error, Lqr, LqrWeights, Matrix, Result, StateSpec};
use nalgebra::{DMatrix, DVector};

use super::{cartpole, springs};

use crate::cases::cases;

/// Returns two masses on springs away from equilibrium, their cost with the cost to go of the
/// regulator, and the regulator's gain.
fn displaced() -> (Data, QuadraticCost, DMatrix<f64>) {
    let mut data = Data::new(springs()).unwrap();
    data.set_physics_state(&[0.3, -0.2, 0.1, 0.4]).unwrap();
    let weights = LqrWeights::diagonal(&[1.0, 2.0, 0.1, 0.2], &[0.05, 0.1]);
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    let solution = Lqr::solve(&system, &weights).unwrap();
    let cost = QuadraticCost::new(data.model(), &[0.0; 4], weights, solution.p).unwrap();
    (data, cost, solution.k.to_nalgebra())
}

fn planner(data: &Data, horizon: usize, iterations: usize) -> IlqrPlanner {
    IlqrPlanner::new(data.model(), horizon, IlqrOptions::default().with_iterations(iterations)).unwrap()
}

#[test]
fn with_the_cost_to_go_of_the_regulator_the_plan_is_the_regulator() {
    let (mut data, cost, gain) = displaced();
    // One iteration solves a linear-quadratic problem.
    for interval in [1, 3] {
        let mut controller = PredictiveController::new(&data, planner(&data, 6, 1), cost.clone(), interval).unwrap();
        for step in 0..50 {
            controller.control(&mut data).unwrap();
            let expected = -(&gain * DVector::from_vec(data.physics_state()));
            let error = (DVector::from_column_slice(data.ctrl()) - &expected).norm();
            assert!(error < 1e-6 * expected.norm().max(0.01), "step {step}: {error:e}");
            data.step().unwrap();
        }
        data.qvel_mut().fill(0.5);
    }
}

#[test]
fn gains_of_the_plan_correct_disturbances_between_plans() {
    let (mut data, cost, gain) = displaced();
    let mut controller = PredictiveController::new(&data, planner(&data, 20, 1), cost, 20).unwrap();
    for step in 0..20 {
        controller.control(&mut data).unwrap();
        let expected = -(&gain * DVector::from_vec(data.physics_state()));
        let error = (DVector::from_column_slice(data.ctrl()) - &expected).norm();
        assert!(error < 1e-5 * expected.norm().max(0.01), "step {step}: {error:e}");
        // A disturbance that the plan does not contain.
        data.qvel_mut()[0] += 0.1;
        data.step().unwrap();
    }
}

/// Returns the cost of holding the cart-pole upright at 0.5 m.
fn hold(data: &Data) -> ResidualCost {
    let model = data.model();
    let position = JointPosition::all(model).with_target(&[0.5, 0.0]).unwrap();
    let terms = [
        Term::new("position", position).with_terminal_weight(10.0),
        Term::new("velocity", JointVelocity::all(model)).with_weight(0.1).with_terminal_weight(10.0),
        Term::new("effort", Controls::new(model)).with_weight(1e-2),
    ];
    ResidualCost::new(model, terms).unwrap()
}

#[test]
fn a_plan_starts_from_the_previous_one_moved_to_the_present_time() {
    const HORIZON: usize = 80;
    let (mut data, shift) = (cartpole(), 3);
    let cost = hold(&data);
    let mut planner = planner(&data, HORIZON, 50);
    let mut policy = TimeVaryingLqr::hold_controls(&data, HORIZON).unwrap();
    let first = planner.plan(&data, &cost, &mut policy).unwrap();
    assert!(first.cost < first.initial_cost, "{first:?}");
    for _ in 0..shift {
        policy.control(&mut data).unwrap();
        data.step().unwrap();
    }
    assert_eq!(policy.row(&data), shift);

    // The previous controls from the present state on, with the last one repeated.
    let controls = policy.controls();
    let mut shifted = Matrix::zeros(HORIZON, 1);
    for step in 0..HORIZON {
        shifted.row_mut(step).copy_from_slice(controls.row((step + shift).min(HORIZON - 1)));
    }
    let mut simulated = data.clone();
    let mut states = Matrix::zeros(HORIZON + 1, 4);
    for step in 0..HORIZON {
        states.row_mut(step).copy_from_slice(&simulated.physics_state());
        simulated.ctrl_mut().copy_from_slice(shifted.row(step));
        simulated.step().unwrap();
    }
    states.row_mut(HORIZON).copy_from_slice(&simulated.physics_state());
    let without_feedback = cost.total(states.view(), shifted.view()).unwrap();

    let second = planner.plan(&data, &cost, &mut policy).unwrap();
    assert!(second.initial_cost <= without_feedback * (1.0 + 1e-9), "{second:?}, without feedback {without_feedback}");
    assert!(second.initial_cost < first.initial_cost, "{second:?} after {first:?}");
    assert!(second.cost <= second.initial_cost);
    // The plan starts at the present state and time.
    assert_eq!((policy.start(), policy.row(&data)), (data.time(), 0));
    assert_eq!(policy.states().row(0), data.physics_state());
    let total = cost.total(policy.states().view(), policy.controls().view()).unwrap();
    assert!((total - second.cost).abs() < 1e-9 * total);
}

#[test]
fn a_plan_without_an_iteration_is_the_initial_controls() {
    let data = cartpole();
    let controls = Matrix::from_row_major(5, 1, vec![0.1, 0.2, 3.0, -3.0, 0.0]);
    let mut planner = planner(&data, 5, 0).with_initial_controls(controls).unwrap();
    let mut policy = TimeVaryingLqr::hold_controls(&data, 5).unwrap();
    let report = planner.plan(&data, &hold(&data), &mut policy).unwrap();
    assert_eq!(policy.controls().as_slice(), [0.1, 0.2, 1.0, -1.0, 0.0]);
    assert_eq!(report.cost, report.initial_cost);
}

#[test]
fn a_run_is_reproducible_and_does_not_depend_on_the_number_of_threads() {
    let run = |threads: usize| {
        let mut data = cartpole();
        data.qpos_mut()[1] = 0.3;
        let options = IlqrOptions::default().with_iterations(1).with_threads(threads);
        let planner = IlqrPlanner::new(data.model(), 30, options).unwrap();
        let mut controller = PredictiveController::new(&data, planner, hold(&data), 2).unwrap();
        for _ in 0..40 {
            controller.control(&mut data).unwrap();
            data.step().unwrap();
        }
        data.physics_state()
    };
    let first = run(1);
    assert_eq!(first, run(1));
    assert_eq!(first, run(3));
}

#[test]
fn a_plan_does_not_foresee_applied_forces_unless_asked() {
    let (mut data, cost, _) = displaced();
    let first_control = |data: &Data, foreseen: Option<StateSpec>| {
        let mut planner = planner(data, 10, 1);
        if let Some(foreseen) = foreseen {
            planner = planner.with_foreseen(foreseen);
        }
        let mut policy = TimeVaryingLqr::hold_controls(data, 10).unwrap();
        planner.plan(data, &cost, &mut policy).unwrap();
        policy.controls().row(0).to_vec()
    };
    let calm = first_control(&data, None);
    data.qfrc_applied_mut()[0] = 2.0;
    assert_eq!(first_control(&data, None), calm);
    assert!((first_control(&data, Some(StateSpec::INTEGRATION))[0] - calm[0]).abs() > 1e-3);
}

#[test]
fn a_reset_of_the_simulation_discards_the_plan() {
    let mut data = cartpole();
    let start = data.state(StateSpec::INTEGRATION);
    let mut controller = PredictiveController::new(&data, planner(&data, 20, 1), hold(&data), 4).unwrap();
    let mut run = |data: &mut Data| {
        data.set_state(StateSpec::INTEGRATION, &start).unwrap();
        let states: Vec<_> = (0..10)
            .map(|_| {
                controller.control(data).unwrap();
                data.step().unwrap();
                data.physics_state()
            })
            .collect();
        states
    };
    let first = run(&mut data);
    assert_eq!(run(&mut data), first);
}

#[test]
fn a_planner_follows_edits_of_the_model() {
    let mut data = cartpole();
    let cost = hold(&data);
    let mut edited = planner(&data, 30, 2);
    let mut policy = TimeVaryingLqr::hold_controls(&data, 30).unwrap();
    edited.plan(&data, &cost, &mut policy).unwrap();
    assert!(policy.controls().as_slice().iter().any(|ctrl| ctrl.abs() > 0.05));
    data.edit_model(|model| model.actuator_ctrlrange_mut()[0] = [-0.05, 0.05]).unwrap();
    edited.reset();
    edited.plan(&data, &cost, &mut policy).unwrap();
    assert!(policy.controls().as_slice().iter().all(|ctrl| ctrl.abs() <= 0.05));
    // The plan is that of a planner for the edited model.
    let controls = policy.controls().clone();
    planner(&data, 30, 2).plan(&data, &cost, &mut policy).unwrap();
    assert_eq!(policy.controls(), &controls);
}

#[test]
fn a_planner_is_usable_after_an_unstable_start() {
    let (mut data, cost, _) = displaced();
    let mut planner = planner(&data, 10, 1);
    let mut policy = TimeVaryingLqr::hold_controls(&data, 10).unwrap();
    let expected = planner.plan(&data, &cost, &mut policy).unwrap();
    let controls = policy.controls().clone();
    let state = data.physics_state();
    data.qvel_mut()[0] = f64::NAN;
    assert!(matches!(planner.plan(&data, &cost, &mut policy), Err(Error::Unstable(_))));
    data.set_physics_state(&state).unwrap();
    assert_eq!(planner.plan(&data, &cost, &mut policy).unwrap(), expected);
    assert_eq!(policy.controls(), &controls);
}

#[test]
fn invalid_arguments_are_errors() {
    let data = cartpole();
    let options = IlqrOptions::default;
    assert!(matches!(IlqrPlanner::new(data.model(), 0, options()), Err(Error::Invalid { .. })));
    assert!(matches!(IlqrPlanner::new(data.model(), 5, options().with_threads(0)), Err(Error::Invalid { .. })));
    assert!(matches!(IlqrPlanner::new(data.model(), 5, options().with_step_sizes([])), Err(Error::Invalid { .. })));
    let wrong = planner(&data, 5, 1).with_initial_controls(Matrix::zeros(4, 1));
    assert!(matches!(wrong, Err(Error::Shape { .. })));
    for interval in [0, 6] {
        let controller = PredictiveController::new(&data, planner(&data, 5, 1), hold(&data), interval);
        assert!(matches!(controller, Err(Error::Invalid { .. })), "{interval}");
    }
    assert!(matches!(TimeVaryingLqr::hold_controls(&data, 0), Err(Error::Invalid { .. })));
    let mut policy = TimeVaryingLqr::hold_controls(&data, 5).unwrap();
    let other = planner(&cartpole(), 5, 1).plan(&data, &hold(&data), &mut policy);
    assert!(matches!(other, Err(Error::OtherModel { .. })));
}

#[test]
fn overwriting_a_table_equals_creating_it_and_leaves_clones_unchanged() {
    let mut data = cartpole();
    let states = Matrix::from_row_major(4, 4, (0..16).map(f64::from).collect());
    let controls = Matrix::from_row_major(3, 1, vec![0.1, 0.2, 0.3]);
    let gains = vec![Matrix::from_row_major(1, 4, vec![1.0, 2.0, 3.0, 4.0]); 3];
    for (steps, keep) in [(3, false), (3, true), (7, false)] {
        let mut policy = TimeVaryingLqr::hold_controls(&data, steps).unwrap();
        let clone = keep.then(|| policy.clone());
        data.set_time(1.5);
        policy.overwrite(&data, &states, &controls, &gains).unwrap();
        let expected = TimeVaryingLqr::with_gains(&data, states.clone(), controls.clone(), gains.clone()).unwrap();
        assert_eq!((policy.states(), policy.controls()), (expected.states(), expected.controls()));
        assert_eq!((policy.gains(), policy.start()), (expected.gains(), 1.5));
        assert!(clone.is_none_or(|clone| clone.controls().as_slice() == [0.0; 3]));
        assert!(matches!(policy.overwrite(&data, &states, &controls, &gains[..2]), Err(Error::Shape { .. })));
    }
}

/// Distance of the pole's direction from upright: `[sin q, 1 − cos q]`.
struct Upright;

impl Residual for Upright {
    fn size(&self) -> usize {
        2
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        let angle = data.qpos()[1];
        residual.copy_from_slice(&[angle.sin(), 1.0 - angle.cos()]);
        Ok(())
    }
}

#[test]
fn the_pole_is_swung_up_and_balanced_again_after_pushes() {
    let mut data = cartpole();
    let model = data.model().clone();
    data.qpos_mut()[1] = 3.0;
    let terms = [
        Term::new("upright", Upright).with_weight(1.0).with_terminal_weight(50.0),
        Term::new("centre", JointPosition::new(&model, "slider").unwrap()).with_weight(0.5).with_terminal_weight(20.0),
        Term::new("velocity", JointVelocity::all(&model)).with_weight(0.01).with_terminal_weight(2.0),
        Term::new("effort", Controls::new(&model)).with_weight(0.05),
    ];
    let cost = ResidualCost::new(&model, terms).unwrap();
    let options = IlqrOptions::default().with_iterations(3).with_threads(2);
    let initial = Matrix::from_row_major(100, 1, vec![0.05; 100]);
    let planner = IlqrPlanner::new(&model, 100, options).unwrap().with_initial_controls(initial).unwrap();
    let mut controller = PredictiveController::new(&data, planner, cost, 8).unwrap();
    let mut run = |data: &mut Data, steps: usize| {
        for _ in 0..steps {
            controller.control(data).unwrap();
            data.step().unwrap();
        }
        [data.qpos()[0].abs(), (1.0 - data.qpos()[1].cos()).abs(), data.qvel()[1].abs()]
    };
    let swung_up = run(&mut data, 400);
    assert!(swung_up[0] < 0.3 && swung_up[1] < 0.01 && swung_up[2] < 0.3, "{swung_up:?}");
    for push in cases(&[60.0][..], &[60.0, -60.0]) {
        let pole = model.body("pole").unwrap().index();
        data.xfrc_applied_mut()[pole][0] = *push;
        run(&mut data, 5);
        data.xfrc_applied_mut()[pole][0] = 0.0;
        assert!(data.qvel()[1].abs() > 0.5, "the push has no effect");
        let balanced = run(&mut data, 300);
        assert!(balanced[0] < 0.3 && balanced[1] < 0.01 && balanced[2] < 0.3, "push {push}: {balanced:?}");
    }
}
