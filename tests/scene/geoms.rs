//! Contents of complete scenes.

use mujoco_safe::data::Warning;
use mujoco_safe::element::Object;
use mujoco_safe::scene::{
    Camera, Categories, FrameMode, LabelMode, Perturbation, PerturbationFlags, RenderFlags, Scene, SceneGeomType,
    SceneOptions, VisualFlags,
};
use mujoco_safe::sys::{self, mjvCamera, mjvOption, mjvPerturb};
use mujoco_safe::{Data, Error, Model, sample};

use crate::cases::cases;
use crate::raw::{RawScene, assert_same_scene, filled, raw_options, raw_perturbation, scene_subjects};
use crate::scene_options::with_groups;
use crate::twins::{Twins, c, differing};

/// Labels of this engine.
const LABELS: &[LabelMode] = &[
    LabelMode::None,
    LabelMode::Body,
    LabelMode::Joint,
    LabelMode::Geom,
    LabelMode::Site,
    LabelMode::Camera,
    LabelMode::Light,
    LabelMode::Tendon,
    LabelMode::Actuator,
    LabelMode::Constraint,
    LabelMode::Skin,
    LabelMode::Selection,
    LabelMode::SelectionPoint,
    LabelMode::ContactForce,
    #[cfg(engine_since = "3.0.0")]
    LabelMode::Flex,
    #[cfg(engine_since = "2.3.7")]
    LabelMode::ContactPoint,
    #[cfg(engine_since = "3.0.0")]
    LabelMode::Island,
];

const FRAMES: [FrameMode; 8] = [
    FrameMode::None,
    FrameMode::Body,
    FrameMode::Geom,
    FrameMode::Site,
    FrameMode::Camera,
    FrameMode::Light,
    FrameMode::Contact,
    FrameMode::World,
];

/// Returns a perturbation of the last body and of the first skin, if any.
pub(crate) fn perturbation(model: &Model) -> Perturbation {
    let mut perturbation = Perturbation::default();
    perturbation.select = model.bodies().last().map(|body| body.id());
    perturbation.skinselect = model.skins().next().map(|skin| skin.id());
    perturbation.active = PerturbationFlags::all();
    perturbation.active2 = PerturbationFlags::ROTATE;
    perturbation.refpos = [0.3, -0.2, 1.5];
    perturbation.refquat = [0.8, 0.0, 0.6, 0.0];
    perturbation.localpos = [0.01, 0.02, 0.03];
    perturbation
}

/// Returns the combinations of options that can interact, and each flag alone.
fn all_options(thorough: bool) -> Vec<SceneOptions> {
    let default = SceneOptions::default();
    let mut all = Vec::new();
    for flags in [
        default.flags,
        VisualFlags::all(),
        VisualFlags::all() - VisualFlags::INERTIA - VisualFlags::CONTACTSPLIT,
        VisualFlags::empty(),
    ] {
        for (index, label) in LABELS.iter().enumerate() {
            for (other, frame) in FRAMES.into_iter().enumerate() {
                if thorough || index % FRAMES.len() == other {
                    all.push(default.clone().with_label(*label).with_frame(frame).with_flags(flags));
                }
            }
        }
    }
    for flag in VisualFlags::all() {
        all.push(default.clone().with_flags(default.flags ^ flag));
    }
    for group in 0..6 {
        let mut some = [false; 6];
        some[group] = true;
        all.push(with_groups(default.clone().with_flags(VisualFlags::all()), some));
    }
    all
}

#[test]
fn scenes_equal_c_for_all_options() {
    let (mut kinds, mut objects) = (std::collections::HashSet::new(), std::collections::HashSet::new());
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        twins
            .ours
            .xfrc_applied_mut()
            .as_flattened_mut()
            .iter_mut()
            .enumerate()
            .for_each(|(i, force)| *force = i as f64);
        let forces = twins.ours.xfrc_applied().as_flattened().to_vec();
        twins.raw.write(|d| d.xfrc_applied, &forces);

        let mut ours = Scene::new(&twins.model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let mut camera = Camera::free(&twins.model);
        let mut raw_camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        let perturbation = perturbation(&twins.model);
        // In a part of the cases each label has one frame only.
        for options in all_options(cases(false, twins.model.ngeom() < 100)) {
            for pert in [None, Some(&perturbation)] {
                ours.update(&mut twins.ours, &options, pert, &mut camera, Categories::all()).unwrap();
                theirs.update(&twins.raw, &options, pert, &mut raw_camera);
                let skins = options.flags.contains(VisualFlags::SKIN);
                assert_same_scene(&format!("{}, {options:?}", twins.name), &ours, &theirs, skins);
                for geom in ours.geoms() {
                    kinds.insert(geom.geom_type());
                    // Rangefinders are objects in newer engines only.
                    if !matches!(geom.object(), Some(Object::Sensor(_))) {
                        objects.insert(geom.object().map(|object| std::mem::discriminant(&object)));
                    }
                }
            }
        }
        assert_eq!(twins.ours.warning(Warning::VisualGeomFull).number, 0);
    }
    for kind in [
        SceneGeomType::Plane,
        SceneGeomType::HeightField,
        SceneGeomType::Sphere,
        SceneGeomType::Capsule,
        SceneGeomType::Ellipsoid,
        SceneGeomType::Cylinder,
        SceneGeomType::Box,
        SceneGeomType::Mesh,
        SceneGeomType::Arrow,
        SceneGeomType::Arrow1,
        SceneGeomType::Line,
        SceneGeomType::Skin,
        SceneGeomType::Label,
    ] {
        assert!(kinds.contains(&kind), "{kind:?} was compared");
    }
    assert_eq!(objects.len(), 11, "all kinds of object, and decoration");
}

#[test]
fn geom_views_have_the_engines_values() {
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        let mut scene = Scene::new(&twins.model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let options = SceneOptions::default().with_flags(VisualFlags::all()).with_label(LabelMode::Geom);
        let mut raw_camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        let mut camera = Camera::free(&twins.model);
        scene.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
        theirs.update(&twins.raw, &options, None, &mut raw_camera);
        assert_eq!(scene.geoms().len(), theirs.geoms().len());
        for (index, (ours, theirs)) in scene.geoms().zip(theirs.geoms()).enumerate() {
            assert_eq!(ours.geom_type(), shape(theirs.type_), "{}: geom {index}", subject.name);
            assert_eq!((ours.size(), ours.pos(), ours.mat()), (theirs.size, theirs.pos, theirs.mat));
            assert_eq!((ours.rgba(), ours.emission()), (theirs.rgba, theirs.emission));
            assert_eq!((ours.specular(), ours.shininess()), (theirs.specular, theirs.shininess));
            assert_eq!((ours.reflectance(), ours.modelrbound()), (theirs.reflectance, theirs.modelrbound));
            assert_eq!(ours.category().bits() as i32, theirs.category);
            assert_eq!((ours.segid(), index), (theirs.segid as usize, index));
            // SAFETY: a model and a geom of its scene.
            let (texture, uniform, repeat) = unsafe { differing::scene_geom_texture(&*twins.raw.m(), &theirs) };
            assert_eq!(ours.texture().map_or(-1, |texture| texture.index() as i32), texture);
            assert_eq!((ours.texrepeat(), ours.texuniform()), (repeat, uniform != 0));
            assert_eq!(ours.texcoord(), theirs.texcoord != 0);
            let data = match ours.geom_type() {
                SceneGeomType::Mesh => ours.mesh().map(|mesh| 2 * mesh.index() + usize::from(ours.shows_convex_hull())),
                SceneGeomType::HeightField => ours.height_field().map(|field| field.index()),
                _ => ours.plane(),
            };
            // A box that was fitted to a mesh has the number of the mesh in 3.5.0.
            let is_fitted = cfg!(all(engine_since = "3.5.0", not(engine_since = "3.17.0")))
                && ours.geom_type() == SceneGeomType::Box;
            assert_eq!(data.map_or(-1, |data| data as i32), if is_fitted { -1 } else { theirs.dataid });
            assert_eq!((ours.camdist(), ours.transparent()), (0.0, false));
            let object = match ours.object() {
                None => None,
                Some(Object::Body(id)) => Some((sys::mjOBJ_BODY, id.index())),
                Some(Object::Joint(id)) => Some((sys::mjOBJ_JOINT, id.index())),
                Some(Object::Geom(id)) => Some((sys::mjOBJ_GEOM, id.index())),
                Some(Object::Site(id)) => Some((sys::mjOBJ_SITE, id.index())),
                Some(Object::Camera(id)) => Some((sys::mjOBJ_CAMERA, id.index())),
                Some(Object::Light(id)) => Some((sys::mjOBJ_LIGHT, id.index())),
                Some(Object::Tendon(id)) => Some((sys::mjOBJ_TENDON, id.index())),
                Some(Object::Actuator(id)) => Some((sys::mjOBJ_ACTUATOR, id.index())),
                Some(Object::Equality(id)) => Some((sys::mjOBJ_EQUALITY, id.index())),
                Some(Object::Skin(id)) => Some((sys::mjOBJ_SKIN, id.index())),
                Some(Object::Sensor(id)) => Some((sys::mjOBJ_SENSOR, id.index())),
                Some(other) => panic!("unexpected type {other:?}"),
            };
            let expected = (theirs.objtype != 0).then_some((theirs.objtype as u32, theirs.objid as usize));
            assert_eq!(object, expected, "{}: geom {index}", subject.name);
        }
        assert_eq!(scene.lights().len(), theirs.0.nlight as usize);
        for (ours, theirs) in scene.lights().zip(&theirs.0.lights) {
            assert_eq!((ours.pos, ours.dir, ours.attenuation), (theirs.pos, theirs.dir, theirs.attenuation));
            assert_eq!((ours.ambient, ours.diffuse, ours.specular), (theirs.ambient, theirs.diffuse, theirs.specular));
            assert_eq!((ours.cutoff, ours.exponent), (theirs.cutoff, theirs.exponent));
            let flags = [ours.headlight, ours.directional, ours.castshadow].map(u8::from);
            assert_eq!(flags, [theirs.headlight, differing::scene_light_directional(theirs), theirs.castshadow]);
        }
    }
}

/// Returns the shape of an engine constant.
fn shape(raw: i32) -> SceneGeomType {
    let shapes = [
        (sys::mjGEOM_PLANE, SceneGeomType::Plane),
        (sys::mjGEOM_HFIELD, SceneGeomType::HeightField),
        (sys::mjGEOM_SPHERE, SceneGeomType::Sphere),
        (sys::mjGEOM_CAPSULE, SceneGeomType::Capsule),
        (sys::mjGEOM_ELLIPSOID, SceneGeomType::Ellipsoid),
        (sys::mjGEOM_CYLINDER, SceneGeomType::Cylinder),
        (sys::mjGEOM_BOX, SceneGeomType::Box),
        (sys::mjGEOM_MESH, SceneGeomType::Mesh),
        (sys::mjGEOM_ARROW, SceneGeomType::Arrow),
        (sys::mjGEOM_ARROW1, SceneGeomType::Arrow1),
        (sys::mjGEOM_ARROW2, SceneGeomType::Arrow2),
        (sys::mjGEOM_LINE, SceneGeomType::Line),
        (sys::mjGEOM_LINEBOX, SceneGeomType::LineBox),
        (sys::mjGEOM_TRIANGLE, SceneGeomType::Triangle),
        (sys::mjGEOM_SKIN, SceneGeomType::Skin),
        (sys::mjGEOM_LABEL, SceneGeomType::Label),
        (sys::mjGEOM_NONE, SceneGeomType::None),
    ];
    shapes.into_iter().find(|(constant, _)| *constant as i32 == raw).expect("a known shape").1
}

#[test]
fn added_geoms_equal_c() {
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        let mut ours = Scene::new(&twins.model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let options = SceneOptions::default().with_flags(VisualFlags::all());
        let raw_options = raw_options(&options);
        let perturbation = perturbation(&twins.model);
        let raw_perturbation = raw_perturbation(&perturbation);
        let mut end = 0;
        for bits in 0..8 {
            let categories = Categories::from_bits_truncate(bits);
            let range = ours.add_geoms(&mut twins.ours, &options, Some(&perturbation), categories).unwrap();
            assert_eq!((range.start, range.end), (end, ours.ngeom()));
            end = range.end;
            let (opt, pert) = (&raw const raw_options, &raw const raw_perturbation);
            c!(mjv_addGeoms(twins.raw.m(), twins.raw.d, opt, pert, bits as i32, &raw mut *theirs.0));
        }
        // Newer engines need a camera, at which they place the headlight.
        let mut raw_camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        ours.update_camera(&twins.ours, &mut Camera::free(&twins.model)).unwrap();
        c!(mjv_updateCamera(twins.raw.m(), twins.raw.d, &raw mut raw_camera, &raw mut *theirs.0));
        ours.update_lights(&twins.ours).unwrap();
        c!(mjv_makeLights(twins.raw.m(), twins.raw.d, &raw mut *theirs.0));
        assert_same_scene(&subject.name, &ours, &theirs, false);
    }
}

#[test]
fn a_full_scene_is_an_error_and_keeps_the_first_geoms() {
    let mut twins = Twins::in_motion(&scene_subjects()[0]);
    let options = SceneOptions::default().with_flags(VisualFlags::all());
    let mut camera = Camera::free(&twins.model);
    let mut whole = Scene::new(&twins.model, 20_000).unwrap();
    whole.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
    let needed = whole.ngeom();
    // The last geoms of this model are the contacts, all of which are shown.
    let mut exact = Scene::new(&twins.model, needed).unwrap();
    exact.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
    assert_eq!(twins.ours.warning(Warning::VisualGeomFull).number, 0);

    for capacity in [0, 1, 7, needed / 2, needed - 1] {
        let mut ours = Scene::new(&twins.model, capacity).unwrap();
        let mut theirs = RawScene::new(&twins.raw, capacity as i32);
        let mut camera = Camera::free(&twins.model);
        let mut raw_camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        let error = ours.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap_err();
        assert!(matches!(error, Error::SceneFull { what: "geoms", capacity: found } if found == capacity), "{error}");
        // The engine logs only the first warning, which is disabled here.
        // SAFETY: the data belongs to this test.
        let counter = unsafe { (*twins.raw.d).warning.get_mut(sys::mjWARN_VGEOMFULL as usize) };
        // Newer engines have no warning, and report the capacity in the scene.
        let counter = counter.map(|counter| &raw mut counter.number);
        // SAFETY: as above.
        counter.inspect(|&counter| unsafe { *counter += 1 });
        theirs.update(&twins.raw, &options, None, &mut raw_camera);
        // SAFETY: as above.
        counter.inspect(|&counter| unsafe { *counter -= 1 });
        assert_eq!(ours.ngeom(), capacity);
        assert_same_scene(&format!("capacity for {capacity}"), &ours, &theirs, true);
        twins.assert_same_state("after a full scene");
        let error = ours.add_geoms(&mut twins.ours, &options, None, Categories::all()).unwrap_err();
        assert!(matches!(error, Error::SceneFull { .. }), "{error}");
        // SAFETY: as above. The library has added the number of omitted geoms to the counter.
        unsafe { (*twins.raw.d).warning = (*twins.ours.as_ptr()).warning };
    }
}

#[test]
fn too_many_lights_are_reported() {
    let lights = |count: usize| {
        let lights = r#"<light pos="0 0 1"/>"#.repeat(count);
        Data::new(Model::from_xml_str(&format!("<mujoco><worldbody>{lights}</worldbody></mujoco>")).unwrap()).unwrap()
    };
    for (count, fits) in [(99, true), (100, false)] {
        let mut data = lights(count);
        data.forward().unwrap();
        let mut scene = Scene::new(data.model(), 10).unwrap();
        let mut camera = Camera::free(data.model());
        let updated = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
        assert_eq!(scene.lights().len(), 100); // includes the headlight
        match updated {
            Ok(()) => assert!(fits),
            Err(error) => {
                assert!(!fits && matches!(error, Error::SceneFull { what: "lights", capacity: 100 }), "{error}");
            }
        }
    }
}

#[test]
fn defaults_equal_c() {
    let options: mjvOption = filled(|options| c!(mjv_defaultOption(options)));
    assert_eq!(format!("{:?}", raw_options(&SceneOptions::default())), format!("{options:?}"));
    let perturbation: mjvPerturb = filled(|perturbation| c!(mjv_defaultPerturb(perturbation)));
    assert_eq!(format!("{:?}", raw_perturbation(&Perturbation::default())), format!("{perturbation:?}"));
    let camera: mjvCamera = filled(|camera| c!(mjv_defaultCamera(camera)));
    let ours = Camera::default();
    let numbers = (ours.lookat, ours.distance, ours.azimuth, ours.elevation);
    assert_eq!(numbers, (camera.lookat, camera.distance, camera.azimuth, camera.elevation));
    for subject in scene_subjects() {
        let ours = Camera::free(&subject.model);
        let camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(subject.model.as_ptr(), camera)));
        let numbers = (ours.lookat, ours.distance, ours.azimuth, ours.elevation);
        assert_eq!(numbers, (camera.lookat, camera.distance, camera.azimuth, camera.elevation));
    }
    let scene = Scene::new(&sample::cartpole(), 1).unwrap();
    let twins = Twins::new(&scene_subjects()[0]);
    let theirs = RawScene::new(&twins.raw, 1);
    for flag in RenderFlags::all() {
        let bit = flag.bits().trailing_zeros() as usize;
        assert_eq!(scene.render_flags().contains(flag), theirs.0.flags[bit] != 0, "{flag:?}");
    }
}

#[test]
fn effects_of_the_engines_own_renderer_are_kept() {
    let twins = Twins::new(&scene_subjects()[0]);
    let theirs = RawScene::new(&twins.raw, 1);
    let mut scene = Scene::new(&twins.model, 1).unwrap();
    for flags in [RenderFlags::all(), RenderFlags::empty(), RenderFlags::FOG | RenderFlags::IDCOLOR] {
        scene.set_render_flags(flags);
        assert_eq!(scene.render_flags(), flags);
        // SAFETY: the scene is alive, and nothing writes to it during this statement.
        let raw = unsafe { (*scene.as_ptr()).flags };
        for (bit, (&ours, &default)) in raw.iter().zip(&theirs.0.flags).enumerate() {
            let known = RenderFlags::from_bits(1 << bit);
            assert_eq!(ours, known.map_or(default, |flag| flags.contains(flag).into()), "{bit}");
        }
    }
}

#[test]
fn labels_of_another_engine_are_an_error() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 100).unwrap();
    for label in [LabelMode::Flex, LabelMode::ContactPoint, LabelMode::Island] {
        let options = SceneOptions::default().with_label(label);
        let mut camera = Camera::free(data.model());
        let updated = scene.update(&mut data, &options, None, &mut camera, Categories::all());
        if cfg!(engine_since = "3.0.0") {
            updated.unwrap();
        } else if !(cfg!(engine_since = "2.3.7") && label == LabelMode::ContactPoint) {
            let error = updated.unwrap_err();
            assert!(matches!(&error, Error::Unsupported(text) if text.contains("and later")), "{error}");
            assert_eq!(scene.ngeom(), 0);
        }
    }
}
