//! Saving of specs with their meshes.

use std::path::{Path, PathBuf};

use mujoco_safe::spec::{Mount, Spec};
use mujoco_safe::{Error, Model};

use super::{corner, joint, link, mesh, put, robot, sizes};

fn read(path: &Path) -> Spec {
    Spec::from_xml_path(path).unwrap()
}

/// Returns a spec with two meshes of the same name in packages, and the folder with them.
fn two_parts() -> (tempfile::TempDir, Spec) {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path().join("arm/part.obj"), &corner(1.0));
    put(folder.path().join("hand/part.obj"), &corner(2.0));
    let content = mesh("collision", "package://arm/part.obj") + &mesh("collision", "package://hand/part.obj");
    let text = link("a", "") + &link("b", &content) + &joint("j", "revolute", "a", "b", "<origin rpy='0 .1 0'/>");
    put(folder.path().join("arm/arm.urdf"), &robot(&text));
    let spec = Spec::from_xml_path(folder.path().join("arm/arm.urdf")).unwrap();
    (folder, spec)
}

#[test]
fn saved_files_load_from_elsewhere() {
    let (folder, spec) = two_parts();
    let model = spec.compile().unwrap();
    let other = tempfile::tempdir().unwrap();
    let absolute = other.path().join("scene.xml");
    spec.save_xml(&absolute).unwrap();
    let copied = other.path().join("copied.xml");
    spec.save_xml_with_assets(&copied).unwrap();
    let text = std::fs::read_to_string(&copied).unwrap();
    assert!(text.contains(r#"name="part1" file="copied_assets/part-2.obj""#), "{text}");
    for path in [&absolute, &copied] {
        super::check(&Model::from_xml_path(path).unwrap(), &model, "saved");
        super::check(&read(path).compile().unwrap(), &model, "saved, read as a spec");
    }
    drop(folder);
    let moved = tempfile::tempdir().unwrap();
    std::fs::rename(&copied, moved.path().join("copied.xml")).unwrap();
    std::fs::rename(other.path().join("copied_assets"), moved.path().join("copied_assets")).unwrap();
    super::check(&Model::from_xml_path(moved.path().join("copied.xml")).unwrap(), &model, "moved");

    // The files do not exist any more.
    assert!(matches!(spec.save_xml(&absolute), Err(Error::File { .. })));
    assert!(matches!(spec.save_xml_with_assets(other.path().join("new.xml")), Err(Error::File { .. })));
    assert!(!other.path().join("new_assets").exists());
}

/// MJCF has other assets, and settings for their directories.
#[test]
fn assets_of_mjcf_are_saved() {
    let folder = super::super::super::assets::folder();
    let text = "<mujoco>
        <compiler meshdir='meshes/' texturedir='images/'/>
        <asset>
          <mesh name='stl' file='solid.stl'/><mesh file='solid.obj'/>
          <hfield name='hills' file='hills.bin' size='1 1 1 .1'/><hfield file='dunes.png' size='1 1 1 .1'/>
          <texture type='2d' file='flat.png'/><material name='flat' texture='flat'/>
        </asset>
        <worldbody>
          <geom type='hfield' hfield='hills'/><geom type='hfield' hfield='dunes'/>
          <body><freejoint/><geom type='mesh' mesh='stl' material='flat'/><geom type='mesh' mesh='solid'/></body>
        </worldbody>
      </mujoco>";
    put(folder.path().join("model.xml"), text);
    let spec = Spec::from_xml_path(folder.path().join("model.xml")).unwrap();
    let model = spec.compile().unwrap();
    let other = tempfile::tempdir().unwrap();
    spec.save_xml(other.path().join("scene.xml")).unwrap();
    spec.save_xml_with_assets(other.path().join("copied.xml")).unwrap();
    for name in ["scene.xml", "copied.xml"] {
        super::check(&Model::from_xml_path(other.path().join(name)).unwrap(), &model, name);
    }

    put(folder.path().join("m/part.obj"), &corner(1.0));
    let text = "<mujoco><compiler meshdir='m' strippath='true'/><asset><mesh file='away/part.obj'/></asset>
        <worldbody><geom type='mesh' mesh='part'/></worldbody></mujoco>";
    put(folder.path().join("stripped.xml"), text);
    let spec = Spec::from_xml_path(folder.path().join("stripped.xml")).unwrap();
    let path = other.path().join("stripped.xml");
    for is_copied in [false, true] {
        if is_copied { spec.save_xml_with_assets(&path) } else { spec.save_xml(&path) }.unwrap();
        assert_eq!(sizes(&Model::from_xml_path(&path).unwrap()), [1.0]);
    }
}

/// Returns the names and contents of the files of a folder.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            found.push((path.clone(), std::fs::read(path).unwrap_or_default()));
        }
    }
    found.sort();
    found
}

/// Returns the path of a robot with a mesh `part.obj` of a size.
fn with_part(folder: &Path, size: f64) -> PathBuf {
    put(folder.join("part.obj"), &corner(size));
    put(folder.join("robot.urdf"), &robot(&link("a", &mesh("collision", "part.obj"))));
    folder.join("robot.urdf")
}

#[test]
fn a_scene_is_saved_again_to_its_own_path() {
    let folder = tempfile::tempdir().unwrap();
    let robots: Vec<PathBuf> =
        (1..=6).map(|number| with_part(&folder.path().join(format!("robot{number}")), f64::from(number))).collect();
    let path = folder.path().join("scene.xml");
    let mut expected = Vec::new();
    for (number, robot) in robots.iter().enumerate() {
        let mut scene = if number == 0 { Spec::new("scene") } else { read(&path) };
        // The meshes of the new robot come first.
        let mut next = Spec::new("scene");
        next.attach(&read(robot), Mount::body(next.world()), &format!("{number}/")).unwrap();
        next.attach(&scene, Mount::body(next.world()), "").unwrap();
        if number % 2 == 0 {
            scene.attach(&read(robot), Mount::body(scene.world()), &format!("{number}/")).unwrap();
            next = scene;
        }
        let before = contents(folder.path());
        next.save_xml_with_assets(&path).unwrap();
        let after = contents(folder.path());
        // No file but the scene was changed.
        for file in before.iter().filter(|(name, _)| *name != path) {
            assert!(after.contains(file), "{:?}", file.0);
        }
        expected.push(number as f64 + 1.0);
        let mut found = sizes(&Model::from_xml_path(&path).unwrap());
        found.sort_by(f64::total_cmp);
        assert_eq!(found, expected);
        // Nothing is written again.
        read(&path).save_xml_with_assets(&path).unwrap();
        let names = |files: &[(PathBuf, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&contents(folder.path())), names(&after));
    }
}

#[test]
fn files_with_the_name_of_the_folder_of_another_scene_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    for (number, name) in [(1.0, "robot.xml"), (2.0, "robot.mjcf")] {
        read(&with_part(&folder.path().join(name.replace('.', "_")), number))
            .save_xml_with_assets(folder.path().join(name))
            .unwrap();
    }
    for (number, name) in [(1.0, "robot.xml"), (2.0, "robot.mjcf")] {
        assert_eq!(sizes(&Model::from_xml_path(folder.path().join(name)).unwrap()), [number]);
    }
}

#[test]
#[cfg(unix)]
fn links_are_not_followed() {
    let folder = tempfile::tempdir().unwrap();
    let precious = folder.path().join("precious.obj");
    put(&precious, "precious");
    let spec = read(&with_part(&folder.path().join("robot"), 1.0));
    let assets = folder.path().join("scene_assets");
    std::fs::create_dir(&assets).unwrap();
    std::os::unix::fs::symlink(&precious, assets.join("part.obj")).unwrap();
    std::os::unix::fs::symlink(folder.path().join("missing"), assets.join("part-2.obj")).unwrap();
    let path = folder.path().join("scene.xml");
    spec.save_xml_with_assets(&path).unwrap();
    assert_eq!(std::fs::read(&precious).unwrap(), b"precious");
    assert!(!folder.path().join("missing").exists());
    assert_eq!(sizes(&Model::from_xml_path(&path).unwrap()), [1.0]);

    std::os::unix::fs::symlink(folder.path().join("robot"), folder.path().join("other_assets")).unwrap();
    let before = contents(folder.path());
    let error = spec.save_xml_with_assets(folder.path().join("other.xml")).unwrap_err();
    assert!(matches!(&error, Error::Save { .. }) && error.to_string().contains("symbolic link"), "{error}");
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn a_failed_save_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let spec = read(&with_part(&folder.path().join("robot"), 1.0));
    // A directory has the name of the scene.
    std::fs::create_dir(folder.path().join("scene.xml")).unwrap();
    let before = contents(folder.path());
    assert!(matches!(spec.save_xml_with_assets(folder.path().join("scene.xml")), Err(Error::File { .. })));
    assert_eq!(contents(folder.path()), before);
    assert!(!folder.path().join("scene_assets").exists());
    // A directory has the name of a copy, which gets another one.
    std::fs::create_dir_all(folder.path().join("new_assets/part.obj")).unwrap();
    spec.save_xml_with_assets(folder.path().join("new.xml")).unwrap();
    assert_eq!(sizes(&Model::from_xml_path(folder.path().join("new.xml")).unwrap()), [1.0]);

    // A later asset is missing.
    let (parts, spec) = two_parts();
    let path = parts.path().join("scene.xml");
    put(&path, "<mujoco/>");
    std::fs::remove_file(parts.path().join("hand/part.obj")).unwrap();
    assert!(matches!(spec.save_xml_with_assets(&path), Err(Error::File { .. })));
    assert!(!parts.path().join("scene_assets").exists());
    assert_eq!(std::fs::read(&path).unwrap(), b"<mujoco/>");
}
