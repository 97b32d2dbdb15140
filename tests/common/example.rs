//! Examples as programs.

#![allow(unreachable_pub, reason = "included by several tests")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// Builds an example in the profile and with the features of this test, and returns its path.
pub fn build(name: &str) -> PathBuf {
    static BUILT: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let test = std::env::current_exe().expect("the path of this test");
    let program = test.parent().and_then(Path::parent).expect("a test lies in deps/").join("examples").join(name);
    if built.contains(name) {
        return program;
    }
    let features = [
        ("renderer", cfg!(feature = "renderer")),
        ("viewer", cfg!(feature = "viewer")),
        ("npz", cfg!(feature = "npz")),
        ("serde", cfg!(feature = "serde")),
    ];
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--example", name]);
    for (feature, _) in features.iter().filter(|(_, is_on)| *is_on) {
        cargo.args(["--features", feature]);
    }
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    assert!(cargo.status().expect("cargo runs").success(), "the example {name} does not build");
    assert!(program.exists(), "{} was built in another directory", program.display());
    built.insert(name.to_owned());
    program
}
