//! Dense matrices against nalgebra.

use mujoco_safe::{Data, Matrix, MatrixView, MatrixViewMut, math, sample};

use crate::{assert_near, assert_same, c, numbers, random};

const SHAPES: [(usize, usize, usize); 6] = [(1, 1, 1), (3, 4, 5), (7, 2, 6), (5, 0, 3), (0, 4, 2), (9, 9, 9)];

fn matrix(random: &mut impl rand::Rng, nrows: usize, ncols: usize) -> Matrix {
    Matrix::from_row_major(nrows, ncols, numbers(random, nrows * ncols))
}

#[track_caller]
fn assert_is(ours: &Matrix, theirs: &nalgebra::DMatrix<f64>) {
    assert_eq!(ours.shape(), theirs.shape());
    assert_near(ours.as_slice(), Matrix::from(theirs).as_slice(), 1e-13);
}

#[test]
fn products_equal_nalgebra() {
    let mut random = random(10);
    for (r, k, s) in SHAPES {
        let (a, b) = (matrix(&mut random, r, k), matrix(&mut random, k, s));
        let (x, y) = (a.to_nalgebra(), b.to_nalgebra());
        let mut res = matrix(&mut random, r, s);
        math::mul_mat_mat(&mut res, &a, &b).unwrap();
        assert_is(&res, &(&x * &y));

        let b_transposed = Matrix::from(&y.transpose());
        math::mul_mat_mat_t(&mut res, &a, &b_transposed).unwrap();
        assert_is(&res, &(&x * &y));

        let a_transposed = Matrix::from(&x.transpose());
        math::mul_mat_t_mat(&mut res, &a_transposed, &b).unwrap();
        assert_is(&res, &(&x * &y));

        let mut turned = Matrix::zeros(k, r);
        math::transpose(&mut turned, &a).unwrap();
        assert_eq!(turned, a_transposed);

        let (vec, left) = (numbers(&mut random, k), numbers(&mut random, r));
        let mut product = vec![9.0; r];
        math::mul_mat_vec(&mut product, &a, &vec).unwrap();
        assert_near(&product, (&x * nalgebra::DVector::from_vec(vec)).as_slice(), 1e-13);
        let mut product = vec![9.0; k];
        math::mul_mat_t_vec(&mut product, &a, &left).unwrap();
        assert_near(&product, x.tr_mul(&nalgebra::DVector::from_vec(left)).as_slice(), 1e-13);

        let diag = numbers(&mut random, r);
        let mut square = matrix(&mut random, k, k);
        math::sqr_mat_td(&mut square, &a, Some(&diag)).unwrap();
        let scaled = nalgebra::DMatrix::from_diagonal(&nalgebra::DVector::from_vec(diag)) * &x;
        assert_is(&square, &x.tr_mul(&scaled));
        math::sqr_mat_td(&mut square, &a, None).unwrap();
        assert_is(&square, &x.tr_mul(&x));
        let mut turned = Matrix::zeros(k, k);
        math::transpose(&mut turned, &square).unwrap();
        assert_same(turned.as_slice(), square.as_slice());
    }
}

#[test]
fn products_equal_c() {
    let mut random = random(11);
    let (a, b) = (matrix(&mut random, 6, 7), matrix(&mut random, 7, 5));
    let (mut ours, mut theirs) = (Matrix::zeros(6, 5), [0.0; 30]);
    math::mul_mat_mat(&mut ours, &a, &b).unwrap();
    c!(mju_mulMatMat(theirs.as_mut_ptr(), a.as_slice().as_ptr(), b.as_slice().as_ptr(), 6, 7, 5));
    assert_same(ours.as_slice(), &theirs);
}

#[test]
fn a_bilinear_form_equals_the_product() {
    let mut random = random(12);
    for n in [0, 1, 4, 9] {
        let mat = matrix(&mut random, n, n);
        let (u, v) = (numbers(&mut random, n), numbers(&mut random, n));
        let expected =
            nalgebra::RowDVector::from_vec(u.clone()) * mat.to_nalgebra() * nalgebra::DVector::from_vec(v.clone());
        assert_near(&[math::mul_vec_mat_vec(&u, &mat, &v).unwrap()], expected.as_slice(), 1e-13);
    }
}

#[test]
fn symmetric_parts_and_identities_equal_nalgebra() {
    let mut random = random(13);
    for n in [0, 1, 2, 7] {
        let mat = matrix(&mut random, n, n);
        let mut res = matrix(&mut random, n, n);
        math::symmetrize(&mut res, &mat).unwrap();
        let full = mat.to_nalgebra();
        assert_is(&res, &(0.5 * (&full + full.transpose())));
        let mut in_place = mat.clone();
        math::symmetrize_in_place(&mut in_place).unwrap();
        assert_eq!(in_place, res);
        math::eye(&mut res).unwrap();
        assert_is(&res, &nalgebra::DMatrix::identity(n, n));
    }
}

#[test]
fn arrays_of_the_engine_are_usable_as_matrices() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.qvel_mut()[5] = 0.7;
    data.forward().unwrap();
    // The spatial velocity of the last body is the combination of the velocities of its degrees of
    // freedom along their axes.
    let mut all = [0.0; 6];
    let root = &data.cdof()[..6];
    math::mul_mat_t_vec(&mut all, root, &data.qvel()[..6]).unwrap();
    assert_near(&all, &data.cvel()[1], 1e-12);
}

#[test]
fn views_of_slices_and_arrays_are_readable_and_writable() {
    let mut values = [0.0; 6];
    let view = MatrixView::from_row_major(2, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let mut target = MatrixViewMut::from_row_major(3, 2, &mut values);
    math::transpose(&mut target, view).unwrap();
    assert_eq!(target.view().row(0), [1.0, 4.0]);
    let mut square = [[0.0; 3]; 3];
    math::mul_mat_t_mat(&mut square, &[[1.0, 2.0, 3.0]], &[[1.0, 1.0, 1.0]]).unwrap();
    assert_eq!(square, [[1.0; 3], [2.0; 3], [3.0; 3]]);
    math::eye(square.as_mut_slice()).unwrap();
    assert_eq!(square[1], [0.0, 1.0, 0.0]);
}

#[test]
#[should_panic(expected = "row 2 of a matrix with 2 rows")]
fn a_row_beyond_the_last_one_panics() {
    MatrixViewMut::from_row_major(2, 3, &mut [0.0; 6]).row_mut(2).fill(1.0);
}

#[test]
#[should_panic(expected = "index out of bounds")]
fn a_column_beyond_the_last_one_panics() {
    MatrixViewMut::from_row_major(2, 3, &mut [0.0; 6])[(0, 3)] = 1.0;
}

#[test]
#[should_panic(expected = "a matrix of 2 rows and 3 columns needs 6 values, not 5")]
fn a_view_of_too_few_values_panics() {
    MatrixViewMut::from_row_major(2, 3, &mut [0.0; 5]);
}
