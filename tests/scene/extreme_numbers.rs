//! Extreme numbers and sizes: an error or a scene, in bounded time and memory.

use mujoco_safe::scene::{
    Camera, Categories, Connector, MouseAction, MovableBodies, NewGeom, Perturbation, Scene, SceneOptions,
};
use mujoco_safe::{Data, Error, Model, sample};

const NUMBERS: [f64; 10] = [0.0, -0.0, -1.0, 1e-320, 1e-30, 1e30, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn computed(model: Model) -> Data {
    let mut data = Data::new(model).unwrap();
    data.forward().unwrap();
    data
}

#[test]
fn scene_sizes_near_the_integer_limits_are_errors_or_scenes() {
    let mut data = computed(sample::cartpole());
    let largest = i32::MAX as usize;
    for room in [0, 1, 2, 1000, largest / 2, largest - 1, largest, largest + 1, usize::MAX / 2, usize::MAX] {
        match Scene::new(data.model(), room) {
            Ok(mut scene) => {
                assert_eq!(scene.max_geoms(), room);
                let mut camera = Camera::free(data.model());
                let updated = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
                assert!(matches!(updated, Ok(()) | Err(Error::SceneFull { .. })), "{room}: {updated:?}");
                assert!(scene.ngeom() <= room);
            }
            Err(error) => {
                assert!(matches!(error, Error::Invalid { .. } | Error::OutOfMemory { .. }), "{room}: {error}");
            }
        }
    }
}

#[test]
fn cameras_mice_and_geoms_of_any_numbers_are_errors_or_scenes() {
    let mut data = computed(sample::humanoid());
    let mut scene = Scene::new(data.model(), 500).unwrap();
    let options = SceneOptions::default();
    for number in NUMBERS {
        let mut camera = Camera::free(data.model());
        let _ = scene.update(&mut data, &options, None, &mut camera, Categories::all());
        for action in [MouseAction::RotateV, MouseAction::MoveH, MouseAction::Zoom] {
            let mut moved = Camera::free(data.model());
            for _ in 0..3 {
                let _ = moved.move_by(data.model(), action, [number, number], &scene);
                let _ = scene.update(&mut data, &options, None, &mut moved, Categories::all());
            }
        }
        let mut perturbation = Perturbation::default();
        let _ = perturbation.start(&mut data, &scene);
        let _ = perturbation.move_by(&data, MouseAction::MoveV, [number, number], &scene);
        let _ = perturbation.apply_pose(&mut data, MovableBodies::MocapAndFree);
        data.reset().unwrap();
        data.forward().unwrap();
        let _ = scene.set_viewpoints(scene.viewpoints());
        for geom in [
            NewGeom::sphere(number),
            NewGeom::capsule(number, number),
            NewGeom::cuboid([number; 3]),
            NewGeom::plane([number; 2]),
            NewGeom::connector(Connector::Arrow, number, [number; 3], [0.0; 3]),
            NewGeom::sphere(0.1).with_pos([number; 3]).with_mat([number; 9]).with_rgba([number as f32; 4]),
        ] {
            let before = scene.ngeom();
            if scene.add_geom(&geom).is_err() {
                assert_eq!(scene.ngeom(), before);
            }
        }
        let _ = scene.select(&data, &options, 1.0, [number, number]);
        let _ = scene.select(&data, &options, number, [0.5, 0.5]);
        let _ = scene.room_to_model([number; 3], [number; 4]);
        let _ = mujoco_safe::scene::align_to_camera([number; 3], [number; 3]);
    }
}

#[test]
fn models_of_any_numbers_make_a_scene() {
    for number in NUMBERS {
        let mut model = sample::humanoid();
        let mut edit = model.edit();
        edit.geom_size_mut().as_flattened_mut().fill(number);
        edit.geom_rbound_mut().fill(number);
        edit.light_pos_mut().as_flattened_mut().fill(number);
        edit.cam_fovy_mut().fill(number);
        edit.cam_quat_mut().as_flattened_mut().fill(number);
        edit.site_size_mut().as_flattened_mut().fill(number);
        edit.tendon_width_mut().fill(number);
        let mut data = Data::new(model).unwrap();
        if data.forward().is_err() {
            continue;
        }
        let mut scene = Scene::new(data.model(), 500).unwrap();
        let mut camera = Camera::free(data.model());
        let _ = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
        let _ = scene.select(&data, &SceneOptions::default(), 1.0, [0.5, 0.5]);
    }
}
