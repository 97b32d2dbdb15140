//! Version of the engine, and the process-wide handlers that must be installed before the first
//! call.

use std::env::consts;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use mujoco_sys::{callback, guard, mj_version};

use crate::error::{Error, Result};
use crate::ffi;
use crate::messages::on_warning;
use crate::version::{Version, built_against};

/// Returns the version of the engine library that is loaded at run time.
pub fn engine_version() -> Version {
    // SAFETY: takes no arguments and returns a constant.
    Version::from_number(unsafe { mj_version() } as u32)
}

/// Installs the handlers once, and rejects an engine of another version, because its structs have
/// another layout. Every function that creates a model calls this first, so no engine call can
/// precede it.
pub(crate) fn ready() -> Result<()> {
    static SAME_VERSION: OnceLock<bool> = OnceLock::new();
    let same = SAME_VERSION.get_or_init(|| {
        let same = engine_version() == built_against();
        if same {
            // SAFETY: this crate has called no other function of the engine yet, so no other thread
            // reads the handlers at this time.
            unsafe { guard::install(Some(on_warning)) };
        }
        same
    });
    if *same { Ok(()) } else { Err(Error::EngineVersion { built: built_against(), running: engine_version() }) }
}

/// Loads the engine's plugins from a shared library, or from all shared libraries in a directory.
/// Models whose `<extension>` element names such a plugin load afterwards: actuators, sensors,
/// passive forces and signed distance fields. Engines from 2.3 have plugins. Without this call no
/// plugin is known; a wheel has them in the directory `mujoco/plugin`.
///
/// # Safety
///
/// The libraries are plugins for this version of the engine. Their code runs now and in every call
/// with a model or a simulation that uses them, in any thread: it must be sound for all models and
/// states.
///
/// # Errors
///
/// [`Error::Unsupported`] with an engine before 2.3, [`Error::File`] if the path does not exist,
/// [`Error::Engine`] if a library cannot be loaded, or has a plugin whose name is in use by
/// another. Plugins that were loaded before the error remain.
///
/// ```no_run
/// use mujoco_safe::Model;
///
/// // SAFETY: the plugins of the wheel that contains the engine.
/// unsafe { mujoco_safe::load_plugins("/opt/mujoco/plugin")? };
/// let model = Model::from_xml_path("nut_and_bolt.xml")?;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub unsafe fn load_plugins(path: impl AsRef<Path>) -> Result<()> {
    if !cfg!(engine_since = "2.3.1") {
        return Err(Error::Unsupported(format!("engine plugins with MuJoCo {}, but from 2.3.1", built_against())));
    }
    ready()?;
    let path = path.as_ref();
    let mut libraries = vec![path.to_owned()];
    if fs::metadata(path).map_err(Error::file(path))?.is_dir() {
        let entries: std::io::Result<Vec<_>> = fs::read_dir(path).and_then(Iterator::collect);
        libraries = entries.map_err(Error::file(path))?.iter().map(fs::DirEntry::path).collect();
        let is_library = |path: &PathBuf| path.extension().is_some_and(|extension| extension == consts::DLL_EXTENSION);
        libraries.retain(is_library);
        libraries.sort();
    }
    for library in libraries {
        // The loader of libraries searches other directories for a name without a slash.
        let library = library.canonicalize().map_err(Error::file(&library))?;
        let name = ffi::c_string("the path of a plugin library", library.as_os_str().as_encoded_bytes())?;
        // SAFETY: a valid string, and the caller's promise for the library.
        let status = unsafe { guard::mj_load_plugin_library(name.as_ptr()) };
        ffi::check_without_data("mj_loadPluginLibrary", status)?;
    }
    Ok(())
}

/// Installs a clock in the engine for the whole process. From then on each simulation accumulates
/// the duration of the parts of its steps; see [`Data::timer`](crate::Data::timer). Without a clock
/// the timers only count calls. A step reads the clock about 20 times, at about 25 ns each.
///
/// Call this before the first step of any simulation: a step that is in progress in another thread
/// would record the uptime of the machine as its duration.
///
/// ```
/// mujoco_safe::data::enable_timers();
/// ```
pub fn enable_timers() {
    // SAFETY: the installed clock function only reads the system clock.
    unsafe { callback::install_clock() };
}
