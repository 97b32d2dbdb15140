//! Published and independently computed figures: the cart-pole of the reference's LQR tutorial,
//! whose linearisation, gain and closed loop were computed with the official Python bindings and
//! SciPy, and the engine's sample humanoid.
//!
//! The tests of the sample humanoid need the package `libmujoco-samples`.
#![allow(clippy::unreadable_literal, reason = "figures as published")]

use std::path::Path;
use std::sync::Arc;

use mujoco_safe::{Controller, Data, Differences, Lqr, LqrWeights, Matrix, Model, StateSpace, sample};
use nalgebra::Complex;

use crate::installed::has;

#[track_caller]
fn assert_near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{what} is {found}, not {expected}");
}

#[track_caller]
fn assert_all_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_near(&format!("{what}[{index}]"), *found, *expected, tolerance);
    }
}

mod cartpole {
    use super::*;

    const A: [[f64; 4]; 4] = [
        [1.0, -0.00020933539434596422, 0.00999696728367769, 7.112993351890879e-06],
        [0.0, 1.0027918363759287, 7.112993351890878e-06, 0.009905136378663615],
        [0.0, -0.020933539434596422, 0.9996967283677689, 0.000711299335189088],
        [0.0, 0.2791836375928739, 0.0007112993351890878, 0.9905136378663615],
    ];
    const B: [f64; 4] = [0.0030327163223112376, -0.007112993351890878, 0.30327163223112374, -0.7112993351890878];
    const K: [f64; 4] = [-0.46741668449941, -5.5927150414698, -0.8436677105895, -1.4448668569023];

    fn linearised(data: &mut Data) -> StateSpace {
        data.transition_fd(1e-6, Differences::Central).unwrap()
    }

    fn weights() -> LqrWeights {
        LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0])
    }

    fn upright() -> Data {
        Data::new(sample::cartpole()).unwrap()
    }

    fn regulator() -> Lqr {
        Lqr::at_present_state(&mut upright(), &weights()).unwrap()
    }

    /// Steps with the regulator, and counts the steps in which its control exceeds the motor's
    /// range.
    fn regulate(data: &mut Data, lqr: &mut Lqr, steps: usize) -> usize {
        let mut saturated = 0;
        for _ in 0..steps {
            lqr.control(data).unwrap();
            saturated += usize::from(data.ctrl()[0].abs() > 1.0);
            data.step().unwrap();
        }
        saturated
    }

    #[test]
    fn the_linearisation_at_the_upright_position_equals_the_published_figures() {
        let StateSpace { a, b, .. } = linearised(&mut upright());
        assert_eq!((a.shape(), b.shape()), ((4, 4), (4, 1)));
        assert_all_near("A", a.as_slice(), A.as_flattened(), 1e-12);
        assert_all_near("B", b.as_slice(), &B, 1e-12);
    }

    #[test]
    fn the_gain_the_cost_and_the_closed_loop_equal_scipy() {
        let system = linearised(&mut upright());
        let solution = Lqr::solve(&system, &weights()).unwrap();
        assert_all_near("K", solution.k.as_slice(), &K, 1e-8);
        let p = [180.2819066017, 2907.909272519, 166.5472641831, 37.13361185153];
        for (index, expected) in p.into_iter().enumerate() {
            let found = solution.p[(index, index)];
            assert_near(&format!("P[{index}, {index}]"), found / expected, 1.0, 1e-9);
        }

        let closed = system.a.to_nalgebra() - system.b.to_nalgebra() * solution.k.to_nalgebra();
        let mut eigenvalues: Vec<Complex<f64>> = closed.complex_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(|x, y| (x.re, x.im).partial_cmp(&(y.re, y.im)).unwrap());
        let expected = [
            (0.2259216435108, 0.0),
            (0.9835493713954, -0.0118444062628),
            (0.9835493713954, 0.0118444062628),
            (0.9897460625077, 0.0),
        ];
        for (found, (re, im)) in eigenvalues.iter().zip(expected) {
            assert_near("an eigenvalue's real part", found.re, re, 1e-10);
            assert_near("an eigenvalue's imaginary part", found.im, im, 1e-10);
        }
    }

    #[test]
    fn the_regulator_has_the_gain_of_the_riccati_equation() {
        assert_all_near("K", regulator().gain().as_slice(), &K, 1e-8);
    }

    #[test]
    fn the_closed_loop_from_a_small_angle_ends_at_the_recorded_state() {
        let mut data = upright();
        data.qpos_mut()[1] = 0.01;
        let saturated = regulate(&mut data, &mut regulator(), 1000);
        assert_eq!(saturated, 0);
        // Recorded with five digits.
        let end = [2.3438e-06, 2.5818e-07, -2.4303e-06, -2.7029e-07];
        for (index, (found, expected)) in data.physics_state().iter().zip(end).enumerate() {
            assert_near(&format!("state[{index}]"), found / expected, 1.0, 1e-4);
        }
    }

    #[test]
    fn from_larger_angles_the_motor_saturates_for_the_recorded_steps() {
        for (angle, saturations) in [(0.1, 0), (0.2, 1), (0.3, 2), (0.5, 4)] {
            let mut data = upright();
            data.qpos_mut()[1] = angle;
            let saturated = regulate(&mut data, &mut regulator(), 1000);
            assert_eq!(saturated, saturations, "steps of saturation from {angle} rad");
            assert!(
                data.physics_state().iter().all(|value| value.abs() < 1e-2),
                "{angle} rad: {:?}",
                data.physics_state()
            );
        }
    }

    #[test]
    fn the_pole_recovers_from_5_newtons_but_not_from_10() {
        for (newtons, stands) in [(5.0, true), (10.0, false)] {
            let mut data = upright();
            let mut lqr = regulator();
            data.body_mut("pole").unwrap().xfrc_applied_mut()[0] = newtons;
            regulate(&mut data, &mut lqr, 10);
            data.body_mut("pole").unwrap().xfrc_applied_mut()[0] = 0.0;
            let mut leaning = 0.0_f64;
            for _ in 0..1000 {
                regulate(&mut data, &mut lqr, 1);
                leaning = leaning.max(data.qpos()[1].abs());
            }
            assert_eq!(leaning < 1.0, stands, "after {newtons} N the pole leans up to {leaning} rad");
            if stands {
                assert!(data.physics_state().iter().all(|value| value.abs() < 1e-2), "{:?}", data.physics_state());
            }
        }
    }

    #[test]
    fn without_control_the_pole_falls_as_recorded() {
        let mut data = upright();
        data.qpos_mut()[1] = 0.01;
        for _ in 0..500 {
            data.step().unwrap();
        }
        assert_all_near("qpos", data.qpos(), &[-0.13082244121084702, 2.8006690225199105], 1e-9);
        assert_all_near("qvel", data.qvel(), &[-0.021304306514575953, 0.05158143442483461], 1e-9);
    }
}

mod sample_humanoid {
    use super::*;

    fn humanoid() -> Option<Arc<Model>> {
        let path = Path::new(sample::SYSTEM_MODELS).join("humanoid/humanoid.xml");
        has("libmujoco-samples", path.exists()).then(|| Arc::new(Model::from_xml_path(&path).unwrap()))
    }

    fn stepped(model: &Arc<Model>, steps: usize) -> Data {
        let mut data = Data::new(model.clone()).unwrap();
        for _ in 0..steps {
            data.step().unwrap();
        }
        data
    }

    fn norm(matrix: &Matrix) -> f64 {
        matrix.to_nalgebra().norm()
    }

    #[test]
    fn sizes_weight_and_names_equal_the_record() {
        let Some(model) = humanoid() else { return };
        assert_eq!((model.nq(), model.nv(), model.nu(), model.na()), (28, 27, 21, 0));
        assert_eq!((model.nbody(), model.njnt(), model.nkey()), (17, 22, 0));
        assert_near("the time step", model.timestep(), 0.005, 0.0);
        let weight = -model.options().gravity[2] * model.body("torso").unwrap().subtreemass();
        assert_near("the weight", weight, 400.6798481841, 1e-9);

        assert_eq!(model.joint("left_knee").unwrap().qpos_range(), 19..20);
        let left = model.joints().filter(|joint| joint.name().is_some_and(|name| name.contains("left")));
        assert_eq!(left.count(), 9);

        let mut data = Data::new(model).unwrap();
        data.reset().unwrap();
        assert_eq!(data.qpos()[..4], [0.0, 0.0, 1.5, 1.0]);
    }

    #[test]
    fn the_fall_from_the_reference_position_equals_the_record() {
        let Some(model) = humanoid() else { return };
        let mut data = stepped(&model, 0);
        let first = (1..=100).find(|_| {
            data.step().unwrap();
            data.ncon() > 0
        });
        assert_eq!(first, Some(43), "the step of the first contact");

        let data = stepped(&model, 100);
        assert_near("time", data.time(), 0.5000000000000003, 0.0);
        assert_eq!((data.ncon(), data.nefc()), (6, 28));
        assert_all_near("qpos", &data.qpos()[..3], &[0.0933876646755869, -1.5e-16, 1.2568522676643226], 1e-9);
        let contact = data.contacts().next().unwrap();
        assert_near("dist", contact.dist(), -0.00036072820205, 1e-12);
        assert_all_near("pos", contact.pos(), &[-0.0798542295, -0.1097356442, -0.00018036], 1e-8);
        assert_all_near("normal", contact.normal(), &[0.0, 0.0, 1.0], 1e-15);
        assert_eq!(
            contact.geoms().unwrap().map(|geom| model.geom(geom).name()),
            [Some("floor"), Some("right_right_foot")]
        );
        let force = contact.force().unwrap();
        assert_all_near("force", &force.force, &[57.0754954, -2.5662983, 0.2591644], 1e-6);
        assert_all_near("torque", &force.torque, &[0.0; 3], 0.0);
    }

    #[test]
    fn the_drop_from_two_metres_ends_at_the_recorded_state() {
        let Some(model) = humanoid() else { return };
        let mut data = stepped(&model, 0);
        data.qpos_mut()[2] = 2.0;
        for _ in 0..400 {
            data.step().unwrap();
        }
        // A fall of two seconds amplifies rounding errors: seven digits remain.
        assert_near("z", data.qpos()[2], 0.2792032523, 1e-7);
        assert_eq!(data.ncon(), 7);
    }

    #[test]
    fn jacobians_equal_the_record() {
        let Some(model) = humanoid() else { return };
        let mut data = stepped(&model, 1);
        let torso = model.body("torso").unwrap();
        let com = *data.body(torso).subtree_com();
        assert_all_near("subtree_com", &com, &[0.015685595769818515, 0.0, 1.0672691968325632], 1e-12);

        let subtree = data.jac_subtree_com(torso).unwrap();
        let row = [1.0000000000000002, 0.0, 0.0, 0.0, -0.4327308031674367, 2.378e-18];
        assert_all_near("jac_subtree_com, row 0", &subtree.row(0)[..6], &row, 1e-12);
        assert_near("its norm", norm(&subtree), 1.885334862905384, 1e-12);

        let com = data.jac_body_com(torso).unwrap();
        assert_near("jac_body_com, translation", norm(&com.linear), 1.7333003029, 1e-9);
        assert_near("jac_body_com, rotation", norm(&com.angular), 1.7320508076, 1e-9);
    }

    #[test]
    fn the_linearisation_has_the_recorded_norms() {
        let Some(model) = humanoid() else { return };
        let system = stepped(&model, 0).transition_fd(1e-6, Differences::Central).unwrap();
        assert_eq!((system.a.shape(), system.b.shape()), ((54, 54), (54, 21)));
        assert_near("A", norm(&system.a), 8.02075917, 1e-7);
        assert_near("B", norm(&system.b), 21.58531543, 1e-7);
    }
}
