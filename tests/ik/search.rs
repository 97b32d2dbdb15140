//! Global inverse kinematics.

use mujoco_safe::Data;
use mujoco_safe::control::residual::{Frame, FramePose, FramePosition, JointPosition};
use mujoco_safe::ik::{Avoidance, Ik, SearchOptions, SearchOutcome, Task};

use crate::{arm, random, randomise};

#[test]
fn reachable_poses_are_found_within_the_ranges() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let hand = ik.add_task(Task::new(FramePose::new(Frame::body(&model, "link6").unwrap())));
    let mut random = random(3);
    for _ in 0..100 {
        randomise(&mut data, &mut random);
        data.forward().unwrap();
        let link = data.body("link6").unwrap();
        let target = [link.xpos().as_slice(), link.xquat()].concat();
        data.qpos_mut().fill(0.0);
        ik.set_target(hand, &target).unwrap();
        let outcome = ik.search(&mut data, &SearchOptions::default()).unwrap();
        let found = outcome.found().unwrap_or_else(|| panic!("{target:?}: {outcome:?}"));
        assert!(found.error <= 1e-6);
        data.forward().unwrap();
        let link = data.body("link6").unwrap();
        for (value, target) in link.xpos().iter().zip(&target) {
            assert!((value - target).abs() < 1e-5);
        }
        for (q, [from, to]) in data.qpos().iter().zip(model.jnt_range()) {
            assert!(from <= q && q <= to);
        }
    }
}

#[test]
fn equal_seeds_give_equal_results_and_postures_are_secondary() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap().with_target([0.4, -0.5, 0.7])));
    ik.add_task(Task::new(JointPosition::all(&model)).with_priority(1));
    let mut solve = |seed| {
        data.reset().unwrap();
        data.qpos_mut().fill(-2.0);
        let found = ik.search(&mut data, &SearchOptions { seed, ..SearchOptions::default() }).unwrap();
        assert!(matches!(found, SearchOutcome::Found(_)), "{found:?}");
        data.qpos().to_vec()
    };
    assert_eq!(solve(5), solve(5));
}

#[test]
fn unreachable_targets_are_not_found_and_the_best_is_kept() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap().with_target([0.0, 0.0, 9.0])));
    let outcome = ik.search(&mut data, &SearchOptions { starts: 5, ..SearchOptions::default() }).unwrap();
    let SearchOutcome::NotFound(result) = outcome else { panic!("{outcome:?}") };
    data.kinematics().unwrap();
    let height = data.body("link6").unwrap().xpos()[2];
    assert_eq!(result.starts, 5);
    assert!((9.0 - height - result.error).abs() < 1e-2 && height > 1.3, "{height}: {result:?}");
}

#[test]
fn solutions_keep_distances() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap().with_target([0.35, 0.2, 0.5])));
    let geoms: Vec<usize> = (0..model.ngeom()).collect();
    let avoidance = Avoidance { minimum: 0.02, detection: 0.1, gain: 0.5 };
    for (place, &first) in geoms.iter().enumerate() {
        for &second in geoms.iter().skip(place + 2) {
            ik.avoid(first, second, avoidance).unwrap();
        }
    }
    let outcome = ik.search(&mut data, &SearchOptions::default()).unwrap();
    assert!(outcome.found().is_some(), "{outcome:?}");
    data.kinematics().unwrap();
    for (place, &first) in geoms.iter().enumerate() {
        for &second in geoms.iter().skip(place + 2) {
            let found = data.geom_distance(first, second, 1.0).unwrap();
            assert!(found.is_none_or(|found| found.distance >= 0.02 - 1e-5), "{found:?}");
        }
    }
}

#[test]
fn wrong_options_are_rejected() {
    let mut data = Data::new(arm()).unwrap();
    let mut ik = Ik::new(data.model());
    let normal = SearchOptions::default();
    for options in [
        SearchOptions { tolerance: 0.0, ..normal },
        SearchOptions { tolerance: f64::NAN, ..normal },
        SearchOptions { step: -1.0, ..normal },
        SearchOptions { starts: 0, ..normal },
    ] {
        assert!(ik.search(&mut data, &options).is_err(), "{options:?}");
    }
    // Without tasks, any position is a solution.
    assert!(ik.search(&mut data, &normal).unwrap().found().is_some());
}
