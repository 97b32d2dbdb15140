//! Links to the engine's library: for the linker and Cargo, and beside the programs.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::target::System;

/// Folder of the library in the directories of programs. Cargo adds those directories to the
/// loader's path for `cargo run` and `cargo test`, but not this folder: it serves only programs
/// that name it in their rpath, and no other engine is found by accident.
const FOLDER: &str = "mujoco-lib";

/// Returns the folders of the library beside the programs: those of `target/debug` and of its
/// directories of tests and examples, for example. On Windows, where programs load libraries from
/// their own directory, they are these directories. None if Cargo's build directory has another
/// form than `target/debug/build/PACKAGE/out`.
pub(crate) fn folders(system: System, out: &Path) -> Vec<PathBuf> {
    let mut above = out.ancestors().skip(2);
    let Some(profile) = above.next().filter(|build| build.ends_with("build")).and_then(|_| above.next()) else {
        return Vec::new();
    };
    let programs = [profile.to_path_buf(), profile.join("deps"), profile.join("examples")];
    let programs = programs.into_iter().filter(|folder| folder.is_dir());
    programs.map(|folder| if system == System::Windows { folder } else { folder.join(FOLDER) }).collect()
}

/// Returns the paths below a search path under which the linker and the loader search a library. A
/// library `libmujoco.so` can be a link to `libmujoco.so.2.2.2`, the name that programs record.
pub(crate) fn names(system: System, library: &Path) -> Vec<String> {
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

/// As [`names`], without the name that only the linker searches.
pub(crate) fn loader_names(system: System, library: &Path) -> Vec<String> {
    let mut names = names(system, library);
    if names.len() > 1 {
        names.retain(|name| !matches!(&**name, "libmujoco.so" | "libmujoco.dylib"));
    }
    names
}

/// Places links to a library under these names in a folder, and removes those of earlier builds. On
/// Windows they are copies.
pub(crate) fn place(system: System, library: &Path, names: &[String], folder: &Path) -> io::Result<()> {
    for part in ["", "mujoco.framework/Versions/A/"] {
        for entry in fs::read_dir(folder.join(part)).into_iter().flatten().flatten() {
            let Some(name) = entry.file_name().to_str().map(str::to_owned) else { continue };
            let is_ours = (cfg!(windows) || entry.path().is_symlink()) && system.is_library(&name);
            if is_ours && !names.contains(&format!("{part}{name}")) {
                fs::remove_file(entry.path())?;
            }
        }
    }
    for name in names {
        let link = folder.join(name);
        // Another build may run programs, or place the same link, at the same time.
        if fs::read_link(&link).is_ok_and(|target| target == library) {
            continue;
        }
        let new = link.with_file_name(format!(".mujoco-lib-{}", std::process::id()));
        fs::create_dir_all(link.parent().expect("the link is in `folder`"))?;
        #[cfg(unix)]
        std::os::unix::fs::symlink(library, &new)?;
        #[cfg(not(unix))]
        fs::copy(library, &new)?;
        fs::rename(&new, &link)?;
    }
    Ok(())
}
