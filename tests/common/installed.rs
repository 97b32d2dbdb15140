//! What `scripts/setup --tests` installs, and tests need.

#![allow(unreachable_pub, dead_code, reason = "included by several tests, each of which uses some of it")]

use std::path::PathBuf;

use mujoco_safe::sample;

/// Returns `true` if a package is installed. Without it the test fails, because it would check
/// nothing, unless the environment variable `MUJOCO_SAFE_WITHOUT` names the package (several are
/// separated by spaces), for systems that do not have it.
#[track_caller]
pub fn has(package: &str, is_installed: bool) -> bool {
    let without = std::env::var("MUJOCO_SAFE_WITHOUT").unwrap_or_default();
    assert!(
        is_installed || without.split_whitespace().any(|name| name == package),
        "{package} is missing: install it (scripts/setup --tests), or leave out what needs it (MUJOCO_SAFE_WITHOUT={package})"
    );
    is_installed
}

/// Returns the engine's sample models.
#[track_caller]
pub fn sample_models() -> Vec<PathBuf> {
    let models = sample::system_models();
    has("libmujoco-samples", !models.is_empty());
    models
}
