//! The Riccati solver: closed-form solutions, solutions checked by formulas that share no code with
//! the solver (`solutions.rs`), a published benchmark collection (`collection.rs`), and the errors
//! of unsolvable equations (`failures.rs`).
//!
//! The textbook systems are from the collection DAREX (Abels and Benner 1999), written from their
//! formulas. Random systems come from a small generator with fixed seeds.
#![allow(
    clippy::many_single_char_names,
    clippy::unreadable_literal,
    reason = "symbols of the literature, and figures as published"
)]

mod collection;
mod failures;
mod solutions;

use mujoco_safe::control::riccati::{Riccati, RiccatiError, RiccatiSolution};
use mujoco_safe::matrix::StridedView;
use nalgebra::{DMatrix, DMatrixView, Dyn, Matrix1};

/// A linear congruential generator of numbers between -1 and 1.
struct Generator(u64);

impl Generator {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 32) as u32) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.number())
    }

    fn positive(&mut self, size: usize) -> DMatrix<f64> {
        let root = self.matrix(size, size);
        &root * root.transpose() + DMatrix::identity(size, size) * 0.1
    }

    fn rotation(&mut self, size: usize) -> DMatrix<f64> {
        self.matrix(size, size).qr().q()
    }
}

fn solve(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<RiccatiSolution, RiccatiError> {
    Riccati::new(a, b, q, r).solve()
}

fn scalar(a: f64, b: f64, q: f64, r: f64) -> Result<RiccatiSolution, RiccatiError> {
    Riccati::new(&Matrix1::new(a), &Matrix1::new(b), &Matrix1::new(q), &Matrix1::new(r)).solve()
}

/// Returns the larger root of the scalar equation, `b²p² + (r − a²r − qb²) p − qr = 0`, without
/// cancellation.
fn scalar_solution(a: f64, b: f64, q: f64, r: f64) -> f64 {
    let half = (q * b * b + a * a * r - r) / 2.0;
    let root = (half * half + b * b * q * r).sqrt();
    if half > 0.0 { (half + root) / (b * b) } else { q * r / (root - half) }
}

/// Returns a row-major view of the matrix with this transpose.
fn row_major(transpose: &DMatrix<f64>) -> DMatrixView<'_, f64, Dyn, Dyn> {
    let (columns, rows) = transpose.shape();
    DMatrixView::from_slice_with_strides(transpose.as_slice(), rows, columns, columns, 1)
}

fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    matrix.complex_eigenvalues().iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max)
}

#[track_caller]
fn assert_close(got: f64, expected: f64, relative: f64) {
    assert!((got - expected).abs() <= relative * expected.abs(), "got {got:e}, expected {expected:e} to {relative:e}");
}

#[track_caller]
fn assert_close_matrix<'a>(got: impl Into<StridedView<'a>>, expected: impl Into<StridedView<'a>>, relative: f64) {
    let (got, expected) = (got.into().to_matrix().to_nalgebra(), expected.into().to_matrix().to_nalgebra());
    let difference = (&got - &expected).norm();
    assert!(
        difference <= relative * expected.norm(),
        "differs by {difference:e} from one of norm {:e}: {got} {expected}",
        expected.norm()
    );
}

/// Asserts that a solution is the stabilising one, by the formulas of the documentation.
#[track_caller]
fn assert_solves(
    solution: &RiccatiSolution,
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    s: &DMatrix<f64>,
) {
    let (p, k) = (&solution.p.to_nalgebra(), &solution.k.to_nalgebra());
    assert_eq!(p, &p.transpose());
    let least = p.clone().symmetric_eigenvalues().min();
    assert!(least >= -1e-12 * p.norm(), "an eigenvalue of P is {least:e}");

    let inverse = (r + b.transpose() * p * b).try_inverse().expect("positive definite");
    let gain = &inverse * (b.transpose() * p * a + s.transpose());
    assert_close_matrix(k, &gain, 1e-9);
    let right = a.transpose() * p * a - (a.transpose() * p * b + s) * &gain + q;
    let residual = (p - right).norm() / p.norm();
    assert!(residual < 1e-11, "the residual is {residual:e}");
    assert!(solution.relative_residual < 1e-12, "the solution reports {:e}", solution.relative_residual);

    let radius = spectral_radius(&(a - b * k));
    assert!(radius < 1.0);
    assert!((radius - solution.spectral_radius).abs() < 1e-9, "{radius} but {}", solution.spectral_radius);
}
