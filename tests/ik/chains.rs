//! Closed chains of equality constraints stay closed.

use mujoco_safe::control::residual::FramePosition;
use mujoco_safe::ik::{Ik, SearchOptions, Task};
use mujoco_safe::{Data, Model};

/// A planar four-bar linkage. In the plane, one of the three equations of the connection is
/// redundant.
fn four_bar(constraint: &str) -> Model {
    Model::from_xml_str(&format!(
        r#"<mujoco><default><geom type="capsule" size=".02" contype="0" conaffinity="0"/></default><worldbody>
             <body name="crank"><joint name="crank" axis="0 1 0"/><geom fromto="0 0 0 0 0 .2"/>
               <body name="rod" pos="0 0 .2"><joint name="rod" axis="0 1 0"/><geom fromto="0 0 0 .5 0 0"/>
                 <site name="tip" pos=".25 0 .1"/>
                 <body name="rocker" pos=".5 0 0"><joint name="rocker" axis="0 1 0"/><geom fromto="0 0 0 0 0 -.2"/></body>
             </body></body>
           </worldbody><equality>{constraint}</equality></mujoco>"#
    ))
    .unwrap()
}

#[test]
fn a_four_bar_linkage_stays_closed() {
    let mut data = Data::new(four_bar(r#"<connect body1="rocker" anchor="0 0 -.2"/>"#)).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    let tip = ik.add_task(Task::new(FramePosition::site(&model, "tip").unwrap()).with_gain(0.1));
    let mut moved: f64 = 0.0;
    for step in 0..300 {
        let phase = 0.03 * f64::from(step);
        ik.set_target(tip, &[0.25 + 0.1 * phase.sin(), 0.0, 0.3]).unwrap();
        let tick = ik.step(&mut data, 0.01).unwrap();
        assert!(tick.is_solved());
        assert!(tick.equality_violation() < 1e-3, "{}", tick.equality_violation());
        moved = moved.max(data.qpos()[0].abs());
    }
    assert!(moved > 0.1, "the crank turns: {moved}");
    // Without a change of the target, the remaining violation disappears.
    for _ in 0..100 {
        ik.step(&mut data, 0.01).unwrap();
    }
    assert!(ik.step(&mut data, 0.01).unwrap().equality_violation() < 1e-9);
}

#[test]
fn an_open_chain_is_closed_by_a_search() {
    let mut data = Data::new(four_bar(r#"<connect body1="rocker" anchor="0 0 -.2"/>"#)).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(
        Task::new(FramePosition::site(&model, "tip").unwrap().with_target([0.3, 0.0, 0.28]))
            .with_weights([1.0, 0.0, 0.0]),
    );
    data.qpos_mut().copy_from_slice(&[0.5, -0.9, 0.1]);
    let outcome = ik.search(&mut data, &SearchOptions::default()).unwrap();
    assert!(outcome.found().is_some(), "{outcome:?}");
    data.forward().unwrap();
    assert!((data.site("tip").unwrap().xpos()[0] - 0.3).abs() < 1e-5);
    assert!(data.efc_pos().iter().all(|value| value.abs() < 1e-5));
}

#[test]
fn coupled_joints_move_together() {
    let mut data = Data::new(four_bar(r#"<joint joint1="rod" joint2="crank" polycoef="0 -1 0 0 0"/>"#)).unwrap();
    let model = data.model().clone();
    let mut ik = Ik::new(&model);
    ik.add_task(Task::new(FramePosition::site(&model, "tip").unwrap().with_target([0.35, 0.0, 0.28])).with_gain(0.3));
    for _ in 0..50 {
        assert!(ik.step(&mut data, 0.01).unwrap().is_solved());
        assert!((data.qpos()[0] + data.qpos()[1]).abs() < 1e-9);
    }
    assert!(data.qpos()[0].abs() > 0.1);
}
