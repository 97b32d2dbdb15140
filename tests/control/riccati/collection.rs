//! The benchmark collection DAREX, which includes badly scaled and singular equations.
//! `tests/oracle/riccati.py` recorded the matrices, SciPy's solutions and the closed-form
//! solutions.

use mujoco_safe::control::riccati::{Riccati, RiccatiSolution, RiccatiWorkspace};
use nalgebra::DMatrix;
use serde_json::Value;

use super::spectral_radius;

struct Example {
    name: String,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    q: DMatrix<f64>,
    r: DMatrix<f64>,
    s: Option<DMatrix<f64>>,
    formula: Option<DMatrix<f64>>,
    scipy: Option<DMatrix<f64>>,
}

fn matrix(value: &Value) -> Option<DMatrix<f64>> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).ok()?;
    Some(DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column]))
}

fn examples() -> Vec<Example> {
    let recorded: Vec<Value> = serde_json::from_str(include_str!("../../oracle/riccati.json")).unwrap();
    let example = |value: &Value| Example {
        name: value["name"].as_str().unwrap().to_owned(),
        a: matrix(&value["a"]).unwrap(),
        b: matrix(&value["b"]).unwrap(),
        q: matrix(&value["q"]).unwrap(),
        r: matrix(&value["r"]).unwrap(),
        s: matrix(&value["s"]),
        formula: matrix(&value["formula"]),
        scipy: matrix(&value["scipy"]),
    };
    recorded.iter().map(example).collect()
}

impl Example {
    fn equation(&self) -> Riccati<'_> {
        let equation = Riccati::new(&self.a, &self.b, &self.q, &self.r);
        match &self.s {
            None => equation,
            Some(s) => equation.with_cross_term(s),
        }
    }

    fn solve(&self) -> RiccatiSolution {
        self.equation().solve().unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }
}

#[test]
fn every_example_is_solved_to_rounding_and_stabilised() {
    let examples = examples();
    assert!(examples.len() > 20);
    for example in examples {
        let Example { name, a, b, q, r, s, .. } = &example;
        let RiccatiSolution { p, k, relative_residual, spectral_radius: radius, .. } = example.solve();
        let (p, k) = (p.to_nalgebra(), k.to_nalgebra());
        assert_eq!(p, p.transpose(), "{name}");
        let s = s.clone().unwrap_or_else(|| DMatrix::zeros(b.nrows(), b.ncols()));

        // The gain follows from P, as precisely as the cost of the controls determines it.
        let cost = r + b.transpose() * &p * b;
        let coupling = b.transpose() * &p * a + s.transpose();
        let unbalanced =
            (&cost * &k - &coupling).norm() / (cost.norm() * k.norm() + coupling.norm() + f64::MIN_POSITIVE);
        assert!(unbalanced < 1e-13, "{name}: {unbalanced:e}");
        let closed_loop = a - b * &k;
        let right =
            closed_loop.transpose() * &p * &closed_loop + k.transpose() * r * &k - &s * &k - (&s * &k).transpose() + q;
        let residual = (&p - right).norm() / p.norm();
        assert!(residual < 1e-12, "{name}: the residual is {residual:e}");
        assert!((residual - relative_residual).abs() < 1e-14, "{name}: {residual:e} but {relative_residual:e}");
        assert!(radius < 1.0, "{name}: {radius}");
        // Rounding perturbs the eigenvalues of a nilpotent closed loop by its n-th root.
        if name.starts_with("2.") || name.starts_with("1.") {
            let by_schur = spectral_radius(&closed_loop);
            assert!((radius - by_schur).abs() < 1e-7, "{name}: {radius} but {by_schur}");
        }
    }
}

#[test]
fn solutions_equal_closed_forms_and_scipy() {
    let mut compared = 0;
    for example in examples() {
        let p = example.solve().p.to_nalgebra();
        // A spectral radius of 1 - 1e-8 makes the equation ill-conditioned: half of the digits are
        // lost.
        let determined = if example.name.starts_with("2.3") { 1e-6 } else { 1e-10 };
        for (source, expected) in [("its formula", &example.formula), ("SciPy", &example.scipy)] {
            if let Some(expected) = expected {
                let difference = (&p - expected).norm() / expected.norm();
                assert!(difference < determined, "{}: differs by {difference:e} from {source}", example.name);
                compared += 1;
            }
        }
    }
    assert!(compared > 30);
}

#[test]
fn a_reused_workspace_gives_the_same_solutions() {
    let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    let examples = examples();
    for example in examples.iter().chain(examples.iter().rev()) {
        example.equation().solve_into(&mut workspace, &mut solution).unwrap();
        assert_eq!(solution, example.solve(), "{}", example.name);
    }
}

#[test]
fn solving_again_at_the_same_size_allocates_nothing() {
    let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    for example in examples() {
        // The solver computes the eigenvalues of a singular R, which allocates.
        if example.name.starts_with("1.3") || example.name.starts_with("1.4") {
            continue;
        }
        let equation = example.equation();
        equation.solve_into(&mut workspace, &mut solution).unwrap();
        let counted = allocation_counter::measure(|| equation.solve_into(&mut workspace, &mut solution).unwrap());
        assert_eq!(counted.count_total, 0, "{}", example.name);
    }
}

#[test]
fn a_failed_solve_keeps_the_previous_solution() {
    let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    let example = &examples()[0];
    example.equation().solve_into(&mut workspace, &mut solution).unwrap();
    let before = solution.clone();
    let uncontrolled = DMatrix::zeros(2, 1);
    let growing = &example.a * 4.0;
    let failed = Riccati::new(&growing, &uncontrolled, &example.q, &example.r);
    assert!(failed.solve_into(&mut workspace, &mut solution).is_err());
    assert_eq!(solution, before);
    // The workspace remains usable.
    example.equation().solve_into(&mut workspace, &mut solution).unwrap();
    assert_eq!(solution, before);
}
