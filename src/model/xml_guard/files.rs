//! Lookup of the files that a text names, by the compiler's rules.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::io;
use std::path::Path;

use crate::file;

/// Sources of files in the order in which the compiler searches them: in memory, by names without a path, and then on disk.
#[derive(Default)]
pub(in crate::model) struct Files<'f> {
    pub(in crate::model) memory: &'f [(&'f str, &'f [u8])],
    /// Base directory for relative names, with a trailing slash. If empty, the working directory of the process.
    pub(in crate::model) directory: &'f [u8],
}

/// Result of looking up a file.
pub(super) enum Found<'f> {
    /// No readable file. The compiler will report it.
    Nothing,
    /// A pipe, a device, a directory or a file of the kernel, on which the compiler could block, or a huge file. Contains the
    /// reason.
    Rejected(&'static str),
    Content(Cow<'f, [u8]>),
}

impl<'f> Files<'f> {
    /// Looks up a path as the compiler will do.
    pub(super) fn find(&self, path: &[u8]) -> Found<'f> {
        let is = |name: &str| last_part(name.as_bytes()).eq_ignore_ascii_case(last_part(path));
        if let Some((_, content)) = self.memory.iter().find(|(name, _)| is(name)) {
            return Found::Content(Cow::Borrowed(content));
        }
        let path = os_path(path);
        if path.exists() && file::check_regular(path).is_err() {
            return Found::Rejected("is not a regular file");
        }
        match file::read_regular(path) {
            Ok(content) => Found::Content(Cow::Owned(content)),
            Err(error) if error.kind() == io::ErrorKind::FileTooLarge => Found::Rejected("is larger than 2 GiB"),
            Err(_) => Found::Nothing,
        }
    }

    /// Returns the path of an asset, which may be relative to a directory that the text specifies.
    pub(super) fn asset_path(&self, folder: &[u8], name: &[u8]) -> Vec<u8> {
        let slash: &[u8] = if matches!(folder.last(), None | Some(b'/' | b'\\')) { b"" } else { b"/" };
        if is_absolute(name) {
            name.to_owned()
        } else if is_absolute(folder) {
            [folder, slash, name].concat()
        } else {
            [self.directory, folder, slash, name].concat()
        }
    }
}

/// Returns `true` if the compiler treats a path as absolute.
fn is_absolute(path: &[u8]) -> bool {
    matches!(path.first(), Some(b'/' | b'\\')) || path.windows(2).any(|pair| pair == b":/" || pair == b":\\")
}

/// Returns `true` if the path exists and is a pipe or a device.
pub(super) fn is_irregular(path: &[u8]) -> bool {
    let path = os_path(path);
    path.exists() && !path.is_dir() && file::check_regular(path).is_err()
}

/// Returns the part of a path up to and including the last slash.
pub(in crate::model) fn directory(path: &[u8]) -> &[u8] {
    &path[..path.len() - last_part(path).len()]
}

/// Returns the part of a path after the last slash.
pub(super) fn last_part(path: &[u8]) -> &[u8] {
    path.rsplit(|byte| b"/\\".contains(byte)).next().unwrap_or_default()
}

/// Returns the first 60 characters of a name for an error message.
pub(super) fn abbreviated(name: &[u8]) -> String {
    String::from_utf8_lossy(name).chars().take(60).collect()
}

#[cfg(unix)]
pub(in crate::model) fn path_bytes(path: &Path) -> &[u8] {
    std::os::unix::ffi::OsStrExt::as_bytes(path.as_os_str())
}

#[cfg(unix)]
pub(super) fn os_path(path: &[u8]) -> &Path {
    Path::new(<OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(path))
}

#[cfg(not(unix))]
pub(in crate::model) fn path_bytes(path: &Path) -> &[u8] {
    path.to_str().unwrap_or_default().as_bytes()
}

#[cfg(not(unix))]
pub(super) fn os_path(path: &[u8]) -> &Path {
    Path::new(OsStr::new(std::str::from_utf8(path).unwrap_or_default()))
}
