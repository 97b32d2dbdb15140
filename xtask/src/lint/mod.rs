//! Rules of this repository that the compiler does not check: `cargo xtask lint`.

mod calls;
mod engine_cfg;
mod imports;
mod lines;
mod promises;
mod test_list;

use std::fs;
use std::path::{Path, PathBuf};

/// Applies all rules. The error lists the violations.
pub fn run(root: &Path) -> Result<(), String> {
    let root = &root.canonicalize().map_err(|error| format!("{}: {error}", root.display()))?;
    let tests = test_list::all(root)?;
    let found = [lines::check(root), calls::check(root), imports::check(root), promises::check(root, &tests)].concat();
    if found.is_empty() { Ok(()) } else { Err(found.join("\n")) }
}

/// Reads a file of the repository.
pub fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the paths of all Rust files in a folder and its subfolders, or that of a file itself.
pub fn sources(path: &Path) -> Vec<PathBuf> {
    assert!(path.exists(), "there is no {}", path.display());
    if path.is_dir() {
        let entries = fs::read_dir(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        return entries.flat_map(|entry| sources(&entry.expect("the folder can be read").path())).collect();
    }
    path.extension().is_some_and(|extension| extension == "rs").then(|| path.to_owned()).into_iter().collect()
}
