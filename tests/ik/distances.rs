//! Distances between geoms stay above their minimum.

use mujoco_safe::control::residual::FramePosition;
use mujoco_safe::ik::{Avoidance, Ik, Limit, Task};
use mujoco_safe::{Data, Model};

/// A point that moves in a plane, and an obstacle between it and its target.
fn scene(obstacle: &str) -> Model {
    Model::from_xml_str(&format!(
        r#"<mujoco><worldbody>
             <geom name="obstacle" {obstacle}/>
             <body name="point" pos="-.5 .03 0"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
               <geom name="point" size=".05"/></body>
           </worldbody></mujoco>"#
    ))
    .unwrap()
}

#[test]
fn obstacles_are_passed_at_a_distance() {
    for obstacle in [r#"size=".2""#, r#"type="capsule" size=".1 .3""#, r#"type="ellipsoid" size=".2 .15 .1""#] {
        let mut data = Data::new(scene(obstacle)).unwrap();
        let model = data.model().clone();
        let mut ik = Ik::new(&model);
        ik.add_task(Task::new(FramePosition::body(&model, "point").unwrap().with_target([0.6, 0.05, 0.0])));
        ik.set_velocity_limits(1.0).unwrap();
        let avoidance = Avoidance { minimum: 0.02, detection: 0.2, gain: 0.3 };
        ik.avoid("point", "obstacle", avoidance).unwrap();
        let (point, other) = (model.geom("point").unwrap().id(), model.geom("obstacle").unwrap().id());
        let (mut nearest, mut active) = (f64::INFINITY, false);
        for _ in 0..2000 {
            let tick = ik.step(&mut data, 0.005).unwrap();
            assert!(tick.is_solved());
            active |= tick.active().contains(&Limit::Distance(point, other));
            data.kinematics().unwrap();
            let found = data.geom_distance("point", "obstacle", 1.0).unwrap();
            nearest = nearest.min(found.map_or(f64::INFINITY, |found| found.distance));
        }
        assert!(active && nearest > 0.02 - 1e-4, "{obstacle}: {nearest}");
        let position = data.body("point").unwrap().xpos();
        assert!((position[0] - 0.6).abs() < 1e-3 && (position[1] - 0.05).abs() < 1e-3, "{obstacle}: {position:?}");
    }
}

#[test]
fn a_pair_that_is_too_near_moves_apart_if_it_can() {
    for (speed, moves) in [(1.0, true), (0.0, false)] {
        let mut data = Data::new(scene(r#"size=".2""#)).unwrap();
        let model = data.model().clone();
        data.qpos_mut()[0] = 0.265; // 0.0131 m inside
        let mut ik = Ik::new(&model);
        ik.add_task(Task::new(FramePosition::body(&model, "point").unwrap()));
        ik.avoid("obstacle", "point", Avoidance::default()).unwrap();
        ik.set_velocity_limits(speed).unwrap();
        let pair = Limit::Distance(model.geom("obstacle").unwrap().id(), model.geom("point").unwrap().id());
        for _ in 0..20 {
            let tick = ik.step(&mut data, 0.01).unwrap();
            assert!(tick.is_solved());
            assert_eq!(tick.conflicts().contains(&pair), !moves);
        }
        data.kinematics().unwrap();
        let after = data.geom_distance("point", "obstacle", 1.0).unwrap().unwrap().distance;
        assert!(if moves { after > 0.0049 } else { after < -0.013 }, "{after}");
    }
}

#[test]
fn wrong_distances_are_rejected() {
    let mut ik = Ik::new(scene(r#"size=".2""#));
    let normal = Avoidance::default();
    for avoidance in [
        Avoidance { minimum: -0.1, ..normal },
        Avoidance { minimum: f64::NAN, ..normal },
        Avoidance { detection: 0.001, ..normal },
        Avoidance { detection: f64::INFINITY, ..normal },
        Avoidance { gain: 0.0, ..normal },
        Avoidance { gain: 1.5, ..normal },
    ] {
        assert!(ik.avoid("point", "obstacle", avoidance).is_err(), "{avoidance:?}");
    }
    assert!(ik.avoid("point", "point", normal).is_err());
    assert!(ik.avoid("point", "wall", normal).is_err());
}
