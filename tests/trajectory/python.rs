//! Scripts for Python with packages that read files of this crate.

use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::Command;

use crate::installed::has;

/// Folder in which `scripts/setup --tests` installs packages of PyPI.
const TOOLS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/tools/bin/python3");

/// Runs a Python script, whose argument is a path, and returns its output. The interpreter is the
/// first of `$PYTHON`, `python3`, that of the system and that of `scripts/setup` which has the
/// modules. `None` if the tests may pass without the package.
pub(crate) fn run(package: &str, modules: &str, script: &str, path: &Path) -> Option<String> {
    let run = |python: &OsStr, script: &str| Command::new(python).arg("-c").arg(script).arg(path).output();
    let named = std::env::var_os("PYTHON");
    let all = named.into_iter().chain(["python3", "/usr/bin/python3", TOOLS].map(OsString::from));
    let import = format!("import {modules}");
    let mut fit = all.filter(|python| run(python, &import).is_ok_and(|output| output.status.success()));
    let python = fit.next();
    has(package, python.is_some());
    let output = run(&python?, script).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}
