//! The Riccati recursion against SciPy, and against the same problem as one linear system.
#![allow(clippy::many_single_char_names, reason = "symbols of the literature")]
#![allow(clippy::unreadable_literal, reason = "figures as published")]

use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiMatrix, RiccatiRecursion};
use mujoco_safe::{LqrWeights, Matrix};
use nalgebra::{DMatrix, DVector, dmatrix};

use super::{Random, assert_close, weights};

/// Returns the upright cart-pole of the reference's documentation.
fn upright() -> (DMatrix<f64>, DMatrix<f64>) {
    (
        dmatrix![
            1.0, -0.00020933539434596422, 0.00999696728367769, 7.112993351890879e-06;
            0.0, 1.0027918363759287, 7.112993351890878e-06, 0.009905136378663615;
            0.0, -0.020933539434596422, 0.9996967283677689, 0.000711299335189088;
            0.0, 0.2791836375928739, 0.0007112993351890878, 0.9905136378663615
        ],
        dmatrix![0.0030327163223112376; -0.007112993351890878; 0.30327163223112374; -0.7112993351890878],
    )
}

#[test]
fn over_a_long_horizon_the_first_gain_equals_scipy() {
    let (a, b) = upright();
    let mut recursion = RiccatiRecursion::new(&DMatrix::zeros(4, 4), 1).unwrap();
    for _ in 0..5000 {
        recursion.step_back(&a, &b, &weights()).unwrap();
    }
    // SciPy's solve_discrete_are.
    let k = dmatrix![-0.46741668449941, -5.5927150414698, -0.8436677105895, -1.4448668569023];
    assert_close(recursion.k(), &k, 1e-11);
    let p = [180.2819066017, 2907.909272519, 166.5472641831, 37.13361185153];
    assert_close(&recursion.p().to_nalgebra().diagonal(), &DMatrix::from_column_slice(4, 1, &p), 1e-11);
}

#[test]
fn the_solution_of_the_equation_is_a_fixed_point() {
    let mut random = Random::new(1);
    for size in [1, 3, 8] {
        let (a, b) = (random.matrix(size, size), random.matrix(size, 2));
        let weights = LqrWeights::new(random.positive(size, 0.1), random.positive(2, 0.1));
        let solution = Riccati::new(&a, &b, &weights.q, &weights.r).solve().expect("controllable");
        let mut recursion = RiccatiRecursion::new(&solution.p, 2).unwrap();
        assert_close(recursion.step_back(&a, &b, &weights).unwrap(), &solution.k, 1e-9);
        assert_close(recursion.p(), &solution.p, 1e-9);
    }
}

/// A time-varying system and its cost.
struct Problem {
    systems: Vec<(DMatrix<f64>, DMatrix<f64>, LqrWeights)>,
    terminal: DMatrix<f64>,
}

impl Problem {
    fn new(seed: u64, steps: usize, (n, m): (usize, usize), cross: bool) -> Self {
        let mut random = Random::new(seed);
        let mut step = |_| {
            let (a, b) = (random.matrix(n, n), random.matrix(n, m));
            // One positive definite matrix for states and controls, so that the cost is never
            // negative.
            let all = random.positive(n + m, 0.5);
            let block = |row, column, rows, columns| all.view((row, column), (rows, columns)).into_owned();
            let s = cross.then(|| block(0, n, n, m));
            (a, b, LqrWeights { s: s.map(Matrix::from), ..LqrWeights::new(block(0, 0, n, n), block(n, n, m, m)) })
        };
        Self { systems: (0..steps).map(&mut step).collect(), terminal: random.positive(n, 0.0) }
    }

    /// Returns the stacked optimal controls of all steps, and their cost, from the normal
    /// equations.
    fn solve(&self, begin: &DVector<f64>) -> (DVector<f64>, f64) {
        let (n, m, steps) = (begin.len(), self.systems[0].1.ncols(), self.systems.len());
        // The states are `offset + map u`, with the stacked controls u; the cost is
        // `½ uᵀ H u + gᵀ u + c`.
        let (mut offset, mut map) = (begin.clone(), DMatrix::zeros(n, m * steps));
        let (mut h, mut g, mut c) = (DMatrix::zeros(m * steps, m * steps), DVector::zeros(m * steps), 0.0);
        for (step, (a, b, weights)) in self.systems.iter().enumerate() {
            let (q, r) = (weights.q.to_nalgebra(), weights.r.to_nalgebra());
            let mut select = DMatrix::zeros(m, m * steps);
            select.view_mut((0, m * step), (m, m)).fill_with_identity();
            h += (map.transpose() * &q * &map + select.transpose() * &r * &select) * 2.0;
            g += map.transpose() * &q * &offset * 2.0;
            c += offset.dot(&(&q * &offset));
            if let Some(s) = weights.s.as_ref().map(Matrix::to_nalgebra) {
                let mixed = map.transpose() * &s * &select;
                h += (&mixed + mixed.transpose()) * 2.0;
                g += select.transpose() * s.transpose() * &offset * 2.0;
            }
            offset = a * offset;
            map = a * map + b * select;
        }
        h += map.transpose() * &self.terminal * &map * 2.0;
        g += map.transpose() * &self.terminal * &offset * 2.0;
        c += offset.dot(&(&self.terminal * &offset));
        let u = -h.clone().cholesky().unwrap().solve(&g);
        let cost = 0.5 * u.dot(&(&h * &u)) + g.dot(&u) + c;
        (u, cost)
    }
}

#[test]
fn the_gains_give_the_optimum_of_the_stacked_problem() {
    for (seed, sizes, cross) in [(1, (2, 1), false), (2, (3, 2), false), (3, (4, 2), true), (4, (1, 3), true)] {
        let (n, m) = sizes;
        let problem = Problem::new(seed, 5, sizes, cross);
        let begin = Random::new(seed + 100).vector(n);
        let (expected, cost) = problem.solve(&begin);

        let mut recursion = RiccatiRecursion::new(&problem.terminal, m).unwrap();
        let back = |(a, b, weights): &(_, _, _)| recursion.step_back(a, b, weights).unwrap().to_nalgebra();
        let mut gains: Vec<DMatrix<f64>> = problem.systems.iter().rev().map(back).collect();
        gains.reverse();
        assert!(
            (begin.dot(&(recursion.p().to_nalgebra() * &begin)) - cost).abs() <= 1e-9 * cost,
            "the cost to go of problem {seed}"
        );
        let mut state = begin;
        for (step, (gain, (a, b, _))) in gains.iter().zip(&problem.systems).enumerate() {
            let control = -gain * &state;
            let expected = expected.rows(m * step, m);
            assert!((&control - expected).norm() <= 1e-8 * expected.norm(), "step {step} of problem {seed}");
            state = a * state + b * control;
        }
    }
}

#[test]
fn controls_need_no_weight_if_they_affect_a_weighted_state() {
    // One step brings the state to zero.
    let mut recursion = RiccatiRecursion::new(&DMatrix::identity(2, 2), 2).unwrap();
    let a = dmatrix![1.0, 2.0; 3.0, 4.0];
    let weights = LqrWeights::diagonal(&[0.0, 0.0], &[0.0, 0.0]);
    let gain = recursion.step_back(&a, &DMatrix::<f64>::identity(2, 2), &weights).unwrap().clone();
    assert_close(&gain, &a, 1e-15);
    assert!(recursion.p().to_nalgebra().norm() < 1e-15);
}

/// Corrupts A, B or the weights.
type Corrupt = fn(&mut DMatrix<f64>, &mut DMatrix<f64>, &mut LqrWeights);

#[test]
fn an_invalid_matrix_is_an_error_that_names_it() {
    let good = || {
        (DMatrix::<f64>::identity(3, 3), DMatrix::from_element(3, 2, 0.5), {
            let mut weights = LqrWeights::diagonal(&[1.0; 3], &[1.0; 2]);
            weights.s = Some(Matrix::zeros(3, 2));
            weights
        })
    };
    let begin = || RiccatiRecursion::new(&DMatrix::identity(3, 3), 2).unwrap();
    begin().step_back(&good().0, &good().1, &good().2).unwrap();

    let wrong = |matrix, expected, found| RiccatiError::WrongShape { matrix, expected, found };
    let shapes: [(Corrupt, RiccatiError); 5] = [
        (|a, _, _| *a = DMatrix::zeros(3, 4), wrong(RiccatiMatrix::A, (3, 3), (3, 4))),
        (|_, b, _| *b = DMatrix::zeros(3, 3), wrong(RiccatiMatrix::B, (3, 2), (3, 3))),
        (|_, _, weights| weights.q = Matrix::zeros(2, 3), wrong(RiccatiMatrix::Q, (3, 3), (2, 3))),
        (|_, _, weights| weights.r = Matrix::zeros(2, 1), wrong(RiccatiMatrix::R, (2, 2), (2, 1))),
        (|_, _, weights| weights.s = Some(Matrix::zeros(2, 2)), wrong(RiccatiMatrix::S, (3, 2), (2, 2))),
    ];
    for (spoil, expected) in shapes {
        let (mut a, mut b, mut weights) = good();
        spoil(&mut a, &mut b, &mut weights);
        let mut recursion = begin();
        assert_eq!(recursion.step_back(&a, &b, &weights).unwrap_err(), expected);
        assert_eq!((recursion.p(), recursion.k()), (begin().p(), begin().k()));
    }
    let values: [(Corrupt, RiccatiMatrix); 5] = [
        (|a, _, _| a[(2, 1)] = f64::NAN, RiccatiMatrix::A),
        (|_, b, _| b[(2, 1)] = f64::INFINITY, RiccatiMatrix::B),
        (|_, _, weights| weights.q[(2, 1)] = f64::NAN, RiccatiMatrix::Q),
        (|_, _, weights| weights.r[(1, 0)] = f64::NAN, RiccatiMatrix::R),
        (|_, _, weights| weights.s.as_mut().unwrap()[(2, 1)] = f64::NAN, RiccatiMatrix::S),
    ];
    for (spoil, at_fault) in values {
        let (mut a, mut b, mut weights) = good();
        spoil(&mut a, &mut b, &mut weights);
        let error = begin().step_back(&a, &b, &weights).unwrap_err();
        assert!(
            matches!(error, RiccatiError::NotFinite { matrix, column: 1 | 0, .. } if matrix == at_fault),
            "{error}"
        );
    }
    let lopsided: [(Corrupt, RiccatiMatrix); 2] = [
        (|_, _, weights| weights.q[(0, 1)] = 0.1, RiccatiMatrix::Q),
        (|_, _, weights| weights.r[(0, 1)] = 0.1, RiccatiMatrix::R),
    ];
    for (spoil, at_fault) in lopsided {
        let (mut a, mut b, mut weights) = good();
        spoil(&mut a, &mut b, &mut weights);
        let error = begin().step_back(&a, &b, &weights).unwrap_err();
        assert!(matches!(error, RiccatiError::NotSymmetric { matrix, .. } if matrix == at_fault), "{error}");
    }
}

#[test]
fn the_terminal_cost_is_checked() {
    let error = |terminal: DMatrix<f64>| RiccatiRecursion::new(&terminal, 1).unwrap_err();
    let wrong = RiccatiError::WrongShape { matrix: RiccatiMatrix::P, expected: (2, 2), found: (2, 3) };
    assert_eq!(error(DMatrix::zeros(2, 3)), wrong);
    assert!(matches!(
        error(dmatrix![1.0, 0.0; f64::NAN, 1.0]),
        RiccatiError::NotFinite { matrix: RiccatiMatrix::P, row: 1, column: 0, .. }
    ));
    assert!(matches!(
        error(dmatrix![1.0, 0.5; 0.0, 1.0]),
        RiccatiError::NotSymmetric { matrix: RiccatiMatrix::P, row: 0, column: 1, .. }
    ));
}

#[test]
fn an_unbounded_cost_is_an_error() {
    let one = DMatrix::identity(1, 1);
    let mut recursion = RiccatiRecursion::new(&dmatrix![-2.0], 1).unwrap();
    let error = recursion.step_back(&one, &one, &LqrWeights::diagonal(&[1.0], &[1.0])).unwrap_err();
    assert_eq!(error, RiccatiError::NoLeastCost { smallest_eigenvalue: -1.0 });
    assert!(error.to_string().contains("positive semidefinite"), "{error}");
    assert_eq!(recursion.p(), &Matrix::from_diagonal(&[-2.0]));
}
