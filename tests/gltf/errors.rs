//! Errors for trajectories and states that cannot be saved.

use mujoco_safe::gltf::GltfOptions;
use mujoco_safe::{Data, Error, Model, Trajectory, sample};

use crate::file::{recorded, still};

#[test]
fn what_cannot_be_saved_is_an_error() {
    let model = sample::cartpole();
    let trajectory = recorded(&model, 0, 10);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("never_written.glb");
    let save = |trajectory: &Trajectory, options: &GltfOptions| trajectory.save_glb(model.clone(), &path, options);
    let good = GltfOptions::default();
    for options in [
        good.clone().with_rotation_error(0.0),
        good.clone().with_rotation_error(f64::NAN),
        good.clone().with_frames_per_second(-1.0),
        good.clone().with_frames_per_second(f64::NAN),
    ] {
        assert!(matches!(save(&trajectory, &options), Err(Error::Invalid { .. })), "{options:?}");
    }
    assert!(matches!(save(&Trajectory::new(&model), &good), Err(Error::Invalid { .. })));
    assert!(save(&recorded(&sample::humanoid(), 0, 2), &good).is_err());
    assert!(matches!(mujoco_safe::gltf::save(&path, model.clone(), [], &good), Err(Error::Invalid { .. })));
    let mut data = Data::new(model.clone()).unwrap();
    for value in [f64::NAN, f64::INFINITY, 1e300] {
        data.qpos_mut()[0] = value;
        let mut trajectory = Trajectory::new(&model);
        trajectory.push(&data).unwrap();
        assert!(save(&trajectory, &good).is_err(), "{value}");
        assert!(data.save_glb(&path, &good).is_err(), "{value}");
        data.reset().unwrap();
    }
    assert!(!path.exists());
    let missing = folder.path().join("no_folder").join("file.glb");
    assert!(matches!(trajectory.save_glb(model.clone(), missing, &good), Err(Error::File { .. })));
}

#[test]
fn a_model_with_numbers_that_are_not_finite_has_a_valid_file_or_an_error() {
    for value in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        let mut model = Model::from_xml_str(
            "<mujoco><asset><material name='m' emission='.5'/></asset><worldbody><light pos='0 0 3'/><camera/>
               <geom size='.1' material='m'/><geom type='box' size='.1 .1 .1'/></worldbody></mujoco>",
        )
        .unwrap();
        let mut edit = model.edit();
        edit.geom_size_mut()[0] = [value; 3];
        edit.geom_rgba_mut()[1] = [value as f32; 4];
        edit.light_diffuse_mut()[0] = [value as f32; 3];
        edit.mat_emission_mut()[0] = value as f32;
        // The reader parses all numbers.
        let file = still(&model);
        assert!(file.gltf.nodes().any(|node| node.mesh().is_some()), "{value}");
    }
}

#[test]
fn an_empty_model_has_a_file() {
    let model = Model::from_xml_str("<mujoco/>").unwrap();
    let file = still(&model);
    assert_eq!((file.gltf.meshes().len(), file.gltf.blob.is_some()), (0, false));
    assert!(file.left_out.is_empty());
}
