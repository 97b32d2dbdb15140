//! Iterative LQR.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::control::ilqr::{
    CostExpansion, Ilqr, IlqrOptions, IlqrSolution, IlqrStatus, QuadraticCost, TrajectoryCost,
};
use mujoco_safe::control::riccati::RiccatiRecursion;
use mujoco_safe::{Controller, Data, Differences, Error, LqrWeights, Matrix, Model, Result, sample};
use nalgebra::{DMatrix, DVector};

use super::{Random, assert_close, cartpole, springs};
use crate::cases::cases;

fn solve(data: &Data, options: IlqrOptions, controls: &Matrix, cost: &dyn TrajectoryCost) -> IlqrSolution {
    Ilqr::new(data.model().clone(), options).unwrap().solve(data, controls, cost).unwrap()
}

/// Returns two masses on springs, away from equilibrium.
fn displaced() -> (Data, QuadraticCost, LqrWeights, DMatrix<f64>) {
    let model = Arc::new(springs());
    let mut data = Data::new(model.clone()).unwrap();
    data.set_physics_state(&[0.3, -0.2, 0.1, 0.4]).unwrap();
    let mut weights = LqrWeights::diagonal(&[1.0, 2.0, 0.1, 0.2], &[0.05, 0.1]);
    weights.s = Some(Matrix::from_rows(&[[0.01, 0.0], [0.0, 0.02], [0.0, 0.0], [0.01, 0.0]]));
    let terminal = DMatrix::identity(4, 4) * 3.0;
    let cost = QuadraticCost::new(model, &[0.0; 4], weights.clone(), terminal.clone()).unwrap();
    (data, cost, weights, terminal)
}

#[test]
fn a_linear_quadratic_problem_is_solved_in_one_iteration() {
    const STEPS: usize = 40;
    let (mut data, cost, weights, terminal) = displaced();
    let solution = solve(&data, IlqrOptions::default(), &Matrix::zeros(STEPS, 2), &cost);
    assert_eq!(solution.status, IlqrStatus::Converged);
    assert_eq!(solution.costs.len(), 2, "{:?}", solution.costs);

    let begin = DVector::from_vec(data.physics_state());
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    let (a, b) = (system.a.to_nalgebra(), system.b.to_nalgebra());
    let mut recursion = RiccatiRecursion::new(&terminal, 2).unwrap();
    for step in (0..STEPS).rev() {
        let gain = recursion.step_back(&a, &b, &weights).unwrap();
        assert_close(&solution.gains[step], gain, 1e-6);
    }
    let cost_to_go = begin.dot(&(recursion.p().to_nalgebra() * &begin));
    assert!((solution.cost() - cost_to_go).abs() < 1e-7 * cost_to_go, "{} and {cost_to_go}", solution.cost());
    let first = -recursion.k().to_nalgebra() * &begin;
    assert_close(&DVector::from_row_slice(solution.controls.row(0)), &first, 1e-6);
}

/// A cost that counts the evaluated trajectories.
struct Counting(QuadraticCost, AtomicUsize);

impl TrajectoryCost for Counting {
    fn value(&self, step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        if controls.is_none() {
            self.1.fetch_add(1, Ordering::Relaxed);
        }
        self.0.value(step, state, controls)
    }

    fn expand(
        &self,
        step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        self.0.expand(step, state, controls, expansion)
    }
}

#[test]
fn a_sufficient_decrease_ends_the_line_search() {
    let (data, cost, ..) = displaced();
    let search = |sufficient: f64, step_sizes: &[f64]| {
        let cost = Counting(cost.clone(), AtomicUsize::new(0));
        let options =
            IlqrOptions::default().with_iterations(1).with_step_sizes(step_sizes).with_sufficient_decrease(sufficient);
        let solution = solve(&data, options, &Matrix::zeros(20, 2), &cost);
        (cost.1.into_inner() - 1, solution.cost())
    };
    // The steps are linear, so the decrease of a step size α is the fraction α (2 − α) of the
    // largest one, which is as predicted.
    let sizes = [0.1, 0.2, 0.5, 1.0, 0.9];
    let (all, least) = search(f64::INFINITY, &sizes);
    assert_eq!(all, sizes.len());
    for (sufficient, expected) in [(0.5, 2), (0.99, 2), (1.01, 5)] {
        let (count, cost) = search(sufficient, &sizes);
        assert_eq!(count, expected, "{sufficient}");
        assert!(cost >= least && (count < 5 || cost == least), "{cost} and {least}");
    }
}

/// Returns a cart-pole with a distant target, and its cost.
fn far() -> (Data, QuadraticCost) {
    let data = cartpole();
    let weights = LqrWeights::diagonal(&[1.0, 0.1, 0.0, 0.0], &[1e-4]);
    let terminal = DMatrix::identity(4, 4) * 10.0;
    let cost = QuadraticCost::new(data.model().clone(), &[0.6, 0.0, 0.0, 0.0], weights, terminal).unwrap();
    (data, cost)
}

#[test]
fn controls_satisfy_the_conditions_of_a_constrained_minimum() {
    let (data, cost) = far();
    let options = IlqrOptions::default().with_tolerance(1e-14);
    let solution = solve(&data, options, &Matrix::zeros(80, 1), &cost);
    let controls = solution.controls.as_slice();
    assert!(controls.iter().all(|ctrl| ctrl.abs() <= 1.0));
    let (held, free): (Vec<usize>, Vec<usize>) = (0..80).partition(|&step| controls[step].abs() == 1.0);
    assert!(held.len() > 5 && free.len() > 20, "{} are held", held.len());

    // The conditions of a minimum, by finite differences of the cost of whole simulations.
    let value = |step: usize, change: f64| {
        let mut changed = solution.controls.clone();
        changed[(step, 0)] += change;
        simulated_cost(&data, &changed, &cost)
    };
    let slope = |step: usize| (value(step, 1e-5) - value(step, -1e-5)) / 2e-5;
    for step in held {
        assert!(slope(step) * controls[step] < 1e-5, "step {step} is held at {}", controls[step]);
        assert!(solution.gains[step].as_slice().iter().all(|gain| *gain == 0.0));
    }
    for step in free {
        assert!(slope(step).abs() < 2e-4, "step {step}: {}", slope(step));
    }
}

/// Returns the cost of a simulation with these controls.
fn simulated_cost(data: &Data, controls: &Matrix, cost: &dyn TrajectoryCost) -> f64 {
    let mut data = data.clone();
    let mut total = 0.0;
    // The engine would clamp the perturbation of a control at the limit of its range.
    data.edit_model(|model| model.actuator_ctrlrange_mut().fill([-10.0, 10.0])).unwrap();
    for (step, controls) in controls.rows().enumerate() {
        total += cost.value(step, &data.physics_state(), Some(controls)).unwrap();
        data.ctrl_mut().copy_from_slice(controls);
        data.step().unwrap();
    }
    total + cost.value(controls.nrows(), &data.physics_state(), None).unwrap()
}

#[test]
fn the_cost_decreases_and_is_that_of_a_simulation() {
    let (data, cost) = far();
    for iterations in [0, 1, 3, cases(15, 200)] {
        let options = IlqrOptions::default().with_iterations(iterations);
        let solution = solve(&data, options, &Matrix::zeros(80, 1), &cost);
        assert!(solution.costs.windows(2).all(|pair| pair[1] < pair[0]), "{:?}", solution.costs);
        assert!(solution.costs.len() <= iterations + 1);
        if iterations < 4 {
            assert_eq!((solution.status, solution.costs.len()), (IlqrStatus::IterationLimit, iterations + 1));
        }
        let mut data = data.clone();
        for step in 0..80 {
            assert_eq!(data.physics_state(), solution.states.row(step));
            data.ctrl_mut().copy_from_slice(solution.controls.row(step));
            data.step().unwrap();
        }
        assert_eq!(data.physics_state(), solution.states.row(80));
        assert!((solution.cost() - simulated_cost(&cartpole(), &solution.controls, &cost)).abs() < 1e-9);
    }
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let (data, cost) = far();
    let by = |threads| {
        let options = IlqrOptions::default().with_threads(threads).with_iterations(4);
        solve(&data, options, &Matrix::zeros(60, 1), &cost)
    };
    let (one, three) = (by(1), by(3));
    assert_eq!(
        (one.controls, one.states, one.gains, one.costs),
        (three.controls, three.states, three.gains, three.costs)
    );
}

#[test]
fn a_reused_solver_follows_edits_of_the_model() {
    let (mut data, cost) = far();
    let options = IlqrOptions::default().with_iterations(6);
    let mut solver = Ilqr::new(data.model().clone(), options.clone()).unwrap();
    let begin = Matrix::zeros(60, 1);
    let first = solver.solve(&data, &begin, &cost).unwrap();
    let original = data.clone();
    data.edit_model(|model| model.actuator_gear_mut()[0][0] = 20.0).unwrap();
    let weaker = solver.solve(&data, &begin, &cost).unwrap();
    assert!(weaker.cost() > 1.01 * first.cost());
    assert_eq!(weaker.controls, solve(&data, options, &begin, &cost).controls);
    assert_eq!(solver.solve(&original, &begin, &cost).unwrap().controls, first.controls);
}

#[test]
fn applied_forces_and_time_are_those_of_the_initial_simulation() {
    let (mut data, cost) = far();
    data.qfrc_applied_mut()[0] = 5.0;
    data.set_time(3.0);
    let solution = solve(&data, IlqrOptions::default().with_iterations(4), &Matrix::zeros(60, 1), &cost);
    let mut follow = solution.controller(&data).unwrap();
    assert_eq!((follow.start(), follow.steps()), (3.0, 60));
    for _ in 0..60 {
        follow.control(&mut data).unwrap();
        data.step().unwrap();
    }
    let end = DVector::from_vec(data.physics_state()) - DVector::from_column_slice(solution.states.row(60));
    assert!(end.norm() < 1e-9, "{end}");
}

/// A cost that decreases with the height of the pole, which hangs at rest.
struct Higher;

impl TrajectoryCost for Higher {
    fn value(&self, _step: usize, state: &[f64], controls: Option<&[f64]>) -> Result<f64> {
        Ok(match controls {
            Some(controls) => 1e-3 * controls[0] * controls[0] + 0.1 * state[0] * state[0],
            None => 1.0 - state[1].cos(),
        })
    }

    fn expand(
        &self,
        step: usize,
        state: &[f64],
        controls: Option<&[f64]>,
        expansion: &mut CostExpansion,
    ) -> Result<()> {
        assert_eq!(controls.is_none(), step == 50);
        if let Some(controls) = controls {
            expansion.u[0] = 2e-3 * controls[0];
            expansion.uu[(0, 0)] = 2e-3;
            expansion.x[0] = 0.2 * state[0];
            expansion.xx[(0, 0)] = 0.2;
        } else {
            expansion.x[1] = state[1].sin();
            expansion.xx[(1, 1)] = state[1].cos();
        }
        Ok(())
    }
}

#[test]
fn a_custom_cost_may_be_nonconvex() {
    let mut data = cartpole();
    data.qpos_mut()[1] = 3.0;
    let solution = solve(&data, IlqrOptions::default(), &Matrix::from_row_major(50, 1, vec![0.1; 50]), &Higher);
    assert!(solution.costs[0] > 1.5);
    assert!(solution.cost() < 0.6 * solution.costs[0], "{:?}: {:?}", solution.status, solution.costs);
}

/// A cost with wrong derivatives or values.
struct Wrong(fn(&mut CostExpansion), f64);

impl TrajectoryCost for Wrong {
    fn value(&self, _: usize, state: &[f64], _: Option<&[f64]>) -> Result<f64> {
        Ok(self.1 + state[0])
    }

    fn expand(&self, _: usize, _: &[f64], _: Option<&[f64]>, expansion: &mut CostExpansion) -> Result<()> {
        expansion.uu = Matrix::identity(expansion.u.len());
        (self.0)(expansion);
        Ok(())
    }
}

#[test]
fn wrong_derivatives_end_the_search_at_the_initial_controls() {
    let data = cartpole();
    // The cost increases to the right, but the derivative has the opposite sign.
    let lie = Wrong(|expansion| expansion.x[0] = -1.0, 0.0);
    let solution = solve(&data, IlqrOptions::default(), &Matrix::zeros(10, 1), &lie);
    assert_eq!((solution.status, solution.costs.len()), (IlqrStatus::NoDescent, 1));
    assert_eq!(solution.controls, Matrix::zeros(10, 1));
    // The cost decreases with a control that is not limited.
    let spoil = |expansion: &mut CostExpansion| (expansion.u[0], expansion.uu[(0, 0)]) = (-1.0, -1.0);
    let endless = Wrong(spoil, 0.0);
    let data = Data::new(springs()).unwrap();
    let solution = solve(&data, IlqrOptions::default(), &Matrix::zeros(10, 2), &endless);
    assert_eq!((solution.status, solution.costs.len()), (IlqrStatus::NoDescent, 1));
}

#[test]
fn a_nan_cost_or_a_changed_shape_is_an_error() {
    let data = cartpole();
    let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default()).unwrap();
    let mut error = |spoilt: Wrong| solver.solve(&data, &Matrix::zeros(3, 1), &spoilt).unwrap_err();
    for value in [f64::NAN, f64::INFINITY] {
        assert!(matches!(error(Wrong(|_| (), value)), Error::Invalid { .. }));
    }
    for spoil in [
        (|expansion| expansion.x[3] = f64::NAN) as fn(&mut CostExpansion),
        |expansion| expansion.u[0] = f64::INFINITY,
        |expansion| expansion.xx[(0, 3)] = f64::NAN,
        |expansion| expansion.uu[(0, 0)] = f64::NAN,
        |expansion| expansion.xu[(3, 0)] = f64::NAN,
    ] {
        assert!(matches!(error(Wrong(spoil, 0.0)), Error::Invalid { .. }));
    }
    for spoil in [
        (|expansion| expansion.x = vec![0.0; 3]) as fn(&mut CostExpansion),
        |expansion| expansion.u = vec![0.0; 2],
        |expansion| expansion.xx = Matrix::zeros(4, 3),
        |expansion| expansion.uu = Matrix::zeros(0, 0),
        |expansion| expansion.xu = Matrix::zeros(1, 4),
    ] {
        assert!(matches!(error(Wrong(spoil, 0.0)), Error::Shape { .. }));
    }
}

#[test]
fn an_unstable_initial_simulation_is_an_error() {
    let data = Data::new(springs()).unwrap();
    let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default()).unwrap();
    for control in [f64::NAN, 1e300] {
        let controls = Matrix::from_row_major(5, 2, vec![control; 10]);
        let cost = Wrong(|_| (), 0.0);
        assert!(matches!(solver.solve(&data, &controls, &cost), Err(Error::Unstable(_))), "{control}");
    }
    // The search has no lasting effect.
    let (data, cost, ..) = displaced();
    let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default()).unwrap();
    let again = solver.solve(&data, &Matrix::zeros(20, 2), &cost).unwrap();
    assert_eq!(again.status, IlqrStatus::Converged);
}

/// Returns the gradient by finite differences in the tangent space, and by the controls.
fn gradient(
    model: &Model,
    cost: &QuadraticCost,
    state: &[f64],
    controls: Option<&[f64]>,
) -> (DVector<f64>, DVector<f64>) {
    const EPS: f64 = 1e-6;
    let (nq, nv, nu) = (model.nq(), model.nv(), model.nu());
    let moved = |index: usize, eps: f64| {
        let mut state = state.to_vec();
        if index < nv {
            let mut velocity = vec![0.0; nv];
            velocity[index] = 1.0;
            model.integrate_pos(&mut state[..nq], &velocity, eps).unwrap();
        } else {
            state[nq + index - nv] += eps;
        }
        cost.value(0, &state, controls).unwrap()
    };
    let x = DVector::from_fn(2 * nv, |index, _| (moved(index, EPS) - moved(index, -EPS)) / (2.0 * EPS));
    let u = DVector::from_fn(nu, |index, _| {
        let Some(controls) = controls else { return 0.0 };
        let changed = |eps: f64| {
            let mut controls = controls.to_vec();
            controls[index] += eps;
            cost.value(0, state, Some(&controls)).unwrap()
        };
        (changed(EPS) - changed(-EPS)) / (2.0 * EPS)
    });
    (x, u)
}

#[test]
#[allow(clippy::many_single_char_names, reason = "symbols of the literature")]
fn the_derivatives_of_a_quadratic_cost_equal_finite_differences() {
    let model = Arc::new(sample::humanoid());
    let (nx, nu) = (54, 21);
    let mut random = Random::new(8);
    let (q, r, s) = (random.positive(nx, 0.1), random.positive(nu, 0.1), random.matrix(nx, nu));
    let weights = LqrWeights { s: Some(Matrix::from(&s)), ..LqrWeights::new(&q, &r) };
    let terminal = random.positive(nx, 0.1);
    let mut data = Data::new(model.clone()).unwrap();
    data.reset_to_key("squat").unwrap();
    let target = data.physics_state();
    let controls: Vec<f64> = random.vector(nu).as_slice().to_vec();
    let cost = QuadraticCost::new(model.clone(), &target, weights, &terminal)
        .and_then(|cost| cost.with_controls(&controls))
        .unwrap();
    assert_eq!(cost.value(0, &target, Some(&controls)).unwrap(), 0.0);
    assert_eq!(cost.value(9, &target, None).unwrap(), 0.0);

    let velocity: Vec<f64> = random.vector(27).as_slice().to_vec();
    model.integrate_pos(data.qpos_mut(), &velocity, 0.5).unwrap();
    data.qvel_mut().copy_from_slice(&velocity);
    let (state, ctrl) = (data.physics_state(), random.vector(nu).as_slice().to_vec());
    for controls in [Some(&ctrl[..]), None] {
        let mut expansion = CostExpansion::zeros(&model);
        cost.expand(0, &state, controls, &mut expansion).unwrap();
        let (x, u) = gradient(&model, &cost, &state, controls);
        let (found_x, found_u) = (DVector::from_vec(expansion.x), DVector::from_vec(expansion.u));
        assert!((&found_x - &x).norm() < 1e-6 * x.norm(), "{found_x} instead of {x}");
        assert!((&found_u - &u).norm() <= 1e-6 * u.norm().max(1e-9), "{found_u} instead of {u}");
        // At the target, the second derivatives are twice the weights.
        let mut expansion = CostExpansion::zeros(&model);
        cost.expand(0, &target, controls, &mut expansion).unwrap();
        let expected = if controls.is_some() { &q } else { &terminal };
        assert_close(&expansion.xx, &(expected * 2.0), 1e-12);
        if controls.is_some() {
            assert_close(&expansion.uu, &(&r * 2.0), 1e-12);
            assert_close(&expansion.xu, &(&s * 2.0), 1e-12);
        }
    }
}

#[test]
fn a_status_has_a_message() {
    let texts =
        [IlqrStatus::Converged, IlqrStatus::NoDescent, IlqrStatus::IterationLimit].map(|status| status.to_string());
    assert_eq!(texts, ["converged", "no step size lowers the cost", "reached the maximum number of iterations"]);
}
