//! Meshes of a URDF in other directories and packages, and saving with them.

use std::path::Path;

use mujoco_safe::spec::{Spec, UrdfWarning};
use mujoco_safe::{Error, LoadOptions, Model};

use super::{corner, joint, link, robot};

fn mesh(role: &str, file: &str) -> String {
    format!("<{role}><geometry><mesh filename='{file}'/></geometry></{role}>")
}

fn put(path: impl AsRef<Path>, content: &str) {
    std::fs::create_dir_all(path.as_ref().parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Returns the lengths of the meshes' longest edges, in the order of the geoms.
fn sizes(model: &Model) -> Vec<f64> {
    let longest = |geom: usize| {
        let mesh = model.geom_dataid()[geom] as usize;
        let (start, count) = (model.mesh_vertadr()[mesh] as usize, model.mesh_vertnum()[mesh] as usize);
        let vertices = &model.mesh_vert()[start..start + count];
        let distance = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|i| f64::from(a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        vertices.iter().flat_map(|a| vertices.iter().map(move |b| distance(a, b))).fold(0.0, f64::max)
    };
    (0..model.ngeom()).map(|geom| (longest(geom) / 2.0_f64.sqrt() * 1e3).round() / 1e3).collect()
}

fn compiled(path: &Path) -> Model {
    Spec::from_xml_path(path).unwrap().compile().unwrap()
}

#[test]
fn relative_names_are_found_in_their_directories() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    put(folder.path().join("meshes/part.obj"), &corner(1.0));
    put(folder.path().join("other/part.obj"), &corner(2.0));
    put(folder.path().join("flat.obj"), &corner(3.0));
    let absolute = folder.path().join("other/part.obj").display().to_string();
    let content = [
        "meshes/part.obj",
        "other/part.obj",
        "./meshes/../meshes/part.obj",
        // Only beside the URDF, where the engine looks.
        "away/flat.obj",
        &absolute,
        &format!("file://{absolute}"),
    ];
    let content: String = content.into_iter().map(|file| mesh("collision", file)).collect();
    put(&path, &robot(&link("a", &content)));
    assert_eq!(sizes(&compiled(&path)), [1.0, 2.0, 1.0, 3.0, 2.0, 2.0]);

    // The names are those that the engine's reader gives, with a number for another file.
    let spec = Spec::from_xml_path(&path).unwrap();
    let names: Vec<_> = spec.ids::<mujoco_safe::kind::Mesh>().into_iter().map(|id| spec.element(id).name()).collect();
    assert_eq!(names[..2], [Some("part"), Some("part1")]);

    // The setting of MuJoCo for the directory, and the one by which only the last part counts.
    let content = mesh("collision", "part.obj");
    put(&path, &robot(&format!("<mujoco><compiler meshdir='other'/></mujoco>{}", link("a", &content))));
    assert_eq!(sizes(&compiled(&path)), [2.0]);
    put(folder.path().join("part.obj"), &corner(4.0));
    let content = mesh("collision", "meshes/part.obj");
    put(&path, &robot(&format!("<mujoco><compiler strippath='true'/></mujoco>{}", link("a", &content))));
    assert_eq!(sizes(&compiled(&path)), [4.0]);
}

#[test]
fn packages_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("src/arm_description/urdf/arm.urdf");
    put(folder.path().join("src/arm_description/meshes/part.obj"), &corner(1.0));
    put(folder.path().join("src/hand/meshes/part.obj"), &corner(2.0));
    put(folder.path().join("share/base/part.obj"), &corner(3.0));
    put(folder.path().join("src/package.xml"), "<package><name> whole </name></package>");
    put(folder.path().join("src/part.obj"), &corner(4.0));
    let files = ["arm_description/meshes/part.obj", "hand/meshes/part.obj", "base/part.obj", "whole/part.obj"];
    let content: String = files.into_iter().map(|file| mesh("collision", &format!("package://{file}"))).collect();
    put(&path, &robot(&link("a", &content)));
    assert_eq!(sizes(&compiled(&path)), [1.0, 2.0, 3.0, 4.0]);

    // A given directory takes precedence.
    let other = tempfile::tempdir().unwrap();
    put(other.path().join("meshes/part.obj"), &corner(5.0));
    let options = LoadOptions::default().with_package("hand", other.path());
    let model = Spec::from_xml_path_with(&path, &options).unwrap().compile().unwrap();
    assert_eq!(sizes(&model), [1.0, 5.0, 3.0, 4.0]);

    // A text from memory.
    let text = robot(&link("a", &mesh("collision", "package://hand/meshes/part.obj")));
    let error = Spec::from_xml_str(&text).unwrap_err().to_string();
    assert!(error.contains("package 'hand' is unknown") && error.contains("with_package"), "{error}");
    assert!(error.contains("the mesh 'package://hand/meshes/part.obj' of link 'a' is not found"), "{error}");
    let model = Spec::from_xml_str_with(&text, &options).unwrap().compile().unwrap();
    assert_eq!(sizes(&model), [5.0]);
    // Some engines keep meshes from memory by their names.
    let (name, content) = ("in_memory.obj", corner(6.0));
    let options = options.with_file(name, content.as_bytes());
    let text = text.replace("part.obj", name);
    let model = Spec::from_xml_str_with(&text, &options).unwrap().compile_with(&options).unwrap();
    assert_eq!(sizes(&model), [6.0]);
}

#[test]
fn files_that_the_engine_does_not_read_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    put(folder.path().join("part.obj"), &corner(1.0));
    let content = mesh("visual", "package://nowhere/part.obj")
        + &mesh("visual", "missing.stl")
        + &mesh("visual", "part.dae")
        + &mesh("visual", "part.obj")
        + &mesh("collision", "part.dae")
        + &mesh("collision", "part.obj");
    put(&path, &robot(&link("a", &content)));
    let read = |options: &LoadOptions<'_>| Spec::from_xml_path_with(&path, options).unwrap();
    let spec = read(&LoadOptions::default());
    assert_eq!(spec.compile().unwrap().ngeom(), 1);
    let left_out = |spec: &Spec| -> Vec<String> {
        let meshes = spec.urdf_warnings().iter().filter(|warning| matches!(warning, UrdfWarning::Mesh { .. }));
        meshes.map(UrdfWarning::to_string).collect()
    };
    let dae = "link 'a': the mesh 'part.dae' is left out: the engine reads only stl, obj, msh";
    assert_eq!(left_out(&spec), [dae]);

    let spec = read(&LoadOptions::default().with_visuals());
    let model = spec.compile().unwrap();
    assert_eq!((model.ngeom(), model.geom_group()), (2, &[1, 0][..]));
    let found = left_out(&spec);
    assert_eq!(found.len(), 4);
    assert!(found[0].contains("package 'nowhere' is unknown"), "{found:?}");
    assert_eq!(found[1], "link 'a': the mesh 'missing.stl' is left out: the file does not exist");
    assert_eq!(found[2..], [dae, dae]);

    // A missing mesh of a collision is an error of the compiler.
    put(&path, &robot(&link("a", &mesh("collision", "missing.stl"))));
    let error = read(&LoadOptions::default()).compile().unwrap_err().to_string();
    assert!(error.contains("missing"), "{error}");
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
        super::check(&compiled(path), &model, "saved, read as a spec");
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
