//! Finds the engine's headers. Used by the build script and by `xtask`.

use std::env;
use std::path::{Path, PathBuf};

/// The variable that names an engine outside the system directories.
pub(crate) const MUJOCO_DIR: &str = "MUJOCO_DIR";

/// System installation prefixes, in search order.
const SYSTEM_ROOTS: [&str; 3] = ["/usr", "/usr/local", "/opt/mujoco"];

/// The headers of an engine.
pub(crate) struct Headers {
    /// The directory that holds `mujoco/mujoco.h`.
    pub(crate) include: PathBuf,
    /// `mjVERSION_HEADER`: 222 is 2.2.2.
    pub(crate) version: u32,
}

/// Returns the value of `MUJOCO_DIR`, unless it is unset or empty.
pub(crate) fn requested() -> Option<PathBuf> {
    env::var_os(MUJOCO_DIR).filter(|dir| !dir.is_empty()).map(PathBuf::from)
}

/// Returns the directories to search: `MUJOCO_DIR` alone if it is set, else the system's.
pub(crate) fn roots() -> Vec<PathBuf> {
    requested().map_or_else(|| SYSTEM_ROOTS.map(PathBuf::from).to_vec(), |dir| vec![dir])
}

/// Reads the version from the headers below `root`.
pub(crate) fn probe(root: &Path) -> Result<Headers, String> {
    let include = root.join("include");
    let header = include.join("mujoco/mujoco.h");
    let text = std::fs::read_to_string(&header).map_err(|error| format!("{}: {error}", header.display()))?;
    let version = text
        .lines()
        .find_map(|line| line.strip_prefix("#define mjVERSION_HEADER")?.trim().parse().ok())
        .ok_or_else(|| format!("{}: does not define mjVERSION_HEADER", header.display()))?;
    Ok(Headers { include, version })
}
