//! Row-major matrices against nalgebra, and matrices without rows or columns.
//!
//! Properties that hold for all inputs are tested on random ones. Numbers are compared by their
//! bits: -0, subnormal numbers, infinities and NaN included.

use mujoco_safe::{Data, Error, Matrix, MatrixView, MatrixViewMut};
use nalgebra::DMatrix;
use proptest::prelude::*;

use crate::arbitrary::{HUMANOID, any_number, bits};

/// Shapes from zero to six rows and columns, with their numbers.
fn any_matrix() -> impl Strategy<Value = (usize, usize, Vec<f64>)> {
    (0..7_usize, 0..7_usize).prop_flat_map(|(rows, columns)| {
        (Just(rows), Just(columns), prop::collection::vec(any_number(), rows * columns))
    })
}

proptest! {
    #[test]
    fn a_matrix_stores_its_values_row_by_row((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values.clone());
        prop_assert_eq!(matrix.shape(), (rows, columns));
        prop_assert_eq!(bits(matrix.as_slice()), bits(&values));
        for row in 0..rows {
            prop_assert_eq!(bits(matrix.row(row)), bits(&values[row * columns..(row + 1) * columns]));
            for column in 0..columns {
                prop_assert_eq!(matrix[(row, column)].to_bits(), values[row * columns + column].to_bits());
                prop_assert_eq!(matrix.view()[(row, column)].to_bits(), values[row * columns + column].to_bits());
            }
        }
    }

    #[test]
    fn nalgebra_views_have_each_value_in_its_place((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values);
        let (copy, transposed) = (matrix.to_nalgebra(), matrix.transposed());
        prop_assert_eq!((copy.shape(), transposed.shape()), ((rows, columns), (columns, rows)));
        for row in 0..rows {
            for column in 0..columns {
                prop_assert_eq!(copy[(row, column)].to_bits(), matrix[(row, column)].to_bits());
                prop_assert_eq!(transposed[(column, row)].to_bits(), matrix[(row, column)].to_bits());
            }
        }
    }

    #[test]
    fn conversion_to_nalgebra_and_back_keeps_the_matrix((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values.clone());
        prop_assert_eq!(bits(Matrix::from(&matrix.to_nalgebra()).as_slice()), bits(&values));
        prop_assert_eq!(Matrix::from(&matrix.to_nalgebra()).shape(), (rows, columns));
        prop_assert_eq!(bits(matrix.view().to_matrix().as_slice()), bits(&values));
        let again = Matrix::from_transposed(matrix.into_transposed());
        prop_assert_eq!((again.shape(), bits(again.as_slice())), ((rows, columns), bits(&values)));
    }

    #[test]
    fn writing_through_the_transpose_writes_to_the_matrix((rows, columns, values) in any_matrix()) {
        let mut matrix = Matrix::zeros(rows, columns);
        matrix.transposed_mut().copy_from(&DMatrix::from_column_slice(columns, rows, &values));
        prop_assert_eq!(bits(matrix.as_slice()), bits(&values));
    }

    #[test]
    fn ndarray_views_are_the_memory_of_the_matrix((rows, columns, values) in any_matrix()) {
        let mut matrix = Matrix::from_row_major(rows, columns, values.clone());
        let view = matrix.as_ndarray();
        prop_assert_eq!((view.dim(), view.is_standard_layout()), ((rows, columns), true));
        prop_assert!(values.is_empty() || view.as_ptr() == matrix.as_slice().as_ptr());
        for ((row, column), value) in view.indexed_iter() {
            prop_assert_eq!(value.to_bits(), matrix[(row, column)].to_bits());
        }
        matrix.as_ndarray_mut().fill(0.5);
        prop_assert!(matrix.as_slice().iter().all(|value| *value == 0.5));
        let mut copy = vec![0.0; values.len()];
        MatrixViewMut::from_row_major(rows, columns, &mut copy).as_ndarray_mut().assign(&matrix.as_ndarray());
        prop_assert_eq!(copy, matrix.as_slice());
    }

    #[test]
    fn single_precision_has_the_nearest_values((rows, columns, values) in any_matrix()) {
        let matrix = Matrix::from_row_major(rows, columns, values.clone());
        let mut rounded = vec![f32::MAX; values.len()];
        matrix.view().to_f32_into(&mut rounded);
        for (rounded, value) in rounded.iter().zip(&values) {
            let error = (f64::from(*rounded) - value).abs();
            if value.is_nan() {
                prop_assert!(rounded.is_nan());
            } else if value.abs() > f64::from(f32::MAX) {
                prop_assert!(rounded.abs() >= f32::MAX && rounded.is_sign_negative() == value.is_sign_negative());
            } else {
                // The distance to neither neighbour is less.
                prop_assert!([rounded.next_down(), rounded.next_up()].iter().all(|next| {
                    (f64::from(*next) - value).abs() >= error
                }), "{value} became {rounded}");
            }
        }
    }

    #[test]
    fn the_transposed_view_multiplies_like_the_matrix(
        (rows, columns, values) in any_matrix(),
        vector in prop::collection::vec(-1e3..1e3_f64, 7),
    ) {
        // Moderate numbers, so that the order of summation does not matter.
        let values: Vec<f64> = values.iter().map(|value| if value.abs() < 1e3 { *value } else { 1.0 }).collect();
        let matrix = Matrix::from_row_major(rows, columns, values);
        let vector = nalgebra::DVector::from_column_slice(&vector[..columns]);
        let product = matrix.transposed().tr_mul(&vector);
        prop_assert_eq!(product.len(), rows);
        for row in 0..rows {
            let expected: f64 = matrix.row(row).iter().zip(vector.iter()).map(|(a, b)| a * b).sum();
            prop_assert!((product[row] - expected).abs() <= 1e-6, "{} and {}", product[row], expected);
        }
    }
}

#[test]
#[should_panic(expected = "needs 6 values, not 5")]
fn values_that_do_not_match_the_shape_panic() {
    let _ = Matrix::from_row_major(2, 3, vec![0.0; 5]);
}

#[test]
#[should_panic(expected = "needs 6 values, not 7")]
fn single_precision_needs_as_many_values() {
    Matrix::zeros(2, 3).view().to_f32_into(&mut [0.0; 7]);
}

#[test]
#[should_panic(expected = "more than isize::MAX rows")]
fn ndarray_has_no_longer_arrays() {
    MatrixView::from_row_major(usize::MAX, 0, &[]).as_ndarray();
}

#[test]
#[should_panic(expected = "row 2 of a matrix with 2 rows")]
fn a_row_out_of_range_panics() {
    let _ = Matrix::zeros(2, 3).row(2);
}

#[test]
#[should_panic(expected = "row 0 of a matrix with 0 rows")]
fn a_matrix_without_rows_has_no_row_0() {
    let _ = Matrix::zeros(0, 3).row(0);
}

#[test]
#[should_panic(expected = "index out of bounds")]
fn a_column_out_of_range_panics() {
    let _ = Matrix::zeros(2, 3)[(0, 3)];
}

#[test]
fn a_matrix_without_columns_has_empty_rows() {
    let matrix = Matrix::zeros(3, 0);
    assert_eq!((matrix.row(2), matrix.as_slice(), matrix.shape()), (&[][..], &[][..], (3, 0)));
    assert_eq!(matrix.transposed().shape(), (0, 3));
    assert_eq!(matrix.to_nalgebra().shape(), (3, 0));
    assert_eq!(Matrix::from_rows::<0>(&[[], []]).shape(), (2, 0));
    assert_eq!(Matrix::default().shape(), (0, 0));
}

#[test]
fn a_matrix_is_printed_row_by_row() {
    let matrix = Matrix::from_rows(&[[1.0, 2.5], [-3.0, 0.0]]);
    assert_eq!(format!("{matrix:?}"), "[[1.0, 2.5], [-3.0, 0.0]]");
    assert_eq!(format!("{:?}", matrix.view()), "[[1.0, 2.5], [-3.0, 0.0]]");
    assert_eq!(format!("{:?}", Matrix::zeros(0, 2)), "[]");
}

#[test]
fn matrices_of_a_wrong_shape_are_not_written_to() {
    let mut data = Data::new(HUMANOID.clone()).unwrap();
    data.forward().unwrap();
    let torso = data.model().body("torso").unwrap().id();
    let nv = data.model().nv();
    for (rows, columns) in [(nv, 3), (3, nv - 1), (3, nv + 1), (2, nv), (1, 3 * nv), (0, 0)] {
        let mut wrong = Matrix::zeros(rows, columns);
        for result in [
            data.jac_body_into(torso, Some(&mut wrong), None),
            data.jac_body_into(torso, None, Some(&mut wrong)),
            data.jac_subtree_com_into(torso, &mut wrong),
        ] {
            let error = result.unwrap_err();
            assert!(
                matches!(error, Error::Shape { expected, found, .. } if expected == (3, nv) && found == (rows, columns)),
                "{error}"
            );
        }
        assert!(wrong.as_slice().iter().all(|value| *value == 0.0));
    }
    assert!(matches!(data.full_m_into(&mut Matrix::zeros(nv, nv + 1)), Err(Error::Shape { .. })));
}
