//! Libraries of engine plugins: those of the wheel that contains the engine, and files that are no
//! library.

use std::path::PathBuf;

use mujoco_safe::{Error, Model, load_plugins};

/// Directory of the engine that the tests are built for.
pub fn directory() -> Option<PathBuf> {
    Some(PathBuf::from(option_env!("MUJOCO_DIR")?).join("plugin")).filter(|directory| directory.is_dir())
}

/// Loads the plugins and a text, or returns `None` if the engine is not from a wheel.
pub fn loaded(text: &str) -> Option<Model> {
    // SAFETY: the plugins of the wheel that contains the engine.
    unsafe { load_plugins(directory()?) }.unwrap();
    Some(Model::from_xml_str(text).unwrap())
}

fn with_plugin(name: &str) -> String {
    format!("<mujoco><extension><plugin plugin='{name}'/></extension></mujoco>")
}

#[test]
fn plugins_of_a_loaded_library_can_be_used_in_a_text() {
    let name = if cfg!(engine_since = "2.3.6") { "mujoco.sensor.touch_grid" } else { "mujoco.elasticity.cable" };
    if let Some(model) = loaded(&with_plugin(name)) {
        assert_eq!(model.nbody(), 1);
    }
}

#[test]
fn missing_and_foreign_libraries_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    // SAFETY: none of the paths is a library.
    unsafe {
        assert!(matches!(load_plugins(folder.path().join("none")), Err(Error::File { .. })));
        load_plugins(folder.path()).unwrap();
        let name = format!("wrong.{}", std::env::consts::DLL_EXTENSION);
        std::fs::write(folder.path().join(name), "no library").unwrap();
        assert!(matches!(load_plugins(folder.path()), Err(Error::Engine { .. })));
    }
    let error = Model::from_xml_str(&with_plugin("mujoco.sensor.unknown")).unwrap_err().to_string();
    assert!(error.contains("mujoco.sensor.unknown"), "{error}");
}
