//! Loading gives the same model as the engine's own loader.

use std::path::Path;

use mujoco_safe::{Data, LoadOptions, Model};

use crate::{assets, bytes, bytes_in_c, bytes_in_c_with_files, folder, from_memory};

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn assets_in_memory_load_like_assets_on_the_disk() {
    let folder = folder();
    let model = from_memory(assets::MODEL, &assets::all()).unwrap();
    let in_c = bytes_in_c(&folder.path().join("model.xml"));
    assert_eq!(bytes(&model), in_c[..bytes(&model).len()]);
    let on_disk = Model::from_xml_path(folder.path().join("model.xml")).unwrap();
    assert!(bytes(&on_disk) == bytes(&model));

    // Values of the official Python bindings of this engine
    // (`MjModel.from_xml_string(xml, assets)`).
    assert_eq!((model.nmesh(), model.nskin(), model.nhfield(), model.ntex()), (3, 1, 2, 2));
    assert_eq!(model.mesh_vertnum(), [4, 12, 4]);
    assert_eq!(model.mesh_facenum(), [4, 4, 4]);
    assert_eq!(model.hfield_data(), [0.0, 0.125, 0.25, 0.375, 0.5, 1.0, 0.6, 0.8, 1.0, 0.0, 0.2, 0.4]);
    assert_eq!((model.tex_width(), model.tex_height()), (&[4, 2][..], &[4, 1][..]));
    assert_eq!(model.textures().last().unwrap().rgb(), [10, 20, 30, 40, 50, 60]);
    assert_eq!((model.nskinvert(), model.nskinbone()), (4, 1));
    Data::new(model).unwrap().step().unwrap();
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn a_file_in_memory_is_found_by_its_name_without_folder_and_case() {
    let expected = bytes(&from_memory(assets::MODEL, &assets::all()).unwrap());
    let rename = |rename: fn(&str) -> String| {
        let files = assets::all();
        let names: Vec<String> = files.iter().map(|(name, _)| rename(name)).collect();
        let files: Vec<(&str, &[u8])> =
            names.iter().zip(&files).map(|(name, (_, content))| (name.as_str(), content.as_slice())).collect();
        bytes(&Model::from_xml_str_with(assets::MODEL, &LoadOptions::default().with_files(&files)).unwrap())
    };
    assert!(rename(|name| name.rsplit('/').next().unwrap().to_owned()) == expected);
    assert!(rename(|name| format!("/some/where/else/{name}")) == expected);
    assert!(rename(|name| format!("C:\\somewhere\\{}", name.replace('/', "\\"))) == expected);
    assert!(rename(str::to_uppercase) == expected);
    // The compiler's option to strip paths makes no difference.
    let stripped = assets::MODEL.replace("<compiler ", r#"<compiler strippath="true" "#);
    assert!(bytes(&from_memory(&stripped, &assets::all()).unwrap()) == expected);
}

#[test]
fn a_file_missing_in_memory_is_loaded_from_the_disk() {
    let folder = folder();
    let xml = format!(
        r#"<mujoco><compiler meshdir="{}/meshes/"/><asset><mesh file="solid.stl"/><mesh name="other" file="solid.msh"/></asset>
           <worldbody><geom type="mesh" mesh="solid"/><geom type="mesh" mesh="other"/></worldbody></mujoco>"#,
        folder.path().display()
    );
    assert_eq!(Model::from_xml_str(&xml).unwrap().nmesh(), 2);
    // Files in memory take precedence.
    let larger =
        [("solid.stl", [&assets::stl()[..80], &[5, 0, 0, 0], &assets::stl()[84..], &assets::stl()[84..134]].concat())];
    assert_eq!(from_memory(&xml, &larger).unwrap().mesh_facenum(), [5, 4]);
}

/// Loads a model with `Model::from_xml_path_with` and with the engine's virtual file system, and
/// asserts that both are equal.
fn with_files(path: &Path, files: &[(&str, &[u8])]) -> Model {
    let model = Model::from_xml_path_with(path, &LoadOptions::default().with_files(files)).unwrap();
    let in_c = bytes_in_c_with_files(path, files);
    assert_eq!(bytes(&model), in_c[..bytes(&model).len()]);
    model
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn files_in_memory_take_precedence_over_files_beside_the_model() {
    let folder = folder();
    let path = folder.path().join("model.xml");
    let on_disk = Model::from_xml_path(&path).unwrap();
    assert!(bytes(&with_files(&path, &[])) == bytes(&on_disk));

    // An included text that exists in memory only and names a mesh on the disk and a mesh in
    // memory.
    let mixed = folder.path().join("mixed.xml");
    std::fs::write(&mixed, assets::MODEL.replace("part.xml", "sub/OTHER.xml")).unwrap();
    let part = assets::PART.replace("solid.msh", "only_here.msh");
    let files: [(&str, &[u8]); 2] = [("other.xml", part.as_bytes()), ("anywhere/only_here.msh", &assets::msh())];
    assert!(bytes(&with_files(&mixed, &files)) == bytes(&on_disk));
    assert!(Model::from_xml_path_with(&mixed, &LoadOptions::default().with_files(&files[..1])).is_err());
    assert!(Model::from_xml_path(&mixed).is_err());

    // Memory takes precedence over the disk.
    let larger = [&assets::stl()[..80], &[5, 0, 0, 0], &assets::stl()[84..], &assets::stl()[84..134]].concat();
    assert_eq!(with_files(&path, &[("solid.stl", &larger)]).mesh_facenum(), [5, 4, 4]);
    let lower = assets::PART.replace("size=\"1 1 1 .1\"", "size=\"1 1 2 .1\"");
    assert_eq!(with_files(&path, &[("part.xml", lower.as_bytes())]).hfield_size()[0][2], 2.0);
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers look up files in memory with their path")]
fn the_model_file_is_always_read_from_the_disk() {
    let folder = folder();
    let path = folder.path().join("model.xml");
    // The engine would load this file as the model; here it is only a file that the model may name.
    let model =
        Model::from_xml_path_with(&path, &LoadOptions::default().with_files(&[("model.xml", b"<mujoco/>")])).unwrap();
    assert!(bytes(&model) == bytes(&Model::from_xml_path(&path).unwrap()));
    // The same holds for a file of the same name in another directory.
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let ball = "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>";
    std::fs::write(folder.path().join("parts/model.xml"), ball).unwrap();
    std::fs::write(&path, "<mujoco><include file='parts/model.xml'/></mujoco>").unwrap();
    assert_eq!(
        Model::from_xml_path_with(&path, &LoadOptions::default().with_files(&[("a.txt", b"text")])).unwrap().ngeom(),
        1
    );
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer compilers open package URIs as they are")]
fn a_urdf_robot_loads_from_a_path_and_from_memory() {
    let folder = folder();
    let path = folder.path().join("arm.urdf");
    let model = Model::from_xml_path(&path).unwrap();
    let in_c = bytes_in_c(&path);
    assert_eq!(bytes(&model), in_c[..bytes(&model).len()]);
    let in_memory = from_memory(assets::URDF, &[("meshes/solid.stl", assets::stl())]).unwrap();
    assert!(bytes(&in_memory) == bytes(&model));
    // Like the official Python bindings, the loader discards visual geoms.
    assert_eq!((model.njnt(), model.nbody(), model.nmesh(), model.ngeom()), (1, 2, 1, 1));
    assert_eq!(model.joint("hinge").map(|_| model.jnt_range().to_vec()).unwrap(), [[-1.0, 1.0]]);
}

#[test]
#[cfg_attr(engine_since = "2.3.0", ignore = "newer engines hold any number of files")]
fn more_files_than_the_engine_can_hold_are_an_error() {
    let names: Vec<String> = (0..1999).map(|index| format!("{index}.txt")).collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &b"text"[..])).collect();
    Model::from_xml_str_with("<mujoco/>", &LoadOptions::default().with_files(&files[..1998])).unwrap();
    let error =
        Model::from_xml_str_with("<mujoco/>", &LoadOptions::default().with_files(&files)).unwrap_err().to_string();
    assert!(error.contains("'1998.txt'") && error.contains("1998"), "{error}");
}
