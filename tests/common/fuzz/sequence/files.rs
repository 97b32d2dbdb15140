//! Files that each call writes, damages and reads in a temporary folder.

use std::fs;

use mujoco_safe::{Data, Error, Model, RandomController, Result, Trajectory};

use super::super::assets;
use super::{Bytes, Call, Scene};

/// Returns `true` if a model is small enough to be written and read often.
fn small(model: &Model) -> bool {
    model.nbuffer() < 200_000
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("no temporary folder")
}

fn trajectory(scene: &mut Scene<'_>, bytes: &mut Bytes<'_>) -> Result<Trajectory> {
    let model = scene.data.model();
    let mut trajectory = if bytes.once_in(2) {
        Trajectory::with_sensordata(model)
    } else {
        Trajectory::with_capacity(model, bytes.below(3))
    };
    trajectory.record(&mut scene.data, &mut RandomController::new(1), bytes.below(3))?;
    Ok(trajectory)
}

/// Occasionally damages a file.
fn damage(path: &std::path::Path, bytes: &mut Bytes<'_>) {
    if bytes.once_in(2) {
        let mut content = fs::read(path).expect("the file was written");
        assets::damage(&mut content, bytes);
        fs::write(path, content).expect("the folder is writable");
    }
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("to_binary, from_binary", |scene, bytes| {
        if !bytes.once_in(if small(scene.data.model()) { 4 } else { 16 }) {
            return Ok(());
        }
        let file = scene.data.model().to_binary()?;
        // A model with arbitrary numbers may be rejected.
        scene.other = Some(Data::new(Model::from_binary(&file)?)?);
        Ok(())
    }),
    ("save_xml", |scene, bytes| {
        if !bytes.once_in(16) {
            return Ok(());
        }
        match scene.data.model().save_xml(folder().path().join("saved.xml")) {
            Err(Error::XmlReplaced) => Ok(()),
            result => result,
        }
    }),
    ("save_binary, from_binary_path", |scene, bytes| {
        if !small(scene.data.model()) || !bytes.once_in(16) {
            return Ok(());
        }
        let folder = folder();
        let path = folder.path().join("saved.mjb");
        scene.data.model().save_binary(&path)?;
        damage(&path, bytes);
        Model::from_binary_path(&path).map(drop)
    }),
    ("print_to", |scene, bytes| {
        if !bytes.once_in(16) {
            return Ok(());
        }
        let folder = folder();
        let name = *bytes.choose(&[&"data.txt", &"", &"no/folder", &"%s%n", &"a\0b"]);
        scene.data.print_to(folder.path().join(name))
    }),
    ("save_csv, load_csv", |scene, bytes| {
        if !bytes.once_in(16) {
            return Ok(());
        }
        let (folder, trajectory) = (folder(), trajectory(scene, bytes)?);
        let path = folder.path().join("trajectory.csv");
        trajectory.save_csv(&path)?;
        damage(&path, bytes);
        let trajectory = Trajectory::load_csv(scene.data.model(), &path)?;
        if trajectory.is_empty() { Ok(()) } else { trajectory.apply(trajectory.len() - 1, &mut scene.data) }
    }),
    #[cfg(feature = "npz")]
    ("save_npz, load_npz", |scene, bytes| {
        if !bytes.once_in(16) {
            return Ok(());
        }
        let (folder, trajectory) = (folder(), trajectory(scene, bytes)?);
        let path = folder.path().join("trajectory.npz");
        trajectory.save_npz(&path)?;
        damage(&path, bytes);
        let trajectory = Trajectory::load_npz(scene.data.model(), &path)?;
        if trajectory.is_empty() { Ok(()) } else { trajectory.apply(trajectory.len() - 1, &mut scene.data) }
    }),
];
