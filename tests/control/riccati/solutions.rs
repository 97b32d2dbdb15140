//! Solutions against closed forms, published figures and formulas.

use mujoco_safe::control::riccati::{Riccati, RiccatiError};
use nalgebra::{DMatrix, DVector, Matrix1, Matrix2, Matrix4, dmatrix, matrix, vector};

use super::{
    Generator, assert_close, assert_close_matrix, assert_solves, row_major, scalar, scalar_solution, solve,
    spectral_radius,
};
use crate::cases::cases;

#[test]
fn a_scalar_equation_has_the_root_of_its_quadratic() {
    for a in [-3.0, -1.0, 0.0, 0.5, 1.0, 1.000_001, 2.0] {
        for b in [1e-3, 1.0, 40.0] {
            for q in [1e-10, 1.0, 1e6] {
                for r in [1e-4, 1.0, 100.0] {
                    let p = scalar_solution(a, b, q, r);
                    let solution = scalar(a, b, q, r).unwrap_or_else(|error| panic!("{a} {b} {q} {r}: {error}"));
                    assert_close(solution.p[(0, 0)], p, 1e-8);
                    let k = a * b * p / (r + b * b * p);
                    assert!((solution.k[(0, 0)] - k).abs() <= 1e-8 * k.abs());
                    assert!((solution.spectral_radius - (a - b * k).abs()).abs() < 1e-10);
                }
            }
        }
    }
}

#[test]
fn a_sampled_double_integrator_has_the_poles_of_its_spectral_factor() {
    // x₁ is the double sum of u, so the poles inside the circle solve (z + 1/z − 2)² = −q.
    let (a, b) = (matrix![1.0, 1.0; 0.0, 1.0], vector![0.0, 1.0]);
    for q in [1e-8_f64, 1e-3, 1.0, 100.0] {
        let half = nalgebra::Complex::new(1.0, q.sqrt() / 2.0);
        let root = (half * half - 1.0).sqrt();
        let [first, second] = [half + root, half - root].map(|pole| pole.re.hypot(pole.im));
        let solution = Riccati::new(&a, &b, &matrix![q, 0.0; 0.0, 0.0], &Matrix1::identity()).solve().unwrap();
        assert_close(solution.spectral_radius, first.min(second), 1e-11);
    }
}

#[test]
fn textbook_equations_have_their_published_solutions() {
    let one = Matrix1::identity();
    // DAREX 1.1 (Laub 1979): unstable, of rank one.
    let q = dmatrix![9.0, 6.0; 6.0, 4.0];
    let laub = Riccati::new(&matrix![4.0, 3.0; -4.5, -3.5], &vector![1.0, -1.0], &q, &one).solve().unwrap();
    assert_close_matrix(&laub.p, &(q * 5.0_f64.sqrt().mul_add(0.5, 0.5)), 1e-13);

    // Pappas, Laub and Sandell 1980: A is singular, so the symplectic matrix does not exist.
    let nilpotent = matrix![0.0, 1.0; 0.0, 0.0];
    let pappas = Riccati::new(&nilpotent, &vector![0.0, 1.0], &matrix![1.0, 2.0; 2.0, 4.0], &one).solve().unwrap();
    assert_close_matrix(&pappas.p, &dmatrix![1.0, 2.0; 2.0, 2.0 + 5.0_f64.sqrt()], 1e-14);

    // DAREX 2.2 (Gudmundsson, Kenney and Laub 1992): badly scaled, and all poles are zero.
    for scale in [1.0, 1e3, 1e6] {
        let deadbeat =
            Riccati::new(&(nilpotent * scale), &vector![0.0, 1.0], &Matrix2::identity(), &one).solve().unwrap();
        assert_close_matrix(&deadbeat.p, &dmatrix![1.0, 0.0; 0.0, 1.0 + scale * scale], 1e-14);
        assert!(deadbeat.spectral_radius <= 0.0);
    }
}

#[test]
fn the_cart_pole_has_the_gain_of_the_reference() {
    let a = matrix![
        1.0, -0.00020933539434596422, 0.00999696728367769, 7.112993351890879e-06;
        0.0, 1.0027918363759287, 7.112993351890878e-06, 0.009905136378663615;
        0.0, -0.020933539434596422, 0.9996967283677689, 0.000711299335189088;
        0.0, 0.2791836375928739, 0.0007112993351890878, 0.9905136378663615
    ];
    let b = vector![0.0030327163223112376, -0.007112993351890878, 0.30327163223112374, -0.7112993351890878];
    let q = Matrix4::from_diagonal(&vector![1.0, 10.0, 1.0, 5.0]);
    let solution = Riccati::new(&a, &b, &q, &Matrix1::identity()).solve().unwrap();

    let k = [-0.46741668449941, -5.5927150414698, -0.8436677105895, -1.4448668569023];
    let diagonal = [180.2819066017, 2907.909272519, 166.5472641831, 37.13361185153];
    for index in 0..4 {
        assert_close(solution.k[(0, index)], k[index], 1e-11);
        assert_close(solution.p[(index, index)], diagonal[index], 1e-11);
    }
    assert_close(solution.spectral_radius, 0.9897460625077, 1e-11);
    assert!(solution.relative_residual < 1e-14, "{:e}", solution.relative_residual);
}

#[test]
fn random_systems_are_solved_and_stabilised() {
    let mut generator = Generator(1);
    for (states, controls) in [(1, 1), (2, 1), (3, 3), (5, 2), (8, 1), (12, 4), (17, 3), (31, 7), (33, 33), (54, 21)] {
        // The checks of a large system take a second in a build without optimisation.
        let growths = if states > 30 { cases(1, 3) } else { 3 };
        for growth in [1.5, 0.3, 1.0].into_iter().take(growths) {
            let a = generator.matrix(states, states);
            let a = &a * (growth / spectral_radius(&a));
            let b = generator.matrix(states, controls);
            let (q, r) = (generator.positive(states), generator.positive(controls));
            let solution =
                solve(&a, &b, &q, &r).unwrap_or_else(|error| panic!("{states} states, {controls} controls: {error}"));
            assert_solves(&solution, &a, &b, &q, &r, &DMatrix::zeros(states, controls));
        }
    }
}

#[test]
fn a_cross_term_equals_a_substitution_of_the_control() {
    // With u = v − Fx the same problem has other matrices, the same P, and the gain K − F.
    let mut generator = Generator(2);
    for (states, controls) in [(2, 1), (6, 3), (20, 5)] {
        let (a, b) = (generator.matrix(states, states), generator.matrix(states, controls));
        let (q, r) = (generator.positive(states), generator.positive(controls));
        let f = generator.matrix(controls, states);
        let plain = solve(&a, &b, &q, &r).unwrap();

        let (changed_a, changed_q, s) = (&a - &b * &f, &q + f.transpose() * &r * &f, -f.transpose() * &r);
        let changed = Riccati::new(&changed_a, &b, &changed_q, &r).with_cross_term(&s).solve().unwrap();
        assert_solves(&changed, &changed_a, &b, &changed_q, &r, &s);
        assert_close_matrix(&changed.p, &plain.p, 1e-10);
        assert_close_matrix(&(changed.k.to_nalgebra() + f), &plain.k, 1e-10);
    }
}

#[test]
fn the_solution_is_the_cost_of_the_closed_loop() {
    let mut generator = Generator(3);
    let (a, b, s) = (generator.matrix(6, 6), generator.matrix(6, 2), generator.matrix(6, 2) * 0.05);
    let (q, r) = (generator.positive(6), generator.positive(2));
    let solution = Riccati::new(&a, &b, &q, &r).with_cross_term(&s).solve().unwrap();
    let start = DVector::from_fn(6, |_, _| generator.number());
    let (mut x, mut cost) = (start.clone(), 0.0);
    for _ in 0..2_000 {
        let u = -(solution.k.to_nalgebra() * &x);
        cost += x.dot(&(&q * &x)) + u.dot(&(&r * &u)) + 2.0 * x.dot(&(&s * &u));
        x = &a * &x + &b * &u;
    }
    assert_close(start.dot(&(solution.p.to_nalgebra() * &start)), cost, 1e-10);
}

#[test]
fn slow_modes_of_small_cost_are_solved_beside_fast_modes() {
    // Scalar systems with closed-form solutions, in rotated coordinates, which preserve the exact
    // properties.
    let mut generator = Generator(4);
    for free in [1, 3, 10] {
        let size = 40;
        let entries = DVector::from_fn(size, |index, _| if index < free { 1.0 } else { generator.number() * 1.2 });
        let costs = DVector::from_fn(size, |index, _| if index < free { 1e-14 } else { 1.0 });
        let axes = generator.rotation(size);
        let seen = |diagonal: &DVector<f64>| {
            let turned = &axes * DMatrix::from_diagonal(diagonal) * axes.transpose();
            (&turned + turned.transpose()) / 2.0
        };
        let (a, q, identity) = (seen(&entries), seen(&costs), DMatrix::identity(size, size));
        let solution = solve(&a, &identity, &q, &identity).unwrap();
        let p = entries.zip_map(&costs, |a, q| scalar_solution(a, 1.0, q, 1.0));
        let radius = entries.zip_map(&p, |a, p| a.abs() / (1.0 + p)).max();
        assert!(radius > 1.0 - 1.1e-7, "the system of the test must be slow: {radius}");
        // Q is known to 1e-16 only, a hundredth of the cost of the slow modes.
        assert_close_matrix(&solution.p, &seen(&p), 1e-8);
        assert!((solution.spectral_radius - radius).abs() < 1e-8);
        assert!(solution.spectral_radius < 1.0);
        assert!(solution.relative_residual < 1e-14, "{:e}", solution.relative_residual);
    }
}

#[test]
fn the_solution_is_invariant_to_units_of_the_states() {
    let mut generator = Generator(5);
    let (a, b) = (generator.matrix(14, 14), generator.matrix(14, 3));
    let (q, r) = (generator.positive(14), generator.positive(3));
    let plain = solve(&a, &b, &q, &r).unwrap();
    let units = DVector::from_fn(14, |index, _| 10.0_f64.powi(i32::try_from(index).unwrap() % 7 - 3));
    let (to, from) = (DMatrix::from_diagonal(&units), DMatrix::from_diagonal(&units.map(f64::recip)));
    let scaled = solve(&(&to * a * &from), &(&to * b), &(&from * q * &from), &r).unwrap();
    assert_close_matrix(&(&to * scaled.p.to_nalgebra() * &to), &plain.p, 1e-8);
    assert_close_matrix(&(scaled.k.to_nalgebra() * &to), &plain.k, 1e-8);
    assert_close(scaled.spectral_radius, plain.spectral_radius, 1e-8);
}

#[test]
fn an_unweighted_unstable_mode_is_stabilised() {
    // P = 0 solves the equation too, but does not stabilise the mode.
    for (a, b, r) in [(2.0, 1.0, 1.0), (-1.1, 3.0, 0.1), (1e3, 1e-2, 1.0)] {
        let solution = scalar(a, b, 0.0, r).unwrap();
        assert_close(solution.p[(0, 0)], (a * a - 1.0) * r / (b * b), 1e-12);
        assert!((solution.spectral_radius - 1.0 / a.abs()).abs() < 1e-12);
    }
    // The two unstable modes do not couple to the third state, which alone has a cost.
    let unseen = dmatrix![1.5, 0.0, 0.3; 0.3, 1.2, 0.0; 0.0, 0.0, 0.9];
    let (b, q) = (dmatrix![1.0; 0.5; 0.2], dmatrix![0.0, 0.0, 0.0; 0.0, 0.0, 0.0; 0.0, 0.0, 1.0]);
    let solution = solve(&unseen, &b, &q, &dmatrix![1.0]).unwrap();
    assert_solves(&solution, &unseen, &b, &q, &dmatrix![1.0], &DMatrix::zeros(3, 1));
}

#[test]
fn a_stable_mode_may_be_uncontrollable() {
    let solution =
        Riccati::new(&matrix![0.9, 0.0; 0.0, 1.1], &vector![0.0, 1.0], &Matrix2::identity(), &Matrix1::identity())
            .solve()
            .unwrap();
    assert_close(solution.p[(0, 0)], 1.0 / (1.0 - 0.81), 1e-13);
    assert_close(solution.p[(1, 1)], scalar_solution(1.1, 1.0, 1.0, 1.0), 1e-13);
    assert_close(solution.spectral_radius, 0.9, 1e-13);
}

#[test]
fn without_controls_the_equation_is_steins_equation() {
    let (none, nothing) = (DMatrix::zeros(2, 0), DMatrix::zeros(0, 0));
    let a = dmatrix![0.5, 0.0; 0.0, -0.8];
    let solution = solve(&a, &none, &DMatrix::identity(2, 2), &nothing).unwrap();
    assert_close_matrix(&solution.p, &dmatrix![1.0 / 0.75, 0.0; 0.0, 1.0 / 0.36], 1e-14);
    assert_eq!(solution.k.shape(), (0, 2));
    let growing = solve(&(a * 2.0), &none, &DMatrix::identity(2, 2), &nothing);
    assert!(matches!(growing, Err(RiccatiError::UncontrollableMode { .. })), "{growing:?}");
}

#[test]
fn without_states_the_solution_is_empty() {
    let solution =
        solve(&DMatrix::zeros(0, 0), &DMatrix::zeros(0, 2), &DMatrix::zeros(0, 0), &DMatrix::identity(2, 2)).unwrap();
    assert_eq!((solution.p.shape(), solution.k.shape()), ((0, 0), (2, 0)));
}

#[test]
fn a_row_major_view_gives_the_same_solution() {
    let mut generator = Generator(6);
    for size in [2, 4, 9, 20] {
        let (a, b) = (generator.matrix(size, size), generator.matrix(size, 2));
        let (q, r) = (generator.positive(size), generator.positive(2));
        let transposed = (a.transpose(), b.transpose());
        let row_major = Riccati::new(row_major(&transposed.0), row_major(&transposed.1), &q, &r).solve().unwrap();
        assert_eq!(row_major, solve(&a, &b, &q, &r).unwrap());
    }
}
