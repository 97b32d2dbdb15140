//! Finds libclang for the feature `bindgen`.

use std::path::Path;

/// Makes bindgen use the libclang of PyPI's package `libclang`, if an active environment has it and
/// the user has selected none.
pub(crate) fn select() {
    let variable = "LIBCLANG_PATH";
    if std::env::var_os(variable).is_some() {
        return;
    }
    let prefixes = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(std::env::var_os);
    let pythons = prefixes.filter_map(|prefix| std::fs::read_dir(Path::new(&prefix).join("lib")).ok()).flatten();
    let folders = pythons.flatten().map(|python| python.path().join("site-packages/clang/native"));
    if let Some(folder) = folders.into_iter().find(|folder| folder.is_dir()) {
        // SAFETY: the build script has one thread.
        unsafe { std::env::set_var(variable, folder) };
    }
}
