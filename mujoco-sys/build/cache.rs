//! The user's cache, in which the feature `download` installs the engine.

use std::env;
use std::path::PathBuf;

use crate::engines::ENGINES;
use crate::find::{self, Engine};
use crate::headers::{self, DOWNLOAD, MUJOCO_DIR};

/// The version of the wheels in `wheels.txt`.
pub(crate) const VERSION: &str = ENGINES[0].version;

/// Returns the target's folder, which has the package `mujoco` once it is installed.
pub(crate) fn folder() -> Result<PathBuf, String> {
    let variable = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let cache = variable("XDG_CACHE_HOME").or_else(|| variable("LOCALAPPDATA"));
    let cache = cache.or_else(|| Some(variable("HOME")?.join(".cache")));
    let cache = cache.ok_or("neither XDG_CACHE_HOME nor HOME names a folder for the cache")?;
    let target = env::var("TARGET").expect("Cargo sets TARGET");
    Ok(cache.join("mujoco-safe").join(format!("{VERSION}-{target}")))
}

/// Prints a warning if the system's engine was found and the official library of the same version,
/// which is faster than Debian's, is in the cache. The difference was measured on x86-64.
pub(crate) fn suggest(found: &Engine) {
    let is_measured = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86_64");
    if !is_measured || !found.on_loader_path || headers::requested().is_some() {
        return;
    }
    let Ok(folder) = folder() else { return };
    if find::probe(&folder.join("mujoco")).is_ok_and(|official| official.version == found.version) {
        let folder = folder.display().to_string();
        let value = if cfg!(feature = "download") { DOWNLOAD } else { &folder };
        println!(
            "cargo::warning=the official MuJoCo library in {folder} steps the humanoid about 1.25 times as fast as \
             Debian's; {MUJOCO_DIR}={value} uses it instead of that in {}",
            found.library_dir.display()
        );
    }
}
