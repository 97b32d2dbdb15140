//! Archives of a model and its files, MuJoCo's `.mjz`.

use std::fs::{self, File};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::Spec;
use crate::error::{Error, Result};
use crate::file;
use crate::model::LoadOptions;
use crate::zip_file;

/// The model in an archive.
const MODEL: &str = "model.xml";
/// Largest number of files in an archive.
const MOST_FILES: usize = 10_000;

/// # Archives
///
/// Require the feature `mjz`.
impl Spec {
    /// Reads an archive (`.mjz`, `.zip`) of a model and its files, which is unpacked to a directory
    /// for temporary files. The directory is removed with the last of the spec, its clones and the
    /// specs to which it was attached.
    ///
    /// The model is `model.xml`, `NAME.xml`, `NAME/NAME.xml` or `NAME/model.xml`, in this order, in
    /// an archive `NAME.mjz`, as for MuJoCo.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be read, is not a ZIP archive, has no such model, or has
    /// files outside of the directory, of the same name, of more than 10,000 in number, or of more
    /// than 64 MiB and a hundred times the size of the archive together; and as for
    /// [`from_xml_path`](Self::from_xml_path).
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let folder = tempfile::tempdir()?; // cargo add tempfile
    /// let path = folder.path().join("ball.mjz");
    /// Spec::from_xml_str("<mujoco><worldbody><geom name='ball' size='.1'/></worldbody></mujoco>")?.save_archive(&path)?;
    /// let model = Spec::from_archive_path(&path)?.compile()?;
    /// assert!(model.geom("ball").is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "mj_parse")]
    #[doc(alias = "from_zip")]
    #[doc(alias = "mjz")]
    pub fn from_archive_path(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let (folder, model) = unpack(path).map_err(Error::file(path))?;
        let name = model.strip_prefix(folder.path()).unwrap_or(&model).display();
        let source_name = format!("{name} in {}", path.display());
        let mut spec = Self::from_file(&model, &source_name, &LoadOptions::default())?;
        spec.unpacked.push(Arc::new(folder));
        Ok(spec)
    }

    /// Writes the spec and its assets as an archive (`.mjz`) of `model.xml` and the folder
    /// `model_assets`, which `mj_parse` of MuJoCo 4.0.1 reads, and
    /// [`from_archive_path`](Self::from_archive_path) with every engine. The same spec gives the
    /// same bytes.
    ///
    /// # Errors
    ///
    /// As for [`save_xml_with_assets`](Self::save_xml_with_assets).
    #[doc(alias = "mj_encode")]
    #[doc(alias = "to_zip")]
    #[doc(alias = "mjz")]
    pub fn save_archive(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let folder = tempfile::tempdir().map_err(Error::file(path))?;
        self.save_xml_with_assets(folder.path().join(MODEL))?;
        let files = files(folder.path()).map_err(Error::file(path))?;
        file::replace(path, |out| pack(folder.path(), &files, out))
    }
}

/// Unpacks an archive to a new directory. Returns the directory and the path of the model.
fn unpack(path: &Path) -> io::Result<(TempDir, PathBuf)> {
    let invalid = |text: String| io::Error::new(io::ErrorKind::InvalidData, text);
    let (mut archive, mut allowed) = zip_file::open(path)?;
    if archive.len() > MOST_FILES {
        return Err(invalid(format!("has {} files, and at most {MOST_FILES} are allowed", archive.len())));
    }
    let folder = tempfile::tempdir()?; // cargo add tempfile
    for number in 0..archive.len() {
        let mut entry = archive.by_index(number)?;
        let name = entry.name()?.into_owned();
        // Names that leave the directory have none.
        let inner = entry.enclosed_name().ok_or_else(|| invalid(format!("has a file outside of it: '{name}'")))?;
        if entry.is_dir() {
            continue;
        }
        let target = folder.path().join(inner);
        fs::create_dir_all(target.parent().unwrap_or(folder.path()))?;
        // Fails for a second file of the name.
        let mut out = File::create_new(&target)
            .map_err(|error| io::Error::new(error.kind(), format!("cannot unpack '{name}': {error}")))?;
        let size = io::copy(&mut (&mut entry).take(allowed.saturating_add(1)), &mut out)?;
        allowed = allowed
            .checked_sub(size)
            .ok_or_else(|| invalid(format!("unpacks to more than a hundred times its size, at '{name}'")))?;
    }
    let stem = path.file_stem().unwrap_or_default();
    let mut named = stem.to_owned();
    named.push(".xml");
    let candidates = [MODEL.into(), (&named).into(), Path::new(stem).join(&named), Path::new(stem).join(MODEL)];
    let model = candidates.into_iter().map(|name: PathBuf| folder.path().join(name)).find(|path| path.is_file());
    let model = model.ok_or_else(|| {
        let stem = stem.display();
        invalid(format!("has no model: none of {MODEL}, {stem}.xml, {stem}/{stem}.xml and {stem}/{MODEL}"))
    })?;
    Ok((folder, model))
}

/// Returns the files in a directory and its directories in a fixed order.
fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() { open.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    Ok(found)
}

/// Writes files as an archive, with their names in the directory.
fn pack(folder: &Path, files: &[PathBuf], out: &mut (impl Write + Seek)) -> io::Result<()> {
    let mut archive = ZipWriter::new(out);
    for path in files {
        let parts = path.strip_prefix(folder).unwrap_or(path).iter().map(|part| part.to_string_lossy());
        archive.start_file(parts.collect::<Vec<_>>().join("/"), SimpleFileOptions::default())?;
        io::copy(&mut File::open(path)?, &mut archive)?;
    }
    archive.finish()?.flush()
}
