//! Quadratic programs with box constraints: the Karush–Kuhn–Tucker conditions, which are necessary
//! and sufficient for the minimum, and SciPy's numbers.

use mujoco_safe::math::{self, BoxQp, BoxQpStatus};
use mujoco_safe::{Error, Matrix};
use proptest::prelude::*;

use crate::cholesky::definite;
use crate::{assert_near, numbers, random};

const H: [[f64; 4]; 4] = [[4.0, 1.0, 0.5, -1.0], [1.0, 3.0, -0.5, 0.25], [0.5, -0.5, 2.0, 0.3], [-1.0, 0.25, 0.3, 5.0]];
const G: [f64; 4] = [-8.0, 1.5, -6.0, 2.0];

#[test]
fn solutions_equal_scipy() {
    // scipy.optimize.lsq_linear(Lᵀ, −L⁻¹ g, bounds, method="bvls") of scipy 1.15.3.
    let mut solver = BoxQp::new(4);
    let mut x = [0.0; 4];
    let solution =
        solver.solve(&mut x, &H, &G, Some(&[-1.0, -3.0, -3.0, -0.25]), Some(&[1.5, 2.0, 10.0, 4.0])).unwrap();
    assert_eq!(solution.status, BoxQpStatus::Solved);
    assert_eq!(solution.index, [1, 2, 3]);
    assert_near(&x, &[1.5, -0.561_748_585_572_843_9, 2.518_011_845_827_439_6, -0.222_993_281_471_003_83], 1e-12);
    // Every coordinate is at a bound; the start is infeasible.
    let mut x = [100.0, -100.0, 0.0, 0.0];
    let solution = solver.solve(&mut x, &H, &G, Some(&[-1.0, -0.2, -3.0, -0.1]), Some(&[1.5, 2.0, 1.25, 0.4])).unwrap();
    assert_eq!((solution.status, solution.index.len(), solution.factor.shape()), (BoxQpStatus::Solved, 0, (0, 0)));
    assert_eq!(x, [1.5, -0.2, 1.25, -0.1]);
}

#[test]
fn without_bounds_the_solution_is_that_of_the_linear_system() {
    let mut random = random(40);
    for n in [0, 1, 3, 12] {
        let h = definite(&mut random, n);
        let g = numbers(&mut random, n);
        let mut x = numbers(&mut random, n);
        let mut solver = BoxQp::new(n);
        let solution = solver.solve(&mut x, &Matrix::from(&h), &g, None, None).unwrap();
        assert_eq!(solution.status, BoxQpStatus::Solved);
        assert!(solution.iterations <= 2);
        assert_eq!(solution.index, (0..n).collect::<Vec<_>>());
        // The factor is that of the whole matrix, and solves other systems with it.
        let mut res = vec![0.0; n];
        math::chol_solve(&mut res, solution.factor, &g).unwrap();
        let expected = -h.cholesky().unwrap().solve(&nalgebra::DVector::from_vec(g));
        assert_near(&x, expected.as_slice(), 1e-12);
        assert_near(&res, (-expected).as_slice(), 1e-12);
    }
}

#[test]
fn an_indefinite_matrix_is_reported() {
    for corner in [-1.0, 0.0, f64::NAN] {
        let mut x = [0.0; 2];
        let solution =
            BoxQp::new(2).solve(&mut x, &[[1.0, 0.0], [0.0, corner]], &[1.0, 1.0], None, None).unwrap().status;
        assert_eq!(solution, BoxQpStatus::NotPositiveDefinite, "{corner}");
    }
    // Numbers on which computations break down must still terminate.
    let h = [[f64::INFINITY, 0.0], [0.0, 1.0]];
    let status = BoxQp::new(2).solve(&mut [0.0; 2], &h, &[1.0, 1.0], None, None).unwrap().status;
    assert_ne!(status, BoxQpStatus::Solved);
}

#[test]
fn infinite_bounds_and_equal_bounds_are_supported() {
    let mut solver = BoxQp::new(1);
    let mut x = [0.0];
    let none = [f64::NEG_INFINITY];
    solver.solve(&mut x, &[[2.0]], &[-6.0], Some(&none), Some(&[f64::INFINITY])).unwrap();
    assert_near(&x, &[3.0], 1e-14);
    solver.solve(&mut x, &[[2.0]], &[-6.0], Some(&[1.0]), Some(&[1.0])).unwrap();
    assert_eq!(x, [1.0]);
}

#[test]
fn invalid_problems_are_rejected() {
    let mut solver = BoxQp::new(1);
    let mut solve = |x: f64, g: f64, lower: f64, upper: f64| {
        solver.solve(&mut [x], &[[1.0]], &[g], Some(&[lower]), Some(&[upper])).map(|solution| solution.status)
    };
    assert_eq!(solve(0.0, 0.0, -1.0, 1.0).unwrap(), BoxQpStatus::Solved);
    for (x, g, lower, upper, what) in [
        (f64::NAN, 0.0, -1.0, 1.0, "x[0]"),
        (0.0, f64::INFINITY, -1.0, 1.0, "g[0]"),
        (0.0, 0.0, 1.0, -1.0, "interval 0"),
        (0.0, 0.0, f64::NAN, 1.0, "interval 0"),
        (0.0, 0.0, f64::INFINITY, f64::INFINITY, "interval 0"),
    ] {
        let error = solve(x, g, lower, upper).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }) && error.to_string().contains(what), "{error}");
    }
}

proptest! {
    #[test]
    fn solutions_satisfy_the_kkt_conditions(n in 1_usize..12, seed: u64, scale in -6_i32..7) {
        let mut random = random(seed);
        let scale = 10_f64.powi(scale);
        let h = Matrix::from(&(definite(&mut random, n) * scale));
        let g: Vec<f64> = numbers(&mut random, n).iter().map(|value| 3.0 * scale * value).collect();
        let (one, other) = (numbers(&mut random, n), numbers(&mut random, n));
        let lower: Vec<f64> = one.iter().zip(&other).map(|(a, b)| a.min(*b)).collect();
        let upper: Vec<f64> = one.iter().zip(&other).map(|(a, b)| a.max(*b)).collect();
        let mut x = numbers(&mut random, n);
        let mut solver = BoxQp::new(n);
        let solution = solver.solve(&mut x, &h, &g, Some(&lower), Some(&upper)).unwrap();
        prop_assert!(matches!(solution.status, BoxQpStatus::Solved | BoxQpStatus::Stalled), "{:?}", solution.status);
        let mut gradient = vec![0.0; n];
        math::mul_mat_vec(&mut gradient, &h, &x).unwrap();
        math::add_to(&mut gradient, &g).unwrap();
        let small = 1e-8_f64.max(1e-10 * scale);
        for i in 0..n {
            prop_assert!(lower[i] <= x[i] && x[i] <= upper[i]);
            if solution.index.contains(&i) {
                prop_assert!(gradient[i].abs() <= small, "free, gradient {}", gradient[i]);
            } else {
                prop_assert!((x[i] == lower[i] && gradient[i] > 0.0) || (x[i] == upper[i] && gradient[i] < 0.0));
            }
        }
        // The factor is that of the free part.
        let free = solution.index;
        for (i, &row) in free.iter().enumerate() {
            for (j, &column) in free[..=i].iter().enumerate() {
                let product: f64 = (0..=j).map(|k| solution.factor[(i, k)] * solution.factor[(j, k)]).sum();
                prop_assert!((product - h[(row, column)]).abs() <= 1e-10 * scale);
            }
        }
    }
}
