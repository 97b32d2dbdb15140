//! Archives of a model and its files.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

use std::fs::File;
use std::io::Write;
use std::path::Path;

use mujoco_safe::Error;
use mujoco_safe::spec::{Mount, Spec};
use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::parse;

fn pack(path: &Path, files: &[(&str, &[u8])]) {
    let mut archive = ZipWriter::new(File::create(path).unwrap());
    for (name, content) in files {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap();
}

const BALL: &[u8] = b"<mujoco><worldbody><geom name='ball' size='.1'/></worldbody></mujoco>";

/// Returns a folder with a model of two meshes, whose files have the same name.
fn robot() -> (TempDir, Spec) {
    let folder = tempfile::tempdir().unwrap();
    for (part, size) in [("base", 1), ("arm", 2)] {
        std::fs::create_dir_all(folder.path().join("meshes").join(part)).unwrap();
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        std::fs::write(folder.path().join(format!("meshes/{part}/link.obj")), text).unwrap();
    }
    let text = "<mujoco><compiler meshdir='meshes'/><asset><mesh name='base' file='base/link.obj'/>
                  <mesh name='arm' file='arm/link.obj'/></asset>
                  <worldbody><geom type='mesh' mesh='base'/><geom type='mesh' mesh='arm'/></worldbody></mujoco>";
    std::fs::write(folder.path().join("model.xml"), text).unwrap();
    let spec = Spec::from_xml_path(folder.path().join("model.xml")).unwrap();
    (folder, spec)
}

#[test]
fn a_model_with_files_is_written_and_read() {
    let (folder, spec) = robot();
    let path = folder.path().join("robot.mjz");
    spec.save_archive(&path).unwrap();
    let first = std::fs::read(&path).unwrap();
    spec.save_archive(&path).unwrap();
    assert!(std::fs::read(&path).unwrap() == first);
    let expected = spec.compile().unwrap();
    let read = Spec::from_archive_path(&path).unwrap();
    let found = read.compile().unwrap();
    assert_eq!(found.mesh_vert(), expected.mesh_vert());
    assert_eq!((found.nmesh(), found.mesh("arm").is_ok()), (2, true));

    // The files exist as long as a spec needs them.
    let directory = read.directory().unwrap().to_owned();
    let mut scene = Spec::new("scene");
    let mount = Mount::body(scene.world());
    scene.attach(&read, mount, "r_").unwrap();
    drop(read);
    let copy = scene.clone();
    drop(scene);
    assert_eq!(copy.compile().unwrap().nmesh(), expected.nmesh());
    drop(copy);
    assert!(!directory.exists());
}

#[test]
fn the_model_is_found_where_the_engine_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.b.zip");
    for name in ["model.xml", "a.b.xml", "a.b/a.b.xml", "a.b/model.xml"] {
        pack(&path, &[("readme.txt", b"text"), (name, BALL)]);
        assert!(Spec::from_archive_path(&path).unwrap().geom("ball").is_ok(), "{name}");
    }
    pack(&path, &[("a.b.xml", b"<mujoco/>"), ("model.xml", BALL)]);
    assert!(Spec::from_archive_path(&path).unwrap().geom("ball").is_ok());
}

#[cfg(engine_since = "4.0.0")]
#[test]
fn the_engine_reads_the_archive() {
    use std::ffi::CString;
    use std::ptr;

    use mujoco_safe::{Model, sys};

    let (folder, spec) = robot();
    let path = folder.path().join("robot.mjz");
    spec.save_archive(&path).unwrap();
    let name = CString::new(path.to_str().unwrap()).unwrap();
    // SAFETY: a valid path; both results are checked, used and freed here.
    let vertices = unsafe {
        let parsed = sys::mj_parse(name.as_ptr(), ptr::null(), ptr::null(), ptr::null_mut(), 0);
        assert!(!parsed.is_null());
        let model = sys::mj_compile(parsed, ptr::null());
        assert!(!model.is_null());
        let length = 3 * (*model).nmeshvert as usize;
        let vertices = std::slice::from_raw_parts((*model).mesh_vert, length).to_vec();
        sys::mj_deleteModel(model);
        sys::mj_deleteSpec(parsed);
        vertices
    };
    assert_eq!(vertices, spec.compile().unwrap().mesh_vert().as_flattened());

    let error = Model::from_xml_path(&path).unwrap_err().to_string();
    assert!(error.contains("Spec::from_archive_path"), "{error}");
}

#[test]
fn archives_from_strangers_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.mjz");
    let error = |expected: &str| {
        let error = Spec::from_archive_path(&path).unwrap_err();
        assert!(error.to_string().contains(expected) && error.to_string().contains("bad.mjz"), "{error}");
        error
    };
    error("No such file");
    std::fs::write(&path, b"text").unwrap();
    assert!(matches!(error("rchive"), Error::File { .. }));
    pack(&path, &[("other.xml", BALL)]);
    error("none of model.xml, bad.xml, bad/bad.xml and bad/model.xml");
    for name in ["../model.xml", "a/../../model.xml"] {
        pack(&path, &[(name, BALL)]);
        error("outside");
    }
    pack(&path, &[("model.xml", BALL), ("./model.xml", BALL)]);
    error("model.xml");
    let zeros = vec![0; 65 << 20];
    pack(&path, &[("model.xml", BALL), ("zeros.bin", &zeros)]);
    error("a hundred times");
    pack(&path, &[("model.xml", b"<mujoco><worldbody></mujoco>")]);
    error("model.xml in");
    let directory = parse("<mujoco><asset><mesh file='missing.stl'/></asset></mujoco>");
    assert!(matches!(directory.save_archive(&path), Err(Error::File { .. })));
}
