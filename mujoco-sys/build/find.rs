//! Finds the engine: headers, version and library.

use std::path::{Path, PathBuf};

use crate::headers::{self, DOWNLOAD, ENVIRONMENTS, MUJOCO_DIR};
use crate::{bindings, engines, target};

/// An engine to compile against and to link with.
pub(crate) struct Engine {
    /// The directory that holds `mujoco/mujoco.h`.
    pub(crate) include: PathBuf,
    /// The directory that holds the shared library.
    pub(crate) library_dir: PathBuf,
    /// The shared library's file name: `libmujoco.so`, or `libmujoco.so.2.2.2` in the official
    /// wheels for Linux.
    pub(crate) library: String,
    /// `mjVERSION_HEADER`: 222 is 2.2.2.
    pub(crate) version: u32,
    /// True if the dynamic loader searches `library_dir` by default.
    pub(crate) on_loader_path: bool,
}

/// Why no engine was found. Nothing was tried if `MUJOCO_DIR` is `download`.
pub(crate) struct Missing {
    /// The value of `MUJOCO_DIR`, if it is set.
    pub(crate) requested: Option<PathBuf>,
    /// Each searched place and the reason for its rejection, in search order.
    pub(crate) tried: Vec<String>,
}

impl Missing {
    /// Returns `true` if `MUJOCO_DIR` is `download`.
    pub(crate) fn is_download(&self) -> bool {
        self.requested.as_deref() == Some(Path::new(DOWNLOAD))
    }
}

/// Returns the engine in `MUJOCO_DIR` if it is set. Otherwise returns the first engine of the
/// default version, else the first whose bindings are committed, else the first of another version.
/// With the feature `bindgen` returns the first engine.
pub(crate) fn engine() -> Result<Engine, Missing> {
    for variable in [MUJOCO_DIR].iter().chain(&ENVIRONMENTS) {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    let mut missing = Missing { requested: headers::requested(), tried: Vec::new() };
    if missing.is_download() {
        return Err(missing);
    }
    let (mut committed, mut other) = (None, None);
    for root in headers::roots() {
        match probe(&root) {
            Ok(engine) if engine.version == bindings::DEFAULT || cfg!(feature = "bindgen") => return Ok(engine),
            Ok(engine) if engines::supported(engine.version).is_some() => committed = committed.or(Some(engine)),
            Ok(engine) => other = other.or(Some(engine)),
            Err(why) => missing.tried.push(why),
        }
    }
    committed.or(other).ok_or(missing)
}

/// Returns the engine in a directory.
pub(crate) fn probe(root: &Path) -> Result<Engine, String> {
    let headers::Headers { include, version } = headers::probe(root)?;
    let triplet = target::triplet();
    let [lib, bin] = ["lib", "bin"].map(|folder| root.join(folder)); // `bin` in archives for Windows
    let places = [lib.join(&triplet), root.join("lib64"), lib, bin, root.to_path_buf()];
    for dir in &places {
        if let Some(library) = shared_library(dir) {
            let on_loader_path =
                ["/lib", "/lib64", "/usr/lib", "/usr/lib64"].iter().any(|system| dir == Path::new(system))
                    || *dir == Path::new("/usr/lib").join(&triplet);
            return Ok(Engine { include, library_dir: dir.clone(), library, version, on_loader_path });
        }
    }
    let places = places.map(|dir| dir.display().to_string()).join(", ");
    let target = std::env::var("TARGET").unwrap_or_default();
    Err(format!("{}: headers found, but no library for {target} in {places}", include.display()))
}

/// Returns the name of the engine's library for the target in a directory: `libmujoco.so` if the
/// directory has it, else the first versioned name.
fn shared_library(dir: &Path) -> Option<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .ok()?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| target::system().is_library(name) && !target::is_foreign(&dir.join(name)))
        .collect();
    names.sort();
    names.into_iter().next()
}
