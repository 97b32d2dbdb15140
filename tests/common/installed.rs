//! Packages that tests need, and that `scripts/setup --tests` installs.

#![allow(unreachable_pub, dead_code, reason = "included by several tests, each of which uses some of it")]

use std::path::PathBuf;

use mujoco_safe::{Model, sample};

/// Returns `true` if a package is installed. Panics if it is missing, because the test would check
/// nothing. The environment variable `MUJOCO_SAFE_WITHOUT`, a list separated by spaces, names
/// packages that may be missing; for these the result is `false`.
#[track_caller]
pub fn has(package: &str, is_installed: bool) -> bool {
    let without = std::env::var("MUJOCO_SAFE_WITHOUT").unwrap_or_default();
    assert!(
        is_installed || without.split_whitespace().any(|name| name == package),
        "{package} is missing: install it (scripts/setup --tests), or leave out what needs it (MUJOCO_SAFE_WITHOUT={package})"
    );
    is_installed
}

/// Returns the files of the engine's sample models.
#[track_caller]
pub fn sample_files() -> Vec<PathBuf> {
    let files = sample::system_models();
    has("libmujoco-samples", !files.is_empty());
    files
}

/// Returns the engine's sample models with the names of their files. Some files are parts of
/// others, and newer compilers reject some.
#[track_caller]
pub fn sample_models() -> Vec<(String, Model)> {
    let files = sample_files();
    let models: Vec<(String, Model)> =
        files.iter().filter_map(|path| Some((path.display().to_string(), Model::from_xml_path(path).ok()?))).collect();
    assert!(models.len() >= files.len() / 4, "only {} of {} sample models load", models.len(), files.len());
    models
}
