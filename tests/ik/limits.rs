//! Limits of positions, velocities and accelerations hold in every tick, whatever the targets.

use mujoco_safe::control::residual::{Frame, FramePosition, JointPosition};
use mujoco_safe::ik::{Ik, IkStatus, Limit, SearchOptions, Task};
use mujoco_safe::{Data, Model};
use rand::RngExt;

use crate::{arm, humanoid, random};

const DT: f64 = 0.01;

#[test]
fn ranges_speeds_and_accelerations_hold_in_random_runs() {
    let model = std::sync::Arc::new(arm());
    for seed in 0..5 {
        let mut random = random(seed);
        let mut data = Data::new(&model).unwrap();
        let mut ik = Ik::new(&model);
        let hand = ik.add_task(Task::new(FramePosition::body(&model, "link6").unwrap()));
        let (speed, acceleration) = (2.0, 15.0);
        ik.set_velocity_limits(speed).unwrap();
        for joint in 0..7 {
            ik.set_acceleration_limit(joint, acceleration).unwrap();
        }
        let mut last = vec![0.0; model.nv()];
        let mut active = 0;
        for step in 0..600 {
            if step % 50 == 0 {
                let target: [f64; 3] = std::array::from_fn(|_| random.random_range(-2.0..2.0));
                ik.set_target(hand, &target).unwrap();
            }
            let tick = ik.step(&mut data, DT).unwrap();
            assert_eq!(tick.status(), IkStatus::Solved);
            assert!(tick.conflicts().is_empty(), "{:?}", tick.conflicts());
            active += tick.active().len();
            for (dof, (now, before)) in tick.velocity().iter().zip(&last).enumerate() {
                assert!(now.abs() <= speed + 1e-9, "dof {dof}: {now}");
                assert!((now - before).abs() <= acceleration * DT + 1e-9, "dof {dof}: {before} and {now}");
            }
            last.copy_from_slice(tick.velocity());
            for (q, [from, to]) in data.qpos().iter().zip(model.jnt_range()) {
                assert!(from <= q && q <= to, "{q} is not in [{from}, {to}]");
            }
        }
        assert!(active > 100);
    }
}

/// A slide that accelerates to its speed, and brakes before the end of its range.
#[test]
fn a_joint_brakes_in_time_and_reaches_the_end() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="x" type="slide" axis="1 0 0" limited="true" range="-1 1"/>
             <geom size=".1"/></body></worldbody></mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(JointPosition::all(&model).with_target(&[5.0]).unwrap()));
    ik.set_velocity_limit("x", 1.5).unwrap();
    ik.set_acceleration_limit("x", 3.0).unwrap();
    let x = model.joint("x").unwrap().id();
    let mut seen = Vec::new();
    let mut last = 0.0;
    for _ in 0..200 {
        let tick = ik.step(&mut data, DT).unwrap();
        let velocity = tick.velocity()[0];
        assert!((velocity - last).abs() <= 3.0 * DT + 1e-9 && velocity <= 1.5 + 1e-9);
        last = velocity;
        let [limit] = tick.active() else { panic!("{:?}", tick.active()) };
        if seen.last() != Some(limit) {
            seen.push(*limit);
        }
    }
    assert_eq!(seen[..3], [Limit::Acceleration(x), Limit::Velocity(x), Limit::Position(x)]);
    assert!((data.qpos()[0] - 1.0).abs() < 1e-12 && last.abs() < 1e-9);
}

#[test]
fn a_joint_outside_of_its_range_returns_and_is_reported() {
    let mut data = Data::new(arm()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.set_velocity_limits(1.0).unwrap();
    data.qpos_mut()[2] = 2.4 + 0.025;
    let joint = model.joint("joint2").unwrap().id();
    for reported in [true, true, false, false] {
        let tick = ik.step(&mut data, DT).unwrap();
        assert!(tick.is_solved());
        assert_eq!(tick.conflicts().contains(&Limit::Position(joint)), reported, "{:?}", tick.conflicts());
    }
    assert_eq!(data.qpos()[2], 2.4);
}

#[test]
fn balls_stay_in_their_range() {
    let model = Model::from_xml_str(
        r#"<mujoco><compiler angle="radian"/><worldbody><body><joint type="ball" limited="true" range="0 0.8"/>
             <geom size=".1"/><site name="tip" pos="0 0 1"/></body></worldbody></mujoco>"#,
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let tip = ik.add_task(Task::new(FramePosition::site(&model, "tip").unwrap()).with_gain(0.2));
    let mut largest: f64 = 0.0;
    for step in 0..400 {
        let phase = 0.05 * f64::from(step);
        ik.set_target(tip, &[2.0 * phase.cos(), 2.0 * phase.sin(), 0.0]).unwrap();
        assert!(ik.step(&mut data, DT).unwrap().is_solved());
        let angle = 2.0 * data.qpos()[0].abs().min(1.0).acos();
        assert!(angle <= 0.8 + 1e-9, "{angle}");
        largest = largest.max(angle);
    }
    assert!(largest > 0.79);
}

#[test]
fn prescribed_bases_move_as_prescribed() {
    let (mut data, mut ik, _) = humanoid();
    let model = data.model().clone();
    let velocity = [0.1, -0.2, 0.05, 0.3, 0.0, -0.1];
    ik.prescribe_velocity("root", Some(&velocity)).unwrap();
    for _ in 0..20 {
        let tick = ik.step(&mut data, DT).unwrap();
        assert!(tick.is_solved());
        assert_eq!(tick.velocity()[..6].iter().map(|v| (v * 1e9).round() / 1e9).collect::<Vec<_>>(), velocity);
    }
    ik.prescribe_velocity("root", None).unwrap();
    assert_ne!(ik.step(&mut data, DT).unwrap().velocity()[..6], velocity);
    assert!(Frame::body(&model, "torso").is_ok());
}

/// A finger whose joints are coupled by a fixed tendon, and a pole on a string.
fn tendons() -> Model {
    Model::from_xml_str(
        r#"<mujoco><compiler angle="radian"/><worldbody>
             <body><joint name="a" axis="0 1 0"/><geom size=".05" fromto="0 0 0 0 0 .3" type="capsule"/>
               <body pos="0 0 .3"><joint name="b" axis="0 1 0"/><geom size=".05" fromto="0 0 0 0 0 .3" type="capsule"/></body>
             </body>
             <site name="wall" pos="1 0 0"/>
             <body pos="1 1 0"><joint name="swing" axis="0 0 1"/><geom size=".05"/><site name="end" pos=".5 0 0"/></body>
           </worldbody>
           <tendon>
             <fixed name="coupling" limited="true" range="-0.3 0.5"><joint joint="a" coef="1"/><joint joint="b" coef="0.5"/></fixed>
             <spatial name="string" limited="true" range="0.2 1.3"><site site="wall"/><site site="end"/></spatial>
           </tendon></mujoco>"#,
    )
    .unwrap()
}

#[test]
fn lengths_of_tendons_stay_in_their_ranges() {
    let mut data = Data::new(tendons()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let posture = ik.add_task(Task::new(JointPosition::all(&model)).with_gain(0.2));
    let [coupling, string] = ["coupling", "string"].map(|name| model.tendon(name).unwrap().id());
    let mut most = [f64::NEG_INFINITY; 2];
    for target in [[2.0, 1.0, 0.0], [-2.0, 0.5, 2.5], [0.1, 0.2, -2.0]] {
        ik.set_target(posture, &target).unwrap();
        let mut active = Vec::new();
        for _ in 0..100 {
            let tick = ik.step(&mut data, DT).unwrap();
            assert!(tick.is_solved() && tick.conflicts().is_empty(), "{:?}", tick.conflicts());
            active.extend_from_slice(tick.active());
            data.forward().unwrap();
            for (tendon, most) in most.iter_mut().enumerate() {
                let [low, high] = model.tendon_range()[tendon];
                let length = data.ten_length()[tendon];
                *most = most.max(low - length).max(length - high);
            }
        }
        let expected = match target[2] {
            0.0 => vec![Limit::Tendon(coupling)],
            2.5 => vec![Limit::Tendon(coupling), Limit::Tendon(string)],
            _ => vec![],
        };
        for limit in [Limit::Tendon(coupling), Limit::Tendon(string)] {
            assert_eq!(active.contains(&limit), expected.contains(&limit), "{limit:?} of {active:?}");
        }
    }
    // The length of the fixed tendon is linear in the positions, unlike that of the spatial one.
    assert!(most[0] < 1e-12 && most[1] < 0.05, "{most:?}");
}

#[test]
fn a_tendon_outside_of_its_range_returns_or_is_reported() {
    let mut data = Data::new(tendons()).unwrap();
    let model = data.model().clone();
    let coupling = model.tendon("coupling").unwrap().id();
    let mut ik = Ik::new(&model);
    data.qpos_mut()[..2].copy_from_slice(&[1.0, 0.0]);
    ik.set_velocity_limits(1.0).unwrap();
    ik.add_task(Task::new(JointPosition::all(&model).with_target(&[2.0, 0.0, 0.0]).unwrap()));
    let tick = ik.step(&mut data, DT).unwrap();
    assert!(tick.is_solved());
    assert!(tick.conflicts().contains(&Limit::Tendon(coupling)), "{:?}", tick.conflicts());
    assert!(tick.velocity()[0] + 0.5 * tick.velocity()[1] < 1e-9, "the length does not grow: {:?}", tick.velocity());
    // Without a limit of the velocity it returns at once.
    ik.set_velocity_limits(f64::INFINITY).unwrap();
    assert!(ik.step(&mut data, DT).unwrap().conflicts().is_empty());
    data.forward().unwrap();
    assert!((data.ten_length()[0] - 0.5).abs() < 1e-9);
}

#[test]
fn a_search_finds_positions_within_the_ranges_of_tendons() {
    let mut data = Data::new(tendons()).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let angle = JointPosition::new(&model, "a").unwrap().with_target(&[0.7]).unwrap();
    ik.add_task(Task::new(angle));
    assert!(ik.search(&mut data, &SearchOptions::default()).unwrap().found().is_some());
    data.forward().unwrap();
    assert!(data.ten_length()[0] <= 0.5 + 1e-6 && (data.qpos()[0] - 0.7).abs() < 1e-6);
}
