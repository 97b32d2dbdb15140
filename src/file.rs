//! Atomic replacement of files, and reading of regular files only.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::error::{Error, Result};

/// Largest size in bytes of a file that [`read_regular`] reads.
const MOST_BYTES: u64 = 1 << 31;

/// Opens a regular file of an ordinary file system for reading. Pipes, sockets and devices can block or never end. So can the
/// files of kernel file systems such as `/proc/kmsg`, although their metadata marks them as regular.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    // Check before opening, because opening a pipe waits for a writer and opening a device can have side effects.
    check_regular(path)?;
    let mut options = File::options();
    options.read(true);
    // The path may have been replaced by a pipe in the meantime.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, rustix::fs::OFlags::NONBLOCK.bits() as i32);
    let file = options.open(path)?;
    check_type(&file.metadata()?)?;
    Ok(file)
}

/// Checks that a path refers to a regular file of an ordinary file system.
pub(crate) fn check_regular(path: &Path) -> io::Result<()> {
    check_type(&fs::metadata(path)?)?;
    #[cfg(target_os = "linux")]
    if KERNEL_FILE_SYSTEMS.contains(&(rustix::fs::statfs(path)?.f_type as u32)) {
        return Err(io::Error::other("not a regular file, but a file of the kernel"));
    }
    Ok(())
}

fn check_type(metadata: &fs::Metadata) -> io::Result<()> {
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    Ok(())
}

/// Magic numbers of the file systems whose contents the kernel generates, from `linux/magic.h`.
#[cfg(target_os = "linux")]
const KERNEL_FILE_SYSTEMS: [u32; 20] = [
    0x9fa0,      // proc
    0x6265_6572, // sysfs
    0x6462_6720, // debugfs
    0x7472_6163, // tracefs
    0x7363_6673, // securityfs
    0x6265_6570, // configfs
    0x0027_e0eb, // cgroup
    0x6367_7270, // cgroup2
    0xcafe_4a11, // bpf
    0x6165_676c, // pstore
    0xde5e_81e4, // efivarfs
    0xf97c_ff8c, // selinuxfs
    0x4341_5d53, // smackfs
    0x0000_1cd1, // devpts
    0x1980_0202, // mqueue
    0x4249_4e4d, // binfmt_misc
    0x6573_5543, // fusectl
    0x6e73_6673, // nsfs
    0x0765_5821, // resctrl
    0x6759_6969, // rpc_pipefs
];

/// Reads a regular file of at most 2 GiB.
pub(crate) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    let file = open_regular(path)?;
    let length = file.metadata()?.len();
    let too_large = || io::Error::new(io::ErrorKind::FileTooLarge, "larger than 2 GiB");
    if length > MOST_BYTES {
        return Err(too_large());
    }
    let mut content = Vec::new();
    content.try_reserve_exact(length as usize)?;
    // A file can grow while it is read.
    file.take(MOST_BYTES + 1).read_to_end(&mut content)?;
    if content.len() as u64 > MOST_BYTES { Err(too_large()) } else { Ok(content) }
}

/// Creates a file with private permissions for data that will later be written to `path`: in the directory for temporary files, or
/// else in the directory of `path`.
pub(crate) fn temporary(path: &Path) -> io::Result<NamedTempFile> {
    NamedTempFile::new().or_else(|error| NamedTempFile::new_in(folder(path)).map_err(|_| error))
}

/// Replaces a file atomically by the data that `write` writes. If an error occurs, the previous file is left unchanged.
pub(crate) fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    try_replace(path, write).map_err(Error::file(path))
}

fn try_replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let replacement = Replacement::create(path)?;
    let mut out = BufWriter::new(replacement.file.try_clone()?);
    write(&mut out)?;
    out.flush()?;
    replacement.finish()
}

/// Replacement of a file in progress. The data has a temporary name until [`finish`](Self::finish), and is deleted if the value
/// is dropped before.
pub(crate) struct Replacement {
    file: File,
    /// Temporary path of the file. `None` if the target is a pipe or a device, which is written to directly.
    name: Option<TempPath>,
    path: PathBuf,
    permissions: Option<Permissions>,
}

impl Replacement {
    /// Creates the temporary file for a replacement of `path`.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let path = resolve_links(path)?;
        let existing = fs::metadata(&path).ok();
        if let Some(existing) = &existing {
            if existing.is_dir() {
                return Err(io::ErrorKind::IsADirectory.into());
            }
            // Require write permission for the existing file, although the permissions of its directory suffice to replace it.
            let file = File::options().write(true).open(&path)?;
            if !existing.is_file() {
                return Ok(Self { file, name: None, path, permissions: None });
            }
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".").suffix(".part");
        // The default permissions of temporary files deny access to other users.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Use the directory of the target, because a file can only be renamed within a file system.
        let (file, name) = builder.tempfile_in(folder(&path))?.into_parts();
        Ok(Self { file, name: Some(name), path, permissions: existing.map(|existing| existing.permissions()) })
    }

    /// Returns the open file.
    #[cfg(feature = "renderer")]
    pub(crate) fn file(&self) -> &File {
        &self.file
    }

    /// Returns the path of the open file, for another process to write to.
    #[cfg(feature = "renderer")]
    pub(crate) fn temporary_path(&self) -> &Path {
        self.name.as_deref().unwrap_or(&self.path)
    }

    /// Renames the temporary file to its final path.
    pub(crate) fn finish(self) -> io::Result<()> {
        if let Some(permissions) = self.permissions {
            self.file.set_permissions(permissions)?;
        }
        drop(self.file);
        match self.name {
            Some(name) => name.persist(&self.path).map_err(|failed| failed.error),
            None => Ok(()),
        }
    }
}

/// Resolves symbolic links, so that a replacement does not overwrite the link itself. The target need not exist.
fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: usize = 40;
    if let Ok(path) = fs::canonicalize(path) {
        return Ok(path);
    }
    let mut path = path.to_owned();
    // Files that the process has open, such as `/dev/stdout`, can be opened although their links are dangling.
    if fs::metadata(&path).is_ok() {
        return Ok(path);
    }
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&path) else { return Ok(path) };
        path = folder(&path).join(target);
    }
    Err(io::Error::other("too many links"))
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::{Error, Write};

    use super::replace;

    #[test]
    fn a_failed_replacement_keeps_the_old_file_and_removes_the_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "old").unwrap();
        let error = replace(&path, |out| out.write_all(b"half").and(Err(Error::other("full")))).unwrap_err();
        assert!(error.to_string().ends_with("file: full"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        replace(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_directory_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        replace(folder.path(), |_| Ok(())).unwrap_err();
        assert!(folder.path().is_dir());
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_directories_are_not_read() {
        for path in ["/dev/zero", "/dev/null", "/"] {
            super::read_regular(path.as_ref()).unwrap_err();
        }
    }

    #[cfg(unix)]
    #[test]
    fn replacement_preserves_links_devices_and_permissions() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        replace(&link, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        let (missing, dangling) = (folder.path().join("missing"), folder.path().join("dangling"));
        std::os::unix::fs::symlink("missing", &dangling).unwrap();
        replace(&dangling, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&dangling).unwrap().is_symlink());
        assert_eq!(fs::read(&missing).unwrap(), b"new");
        let circle = folder.path().join("circle");
        std::os::unix::fs::symlink("circle", &circle).unwrap();
        replace(&circle, |_| Ok(())).unwrap_err();
        replace("/dev/null".as_ref(), |out| out.write_all(b"new")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
