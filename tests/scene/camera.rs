//! Cameras, viewpoints, and the transform of the model.

use mujoco_safe::scene::{
    Camera, CameraView, Categories, MouseAction, Scene, SceneOptions, Transform, Viewpoint, align_to_camera,
};
use mujoco_safe::sys::{mjvCamera, mjvScene};
use mujoco_safe::{Data, Error, sample};

use crate::cases::cases;
use crate::raw::{RawScene, assert_same_scene, filled, scene_subjects};
use crate::twins::{Twins, assert_same, c, differing};

const ACTIONS: [MouseAction; 5] =
    [MouseAction::RotateV, MouseAction::RotateH, MouseAction::MoveV, MouseAction::MoveH, MouseAction::Zoom];

#[track_caller]
fn assert_same_camera(what: &str, ours: &Camera, theirs: &mjvCamera) {
    let numbers = |lookat: [f64; 3], others: [f64; 3]| [lookat, others].concat();
    assert_same(
        what,
        &numbers(ours.lookat, [ours.distance, ours.azimuth, ours.elevation]),
        &numbers(theirs.lookat, [theirs.distance, theirs.azimuth, theirs.elevation]),
    );
}

#[test]
fn cameras_are_found_by_name_index_id_and_view() {
    let model = sample::humanoid();
    let (side, torso) = (model.camera("side").unwrap(), model.body("torso").unwrap());
    let fixed = Camera { view: CameraView::Fixed(side.id()), ..Camera::default() };
    assert_eq!(Camera::fixed(&model, "side").unwrap(), fixed);
    assert_eq!(Camera::fixed(&model, side.id().index()).unwrap(), fixed);
    assert_eq!([Camera::fixed(&model, side.id()), Camera::fixed(&model, side)], [fixed; 2]);
    let tracking = Camera { view: CameraView::Tracking(torso.id()), ..Camera::free(&model) };
    assert_eq!(Camera::tracking(&model, "torso").unwrap(), tracking);
    assert_eq!(Camera::tracking(&model, torso.id().index()).unwrap(), tracking);
    assert_eq!([Camera::tracking(&model, torso.id()), Camera::tracking(&model, torso)], [tracking; 2]);
    assert!(matches!(Camera::fixed(&model, "torso"), Err(Error::NoSuchName { .. })));
    assert!(matches!(Camera::tracking(&model, model.nbody()), Err(Error::NoSuchIndex { .. })));
}

#[test]
#[should_panic(expected = "another model")]
fn a_camera_of_another_model_panics() {
    let other = sample::humanoid();
    let _ = Camera::fixed(&sample::humanoid(), other.camera("side").unwrap());
}

#[test]
fn cameras_move_as_in_c() {
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        let model = twins.model.clone();
        let mut ours = Scene::new(&model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let body = model.bodies().last().unwrap().id();
        let fixed = model.cameras().last().map(|camera| CameraView::Fixed(camera.id()));
        for view in [Some(CameraView::Free), Some(CameraView::Tracking(body)), fixed].into_iter().flatten() {
            let mut camera = Camera { view, ..Camera::free(&model) };
            let mut raw: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(model.as_ptr(), camera)));
            match view {
                CameraView::Tracking(body) => (raw.type_, raw.trackbodyid) = (1, body.index() as i32),
                CameraView::Fixed(camera) => (raw.type_, raw.fixedcamid) = (2, camera.index() as i32),
                _ => (),
            }
            for round in 0..cases(5, 20) {
                let options = SceneOptions::default();
                ours.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
                theirs.update(&twins.raw, &options, None, &mut raw);
                let what = format!("{}, {view:?}, round {round}", subject.name);
                assert_same_scene(&what, &ours, &theirs, true);
                assert_same_camera(&what, &camera, &raw);
                let motion = twins.numbers(2);
                let action = ACTIONS[round % ACTIONS.len()];
                camera.move_by(&model, action, [motion[0], motion[1]], &ours).unwrap();
                let number = [1, 2, 3, 4, 5][round % ACTIONS.len()];
                // SAFETY: the scene was updated with the model.
                unsafe { differing::move_camera(model.as_ptr(), number, [motion[0], motion[1]], &theirs.0, &mut raw) };
                assert_same_camera(&what, &camera, &raw);
            }
        }
    }
}

#[test]
fn viewpoints_equal_c() {
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        let mut ours = Scene::new(&twins.model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let mut camera = Camera::free(&twins.model);
        let mut raw: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(twins.raw.m(), camera)));
        ours.update_camera(&twins.ours, &mut camera).unwrap();
        c!(mjv_updateCamera(twins.raw.m(), twins.raw.d, &raw mut raw, &raw mut *theirs.0));
        let eyes = &theirs.0.camera;
        let average = c!(mjv_averageCamera(&raw const eyes[0], &raw const eyes[1]));
        for (ours, theirs) in ours.viewpoints().iter().zip(eyes).chain([(&ours.viewpoint(), &average)]) {
            assert_eq!((ours.pos, ours.forward, ours.up), (theirs.pos, theirs.forward, theirs.up));
            assert_eq!((ours.frustum_bottom, ours.frustum_top), (theirs.frustum_bottom, theirs.frustum_top));
            assert_eq!((ours.frustum_near, ours.frustum_far), (theirs.frustum_near, theirs.frustum_far));
            assert_eq!(ours.frustum_center, theirs.frustum_center);
        }
        let height = ours.frustum_height().unwrap();
        assert_same("height", &[height], &[c!(mjv_frustumHeight(&raw const *theirs.0))]);

        let transform = Transform { translate: [0.5, -1.0, 2.0], rotate: [0.6, 0.0, 0.8, 0.0], scale: 1.5 };
        for transform in [None, Some(transform)] {
            ours.set_transform(transform).unwrap();
            assert_eq!(ours.transform(), transform);
            if let Some(Transform { translate, rotate, scale }) = transform {
                theirs.0.enabletransform = 1;
                (theirs.0.translate, theirs.0.rotate, theirs.0.scale) = (translate, rotate, scale);
            }
            assert_same_transform(&ours, &theirs.0);
        }
        for action in ACTIONS {
            let motion = twins.numbers(2);
            ours.move_model(&twins.model, action, [motion[0], motion[1]], [0.0, 0.0, 1.0]).unwrap();
            let number = 1 + ACTIONS.iter().position(|other| *other == action).unwrap() as i32;
            let (m, up) = (twins.raw.m(), [0.0, 0.0, 1.0]);
            c!(mjv_moveModel(m, number, motion[0], motion[1], up.as_ptr(), &raw mut *theirs.0));
            let moved = ours.transform().unwrap();
            assert_eq!((moved.translate, moved.rotate), (theirs.0.translate, theirs.0.rotate));
            assert_eq!(moved.scale, theirs.0.scale);
            assert_same_transform(&ours, &theirs.0);
        }
    }
}

#[track_caller]
fn assert_same_transform(ours: &Scene, theirs: &mjvScene) {
    let three = |fill: &mut dyn FnMut(*mut f64, *mut f64, *mut f64)| {
        let mut head = [[0.0; 3]; 3];
        let [pos, forward, up] = &mut head;
        fill(pos.as_mut_ptr(), forward.as_mut_ptr(), up.as_mut_ptr());
        head.concat()
    };
    let head = ours.camera_in_model().unwrap();
    let raw = three(&mut |pos, forward, up| c!(mjv_cameraInModel(pos, forward, up, theirs)));
    assert_same("in the model", &[head.pos, head.forward, head.up].concat(), &raw);
    let head = ours.camera_in_room().unwrap();
    let raw = three(&mut |pos, forward, up| c!(mjv_cameraInRoom(pos, forward, up, theirs)));
    assert_same("in the room", &[head.pos, head.forward, head.up].concat(), &raw);

    let (pos, quat) = ([0.1, 0.2, 0.3], [0.5, 0.5, -0.5, 0.5]);
    let (mut raw_pos, mut raw_quat) = ([0.0; 3], [0.0; 4]);
    let (to_pos, to_quat) = (raw_pos.as_mut_ptr(), raw_quat.as_mut_ptr());
    c!(mjv_room2model(to_pos, to_quat, pos.as_ptr(), quat.as_ptr(), theirs));
    let (our_pos, our_quat) = ours.room_to_model(pos, quat).unwrap();
    assert_same("to the model", &[&our_pos[..], &our_quat].concat(), &[&raw_pos[..], &raw_quat].concat());
    let (to_pos, to_quat) = (raw_pos.as_mut_ptr(), raw_quat.as_mut_ptr());
    c!(mjv_model2room(to_pos, to_quat, pos.as_ptr(), quat.as_ptr(), theirs));
    let (our_pos, our_quat) = ours.model_to_room(pos, quat).unwrap();
    assert_same("to the room", &[&our_pos[..], &our_quat].concat(), &[&raw_pos[..], &raw_quat].concat());
}

#[test]
fn vectors_are_aligned_to_the_camera_as_in_c() {
    for forward in [[1.0, 0.0, 0.0], [0.3, -0.4, 2.0], [0.0, 0.0, 1.0]] {
        let (vec, mut raw) = ([0.1, 0.7, -0.2], [0.0; 3]);
        c!(mjv_alignToCamera(raw.as_mut_ptr(), vec.as_ptr(), forward.as_ptr()));
        assert_same("aligned", &align_to_camera(vec, forward), &raw);
    }
}

#[test]
fn a_scene_is_send() {
    let mut data = Data::new(mujoco_safe::sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    let count = scene.ngeom();
    let moved = std::thread::spawn(move || scene.geoms().filter(|geom| geom.size()[0] >= 0.0).count());
    assert_eq!(moved.join().unwrap(), count);
}

#[test]
fn viewpoints_keep_their_projection_or_the_engine_has_none() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.forward().unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    let eye = scene.viewpoint();
    let wide = Viewpoint { frustum_width: 0.02, ..eye };
    let orthographic = Viewpoint { orthographic: true, ..eye };
    for (changed, is_known) in [(wide, cfg!(engine_since = "3.0.0")), (orthographic, cfg!(engine_since = "3.2.0"))] {
        match scene.set_viewpoints([changed; 2]) {
            Ok(()) => assert!(is_known && scene.viewpoint() == changed, "{:?}", scene.viewpoint()),
            Err(error) => assert!(!is_known && matches!(error, Error::Unsupported(_)), "{error}"),
        }
    }
    for frustum_width in [-1.0, f32::NAN] {
        let result = scene.set_viewpoints([Viewpoint { frustum_width, ..eye }; 2]);
        assert!(matches!(result, Err(Error::Invalid { .. })), "{frustum_width}");
    }
}
