//! Finds libclang, which generates bindings. Used by the build script (feature `bindgen`), by its
//! tests and by `xtask`.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The error if no libclang was found.
pub(crate) const MISSING: &str = "libclang, which generates bindings, was not found. Install it by one of: pip install libclang; apt-get install libclang-dev";

/// Makes bindgen use the libclang of PyPI's package `libclang`, if the Python on the path has it
/// and the user has selected none. Otherwise bindgen searches the system.
pub(crate) fn select() {
    let variable = "LIBCLANG_PATH";
    if std::env::var_os(variable).is_some() {
        return;
    }
    if let Some(folder) = ["python3", "python"].iter().find_map(|python| of_python(Path::new(python))) {
        // SAFETY: the build script and `xtask` have one thread.
        unsafe { std::env::set_var(variable, folder) };
    }
}

/// Returns the folder of libclang in a Python with the package.
pub(crate) fn of_python(python: &Path) -> Option<PathBuf> {
    let output = Command::new(python).args(["-c", "import clang; print(clang.__path__[0])"]).output().ok()?;
    let package = String::from_utf8(output.stdout).ok()?;
    Some(Path::new(package.trim()).join("native")).filter(|folder| output.status.success() && folder.is_dir())
}
