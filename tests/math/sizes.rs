//! Size checks, one wrong size at a time.
#![forbid(unsafe_code)]

use mujoco_safe::math::{self, BandShape, BoxQp};
use mujoco_safe::{Error, Matrix, Result};

/// Asserts that `call(sizes)` succeeds with the given sizes, and is an [`Error::Shape`] if any size
/// is one less or one more.
#[track_caller]
fn checks<const N: usize, T>(right: [usize; N], mut call: impl FnMut([usize; N]) -> Result<T>) {
    call(right).map(drop).unwrap();
    for at in 0..N {
        for wrong in [right[at] + 1, right[at] - 1] {
            let mut sizes = right;
            sizes[at] = wrong;
            let error = call(sizes).map(drop).expect_err(&format!("{sizes:?} instead of {right:?}"));
            assert!(matches!(error, Error::Shape { .. }), "{error}");
        }
    }
}

fn v(length: usize) -> Vec<f64> {
    vec![1.0; length]
}

fn m(nrows: usize, ncols: usize) -> Matrix {
    Matrix::zeros(nrows, ncols)
}

#[test]
fn vector_functions_check_sizes() {
    checks([3, 3], |[a, b]| math::copy(&mut v(a), &v(b)));
    checks([3, 3], |[a, b]| math::f2n(&mut v(a), &vec![0.0; b]));
    checks([3, 3], |[a, b]| math::n2f(&mut vec![0.0; a], &v(b)));
    checks([3, 3], |[a, b]| math::dot(&v(a), &v(b)));
    checks([3, 3], |[a, b]| math::scl(&mut v(a), &v(b), 2.0));
    checks([3, 3, 3], |[a, b, c]| math::add(&mut v(a), &v(b), &v(c)));
    checks([3, 3, 3], |[a, b, c]| math::sub(&mut v(a), &v(b), &v(c)));
    checks([3, 3, 3], |[a, b, c]| math::add_scl(&mut v(a), &v(b), &v(c), 2.0));
    checks([3, 3], |[a, b]| math::add_to(&mut v(a), &v(b)));
    checks([3, 3], |[a, b]| math::sub_from(&mut v(a), &v(b)));
    checks([3, 3], |[a, b]| math::add_to_scl(&mut v(a), &v(b), 2.0));
}

#[test]
fn matrix_functions_check_sizes() {
    checks([2, 2, 3, 3], |[r, mr, mc, c]| math::mul_mat_vec(&mut v(r), &m(mr, mc), &v(c)));
    checks([3, 2, 3, 2], |[r, mr, mc, c]| math::mul_mat_t_vec(&mut v(r), &m(mr, mc), &v(c)));
    checks([3, 3, 3, 3], |[a, mr, mc, b]| math::mul_vec_mat_vec(&v(a), &m(mr, mc), &v(b)));
    checks([3, 2, 2, 3], |[rr, rc, mr, mc]| math::transpose(&mut m(rr, rc), &m(mr, mc)));
    checks([3, 3, 3, 3], |[rr, rc, mr, mc]| math::symmetrize(&mut m(rr, rc), &m(mr, mc)));
    checks([3, 3], |[mr, mc]| math::symmetrize_in_place(&mut m(mr, mc)));
    checks([3, 3], |[mr, mc]| math::eye(&mut m(mr, mc)));
    checks([2, 4, 2, 3, 3, 4], |[a, b, c, d, e, f]| math::mul_mat_mat(&mut m(a, b), &m(c, d), &m(e, f)));
    checks([2, 4, 2, 3, 4, 3], |[a, b, c, d, e, f]| math::mul_mat_mat_t(&mut m(a, b), &m(c, d), &m(e, f)));
    checks([2, 4, 3, 2, 3, 4], |[a, b, c, d, e, f]| math::mul_mat_t_mat(&mut m(a, b), &m(c, d), &m(e, f)));
    checks([3, 3, 2, 3, 2], |[a, b, c, d, e]| math::sqr_mat_td(&mut m(a, b), &m(c, d), Some(&v(e))));
    checks([3, 3, 3], |[a, b, c]| math::sqr_mat_td(&mut m(a, b), &m(2, c), None));
}

#[test]
fn factorisations_check_sizes() {
    checks([3, 3], |[a, b]| math::chol_factor(&mut m(a, b), 1e-15));
    checks([3, 3, 3, 3], |[a, b, c, d]| math::chol_solve(&mut v(a), &m(b, c), &v(d)));
    checks([3, 3, 3], |[a, b, c]| math::chol_solve_in_place(&m(a, b), &mut v(c)));
    checks([3, 3, 3], |[a, b, c]| math::chol_update(&mut m(a, b), &mut v(c), math::RankOneUpdate::Add));
    let shape = BandShape::new(5, 2, 1).unwrap();
    let kept = shape.len();
    assert_eq!(kept, 4 * 2 + 5);
    checks([kept], |[a]| math::chol_factor_band(&mut v(a), shape, 1.0, 0.0));
    checks([5, kept, 5], |[a, b, c]| math::chol_solve_band(&mut v(a), &v(b), &v(c), shape));
    checks([kept, 5], |[a, b]| math::chol_solve_band_in_place(&v(a), &mut v(b), shape));
    checks([5, 5, kept], |[a, b, c]| math::band2dense(&mut m(a, b), &v(c), shape, math::BandKind::Symmetric));
    checks([kept, 5, 5], |[a, b, c]| math::dense2band(&mut v(a), &m(b, c), shape));
    checks([3, 5, kept, 3, 5], |[a, b, c, d, e]| {
        math::band_mul_mat_vec(&mut m(a, b), &v(c), &m(d, e), shape, math::BandKind::Symmetric)
    });
}

#[test]
fn quadratic_programs_check_sizes() {
    checks([2, 2, 2, 2, 2, 2], |[x, hr, hc, g, lower, upper]| {
        let h = Matrix::from(&nalgebra::DMatrix::identity(hr, hc));
        BoxQp::new(2)
            .solve(&mut v(x), &h, &v(g), Some(&vec![0.0; lower]), Some(&v(upper)))
            .map(|solution| solution.status)
    });
}

#[test]
fn pyramids_check_sizes() {
    checks([4, 3, 2], |[pyramid, force, mu]| math::encode_pyramid(&mut v(pyramid), &v(force), &v(mu)));
    checks([3, 4, 2], |[force, pyramid, mu]| math::decode_pyramid(&mut v(force), &v(pyramid), &v(mu)));
    // Without friction the engine reads one number of the pyramid, regardless of its length.
    checks([1, 1], |[pyramid, force]| math::encode_pyramid(&mut v(pyramid), &v(force), &[]));
    checks([1, 1], |[force, pyramid]| math::decode_pyramid(&mut v(force), &v(pyramid), &[]));
}

#[test]
fn sizes_beyond_a_c_int_are_errors() {
    // Matrices without numbers may have more rows than a C int holds.
    let (rows, columns) = (m(1 << 40, 0), m(0, 1 << 40));
    for result in [
        math::mul_mat_mat(&mut m(0, 0), &columns, &rows),
        math::mul_mat_t_mat(&mut m(0, 0), &rows, &rows),
        math::mul_mat_mat_t(&mut m(0, 0), &columns, &columns),
        math::transpose(&mut m(0, 1 << 40), &rows),
        math::sqr_mat_td(&mut m(0, 0), &rows, None),
    ] {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
    }
}
