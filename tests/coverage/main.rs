//! Coverage of the engine: generated sources and the tables in `docs/coverage/` are up to date and
//! complete, except for listed exceptions.

#![forbid(unsafe_code)]

mod element_views;
mod engines;
mod field_docs;
mod fields;
mod functions;
mod guide;
mod kinds;
mod rendered;
mod search_index;

use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Compares a table with the committed one, or writes it.
fn is_committed(name: &str, made: &str) {
    let path = root().join("docs/coverage").join(name);
    if std::env::var_os("UPDATE_GENERATED").is_some() {
        std::fs::write(&path, made).expect("docs/coverage can be written to");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == made, "{} is out of date: UPDATE_GENERATED=1 cargo test --test coverage", path.display());
}

/// Returns the path and the text of every source file in a folder of the crate and its subfolders.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&entry).unwrap();
                found.push((entry, text));
            }
        }
    }
    found
}
