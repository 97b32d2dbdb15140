//! Specs of files are the models of these files.

use std::path::{Path, PathBuf};

use mujoco_safe::spec::Spec;
use mujoco_safe::{Error, LoadOptions, Model};

use super::super::{bytes, folder};

use crate::cases::cases;

pub fn files(directory: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(directory) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> =
        paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    found.sort();
    found
}

/// Returns the models of this crate and the sample models of the engine, or a part of them.
pub fn all_models() -> impl Iterator<Item = (PathBuf, Model)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let directories = [root.join("models"), root.join("tests/models"), PathBuf::from("/usr/share/mujoco/model")];
    let paths = directories.into_iter().flat_map(|directory| files(&directory)).step_by(cases(5, 1));
    paths.filter_map(|path| Model::from_xml_path(&path).ok().map(|model| (path, model)))
}

#[test]
fn a_spec_of_a_file_compiles_to_the_model_of_the_file() {
    let mut number = 0;
    for (path, expected) in all_models() {
        let spec = Spec::from_xml_path(&path).unwrap();
        let compiled = spec.compile().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(bytes(&compiled) == bytes(&expected), "{}", path.display());
        number += 1;
    }
    assert!(number >= cases(3, 10), "{number} models");
}

#[test]
fn includes_are_read_from_memory_and_from_disk() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "main.xml",
        "<mujoco><include file='parts/a.xml'/><worldbody><geom name='last' size='1'/></worldbody></mujoco>",
    );
    write("parts/a.xml", "<mujocoinclude><worldbody><include file='parts/b.xml'/></worldbody></mujocoinclude>");
    write("parts/b.xml", "<mujoco><geom name='first' size='2'/></mujoco>");
    let path = folder.path().join("main.xml");
    let spec = Spec::from_xml_path(&path).unwrap();
    assert_eq!(spec.geom("first").unwrap().attribute("size"), Some("2"));
    assert!(bytes(&spec.compile().unwrap()) == bytes(&Model::from_xml_path(&path).unwrap()));

    let options = LoadOptions::default().with_file("b.xml", b"<mujoco><geom name='ball' size='2'/></mujoco>");
    let text = "<mujoco><worldbody><include file='b.xml'/></worldbody></mujoco>";
    assert!(Spec::from_xml_str_with(text, &options).unwrap().geom("ball").is_ok());
}

#[test]
fn assets_of_included_files_are_found() {
    let files = folder();
    std::fs::create_dir(files.path().join("sub")).unwrap();
    std::fs::write(files.path().join("main.xml"), "<mujoco><include file='sub/part.xml'/></mujoco>").unwrap();
    let part = "<mujoco><asset><mesh name='m' file='only_here.obj'/></asset>
        <worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>";
    std::fs::write(files.path().join("sub/part.xml"), part).unwrap();
    let path = files.path().join("main.xml");
    for place in ["sub/only_here.obj", "only_here.obj"] {
        std::fs::write(files.path().join(place), super::super::assets::obj()).unwrap();
        let expected = Model::from_xml_path(&path);
        let compiled = Spec::from_xml_path(&path).unwrap().compile();
        assert_eq!(compiled.is_ok(), expected.is_ok(), "{place}: {compiled:?}, {expected:?}");
    }
}

#[test]
fn mistakes_in_files_are_errors_with_their_cause() {
    let error = |text: &str| Spec::from_xml_str(text).unwrap_err().to_string();
    assert!(error("<mujoco>").contains("the given XML"));
    assert!(error("<sdf/>").contains("not a <mujoco> (MJCF) or a <robot> (URDF)"));
    assert!(error("<mujoco><include/></mujoco>").contains("'file'"));
    assert!(error("<mujoco><include file='none.xml'/></mujoco>").contains("'none.xml' cannot be read"));
    let deep = format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(500), "</body>".repeat(500));
    assert!(error(&deep).contains("400"));
    assert!(matches!(Spec::from_xml_path("no/such.xml"), Err(Error::File { .. })));

    let recursive = LoadOptions::default().with_file("a.xml", b"<mujoco><include file='a.xml'/></mujoco>");
    let error = Spec::from_xml_str_with("<mujoco><include file='a.xml'/></mujoco>", &recursive).unwrap_err();
    assert!(error.to_string().contains("includes itself"), "{error}");
}
