//! Quaternions, poses, spatial vectors and eigenvalues against the engine, nalgebra and SciPy.

use mujoco_safe::Error;
use mujoco_safe::math::{self, Pose};
use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::{array, assert_near, assert_same, c, random, unit};

fn nalgebras(quat: &[f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(quat[0], quat[1], quat[2], quat[3]))
}

fn numbers(quat: &UnitQuaternion<f64>) -> [f64; 4] {
    [quat.w, quat.i, quat.j, quat.k]
}

#[test]
fn quaternions_equal_nalgebra() {
    let mut random = random(50);
    for _ in 0..100 {
        let (p, q) = (unit(&mut random), unit(&mut random));
        let (x, y) = (nalgebras(&p), nalgebras(&q));
        let vec: [f64; 3] = array(&mut random);
        let vector = Vector3::from(vec);
        assert_near(&math::rot_vec_quat(&vec, &p), (x * vector).as_slice(), 1e-14);
        assert_near(&math::mul_quat(&p, &q), &numbers(&(x * y)), 1e-14);
        assert_near(&math::neg_quat(&p), &numbers(&x.inverse()), 1e-15);
        assert_near(&math::mul_quat_axis(&p, &vec), &math::mul_quat(&p, &[0.0, vec[0], vec[1], vec[2]]), 1e-15);
        let matrix = x.to_rotation_matrix().matrix().transpose();
        assert_near(&math::quat2mat(&p), matrix.as_slice(), 1e-14);
        let back = math::mat2quat(&math::quat2mat(&p));
        assert_near(&back.map(|value| value * back[0].signum()), &p.map(|value| value * p[0].signum()), 1e-14);
        // The rotation vector from q to p in the frame of q.
        let rotation = (y.inverse() * x).scaled_axis();
        assert_near(&math::sub_quat(&p, &q), rotation.as_slice(), 1e-13);
        assert_near(&math::quat2vel(&p, 0.5), (2.0 * x.scaled_axis()).as_slice(), 1e-13);
        let mut turned = q;
        math::quat_integrate(&mut turned, &vec, 0.7);
        assert_near(&turned, &numbers(&(y * UnitQuaternion::from_scaled_axis(0.7 * vector))), 1e-14);
        // The derivative belongs to a rotation in the world frame.
        let eps = 1e-6;
        let later = UnitQuaternion::from_scaled_axis(eps * vector) * y;
        let difference = [0, 1, 2, 3].map(|at| (numbers(&later)[at] - q[at]) / eps);
        assert_near(&math::deriv_quat(&q, &vec), &difference, 1e-5);
        let direction = math::rot_vec_quat(&[0.0, 0.0, 1.0], &math::quat_z2vec(&vec));
        assert_near(&direction, vector.normalize().as_slice(), 1e-14);
        let axis = vector.normalize();
        let expected = UnitQuaternion::from_axis_angle(&nalgebra::Unit::new_unchecked(axis), 1.3);
        assert_near(&math::axis_angle2quat(&axis.into(), 1.3), &numbers(&expected), 1e-15);
    }
}

#[test]
fn quaternions_equal_c() {
    let mut random = random(51);
    let (p, q, vec): (_, _, [f64; 3]) = (unit(&mut random), unit(&mut random), array(&mut random));
    let mut theirs = [0.0; 9];
    let r = theirs.as_mut_ptr();
    c!(mju_subQuat(r, p.as_ptr(), q.as_ptr()));
    assert_same(&math::sub_quat(&p, &q), &theirs[..3]);
    c!(mju_derivQuat(r, p.as_ptr(), vec.as_ptr()));
    assert_same(&math::deriv_quat(&p, &vec), &theirs[..4]);
    c!(mju_quat2Mat(r, p.as_ptr()));
    assert_same(&math::quat2mat(&p), &theirs);
    let mut ours = [0.0, 2.0, 0.0, 0.0];
    assert_eq!(math::normalize4(&mut ours), 2.0);
    assert_eq!(ours, [0.0, 1.0, 0.0, 0.0]);
    assert_eq!(math::normalize4(&mut [0.0; 4]), 0.0);
    assert_eq!(math::quat_z2vec(&[0.0; 3]), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(math::quat_z2vec(&[0.0, 0.0, -2.0]), [0.0, 1.0, 0.0, 0.0]);
}

#[test]
fn euler_angles_equal_scipy() {
    // scipy 1.15.3, Rotation.from_euler, where capital letters are intrinsic axes.
    let rigid = [
        ("xyz", [0.378_251_062_430_539_1, -0.435_530_330_865_275_3, -0.306_014_489_582_654, 0.757_360_282_053_409_3]),
        ("XYZ", [0.232_649_028_605_833_9, 0.527_858_849_335_889_9, -0.068_531_541_029_943_02, 0.813_967_378_062_913_1]),
        ("zyx", [0.232_649_028_605_833_9, 0.813_967_378_062_913_1, -0.068_531_541_029_943_02, 0.527_858_849_335_889_9]),
        (
            "ZXZ",
            [0.186_708_571_241_831_02, -0.260_074_032_218_651_1, -0.453_391_042_095_830_7, 0.831_828_089_293_468_5],
        ),
        (
            "yxy",
            [0.186_708_571_241_831_02, -0.260_074_032_218_651_1, 0.831_828_089_293_468_5, -0.453_391_042_095_830_7],
        ),
    ];
    for (seq, quat) in rigid {
        let ours = math::euler2quat(&[0.3, -1.1, 2.4], seq).unwrap();
        let sign = (ours[0] * quat[0]).signum();
        assert_near(&ours.map(|value| sign * value), &quat, 1e-15);
    }
    // Intrinsic and extrinsic axes may be mixed: two rotations about z, one of which does not
    // rotate the other's axis.
    let mixed = math::euler2quat(&[0.4, 0.5, 0.0], "zZx").unwrap();
    assert_near(&mixed, &math::axis_angle2quat(&[0.0, 0.0, 1.0], 0.9), 1e-15);
}

#[test]
fn invalid_axis_sequences_are_rejected() {
    for seq in ["", "xy", "xyzx", "xyw", "xy ", "é1", "xy\0"] {
        let error = math::euler2quat(&[0.0; 3], seq).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{seq:?}: {error}");
    }
}

#[test]
fn poses_are_isometries() {
    let mut random = random(52);
    for _ in 0..50 {
        let mut pose = || Pose { pos: array(&mut random), quat: unit(&mut random) };
        let (one, two) = (pose(), pose());
        let isometry = |pose: &Pose| Isometry3::from_parts(Translation3::from(pose.pos), nalgebras(&pose.quat));
        let assert_is = |ours: Pose, theirs: Isometry3<f64>| {
            assert_near(&ours.pos, theirs.translation.vector.as_slice(), 1e-14);
            assert_near(&ours.quat, &numbers(&theirs.rotation), 1e-14);
        };
        assert_is(math::mul_pose(&one, &two), isometry(&one) * isometry(&two));
        assert_is(math::neg_pose(&one), isometry(&one).inverse());
        assert_is(Pose::default(), Isometry3::identity());
        let vec = array(&mut random);
        let expected = isometry(&one) * nalgebra::Point3::from(vec);
        assert_near(&math::trn_vec_pose(&one, &vec), expected.coords.as_slice(), 1e-14);
    }
}

#[test]
fn matrices_rotate_vectors() {
    let mut random = random(53);
    let (a, b): ([f64; 3], [f64; 3]) = (array(&mut random), array(&mut random));
    assert_near(&math::cross(&a, &b), Vector3::from(a).cross(&Vector3::from(b)).as_slice(), 1e-15);
    let mat: [f64; 9] = array(&mut random);
    let matrix = Matrix3::from_row_slice(&mat);
    assert_near(&math::rot_vec_mat(&a, &mat), (matrix * Vector3::from(a)).as_slice(), 1e-15);
    assert_near(&math::rot_vec_mat_t(&a, &mat), matrix.tr_mul(&Vector3::from(a)).as_slice(), 1e-15);
}

#[test]
fn power_does_not_depend_on_the_frame() {
    // A motion and a force, expressed at another point and in other axes, have the same power.
    let mut random = random(54);
    for _ in 0..20 {
        let (motion, force): ([f64; 6], [f64; 6]) = (array(&mut random), array(&mut random));
        let (newpos, oldpos) = (array(&mut random), array(&mut random));
        let rotation = math::quat2mat(&unit(&mut random));
        for rotation in [None, Some(&rotation)] {
            let moved = math::transform_spatial(&motion, math::SpatialKind::Motion, &newpos, &oldpos, rotation);
            let pushed = math::transform_spatial(&force, math::SpatialKind::Force, &newpos, &oldpos, rotation);
            let power = |a: &[f64], b: &[f64]| math::dot(a, b).unwrap();
            assert_near(&[power(&moved, &pushed)], &[power(&motion, &force)], 1e-13);
            assert_near(&[math::norm(&moved[..3])], &[math::norm(&motion[..3])], 1e-14);
        }
    }
}

#[test]
fn eigenvalues_equal_nalgebra() {
    let mut random = random(55);
    for _ in 0..50 {
        let half = Matrix3::from_row_slice(&array::<9>(&mut random));
        let full = half + half.transpose();
        let found = math::eig3(full.as_slice().try_into().unwrap());
        let mut expected: Vec<f64> = full.symmetric_eigenvalues().iter().copied().collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        assert_near(&found.eigval, &expected, 1e-10);
        let vectors = Matrix3::from_row_slice(&found.eigvec);
        let again = vectors * Matrix3::from_diagonal(&found.eigval.into()) * vectors.transpose();
        // The engine stops at rotations smaller than 1.5·10⁻⁶.
        assert_near(again.as_slice(), full.as_slice(), 1e-5);
        assert_near(&[vectors.determinant()], &[1.0], 1e-12);
        assert_same(&math::quat2mat(&found.quat), &found.eigvec);
        assert!(found.iterations < 500);
    }
    assert_eq!(math::eig3(&[f64::NAN; 9]).iterations, 500);
}
