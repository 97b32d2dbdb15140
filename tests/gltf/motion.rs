//! Poses of nodes equal those of the engine.

use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::nalgebra::{Point3, Vector3};
use mujoco_safe::{Data, Model, Trajectory, sample};

use crate::file::{File, SHAPES, recorded, saved, z_up};

/// Returns the largest distance between a point of a geom in the file and in the engine, at a
/// distance of 0.1 m from the centre of the geom, over all geoms and their axes.
fn largest_distance(file: &File, key: Option<(usize, usize)>, data: &Data) -> f64 {
    let world = file.world(key);
    let mut largest = 0.0_f64;
    for geom in data.model().geoms().filter(|geom| geom.name().is_some()) {
        let index = geom.id().index();
        let node = file.shown(geom.name().unwrap());
        let (pos, mat) = (data.geom_xpos()[index], data.geom_xmat()[index]);
        for axis in 0..3 {
            let mut point = Point3::origin();
            point[axis] = 0.1;
            let column = Vector3::new(mat[axis], mat[3 + axis], mat[6 + axis]);
            let expected = Point3::from(pos) + 0.1 * column;
            let found = z_up(world[&node.index()] * point);
            largest = largest.max((found - expected).norm());
        }
    }
    largest
}

fn check(model: &Model, steps: usize, rotation_error: f64, tolerance: f64) {
    let trajectories = [recorded(model, 1, steps), recorded(model, 2, steps)];
    let options = GltfOptions::default().with_rotation_error(rotation_error).with_frames_per_second(f64::INFINITY);
    let file = saved(model, &[("first", &trajectories[0]), ("second", &trajectories[1])], &options);
    let mut data = Data::new(model.clone()).unwrap();
    assert_eq!(file.gltf.animations().map(|found| found.name().unwrap()).collect::<Vec<_>>(), ["first", "second"]);
    for (animation, trajectory) in trajectories.iter().enumerate() {
        let times = file.times(animation);
        assert_eq!(times.len(), steps);
        for key in [0, 1, steps / 3, steps / 2, steps - 1] {
            let time = trajectory.times()[key] - trajectory.times()[0];
            assert!((f64::from(times[key]) - time).abs() < 1e-6);
            trajectory.apply(key, &mut data).unwrap();
            data.forward().unwrap();
            let error = largest_distance(&file, Some((animation, key)), &data);
            assert!(error <= tolerance, "record {key} of animation {animation}: {error}");
        }
    }
    // At rest, the nodes have the first record.
    trajectories[0].apply(0, &mut data).unwrap();
    data.forward().unwrap();
    let error = largest_distance(&file, None, &data);
    assert!(error <= tolerance, "at rest: {error}");
}

#[test]
fn geoms_have_the_poses_of_the_engine() {
    // The error of rotations adds up along the tree: the prism is 5 m from the second of two
    // rotated bodies, the feet of the humanoid are 1 m from its torso.
    let shapes = Model::from_xml_str(SHAPES).unwrap();
    check(&shapes, 300, 1e-6, 2e-5);
    check(&shapes, 300, 1e-4, 1.5e-3);
    check(&sample::humanoid(), 300, 1e-6, 5e-6);
    check(&sample::humanoid(), 300, 1e-4, 2e-4);
}

#[test]
fn only_moving_nodes_are_animated() {
    let model = sample::cartpole();
    let file = saved(&model, &[("", &recorded(&model, 1, 200))], &GltfOptions::default());
    let animation = file.gltf.animations().next().unwrap();
    let mut animated: Vec<(String, String)> = animation
        .channels()
        .map(|channel| {
            let target = channel.target();
            (target.node().name().unwrap().to_owned(), format!("{:?}", target.property()))
        })
        .collect();
    animated.sort();
    let camera = format!("frame of {}", model.cameras().nth(1).unwrap().name().unwrap());
    let expected = [("cart", "Translation"), (&camera, "Translation"), ("pole", "Rotation")];
    assert_eq!(animated, expected.map(|(node, property)| (node.to_owned(), property.to_owned())));
}

#[test]
fn a_still_state_has_no_animation() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><body name='hand' mocap='true'><geom name='hand' size='.1'/></body></worldbody></mujoco>",
    )
    .unwrap();
    let mut data = Data::new(model).unwrap();
    data.mocap_pos_mut()[0] = [1.0, 2.0, 3.0];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.glb");
    let left_out = data.save_glb(&path, &GltfOptions::default()).unwrap();
    let file = File::read(std::fs::read(path).unwrap(), left_out);
    assert_eq!(file.gltf.animations().len(), 0);
    data.forward().unwrap();
    assert!(largest_distance(&file, None, &data) < 1e-6);
}

#[test]
fn cameras_that_track_move_with_their_target() {
    let model = Model::from_xml_str(SHAPES).unwrap();
    let trajectory = recorded(&model, 3, 100);
    let file = saved(&model, &[("", &trajectory)], &GltfOptions::default().with_rotation_error(1e-6));
    let mut data = Data::new(model.clone()).unwrap();
    trajectory.apply(99, &mut data).unwrap();
    data.forward().unwrap();
    let world = file.world(Some((0, file.times(0).len() - 1)));
    for (index, camera) in model.cameras().enumerate() {
        let node = file.gltf.nodes().find(|node| node.camera().is_some() && node.name() == camera.name()).unwrap();
        let mat = data.cam_xmat()[index];
        let expected = Point3::from(data.cam_xpos()[index]) - Vector3::new(mat[2], mat[5], mat[8]);
        let found = z_up(world[&node.index()] * Point3::new(0.0, 0.0, -1.0));
        assert!((found - expected).norm() < 2e-5, "{:?}: {found} {expected}", camera.name());
    }
    for (index, light) in model.lights().enumerate() {
        let node = file.gltf.nodes().find(|node| node.light().is_some() && node.name() == light.name()).unwrap();
        let expected = Point3::from(data.light_xpos()[index]) + Vector3::from(data.light_xdir()[index]);
        let found = z_up(world[&node.index()] * Point3::new(0.0, 0.0, -1.0));
        assert!((found - expected).norm() < 2e-5, "{:?}: {found} {expected}", light.name());
    }
}

#[test]
fn times_that_do_not_ascend_have_one_key() {
    let model = sample::cartpole();
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(&model);
    for (time, angle) in [(5.0, 0.0), (5.0, 0.1), (5.5, 0.2), (5.500_000_001, 0.3), (6.0, 0.4)] {
        data.set_time(time);
        data.qpos_mut()[1] = angle;
        trajectory.push(&data).unwrap();
    }
    let file = saved(&model, &[("", &trajectory)], &GltfOptions::default().with_frames_per_second(f64::INFINITY));
    assert_eq!(file.times(0), [0.0, 0.5, 1.0]);
}
