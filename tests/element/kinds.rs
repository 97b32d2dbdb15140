//! The views of each kind against the numbers and names of the XML: assets, custom fields,
//! constraints, and the engine's types and ids.

use mujoco_safe::element::{EqualityObjects, Object, Transmission, Wrap, WrapPoint};
use mujoco_safe::enums::{
    ActuatorBias, ActuatorDynamics, ActuatorGain, CameraMode, EqualityType, SameFrame, SensorDataType, SensorType,
    TextureType,
};
use mujoco_safe::id::JointId;
use mujoco_safe::{Data, Error, Stage};

use crate::every_element;

#[test]
fn custom_numerics_texts_and_tuples_are_those_of_the_xml() {
    let model = every_element();
    assert_eq!(model.numeric("gains").unwrap().data(), [1.0, 2.0, 3.5]);
    assert_eq!(model.numeric("reserved").unwrap().data(), [7.0, 0.0, 0.0, 0.0]);
    assert_eq!(model.text("note").unwrap().data(), "every kind of element");
    assert_eq!(model.text("unit").unwrap().bytes(), b"metre");
    let parts = model.tuple("parts").unwrap();
    assert_eq!(parts.objprm(), [0.5, 0.0, 0.0, 0.0, 0.0]);
    let expected = [
        Object::Body(model.body("chain_0").unwrap().id()),
        Object::Geom(model.geom("ball").unwrap().id()),
        Object::Site(model.site("tip").unwrap().id()),
        Object::Actuator(model.actuator("motor").unwrap().id()),
        Object::Tendon(model.tendon("cable").unwrap().id()),
    ];
    assert!(parts.objects().eq(expected));
    assert_eq!(parts.objects().len(), 5);
    let nested: Vec<Object> = model.tuple("nested").unwrap().objects().collect();
    assert_eq!(nested[0], Object::Tuple(parts.id()));
    assert_eq!(nested[4], Object::HeightField(model.height_field("ground").unwrap().id()));
    assert_eq!(nested[14], Object::Equality(model.equality("geared").unwrap().id()));
    assert_eq!(nested[15], Object::XBody(model.body("branch").unwrap().id()));
}

// Binary models load with 2.2.2 and 3.5.0 only.
#[cfg(validates_binaries)]
#[test]
fn text_that_is_not_utf8_is_readable() {
    let mut file = every_element().to_binary().unwrap();
    let at = file.windows(6).position(|bytes| bytes == b"metre\0").unwrap();
    file[at + 1] = 0xE8; // è in Latin-1
    let model = mujoco_safe::Model::from_binary(&file).unwrap();
    let unit = model.text("unit").unwrap();
    assert_eq!(unit.bytes(), b"m\xE8tre");
    assert_eq!(unit.data(), "m\u{FFFD}tre");
}

#[test]
fn meshes_have_their_own_vertices_and_faces() {
    let model = every_element();
    let tetra = model.mesh("tetra").unwrap();
    assert_eq!((tetra.vert().len(), tetra.normal().len(), tetra.texcoord().len(), tetra.face().len()), (4, 4, 4, 4));
    assert_eq!(tetra.texcoord(), [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let wedge = model.mesh("wedge").unwrap();
    assert_eq!(wedge.vert().len(), 6);
    assert!(wedge.texcoord().is_empty());
    // The compiler centres and rotates a mesh, which preserves the lengths of its edges.
    let length =
        |one: [f32; 3], other: [f32; 3]| one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt();
    assert!((length(tetra.vert()[0], tetra.vert()[1]) - 0.15).abs() < 1e-6);
    assert!((length(wedge.vert()[0], wedge.vert()[1]) - 0.2).abs() < 1e-6);
    for mesh in model.meshes() {
        assert!(mesh.face().iter().flatten().all(|corner| (*corner as usize) < mesh.vert().len()), "{mesh:?}");
        if let Some(graph) = mesh.graph() {
            assert!(graph[0] as usize <= mesh.vert().len(), "{mesh:?}");
        }
    }
    assert!(tetra.graph().is_some());
    assert_eq!(model.geom("tetra_geom").unwrap().mesh(), Some(tetra.id()));
    assert_eq!(model.geom("fitted_geom").unwrap().mesh(), None, "a box that was fitted to a mesh is a box");
}

#[test]
fn skins_have_bones_with_vertices_and_weights() {
    let model = every_element();
    let sheet = model.skin("sheet").unwrap();
    assert_eq!(sheet.material(), Some(model.material("painted").unwrap().id()));
    assert_eq!((sheet.inflate(), sheet.group(), sheet.vert().len()), (0.01, 2, 6));
    assert_eq!(sheet.face(), [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]);
    assert_eq!(sheet.bonebindpos()[1], [0.0, 0.2, 0.0]);
    let bones: Vec<_> = sheet.bones().collect();
    assert_eq!(bones.len(), 2);
    assert_eq!(bones[1].body, model.body("chain_1").unwrap().id());
    assert_eq!(bones[1].vertid, [2, 3, 4, 5]);
    assert_eq!(bones[1].vertweight, [0.5, 0.5, 1.0, 1.0]);
    assert_eq!(sheet.bonevertweight(), [1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 1.0, 1.0]);
    assert!(model.skin(1).unwrap().texcoord().is_empty());
}

#[test]
fn height_fields_are_rows_of_elevations() {
    let mut model = every_element();
    let mut edit = model.edit();
    edit.height_field_mut("second").unwrap().data_mut().copy_from_slice(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
    let second = model.height_field("second").unwrap();
    assert_eq!((second.nrow(), second.ncol(), second.size()), (2, 3, &[0.2, 0.2, 0.1, 0.05]));
    assert_eq!(
        (second.data()[2], second.data()[second.ncol()]),
        (0.2, 0.3),
        "the last of a row, the first of the next"
    );
    let ground = model.height_field("ground").unwrap();
    assert_eq!((ground.nrow(), ground.ncol(), ground.data().len()), (7, 9, 63));
    assert!(ground.data().iter().all(|height| *height == 0.0), "the neighbour is unchanged");
    let hills = model.geom("hills").unwrap();
    assert_eq!((hills.height_field(), hills.mesh()), (Some(ground.id()), None));
}

#[test]
fn textures_have_pixels_and_materials_have_textures() {
    let mut model = every_element();
    let checks = model.texture("checks").unwrap();
    assert_eq!((checks.texture_type(), checks.width(), checks.height()), (TextureType::Flat, 16, 12));
    assert_eq!(checks.rgb().len(), 16 * 12 * 3);
    assert_eq!(model.texture("crate").unwrap().texture_type(), TextureType::Cube);
    assert_eq!(model.texture("sky").unwrap().texture_type(), TextureType::Skybox);
    let painted = model.material("painted").unwrap();
    assert_eq!((painted.texture(), painted.texuniform(), painted.texrepeat()), (Some(checks.id()), true, &[3.0, 3.0]));
    assert_eq!(model.material("plain").unwrap().texture(), None);
    assert_eq!(model.geom("floor").unwrap().material(), Some(painted.id()));
    let before = model.texture("crate").unwrap().rgb().to_vec();
    model.edit().texture_mut("checks").unwrap().rgb_mut().fill(9);
    assert!(model.texture("checks").unwrap().rgb().iter().all(|byte| *byte == 9));
    assert_eq!(model.texture("crate").unwrap().rgb(), before, "the neighbour is unchanged");
}

#[test]
fn pairs_excludes_and_equalities_have_their_objects() {
    let model = every_element();
    let pair = model.pair("pad_and_floor").unwrap();
    let geoms = [pair.geom1(), pair.geom2()].map(|geom| model.geom(geom).name());
    assert!(geoms.contains(&Some("pad")) && geoms.contains(&Some("floor")), "{geoms:?}");
    assert_eq!((pair.dim(), pair.friction()), (3, &[0.9, 0.9, 0.01, 0.001, 0.001]));
    let exclude = model.exclude("branch_and_end").unwrap();
    let bodies = [exclude.body1(), exclude.body2()].map(|body| model.body(body).name());
    assert!(bodies.contains(&Some("branch")) && bodies.contains(&Some("chain_2")), "{bodies:?}");

    let body = |name: &str| model.body(name).unwrap().id();
    let joint = |name: &str| -> JointId { model.joint(name).unwrap().id() };
    let tendon = |name: &str| model.tendon(name).unwrap().id();
    let expected = [
        (EqualityType::Connect, EqualityObjects::Bodies(body("RB2"), body("world")), true),
        (EqualityType::Connect, EqualityObjects::Bodies(body("pendulum"), body("carried")), false),
        (EqualityType::Weld, EqualityObjects::Bodies(body("hand"), body("carried")), true),
        (EqualityType::Joint, EqualityObjects::Joints(joint("swivel"), Some(joint("branch_hinge"))), true),
        (EqualityType::Joint, EqualityObjects::Joints(joint("gripper_x"), None), true),
        (EqualityType::Tendon, EqualityObjects::Tendons(tendon("coupling"), Some(tendon("other_coupling"))), false),
        (EqualityType::Tendon, EqualityObjects::Tendons(tendon("other_coupling"), None), true),
    ];
    for (equality, expected) in model.equalities().skip(model.neq() - expected.len()).zip(expected) {
        assert_eq!((equality.equality_type(), equality.objects(), equality.active()), expected, "{equality:?}");
    }
    assert_eq!(model.equality("geared").unwrap().data()[..5], [0.0, 0.5, 0.1, 0.0, 0.0]);
}

#[test]
fn actuators_have_their_transmission_and_types() {
    let model = every_element();
    let actuator = |name: &str| model.actuator(name).unwrap();
    let joint = |name: &str| -> JointId { model.joint(name).unwrap().id() };
    let site = |name: &str| model.site(name).unwrap().id();
    assert_eq!(actuator("motor").transmission(), Transmission::Joint(joint("hinge")));
    assert_eq!(actuator("in_parent").transmission(), Transmission::JointInParent(joint("ball_joint")));
    assert_eq!(actuator("pull").transmission(), Transmission::Tendon(model.tendon("cable").unwrap().id()));
    assert_eq!(actuator("jet").transmission(), Transmission::Site(site("tip")));
    assert_eq!(
        actuator("crank_drive").transmission(),
        Transmission::SliderCrank { crank: site("crank_site"), slider: site("slider_site") }
    );
    assert_eq!(actuator("stick").transmission(), Transmission::Body(model.body("gripper").unwrap().id()));
    let kinds = |name: &str| (actuator(name).dynamics(), actuator(name).gain(), actuator(name).bias());
    assert_eq!(kinds("motor"), (ActuatorDynamics::None, ActuatorGain::Fixed, ActuatorBias::None));
    assert_eq!(kinds("servo"), (ActuatorDynamics::None, ActuatorGain::Fixed, ActuatorBias::Affine));
    assert_eq!(kinds("integrating").0, ActuatorDynamics::Integrator);
    assert_eq!(kinds("filtered"), (ActuatorDynamics::Filter, ActuatorGain::Affine, ActuatorBias::Affine));
    assert_eq!(kinds("muscle"), (ActuatorDynamics::Muscle, ActuatorGain::Muscle, ActuatorBias::Muscle));
    assert_eq!(kinds("custom"), (ActuatorDynamics::User, ActuatorGain::User, ActuatorBias::User));
}

#[test]
fn sensors_have_their_type_and_object() {
    use SensorType as S;
    let model = every_element();
    // In the order of the XML.
    let expected = [
        S::Touch,
        S::Accelerometer,
        S::Velocimeter,
        S::Gyro,
        S::Force,
        S::Torque,
        S::Magnetometer,
        S::Rangefinder,
        S::JointPosition,
        S::JointVelocity,
        S::TendonPosition,
        S::TendonVelocity,
        S::ActuatorPosition,
        S::ActuatorVelocity,
        S::ActuatorForce,
        S::BallQuaternion,
        S::BallAngularVelocity,
        S::JointLimitPosition,
        S::JointLimitVelocity,
        S::JointLimitForce,
        S::TendonLimitPosition,
        S::TendonLimitVelocity,
        S::TendonLimitForce,
        S::FramePosition,
        S::FramePosition,
        S::FrameQuaternion,
        S::FrameXAxis,
        S::FrameYAxis,
        S::FrameZAxis,
        S::FrameLinearVelocity,
        S::FrameAngularVelocity,
        S::FrameLinearAcceleration,
        S::FrameAngularAcceleration,
        S::SubtreeCom,
        S::SubtreeLinearVelocity,
        S::SubtreeAngularMomentum,
        S::Clock,
        S::User,
        S::User,
        S::User,
        S::User,
    ];
    assert!(model.sensors().map(|sensor| sensor.sensor_type()).eq(expected));
    let body = |name: &str| model.body(name).unwrap().id();
    let site = |name: &str| model.site(name).unwrap().id();
    let sensor = |index: usize| model.sensor(index).unwrap();
    assert_eq!((sensor(0).object(), sensor(0).reference()), (Some(Object::Site(site("ball_site"))), None));
    assert_eq!(sensor(0).datatype(), SensorDataType::Positive);
    assert_eq!((sensor(23).object(), sensor(23).reference()), (Some(Object::Body(body("chain_2"))), None));
    assert_eq!(sensor(24).reference(), Some(Object::XBody(body("free_ball"))));
    let clock = model.sensor("clock").unwrap();
    assert_eq!((clock.object(), clock.needstage()), (None, Stage::Position));
    let custom = model.sensor("custom_real").unwrap();
    assert_eq!(custom.object(), Some(Object::Tendon(model.tendon("cable").unwrap().id())));
    assert_eq!((custom.dim(), custom.needstage(), custom.datatype()), (2, Stage::Velocity, SensorDataType::Real));
    let axis = model.sensor("custom_axis").unwrap();
    assert_eq!((axis.needstage(), axis.datatype()), (Stage::Acceleration, SensorDataType::Axis));
    assert_eq!(model.sensor("custom_quaternion").unwrap().datatype(), SensorDataType::Quaternion);
}

#[test]
fn tendon_paths_are_those_of_the_xml() {
    let model = every_element();
    let site = |name: &str| model.site(name).unwrap().id();
    let geom = |name: &str| model.geom(name).unwrap().id();
    let cable: Vec<Wrap> = model.tendon("cable").unwrap().path().collect();
    let expected = [
        Wrap::Site(site("anchor")),
        Wrap::Cylinder { geom: geom("guide"), side: Some(site("side")) },
        Wrap::Site(site("tip")),
        Wrap::Pulley { divisor: 2.0 },
        Wrap::Site(site("mount")),
        Wrap::Sphere { geom: geom("ball"), side: None },
        Wrap::Site(site("ball_site")),
        Wrap::Site(site("branch_site")),
    ];
    assert_eq!(cable, expected);
    let hinge = model.joint("hinge").unwrap().id();
    let coupling: Vec<Wrap> = model.tendon("coupling").unwrap().path().collect();
    assert_eq!(coupling.len(), 3);
    assert_eq!(coupling[0], Wrap::Joint { joint: hinge, coefficient: 1.0 });
}

#[test]
fn the_length_of_a_tendon_path_is_the_tendons_length() {
    let mut data = Data::new(every_element()).unwrap();
    data.forward().unwrap();
    let string = data.tendon("string").unwrap();
    let points: Vec<[f64; 3]> = string
        .wrap_points()
        .map(|point| match point {
            WrapPoint::Site { xpos } => xpos,
            other => panic!("not a site: {other:?}"),
        })
        .collect();
    assert_eq!(points[0], *data.site("pendulum_site").unwrap().xpos());
    assert_eq!(points[1], *data.site("anchor").unwrap().xpos());
    let length = points[0].iter().zip(points[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!((string.length() - length).abs() < 1e-12);
    assert_eq!(data.tendon("coupling").unwrap().wrap_points().len(), 0);
    assert!(data.tendon("cable").unwrap().wrap_points().any(|point| point == WrapPoint::Pulley));
}

#[test]
fn a_tendons_jacobian_row_is_independent_of_the_layout() {
    for jacobian in [mujoco_safe::enums::JacobianStorage::Dense, mujoco_safe::enums::JacobianStorage::Sparse] {
        let mut data = Data::new(every_element()).unwrap();
        data.forward().unwrap();
        data.edit_model(|model| model.edit_options(|options| options.jacobian = jacobian)).unwrap();
        let coupling = data.tendon("coupling").unwrap();
        assert!(coupling.J().is_none(), "computed with another layout");
        data.forward().unwrap();
        let nv = data.model().nv();
        let mut expected = vec![0.0; nv];
        for (joint, coefficient) in [("hinge", 1.0), ("branch_hinge", -0.5), ("slide", 0.2)] {
            expected[data.joint(joint).unwrap().in_model().dofs().start] = coefficient;
        }
        let row = data.tendon("coupling").unwrap().J().unwrap();
        assert_eq!(row.to_vec(), expected);
        let mut written = vec![7.0; nv];
        row.write_into(&mut written).unwrap();
        assert_eq!(written, expected);
        for wrong in [nv - 1, nv + 1] {
            let error = row.write_into(&mut vec![0.0; wrong]).unwrap_err();
            assert!(matches!(error, Error::Shape { .. }), "{error}");
        }
    }
}

#[test]
fn cameras_and_lights_have_their_mode_and_target() {
    let model = every_element();
    let modes: Vec<CameraMode> = model.cameras().map(|camera| camera.mode()).collect();
    let expected =
        [CameraMode::Fixed, CameraMode::Track, CameraMode::TrackCom, CameraMode::TargetBody, CameraMode::TargetBodyCom];
    assert_eq!(modes, expected);
    let targeting = model.camera("targeting").unwrap();
    assert_eq!(targeting.target(), Some(model.body("free_ball").unwrap().id()));
    assert_eq!(model.camera("fixed").unwrap().target(), None);
    assert_eq!(model.light("lamp").unwrap().mode(), CameraMode::Fixed);
    assert!(model.lights().any(|light| light.mode() == CameraMode::TargetBodyCom && !light.active()));
}

#[test]
fn bodies_have_their_joints_geoms_and_parents() {
    let model = every_element();
    let chain = model.body("chain_1").unwrap();
    let joints: Vec<_> = chain.joints().map(|joint| model.joint(joint).name()).collect();
    assert_eq!(joints, [Some("slide"), Some("swivel")]);
    let geoms: Vec<_> = chain.geoms().map(|geom| model.geom(geom).name()).collect();
    assert_eq!(geoms, [Some("link_1"), Some("guide")]);
    assert_eq!(chain.joints().next_back().map(|joint| model.joint(joint).name()), Some(Some("swivel")));
    let world = model.body(0).unwrap();
    assert_eq!((world.joints().len(), world.geoms().len()), (0, world.ngeom()));
    assert_eq!(model.body("fixed_to_chain").unwrap().weld(), model.body("chain_2").unwrap().id());
    let swivel = model.joint("swivel").unwrap();
    assert_eq!(swivel.parent_dof(), Some(model.joint("slide").unwrap().dofs().start));
    assert_eq!(model.joint("hinge").unwrap().parent_dof(), None);
    assert_eq!(model.geom("ball").unwrap().sameframe(), SameFrame::Body);
}

#[test]
fn mocap_bodies_and_activations_are_written_through_their_elements() {
    let mut data = Data::new(every_element()).unwrap();
    *data.body_mut("hand").unwrap().mocap_pos_mut().unwrap() = [0.1, 0.2, 0.3];
    data.body_mut("hand").unwrap().mocap_quat_mut().unwrap()[1] = 0.5;
    assert!(data.body_mut("chain_0").unwrap().mocap_pos_mut().is_none());
    assert!(data.body_mut("chain_0").unwrap().mocap_quat_mut().is_none());
    assert_eq!(data.mocap_pos()[0], [0.1, 0.2, 0.3]);
    assert_eq!(data.mocap_quat()[0][1], 0.5);
    *data.actuator_mut("muscle").unwrap().act_mut().unwrap() = 0.25;
    assert!(data.actuator_mut("motor").unwrap().act_mut().is_none());
    assert_eq!(data.actuator("muscle").unwrap().act(), Some(0.25));
    let at = data.model().actuator("muscle").unwrap().activation().unwrap();
    assert_eq!(data.act()[at], 0.25);
}
