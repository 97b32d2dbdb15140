//! Valid models that overflow the engine's arrays or break its algorithms: they are rejected, or a
//! call returns an error.
#![forbid(unsafe_code)]

use mujoco_safe::data::{NewContact, RayOptions};
use mujoco_safe::{Data, Error, Model};

use crate::is_default;

/// Returns a ball that an adhesion actuator sticks to the floor, with these sizes. The ball starts
/// above the floor, because the engine's compiler makes a step, in which a contact would already
/// need space for its constraints.
fn sticky(njmax: &str) -> String {
    format!(
        r#"<mujoco>
             <size {njmax}/>
             <worldbody>
               <geom name="floor" type="plane" size="1 1 .1"/>
               <body name="ball" pos="0 0 .105"><freejoint/><geom size=".1"/></body>
             </worldbody>
             <actuator><adhesion body="ball" ctrlrange="0 1" gain="10"/></actuator>
           </mujoco>"#
    )
}

#[test]
fn an_adhesion_actuator_with_a_small_constraint_buffer_is_rejected() {
    for njmax in ["njmax='0'", "njmax = \"3\"", "njmax=\" 99 \""] {
        let error = Model::from_xml_str(&sticky(njmax)).unwrap_err();
        assert!(matches!(&error, Error::Load { message, .. } if message.contains("njmax")), "{error}");
    }
}

/// Returns the binary model with another `njmax`, which a binary file can contain although the
/// compiler rejects it in a text.
fn binary_with_njmax(model: &Model, njmax: i32) -> Vec<u8> {
    let mut bytes = model.to_binary().unwrap();
    // The header is four integers long; the sizes follow in the order of the engine's list.
    let table = include_str!("../../mujoco-sys/fields/v2_2_2.tsv");
    let sizes: Vec<&str> =
        table.lines().filter_map(|line| line.strip_prefix("Model\tsize\tint\t")?.split('\t').next()).collect();
    let at = 4 * (4 + sizes.iter().position(|&size| size == "njmax").unwrap());
    assert_eq!(bytes[at..at + 4], (model.njmax() as i32).to_ne_bytes());
    bytes[at..at + 4].copy_from_slice(&njmax.to_ne_bytes());
    bytes
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer engines ignore njmax")]
fn an_adhesion_actuator_with_a_full_constraint_buffer_is_an_error() {
    let model = Model::from_xml_str(&sticky("njmax=\"100\"")).unwrap();
    for njmax in 1..4 {
        let mut data = Data::new(Model::from_binary(&binary_with_njmax(&model, njmax)).unwrap()).unwrap();
        for _ in 0..3 {
            let error = (0..200).find_map(|_| data.step().err()).expect("a contact needs four constraints");
            assert!(error.to_string().contains("constraint buffer is full"), "{error}");
            assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
            data.reset().unwrap();
        }
    }
    assert!(matches!(Model::from_binary(&binary_with_njmax(&model, 0)), Err(Error::InvalidBinary { .. })));
}

#[test]
fn an_adhesion_actuator_with_room_for_its_constraints_works() {
    let mut data = Data::new(Model::from_xml_str(&sticky("njmax=\"100\"")).unwrap()).unwrap();
    data.ctrl_mut()[0] = 1.0;
    for _ in 0..500 {
        data.step().unwrap();
    }
    assert!(data.contacts().next().expect("the ball lies on the floor").force().unwrap().force[0] > 0.0);
    assert_eq!(data.warning(mujoco_safe::data::Warning::ConstraintFull).number, 0);
}

/// Engines since 2.3 remove constraints for which they have no memory, and keep the number of
/// friction losses, whose rows the visualiser would read.
#[test]
#[cfg_attr(not(engine_since = "2.3.0"), ignore = "2.2.2 has a fixed number of constraints")]
fn numbers_of_constraints_without_memory_are_zero() {
    let joint = "<body><joint frictionloss='1'/><geom size='.1' contype='0' conaffinity='0'/></body>";
    let joints = joint.repeat(40);
    let (mut removed, mut kept) = (0, 0);
    for bytes in (4_000..80_000).step_by(400) {
        let xml = format!("<mujoco><size memory='{bytes}'/><worldbody>{joints}</worldbody></mujoco>");
        let Ok(model) = Model::from_xml_str(&xml) else { continue };
        let mut data = Data::new(model).unwrap();
        if data.forward().is_err() {
            continue;
        }
        if data.nefc() == 0 {
            removed += 1;
            assert!(data.warning(mujoco_safe::data::Warning::ConstraintFull).number > 0, "{bytes}");
            assert_eq!(data.nf(), 0, "{bytes}");
        } else {
            kept += 1;
            assert_eq!((data.nefc(), data.nf()), (40, 40), "{bytes}");
        }
    }
    assert!(removed > 0 && kept > 0, "{removed} {kept}");
}

#[test]
fn a_fixed_tendon_with_a_duplicate_joint_is_rejected() {
    let error = Model::from_xml_str(
        r#"<mujoco>
             <worldbody><body><joint name="hinge"/><geom size=".1"/></body></worldbody>
             <tendon>
               <fixed name="twice"><joint joint="hinge" coef="1"/><joint joint="hinge" coef="2"/></fixed>
             </tendon>
           </mujoco>"#,
    )
    .unwrap_err();
    let text = error.to_string();
    assert!(text.contains("the same joint twice"), "{text}");
}

#[test]
fn a_timestep_that_is_not_positive_is_rejected() {
    for timestep in ["0", "-0.01", "nan"] {
        let error = Model::from_xml_str(&format!("<mujoco><option timestep=\"{timestep}\"/></mujoco>")).unwrap_err();
        assert!(error.to_string().contains("timestep"), "{timestep}: {error}");
    }
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers have other composites")]
fn a_model_with_every_element_passes_these_checks() {
    Model::from_xml_path(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml")).unwrap();
}

#[test]
fn a_rangefinder_that_would_read_beyond_a_height_field_is_rejected() {
    for (rows, columns, loads) in [(3, 3, true), (3, 9, true), (9, 3, false)] {
        let xml = format!(
            r#"<mujoco>
                 <asset><hfield name="field" nrow="{rows}" ncol="{columns}" size="1 1 .5 .1"/></asset>
                 <worldbody>
                   <geom type="hfield" hfield="field"/>
                   <site name="eye" pos="3 .9 .2" euler="0 -90 0"/>
                 </worldbody>
                 <sensor><rangefinder site="eye"/></sensor>
               </mujoco>"#
        );
        match Model::from_xml_str(&xml) {
            Ok(model) => {
                assert!(loads, "{rows} x {columns}");
                Data::new(model).unwrap().step().unwrap();
            }
            Err(error) => assert!(!loads && error.to_string().contains("height field"), "{rows} x {columns}: {error}"),
        }
    }
}

/// Returns a height field without heights.
fn field(rows: u32, columns: u32, size: &str) -> String {
    format!(
        r#"<mujoco>
             <asset><hfield name="field" nrow="{rows}" ncol="{columns}" size="{size}"/></asset>
             <worldbody><geom name="field" type="hfield" hfield="field"/></worldbody>
           </mujoco>"#
    )
}

#[test]
fn a_ray_on_a_height_field_of_extreme_size_is_rejected() {
    // Newer compilers reject subnormal numbers.
    let least = if is_default() { 5e-324 } else { f64::MIN_POSITIVE };
    let smallest = format!("{least:e} {least:e} 1 1");
    for (size, point, direction, ok) in [
        ("1e308 1e308 1 1", [0.0, 0.0, 0.5], [0.95, 1.0, 0.0], false),
        (&*smallest, [-least, -1.0, 0.5], [0.0, 1.0, 0.0], false),
        ("1e90 1e90 1 1", [0.0, 0.0, 0.5], [0.95, 1.0, 0.0], true),
        ("1e-90 1e-90 1 1", [-1e-90, -1.0, 0.5], [0.0, 1.0, 0.0], true),
    ] {
        let mut model = Model::from_xml_str(&field(99, 99, size)).unwrap();
        model.edit().hfield_data_mut().fill(1.0);
        let mut data = Data::new(model).unwrap();
        data.forward().unwrap();
        let geom = data.model().geom("field").unwrap().id();
        let found = [
            data.ray(point, direction, &RayOptions::default()).map(drop),
            data.ray_hfield(geom, point, direction).map(drop),
        ];
        for found in found {
            assert!(matches!((&found, ok), (Ok(()), true) | (Err(Error::Unsupported(_)), false)), "{size}: {found:?}");
        }
    }
}

/// Matrix of a pose whose components are so large that their products are infinite, with both
/// signs.
const EXTREME_AXES: [f64; 9] = [1e160, 1e160, 1e160, 1e160, -1e160, -1e160, 0.0, 0.0, 0.0];

#[test]
fn a_ray_on_a_height_field_whose_axes_are_no_rotation_is_rejected() {
    let mut model = Model::from_xml_str(&field(99, 99, "1 1 1 1")).unwrap();
    model.edit().hfield_data_mut().fill(1.0);
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    data.geom_xmat_mut()[0] = EXTREME_AXES;
    let geom = data.model().geom("field").unwrap().id();
    for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.3, 0.0]] {
        let point = [0.5e160, -0.5e160, 0.0];
        assert!(matches!(data.ray(point, direction, &RayOptions::default()), Err(Error::Unsupported(_))));
        assert!(matches!(data.ray_hfield(geom, point, direction), Err(Error::Unsupported(_))));
    }
}

/// A rangefinder that points at a rotated height field.
const RANGEFINDER: &str = r#"<mujoco>
    <asset><hfield name="field" nrow="3" ncol="9" size="1.25 1.75 .5 .1"/></asset>
    <worldbody>
      <geom name="field" type="hfield" hfield="field" quat=".8 .6 0 0"/>
      <site name="eye" pos="3 .9 .2" euler="0 -90 0"/>
    </worldbody>
    <sensor><rangefinder site="eye"/></sensor>
  </mujoco>"#;

#[test]
fn a_rangefinder_on_a_height_field_whose_axes_are_no_rotation_is_an_error() {
    let mut data = Data::new(Model::from_xml_str(RANGEFINDER).unwrap()).unwrap();
    data.step().unwrap();
    data.edit_model(|model| model.geom_quat_mut()[0] = [1e80, 1e80, 0.0, 0.0]).unwrap();
    assert!(matches!(data.step(), Err(Error::Unsupported(_))));
    data.edit_model(|model| model.geom_quat_mut()[0] = [1.0, 0.0, 0.0, 0.0]).unwrap();
    data.forward().unwrap();
    data.geom_xmat_mut()[0] = EXTREME_AXES;
    assert!(matches!(data.sensor_pos(), Err(Error::Unsupported(_))));
}

#[test]
#[cfg_attr(not(validates_binaries), ignore = "binary models load with 2.2.2 and 3.5.0 only")]
fn a_binary_model_whose_rangefinder_would_read_beyond_a_height_field_is_rejected() {
    let mut bytes = Model::from_xml_str(RANGEFINDER).unwrap().to_binary().unwrap();
    Model::from_binary(&bytes).unwrap();
    // The rows and columns are stored after the sizes.
    let sizes: Vec<u8> = [1.25_f64, 1.75, 0.5, 0.1].iter().flat_map(|size| size.to_le_bytes()).collect();
    let at = bytes.windows(sizes.len()).position(|window| window == sizes).unwrap() + sizes.len();
    assert_eq!(bytes[at..at + 8], [3, 0, 0, 0, 9, 0, 0, 0]);
    bytes.swap(at, at + 4);
    let error = Model::from_binary(&bytes).unwrap_err();
    assert!(matches!(&error, Error::InvalidBinary { .. }) && error.to_string().contains("height field"), "{error}");
}

#[test]
fn a_degenerate_box_in_contact_with_a_sphere_or_a_capsule_is_an_error() {
    for other in ["sphere", "capsule"] {
        let model = Model::from_xml_str(&format!(
            r#"<mujoco><worldbody>
                 <geom type="box" size=".1 .1 .1"/>
                 <body><freejoint/><geom type="{other}" size=".05 .05"/></body>
               </worldbody></mujoco>"#
        ));
        let mut data = Data::new(model.unwrap()).unwrap();
        data.forward().unwrap();
        assert!(data.ncon() > 0);
        for size in [0.0, -1.0, 1e-300, f64::NAN, f64::INFINITY] {
            data.reset().unwrap();
            data.edit_model(|model| model.geom_size_mut()[0].fill(size)).unwrap();
            let error = data.forward().unwrap_err();
            assert!(matches!(&error, Error::Engine { message, .. } if message.contains("geom 0, a box")), "{error}");
        }
        data.reset().unwrap();
        data.edit_model(|model| model.geom_size_mut()[0] = [1e-3, 2.0, 1e-12]).unwrap();
        data.forward().unwrap();
    }
}

/// Returns a free body with two overlapping geoms. Its inertia is given, because an inertia frame
/// that is computed from the geoms can differ from the body frame in the last bit.
fn body_of_two_geoms(rest: &str) -> String {
    format!(
        r#"<mujoco><option jacobian="sparse" solver="PGS"/><size njmax="12"/><worldbody>
             <body name="b"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom name="one" size=".1" pos="0 0 .05"/><geom name="other" size=".1" pos="0 0 -.05"/></body>
           </worldbody>{rest}</mujoco>"#
    )
}

#[test]
fn two_geoms_of_one_body_make_no_contact_in_a_sparse_jacobian() {
    let pair = r#"<pair geom1="one" geom2="other" condim="6"/>"#;
    let model = Model::from_xml_str(&body_of_two_geoms(&format!("<contact>{pair}</contact>"))).unwrap();
    // The body frame coincides with the inertia frame.
    assert_eq!(model.body_simple(), [1, 1]);
    let mut data = Data::new(model).unwrap();
    for _ in 0..10 {
        data.step().unwrap();
        assert!(data.efc_J_rownnz().iter().all(|&count| count as usize <= data.model().nv()));
    }
}

#[test]
fn adding_a_contact_between_two_geoms_of_one_body_is_an_error() {
    let mut data = Data::new(Model::from_xml_str(&body_of_two_geoms("")).unwrap()).unwrap();
    data.forward().unwrap();
    let geoms = ["one", "other"].map(|geom| data.model().geom(geom).unwrap().id());
    let error = data.add_contact(&NewContact::new(geoms, 0.0, [0.0; 3], [0.0, 0.0, 1.0])).unwrap_err();
    assert!(matches!(&error, Error::Invalid { what, .. } if what == "the geoms of a new contact"), "{error}");
}

#[test]
fn colliding_geoms_with_an_invalid_pose_is_an_error() {
    let model = Model::from_xml_str(
        r#"<mujoco><worldbody>
             <body><freejoint/><geom type="ellipsoid" size=".1 .2 .3"/></body>
             <body pos=".1 0 0"><freejoint/><geom type="cylinder" size=".1 .2"/></body>
           </worldbody></mujoco>"#,
    );
    let mut data = Data::new(model.unwrap()).unwrap();
    data.forward().unwrap();
    assert!(data.ncon() > 0);
    for value in [0.0, 2.0, 1e200, f64::NAN] {
        data.reset().unwrap();
        data.kinematics().unwrap();
        data.geom_xmat_mut()[1].fill(value);
        let error = data.collision().unwrap_err();
        assert!(matches!(&error, Error::Engine { message, .. } if message.contains("geom 1")), "{error}");
    }
    data.reset().unwrap();
    data.step().unwrap();
}

/// The box and its pose come from a call sequence on which libccd did not terminate.
#[test]
fn a_box_of_a_million_kilometres_on_a_height_field_is_an_error() {
    let model = Model::from_xml_str(
        r#"<mujoco><asset><hfield name="field" nrow="3" ncol="3" size="1 1 .15 .1"/></asset>
           <worldbody>
             <geom type="hfield" hfield="field"/>
             <body pos="0 .507 0"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
           </worldbody></mujoco>"#,
    );
    let mut data = Data::new(model.unwrap()).unwrap();
    data.step().unwrap();
    for size in [1e9, 1e300, f64::INFINITY] {
        data.reset().unwrap();
        data.edit_model(|model| model.geom_size_mut()[1][0] = size).unwrap();
        data.kinematics().unwrap();
        data.com_pos().unwrap();
        data.geom_xmat_mut()[1] = [
            0.529_291_306,
            -0.444_831_229,
            0.722_478_991,
            -0.173_859_884,
            0.776_602_487,
            0.605_525_654,
            -0.830_435_702,
            -0.446_109_578,
            0.333_710_639,
        ];
        let error = data.collision().unwrap_err();
        assert!(matches!(&error, Error::Engine { message, .. } if message.contains("size of geom 1")), "{error}");
    }
}

#[test]
#[cfg(all(validates_binaries, engine_since = "3.5.0"))]
fn several_contact_points_are_not_enabled_for_a_binary_model_with_large_polygons() {
    use mujoco_safe::model::EnableFlags;

    let corners = (0..12).map(|i| f64::from(i) * std::f64::consts::TAU / 12.0);
    let ring: Vec<String> = corners.map(|angle| format!("{} {}", angle.cos(), angle.sin())).collect();
    let vertices: Vec<String> =
        ["0", "1"].iter().flat_map(|z| ring.iter().map(move |xy| format!("{xy} {z}"))).collect();
    let compiled = Model::from_xml_str(&format!(
        "<mujoco><asset><mesh name='m' vertex='{}'/></asset>
         <worldbody><body><freejoint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>",
        vertices.join(" ")
    ))
    .unwrap();
    let enable = |model: &mut Model| model.edit().edit_options(|options| options.enable |= EnableFlags::MULTICCD);
    let loaded = Model::from_binary(&compiled.to_binary().unwrap()).unwrap();
    for mut model in [loaded.try_clone().unwrap(), loaded] {
        assert!(matches!(enable(&mut model), Err(Error::Unsupported(_))));
        assert_eq!(model.to_binary().unwrap(), compiled.to_binary().unwrap());
    }
    let mut compiled = compiled;
    enable(&mut compiled).unwrap();
    assert!(matches!(Model::from_binary(&compiled.to_binary().unwrap()), Err(Error::Unsupported(_))));
}

#[test]
#[cfg(all(engine_since = "3.3.3", not(engine_since = "3.8.0")))]
fn many_iterations_of_the_collider_are_rejected_with_sensors_of_distances() {
    let text = |iterations: u32| {
        format!(
            r#"<mujoco><option ccd_iterations="{iterations}"/><worldbody><geom name="a" type="ellipsoid" size=".1 .2 .3"/>
            <body pos="0 0 1"><freejoint/><geom name="b" type="box" size=".1 .1 .1"/></body></worldbody>
            <sensor><distance geom1="a" geom2="b" cutoff="2"/></sensor></mujoco>"#
        )
    };
    let mut model = Model::from_xml_str(&text(170)).unwrap();
    let error = Model::from_xml_str(&text(171)).unwrap_err();
    assert!(error.to_string().contains("at most 170"), "{error}");
    let edit = model.edit().edit_options(|options| options.mpr_iterations = 171);
    assert!(matches!(edit, Err(Error::Unsupported(_))));
    Data::new(model).unwrap().step().unwrap();
}
