//! Functions that this crate implements in Rust, because 2.2.2 does not have them, agree with those
//! of newer engines.

use mujoco_safe::data::RayOptions;
use mujoco_safe::derivative::InverseForce;
use mujoco_safe::math::{self, BandKind, BandShape, BoxQp, BoxQpStatus};
use mujoco_safe::sys;
use mujoco_safe::{Data, Matrix, Model, StateSpec};

use super::{Raw, squatting};

/// Compares numbers with a relative and absolute tolerance.
fn assert_near(ours: &[f64], engine: &[f64], tolerance: f64, what: &str) {
    assert_eq!(ours.len(), engine.len(), "{what}");
    for (at, (one, other)) in ours.iter().zip(engine).enumerate() {
        assert!((one - other).abs() <= tolerance * (1.0 + other.abs()), "{what} {at}: {one} {other}");
    }
}

/// Returns a data of the C API with the same state and results.
fn twin(data: &Data) -> Raw {
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    c!(mj_copyData(raw.0, data.model().as_ptr(), data.as_ptr()));
    raw
}

fn in_the_air() -> Data {
    let mut data = squatting();
    data.qpos_mut()[2] += 1.0;
    for (dof, velocity) in data.qvel_mut().iter_mut().enumerate() {
        *velocity = 0.3 * f64::sin(dof as f64);
    }
    data.ctrl_mut().fill(0.2);
    data.forward().unwrap();
    data
}

#[test]
fn state_vectors_equal_those_of_the_engine_bit_for_bit() {
    let mut data = squatting();
    data.qfrc_applied_mut().fill(0.1);
    data.xfrc_applied_mut()[3] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    data.ctrl_mut().fill(0.2);
    data.step().unwrap();
    let model = data.model().clone();
    let specs = [
        (StateSpec::TIME, sys::mjSTATE_TIME),
        (StateSpec::PHYSICS, sys::mjSTATE_PHYSICS),
        (StateSpec::WARMSTART | StateSpec::CTRL, sys::mjSTATE_WARMSTART | sys::mjSTATE_CTRL),
        (StateSpec::QFRC_APPLIED | StateSpec::QPOS, sys::mjSTATE_QFRC_APPLIED | sys::mjSTATE_QPOS),
        (StateSpec::XFRC_APPLIED | StateSpec::QVEL, sys::mjSTATE_XFRC_APPLIED | sys::mjSTATE_QVEL),
        (StateSpec::MOCAP_POS | StateSpec::MOCAP_QUAT, sys::mjSTATE_MOCAP_POS | sys::mjSTATE_MOCAP_QUAT),
        (StateSpec::USERDATA | StateSpec::ACT, sys::mjSTATE_USERDATA | sys::mjSTATE_ACT),
    ];
    for (ours, engine) in specs {
        assert_eq!(model.state_size(ours), c!(mj_stateSize(model.as_ptr(), engine as _)) as usize, "{ours:?}");
        let state = data.state(ours);
        let mut expected = vec![0.0; state.len()];
        c!(mj_getState(model.as_ptr(), data.as_ptr(), expected.as_mut_ptr(), engine as _));
        assert_eq!(state, expected, "{ours:?}");
        // Writes a changed state by both.
        let changed: Vec<f64> = state.iter().map(|value| value + 0.01).collect();
        let raw = twin(&data);
        c!(mj_setState(model.as_ptr(), raw.0, changed.as_ptr(), engine as _));
        let mut copy = data.clone();
        copy.set_state(ours, &changed).unwrap();
        let mut stored = [vec![0.0; state.len()], vec![0.0; state.len()]];
        c!(mj_getState(model.as_ptr(), raw.0, stored[0].as_mut_ptr(), engine as _));
        c!(mj_getState(model.as_ptr(), copy.as_ptr(), stored[1].as_mut_ptr(), engine as _));
        assert_eq!(stored[0], stored[1], "{ours:?}");
    }
}

#[test]
fn a_stored_keyframe_equals_that_of_the_engine_bit_for_bit() {
    let mut data = in_the_air();
    data.step().unwrap();
    let expected = (**data.model()).clone();
    c!(mj_setKeyframe(expected.as_ptr().cast_mut(), data.as_ptr(), 0));
    data.set_keyframe(0_usize).unwrap();
    let stored = data.model();
    assert_eq!((stored.key_time()[0], stored.key_qpos().row(0)), (expected.key_time()[0], expected.key_qpos().row(0)));
    assert_eq!(stored.key_qvel().row(0), expected.key_qvel().row(0));
    assert_eq!(stored.key_ctrl().row(0), expected.key_ctrl().row(0));
    assert!(stored.key_ctrl().row(0).contains(&0.2));
}

#[test]
fn derivatives_of_inverse_dynamics_agree_with_the_engine() {
    let mut data = in_the_air();
    let model = data.model().clone();
    let (nv, ns) = (model.nv(), model.nsensordata());
    for (force, flag) in [(InverseForce::Total, 0), (InverseForce::WithoutActuators, 1)] {
        let ours = data.inverse_fd(1e-6, force).unwrap();
        let raw = twin(&data);
        let mut engine = [nv, nv, nv, ns, ns, ns, ours.dm_dq.shape().1].map(|columns| Matrix::zeros(nv, columns));
        let [dq, dv, da, sq, sv, sa, mq] = engine.each_mut().map(|matrix| {
            if matrix.as_slice().is_empty() { std::ptr::null_mut() } else { matrix.as_mut_slice().as_mut_ptr() }
        });
        c!(mjd_inverseFD(model.as_ptr(), raw.0, 1e-6, flag, dq, dv, da, sq, sv, sa, mq));
        let ours = [&ours.df_dq, &ours.df_dv, &ours.df_da, &ours.ds_dq, &ours.ds_dv, &ours.ds_da, &ours.dm_dq];
        for (at, (ours, engine)) in ours.into_iter().zip(&engine).enumerate() {
            assert_near(ours.as_slice(), engine.as_slice(), 1e-6, &format!("{force:?} {at}"));
        }
    }
}

#[test]
fn several_rays_hit_what_the_function_of_the_engine_finds() {
    let data = squatting_with_results();
    let model = data.model().clone();
    let directions: Vec<[f64; 3]> = (0..200)
        .map(|ray| {
            let (turn, slope) = (0.4 * f64::from(ray), 0.01 * f64::from(ray));
            [turn.cos(), turn.sin(), -slope]
        })
        .collect();
    let mut hits = vec![None; directions.len()];
    let point = [1.0, 0.2, 1.5];
    data.multi_ray_into(point, &directions, &RayOptions::default(), 4.0, &mut hits).unwrap();
    let raw = twin(&data);
    let (mut geoms, mut distances) = (vec![0; hits.len()], vec![0.0; hits.len()]);
    let none = std::ptr::null;
    c!(mj_multiRay(
        model.as_ptr(),
        raw.0,
        point.as_ptr(),
        directions.as_ptr().cast(),
        none(),
        1,
        -1,
        geoms.as_mut_ptr(),
        distances.as_mut_ptr(),
        std::ptr::null_mut(),
        hits.len() as i32,
        4.0,
    ));
    let (mut found, mut missed) = (0, 0);
    for ((hit, geom), distance) in hits.iter().zip(&geoms).zip(&distances) {
        if let Some(hit) = hit {
            assert_eq!((hit.geom.index() as i32, hit.distance), (*geom, *distance));
            found += 1;
        } else {
            // The engine also returns some hits beyond the cutoff, for example those of planes.
            assert!(*geom == -1 || *distance > 4.0, "{geom} {distance}");
            missed += 1;
        }
    }
    assert!(found > 20 && missed > 20, "{found} {missed}");
}

fn squatting_with_results() -> Data {
    let mut data = squatting();
    data.forward().unwrap();
    data
}

const SHAPES: &str = r#"<mujoco><worldbody>
  <geom name="plane" type="plane" size="0 0 1"/>
  <body pos="0 0 1" euler="20 30 40"><freejoint/><geom name="box" type="box" size="0.1 0.2 0.3"/></body>
  <body pos="1 0 1.2" euler="70 10 20"><freejoint/><geom name="capsule" type="capsule" size="0.1 0.3"/></body>
  <body pos="0 1 1.4"><freejoint/><geom name="sphere" size="0.2"/></body>
  <body pos="1 1 1.1" euler="5 50 10"><freejoint/><geom name="ellipsoid" type="ellipsoid" size="0.1 0.2 0.15"/></body>
  <body pos="-1 1 1.3" euler="15 40 30"><freejoint/><geom name="cylinder" type="cylinder" size="0.1 0.2"/></body>
</worldbody></mujoco>"#;

#[test]
fn distances_of_geoms_agree_with_the_engine() {
    // 3.5.0 returns larger distances between some convex shapes than later versions, by up to 28 %.
    if sys::mjVERSION_HEADER < 3_017_000 {
        return;
    }
    let mut data = Data::new(Model::from_xml_str(SHAPES).unwrap()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let mut count = 0;
    for one in 0..model.ngeom() {
        for other in one + 1..model.ngeom() {
            let ours = data.geom_distance(one, other, 5.0).unwrap().expect("nearer than 5 m");
            let raw = twin(&data);
            let mut fromto = [0.0; 6];
            let engine = c!(mj_geomDistance(model.as_ptr(), raw.0, one as i32, other as i32, 5.0, fromto.as_mut_ptr()));
            // Both iterate for shapes without a formula, with a tolerance of 1e-6.
            assert!((ours.distance - engine).abs() < 1e-4, "{one} {other}: {} {engine}", ours.distance);
            count += 1;
        }
    }
    assert_eq!(count, 15);
}

#[test]
fn the_angular_momentum_matrix_equals_that_of_the_engine() {
    let data = in_the_air();
    let model = data.model().clone();
    let raw = twin(&data);
    for body in 0..model.nbody() {
        let ours = data.angmom_mat(body).unwrap();
        let mut engine = vec![0.0; 3 * model.nv()];
        c!(mj_angmomMat(model.as_ptr(), raw.0, engine.as_mut_ptr(), body as i32));
        assert_near(ours.as_slice(), &engine, 1e-12, &format!("body {body}"));
    }
}

#[test]
fn derivatives_of_quaternions_agree_with_the_engine() {
    let axis =
        |x: f64, y: f64, z: f64| math::axis_angle2quat(&[x, y, z].map(|v| v / (x * x + y * y + z * z).sqrt()), 1.3);
    for (qa, qb) in [(axis(1.0, 2.0, 3.0), axis(-1.0, 0.5, 2.0)), (axis(0.0, 0.0, 1.0), axis(0.0, 0.1, 1.0))] {
        let ours = math::sub_quat_derivative(&qa, &qb);
        let (mut da, mut db) = ([0.0; 9], [0.0; 9]);
        c!(mjd_subQuat(qa.as_ptr(), qb.as_ptr(), da.as_mut_ptr(), db.as_mut_ptr()));
        assert_near(&ours.da, &da, 1e-9, "Da");
        assert_near(&ours.db, &db, 1e-9, "Db");
    }
    for (vel, scale) in [([0.3, -0.2, 0.5], 0.7), ([3.0, 1.0, -2.0], 0.1)] {
        let ours = math::quat_integrate_derivative(&vel, scale);
        let (mut quat, mut by_vel, mut by_scale) = ([0.0; 9], [0.0; 9], [0.0; 3]);
        c!(mjd_quatIntegrate(vel.as_ptr(), scale, quat.as_mut_ptr(), by_vel.as_mut_ptr(), by_scale.as_mut_ptr()));
        assert_near(&ours.dquat, &quat, 1e-9, "Dquat");
        assert_near(&ours.dvel, &by_vel, 1e-9, "Dvel");
        assert_near(&ours.dscale, &by_scale, 1e-9, "Dscale");
    }
}

#[test]
fn box_constrained_programmes_have_the_solution_of_the_engine() {
    const N: usize = 5;
    let mut h = Matrix::zeros(N, N);
    for row in 0..N {
        for column in 0..N {
            h[(row, column)] = if row == column { 3.0 } else { f64::sin((row + column) as f64) * 0.5 };
        }
    }
    for seed in 0..20 {
        let value = |index: usize| 4.0 * f64::sin(f64::from(seed) + 1.7 * index as f64);
        let g: Vec<f64> = (0..N).map(value).collect();
        let (lower, upper) = ([-0.5; N], [0.7; N]);
        let mut x = [0.0; N];
        let mut solver = BoxQp::new(N);
        let solution = solver.solve(&mut x, &h, &g, Some(&lower), Some(&upper)).unwrap();
        assert_ne!(solution.status, BoxQpStatus::NotPositiveDefinite);
        let (mut res, mut factor, mut index) = ([0.0; N], [0.0; N * (N + 7)], [0; N]);
        let free = c!(mju_boxQP(
            res.as_mut_ptr(),
            factor.as_mut_ptr(),
            index.as_mut_ptr(),
            h.as_slice().as_ptr(),
            g.as_ptr(),
            N as i32,
            lower.as_ptr(),
            upper.as_ptr()
        ));
        assert_eq!(solution.index.len() as i32, free);
        assert!(solution.index.iter().zip(&index).all(|(ours, engine)| *ours as i32 == *engine));
        assert_near(&x, &res, 1e-8, "x");
    }
}

#[test]
fn band_matrices_agree_with_the_engine() {
    let (n, nband, ndense) = (8, 3, 2);
    let shape = BandShape::new(n, nband, ndense).unwrap();
    let mut dense = Matrix::zeros(n, n);
    for row in 0..n {
        for column in 0..n {
            let is_stored = row.abs_diff(column) < nband || row.max(column) >= n - ndense;
            if is_stored {
                dense[(row, column)] = if row == column { 6.0 } else { f64::cos((row * column) as f64) };
            }
        }
    }
    let sizes = [n, nband, ndense].map(|size| size as i32);
    let [ntotal, band, rest] = sizes;
    let mut packed = vec![0.0; shape.len()];
    math::dense2band(&mut packed, &dense, shape).unwrap();
    let mut engine = vec![0.0; shape.len()];
    c!(mju_dense2Band(engine.as_mut_ptr(), dense.as_slice().as_ptr(), ntotal, band, rest));
    assert_eq!(packed, engine);
    for row in 0..n {
        assert_eq!(shape.band_diag(row) as i32, c!(mju_bandDiag(row as i32, ntotal, band, rest)));
    }
    let mut back = Matrix::zeros(n, n);
    math::band2dense(&mut back, &packed, shape, BandKind::Symmetric).unwrap();
    let mut unpacked = vec![0.0; n * n];
    c!(mju_band2Dense(unpacked.as_mut_ptr(), packed.as_ptr(), ntotal, band, rest, 1));
    assert_eq!(back.as_slice(), unpacked);
    let vector: Vec<f64> = (0..n).map(|at| at as f64 - 2.5).collect();
    let (mut product, mut expected) = (Matrix::zeros(1, n), vec![0.0; n]);
    let vectors = Matrix::from_row_major(1, n, vector.clone());
    math::band_mul_mat_vec(&mut product, &packed, &vectors, shape, BandKind::Symmetric).unwrap();
    c!(mju_bandMulMatVec(expected.as_mut_ptr(), packed.as_ptr(), vector.as_ptr(), ntotal, band, rest, 1, 1));
    assert_near(product.as_slice(), &expected, 1e-14, "product");
    let pivot = math::chol_factor_band(&mut packed, shape, 0.1, 0.01).unwrap().expect("positive definite");
    let smallest = c!(mju_cholFactorBand(engine.as_mut_ptr(), ntotal, band, rest, 0.1, 0.01));
    // Version 4 returns the diagonal value of the factor instead of its square.
    let smallest = if sys::mjVERSION_HEADER >= 4_000_000 { smallest * smallest } else { smallest };
    assert!((pivot - smallest).abs() < 1e-12, "{pivot} {smallest}");
    // Storage that no value uses may differ.
    let mut factors = [vec![0.0; n * n], vec![0.0; n * n]];
    for (factor, stored) in factors.iter_mut().zip([&packed, &engine]) {
        c!(mju_band2Dense(factor.as_mut_ptr(), stored.as_ptr(), ntotal, band, rest, 0));
    }
    assert_near(&factors[0], &factors[1], 1e-14, "factor");
    let mut solution = vec![0.0; n];
    math::chol_solve_band(&mut solution, &packed, &vector, shape).unwrap();
    c!(mju_cholSolveBand(expected.as_mut_ptr(), engine.as_ptr(), vector.as_ptr(), ntotal, band, rest));
    assert_near(&solution, &expected, 1e-13, "solution");
}
