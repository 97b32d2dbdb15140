//! Constraints, forces, velocities and accelerations of objects, and square roots of the inertia
//! matrix.

use mujoco_safe::Stage;
use mujoco_safe::data::{Accelerations, Axes, ConeHessian, FrameId, SpatialVector};

use crate::twins::{Twins, assert_same, c, small_subjects, usual_subjects};

/// Calls `mj_solveM2`. Newer engines take the square roots of `qLDiagInv` as an argument instead of
/// `qLDiagSqrtInv`.
fn solve_m2(twins: &Twins, vectors: &[f64], result: &mut [f64], count: i32) {
    let (m, d, (result, vectors)) = (twins.raw.m(), twins.raw.d, (result.as_mut_ptr(), vectors.as_ptr()));
    #[cfg(engine_since = "3.5.0")]
    {
        let roots: Vec<f64> = twins.ours.qLDiagInv().iter().map(|inverse| inverse.sqrt()).collect();
        c!(mj_solveM2(m, d, result, vectors, roots.as_ptr(), count));
    }
    #[cfg(not(engine_since = "3.5.0"))]
    c!(mj_solveM2(m, d, result, vectors, count));
}

#[test]
fn square_roots_of_the_inertia_matrix_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let nv = twins.model.nv();
        // The engine's square root has a defect. Half of a solution of a product is a square root
        // as well.
        let vector = twins.numbers(nv);
        let (mut ours, mut product, mut theirs) = (vec![0.0; nv], vec![0.0; nv], vec![0.0; nv]);
        twins.ours.mul_m2_into(&vector, &mut ours).unwrap();
        c!(mj_mulM(twins.raw.m(), twins.raw.d, product.as_mut_ptr(), vector.as_ptr()));
        solve_m2(&twins, &product, &mut theirs, 1);
        let size = 1.0 + theirs.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (ours, theirs) in ours.iter().zip(&theirs) {
            assert!((ours - theirs).abs() < 1e-9 * size, "{}: {ours} and {theirs}", twins.name);
        }

        let vectors = twins.numbers(2 * nv);
        let (mut ours, mut theirs) = (vec![0.0; 2 * nv], vec![0.0; 2 * nv]);
        twins.ours.solve_m2_into(&vectors, &mut ours).unwrap();
        solve_m2(&twins, &vectors, &mut theirs, 2);
        assert_same(&twins.name, &ours, &theirs);

        for (accelerations, flag) in [(Accelerations::Zero, 0), (Accelerations::Present, 1)] {
            let (mut ours, mut theirs) = (vec![0.0; nv], vec![0.0; nv]);
            twins.ours.rne_into(accelerations, &mut ours).unwrap();
            c!(mj_rne(twins.raw.m(), twins.raw.d, flag, theirs.as_mut_ptr()));
            assert_same(&twins.name, &ours, &theirs);
        }
    }
}

#[test]
fn sums_with_the_inertia_matrix_equal_c() {
    for subject in small_subjects() {
        let mut twins = Twins::in_motion(subject);
        let nv = twins.model.nv();
        let mut sum = twins.ours.full_m().unwrap();
        let mut theirs = sum.as_slice().to_vec();
        twins.ours.add_m(&mut sum).unwrap();
        let null = std::ptr::null_mut;
        c!(mj_addM(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), null(), null(), null()));
        // Newer engines add the lower triangle only.
        #[cfg(engine_since = "3.5.0")]
        for row in 0..nv {
            for column in row + 1..nv {
                theirs[row * nv + column] = theirs[column * nv + row];
            }
        }
        assert_same(&twins.name, sum.as_slice(), &theirs);

        // Sparse sums, first to empty rows, then to existing rows: the matrix once and twice.
        let mut rownnz = vec![0; nv];
        let rowadr: Vec<i32> = (0..nv as i32).map(|row| row * nv as i32).collect();
        let (mut values, mut colind) = (vec![0.0; nv * nv], vec![0; nv * nv]);
        let full = twins.ours.full_m().unwrap();
        for times in [1.0, 2.0] {
            twins.ours.add_m_sparse(&mut values, &mut rownnz, &rowadr, &mut colind).unwrap();
            let mut dense = vec![0.0; nv * nv];
            for row in 0..nv {
                for at in row * nv..row * nv + rownnz[row] as usize {
                    dense[row * nv + colind[at] as usize] = values[at];
                }
            }
            let expected: Vec<f64> = full.as_slice().iter().map(|value| times * value).collect();
            for (ours, theirs) in dense.iter().zip(&expected) {
                assert!(ours == theirs, "{}, {times} times: {ours} and {theirs}", twins.name);
            }
        }
    }
}

#[test]
fn products_with_the_constraint_jacobian_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let (nv, nefc) = (twins.model.nv(), twins.ours.nefc());
        let vector = twins.numbers(nv);
        let (mut ours, mut theirs) = (vec![0.0; nefc], vec![0.0; nefc]);
        twins.ours.mul_jac_vec_into(&vector, &mut ours).unwrap();
        c!(mj_mulJacVec(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), vector.as_ptr()));
        assert_same(&twins.name, &ours, &theirs);

        let vector = twins.numbers(nefc);
        let (mut ours, mut theirs) = (vec![7.0; nv], vec![0.0; nv]);
        twins.ours.mul_jac_t_vec_into(&vector, &mut ours).unwrap();
        c!(mj_mulJacTVec(twins.raw.m(), twins.raw.d, theirs.as_mut_ptr(), vector.as_ptr()));
        assert_same(&twins.name, &ours, &theirs);

        let jar = twins.numbers(nefc);
        let mut cost = 0.0;
        c!(mj_constraintUpdate(twins.raw.m(), twins.raw.d, jar.as_ptr(), &raw mut cost, 1));
        assert_same(&twins.name, &[twins.ours.constraint_update(&jar, ConeHessian::Compute).unwrap()], &[cost]);
        assert_same(&twins.name, twins.ours.efc_force(), &twins.raw.values(|d| d.efc_force, nefc));
        assert_same(&twins.name, twins.ours.qfrc_constraint(), &twins.raw.values(|d| d.qfrc_constraint, nv));

        assert_eq!(twins.model.is_sparse(), c!(mj_isSparse(twins.raw.m())) != 0);
        assert_eq!(twins.model.is_dual(), c!(mj_isDual(twins.raw.m())) != 0);
        assert_eq!(twins.model.is_pyramidal(), c!(mj_isPyramidal(twins.raw.m())) != 0);
    }
}

#[test]
fn velocities_and_accelerations_of_objects_equal_c() {
    for subject in small_subjects() {
        let mut twins = Twins::in_motion(subject);
        twins.ours.rne_post_constraint().unwrap();
        c!(mj_rnePostConstraint(twins.raw.m(), twins.raw.d));
        let model = twins.model.clone();
        let bodies = model.bodies().map(|body| body.id());
        let objects = bodies
            .flat_map(|id| [(FrameId::BodyInertia(id), 1, id.index()), (FrameId::Body(id), 2, id.index())])
            .chain(model.geoms().map(|geom| (FrameId::Geom(geom.id()), 5, geom.index())))
            .chain(model.sites().map(|site| (FrameId::Site(site.id()), 6, site.index())))
            .chain(model.cameras().map(|camera| (FrameId::Camera(camera.id()), 7, camera.index())));
        for (object, objtype, index) in objects {
            for (axes, local) in [(Axes::World, 0), (Axes::Local, 1)] {
                let same = |what: &str, ours: SpatialVector, theirs: [f64; 6]| {
                    assert_same(&format!("{what} of {object:?}"), &ours.angular, &theirs[..3]);
                    assert_same(&format!("{what} of {object:?}"), &ours.linear, &theirs[3..]);
                };
                let mut result = [0.0; 6];
                let (m, d, id) = (twins.raw.m(), twins.raw.d, index as i32);
                c!(mj_objectVelocity(m, d, objtype, id, result.as_mut_ptr(), local));
                same("velocity", twins.ours.object_velocity(object, axes).unwrap(), result);
                c!(mj_objectAcceleration(m, d, objtype, id, result.as_mut_ptr(), local));
                same("acceleration", twins.ours.object_acceleration(object, axes).unwrap(), result);
            }
        }
    }
}

#[test]
fn forces_on_bodies_and_points_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let nv = twins.model.nv();
        let bodies: Vec<_> = twins.model.bodies().map(|body| body.id()).step_by(3).collect();
        for body in bodies.into_iter().take(30) {
            let numbers = twins.numbers(13);
            let [force, torque, point] = [0, 3, 6].map(|at| [numbers[at], numbers[at + 1], numbers[at + 2]]);
            let start = twins.numbers(nv);
            let (mut ours, mut theirs) = (start.clone(), start);
            twins.ours.apply_ft(force, torque, point, body, &mut ours).unwrap();
            let (m, d, id) = (twins.raw.m(), twins.raw.d, body.index() as i32);
            c!(mj_applyFT(m, d, force.as_ptr(), torque.as_ptr(), point.as_ptr(), id, theirs.as_mut_ptr()));
            assert_same(&twins.name, &ours, &theirs);

            let quat = [numbers[9], numbers[10], numbers[11], numbers[12]];
            let (mut xpos, mut xmat) = ([0.0; 3], [0.0; 9]);
            c!(mj_local2Global(d, xpos.as_mut_ptr(), xmat.as_mut_ptr(), point.as_ptr(), quat.as_ptr(), id, 0));
            let (pos, mat) = twins.ours.local_to_global(point, quat, body).unwrap();
            assert_same(&twins.name, &pos, &xpos);
            assert_same(&twins.name, &mat, &xmat);

            let [axis, point] = [force, torque];
            let mut theirs = [vec![0.0; 3 * nv], vec![0.0; 3 * nv]];
            let [jac_point, jac_axis] = theirs.each_mut().map(|matrix| matrix.as_mut_ptr());
            c!(mj_jacPointAxis(m, d, jac_point, jac_axis, point.as_ptr(), axis.as_ptr(), id));
            let ours = twins.ours.jac_point_axis(point, axis, body).unwrap();
            assert_same(&twins.name, ours[0].as_slice(), &theirs[0]);
            assert_same(&twins.name, ours[1].as_slice(), &theirs[1]);
        }
    }
}

#[test]
fn the_angular_momentum_matrix_equals_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        twins.ours.subtree_vel().unwrap();
        assert_eq!(twins.ours.stage(), Stage::Acceleration);
        c!(mj_subtreeVel(twins.raw.m(), twins.raw.d));
        let theirs = twins.raw.values(|d| d.subtree_angmom, 3 * twins.model.nbody());
        assert_same(&twins.name, twins.ours.subtree_angmom().as_flattened(), &theirs);
        for body in twins.model.bodies() {
            let matrix = twins.ours.angmom_mat(body).unwrap();
            for (axis, row) in matrix.rows().enumerate() {
                let products = row.iter().zip(twins.ours.qvel()).map(|(entry, velocity)| entry * velocity);
                let size: f64 = 1.0 + products.clone().map(f64::abs).sum::<f64>();
                let (ours, theirs) = (products.sum::<f64>(), theirs[3 * body.index() + axis]);
                assert!((ours - theirs).abs() < 1e-10 * size, "{}, {body:?}: {ours} and {theirs}", twins.name);
            }
        }
    }
}

#[test]
fn masses_and_quaternions_equal_c() {
    for subject in small_subjects() {
        let mut twins = Twins::in_motion(subject);
        assert_same(&twins.name, &[twins.model.total_mass()], &[c!(mj_getTotalmass(twins.raw.m()))]);
        let mut ours = twins.numbers(twins.model.nq());
        let mut theirs = ours.clone();
        twins.model.normalize_quat(&mut ours).unwrap();
        c!(mj_normalizeQuat(twins.raw.m(), theirs.as_mut_ptr()));
        assert_same(&twins.name, &ours, &theirs);
    }
}
