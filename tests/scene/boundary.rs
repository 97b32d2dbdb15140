//! Invalid use of a scene is an error or a panic with a message, and never an invalid access. These
//! tests run under memcheck too.

#![forbid(unsafe_code)]

use std::hint::black_box;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mujoco_safe::enums::Cone;
use mujoco_safe::scene::{
    Camera, CameraView, Categories, Connector, FrameMode, LabelMode, MouseAction, MovableBodies, NewGeom, Perturbation,
    PerturbationFlags, RenderFlags, Scene, SceneOptions, Selection, TextureRepeat, Transform, Viewpoint, VisualFlags,
};
use mujoco_safe::{Data, Error, Model, sample};

use crate::scene_options::with_groups;

const EVERY_ELEMENT: &str = include_str!("../models/every_element.xml");
const COMPOSITES: &str = include_str!("../models/composites.xml");

fn every_element() -> Model {
    Model::from_xml_str(EVERY_ELEMENT).unwrap()
}

fn everything(label: LabelMode, frame: FrameMode) -> SceneOptions {
    let options = SceneOptions::default().with_label(label).with_frame(frame).with_flags(VisualFlags::all());
    with_groups(options, [true; 6])
}

/// Branches on the value, because memcheck reports uninitialised values in branches.
#[inline(never)]
#[allow(clippy::bool_to_int_with_if, reason = "memcheck reports branches, not conversions")]
fn branch(value: impl PartialEq + Default) -> usize {
    if black_box(value) == Default::default() { 0 } else { 1 }
}

/// Branches on every number of a scene.
fn touch(scene: &Scene) -> usize {
    let geoms: usize = scene
        .geoms()
        .map(|geom| {
            let reals = geom.size().into_iter().chain(geom.pos()).chain(geom.mat()).chain(geom.rgba());
            let others = [geom.emission(), geom.specular(), geom.shininess(), geom.reflectance(), geom.modelrbound()];
            let reals = reals.chain(others).chain(geom.texrepeat()).chain([geom.camdist()]);
            let label = geom.label().bytes().map(branch).sum::<usize>();
            let flags = [geom.texuniform(), geom.texcoord(), geom.transparent()];
            let data = [geom.plane(), geom.mesh().map(|mesh| mesh.index()), geom.height_field().map(|id| id.index())];
            let ids = usize::from(geom.object().is_some()) + usize::from(geom.texture().is_some()) + geom.segid();
            reals.map(branch).sum::<usize>() + flags.map(branch)[0] + data.map(branch)[0] + ids + label
        })
        .sum();
    let skins = scene.skins().flat_map(|skin| [skin.vertices, skin.normals]).flatten().flatten();
    let eyes = scene.viewpoints().map(|eye| branch(eye.pos[0]) + branch(eye.frustum_far) + branch(eye.up[2]));
    let lights = scene.lights().map(|light| branch(light.pos[0]) + branch(light.cutoff) + branch(light.castshadow));
    geoms + skins.map(|&number| branch(number)).sum::<usize>() + eyes.iter().sum::<usize>() + lights.sum::<usize>()
}

/// Returns `true` if the call succeeded; the only allowed error is a missing result.
fn succeeded<T>(result: Result<T, Error>) -> bool {
    match result {
        Ok(_) => true,
        Err(Error::NotComputed { .. }) => false,
        Err(error) => panic!("{error}"),
    }
}

/// Makes calls that need no contacts, calls that need contacts, and calls that need velocities, and
/// returns which succeeded.
fn try_all(scene: &mut Scene, data: &mut Data) -> [bool; 3] {
    let model = data.model().clone();
    let body = model.body("free_ball").unwrap().id();
    let mut camera = Camera::tracking(&model, body);
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(body);
    perturbation.skinselect = model.skins().last().map(|skin| skin.id());
    perturbation.active = PerturbationFlags::all();
    let plain = SceneOptions::default();
    let positions = [
        succeeded(scene.update_camera(data, &mut camera)),
        succeeded(scene.update(data, &plain, Some(&perturbation), &mut camera, Categories::all())),
        succeeded(scene.update_lights(data)),
        succeeded(scene.add_geoms(data, &plain, Some(&perturbation), Categories::all())),
        succeeded(perturbation.start(data, scene)),
        succeeded(perturbation.move_by(data, MouseAction::RotateV, [0.1, 0.2], scene)),
        succeeded(perturbation.move_by(data, MouseAction::MoveH, [0.1, 0.2], scene)),
        succeeded(perturbation.apply_pose(data, MovableBodies::MocapAndFree)),
        succeeded(perturbation.select(data, &Selection { body, geom: None, skin: None, flex: None, point: [0.0; 3] })),
        succeeded(scene.select(data, &plain, 1.0, [0.5, 0.5])),
    ];
    assert!(positions.iter().all(|&succeeded| succeeded == positions[0]), "{positions:?}");
    black_box(touch(scene));
    let contacts = [
        everything(LabelMode::ContactForce, FrameMode::Contact),
        plain.clone().with_frame(FrameMode::Contact),
        plain.clone().with_flags(VisualFlags::CONTACTPOINT),
        plain.clone().with_flags(VisualFlags::CONTACTFORCE),
        plain.with_flags(VisualFlags::CONSTRAINT),
    ]
    .map(|options| succeeded(scene.update(data, &options, Some(&perturbation), &mut camera, Categories::all())));
    assert!(contacts.iter().all(|&succeeded| succeeded == contacts[0]), "{contacts:?}");
    black_box(touch(scene));
    perturbation.active = PerturbationFlags::all();
    let forces = [succeeded(perturbation.force(data)), succeeded(perturbation.apply_force(data))];
    assert_eq!(forces[0], forces[1]);
    perturbation.remove_force(data);
    [positions[0], contacts[0], forces[0]]
}

#[test]
fn a_scene_needs_computed_results() {
    let mut data = Data::new(every_element()).unwrap();
    let mut scene = Scene::new(data.model(), 20_000).unwrap();
    let check = |scene: &mut Scene, data: &mut Data, expected: [bool; 3], when: &str| {
        assert_eq!(try_all(scene, data), expected, "{when}");
    };
    check(&mut scene, &mut data, [false; 3], "before any call");
    data.kinematics().unwrap();
    check(&mut scene, &mut data, [false; 3], "after some position stages");
    data.fwd_position().unwrap();
    let mut camera = Camera::free(data.model());
    let rays = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
    assert!(matches!(rays, Err(Error::NotComputed { call: "Scene::update", .. })), "lengths of rays: {rays:?}");
    data.sensor_pos().unwrap();
    check(&mut scene, &mut data, [true, false, false], "after positions");
    data.fwd_velocity().unwrap();
    check(&mut scene, &mut data, [true, false, true], "after velocities");
    data.forward().unwrap();
    check(&mut scene, &mut data, [true; 3], "after everything");
    for _ in 0..200 {
        data.step().unwrap();
    }
    check(&mut scene, &mut data, [true; 3], "after a step");
    data.step1().unwrap();
    check(&mut scene, &mut data, [true, false, true], "with rows that have no forces yet");
    data.inverse().unwrap();
    check(&mut scene, &mut data, [true; 3], "after inverse dynamics");
    data.edit_model(|model| model.edit_options(|options| options.cone = Cone::Elliptic)).unwrap();
    check(&mut scene, &mut data, [false; 3], "with contacts of another layout");
    data.forward().unwrap();
    check(&mut scene, &mut data, [true; 3], "after everything");
    data.reset().unwrap();
    check(&mut scene, &mut data, [false; 3], "after a reset");
}

#[test]
fn a_scene_without_an_update_has_no_view() {
    let mut data = Data::new(every_element()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 100).unwrap();
    assert_eq!(touch(&scene), 0);
    let options = SceneOptions::default();
    let mut camera = Camera::free(data.model());
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(data.model().body("free_ball").unwrap().id());
    scene.set_transform(Some(Transform { translate: [0.0; 3], rotate: [1.0, 0.0, 0.0, 0.0], scale: 1.0 })).unwrap();
    let model = data.model().clone();
    for error in [
        scene.select(&data, &options, 1.0, [0.5, 0.5]).unwrap_err(),
        scene.frustum_height().unwrap_err(),
        scene.camera_in_model().unwrap_err(),
        scene.camera_in_room().unwrap_err(),
        scene.move_model(&model, MouseAction::RotateV, [0.1; 2], [0.0, 0.0, 1.0]).unwrap_err(),
        perturbation.start(&mut data, &scene).unwrap_err(),
        perturbation.move_by(&data, MouseAction::MoveV, [0.1; 2], &scene).unwrap_err(),
    ] {
        assert!(matches!(&error, Error::Engine { message, .. } if message.contains("frustum_near")), "{error}");
    }
    // Newer engines move the camera without a view.
    let moved = camera.move_by(&model, MouseAction::MoveH, [0.1; 2], &scene);
    assert_eq!(moved.is_ok(), cfg!(engine_since = "3.11.0"), "{moved:?}");
    // An error of a scene does not poison the simulation.
    data.step().unwrap();
}

#[test]
fn objects_of_another_model_are_rejected() {
    let mut data = Data::new(every_element()).unwrap();
    data.forward().unwrap();
    let mut other = Data::new(every_element()).unwrap();
    other.forward().unwrap();
    let mut scene = Scene::new(data.model(), 20_000).unwrap();
    let options = SceneOptions::default();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
    // A clone is not another model.
    scene.update(&mut data.clone(), &options, None, &mut camera, Categories::all()).unwrap();

    let model = other.model().clone();
    let mut perturbation = Perturbation::default();
    for error in [
        scene.update(&mut other, &options, None, &mut camera, Categories::all()).unwrap_err(),
        scene.add_geoms(&mut other, &options, None, Categories::all()).unwrap_err(),
        scene.update_lights(&other).unwrap_err(),
        scene.update_camera(&other, &mut camera).unwrap_err(),
        scene.select(&other, &options, 1.0, [0.5; 2]).unwrap_err(),
        scene.move_model(&model, MouseAction::Zoom, [0.1; 2], [0.0, 0.0, 1.0]).unwrap_err(),
        camera.move_by(&model, MouseAction::Zoom, [0.1; 2], &scene).unwrap_err(),
        perturbation.start(&mut other, &scene).unwrap_err(),
        perturbation.move_by(&other, MouseAction::MoveV, [0.1; 2], &scene).unwrap_err(),
    ] {
        assert!(matches!(error, Error::OtherModel { .. }), "{error}");
    }

    let (body, fixed) = (model.body(1).unwrap().id(), model.camera(0).unwrap().id());
    let (mesh, field) = (model.mesh(0).unwrap().id(), model.height_field(0).unwrap().id());
    let (texture, skin) = (model.texture(0).unwrap().id(), model.skin(0).unwrap().id());
    let mut panics = |what: &str, action: &mut dyn FnMut(&mut Scene, &mut Data)| {
        let caught = catch_unwind(AssertUnwindSafe(|| action(&mut scene, &mut data)));
        let message = caught.expect_err(what).downcast::<String>().map(|text| *text).unwrap_or_default();
        let message = if message.is_empty() { "belongs to another model".to_owned() } else { message };
        assert!(message.contains("to another model"), "{what}: {message}");
    };
    for view in [CameraView::Tracking(body), CameraView::Fixed(fixed)] {
        let mut camera = Camera { view, ..Camera::default() };
        panics("a camera", &mut |scene, data| {
            let _ = scene.update(data, &options, None, &mut camera, Categories::all());
        });
        panics("update_camera", &mut |scene, data| {
            let _ = scene.update_camera(data, &mut camera);
        });
        panics("a camera motion", &mut |scene, data| {
            let model = data.model().clone();
            let _ = camera.move_by(&model, MouseAction::Zoom, [0.1; 2], scene);
        });
    }
    for (select, skinselect) in [(Some(body), None), (None, Some(skin))] {
        let mut perturbation = Perturbation::default();
        (perturbation.select, perturbation.skinselect) = (select, skinselect);
        perturbation.active = PerturbationFlags::all();
        panics("a displayed perturbation", &mut |scene, data| {
            let _ = scene.add_geoms(data, &options, Some(&perturbation), Categories::all());
        });
        panics("a perturbation", &mut |_, data| {
            let _ = perturbation.force(data);
        });
        panics("a perturbation of a pose", &mut |_, data| {
            let _ = perturbation.apply_pose(data, MovableBodies::MocapAndFree);
        });
    }
    panics("a selection", &mut |_, data| {
        let selection = Selection { body, geom: None, skin: None, flex: None, point: [0.0; 3] };
        let _ = Perturbation::default().select(data, &selection);
    });
    for geom in [
        NewGeom::mesh(mesh),
        NewGeom::convex_hull(mesh),
        NewGeom::height_field(field),
        NewGeom::sphere(1.0).with_texture(texture, TextureRepeat::PerGeom([1.0; 2])),
    ] {
        panics("a new geom", &mut |scene, _| {
            let _ = scene.add_geom(&geom);
        });
    }
    // A force applied to one body is not removed from another.
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(data.model().body("free_ball").unwrap().id());
    perturbation.active = PerturbationFlags::TRANSLATE;
    perturbation.apply_force(&mut data).unwrap();
    other.xfrc_applied_mut().clone_from_slice(data.xfrc_applied());
    perturbation.remove_force(&mut other);
    assert_eq!(other.xfrc_applied(), data.xfrc_applied());
}

#[test]
fn invalid_numbers_are_rejected() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let mut scene = Scene::new(&model, 1000).unwrap();
    let options = SceneOptions::default();
    scene.update(&mut data, &options, None, &mut Camera::free(&model), Categories::all()).unwrap();
    for invalid in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let free = Camera::free(&model);
        for mut camera in [
            Camera { lookat: [0.0, invalid, 0.0], ..free },
            Camera { distance: invalid, ..free },
            Camera { azimuth: invalid, ..free },
            Camera { elevation: invalid, ..free },
            Camera { distance: 1e300, ..free },
        ] {
            let updated = scene.update(&mut data, &options, None, &mut camera, Categories::all());
            assert!(matches!(updated, Err(Error::Invalid { .. })));
            assert!(matches!(scene.update_camera(&data, &mut camera), Err(Error::Invalid { .. })));
        }
        let (mut camera, mut perturbation) = (free, Perturbation::default());
        perturbation.select = Some(model.body("torso").unwrap().id());
        for motion in [[invalid, 0.0], [0.0, invalid]] {
            let moved = camera.move_by(&model, MouseAction::RotateV, motion, &scene);
            assert!(matches!(moved, Err(Error::Invalid { .. })));
            let moved = perturbation.move_by(&data, MouseAction::MoveV, motion, &scene);
            assert!(matches!(moved, Err(Error::Invalid { .. })));
            let moved = scene.move_model(&model, MouseAction::MoveV, motion, [0.0, 0.0, 1.0]);
            assert!(matches!(moved, Err(Error::Invalid { .. })));
            assert!(matches!(scene.select(&data, &options, 1.0, motion), Err(Error::Invalid { .. })));
        }
        assert_eq!(camera, free);
        assert!(matches!(scene.select(&data, &options, invalid, [0.5; 2]), Err(Error::Invalid { .. })));
        perturbation.active = PerturbationFlags::all();
        for set in [
            |perturbation: &mut Perturbation, invalid| perturbation.refpos[1] = invalid,
            |perturbation: &mut Perturbation, invalid| perturbation.refquat[3] = invalid,
            |perturbation: &mut Perturbation, invalid| perturbation.localpos[0] = invalid,
            |perturbation: &mut Perturbation, invalid| perturbation.scale = invalid,
        ] {
            let mut perturbation = perturbation.clone();
            set(&mut perturbation, invalid);
            assert!(matches!(perturbation.force(&mut data), Err(Error::Invalid { .. })));
            assert!(matches!(perturbation.apply_force(&mut data), Err(Error::Invalid { .. })));
            assert!(matches!(
                perturbation.apply_pose(&mut data, MovableBodies::MocapAndFree),
                Err(Error::Invalid { .. })
            ));
            let updated = scene.update(&mut data, &options, Some(&perturbation), &mut camera, Categories::all());
            assert!(matches!(updated, Err(Error::Invalid { .. })));
        }
        let single = invalid as f32;
        for geom in [
            NewGeom::sphere(invalid),
            NewGeom::sphere(1e300),
            NewGeom::sphere(-1.0),
            NewGeom::cuboid([1.0, invalid, 1.0]),
            NewGeom::plane([1.0, invalid]),
            NewGeom::sphere(1.0).with_pos([invalid, 0.0, 0.0]),
            NewGeom::sphere(1.0).with_mat([invalid; 9]),
            NewGeom::sphere(1.0).with_rgba([single, 0.0, 0.0, 1.0]),
            NewGeom::sphere(1.0).with_surface(0.0, single, 0.0, 0.0),
            NewGeom::connector(Connector::Arrow, invalid, [0.0; 3], [1.0; 3]),
            NewGeom::connector(Connector::Line, 1.0, [invalid; 3], [1.0; 3]),
            NewGeom::connector(Connector::Capsule, 1.0, [0.0; 3], [invalid; 3]),
        ] {
            assert!(matches!(scene.add_geom(&geom), Err(Error::Invalid { .. })), "{geom:?}");
        }
        let eye = scene.viewpoint();
        for eye in [
            Viewpoint { pos: [single; 3], ..eye },
            Viewpoint { frustum_near: 0.0, ..eye },
            Viewpoint { frustum_far: eye.frustum_near, ..eye },
            Viewpoint { frustum_top: eye.frustum_bottom, ..eye },
        ] {
            assert!(matches!(scene.set_viewpoints([eye; 2]), Err(Error::Invalid { .. })));
        }
        let whole = Transform { translate: [0.0; 3], rotate: [1.0, 0.0, 0.0, 0.0], scale: 1.0 };
        for transform in [
            Transform { translate: [0.0, single, 0.0], ..whole },
            Transform { rotate: [0.0; 4], ..whole },
            Transform { rotate: [single, 0.0, 0.0, 0.0], ..whole },
            Transform { scale: single, ..whole },
            Transform { scale: 0.0, ..whole },
        ] {
            assert!(matches!(scene.set_transform(Some(transform)), Err(Error::Invalid { .. })));
        }
        assert_eq!(scene.transform(), None);
    }
    // At such a distance a zoom overflows.
    let far_behind = Camera { distance: -1e6, ..Camera::free(&model) };
    let mut camera = far_behind;
    assert!(matches!(camera.move_by(&model, MouseAction::Zoom, [0.0, 0.1], &scene), Err(Error::Invalid { .. })));
    assert_eq!(camera, far_behind);
}

/// The engine uses a skin's group as an index without a check, so loading must reject invalid
/// groups.
#[test]
fn a_skin_with_an_invalid_group_is_rejected() {
    for group in [-1, 6, 1_000_000] {
        let mut texts = vec![(EVERY_ELEMENT, r#"<skin name="sheet""#)];
        // Newer compilers lack the composites.
        if cfg!(not(engine_since = "2.3.0")) {
            texts.push((COMPOSITES, r#"<skin inflate="0.005""#));
        }
        for (text, skin) in texts {
            assert!(text.contains(skin));
            let with_group = skin.replace("<skin", &format!(r#"<skin group="{group}""#));
            let xml = text.replace(r#" group="2""#, "").replace(skin, &with_group);
            let error = Model::from_xml_str(&xml).unwrap_err();
            assert!(error.to_string().contains("skin group"), "{error}");
        }
    }
}

#[test]
fn selecting_in_a_height_field_that_the_engine_misreads_is_rejected() {
    let xml = r#"<mujoco><asset><hfield name="h" nrow="9" ncol="3" size="1 1 1 1"/></asset>
        <worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 10).unwrap();
    let options = SceneOptions::default();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
    assert!(matches!(scene.select(&data, &options, 1.0, [0.5; 2]), Err(Error::Unsupported(_))));
}

#[test]
fn a_scene_larger_than_memory_is_an_error() {
    let model = sample::cartpole();
    assert!(matches!(Scene::new(&model, usize::MAX), Err(Error::Invalid { .. })));
    assert!(matches!(Scene::new(&model, i32::MAX as usize + 1), Err(Error::Invalid { .. })));
    let mut none = Scene::new(&model, 0).unwrap();
    assert!(matches!(none.add_geom(&NewGeom::sphere(1.0)), Err(Error::SceneFull { what: "geoms", capacity: 0 })));
    // A large scene takes memory only for the geoms in use.
    let mut large = Scene::new(&model, 1_000_000).unwrap();
    large.add_geom(&NewGeom::sphere(1.0)).unwrap();
    assert_eq!(large.ngeom(), 1);
}

#[test]
fn user_geoms_remain_until_the_next_update() {
    let mut data = Data::new(every_element()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let mut scene = Scene::new(&model, 20_000).unwrap();
    let mut camera = Camera::free(&model);
    let options = SceneOptions::default();
    scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
    let shown = scene.ngeom();
    let texture = model.texture("checks").unwrap().id();
    let geoms = [
        NewGeom::plane([1.0, 2.0]),
        NewGeom::capsule(0.1, 0.2),
        NewGeom::ellipsoid([0.1, 0.2, 0.3]),
        NewGeom::cylinder(0.1, 0.2).with_category(Categories::DYNAMIC),
        NewGeom::cuboid([0.1, 0.2, 0.3]),
        NewGeom::mesh(model.mesh("tetra").unwrap().id()),
        NewGeom::height_field(model.height_field("second").unwrap().id()),
    ];
    for (index, geom) in geoms.into_iter().enumerate() {
        assert_eq!(scene.add_geom(&geom).unwrap(), shown + index);
        assert_eq!((scene.geom(shown + index).object(), scene.geom(shown + index).segid()), (None, shown + index));
    }
    let added = |index: usize| scene.geom(shown + index);
    assert_eq!(added(0).size(), [1.0, 2.0, 0.0]);
    assert_eq!(added(1).size(), [0.1, 0.1, 0.2]);
    assert_eq!(added(2).size(), [0.1, 0.2, 0.3]);
    assert_eq!((added(3).size(), added(3).category()), ([0.1, 0.1, 0.2], Categories::DYNAMIC));
    assert_eq!((added(4).size(), added(4).texture()), ([0.1, 0.2, 0.3], None));
    assert_eq!((added(5).mesh(), added(5).shows_convex_hull()), (Some(model.mesh("tetra").unwrap().id()), false));
    assert_eq!(added(6).height_field(), Some(model.height_field("second").unwrap().id()));
    let textured = NewGeom::cuboid([0.1; 3]).with_texture(texture, TextureRepeat::PerLength([2.0, 3.0]));
    if cfg!(engine_since = "3.2.1") {
        // The textures of newer engines belong to materials.
        assert!(matches!(scene.add_geom(&textured), Err(Error::Unsupported(_))));
    } else {
        let index = scene.add_geom(&textured).unwrap();
        let geom = scene.geom(index);
        assert_eq!((geom.texture(), geom.texrepeat(), geom.texuniform()), (Some(texture), [2.0, 3.0], true));
    }
    // A convex hull, where one exists.
    for mesh in model.meshes() {
        let index = scene.add_geom(&NewGeom::convex_hull(mesh.id())).unwrap();
        let has_hull = model.mesh_graphadr()[mesh.index()] >= 0;
        assert_eq!(scene.geom(index).mesh(), Some(mesh.id()));
        assert_eq!(scene.geom(index).shows_convex_hull(), has_hull);
    }
    black_box(touch(&scene));
    scene.update(&mut data, &options, None, &mut camera, Categories::all()).unwrap();
    assert_eq!(scene.ngeom(), shown);
    scene.clear();
    assert_eq!(scene.ngeom(), 0);
}

#[test]
fn user_viewpoints_and_render_flags_remain() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera { view: CameraView::User, ..Camera::default() };
    let eye = Viewpoint {
        pos: [0.0, -3.0, 1.0],
        forward: [0.0, 1.0, 0.0],
        up: [0.0, 0.0, 1.0],
        frustum_center: 0.0,
        frustum_width: 0.0,
        frustum_bottom: -0.01,
        frustum_top: 0.01,
        frustum_near: 0.02,
        frustum_far: 50.0,
        orthographic: false,
    };
    scene.set_viewpoints([eye; 2]).unwrap();
    scene.set_render_flags(RenderFlags::WIREFRAME | RenderFlags::CULL_FACE);
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    assert_eq!(scene.viewpoints(), [eye; 2]);
    assert_eq!(scene.render_flags(), RenderFlags::WIREFRAME | RenderFlags::CULL_FACE);
    assert_eq!(scene.frustum_height().unwrap(), f64::from(0.02_f32) / f64::from(0.02_f32));
}
