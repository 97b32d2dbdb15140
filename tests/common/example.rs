//! Examples as programs.

#![allow(unreachable_pub, reason = "included by several tests")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::cases::cases;

/// The examples that tests start, except those for which this test lacks a feature.
const USUAL: &[&str] = &[
    "humanoid_lqr",
    #[cfg(feature = "viewer")]
    "replay",
    #[cfg(feature = "viewer")]
    "view",
];

/// Those that tests start only if they run all cases.
const OTHERS: &[&str] = &[
    "arm_tracking",
    "cartpole_lqr",
    "cartpole_swing_up",
    "contacts",
    "humanoid_predictive",
    "humanoid_stand_up",
    "learn_gait",
    "rollouts",
];

/// Returns the path of an example, after building all that tests start, in the profile and with the
/// features of this test, so that the library is not compiled again. Cargo builds several at the
/// same time.
pub fn build(name: &str) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let started = [USUAL, cases(&[], OTHERS)].concat();
    assert!(started.contains(&name), "{name} is not among {started:?}");
    let folder = FOLDER.get_or_init(|| {
        let features = [
            ("renderer", cfg!(feature = "renderer")),
            ("viewer", cfg!(feature = "viewer")),
            ("mjz", cfg!(feature = "mjz")),
            ("npz", cfg!(feature = "npz")),
            ("mcap", cfg!(feature = "mcap")),
            ("html", cfg!(feature = "html")),
            ("live", cfg!(feature = "live")),
            ("gltf", cfg!(feature = "gltf")),
            ("serde", cfg!(feature = "serde")),
        ];
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--quiet"]).args(started.iter().flat_map(|name| ["--example", name]));
        for (feature, _) in features.iter().filter(|(_, is_on)| *is_on) {
            cargo.args(["--features", feature]);
        }
        if !cfg!(debug_assertions) {
            cargo.arg("--release");
        }
        assert!(cargo.status().expect("cargo runs").success(), "the examples do not build");
        let test = std::env::current_exe().expect("the path of this test");
        test.parent().and_then(Path::parent).expect("a test lies in deps/").join("examples")
    });
    let program = folder.join(name);
    assert!(program.exists(), "{} was built in another directory", program.display());
    program
}
