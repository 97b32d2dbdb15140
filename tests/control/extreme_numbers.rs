//! Extreme matrices and degenerate models: each gives a result or an error, in bounded time.

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, QuadraticCost};
use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiRecursion};
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::{
    Controller, Data, Differences, Lineariser, Lqr, LqrWeights, Matrix, Model, PdController, RandomController,
    StateSpace, ZeroController, sample,
};
use nalgebra::DMatrix;

use crate::cases::cases;

/// Numbers that break computations.
const NUMBERS: [f64; 12] =
    [0.0, -0.0, 1.0, -1.0, 1e-320, 1e-160, 1e160, 1e300, f64::MAX, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Models without degrees of freedom, without actuators, and with neither.
const SMALL: [&str; 3] = [
    "<mujoco/>",
    r#"<mujoco><worldbody><body><joint/><geom size=".1"/></body></worldbody></mujoco>"#,
    r#"<mujoco><worldbody><site name="s"/></worldbody><actuator><general site="s" dyntype="integrator"/></actuator></mujoco>"#,
];

/// Returns matrices of a size: constant, diagonal, and with a single special entry.
fn matrices(rows: usize, columns: usize) -> Vec<DMatrix<f64>> {
    let mut matrices = Vec::new();
    for number in NUMBERS {
        matrices.push(DMatrix::from_element(rows, columns, number));
        matrices.push(DMatrix::from_fn(rows, columns, |row, column| if row == column { number } else { 0.0 }));
        let mut odd = DMatrix::identity(rows, columns);
        if let Some(entry) = odd.iter_mut().last() {
            *entry = number;
        }
        matrices.push(odd);
    }
    matrices
}

/// Asserts that a solution is finite. An error is allowed.
fn check_solution(result: Result<mujoco_safe::control::riccati::RiccatiSolution, RiccatiError>) -> bool {
    let Ok(solution) = result else { return false };
    assert!(solution.p.as_slice().iter().chain(solution.k.as_slice()).all(|value| value.is_finite()), "{solution:?}");
    assert!(solution.spectral_radius.is_finite() && solution.relative_residual.is_finite(), "{solution:?}");
    true
}

#[test]
#[allow(clippy::many_single_char_names, reason = "A, B, Q, R and S are the symbols of the field")]
fn riccati_equations_of_any_numbers_give_finite_solutions_or_errors() {
    let mut solved = 0;
    let sizes = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 1), (3, 2)];
    for &(states, controls) in &sizes[..cases(5, 6)] {
        let good = [
            DMatrix::identity(states, states) * 0.9,
            DMatrix::identity(states, controls),
            DMatrix::identity(states, states),
            DMatrix::identity(controls, controls),
            DMatrix::zeros(states, controls),
        ];
        for odd in 0..5 {
            for matrix in matrices(good[odd].nrows(), good[odd].ncols()) {
                let mut all = good.clone();
                all[odd] = matrix;
                let [a, b, q, r, s] = &all;
                solved += usize::from(check_solution(Riccati::new(a, b, q, r).solve()));
                solved += usize::from(check_solution(Riccati::new(a, b, q, r).with_cross_term(s).solve()));
                let weights = LqrWeights { s: Some(s.into()), ..LqrWeights::new(q, r) };
                for terminal in [q, &DMatrix::zeros(states, states)] {
                    let Ok(mut recursion) = RiccatiRecursion::new(terminal, controls) else { continue };
                    for _ in 0..cases(10, 50) {
                        if recursion.step_back(a, b, &weights).is_err() {
                            break;
                        }
                    }
                }
            }
        }
        // The same number in all matrices.
        for number in NUMBERS {
            let [a, b, q, r, s] = good.each_ref().map(|matrix| matrix.map(|_| number));
            solved += usize::from(check_solution(Riccati::new(&a, &b, &q, &r).with_cross_term(&s).solve()));
            for &tolerance in NUMBERS.iter().skip(states % cases(4, 1)).step_by(cases(4, 1)) {
                let _ = Riccati::new(&a, &b, &good[2], &good[3]).with_residual_tolerance(tolerance).solve();
            }
        }
    }
    assert!(solved > 100, "{solved}");
}

#[test]
fn regulators_of_degenerate_models_are_results_or_errors() {
    for xml in SMALL {
        let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
        let (nx, nu) = (2 * data.model().nv() + data.model().na(), data.model().nu());
        let weights = LqrWeights::diagonal(&vec![1.0; nx], &vec![1.0; nu]);
        if let Ok(mut lqr) = Lqr::at_present_state(&mut data, &weights) {
            lqr.control(&mut data).unwrap();
        }
        let mut lqr = Lqr::with_gain(&data, Matrix::zeros(nu, nx)).unwrap();
        lqr.control(&mut data).unwrap();
        PdController::new(data.model(), f64::NAN, f64::INFINITY).control(&mut data).ok();
        RandomController::new(1).control(&mut data).unwrap();
        ZeroController.control(&mut data).unwrap();
        data.reset().unwrap();
        let _ = data.transition_fd(1e-6, Differences::Central);

        let width = data.model().nq() + data.model().nv() + data.model().na();
        let (states, controls) = (Matrix::zeros(4, width), Matrix::zeros(3, nu));
        let mut transition = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
        let follow = TimeVaryingLqr::along(
            &mut transition,
            &data,
            states,
            controls.clone(),
            &weights,
            &DMatrix::identity(nx, nx),
        );
        if let Ok(mut follow) = follow {
            for start in NUMBERS {
                follow.set_start(start);
                follow.control(&mut data).unwrap();
            }
        }
        let target = data.qpos().iter().chain(data.qvel()).chain(data.act()).copied().collect::<Vec<_>>();
        let cost = QuadraticCost::new(data.model().clone(), &target, weights, DMatrix::identity(nx, nx)).unwrap();
        let mut solver = Ilqr::new(data.model().clone(), IlqrOptions::default().with_iterations(3)).unwrap();
        if let Ok(solution) = solver.solve(&data, &controls, &cost) {
            assert!(solution.cost().is_finite());
        }
    }
}

#[test]
fn weights_gains_and_targets_of_any_numbers_do_not_panic() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    for number in NUMBERS {
        for weights in [
            LqrWeights::diagonal(&[number; 4], &[1.0]),
            LqrWeights::diagonal(&[1.0; 4], &[number]),
            LqrWeights::diagonal(&[number; 4], &[number]),
            LqrWeights { s: Some(Matrix::from_row_major(4, 1, vec![number; 4])), ..super::weights() },
            LqrWeights::diagonal(&[], &[]),
            LqrWeights::diagonal(&[1.0; 5], &[]),
        ] {
            check_solution(Lqr::solve(&system, &weights));
            let mut fill = system.clone();
            fill.a = Matrix::from_row_major(4, 4, vec![number; 16]);
            check_solution(Lqr::solve(&fill, &weights));
            let _ = TimeVaryingLqr::solve([&system, &fill].into_iter(), &weights, &DMatrix::identity(4, 4));
            data.reset().unwrap();
            if let Ok(mut lqr) = Lqr::at_present_state(&mut data, &weights) {
                lqr.control(&mut data).unwrap();
            }
            if let Ok(cost) =
                QuadraticCost::new(sample::cartpole(), &[number; 4], weights, DMatrix::from_element(4, 4, number))
            {
                let data = Data::new(sample::cartpole()).unwrap();
                let options = IlqrOptions::default().with_iterations(2);
                let mut solver = Ilqr::new(data.model().clone(), options).unwrap();
                let _ = solver.solve(&data, &Matrix::zeros(5, 1), &cost);
                let _ = solver.solve(&data, &Matrix::from_row_major(5, 1, vec![number; 5]), &cost);
            }
        }
        let mut lqr = Lqr::with_gain(&data, Matrix::from_row_major(1, 4, vec![number; 4])).unwrap();
        lqr.control(&mut data).unwrap();
        let _ = data.step();
        data.reset().unwrap();
        let mut pd = PdController::new(data.model(), number, number);
        pd.set_target(data.model().actuator("slide").unwrap(), number);
        for _ in 0..3 {
            if pd.control(&mut data).and_then(|()| data.step()).is_err() {
                break;
            }
        }
        data.reset().unwrap();
    }
    // Systems whose matrices have inconsistent shapes.
    for (a, b) in [((4, 4), (3, 1)), ((4, 3), (4, 1)), ((0, 0), (4, 1)), ((4, 4), (0, 0))] {
        let system = StateSpace { a: Matrix::zeros(a.0, a.1), b: Matrix::zeros(b.0, b.1), ..system.clone() };
        assert!(Lqr::solve(&system, &super::weights()).is_err());
        assert!(TimeVaryingLqr::solve([&system].into_iter(), &super::weights(), &DMatrix::identity(4, 4)).is_err());
    }
}

#[test]
fn gain_tables_and_ilqr_from_extreme_states_are_finite_or_errors() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut transition = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    for number in NUMBERS {
        let states = Matrix::from_row_major(4, 4, vec![number; 16]);
        let controls = Matrix::from_row_major(3, 1, vec![number; 3]);
        let along = TimeVaryingLqr::along(
            &mut transition,
            &data,
            states.clone(),
            controls.clone(),
            &super::weights(),
            &DMatrix::identity(4, 4),
        );
        if let Ok(along) = along {
            assert!(along.gains().iter().all(|gain| gain.as_slice().iter().all(|value| value.is_finite())), "{number}");
        }
        let gains = vec![Matrix::from_row_major(1, 4, vec![number; 4]); 3];
        let mut follow = TimeVaryingLqr::with_gains(&data, states, controls, gains).unwrap();
        for start in NUMBERS {
            follow.set_start(start);
            assert!(follow.row(&data) <= follow.steps());
            follow.control(&mut data).unwrap();
            let _ = data.step();
            data.reset().unwrap();
        }
    }
}
