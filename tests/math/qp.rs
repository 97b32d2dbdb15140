//! Quadratic programs with constraints: the Karush–Kuhn–Tucker conditions, which are necessary and
//! sufficient for the minimum, the enumeration of all sets of active constraints, and the numbers
//! of quadprog.

use mujoco_safe::math::{self, Qp, QpProblem, QpStatus};
use mujoco_safe::{Error, Matrix};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{Rng, RngExt};

use crate::cholesky::definite;
use crate::{assert_near, numbers, random};

const INF: f64 = f64::INFINITY;
const H: [[f64; 4]; 4] = [[4.0, 1.0, 0.5, -1.0], [1.0, 3.0, -0.5, 0.25], [0.5, -0.5, 2.0, 0.3], [-1.0, 0.25, 0.3, 5.0]];
const G: [f64; 4] = [-8.0, 1.5, -6.0, 2.0];

#[test]
fn solutions_equal_quadprog() {
    // quadprog.solve_qp of quadprog 0.1.14.
    let c = [[1.0, 1.0, 1.0, 1.0], [1.0, -2.0, 0.5, 0.0], [0.0, 1.0, -1.0, 3.0]];
    let (lower, upper) = ([-1.0, -3.0, -3.0, -0.25], [1.5, 2.0, 1.25, 4.0]);
    let (from, to) = ([1.0, -1.0, -INF], [1.0, 2.0, -1.5]);
    let problem = QpProblem::new(&H, &G).with_bounds(&lower, &upper).with_constraints(&c, &from, &to);
    let expected = [0.773_680_124_223_602_2, -0.395_263_975_155_279_67, 0.871_583_850_931_677_1, -0.25];
    let mut x = [0.0; 4];
    let mut solver = Qp::new(4, 3);
    let solution = solver.solve(&mut x, &problem).unwrap();
    assert_eq!(solution.status, QpStatus::Solved);
    assert_near(&x, &expected, 1e-12);
    assert_near(solution.bound_multipliers, &[0.0, 0.0, 0.0, -3.018_947_981_366_460_4], 1e-12);
    assert_near(solution.constraint_multipliers, &[2.879_968_944_099_379_4, 1.734_782_608_695_652_6, 0.0], 1e-12);
    // The start from the solution needs no iterations.
    let solution = solver.solve(&mut x, &problem).unwrap();
    assert_eq!((solution.status, solution.iterations), (QpStatus::Solved, 0));
    assert_near(&x, &expected, 1e-12);
}

/// Random problem with bounds, inequalities, equations and repeated constraints.
struct Problem {
    h: Matrix,
    g: Vec<f64>,
    bounds: [Vec<f64>; 2],
    c: Matrix,
    limits: [Vec<f64>; 2],
}

/// Returns the smaller and the larger numbers of pairs. Some limits are infinite, some equal.
fn intervals(random: &mut impl Rng, count: usize) -> [Vec<f64>; 2] {
    let mut intervals = [Vec::new(), Vec::new()];
    for _ in 0..count {
        let (a, b): (f64, f64) = (random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
        let (lower, upper) = match random.random_range(0..6) {
            0 => (-INF, a),
            1 => (a, INF),
            2 => (-INF, INF),
            3 if random.random_range(0..3) == 0 => (a, a),
            _ => (a.min(b), a.max(b)),
        };
        intervals[0].push(lower);
        intervals[1].push(upper);
    }
    intervals
}

impl Problem {
    fn new(seed: u64, n: usize, m: usize) -> Self {
        let mut random = random(seed);
        let mut c = Matrix::from_row_major(m, n, numbers(&mut random, m * n));
        let mut limits = intervals(&mut random, m);
        if m >= 3 && random.random_range(0..2) == 0 {
            // The third constraint is twice the first: redundant.
            for column in 0..n {
                c[(2, column)] = 2.0 * c[(0, column)];
            }
            for limits in &mut limits {
                limits[2] = 2.0 * limits[0];
            }
        }
        Self {
            h: Matrix::from(&definite(&mut random, n)),
            g: numbers(&mut random, n).iter().map(|value| 3.0 * value).collect(),
            bounds: intervals(&mut random, n),
            c,
            limits,
        }
    }

    fn view(&self) -> QpProblem<'_> {
        QpProblem::new(&self.h, &self.g).with_bounds(&self.bounds[0], &self.bounds[1]).with_constraints(
            &self.c,
            &self.limits[0],
            &self.limits[1],
        )
    }

    /// Returns the rows of all constraints, those of the bounds first, and their limits.
    fn rows(&self) -> Vec<(Vec<f64>, f64, f64)> {
        let n = self.g.len();
        let unit = |index| (0..n).map(|column| f64::from(u8::from(column == index))).collect();
        let bounds = (0..n).map(|index| (unit(index), self.bounds[0][index], self.bounds[1][index]));
        let rows = self.c.rows().zip(self.limits[0].iter().zip(&self.limits[1]));
        bounds.chain(rows.map(|(row, (lower, upper))| (row.to_vec(), *lower, *upper))).collect()
    }

    /// Returns the minimum by trying all sets of active limits, or `None` if no point is feasible.
    fn enumerate(&self) -> Option<Vec<f64>> {
        let n = self.g.len();
        let rows = self.rows();
        let mut active: Vec<(&[f64], f64)> = Vec::new();
        let mut best: Option<(f64, Vec<f64>)> = None;
        self.search(&rows, 0, n, &mut active, &mut best);
        best.map(|(_, x)| x)
    }

    fn search<'a>(
        &self,
        rows: &'a [(Vec<f64>, f64, f64)],
        next: usize,
        n: usize,
        active: &mut Vec<(&'a [f64], f64)>,
        best: &mut Option<(f64, Vec<f64>)>,
    ) {
        if next == rows.len() {
            let count = active.len();
            let matrix = DMatrix::from_fn(n + count, n + count, |i, j| match (i < n, j < n) {
                (true, true) => self.h[(i, j)],
                (true, false) => active[j - n].0[i],
                (false, true) => active[i - n].0[j],
                (false, false) => 0.0,
            });
            let right = DVector::from_fn(n + count, |i, _| if i < n { -self.g[i] } else { active[i - n].1 });
            let Some(solution) = matrix.full_piv_lu().solve(&right) else { return };
            let x = solution.as_slice()[..n].to_vec();
            let value = |row: &[f64]| row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            let feasible = rows.iter().all(|(row, lower, upper)| {
                let value = value(row);
                lower - 1e-9 <= value && value <= upper + 1e-9
            });
            let h = DMatrix::from_fn(n, n, |i, j| self.h[(i, j)]);
            let point = DVector::from_row_slice(&x);
            let cost = 0.5 * (h * &point).dot(&point) + point.dot(&DVector::from_row_slice(&self.g));
            if feasible && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                *best = Some((cost, x));
            }
            return;
        }
        self.search(rows, next + 1, n, active, best);
        let (row, lower, upper) = &rows[next];
        for limit in [*lower, *upper] {
            if limit.is_finite() && active.len() < n {
                active.push((row, limit));
                self.search(rows, next + 1, n, active, best);
                active.pop();
            }
        }
    }
}

#[track_caller]
fn assert_is_minimum(problem: &Problem, x: &[f64], bounds: &[f64], constraints: &[f64]) {
    let mut gradient = vec![0.0; x.len()];
    math::mul_mat_vec(&mut gradient, &problem.h, x).unwrap();
    math::add_to(&mut gradient, &problem.g).unwrap();
    for ((row, lower, upper), multiplier) in problem.rows().iter().zip(bounds.iter().chain(constraints)) {
        let value: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
        assert!(lower - 1e-9 <= value && value <= upper + 1e-9, "{value} is not in [{lower}, {upper}]");
        assert!(*multiplier <= 1e-12 || value >= upper - 1e-9, "a multiplier {multiplier} below the upper limit");
        assert!(*multiplier >= -1e-12 || value <= lower + 1e-9, "a multiplier {multiplier} above the lower limit");
        gradient.iter_mut().zip(row).for_each(|(gradient, a)| *gradient += multiplier * a);
    }
    assert_near(&gradient, &vec![0.0; x.len()], 1e-8);
}

proptest! {
    #[test]
    fn solutions_satisfy_the_kkt_conditions_from_any_start(n in 1_usize..16, m in 0_usize..12, seeds: [u64; 4]) {
        let mut solver = Qp::new(n, 12);
        // Each problem starts from the active constraints of the one before.
        for seed in seeds {
            let problem = Problem::new(seed, n, m);
            let mut x = vec![0.0; n];
            let solution = solver.solve(&mut x, &problem.view()).unwrap();
            match solution.status {
                QpStatus::Solved => {
                    assert_is_minimum(&problem, &x, solution.bound_multipliers, solution.constraint_multipliers);
                }
                QpStatus::Infeasible => {
                    // Without the past, too.
                    prop_assert!(solution.conflict.is_some_and(|index| index < n + m));
                    let status = Qp::new(n, m).solve(&mut x, &problem.view()).unwrap().status;
                    prop_assert_eq!(status, QpStatus::Infeasible);
                }
                other => prop_assert!(false, "{other:?}"),
            }
        }
    }

    #[test]
    fn solutions_equal_the_best_of_all_active_sets(n in 1_usize..4, m in 0_usize..4, seed: u64) {
        let problem = Problem::new(seed, n, m);
        let mut x = vec![0.0; n];
        let mut solver = Qp::new(n, m);
        let solution = solver.solve(&mut x, &problem.view()).unwrap();
        let expected = problem.enumerate();
        prop_assert_eq!(solution.status == QpStatus::Solved, expected.is_some());
        prop_assert_eq!(solution.status == QpStatus::Infeasible, expected.is_none());
        if let Some(expected) = expected {
            assert_near(&x, &expected, 1e-6);
        }
    }

    #[test]
    fn hostile_numbers_end_with_a_status(values in proptest::collection::vec(
        prop_oneof![Just(0.0), Just(1e308), Just(-1e300), Just(1e-308), -1.0..1.0_f64], 9 + 3 + 6 + 6 + 4
    ), inf: bool) {
        let mut h = Matrix::from_row_major(3, 3, values[..9].to_vec());
        if inf { h[(1, 1)] = f64::NAN; }
        let sorted = |range: std::ops::Range<usize>| {
            let half = range.len() / 2;
            let (a, b) = values[range].split_at(half);
            let lower: Vec<f64> = a.iter().zip(b).map(|(a, b)| a.min(*b)).collect();
            let upper: Vec<f64> = a.iter().zip(b).map(|(a, b)| a.max(*b)).collect();
            (lower, upper)
        };
        let ((lower, upper), (from, to)) = (sorted(12..18), sorted(24..28));
        let c = Matrix::from_row_major(2, 3, values[18..24].to_vec());
        let problem = QpProblem::new(&h, &values[9..12]).with_bounds(&lower, &upper).with_constraints(&c, &from, &to);
        let mut x = [f64::NAN; 3];
        let mut solver = Qp::new(3, 2);
        for _ in 0..2 {
            let solution = solver.solve(&mut x, &problem).unwrap();
            prop_assert!(!inf || solution.status == QpStatus::NotPositiveDefinite);
            prop_assert!(x.iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn degenerate_vertices_and_redundant_equations_are_solved() {
    let h = [[1.0, 0.0], [0.0, 1.0]];
    // Five constraints meet in the minimum (1, 1); the last three are equations of one line.
    let c = [[1.0, 1.0], [1.0, 2.0], [2.0, 1.0], [1.0, -1.0], [2.0, -2.0], [-3.0, 3.0]];
    let (lower, upper) = ([2.0, 3.0, 3.0, 0.0, 0.0, 0.0], [INF, INF, INF, 0.0, 0.0, 0.0]);
    let problem =
        QpProblem::new(&h, &[0.0, 0.0]).with_bounds(&[1.0; 2], &[INF; 2]).with_constraints(&c, &lower, &upper);
    let mut x = [0.0; 2];
    let mut solver = Qp::new(2, 6);
    let solution = solver.solve(&mut x, &problem).unwrap();
    assert_eq!(solution.status, QpStatus::Solved);
    assert_near(&x, &[1.0, 1.0], 1e-12);
}

#[test]
fn contradictions_are_reported_with_a_constraint() {
    let h = [[1.0, 0.0], [0.0, 1.0]];
    let c = [[1.0, 1.0], [0.0, 0.0]];
    let mut solver = Qp::new(2, 2);
    let mut x = [0.0; 2];
    let mut conflict = |lower: [f64; 2], upper: [f64; 2]| {
        let problem =
            QpProblem::new(&h, &[0.0, 0.0]).with_bounds(&[-1.0; 2], &[1.0; 2]).with_constraints(&c, &lower, &upper);
        let solution = solver.solve(&mut x, &problem).unwrap();
        (solution.status, solution.conflict)
    };
    assert_eq!(conflict([2.0, 0.0], [2.0, 0.0]), (QpStatus::Solved, None));
    // A corner of the box is too near.
    assert_eq!(conflict([2.5, 0.0], [2.5, 0.0]).0, QpStatus::Infeasible);
    // A row of zeros cannot have the product 1.
    assert_eq!(conflict([0.0, 1.0], [0.0, 1.0]), (QpStatus::Infeasible, Some(3)));
    assert_eq!(conflict([2.0, -1.0], [2.0, 0.0]), (QpStatus::Solved, None));
}

#[test]
fn a_matrix_that_is_not_positive_definite_is_reported() {
    for corner in [-1.0, 0.0, 1.0, f64::NAN, INF] {
        let mut x = [1.0; 2];
        let h = [[1.0, 1.0], [1.0, corner]];
        let status = Qp::new(2, 0).solve(&mut x, &QpProblem::new(&h, &[1.0, 1.0])).unwrap().status;
        assert_eq!(status, QpStatus::NotPositiveDefinite, "{corner}");
        assert_eq!(x, [0.0; 2]);
    }
}

#[test]
fn invalid_problems_are_rejected() {
    let h = [[1.0, 0.0], [0.0, 1.0]];
    let mut solver = Qp::new(2, 1);
    let mut solve = |problem: QpProblem<'_>| solver.solve(&mut [0.0; 2], &problem).unwrap_err();
    let valid = QpProblem::new(&h, &[0.0; 2]);
    assert!(matches!(solve(QpProblem::new(&[[1.0]], &[0.0; 2])), Error::Shape { .. }));
    assert!(matches!(solve(QpProblem::new(&h, &[0.0; 3])), Error::Shape { .. }));
    assert!(matches!(solve(valid.with_bounds(&[0.0; 1], &[0.0; 2])), Error::Shape { .. }));
    assert!(matches!(solve(valid.with_constraints(&[[1.0; 3]], &[0.0], &[0.0])), Error::Shape { .. }));
    for (error, what) in [
        (solve(QpProblem::new(&h, &[0.0, f64::NAN])), "g[1]"),
        (solve(valid.with_bounds(&[0.0, 1.0], &[0.0, 0.0])), "interval 1 of the bounds"),
        (solve(valid.with_bounds(&[f64::NAN, 0.0], &[0.0, 0.0])), "interval 0 of the bounds"),
        (solve(valid.with_constraints(&[[1.0, INF]], &[0.0], &[0.0])), "c[1]"),
        (solve(valid.with_constraints(&[[1.0, 1.0]], &[INF], &[INF])), "interval 0 of the constraints"),
        (solve(valid.with_constraints(&[[1.0; 2]; 2], &[0.0; 2], &[0.0; 2])), "at most 1"),
    ] {
        assert!(matches!(error, Error::Invalid { .. }) && error.to_string().contains(what), "{error}");
    }
}
