//! Mathematical functions, with matching and mismatched sizes.

use std::hint::black_box;

use mujoco_safe::enums::GeomType;
use mujoco_safe::math::{self, BandShape, BoxQp, Pose};
use mujoco_safe::{Matrix, MatrixView, Result};

use super::{Bytes, Call};

/// Returns a small size.
fn size(bytes: &mut Bytes<'_>) -> usize {
    bytes.below(7)
}

/// Returns a matrix, mostly of the given shape, sometimes with many rows or columns and no numbers.
fn matrix(bytes: &mut Bytes<'_>, nrows: usize, ncols: usize) -> Matrix {
    match bytes.below(64) {
        63 => Matrix::zeros(1 << 33, 0),
        62 => Matrix::zeros(0, usize::MAX),
        61 => Matrix::zeros(nrows + 1, ncols),
        60 => Matrix::zeros(nrows, ncols + 1),
        _ => {
            let mut values = vec![bytes.number(); nrows * ncols];
            for _ in 0..bytes.below(3) {
                let (at, value) = (bytes.below(values.len()), bytes.number());
                values.iter_mut().skip(at).take(1).for_each(|number| *number = value);
            }
            // The diagonal is mostly positive.
            if bytes.once_in(2) {
                values.iter_mut().step_by(ncols + 1).for_each(|number| *number = 10.0);
            }
            Matrix::from_row_major(nrows, ncols, values)
        }
    }
}

fn pose(bytes: &mut Bytes<'_>) -> Pose {
    let mut pose = Pose::default();
    (pose.pos, pose.quat) = (bytes.numbers(), bytes.numbers());
    pose
}

/// Returns a shape and its numbers.
fn band(bytes: &mut Bytes<'_>) -> Result<(BandShape, Vec<f64>)> {
    let shape = if bytes.once_in(16) {
        BandShape::new(bytes.word() as usize, size(bytes), bytes.word() as usize)?
    } else {
        BandShape::new(size(bytes), size(bytes), bytes.below(4))?
    };
    if shape.len() > 1000 {
        black_box((shape.ntotal(), shape.is_empty(), shape.band_diag(shape.ntotal() - 1)));
        return Ok((shape, vec![]));
    }
    let mut values = bytes.vector(shape.len());
    if bytes.once_in(2) {
        for row in 0..shape.ntotal() {
            values.iter_mut().skip(shape.band_diag(row)).take(1).for_each(|number| *number = 10.0);
        }
    }
    Ok((shape, values))
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("vectors", |_, bytes| {
        let n = size(bytes);
        let (mut res, one, other, number) = (bytes.vector(n), bytes.vector(n), bytes.vector(n), bytes.number());
        black_box((math::sum(&one), math::l1(&one), math::norm(&one), math::is_zero(&one), math::is_bad(number)));
        black_box((
            math::normalize(&mut res),
            math::spring_damper(number, 1.0, number, 2.0, 0.1),
            math::sigmoid(number),
        ));
        match bytes.below(14) {
            0 => math::copy(&mut res, &one)?,
            1 => math::scl(&mut res, &one, number)?,
            2 => math::add(&mut res, &one, &other)?,
            3 => math::sub(&mut res, &one, &other)?,
            4 => math::add_to(&mut res, &one)?,
            5 => math::sub_from(&mut res, &one)?,
            6 => math::add_to_scl(&mut res, &one, number)?,
            7 => math::add_scl(&mut res, &one, &other, number)?,
            8 => math::insertion_sort(&mut res)?,
            9 => math::insertion_sort_int(&mut vec![bytes.integer(), 0, bytes.integer()][..n.min(3)])?,
            10 => math::scl_in_place(&mut res, number),
            11 => math::fill(&mut res, number),
            12 => {
                let mut single = vec![number as f32; n];
                math::n2f(&mut single, &one)?;
                math::f2n(&mut res, &single)?;
            }
            _ => math::zero(&mut res),
        }
        black_box(math::halton(bytes.word() as u32, bytes.integer() as u32)?);
        math::dot(&res, &one).map(drop)
    }),
    ("matrices and vectors", |_, bytes| {
        let (nrows, ncols) = (size(bytes), size(bytes));
        let mat = matrix(bytes, nrows, ncols);
        let (mut res, vec) = (bytes.vector(nrows), bytes.vector(ncols));
        math::mul_mat_vec(&mut res, &mat, &vec)?;
        if nrows == ncols {
            black_box(math::mul_vec_mat_vec(&res, &mat, &vec)?);
        }
        math::mul_mat_t_vec(&mut bytes.vector(ncols), &mat, &res)
    }),
    ("products of matrices", |_, bytes| {
        let (n, m, k) = (size(bytes), size(bytes), size(bytes));
        match bytes.below(4) {
            0 => math::mul_mat_mat(&mut matrix(bytes, n, k), &matrix(bytes, n, m), &matrix(bytes, m, k)),
            1 => math::mul_mat_mat_t(&mut matrix(bytes, n, k), &matrix(bytes, n, m), &matrix(bytes, k, m)),
            2 => math::mul_mat_t_mat(&mut matrix(bytes, m, k), &matrix(bytes, n, m), &matrix(bytes, n, k)),
            _ => {
                let diag = bytes.vector(n);
                let diag = bytes.once_in(2).then_some(&diag[..]);
                math::sqr_mat_td(&mut matrix(bytes, m, m), &matrix(bytes, n, m), diag)
            }
        }
    }),
    ("one matrix", |_, bytes| {
        let (n, m) = (size(bytes), size(bytes));
        let mut square = matrix(bytes, n, n);
        black_box(format!("{:?}", square.shape()));
        match bytes.below(4) {
            0 => math::transpose(&mut matrix(bytes, m, n), &matrix(bytes, n, m)),
            1 => math::symmetrize(&mut square, &matrix(bytes, n, n)),
            2 => math::symmetrize_in_place(&mut square),
            _ => math::eye(&mut square),
        }
    }),
    ("chol", |_, bytes| {
        let n = size(bytes);
        let mut mat = matrix(bytes, n, n);
        if bytes.once_in(2) {
            math::symmetrize_in_place(&mut mat)?;
        }
        black_box(math::chol_factor(&mut mat, bytes.number())?);
        let (mut res, vec) = (bytes.vector(n), bytes.vector(n));
        math::chol_solve(&mut res, &mat, &vec)?;
        math::chol_solve_in_place(&mat, &mut res)?;
        let update = bytes.either(math::RankOneUpdate::Add, math::RankOneUpdate::Subtract);
        math::chol_update(&mut mat, &mut bytes.vector(n), update).map(drop)
    }),
    ("band", |_, bytes| {
        let (shape, mut mat) = band(bytes)?;
        if shape.ntotal() > 1000 {
            return math::chol_factor_band(&mut mat, shape, 0.0, 0.0).map(drop);
        }
        let n = shape.ntotal();
        let mut dense = matrix(bytes, n, n);
        let kind = bytes.either(math::BandKind::Symmetric, math::BandKind::LowerTriangular);
        math::band2dense(&mut dense, &mat, shape, kind)?;
        math::dense2band(&mut mat, &dense, shape)?;
        let times = bytes.below(3);
        math::band_mul_mat_vec(&mut matrix(bytes, times, n), &mat, &matrix(bytes, times, n), shape, kind)?;
        black_box(math::chol_factor_band(&mut mat, shape, bytes.number(), bytes.number())?);
        let (mut res, vec) = (bytes.vector(n), bytes.vector(n));
        math::chol_solve_band(&mut res, &mat, &vec, shape)?;
        math::chol_solve_band_in_place(&mat, &mut res, shape)
    }),
    ("BoxQp", |_, bytes| {
        let n = size(bytes);
        let mut solver = BoxQp::new(n);
        for _ in 0..=bytes.below(2) {
            let mut h = matrix(bytes, n, n);
            if bytes.once_in(2) {
                math::symmetrize_in_place(&mut h)?;
            }
            let (mut x, g, lower, upper) = (bytes.vector(n), bytes.vector(n), bytes.vector(n), bytes.vector(n));
            let (lower, upper) = (bytes.once_in(2).then_some(&lower[..]), bytes.once_in(2).then_some(&upper[..]));
            let solution = solver.solve(&mut x, &h, &g, lower, upper)?;
            black_box((solution.status, solution.iterations, solution.index.len(), solution.factor.shape()));
        }
        Ok(())
    }),
    ("quaternions and poses", |_, bytes| {
        let (mut one, other, vec, number) = (bytes.numbers(), bytes.numbers(), bytes.numbers(), bytes.number());
        let mat = bytes.numbers();
        black_box((math::rot_vec_quat(&vec, &one), math::neg_quat(&one), math::mul_quat(&one, &other)));
        black_box((math::mul_quat_axis(&one, &vec), math::axis_angle2quat(&vec, number), math::quat2vel(&one, number)));
        black_box((math::sub_quat(&one, &other), math::quat2mat(&one), math::mat2quat(&mat)));
        black_box((math::deriv_quat(&one, &vec), math::quat_z2vec(&vec)));
        black_box((math::sub_quat_derivative(&one, &other), math::quat_integrate_derivative(&vec, number)));
        math::quat_integrate(&mut one, &vec, number);
        black_box(math::normalize4(&mut one));
        let (pose1, pose2) = (pose(bytes), pose(bytes));
        black_box((math::mul_pose(&pose1, &pose2), math::neg_pose(&pose1), math::trn_vec_pose(&pose1, &vec)));
        math::euler2quat(&vec, bytes.choose(&["xyz", "XYZ", "xyx", "", "xy", "xyzx", "XyZ", "äöü", "abc"])).map(drop)
    }),
    ("spatial vectors, muscles", |_, bytes| {
        let (mat, vec, other): ([f64; 9], _, _) = (bytes.numbers(), bytes.numbers(), bytes.numbers());
        black_box((math::cross(&vec, &other), math::rot_vec_mat(&vec, &mat), math::rot_vec_mat_t(&vec, &mat)));
        black_box(math::eig3(&mat));
        let rotation = bytes.once_in(2).then_some(&mat);
        black_box(math::transform_spatial(
            &bytes.numbers(),
            bytes.either(math::SpatialKind::Force, math::SpatialKind::Motion),
            &vec,
            &other,
            rotation,
        ));
        let (range, number) = (bytes.numbers(), bytes.number());
        black_box(math::muscle_gain(number, bytes.number(), &range, bytes.number(), &mat));
        black_box(math::muscle_bias(number, &range, bytes.number(), &mat));
        black_box(math::muscle_dynamics(number, bytes.number(), &range));
        Ok(())
    }),
    ("pyramids", |_, bytes| {
        let mu = bytes.below(8);
        let rows = mu.saturating_sub(bytes.below(2));
        let (mut pyramid, mut force, mu) = (bytes.vector(2 * rows), bytes.vector(rows + 1), bytes.vector(mu));
        math::encode_pyramid(&mut pyramid, &force, &mu)?;
        math::decode_pyramid(&mut force, &pyramid, &mu)
    }),
    ("ray_geom, ray_skin", |_, bytes| {
        const TYPES: [GeomType; 8] = [
            GeomType::Plane,
            GeomType::HeightField,
            GeomType::Sphere,
            GeomType::Capsule,
            GeomType::Ellipsoid,
            GeomType::Cylinder,
            GeomType::Box,
            GeomType::Mesh,
        ];
        let geom_type = TYPES[bytes.below(TYPES.len())];
        let (pnt, vec): ([f64; 3], [f64; 3]) = (bytes.numbers(), [bytes.fraction(), bytes.number(), 1.0]);
        let hit = math::ray_geom(&bytes.numbers(), &bytes.numbers(), &bytes.numbers(), &pnt, &vec, geom_type);
        let vert: Vec<[f32; 3]> = (0..size(bytes)).map(|_| bytes.numbers().map(|number: f64| number as f32)).collect();
        let index =
            |bytes: &mut Bytes<'_>| if bytes.once_in(24) { bytes.integer() } else { bytes.below(vert.len()) as i32 };
        let face: Vec<[i32; 3]> = (0..bytes.below(4)).map(|_| std::array::from_fn(|_| index(bytes))).collect();
        let skin = math::ray_skin(&face, &vert, &pnt, &vec);
        hit.map(drop).and(skin.map(drop))
    }),
    ("views of matrices", |_, bytes| {
        let (nrows, ncols) = (size(bytes), size(bytes));
        let mut mat = matrix(bytes, nrows, ncols);
        if mat.as_slice().is_empty() {
            return Ok(());
        }
        let (at, number) = ((bytes.below(mat.nrows()), bytes.below(mat.ncols())), bytes.number());
        mat[at] = number;
        mat.transposed_mut().fill_diagonal(number);
        let view = MatrixView::from_row_major(mat.ncols(), mat.nrows(), mat.as_slice());
        black_box((view.to_nalgebra(), view.transposed().sum(), view.to_matrix(), format!("{view} {mat:?}")));
        black_box(Matrix::from_transposed(mat.clone().into_transposed()).row(at.0).len());
        Ok(())
    }),
];
