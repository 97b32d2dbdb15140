//! Where is the engine, and which version is it?

use std::env;
use std::path::{Path, PathBuf};

/// The variable that names an engine outside the system.
pub(crate) const MUJOCO_DIR: &str = "MUJOCO_DIR";

/// Where a system keeps what was installed on it, in the order in which it is searched.
const SYSTEM_ROOTS: [&str; 3] = ["/usr", "/usr/local", "/opt/mujoco"];

/// An engine that can be compiled against and linked with.
pub(crate) struct Engine {
    /// The directory that holds `mujoco/mujoco.h`.
    pub(crate) include: PathBuf,
    /// The directory that holds the shared library.
    pub(crate) library_dir: PathBuf,
    /// The shared library's file name: `libmujoco.so`, or `libmujoco.so.2.2.2` in the official wheels.
    pub(crate) library: String,
    /// `mjVERSION_HEADER`: 222 is 2.2.2.
    pub(crate) version: u32,
    /// Whether the dynamic loader finds the library by itself.
    pub(crate) on_loader_path: bool,
}

/// Why there is none: what was looked for, in order.
pub(crate) struct Missing {
    /// The value of `MUJOCO_DIR`, if it is set.
    pub(crate) requested: Option<PathBuf>,
    /// Each place and what was wrong with it.
    pub(crate) tried: Vec<String>,
}

/// Looks in `MUJOCO_DIR` alone if it is set, and otherwise on the system.
pub(crate) fn engine() -> Result<Engine, Missing> {
    println!("cargo::rerun-if-env-changed={MUJOCO_DIR}");
    let requested = env::var_os(MUJOCO_DIR).filter(|dir| !dir.is_empty()).map(PathBuf::from);
    let roots = requested.clone().map_or_else(|| SYSTEM_ROOTS.map(PathBuf::from).to_vec(), |dir| vec![dir]);
    let mut tried = Vec::new();
    for root in roots {
        match probe(&root) {
            Ok(engine) => return Ok(engine),
            Err(why) => tried.push(why),
        }
    }
    Err(Missing { requested, tried })
}

fn probe(root: &Path) -> Result<Engine, String> {
    let include = root.join("include");
    let header = include.join("mujoco/mujoco.h");
    let text = std::fs::read_to_string(&header).map_err(|error| format!("{}: {error}", header.display()))?;
    let version = version_of(&text).ok_or_else(|| format!("{}: no mjVERSION_HEADER in it", header.display()))?;

    let triplet = triplet();
    let places = [root.join("lib").join(&triplet), root.join("lib64"), root.join("lib"), root.to_path_buf()];
    for dir in &places {
        if let Some(library) = shared_library(dir) {
            let on_loader_path =
                ["/lib", "/lib64", "/usr/lib", "/usr/lib64"].iter().any(|system| dir == Path::new(system))
                    || *dir == Path::new("/usr/lib").join(&triplet);
            return Ok(Engine { include, library_dir: dir.clone(), library, version, on_loader_path });
        }
    }
    let places = places.map(|dir| dir.display().to_string()).join(", ");
    Err(format!("{}: found, but no libmujoco.so in {places}", header.display()))
}

fn version_of(header: &str) -> Option<u32> {
    header.lines().find_map(|line| line.strip_prefix("#define mjVERSION_HEADER")?.trim().parse().ok())
}

/// The directory name that Debian gives the target: `x86_64-linux-gnu` for `x86_64-unknown-linux-gnu`.
fn triplet() -> String {
    let part = |name: &str| env::var(format!("CARGO_CFG_TARGET_{name}")).unwrap_or_default();
    format!("{}-{}-{}", part("ARCH"), part("OS"), part("ENV"))
}

/// `libmujoco.so` if it is there, else one with a version behind it.
fn shared_library(dir: &Path) -> Option<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .ok()?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name == "libmujoco.so" || name.starts_with("libmujoco.so.") || name == "libmujoco.dylib")
        .collect();
    names.sort();
    names.into_iter().next()
}
