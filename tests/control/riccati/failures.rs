//! Errors of unsolvable equations, and their contents.

use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiMatrix, RiccatiSolution};
use mujoco_safe::derivative::{TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Lqr, Model};
use nalgebra::{DMatrix, Matrix2, Matrix4, dmatrix, matrix};

use super::{Generator, assert_close, assert_close_matrix, scalar, solve};
use crate::weights;

#[test]
fn a_wrong_shape_is_an_error_with_the_expected_shape() {
    let shapes = [(3, 3), (3, 2), (3, 3), (2, 2), (3, 2)];
    let attempt = |shapes: [(usize, usize); 5]| {
        let [a, b, q, r, s] = shapes.map(|(rows, columns)| DMatrix::identity(rows, columns) * 0.5);
        Riccati::new(&a, &b, &q, &r).with_cross_term(&s).solve().map(drop)
    };
    assert_eq!(attempt(shapes), Ok(()));
    let names = [RiccatiMatrix::A, RiccatiMatrix::B, RiccatiMatrix::Q, RiccatiMatrix::R, RiccatiMatrix::S];
    for (index, matrix) in names.into_iter().enumerate() {
        let mut wrong = shapes;
        // A's rows and B's columns define the sizes; the other matrices are compared with them.
        if index == 0 {
            wrong[index].1 += 1;
        } else {
            wrong[index].0 += 1;
        }
        let (expected, found) = (shapes[index], wrong[index]);
        assert_eq!(attempt(wrong), Err(RiccatiError::WrongShape { matrix, expected, found }));
    }
}

#[test]
fn a_nan_entry_is_an_error_with_its_position() {
    for value in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let q = dmatrix![1.0, value; 0.0, 1.0];
        let Err(RiccatiError::NotFinite { matrix, row, column, value: got }) =
            Riccati::new(&Matrix2::identity(), &Matrix2::identity(), &q, &Matrix2::identity()).solve()
        else {
            panic!("{value} was accepted");
        };
        assert_eq!((matrix, row, column, got.to_bits()), (RiccatiMatrix::Q, 0, 1, value.to_bits()));
    }
}

#[test]
fn an_asymmetric_weight_is_rejected_beyond_rounding() {
    let identity = Matrix2::identity();
    let a = matrix![1.0, 0.1; 0.0, 1.0];
    let lopsided = matrix![2.0, 0.5; 0.4, 1.0];
    let expected = |matrix| Err(RiccatiError::NotSymmetric { matrix, row: 0, column: 1, value: 0.5, mirror: 0.4 });
    assert_eq!(Riccati::new(&a, &identity, &lopsided, &identity).solve(), expected(RiccatiMatrix::Q));
    assert_eq!(Riccati::new(&a, &identity, &identity, &lopsided).solve(), expected(RiccatiMatrix::R));

    let nearly = matrix![2.0, 0.5 + 1e-10; 0.5 - 1e-10, 1.0];
    let solution = Riccati::new(&a, &identity, &nearly, &nearly).solve().unwrap();
    let symmetric = matrix![2.0, 0.5; 0.5, 1.0];
    assert_close_matrix(&solution.p, &Riccati::new(&a, &identity, &symmetric, &symmetric).solve().unwrap().p, 1e-14);
}

#[test]
fn a_negative_control_cost_is_rejected() {
    let identity = Matrix2::identity();
    for (r, smallest) in [(matrix![1.0, 2.0; 2.0, 1.0], -1.0), (matrix![1.0, 0.0; 0.0, -3.0], -3.0)] {
        let Err(RiccatiError::ControlCostNotPositive { smallest_eigenvalue }) =
            Riccati::new(&identity, &identity, &identity, &r).solve()
        else {
            panic!("{r} was accepted");
        };
        assert!((smallest_eigenvalue - smallest).abs() < 1e-15, "{smallest_eigenvalue}");
    }
}

#[test]
fn a_control_without_cost_must_have_an_effect() {
    let identity = Matrix2::identity();
    // Both controls have the same effect; their sum has a cost, their difference has none.
    let b = matrix![1.0, 1.0; 0.5, 0.5];
    for r in [matrix![1.0, 1.0; 1.0, 1.0], Matrix2::zeros()] {
        assert_eq!(Riccati::new(&identity, &b, &identity, &r).solve(), Err(RiccatiError::SingularPencil));
    }
    assert_eq!(scalar(0.5, 0.0, 1.0, 0.0), Err(RiccatiError::SingularPencil));
    // Each control has its own effect: together they bring the state to rest in one step at no
    // cost.
    let solution = Riccati::new(&identity, &identity, &identity, &Matrix2::zeros()).solve().unwrap();
    assert_close_matrix(&solution.p, &DMatrix::identity(2, 2), 1e-14);
    assert_close_matrix(&solution.k, &DMatrix::identity(2, 2), 1e-14);
    assert!(solution.spectral_radius < 1e-14);
}

#[test]
fn an_uncontrollable_mode_is_an_error_with_its_eigenvalue() {
    let mut generator = Generator(7);
    // One uncontrollable mode among controllable modes, real or complex, in rotated coordinates.
    let spiral = dmatrix![0.0, -1.25; 1.25, 0.0];
    for (block, modulus) in [(dmatrix![1.3], 1.3), (dmatrix![-1.0], 1.0), (spiral, 1.25)] {
        let (reached, hidden) = (7, block.nrows());
        let size = reached + hidden;
        let mut a = generator.matrix(size, size);
        a.view_mut((reached, 0), (hidden, reached)).fill(0.0);
        a.view_mut((reached, reached), (hidden, hidden)).copy_from(&block);
        let mut b = generator.matrix(size, 2);
        b.rows_mut(reached, hidden).fill(0.0);
        let axes = generator.rotation(size);
        let (a, b) = (&axes * a * axes.transpose(), &axes * b);
        let got = solve(&a, &b, &DMatrix::identity(size, size), &DMatrix::identity(2, 2));
        let Err(RiccatiError::UncontrollableMode { eigenvalue, distance }) = got else {
            panic!("{block} is uncontrollable, but the result is {got:?}");
        };
        assert_close(eigenvalue.re.hypot(eigenvalue.im), modulus, 1e-9);
        assert!(distance < 1e-12, "{distance:e}");
    }
}

#[test]
fn a_body_without_forces_is_uncontrollable() {
    // Position and velocity of a mass without forces: a double eigenvalue, which rounding
    // separates.
    let mut a = DMatrix::identity(4, 4);
    a[(0, 1)] = 0.005;
    a[(2, 3)] = 0.005;
    let b = dmatrix![0.0; 0.0; 1e-5; 0.005];
    let axes = Generator(8).rotation(4);
    let got = solve(&(&axes * a * axes.transpose()), &(&axes * b), &DMatrix::identity(4, 4), &dmatrix![1.0]);
    let Err(RiccatiError::UncontrollableMode { eigenvalue, .. }) = got else {
        panic!("{got:?}");
    };
    assert!((eigenvalue - 1.0).norm_sqr() < 1e-12, "{eigenvalue}");
}

#[test]
fn an_uncontrollable_mode_is_found_in_matrices_by_differences() {
    // Two masses, of which the second is out of reach. Differences give it a minute dependence on
    // all states and on the control.
    for error in [0.0, 1e-14, 1e-10, 1e-8, 1e-7, 1e-6] {
        for seed in 11..31 {
            let mut generator = Generator(seed);
            let mut a = DMatrix::identity(4, 4);
            (a[(0, 2)], a[(1, 3)], a[(2, 0)]) = (0.005, 0.005, -0.015);
            let b = dmatrix![2.5e-5; 0.0; 0.005; 0.0];
            let (a, b) = (a + generator.matrix(4, 4) * error, b + generator.matrix(4, 1) * error);
            let got = solve(&a, &b, &DMatrix::identity(4, 4), &dmatrix![1.0]);
            match got {
                Err(RiccatiError::UncontrollableMode { eigenvalue, distance }) => {
                    assert!((eigenvalue - 1.0).norm() < 0.01, "{eigenvalue}");
                    assert!(distance <= 1e-7 + 10.0 * error, "{distance:e}");
                }
                // The error gives the control an effect.
                Ok(solution) => {
                    assert!(error > 0.0 && solution.k.to_nalgebra().amax() > 10.0, "{error:e}: {:?}", solution.k);
                }
                Err(failure) => panic!("{error:e}, {seed}: {failure}"),
            }
        }
    }
}

#[test]
fn a_mode_that_the_control_hardly_reaches_explains_an_inaccurate_solution() {
    for seed in 100..106 {
        let mut generator = Generator(seed);
        let mut a = generator.matrix(2, 2);
        (a[(1, 0)], a[(1, 1)]) = (0.0, 1.01);
        let mut b = generator.matrix(2, 1);
        b[1] *= 1e-6;
        let axes = generator.rotation(2);
        let (a, b) = (&axes * a * axes.transpose(), &axes * b);
        let got = solve(&a, &b, &DMatrix::identity(2, 2), &dmatrix![1.0]);
        let Err(RiccatiError::UncontrollableMode { eigenvalue, distance }) = got else {
            panic!("{seed}: {got:?}");
        };
        assert!((eigenvalue - 1.01).norm() < 1e-9 && distance < 1e-5, "{seed}: {eigenvalue}, {distance:e}");
    }
}

#[test]
fn an_unweighted_mode_on_the_unit_circle_has_no_stabilising_solution() {
    let turn = 0.7_f64;
    let oscillator = dmatrix![turn.cos(), -turn.sin(); turn.sin(), turn.cos()];
    let (b, one) = (dmatrix![0.3; 1.0], dmatrix![1.0]);
    let got = solve(&oscillator, &b, &DMatrix::zeros(2, 2), &one);
    let Err(RiccatiError::UnobservableMode { eigenvalue, distance }) = got else {
        panic!("{got:?}");
    };
    assert!((eigenvalue.re - turn.cos()).abs() < 1e-12 && (eigenvalue.im.abs() - turn.sin()).abs() < 1e-12);
    assert!(distance < 1e-12, "{distance:e}");
    let weighted = solve(&oscillator, &b, &(DMatrix::identity(2, 2) * 1e-9), &one).unwrap();
    assert!(weighted.spectral_radius < 1.0);
}

#[test]
fn an_unweighted_mode_is_found_among_other_modes() {
    // Coupled to the other modes, and beside a mode that is uncontrollable but stable.
    let mut generator = Generator(10);
    let turning = |turn: f64| dmatrix![turn.cos(), -turn.sin(); turn.sin(), turn.cos()];
    for block in [dmatrix![1.0], dmatrix![-1.0], turning(0.3), turning(1.9), turning(2.5)] {
        let free = block.nrows();
        let size = free + 5;
        let last = size - 1;
        let mut a = generator.matrix(size, size) * 0.3;
        a.view_mut((free, 0), (size - free, free)).fill(0.0);
        a.view_mut((0, 0), (free, free)).copy_from(&block);
        a.row_mut(last).fill(0.0);
        a[(last, last)] = 0.5;
        let mut b = generator.matrix(size, 2);
        b.row_mut(last).fill(0.0);
        let mut q = DMatrix::identity(size, size);
        q.view_mut((0, 0), (free, free)).fill(0.0);

        let got = solve(&a, &b, &q, &DMatrix::identity(2, 2));
        let Err(RiccatiError::UnobservableMode { eigenvalue, distance }) = got else {
            panic!("{block} is unweighted, but the result is {got:?}");
        };
        assert_close(eigenvalue.re.hypot(eigenvalue.im), 1.0, 1e-9);
        assert!((eigenvalue.re - block[(0, 0)]).abs() < 1e-9, "{eigenvalue}");
        assert!(distance < 1e-12, "{distance:e}");
    }
}

#[test]
fn an_unbounded_cost_does_not_converge() {
    // p² + p + 1 = 0 has no real root.
    let got = scalar(1.0, 1.0, -1.0, 1.0);
    assert!(matches!(got, Err(RiccatiError::NoConvergence { iterations: 1.. })), "{got:?}");
}

#[test]
fn overflowing_entries_are_an_error() {
    for size in [1, 3, 20] {
        let huge = DMatrix::from_element(size, size, 1e200);
        let identity = DMatrix::identity(size, size);
        let got = solve(&huge, &huge, &identity, &identity);
        assert!(got.is_err(), "{got:?}");
    }
    // The norm of A overflows, and dividing by it gives NaN.
    let twisted = dmatrix![0.01, -1e15; 1e300, 0.05];
    for controls in [0, 2] {
        let (b, r) = (DMatrix::from_element(2, controls, 1.0), DMatrix::identity(controls, controls));
        let got = solve(&twisted, &b, &DMatrix::identity(2, 2), &r);
        assert!(got.is_err(), "{got:?}");
    }
}

/// A motor moves a cart; nothing holds the other body.
#[test]
fn a_regulator_names_the_mode_that_no_actuator_of_a_model_reaches() {
    const DT: f64 = 0.01;
    let (mass, height, radius, gravity) = (2.0, 0.5, 0.1, 9.81);
    let pendulum =
        format!(r#"<joint axis="0 1 0"/><geom type="sphere" size="{radius}" pos="0 0 {height}" mass="{mass}"/>"#);
    let inertia = mass * height * height + 0.4 * mass * radius * radius;
    // Euler steps with the new velocity: λ² − (2 + (Δt)² m g h / I) λ + 1 = 0.
    let half = 1.0 + 0.5 * DT * DT * mass * gravity * height / inertia;
    let falls = half + (half * half - 1.0).sqrt();
    let slider = r#"<joint type="slide" axis="1 0 0"/><geom size="0.1"/>"#.to_owned();
    for (body, expected) in [(pendulum, falls), (slider, 1.0)] {
        let model = Model::from_xml_str(&format!(
            r#"<mujoco><option timestep="{DT}" gravity="0 0 -{gravity}"/><worldbody>
                 <body><joint name="cart" type="slide" axis="1 0 0"/><geom size="0.1"/></body>
                 <body pos="0 1 0">{body}</body></worldbody>
               <actuator><motor joint="cart"/></actuator></mujoco>"#
        ));
        let mut data = Data::new(model.unwrap()).unwrap();
        // The slider has a double eigenvalue, which the square root of an error separates.
        let check = |found: Option<&RiccatiError>, what: &str| {
            let Some(RiccatiError::UncontrollableMode { eigenvalue, .. }) = found else { panic!("{what}: {found:?}") };
            assert!((eigenvalue.re - expected).abs() < 1e-4 && eigenvalue.im.abs() < 1e-4, "{what}: {eigenvalue}");
            assert!(found.unwrap().to_string().contains("actuator"), "{what}");
        };
        let error = Lqr::at_present_state(&mut data, &weights()).unwrap_err();
        check(error.solver(), "the default method");
        for method in [TransitionMethod::Analytic, TransitionMethod::Columns, TransitionMethod::Engine] {
            let options = TransitionOptions::default().with_method(method);
            let (system, _) = Lineariser::new(data.model(), options).unwrap().linear_system(&mut data).unwrap();
            check(Lqr::solve(&system, &weights()).err().as_ref(), &format!("{method:?}, {expected}"));
        }
    }
}

#[test]
fn a_residual_above_the_tolerance_is_an_error_with_both_numbers() {
    let mut generator = Generator(9);
    let (a, b) = (generator.matrix(10, 10), generator.matrix(10, 2));
    let (q, r) = (generator.positive(10), generator.positive(2));
    let reached = solve(&a, &b, &q, &r).unwrap().relative_residual;
    assert!(reached > 0.0);
    let strict = Riccati::new(&a, &b, &q, &r).with_residual_tolerance(reached / 2.0).solve();
    assert_eq!(strict, Err(RiccatiError::Inaccurate { relative_residual: reached, tolerance: reached / 2.0 }));
    assert!(Riccati::new(&a, &b, &q, &r).with_residual_tolerance(reached).solve().is_ok());
}

#[test]
fn messages_name_the_matrix_the_problem_and_the_expectation() {
    let identity = Matrix2::identity();
    let message = |result: Result<RiccatiSolution, RiccatiError>| result.unwrap_err().to_string();
    let shape = message(Riccati::new(&identity, &identity, &Matrix4::identity(), &identity).solve());
    assert_eq!(shape, "Q is 4 by 4; to match the other matrices it should be 2 by 2");
    let entry = message(Riccati::new(&identity, &matrix![0.0, f64::NAN; 0.0, 0.0], &identity, &identity).solve());
    assert_eq!(entry, "the entry of B in row 0, column 1 is NaN; every entry should be a finite number");
    let mode = message(Riccati::new(&(identity * 2.0), &matrix![1.0, 0.0; 0.0, 0.0], &identity, &identity).solve());
    assert!(mode.contains("eigenvalue 2+0i") && mode.contains("actuator"), "{mode}");
    let weight = message(scalar(1.0, 1.0, 0.0, 1.0));
    assert!(weight.contains("on the unit circle") && weight.contains("weight in Q"), "{weight}");
}
