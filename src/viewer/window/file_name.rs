//! Names of files that are not there yet.

use std::path::{Path, PathBuf};

/// The path itself, or, where there is something already, the first that is free of `name-2.png`, `name-3.png`, ….
pub(super) fn free(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|extension| format!(".{}", extension.to_string_lossy())).unwrap_or_default();
    let mut free = path.to_owned();
    let mut number = 2_u64;
    while free.exists() {
        free = path.with_file_name(format!("{stem}-{number}{extension}"));
        number += 1;
    }
    free
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_there_is_gets_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("view.of.it.png");
        assert_eq!(free(&path), path);
        std::fs::write(&path, "").unwrap();
        let second = folder.path().join("view.of.it-2.png");
        assert_eq!(free(&path), second);
        std::fs::write(&second, "").unwrap();
        assert_eq!(free(&path), folder.path().join("view.of.it-3.png"));
        let folder_name = folder.path().join("frames");
        std::fs::create_dir(&folder_name).unwrap();
        assert_eq!(free(&folder_name), folder.path().join("frames-2"));
    }
}
