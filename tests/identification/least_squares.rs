//! The solver alone.

use mujoco_safe::control::residual::Norm;
use mujoco_safe::least_squares::{
    Function, LeastSquares, LeastSquaresOptions, LeastSquaresOutcome, LeastSquaresStatus, ResidualFunction,
};
use mujoco_safe::{Error, Matrix, Result};

fn minimise(problem: &mut Function<'_, impl ResidualFunction>, n: usize) -> LeastSquaresOutcome {
    LeastSquares::new(n, LeastSquaresOptions::default()).unwrap().minimise(problem).unwrap()
}

/// Problem Misra1a of NIST's *Statistical Reference Datasets* (data, starts and certified values).
#[test]
fn the_values_that_nist_certifies() {
    let volumes = [77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0];
    let pressures = [10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78];
    for start in [[500.0, 1e-4], [250.0, 5e-4]] {
        let mut x = start;
        let function = |x: &[f64], r: &mut [f64]| {
            for ((r, volume), pressure) in r.iter_mut().zip(volumes).zip(pressures) {
                *r = x[0] * (1.0 - (-x[1] * volume).exp()) - pressure;
            }
            Ok(())
        };
        let outcome = minimise(&mut Function::new(&mut x, 14, function).unwrap(), 2);
        assert_eq!(outcome.status, LeastSquaresStatus::Converged);
        for (found, certified) in x.iter().zip([2.389_421_291_8e2, 5.501_564_318_1e-4]) {
            assert!((found / certified - 1.0).abs() < 1e-6, "{x:?}");
        }
        assert!((2.0 * outcome.cost / 1.245_513_889_4e-1 - 1.0).abs() < 1e-9);
    }
}

struct Rosenbrock;

impl ResidualFunction for Rosenbrock {
    fn residuals(&mut self, x: &[f64], residuals: &mut [f64]) -> Result<()> {
        residuals.copy_from_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        Ok(())
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut Matrix) -> Result<bool> {
        *jacobian = Matrix::from_rows(&[[-20.0 * x[0], 10.0], [-1.0, 0.0]]);
        Ok(true)
    }
}

#[test]
fn bounds_hold() {
    let mut x = [-1.2, 1.0];
    let free = minimise(&mut Function::new(&mut x, 2, Rosenbrock).unwrap(), 2);
    assert_eq!(free.status, LeastSquaresStatus::Converged);
    assert!(x.iter().all(|value| (value - 1.0).abs() < 1e-8), "{x:?}");

    let mut x = [-1.2, 3.0];
    let mut problem = Function::new(&mut x, 2, Rosenbrock).unwrap().with_bounds(&[-2.0, -1.0], &[0.5, 2.0]).unwrap();
    assert_eq!(minimise(&mut problem, 2).status, LeastSquaresStatus::Converged);
    // On the bound, the first residual is zero.
    assert_eq!(x[0], 0.5);
    assert!((x[1] - 0.25).abs() < 1e-6, "{x:?}");
}

/// A line through points of which one is wrong: the smooth absolute value finds the others.
#[test]
fn norms_limit_outliers() {
    let fit = |norm| {
        let mut x = [0.0, 0.0];
        let line = |x: &[f64], r: &mut [f64]| {
            for (i, r) in r.iter_mut().enumerate() {
                let y = if i == 7 { 100.0 } else { 2.0 * i as f64 + 1.0 };
                *r = x[0] * i as f64 + x[1] - y;
            }
            Ok(())
        };
        minimise(&mut Function::new(&mut x, 10, line).unwrap().with_norm(norm), 2);
        x
    };
    let robust = fit(Norm::SmoothAbs { width: 1e-3 });
    assert!((robust[0] - 2.0).abs() < 1e-3 && (robust[1] - 1.0).abs() < 1e-3, "{robust:?}");
    assert!((fit(Norm::Quadratic)[0] - 2.0).abs() > 1.0);
}

#[test]
fn what_has_no_minimum_is_a_status() {
    let run = |value: f64, jump: bool| {
        let mut x = [1.0];
        let function = |x: &[f64], r: &mut [f64]| {
            r[0] = if jump && x[0] != 1.0 { 1e9 } else { x[0] + value };
            Ok(())
        };
        let mut problem = Function::new(&mut x, 1, function).unwrap();
        minimise(&mut problem, 1).status
    };
    assert_eq!(run(f64::NAN, false), LeastSquaresStatus::NotFinite);
    assert_eq!(run(f64::INFINITY, false), LeastSquaresStatus::NotFinite);
    assert_eq!(run(1.0, true), LeastSquaresStatus::Stalled);
    let mut x = [-1.2, 1.0];
    let options = {
        let mut options = LeastSquaresOptions::default();
        options.iterations = 2;
        options
    };
    let mut problem = Function::new(&mut x, 2, Rosenbrock).unwrap();
    let outcome = LeastSquares::new(2, options).unwrap().minimise(&mut problem).unwrap();
    assert_eq!((outcome.status, outcome.iterations), (LeastSquaresStatus::IterationLimit, 3));
    assert!(outcome.cost < outcome.first_cost);
    // No coordinates.
    let mut problem = Function::new(&mut [], 1, |_: &[f64], r: &mut [f64]| {
        r[0] = 3.0;
        Ok(())
    })
    .unwrap();
    assert_eq!(minimise(&mut problem, 0).status, LeastSquaresStatus::Converged);
}

#[test]
fn wrong_arguments_are_errors() {
    let zero = |_: &[f64], r: &mut [f64]| {
        r.fill(0.0);
        Ok(())
    };
    assert!(matches!(Function::new(&mut [f64::NAN], 1, zero), Err(Error::Invalid { .. })));
    for (lower, upper) in [(&[1.0][..], &[0.0][..]), (&[f64::NAN], &[0.0])] {
        let mut x = [0.0];
        assert!(matches!(
            Function::new(&mut x, 1, zero).unwrap().with_bounds(lower, upper),
            Err(Error::Invalid { .. })
        ));
    }
    let mut x = [0.0];
    assert!(matches!(Function::new(&mut x, 1, zero).unwrap().with_bounds(&[], &[1.0]), Err(Error::Shape { .. })));
    for tolerance in [-1.0, f64::NAN] {
        let mut options = LeastSquaresOptions::default();
        options.tolerance = tolerance;
        assert!(matches!(LeastSquares::new(1, options), Err(Error::Invalid { .. })));
    }
    let mut problem = Function::new(&mut x, 1, zero).unwrap();
    let mut solver = LeastSquares::new(2, LeastSquaresOptions::default()).unwrap();
    assert!(matches!(solver.minimise(&mut problem), Err(Error::Shape { .. })));
    let fail = |_: &[f64], _: &mut [f64]| Err(Error::Unsupported("no".into()));
    let mut problem = Function::new(&mut x, 1, fail).unwrap();
    let mut solver = LeastSquares::new(1, LeastSquaresOptions::default()).unwrap();
    assert!(matches!(solver.minimise(&mut problem), Err(Error::Unsupported(_))));
}

#[test]
fn a_search_does_not_allocate() {
    let mut x = [-1.2, 1.0];
    let function = |x: &[f64], r: &mut [f64]| {
        r.copy_from_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        Ok(())
    };
    let mut problem = Function::new(&mut x, 2, function).unwrap();
    let mut solver = LeastSquares::new(2, LeastSquaresOptions::default()).unwrap();
    let allocations = allocation_counter::measure(|| {
        solver.minimise(&mut problem).unwrap();
    });
    assert_eq!(allocations.count_total, 0);
}
