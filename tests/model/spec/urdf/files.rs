//! Meshes of a URDF in other directories and packages.

use std::path::Path;

use mujoco_safe::spec::{Spec, UrdfWarning};
use mujoco_safe::{LoadOptions, Model};

use super::super::engine_spec::{self, Source};
use super::{corner, link, mesh, put, robot, sizes};

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

/// The settings in `<mujoco>` come first, for packages too, and the last part of a name comes last.
#[test]
fn the_directory_of_meshes_comes_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m/arm.urdf");
    put(folder.path().join("m/meshes/a.obj"), &corner(1.0));
    put(folder.path().join("m/mj/a.obj"), &corner(2.0));
    put(folder.path().join("m/mj/b.obj"), &corner(3.0));
    put(folder.path().join("m/c.obj"), &corner(4.0));
    let size = |settings: &str, file: &str| {
        let mujoco = format!("<mujoco><compiler {settings}/></mujoco>");
        put(&path, &robot(&(mujoco + &link("a", &mesh("collision", file)))));
        let model = compiled(&path);
        // Plain calls of the engine: Model finds packages first.
        if let Some(theirs) = engine_spec::compile(&Source::File(path.clone())) {
            let found = theirs.differences(&model, super::TOLERANCE, &[]);
            assert!(found.is_empty(), "{settings} {file}: {found:#?}");
        }
        sizes(&model)[0]
    };
    for settings in ["meshdir='mj' strippath='true'", "meshdir='mj'", "assetdir='mj'"] {
        for file in ["meshes/a.obj", "package://m/meshes/a.obj"] {
            assert_eq!(size(settings, file), 2.0, "{settings} {file}");
        }
        assert_eq!(size(settings, "package://unknown/meshes/b.obj"), 3.0);
        assert_eq!(size(settings, "meshes/b.obj"), 3.0);
    }
    assert_eq!(size("", "package://unknown/meshes/c.obj"), 4.0);
    assert_eq!(size("", "package://m/meshes/c.obj"), 4.0);
    assert_eq!(size("", "package://m/meshes/a.obj"), 1.0);
}

/// The directory of a package is that with the file, of several.
#[test]
fn packages_are_found_file_by_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm/urdf/arm.urdf");
    put(folder.path().join("x/outer.obj"), &corner(1.0));
    put(folder.path().join("arm/x/inner.obj"), &corner(2.0));
    put(folder.path().join("arm/meshes/part.obj"), &corner(3.0));
    let files = ["x/outer.obj", "x/inner.obj", "arm//meshes/part.obj"];
    let content: String = files.into_iter().map(|file| mesh("collision", &format!("package://{file}"))).collect();
    put(&path, &robot(&link("a", &content)));
    assert_eq!(sizes(&compiled(&path)), [1.0, 2.0, 3.0]);
    put(&path, &robot(&link("a", &mesh("collision", "package://arm//meshes/part.obj"))));
    assert_eq!(sizes(&Model::from_xml_path(&path).unwrap()), [3.0]);
    for (uri, part) in [("arm/../x/outer.obj", "leaves the package"), ("../x/none.obj", "name/path")] {
        put(&path, &robot(&link("a", &mesh("collision", &format!("package://{uri}")))));
        let error = Spec::from_xml_path(&path).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn other_spellings_of_names_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    put(folder.path().join("meshes/part.obj"), &corner(1.0));
    put(folder.path().join("sp ace/é.obj"), &corner(2.0));
    put(folder.path().join("100%.obj"), &corner(3.0));
    let uri = |name: &str| format!("file://{}/{name}", folder.path().display());
    let files = ["meshes\\part.obj".to_owned(), uri("sp%20ace/%c3%A9.obj"), uri("sp ace/é.obj"), uri("100%.obj")];
    let content: String = files.iter().map(|file| mesh("collision", file)).collect();
    put(&path, &robot(&link("a", &content)));
    assert_eq!(sizes(&compiled(&path)), [1.0, 2.0, 2.0, 3.0]);
}

#[test]
fn files_that_the_engine_does_not_read_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    put(folder.path().join("part.obj"), &corner(1.0));
    let content = mesh("visual", "package://nowhere/other.obj")
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
