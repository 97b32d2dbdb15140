//! Cholesky factorisation against nalgebra and the engine.

use mujoco_safe::{Matrix, math};
use nalgebra::{DMatrix, DVector};
use rand::Rng;

use crate::{assert_near, assert_same, c, numbers, random};

/// Returns a symmetric positive definite matrix.
pub(crate) fn definite(random: &mut impl Rng, n: usize) -> DMatrix<f64> {
    let root = DMatrix::from_vec(n, n, numbers(random, n * n));
    &root * root.transpose() + DMatrix::identity(n, n)
}

fn lower(factor: &Matrix) -> DMatrix<f64> {
    factor.to_nalgebra().lower_triangle()
}

#[test]
fn factors_and_solutions_equal_nalgebra() {
    let mut random = random(20);
    for n in [0, 1, 2, 5, 17] {
        let full = definite(&mut random, n);
        let mut factor = Matrix::from(&full);
        assert_eq!(math::chol_factor(&mut factor, 1e-15).unwrap(), n);
        let cholesky = full.clone().cholesky().unwrap();
        assert_near(lower(&factor).as_slice(), cholesky.l().as_slice(), 1e-12);
        let vec = numbers(&mut random, n);
        let mut res = vec![0.0; n];
        math::chol_solve(&mut res, &factor, &vec).unwrap();
        assert_near(&res, cholesky.solve(&DVector::from_vec(vec.clone())).as_slice(), 1e-11);
        let mut in_place = vec;
        math::chol_solve_in_place(&factor, &mut in_place).unwrap();
        assert_same(&in_place, &res);
    }
}

#[test]
fn updates_and_downdates_equal_factors_of_the_sum_and_difference() {
    let mut random = random(21);
    for n in [1, 2, 6, 13] {
        let full = definite(&mut random, n);
        let x = numbers(&mut random, n);
        let outer = DVector::from_vec(x.clone()) * DVector::from_vec(x.clone()).transpose();
        let mut factor = Matrix::from(&full);
        math::chol_factor(&mut factor, 1e-15).unwrap();
        assert_eq!(math::chol_update(&mut factor, &mut x.clone(), math::RankOneUpdate::Add).unwrap(), n);
        let l = lower(&factor);
        assert_near((&l * l.transpose()).as_slice(), (&full + &outer).as_slice(), 1e-11);
        assert_eq!(math::chol_update(&mut factor, &mut x.clone(), math::RankOneUpdate::Subtract).unwrap(), n);
        let l = lower(&factor);
        assert_near((&l * l.transpose()).as_slice(), full.as_slice(), 1e-11);
    }
}

#[test]
fn a_rank_deficient_matrix_has_the_engines_factor() {
    // A matrix of rank 2.
    let mut ours = Matrix::from_rows(&[[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 2.0]]);
    let mut theirs = ours.as_slice().to_vec();
    assert_eq!(math::chol_factor(&mut ours, 1e-10).unwrap(), 2);
    assert_eq!(c!(mju_cholFactor(theirs.as_mut_ptr(), 3, 1e-10)), 2);
    assert_same(ours.as_slice(), &theirs);
    // Subtracting too much.
    let mut one = Matrix::from_rows(&[[1.0]]);
    assert_eq!(math::chol_update(&mut one, &mut [2.0], math::RankOneUpdate::Subtract).unwrap(), 0);
    assert!(one[(0, 0)] > 0.0);
}

#[test]
fn nan_propagates_or_reduces_the_rank() {
    let mut mat = Matrix::from_rows(&[[f64::NAN, 0.0], [0.0, 1.0]]);
    let rank = math::chol_factor(&mut mat, 1e-15).unwrap();
    let mut vec = [1.0, 1.0];
    math::chol_solve_in_place(&mat, &mut vec).unwrap();
    if cfg!(engine_since = "4.0.0") {
        assert_eq!((rank, mat[(0, 0)], vec[1]), (1, f64::sqrt(1e-15), 1.0));
    } else {
        assert!(rank == 2 && vec[0].is_nan());
    }
}
