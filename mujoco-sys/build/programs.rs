//! Links to the engine's library: for the linker, for Cargo, and beside the programs.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::target::System;

/// Returns the directories of programs, which contain their library if the engine is outside the
/// loader's path: `target/debug` and its directories of tests and examples, for example.
pub(crate) fn directories(out: &Path) -> Vec<PathBuf> {
    let build = out.ancestors().find(|folder| folder.ends_with("build"));
    let Some(profile) = build.and_then(Path::parent) else { return Vec::new() };
    let folders = [profile.to_path_buf(), profile.join("deps"), profile.join("examples")];
    folders.into_iter().filter(|folder| folder.is_dir()).collect()
}

/// Creates links to a library in a directory, under the names that the linker and the loader
/// search. On Windows they are copies.
pub(crate) fn link(system: System, library: &Path, folder: &Path) -> io::Result<()> {
    for name in names(system, library) {
        let link = folder.join(name);
        fs::create_dir_all(link.parent().expect("the link is in `folder`"))?;
        #[cfg(unix)]
        std::os::unix::fs::symlink(library, &link)?;
        #[cfg(not(unix))]
        fs::copy(library, &link)?;
    }
    Ok(())
}

/// Returns the paths below a search path. A library `libmujoco.so` can be a link to
/// `libmujoco.so.2.2.2`, the name that programs record.
fn names(system: System, library: &Path) -> Vec<String> {
    let real = fs::canonicalize(library).unwrap_or_default();
    let files = [library, &real].map(|path| path.file_name().and_then(|name| name.to_str()).unwrap_or_default());
    let mut names: Vec<String> = Vec::new();
    for file in files.into_iter().filter(|file| system.is_library(file)) {
        names.extend(system.search_names(file));
    }
    names.sort();
    names.dedup();
    names
}

/// Removes the links of an earlier build from a directory. Other files with such names remain,
/// except on Windows, where they are the copies of an earlier build.
pub(crate) fn unlink(system: System, folder: &Path) {
    for folder in [folder.to_path_buf(), folder.join("mujoco.framework/Versions/A")] {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let is_ours = cfg!(windows) || entry.path().is_symlink();
            if is_ours && entry.file_name().to_str().is_some_and(|name| system.is_library(name)) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}
