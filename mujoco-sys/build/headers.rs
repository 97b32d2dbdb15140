//! Finds the engine's headers. Used by the build script, by its tests and by `xtask`.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The variable that names an engine. If it is set, no other place is searched.
pub(crate) const MUJOCO_DIR: &str = "MUJOCO_DIR";

/// The value of `MUJOCO_DIR` that names the official library of the feature `download`.
#[allow(dead_code, reason = "`xtask` does not use it")]
pub(crate) const DOWNLOAD: &str = "download";

/// The variables that name environments in which an engine can be installed.
pub(crate) const ENVIRONMENTS: [&str; 3] = ["VIRTUAL_ENV", "CONDA_PREFIX", "AMENT_PREFIX_PATH"];

/// The engine's header below its directory.
const HEADER: &str = "include/mujoco/mujoco.h";

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
    variable(MUJOCO_DIR).map(PathBuf::from)
}

/// Returns the value of an environment variable, unless it is unset or empty.
fn variable(name: &str) -> Option<OsString> {
    env::var_os(name).filter(|value| !value.is_empty())
}

/// Returns the directories to search, in search order.
pub(crate) fn roots() -> Vec<PathBuf> {
    // Cargo's target directory is normally in the workspace.
    let base = variable("OUT_DIR").map_or_else(|| env::current_dir().unwrap_or_default(), PathBuf::from);
    requested().map_or_else(|| found_roots(variable), |dir| named_roots(&dir, &base))
}

/// Returns the directory of the engine for a value of `MUJOCO_DIR`, or all searched directories if
/// none has the headers. The value names the directory itself or, as the argument of
/// `pip install --target`, its parent. A relative path can be relative to `base` or to each
/// directory that contains it; the nearest has precedence.
pub(crate) fn named_roots(dir: &Path, base: &Path) -> Vec<PathBuf> {
    // `join` returns an absolute path unchanged.
    let mut places: Vec<_> = base.ancestors().map(|folder| folder.join(dir)).collect();
    places.dedup();
    let roots = places.iter().flat_map(|place| [place.clone(), place.join("mujoco")]);
    let found = roots.into_iter().find(|root| root.join(HEADER).is_file());
    found.map_or(places, |root| vec![root])
}

/// Returns the directories to search without `MUJOCO_DIR`: the wheel in the active Python
/// environment, the active conda environment, ROS's `mujoco_vendor`, the prefix that pkg-config
/// reports, and the system's prefixes.
pub(crate) fn found_roots(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let [python, conda, ros] = ENVIRONMENTS.map(variable);
    let mut roots = Vec::new();
    roots.extend(python.map(PathBuf::from).iter().flat_map(|prefix| wheels(prefix)));
    roots.extend(conda.iter().map(PathBuf::from));
    // On Windows.
    roots.extend(conda.iter().map(|prefix| Path::new(prefix).join("Library")).filter(|root| root.is_dir()));
    let ros = ros.unwrap_or_default();
    roots.extend(env::split_paths(&ros).map(|prefix| prefix.join("opt/mujoco_vendor")).filter(|root| root.is_dir()));
    roots.extend(
        pkg_config::get_variable("mujoco", "prefix").ok().filter(|prefix| !prefix.is_empty()).map(PathBuf::from),
    );
    roots.extend(SYSTEM_ROOTS.map(PathBuf::from));
    let mut seen = std::collections::HashSet::new();
    roots.retain(|root| seen.insert(root.clone()));
    roots
}

/// Returns the package directories of the engine's wheel in a Python environment: one per version
/// of Python, or a single one on Windows.
fn wheels(prefix: &Path) -> Vec<PathBuf> {
    let pythons = std::fs::read_dir(prefix.join("lib")).into_iter().flatten().flatten().map(|python| python.path());
    let mut wheels: Vec<_> = pythons
        .chain([prefix.join("Lib")])
        .map(|python| python.join("site-packages/mujoco"))
        .filter(|wheel| wheel.is_dir())
        .collect();
    wheels.sort();
    wheels
}

/// Reads the version from the headers below `root`.
pub(crate) fn probe(root: &Path) -> Result<Headers, String> {
    let include = root.join("include");
    let header = root.join(HEADER);
    let text = std::fs::read_to_string(&header).map_err(|error| format!("{}: {error}", header.display()))?;
    let version = text
        .lines()
        .find_map(|line| line.strip_prefix("#define mjVERSION_HEADER")?.trim().parse().ok())
        .ok_or_else(|| format!("{}: does not define mjVERSION_HEADER", header.display()))?;
    Ok(Headers { include, version })
}
