//! Functions of newer engines. The independent sources are the C functions of the same engine where
//! it has them, and mathematics.

use mujoco_safe::data::{FlexRayOptions, Interpolation};
use mujoco_safe::{Data, Error, Model, StateSpec, Version, built_against};

#[cfg(engine_since = "3.2.5")]
use mujoco_safe::sys;

/// A chain of every type of joint, a second tree, and a fixed body.
const CHAIN: &str = r#"<mujoco>
  <worldbody>
    <body name="base" pos=".1 .2 .3"><freejoint/><geom size=".1" pos=".1 0 0"/>
      <body name="ball" pos=".3 0 .1"><joint type="ball" pos="0 .1 0"/><geom size=".05" pos=".2 .1 0"/>
        <body name="arm" pos=".2 .1 0"><joint axis="1 2 3" pos=".1 0 0"/><joint type="slide" axis="0 1 1"/><geom size=".05"/>
          <body name="tip" pos="0 0 .2"><geom size=".02"/></body></body></body></body>
    <body name="other" pos="0 2 0"><joint axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body>
    <body name="fixed" pos="0 -2 0"><geom size=".1"/></body>
  </worldbody>
</mujoco>"#;

fn moving() -> Data {
    let mut data = Data::new(Model::from_xml_str(CHAIN).unwrap()).unwrap();
    let nv = data.model().nv();
    let velocity: Vec<f64> = (0..nv).map(|dof| f64::sin(1.0 + dof as f64)).collect();
    data.integrate_pos(&velocity, 0.7).unwrap();
    data.qvel_mut().copy_from_slice(&velocity);
    data.forward().unwrap();
    data
}

#[test]
fn the_rate_of_a_jacobian_is_its_difference_along_the_motion() {
    /// Step of the central difference, s: errors of 1e-10 from the truncation and from rounding.
    const STEP: f64 = 1e-5;
    let data = moving();
    let velocity = data.qvel().to_vec();
    for body in ["base", "ball", "arm", "tip", "other", "fixed", "world"] {
        let local = [0.1, -0.2, 0.05];
        let at = |time: f64| {
            let mut data = data.clone();
            data.integrate_pos(&velocity, time).unwrap();
            data.forward().unwrap();
            let (point, _) = data.local_to_global(local, [1.0, 0.0, 0.0, 0.0], body).unwrap();
            (point, data.jac(point, body).unwrap())
        };
        let (point, _) = at(0.0);
        let rate = data.jac_dot(point, body).unwrap();
        let (before, after) = (at(-STEP).1, at(STEP).1);
        for (rate, before, after) in
            [(&rate.linear, &before.linear, &after.linear), (&rate.angular, &before.angular, &after.angular)]
        {
            for ((rate, before), after) in rate.as_slice().iter().zip(before.as_slice()).zip(after.as_slice()) {
                let expected = (after - before) / (2.0 * STEP);
                assert!((rate - expected).abs() < 1e-8, "{body}: {rate} {expected}");
            }
        }
        let is_still = ["fixed", "world"].contains(&body);
        assert_eq!(rate.linear.as_slice().iter().all(|rate| *rate == 0.0), is_still, "{body}");
    }
}

/// The function of earlier engines disagrees with the differences in the test above.
#[cfg(engine_since = "3.3.1")]
#[test]
fn the_rate_of_a_jacobian_equals_that_of_the_engine() {
    let data = moving();
    let (model, nv) = (data.model(), data.model().nv());
    let point = [0.3, -0.1, 0.7];
    for body in 0..model.nbody() {
        let (mut linear, mut angular) = (vec![0.0; 3 * nv], vec![0.0; 3 * nv]);
        let (jacp, jacr) = (linear.as_mut_ptr(), angular.as_mut_ptr());
        c!(mj_jacDot(model.as_ptr(), data.as_ptr(), jacp, jacr, point.as_ptr(), body as i32));
        let rate = data.jac_dot(point, body).unwrap();
        let ours = rate.linear.as_slice().iter().chain(rate.angular.as_slice());
        for (ours, theirs) in ours.zip(linear.iter().chain(&angular)) {
            assert!((ours - theirs).abs() < 1e-14, "{body}: {ours} {theirs}");
        }
    }
}

#[test]
fn the_rate_of_a_jacobian_needs_velocities_and_matching_shapes() {
    let mut data = Data::new(Model::from_xml_str(CHAIN).unwrap()).unwrap();
    data.fwd_position().unwrap();
    assert!(matches!(data.jac_dot([0.0; 3], "tip"), Err(Error::NotComputed { .. })));
    data.fwd_velocity().unwrap();
    let mut wrong = mujoco_safe::Matrix::zeros(3, 1);
    assert!(matches!(data.jac_dot_into([0.0; 3], "tip", Some(&mut wrong), None), Err(Error::Shape { .. })));
    assert!(matches!(data.jac_dot([0.0; 3], "hand"), Err(Error::NoSuchName { .. })));
    assert!(matches!(data.jac_dot([0.0; 3], 99), Err(Error::NoSuchIndex { .. })));
}

const SITES: &str = r#"<mujoco>
  <worldbody>
    <body pos="1 2 3" euler="0 0 90"><joint/><geom size=".1"/>
      <site name="sphere" size=".1"/><site name="box" type="box" size=".1 .2 .3"/>
      <site name="capsule" type="capsule" size=".1 .2"/><site name="cylinder" type="cylinder" size=".1 .2"/>
      <site name="ellipsoid" type="ellipsoid" size=".1 .2 .3"/></body>
  </worldbody>
</mujoco>"#;

#[test]
fn points_are_inside_of_sites_by_their_equations() {
    let mut data = Data::new(Model::from_xml_str(SITES).unwrap()).unwrap();
    if built_against() < (Version { major: 3, minor: 13, patch: 0 }) {
        data.forward().unwrap();
        let error = data.inside_site("box", [1.0, 2.0, 3.0]).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)) && error.to_string().contains("3.13.0"), "{error}");
        return;
    }
    assert!(matches!(data.inside_site("box", [0.0; 3]), Err(Error::NotComputed { .. })));
    data.forward().unwrap();
    let mut inside = 0;
    for index in 0..500 {
        let random = |axis: u32| (f64::from((index + 1) * (axis + 7) * 7919 % 1000) / 1000.0 - 0.5) * 0.8;
        let [x, y, z] = [random(0), random(1), random(2)];
        // The frame is turned by 90° about z.
        let point = [1.0 - y, 2.0 + x, 3.0 + z];
        let radius = x.hypot(y);
        for (site, expected) in [
            ("sphere", radius.hypot(z) < 0.1),
            ("box", x.abs() < 0.1 && y.abs() < 0.2 && z.abs() < 0.3),
            ("capsule", radius.hypot((z.abs() - 0.2).max(0.0)) < 0.1),
            ("cylinder", radius < 0.1 && z.abs() < 0.2),
            ("ellipsoid", (x / 0.1).powi(2) + (y / 0.2).powi(2) + (z / 0.3).powi(2) < 1.0),
        ] {
            assert_eq!(data.inside_site(site, point).unwrap(), expected, "{site} {x} {y} {z}");
            inside += u32::from(expected);
        }
    }
    assert!(inside > 50, "{inside}");
    assert!(!data.inside_site("box", [f64::NAN; 3]).unwrap());
}

#[test]
fn parts_of_states_are_copied_and_extracted() {
    let mut data = moving();
    data.step_n(3).unwrap();
    let all = StateSpec::INTEGRATION;
    let saved = data.state(all);
    for part in
        [StateSpec::QVEL, StateSpec::TIME | StateSpec::XFRC_APPLIED, StateSpec::PHYSICS, StateSpec::empty(), all]
    {
        assert_eq!(data.model().extract_state(&saved, all, part).unwrap(), data.state(part), "{part:?}");
    }
    let model = data.model();
    let error = model.extract_state(&data.state(StateSpec::QPOS), StateSpec::QPOS, StateSpec::QVEL).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    assert!(matches!(model.extract_state(&[0.0], all, StateSpec::QPOS), Err(Error::Shape { .. })));

    let mut twin = Data::new(data.model().clone()).unwrap();
    twin.copy_state(&data, StateSpec::QVEL).unwrap();
    assert_eq!((twin.qvel(), twin.time()), (data.qvel(), 0.0));
    assert_ne!(twin.qpos(), data.qpos());
    twin.copy_state(&data, all).unwrap();
    assert_eq!(twin.state(all), saved);
    let mut other = Data::new(Model::from_xml_str(CHAIN).unwrap()).unwrap();
    assert!(matches!(other.copy_state(&data, all), Err(Error::OtherModel { .. })));
}

#[test]
fn controls_are_reset_to_neutral_values() {
    let quaternion = if cfg!(engine_since = "3.12.0") { r#"<orientation joint="ball"/>"# } else { "" };
    let text = format!(
        r#"<mujoco><worldbody><body><joint name="ball" type="ball"/><geom size=".1"/></body>
             <body><joint name="hinge"/><geom size=".1"/></body></worldbody>
           <actuator><motor joint="hinge"/>{quaternion}<motor joint="hinge"/></actuator></mujoco>"#
    );
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    data.ctrl_mut().fill(0.3);
    data.reset_ctrl();
    let expected: &[f64] = match data.model().nu() {
        2 => &[0.0; 2],
        6 => &[0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        5 => &[0.0; 5],
        controls => panic!("{controls} controls"),
    };
    assert_eq!(data.ctrl(), expected);
    #[cfg(engine_since = "3.11.0")]
    {
        let raw = super::Raw(c!(mj_makeData(data.model().as_ptr())));
        c!(mj_resetCtrl(data.model().as_ptr(), raw.0));
        // SAFETY: the array has nu numbers.
        assert_eq!(data.ctrl(), unsafe { std::slice::from_raw_parts((*raw.0).ctrl, data.model().nu()) });
    }
    for actuator in data.model().actuators() {
        for input in actuator.controls().enumerate().map(|(input, _)| input) {
            let name = actuator.input_name(input);
            #[cfg(engine_since = "3.11.0")]
            {
                let expected = c!(mj_actuatorInputName(data.model().as_ptr(), actuator.index() as i32, input as i32));
                // SAFETY: NULL or a constant string of the engine.
                let expected = (!expected.is_null()).then(|| unsafe { std::ffi::CStr::from_ptr(expected) });
                assert_eq!(name, expected.map(|name| name.to_str().unwrap()));
            }
            #[cfg(not(engine_since = "3.11.0"))]
            assert_eq!(name, None);
        }
    }
}

#[test]
#[should_panic(expected = "input 1 of actuator 0 'slide', which has 1")]
fn an_input_that_the_actuator_lacks_panics() {
    mujoco_safe::sample::cartpole().actuators().next().unwrap().input_name(1);
}

#[test]
fn an_element_without_a_buffer_has_its_present_values_at_all_times() {
    let text = r#"<mujoco><worldbody><body><joint name="a"/><geom size=".1" pos=".1 0 0"/></body></worldbody>
        <actuator><motor joint="a"/></actuator><sensor><jointpos joint="a"/></sensor></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.ctrl_mut()[0] = 0.4;
    let mut value = [0.0];
    assert!(matches!(data.read_sensor_into(0, 0.0, None, &mut value), Err(Error::NotComputed { .. })));
    data.qpos_mut()[0] = 0.2;
    data.forward().unwrap();
    for time in [-1.0, 0.0, 5.0, f64::INFINITY] {
        data.read_ctrl_into(0, time, Some(Interpolation::Cubic), &mut value).unwrap();
        assert_eq!(value, [0.4]);
        data.read_sensor_into(0, time, None, &mut value).unwrap();
        assert_eq!(value, [0.2]);
    }
    assert!(matches!(data.read_ctrl_into(0, f64::NAN, None, &mut value), Err(Error::Invalid { .. })));
    assert!(matches!(data.read_ctrl_into(0, 0.0, None, &mut [0.0; 2]), Err(Error::Shape { .. })));
    assert!(matches!(data.read_ctrl_into(1, 0.0, None, &mut value), Err(Error::NoSuchIndex { .. })));
    assert!(matches!(data.init_ctrl_history(0, &[0.0], &[1.0]), Err(Error::Shape { .. })));
    data.init_ctrl_history(0, &[], &[]).unwrap();
}

#[test]
fn flexes_are_hit_by_rays_with_engines_that_have_flexes() {
    let mut data = Data::new(mujoco_safe::sample::cartpole()).unwrap();
    data.forward().unwrap();
    let options = FlexRayOptions::default();
    let error = data.ray_flex("cloth", [0.0; 3], [0.0, 0.0, -1.0], &options).unwrap_err();
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
    if !cfg!(engine_since = "3.0.0") {
        return;
    }
    let text = r#"<mujoco><worldbody>
        <flexcomp name="cloth" type="grid" count="5 5 1" spacing=".1 .1 .1" pos="0 0 1" dim="2" radius="0.01" mass="0.2"/>
      </worldbody></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    let down = [0.0, 0.0, -2.0];
    assert!(matches!(data.ray_flex("cloth", [0.0, 0.0, 2.0], down, &options), Err(Error::NotComputed { .. })));
    data.forward().unwrap();
    // The middle vertex is the highest point of the spheres around the vertices, 1 cm above.
    let hit = data.ray_flex("cloth", [0.0, 0.0, 2.0], down, &options).unwrap().unwrap();
    assert!((hit.distance - 0.495).abs() < 1e-9, "{hit:?}");
    assert_eq!(hit.vertex, 12);
    // Between the vertices, the faces.
    let faces = FlexRayOptions::default().with_vertices(false).with_edges(false);
    let hit = data.ray_flex("cloth", [0.12, 0.16, 2.0], down, &faces).unwrap().unwrap();
    assert!((hit.distance - 0.5).abs() < 0.006, "{hit:?}");
    assert_eq!(data.ray_flex("cloth", [3.0, 0.0, 2.0], down, &options).unwrap(), None);
    assert!(matches!(data.ray_flex("cloth", [0.0; 3], [0.0; 3], &options), Err(Error::Invalid { .. })));

    // Every combination of parts of a rope, a cloth and a block.
    let text = text.replace(
        "</worldbody>",
        r#"<flexcomp name="rope" type="grid" count="5 1 1" spacing=".1 .1 .1" pos="0 0 .5" dim="1" radius="0.01" mass="0.2"/>
           <flexcomp name="block" type="grid" count="4 4 4" spacing=".1 .1 .1" pos="0 0 0" dim="3" radius="0.01" mass="0.2"/>
        </worldbody>"#,
    );
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    data.forward().unwrap();
    for flex in ["cloth", "rope", "block"] {
        let mut hits = 0;
        for (parts, layer) in (0..16).flat_map(|parts| [0, 1, 2, u16::MAX].map(|layer| (parts, layer))) {
            let options = FlexRayOptions::default()
                .with_layer(layer)
                .with_vertices(parts & 1 != 0)
                .with_edges(parts & 2 != 0)
                .with_faces(parts & 4 != 0)
                .with_skin(parts & 8 != 0);
            for x in [-0.15, 0.0, 0.05, 1e300] {
                let hit =
                    data.ray_flex(flex, [x, 0.05 * f64::from(u8::from(flex == "block")), 3.0], down, &options).unwrap();
                hits += u32::from(hit.is_some_and(|hit| hit.distance < 2.0 && hit.vertex < 64));
            }
        }
        assert!(hits > 8, "{flex}: {hits}");
    }
}
