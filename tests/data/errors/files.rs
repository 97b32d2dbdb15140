//! Unreadable, unwritable and malformed files.

use std::path::PathBuf;

use mujoco_safe::{LoadOptions, Model, Trajectory, sample};

use super::text_of;

/// Part of the system's message for a missing file.
const MISSING: &str = if cfg!(windows) { "(os error " } else { "No such file or directory" };

/// A device.
const NULL: &str = if cfg!(windows) { "NUL" } else { "/dev/null" };

/// Returns a temporary folder, and the path of a file in it.
fn file(name: &str, content: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    (folder, path)
}

#[test]
fn loading_a_missing_file_names_the_path_and_the_reason() {
    text_of(Model::from_xml_path("no/such/model.xml"), &["no/such/model.xml", MISSING]);
    text_of(Model::from_binary_path("no/such/model.mjb"), &["no/such/model.mjb", MISSING]);
    text_of(Model::from_xml_path(""), &[MISSING]);
    text_of(Model::from_xml_path("nul\0byte.xml"), &["nul"]);
    let model = sample::cartpole();
    text_of(Trajectory::load_csv(&model, "no/such.csv"), &["no/such.csv", MISSING]);
    text_of(Trajectory::new(&model).save_csv("no/such/folder.csv"), &["no/such/folder.csv", MISSING]);
    text_of(model.save_binary("no/such/folder.mjb"), &["no/such/folder.mjb", MISSING]);
}

#[test]
fn a_directory_is_not_a_model() {
    let directory = std::env::temp_dir();
    let shown = directory.display().to_string();
    text_of(Model::from_xml_path(&directory), &[&shown, "directory"]);
    text_of(Model::from_binary_path(&directory), &[&shown, "directory"]);
    text_of(Model::from_xml_path(NULL), &[NULL, "not a regular file"]);
}

#[test]
fn a_path_instead_of_xml_is_an_error_that_names_the_function_for_files() {
    for path in ["humanoid.xml", "robots/arm.urdf", " C:\\models\\arm.XML\n"] {
        text_of(Model::from_xml_str(path), &["cannot load the given XML", path.trim(), "Model::from_xml_path"]);
    }
    let (_folder, path) = file("model.xml", "<mujoco/>");
    text_of(Model::from_xml_str(path.to_str().unwrap()), &["is a path, not XML", "Model::from_xml_path"]);
    text_of(Model::from_xml_str("model.mjb"), &["is a path, not XML", "Model::from_binary_path"]);
    for text in ["model.obj", "not XML at all", "xml", "<mujoco>model.xml", "one.xml\ntwo.xml"] {
        assert!(!text_of(Model::from_xml_str(text), &[]).contains("is a path"), "{text}");
    }
}

#[test]
fn malformed_xml_is_an_error_with_its_line() {
    text_of(Model::from_xml_str("<mujoco>\n<worldbody>\n</mujoco>"), &["cannot load the given XML", "Line number=2"]);
    text_of(
        Model::from_xml_str("<mujoco>\n  <worldbod/>\n</mujoco>"),
        &["unrecognized element", "'worldbod'", "line 2"],
    );
    text_of(Model::from_xml_str("<mujoco>\n\n<option timestep='soon'/></mujoco>"), &["'timestep'", "line 3"]);
    text_of(
        Model::from_xml_str("<mujoco>\n<worldbody>\n<geom/></worldbody></mujoco>"),
        &[if cfg!(engine_since = "2.3.0") { "line 3" } else { "line = 3" }],
    );
    text_of(Model::from_xml_str(""), &["cannot load the given XML"]);
    text_of(Model::from_xml_str("not XML at all"), &["cannot load the given XML"]);
    text_of(Model::from_xml_str("<html/>"), &["html"]);
    let (_folder, path) = file("broken.xml", "<mujoco>\n\n  <worldbod/></mujoco>");
    text_of(Model::from_xml_path(&path), &["broken.xml", "'worldbod'", "line 3"]);
    // The engine's examples use a buffer of a hundred bytes for this message.
    let long = "n".repeat(300);
    text_of(Model::from_xml_str(&format!("<mujoco><worldbody><body><{long}/></body></worldbody></mujoco>")), &[&long]);
}

#[test]
fn empty_duplicate_and_misnamed_files_are_errors() {
    let load =
        |files: &[(&str, &[u8])]| Model::from_xml_str_with("<mujoco/>", &LoadOptions::default().with_files(files));
    text_of(load(&[("", b"x")]), &["named with 0 bytes"]);
    text_of(load(&[("a/", b"x")]), &["'a/'", "named with 0 bytes"]);
    text_of(load(&[(&"n".repeat(1000), b"x")]), &["named with 1000 bytes"]);
    text_of(load(&[("a.xml", b"")]), &["'a.xml'", "empty"]);
    text_of(load(&[("a.xml", b"x"), ("a.xml", b"x")]), &["given twice"]);
    // Newer engines compare names with their path and case.
    if cfg!(not(engine_since = "3.2.1")) {
        text_of(load(&[("a.xml", b"x"), ("other/A.xml", b"x")]), &["given twice"]);
    }
    text_of(load(&[("a\0.xml", b"x")]), &["NUL byte at position 1"]);
    let many: Vec<String> = (0..2100).map(|file| format!("{file}.xml")).collect();
    let many: Vec<(&str, &[u8])> = many.iter().map(|name| (name.as_str(), &b"x"[..])).collect();
    if cfg!(engine_since = "3.2.1") {
        load(&many).unwrap(); // these engines have no limit
    } else {
        text_of(load(&many), &["beyond the limit"]);
    }
}

#[test]
fn a_malformed_csv_trajectory_is_an_error_with_its_line() {
    let model = sample::cartpole();
    let load = |content: &str| {
        let (_folder, path) = file("damaged.csv", content);
        Trajectory::load_csv(&model, &path)
    };
    let header = "time,qpos0,qpos1,qvel0,qvel1,ctrl0\n";
    assert_eq!(load(&format!("{header}0,1,2,3,4,5\n")).unwrap().len(), 1);
    text_of(load(""), &["damaged.csv", "line 1"]);
    text_of(Trajectory::load_csv(&model, NULL), &[NULL, "not a regular file"]);
    text_of(load("time,x\n"), &["line 1 is not the header", "found 2"]);
    text_of(load(&format!("{header}0,1,2,3,4,5\n0,1,2,3,4\n")), &["line 3 has 5 columns, not 6"]);
    text_of(load(&format!("{header}0,1,two,3,4,5\n")), &["line 2: 'two' is not a number"]);
}

#[test]
fn saving_to_an_unwritable_path_names_the_path() {
    let model = sample::cartpole();
    // Other tests load models at the same time, so the error may be that the XML was replaced.
    let assert_error = |path: &str, part: &str| {
        let text = model.save_xml(path).unwrap_err().to_string();
        assert!(text.contains(part) && text.contains(path) || text.contains("another one was loaded since"), "{text}");
    };
    assert_error("no/such/folder/model.xml", MISSING);
    assert_error(std::env::temp_dir().to_str().unwrap(), "directory");
    if cfg!(target_os = "linux") {
        assert_error("/dev/full", "No space left on device");
        assert_error("/proc/version", ": ");
    }
    sample::humanoid();
    text_of(model.save_xml("unused.xml"), &["another one was loaded since", "save before loading the next"]);
    assert!(!PathBuf::from("unused.xml").exists());
}
