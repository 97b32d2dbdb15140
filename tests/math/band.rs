//! Band matrices against dense matrices.

use mujoco_safe::math::{self, BandShape};
use mujoco_safe::{Error, Matrix};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::Rng;

use crate::cholesky::definite;
use crate::{assert_near, numbers, random};

const SHAPES: [(usize, usize, usize); 9] =
    [(1, 1, 0), (5, 1, 0), (6, 2, 0), (6, 3, 1), (7, 3, 7), (8, 4, 3), (4, 9, 1), (0, 0, 0), (9, 2, 2)];

/// Returns a positive definite matrix that is zero outside of the band.
fn banded(random: &mut impl Rng, shape: BandShape) -> DMatrix<f64> {
    let n = shape.ntotal();
    let mut full = definite(random, n) + DMatrix::from_diagonal_element(n, n, 3.0 * n as f64);
    for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
        if i < n - shape.ndense() && i - j >= shape.nband() {
            full[(i, j)] = 0.0;
            full[(j, i)] = 0.0;
        }
    }
    full
}

fn band_of(full: &DMatrix<f64>, shape: BandShape) -> Vec<f64> {
    // NaN in the unused elements must not affect the results.
    let mut band = vec![f64::NAN; shape.len()];
    math::dense2band(&mut band, &Matrix::from(full), shape).unwrap();
    band
}

fn subjects() -> impl Iterator<Item = (BandShape, DMatrix<f64>)> {
    let mut random = random(30);
    SHAPES.into_iter().map(move |(ntotal, nband, ndense)| {
        let shape = BandShape::new(ntotal, nband, ndense).unwrap();
        let full = banded(&mut random, shape);
        (shape, full)
    })
}

#[test]
fn conversions_between_band_and_dense_round_trip() {
    for (shape, full) in subjects() {
        let n = shape.ntotal();
        let band = band_of(&full, shape);
        assert_eq!(band.len(), (n - shape.ndense()) * shape.nband() + shape.ndense() * n);
        let mut dense = Matrix::from_row_major(n, n, vec![9.0; n * n]);
        math::band2dense(&mut dense, &band, shape, math::BandKind::Symmetric).unwrap();
        assert_eq!(dense, Matrix::from(&full));
        math::band2dense(&mut dense, &band, shape, math::BandKind::LowerTriangular).unwrap();
        assert_eq!(dense, Matrix::from(&full.lower_triangle()));
        for i in 0..n {
            assert_eq!(band[shape.band_diag(i)], full[(i, i)], "{shape:?}, row {i}");
        }
    }
}

#[test]
fn products_equal_dense_products() {
    let mut random = random(31);
    for (shape, full) in subjects() {
        let band = band_of(&full, shape);
        for nvec in [0, 1, 3] {
            let vec = Matrix::from_row_major(nvec, shape.ntotal(), numbers(&mut random, nvec * shape.ntotal()));
            let mut res = Matrix::zeros(nvec, shape.ntotal());
            for (kind, mat) in
                [(math::BandKind::Symmetric, full.clone()), (math::BandKind::LowerTriangular, full.lower_triangle())]
            {
                math::band_mul_mat_vec(&mut res, &band, &vec, shape, kind).unwrap();
                let expected = Matrix::from(&(vec.to_nalgebra() * mat.transpose()));
                assert_near(res.as_slice(), expected.as_slice(), 1e-11);
            }
        }
    }
}

#[test]
fn factors_and_solutions_equal_dense_ones() {
    let mut random = random(32);
    for (shape, full) in subjects() {
        let n = shape.ntotal();
        let (diagadd, diagmul) = (0.25, 0.5);
        let sum =
            &full + DMatrix::from_diagonal_element(n, n, diagadd) + diagmul * DMatrix::from_diagonal(&full.diagonal());
        let cholesky = sum.cholesky().unwrap();
        let mut band = band_of(&full, shape);
        let smallest = math::chol_factor_band(&mut band, shape, diagadd, diagmul).unwrap().unwrap();
        let expected = cholesky.l().diagonal().iter().map(|value| value * value).fold(f64::INFINITY, f64::min);
        assert!(smallest == expected || (smallest - expected).abs() < 1e-10 * expected, "{smallest}, {expected}");
        let mut factor = Matrix::zeros(n, n);
        math::band2dense(&mut factor, &band, shape, math::BandKind::LowerTriangular).unwrap();
        assert_near(factor.as_slice(), Matrix::from(&cholesky.l()).as_slice(), 1e-11);
        let vec = numbers(&mut random, n);
        let mut res = vec![9.0; n];
        math::chol_solve_band(&mut res, &band, &vec, shape).unwrap();
        assert_near(&res, cholesky.solve(&DVector::from_vec(vec.clone())).as_slice(), 1e-11);
        let mut in_place = vec;
        math::chol_solve_band_in_place(&band, &mut in_place, shape).unwrap();
        assert_eq!(in_place, res);
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_has_no_factor() {
    let shape = BandShape::new(2, 2, 0).unwrap();
    for corner in [1.0, 0.5, f64::NAN] {
        assert_eq!(math::chol_factor_band(&mut [0.0, 1.0, 1.0, corner], shape, 0.0, 0.0).unwrap(), None);
    }
    assert!(math::chol_factor_band(&mut [0.0, 1.0, 1.0, 1.0], shape, 0.5, 0.0).unwrap().is_some());
}

#[test]
fn invalid_shapes_are_rejected() {
    for (ntotal, nband, ndense) in [(3, 2, 4), (3, 0, 2), (usize::MAX, 2, 0), (usize::MAX, 1, 1)] {
        let error = BandShape::new(ntotal, nband, ndense).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
    BandShape::new(3, 0, 3).unwrap();
}

#[test]
#[should_panic(expected = "row 3 of a band matrix of 3 rows")]
fn the_diagonal_of_a_row_out_of_range_panics() {
    BandShape::new(3, 2, 1).unwrap().band_diag(3);
}

proptest! {
    #[test]
    fn solutions_satisfy_the_equation_for_any_shape(ntotal in 0_usize..12, nband in 1_usize..14, ndense in 0_usize..12, seed: u64) {
        let shape = BandShape::new(ntotal, nband, ndense.min(ntotal)).unwrap();
        let mut random = random(seed);
        let full = banded(&mut random, shape);
        let mut band = band_of(&full, shape);
        math::chol_factor_band(&mut band, shape, 0.0, 0.0).unwrap().unwrap();
        let vec = numbers(&mut random, ntotal);
        let mut res = vec![0.0; ntotal];
        math::chol_solve_band(&mut res, &band, &vec, shape).unwrap();
        assert_near((full * DVector::from_vec(res)).as_slice(), &vec, 1e-11);
    }
}

#[test]
fn the_index_of_a_diagonal_value_does_not_overflow() {
    let largest = BandShape::new(usize::MAX, 1, 0).unwrap();
    assert_eq!(largest.band_diag(usize::MAX - 1), usize::MAX - 1);
}
