//! Saving of a spec with its assets.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::paths::{self, FILES, is_asset};
use super::tree::{Index, Tree};
use super::{Spec, names, text};
use crate::error::{Error, Result};
use crate::file;

/// # Saving
impl Spec {
    /// Writes the spec as an MJCF file, in which the names of assets are absolute paths. So the
    /// file loads from every directory of this machine, if the spec compiles without files in
    /// memory.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written, or an asset does not exist;
    /// [`Error::Save`] if a path is not UTF-8; and as for [`compile`](Self::compile) if a name has
    /// a NUL character, or values of a keyframe cannot be placed. A previous file is left unchanged
    /// then.
    ///
    /// ```
    /// use mujoco_safe::Model;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let folder = tempfile::tempdir()?; // cargo add tempfile
    /// let path = folder.path().join("box.xml");
    /// let mut spec = Spec::from_xml_str(r#"<robot name="box"><link name="box"/></robot>"#)?;
    /// spec.add_geom(spec.world()).set_size(&[1.0]);
    /// spec.save_xml(&path)?;
    /// assert_eq!(Model::from_xml_path(&path)?.ngeom(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "to_file")]
    #[doc(alias = "mj_saveXML")]
    #[doc(alias = "mj_saveLastXML")]
    pub fn save_xml(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let mut tree = self.complete_tree()?.into_owned();
        for Asset { index, attribute, source } in self.assets(&mut tree)? {
            let name = source.to_str().ok_or_else(|| not_utf8(path, &source))?.to_owned();
            tree.node_mut(index).set(attribute, name);
        }
        write(path, &tree)
    }

    /// Writes the spec as an MJCF file `scene.xml`, and copies of its assets in a folder
    /// `scene_assets` beside it. So the two load from every directory, also on another machine, if
    /// the spec compiles without files in memory.
    ///
    /// Assets keep their names, with a number if another asset or a file of the folder has the name
    /// and another content. Files of the folder are never changed, so those of earlier versions
    /// remain.
    ///
    /// # Errors
    ///
    /// As for [`save_xml`](Self::save_xml), [`Error::File`] if an asset cannot be copied,
    /// [`Error::Save`] if the folder is a symbolic link, and [`Error::Unsupported`] for a spec with
    /// an asset that is a model (`<model>`), which names further files. The new copies are removed
    /// then.
    ///
    /// ```
    /// use mujoco_safe::Model;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let folder = tempfile::tempdir()?; // cargo add tempfile
    /// let corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    /// std::fs::create_dir_all(folder.path().join("robots/meshes"))?;
    /// std::fs::write(folder.path().join("robots/meshes/corner.obj"), corner)?;
    /// let urdf = r#"<robot name="corner"><link name="corner"><collision><geometry>
    ///     <mesh filename="meshes/corner.obj"/>
    /// </geometry></collision></link></robot>"#;
    /// std::fs::write(folder.path().join("robots/corner.urdf"), urdf)?;
    ///
    /// let spec = Spec::from_xml_path(folder.path().join("robots/corner.urdf"))?;
    /// spec.save_xml_with_assets(folder.path().join("scene.xml"))?;
    /// std::fs::remove_dir_all(folder.path().join("robots"))?;
    /// assert!(folder.path().join("scene_assets/corner.obj").exists());
    /// assert_eq!(Model::from_xml_path(folder.path().join("scene.xml"))?.nmesh(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save_xml_with_assets(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let mut tree = self.complete_tree()?.into_owned();
        let assets = self.assets(&mut tree)?;
        if let Some(asset) = assets.iter().find(|asset| tree.tag(asset.index) == "model") {
            let model = names::describe(&tree, asset.index);
            return Err(Error::Unsupported(format!("copies of the files of {model}: save_xml writes its path")));
        }
        let stem = path.file_stem().unwrap_or_default().to_str().ok_or_else(|| not_utf8(path, path))?;
        let name_of_folder = format!("{stem}_assets");
        let folder = path.with_file_name(&name_of_folder);
        if folder.is_symlink() {
            let reason = format!("{} is a symbolic link, and copies would be elsewhere", folder.display());
            return Err(Error::Save { path: path.to_owned(), reason });
        }
        let mut copies =
            Copies { folder: &folder, files: Vec::new(), by_source: HashMap::new(), by_name: HashMap::new() };
        for Asset { index, attribute, source } in assets {
            let name = copies.name(&source)?.ok_or_else(|| not_utf8(path, &source))?;
            // The compiler would derive it from the file.
            if let Some(derived) = names::name(&tree, index).map(str::to_owned) {
                tree.node_mut(index).set("name", derived);
            }
            tree.node_mut(index).set(attribute, format!("{name_of_folder}/{name}"));
        }
        copies.write(|| write(path, &tree))
    }

    /// Returns the files of assets, with complete paths. Removes the settings of the compiler that
    /// change the meaning of file names.
    fn assets(&self, tree: &mut Tree) -> Result<Vec<Asset>> {
        let directory = self.directory.as_deref().unwrap_or(Path::new(""));
        paths::resolve(tree, None);
        let mut assets = Vec::new();
        for index in tree.descendants(Tree::ROOT).into_iter().filter(|&index| is_asset(tree, index)) {
            for attribute in FILES {
                let Some(name) = tree.attribute(index, attribute).filter(|name| !name.is_empty()) else { continue };
                let source = directory.join(name);
                let source = std::path::absolute(&source).map_err(Error::file(&source))?;
                file::check_regular(&source).map_err(Error::file(&source))?;
                assets.push(Asset { index, attribute, source });
            }
        }
        Ok(assets)
    }
}

/// File of an asset.
struct Asset {
    index: Index,
    attribute: &'static str,
    source: PathBuf,
}

/// Copies of files in a folder. Their names differ also if a file system ignores case.
struct Copies<'f> {
    folder: &'f Path,
    files: Vec<Copy>,
    /// Numbers of the copies.
    by_source: HashMap<PathBuf, usize>,
    /// The names are in lower case.
    by_name: HashMap<String, usize>,
}

struct Copy {
    name: String,
    content: Vec<u8>,
    /// The folder has this file.
    exists: bool,
}

impl Copies<'_> {
    /// Returns the name of the copy of a file, or `None` if it is not UTF-8. It is not that of a
    /// file with another content.
    fn name(&mut self, source: &Path) -> Result<Option<String>> {
        if let Some(&number) = self.by_source.get(source) {
            return Ok(Some(self.files[number].name.clone()));
        }
        let [stem, extension] = [source.file_stem(), source.extension()].map(|part| part.unwrap_or_default().to_str());
        let (Some(stem), Some(extension)) = (stem, extension) else { return Ok(None) };
        let content = file::read_regular(source).map_err(Error::file(source))?;
        let dot = if extension.is_empty() { "" } else { "." };
        for number in 1.. {
            let suffix = if number == 1 { String::new() } else { format!("-{number}") };
            let name = format!("{stem}{suffix}{dot}{extension}");
            let target = self.folder.join(&name);
            let number = match self.by_name.get(&name.to_lowercase()) {
                Some(&number) if self.files[number].content == content => number,
                Some(_) => continue,
                None => {
                    let exists = fs::symlink_metadata(&target).is_ok();
                    if exists && !is_file_with(&target, &content) {
                        continue;
                    }
                    self.by_name.insert(name.to_lowercase(), self.files.len());
                    self.files.push(Copy { name, content, exists });
                    self.files.len() - 1
                }
            };
            self.by_source.insert(source.to_owned(), number);
            return Ok(Some(self.files[number].name.clone()));
        }
        Ok(None)
    }

    /// Writes the copies and then what refers to them. If one of the two fails, the new copies are
    /// removed.
    fn write(&self, and_then: impl FnOnce() -> Result<()>) -> Result<()> {
        let mut written = Vec::new();
        let is_new = !self.files.is_empty() && !self.folder.exists();
        let write = || {
            if is_new {
                fs::create_dir(self.folder).map_err(Error::file(self.folder))?;
            }
            for Copy { name, content, .. } in self.files.iter().filter(|file| !file.exists) {
                let target = self.folder.join(name);
                file::replace(&target, |out| std::io::Write::write_all(out, content))?;
                written.push(target);
            }
            and_then()
        };
        let result = write();
        if result.is_err() {
            for path in written {
                let _ = fs::remove_file(path);
            }
            if is_new {
                // Fails if another process put a file there.
                let _ = fs::remove_dir(self.folder);
            }
        }
        result
    }
}

/// Returns `true` for a file with this content that is not a symbolic link.
fn is_file_with(path: &Path, content: &[u8]) -> bool {
    let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.len() == content.len() as u64);
    is_file && file::read_regular(path).is_ok_and(|found| found == content)
}

fn write(path: &Path, tree: &Tree) -> Result<()> {
    let text = text::write(tree).text;
    file::replace(path, |out| std::io::Write::write_all(out, text.as_bytes()))
}

fn not_utf8(path: &Path, wrong: &Path) -> Error {
    Error::Save { path: path.to_owned(), reason: format!("the path {} is not UTF-8", wrong.display()) }
}
