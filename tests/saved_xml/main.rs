//! `Model::save_xml` writes a text only if it loads as the same model, and reports edits that XML
//! cannot represent.
//!
//! The engine keeps the XML of the last model that the process loaded, so the tests of this program
//! run one at a time.
#![forbid(unsafe_code)]
#![allow(clippy::float_cmp, reason = "a saved number loads as the same number")]

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/fields.rs"]
#[macro_use]
mod fields;

#[path = "../common/assets.rs"]
#[allow(dead_code, reason = "the program `model` uses the rest")]
mod assets;
mod check;
mod edits;
#[cfg(engine_since = "3.5.0")]
mod newer;

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use assets::folder;
use mujoco_safe::model::{SaveXmlOptions, UnsavedField, XmlCheck};
use mujoco_safe::{Model, Result};

/// Locks the engine's XML tree while a test loads and saves: a load by another test would replace
/// the tree, and the save would be an error.
fn lock_engine() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Loads a model and saves it.
fn saved_with(
    load: impl FnOnce() -> Model,
    path: &Path,
    options: &SaveXmlOptions,
) -> (Model, Result<Vec<UnsavedField>>) {
    let model = load();
    let saved = model.save_xml_with(path, options);
    (model, saved)
}

/// Returns the model files of the repository and of the engine's samples, without the 3000
/// particles, which take as long as all others.
fn samples() -> Vec<PathBuf> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    let mut folders =
        vec![PathBuf::from("/usr/share/mujoco/model"), repository.join("models"), repository.join("tests/models")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "xml") && !path.ends_with("particle.xml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Copies the files of a model to a folder, and returns the path of a model file there.
fn copy_into(original: &Path, folder: &Path) -> PathBuf {
    for entry in std::fs::read_dir(original.parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        } else {
            let inner = folder.join(path.file_name().unwrap());
            std::fs::create_dir_all(&inner).unwrap();
            for entry in std::fs::read_dir(path).unwrap() {
                let path = entry.unwrap().path();
                std::fs::copy(&path, inner.join(path.file_name().unwrap())).unwrap();
            }
        }
    }
    folder.join("saved.xml")
}

/// Loads a model, saves it with a check, and returns the fields that the check reports.
fn lost(load: impl FnOnce() -> Model, path: &Path) -> Result<Vec<String>> {
    let options = SaveXmlOptions::default().with_check(XmlCheck::Report);
    let (_, lost) = saved_with(load, path, &options);
    lost.map(|lost| lost.into_iter().map(|lost| lost.field).collect())
}
