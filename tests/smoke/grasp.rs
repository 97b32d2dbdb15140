//! Equality constraints at the present pose. The independent sources are the engine's residuals of
//! the constraints, products of rotations, and models that are compiled with the pose.

use std::sync::Arc;

use mujoco_safe::{Data, Error, Model, StateSpec};

/// Two free bodies, a mocap body and a joint, without gravity; `attributes` are those of the weld.
fn text(attributes: &str, gravity: &str) -> String {
    format!(
        r#"<mujoco>
  <option gravity="0 0 {gravity}"/>
  <worldbody>
    <body name="a" pos="1 0 0" euler="0 0 30"><freejoint/><geom size=".1" contype="0"/><site name="p"/></body>
    <body name="b" pos="0 1 .5" euler="40 0 0"><freejoint/><geom size=".1" contype="0"/><site name="q"/></body>
    <body name="hand" mocap="true" pos="2 2 2"/>
    <body pos="0 3 0"><joint name="j"/><joint name="k" axis="0 1 0"/><geom size=".1" pos=".1 0 0"/></body>
  </worldbody>
  <equality>
    <weld name="weld" body1="a" body2="b" {attributes}/>
    <connect name="connect" body1="b" body2="a" anchor=".1 .2 .3" active="false"/>
    <weld name="hold" body1="hand" body2="a" active="false"/>
    <weld name="world" body1="b" active="false"/>
    <joint name="joint" joint1="j" joint2="k"/>
  </equality>
</mujoco>"#
    )
}

/// Returns a simulation in which the bodies have moved from their reference poses.
fn moved(attributes: &str, gravity: &str) -> Data {
    let mut data = Data::new(Model::from_xml_str(&text(attributes, gravity)).unwrap()).unwrap();
    let velocity: Vec<f64> = (0..data.model().nv()).map(|dof| f64::sin(3.0 * dof as f64)).collect();
    data.integrate_pos(&velocity, 0.9).unwrap();
    data.qvel_mut().fill(0.0);
    data
}

/// Returns the pose of a body in the frame of another one: the position, and the matrix.
fn relative(data: &Data, first: &str, second: &str) -> ([f64; 3], [f64; 9]) {
    let (first, second) = (data.body(first).unwrap(), data.body(second).unwrap());
    let (rotation, other) = (first.xmat(), second.xmat());
    let offset = [0, 1, 2].map(|axis| second.xpos()[axis] - first.xpos()[axis]);
    // The product with the transpose of the first rotation.
    let position = [0, 1, 2].map(|column| (0..3).map(|row| rotation[3 * row + column] * offset[row]).sum());
    let matrix =
        std::array::from_fn(|index| (0..3).map(|row| rotation[3 * row + index / 3] * other[3 * row + index % 3]).sum());
    (position, matrix)
}

fn assert_near(one: &[f64], other: &[f64], tolerance: f64) {
    for (one, other) in one.iter().zip(other) {
        assert!((one - other).abs() < tolerance, "{one} {other}");
    }
}

/// Returns the residuals of the active constraints of bodies.
fn residuals(data: &mut Data) -> Vec<f64> {
    data.forward().unwrap();
    data.efc_pos()[..data.ne()].to_vec()
}

#[test]
fn a_constraint_at_the_present_pose_has_no_residual() {
    for attributes in
        ["", r#"active="false""#, r#"torquescale=".5" anchor=".4 .5 .6""#, r#"relpose="1 2 3 .5 .5 .5 .5""#]
    {
        for (name, rows) in [("weld", 6), ("connect", 3), ("hold", 6), ("world", 6)] {
            // Versions differ in attributes of welds.
            let Ok(_) = Model::from_xml_str(&text(attributes, "0")) else { continue };
            let mut data = moved(attributes, "0");
            data.set_equality_active("joint", false).unwrap();
            data.set_equality_active("weld", false).unwrap();
            assert_eq!(residuals(&mut data).len(), 0);
            let before = data.model().eq_data().to_vec();
            let index = data.model().equality(name).unwrap().index();
            data.weld_at_present_pose(name).unwrap();
            assert!(matches!(data.require(mujoco_safe::Stage::Position), Err(Error::NotComputed { .. })));
            assert!(data.equality(name).unwrap().active() && data.model().equality(name).unwrap().active());
            let residuals = residuals(&mut data);
            assert_eq!(residuals.len(), rows, "{name}");
            assert!(residuals.iter().all(|residual| residual.abs() < 1e-12), "{name} {attributes}: {residuals:?}");
            // The anchor and the scale of torques stay; so do the other constraints.
            let after = data.model().eq_data();
            assert_eq!((&after[index][..3], after[index][10]), (&before[index][..3], before[index][10]));
            assert_ne!(after[index], before[index]);
            for other in (0..before.len()).filter(|other| *other != index) {
                assert_eq!(after[other], before[other]);
            }
        }
    }
}

#[test]
fn a_weld_at_the_present_pose_holds_it() {
    let mut data = moved(r#"active="false""#, "0");
    data.forward().unwrap();
    let (position, rotation) = relative(&data, "a", "b");
    data.weld_at_present_pose("weld").unwrap();
    data.joint_mut(0).unwrap().qvel_mut().copy_from_slice(&[0.1, -0.2, 0.3, 0.2, 0.1, -0.3]);
    for _ in 0..1000 {
        data.step().unwrap();
    }
    data.forward().unwrap();
    let (now, turned) = relative(&data, "a", "b");
    assert_near(&now, &position, 1e-3);
    assert_near(&turned, &rotation, 1e-3);

    // Released, the bodies separate.
    data.set_equality_active("weld", false).unwrap();
    assert!(!data.equality("weld").unwrap().active());
    data.joint_mut(0).unwrap().qvel_mut()[0] += 1.0;
    data.step_n(200).unwrap();
    data.forward().unwrap();
    let distance: f64 = relative(&data, "a", "b").0.iter().zip(position).map(|(a, b)| (a - b).abs()).sum();
    assert!(distance > 0.1, "{distance}");
}

#[test]
fn a_weld_to_a_mocap_body_holds_the_pose_of_the_present_state() {
    let mut data = moved(r#"active="false""#, "-9.81");
    // The poses of the last forward are other ones.
    data.forward().unwrap();
    data.mocap_pos_mut()[0] = [0.3, 0.2, 0.1];
    data.mocap_quat_mut()[0] = [0.8, 0.0, 0.6, 0.0];
    data.joint_mut(0).unwrap().qpos_mut()[..3].copy_from_slice(&[0.5, 0.5, 0.5]);
    data.weld_at_present_pose("hold").unwrap();
    data.forward().unwrap();
    let (position, _) = relative(&data, "hand", "a");
    assert!(data.efc_pos()[..6].iter().all(|residual| residual.abs() < 1e-12));
    for _ in 0..300 {
        data.mocap_pos_mut()[0][0] += 1e-4;
        data.step().unwrap();
    }
    data.forward().unwrap();
    // The constraint is soft: gravity pulls the body down by less than a millimetre.
    assert_near(&relative(&data, "hand", "a").0, &position, 2e-3);
}

#[test]
fn a_weld_at_the_present_pose_is_that_of_a_model_compiled_with_it() {
    let mut data = moved("", "-9.81");
    data.weld_at_present_pose("weld").unwrap();
    let numbers = data.model().equality("weld").unwrap().data()[3..10].iter().map(f64::to_string).collect::<Vec<_>>();
    let compiled = Model::from_xml_str(&text(&format!(r#"relpose="{}""#, numbers.join(" ")), "-9.81")).unwrap();
    let mut twin = Data::new(compiled).unwrap();
    twin.set_state(StateSpec::INTEGRATION, &data.state(StateSpec::INTEGRATION)).unwrap();
    for _ in 0..100 {
        data.step().unwrap();
        twin.step().unwrap();
    }
    assert_near(data.qpos(), twin.qpos(), 1e-9);

    // The derived constants keep the pose.
    data.edit_model(|model| model.update_constants()).unwrap();
    let kept = data.model().equality("weld").unwrap().data()[..11].to_vec();
    assert_near(&kept, &twin.model().equality("weld").unwrap().data()[..11], 1e-12);
}

#[test]
fn other_simulations_of_the_model_do_not_change() {
    let model = Arc::new(Model::from_xml_str(&text(r#"active="false""#, "0")).unwrap());
    let (mut data, other) = (Data::new(model.clone()).unwrap(), Data::new(model.clone()).unwrap());
    let before = model.eq_data().to_vec();
    data.joint_mut(0).unwrap().qpos_mut()[0] = 3.0;
    data.weld_at_present_pose("weld").unwrap();
    assert_eq!(model.eq_data(), before);
    assert!(!other.equality("weld").unwrap().active() && !model.equality("weld").unwrap().active());
    // The grasp remains after a reset.
    data.reset().unwrap();
    assert!(data.equality("weld").unwrap().active());
}

#[test]
fn constraints_without_a_relative_pose_of_bodies_are_errors() {
    let mut data = moved("", "0");
    let error = data.weld_at_present_pose("joint").unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    assert!(error.to_string().contains("equality 'joint'") && error.to_string().contains("Weld"), "{error}");
    assert!(matches!(data.weld_at_present_pose("none"), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.set_equality_active(17, true), Err(Error::NoSuchIndex { .. })));
    let before = data.model().eq_data().to_vec();
    data.mocap_pos_mut()[0][1] = f64::INFINITY;
    let error = data.weld_at_present_pose("hold").unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    data.qpos_mut()[0] = f64::NAN;
    let error = data.weld_at_present_pose("weld").unwrap_err();
    assert!(matches!(error, Error::Unstable { .. }), "{error}");
    assert_eq!(data.model().eq_data(), before);
    if cfg!(engine_since = "3.2.5") {
        let text = text("", "0").replace("<equality>", r#"<equality><weld name="sites" site1="p" site2="q"/>"#);
        let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
        let error = data.weld_at_present_pose("sites").unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)) && error.to_string().contains("sites coincide"), "{error}");
    }
}
