//! Abstract scenes: contents, camera, and perturbation with the mouse.

use std::hint::black_box;

use mujoco_safe::scene::{
    self, Camera, CameraView, Categories, Connector, FrameMode, LabelMode, MouseAction, MovableBodies, NewGeom,
    Perturbation, PerturbationFlags, RenderFlags, SceneOptions, TextureRepeat, Transform, Viewpoint, VisualFlags,
};
use mujoco_safe::{Data, Error, Result};

use super::{Bytes, Call, Scene, expected, must_panic, read_only};

/// A scene, its camera and its perturbation, all of one model.
pub(super) struct SceneView {
    scene: scene::Scene,
    camera: Camera,
    perturbation: Perturbation,
    options: SceneOptions,
}

impl SceneView {
    fn new(data: &Data, bytes: &mut Bytes<'_>) -> Result<Self> {
        let model = data.model();
        let room = [1000, 1000, 100, 3, 0, i32::MAX as usize, usize::MAX][bytes.below(7)];
        let scene = scene::Scene::new(model, room)?;
        let camera = Camera::free(model);
        Ok(Self { scene, camera, perturbation: Perturbation::default(), options: SceneOptions::default() })
    }

    /// Returns `true` if the scene is of this model.
    fn fits(&mut self, data: &Data) -> bool {
        !matches!(self.scene.update_lights(data), Err(Error::OtherModel { .. }))
    }
}

/// Makes a call with a scene, often the scene of an earlier call, of the same model or of another.
fn with_view(
    scene: &mut Scene<'_>,
    bytes: &mut Bytes<'_>,
    call: impl FnOnce(&mut SceneView, &mut Data, &mut Bytes<'_>) -> Result<()>,
) -> Result<()> {
    if scene.view.is_none() || bytes.once_in(12) {
        scene.view = Some(SceneView::new(&scene.data, bytes)?);
    }
    let view = scene.view.as_mut().expect("just created");
    call(view, &mut scene.data, bytes)
}

fn options(bytes: &mut Bytes<'_>) -> SceneOptions {
    const LABELS: [LabelMode; 5] =
        [LabelMode::None, LabelMode::Body, LabelMode::Constraint, LabelMode::SelectionPoint, LabelMode::ContactForce];
    const FRAMES: [FrameMode; 4] = [FrameMode::None, FrameMode::Geom, FrameMode::Contact, FrameMode::World];
    let group = |bytes: &mut Bytes<'_>| {
        let bits = bytes.word();
        std::array::from_fn(|index| bits >> index & 1 != 0)
    };
    SceneOptions::default()
        .with_label(LABELS[bytes.below(5)])
        .with_frame(FRAMES[bytes.below(4)])
        .with_geomgroup(group(bytes))
        .with_sitegroup(group(bytes))
        .with_jointgroup(group(bytes))
        .with_tendongroup(group(bytes))
        .with_actuatorgroup(group(bytes))
        .with_skingroup(group(bytes))
        .with_flexgroup(group(bytes))
        .with_flags(VisualFlags::from_bits_retain(bytes.word() as u32))
}

fn action(bytes: &mut Bytes<'_>) -> MouseAction {
    [MouseAction::RotateV, MouseAction::RotateH, MouseAction::MoveV, MouseAction::MoveH, MouseAction::Zoom]
        [bytes.below(5)]
}

/// Moves the camera; ids are valid only for the camera's own model.
fn aim(view: &mut SceneView, data: &Data, bytes: &mut Bytes<'_>) -> Result<()> {
    let camera = &mut view.camera;
    camera.view = match bytes.below(4) {
        0 => CameraView::Tracking(read_only::body(data, bytes)?),
        1 => CameraView::Fixed(data.model().camera(bytes.index(data.model().ncam()))?.id()),
        2 => CameraView::User,
        _ => CameraView::Free,
    };
    let number = bytes.number();
    match bytes.below(6) {
        0 => camera.lookat[bytes.below(3)] = number,
        1 => camera.distance = number,
        2 => camera.azimuth = number,
        3 => camera.elevation = number,
        _ => *camera = Camera { view: camera.view, ..Camera::free(data.model()) },
    }
    Ok(())
}

fn new_geom(data: &Data, bytes: &mut Bytes<'_>) -> Result<NewGeom> {
    const CONNECTORS: [Connector; 6] = [
        Connector::Capsule,
        Connector::Cylinder,
        Connector::Arrow,
        Connector::Arrow1,
        Connector::Arrow2,
        Connector::Line,
    ];
    let model = data.model();
    let mesh = |bytes: &mut Bytes<'_>| model.mesh(bytes.index(model.nmesh())).map(|mesh| mesh.id());
    let mut geom = match bytes.below(11) {
        0 => NewGeom::plane(bytes.numbers()),
        1 => NewGeom::sphere(bytes.number()),
        2 => NewGeom::capsule(bytes.number(), bytes.number()),
        3 => NewGeom::ellipsoid(bytes.numbers()),
        4 => NewGeom::cylinder(bytes.number(), bytes.number()),
        5 => NewGeom::cuboid(bytes.numbers()),
        6 => NewGeom::mesh(mesh(bytes)?),
        7 => NewGeom::convex_hull(mesh(bytes)?),
        8 => NewGeom::height_field(model.height_field(bytes.index(model.nhfield()))?.id()),
        9 => NewGeom::text(bytes.choose(&["a", "", "ä\u{200f}", "a\0b"]))?,
        _ => NewGeom::connector(CONNECTORS[bytes.below(6)], bytes.number(), bytes.numbers(), bytes.numbers()),
    };
    let number = bytes.number();
    match bytes.below(8) {
        0 => geom = geom.with_pos(bytes.numbers()),
        1 => geom = geom.with_mat(bytes.numbers()),
        2 => geom = geom.with_rgba([number as f32; 4]),
        3 => geom = geom.with_surface(number as f32, 0.0, 1.0, number as f32),
        4 => {
            geom = geom.with_texture(
                model.texture(bytes.index(model.ntex()))?.id(),
                TextureRepeat::PerLength([number as f32; 2]),
            );
        }
        5 => geom = geom.with_category(Categories::from_bits_retain(bytes.word() as u32)),
        6 => geom = geom.with_label(&"ä".repeat(bytes.below(60)))?,
        _ => {}
    }
    Ok(geom)
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("Scene::update", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            if bytes.once_in(2) {
                view.options = options(bytes);
            }
            let SceneView { scene, camera, perturbation, options } = view;
            let perturbation = bytes.once_in(2).then_some(&*perturbation);
            scene.update(data, options, perturbation, camera, Categories::all())
        })
    }),
    ("Scene::update with random categories", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            let SceneView { scene, camera, perturbation, .. } = view;
            let categories = Categories::from_bits_retain(bytes.word() as u32);
            scene.update(data, &options(bytes), Some(perturbation), camera, categories)
        })
    }),
    ("Scene::add_geoms", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            let SceneView { scene, perturbation, .. } = view;
            let added = scene.add_geoms(data, &options(bytes), Some(perturbation), Categories::all())?;
            assert_eq!(added.end, scene.ngeom());
            Ok(())
        })
    }),
    ("Scene::add_geom", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            if !view.fits(data) {
                let Ok(mesh) = data.model().mesh(0) else { return Ok(()) };
                must_panic(|| view.scene.add_geom(&NewGeom::mesh(mesh.id())));
                return Ok(());
            }
            for _ in 0..bytes.below(4) {
                let index = view.scene.add_geom(&new_geom(data, bytes)?)?;
                assert_eq!(index + 1, view.scene.ngeom());
            }
            Ok(())
        })
    }),
    ("the geoms, lights and skins of a scene", |scene, bytes| {
        with_view(scene, bytes, |view, _, bytes| {
            let scene = &mut view.scene;
            black_box((scene.max_geoms(), format!("{scene:?}")));
            scene.geoms().take(8).for_each(|geom| drop(black_box(format!("{geom:?} {:?}", geom.plane()))));
            black_box((scene.lights().count(), scene.skins().count()));
            for flex in scene.flexes() {
                let corners = flex.faces.as_flattened().iter().chain(flex.normals.as_flattened());
                black_box(corners.chain(flex.vertices).flatten().sum::<f32>());
                black_box((flex.edges.as_flattened().iter().max(), flex.texcoords.as_flattened().last()));
            }
            let (number, label) = (bytes.number() as f32, "a".repeat(bytes.below(120)));
            for mut geom in scene.geoms_mut().take(2) {
                geom.set_rgba([number; 4]);
                geom.set_emission(number);
                geom.set_pos([number; 3]);
                geom.set_label(&label)?;
            }
            scene.set_render_flags(RenderFlags::from_bits_retain(bytes.word() as u32));
            black_box(scene.render_flags());
            if bytes.once_in(8) {
                scene.clear();
            }
            Ok(())
        })
    }),
    ("Scene::select, Perturbation::select", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            let aspectratio = if bytes.once_in(4) { bytes.number() } else { 1.5 };
            let at = if bytes.once_in(4) { bytes.numbers() } else { [bytes.below(9) as f64 / 8.0; 2] };
            let found = view.scene.select(data, &view.options, aspectratio, at)?;
            found.map_or(Ok(()), |found| view.perturbation.select(data, &found))
        })
    }),
    ("Camera::move_by, Scene::update_camera", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            if view.fits(data) {
                aim(view, data, bytes)?;
            }
            let motion = if bytes.once_in(4) { bytes.numbers() } else { [bytes.fraction(), bytes.fraction()] };
            let result = view.camera.move_by(data.model(), action(bytes), motion, &view.scene);
            expected(&result);
            view.scene.update_camera(data, &mut view.camera)
        })
    }),
    ("the viewpoints and the model transform of a scene", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            let scene = &mut view.scene;
            let number = bytes.number() as f32;
            let mut viewpoint =
                Viewpoint { frustum_top: 0.1, frustum_near: 0.01, frustum_far: 10.0, ..scene.viewpoint() };
            match bytes.below(8) {
                0 => viewpoint.pos.fill(number),
                1 => viewpoint.forward = [number, 1.0, 0.0],
                2 => viewpoint.up = [0.0, 0.0, number],
                3 => viewpoint.frustum_center = number,
                4 => viewpoint.frustum_bottom = number,
                5 => viewpoint.frustum_near = number,
                6 => viewpoint.frustum_far = number,
                _ => {}
            }
            let other = scene.viewpoints()[1];
            expected(&scene.set_viewpoints([viewpoint, if bytes.once_in(2) { other } else { viewpoint }]));
            let scale = [1.0, 0.01, 100.0, number][bytes.below(4)];
            let rotate = bytes.numbers().map(|number: f64| number as f32);
            let transform = Transform { translate: [number; 3], rotate, scale };
            expected(&scene.set_transform(bytes.once_in(2).then_some(transform)));
            expected(&scene.move_model(data.model(), action(bytes), bytes.numbers(), bytes.numbers()));
            black_box((scene.camera_in_model()?, scene.camera_in_room()?, scene.frustum_height()?));
            black_box((scene.transform(), scene.room_to_model(bytes.numbers(), bytes.numbers())?));
            black_box(scene::align_to_camera(bytes.numbers(), bytes.numbers()));
            scene.model_to_room(bytes.numbers(), bytes.numbers()).map(drop)
        })
    }),
    ("Perturbation", |scene, bytes| {
        with_view(scene, bytes, |view, data, bytes| {
            let fits = view.fits(data);
            let SceneView { scene, perturbation, .. } = view;
            if !fits {
                if perturbation.select.is_some() {
                    must_panic(|| perturbation.force(data));
                }
                return perturbation.start(data, scene);
            }
            if bytes.once_in(2) {
                perturbation.select = Some(read_only::body(data, bytes)?);
            }
            if bytes.once_in(8) {
                let model = data.model();
                perturbation.skinselect = Some(model.skin(bytes.index(model.nskin()))?.id());
            }
            perturbation.active = PerturbationFlags::from_bits_retain(bytes.word() as u32);
            perturbation.active2 = PerturbationFlags::from_bits_truncate(bytes.word() as u32);
            let number = bytes.number();
            match bytes.below(12) {
                0 => perturbation.refpos[bytes.below(3)] = number,
                1 => perturbation.refquat[bytes.below(4)] = number,
                2 => perturbation.refquat = [0.0; 4],
                3 => perturbation.localpos.fill(number),
                4 => perturbation.scale = number,
                5 => (perturbation.refpos, perturbation.refquat) = ([0.0; 3], [1.0, 0.0, 0.0, 0.0]),
                6 => (perturbation.localpos, perturbation.scale) = ([0.0; 3], 1.0),
                _ => {}
            }
            expected(&perturbation.start(data, scene));
            let motion = if bytes.once_in(4) { bytes.numbers() } else { [bytes.fraction(), bytes.fraction()] };
            expected(&perturbation.move_by(data, action(bytes), motion, scene));
            expected(&perturbation.apply_pose(data, bytes.either(MovableBodies::MocapAndFree, MovableBodies::Mocap)));
            expected(&perturbation.apply_force(data));
            if bytes.once_in(2) {
                expected(&data.step());
            }
            match bytes.below(4) {
                0 => perturbation.remove_force(data),
                1 => perturbation.unselect(),
                2 => perturbation.stop(),
                _ => {}
            }
            Ok(())
        })
    }),
];
