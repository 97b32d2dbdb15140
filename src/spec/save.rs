//! Saving of a spec with its assets.

use std::collections::{HashMap, HashSet};
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
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("box.xml");
    /// let mut spec = Spec::from_xml_str(r#"<robot name="box"><link name="box"/></robot>"#)?;
    /// spec.add_geom(spec.world()).set_size(&[1.0]);
    /// spec.save_xml(&path)?;
    /// assert_eq!(Model::from_xml_path(&path)?.ngeom(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    /// Assets keep their names. Files of the folder that have the names of assets are replaced, and
    /// others are left unchanged.
    ///
    /// # Errors
    ///
    /// As for [`save_xml`](Self::save_xml), [`Error::File`] if an asset cannot be copied, and
    /// [`Error::Unsupported`] for a spec with an asset that is a model (`<model>`), which names
    /// further files.
    ///
    /// ```
    /// use mujoco_safe::Model;
    /// use mujoco_safe::spec::Spec;
    ///
    /// let folder = tempfile::tempdir()?;
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
        let folder = format!("{stem}_assets");
        let mut copies = Copies::default();
        for Asset { index, attribute, source } in assets {
            let name = copies.name(source).ok_or_else(|| not_utf8(path, path))?;
            // The compiler would derive it from the file.
            if let Some(derived) = names::name(&tree, index).map(str::to_owned) {
                tree.node_mut(index).set("name", derived);
            }
            tree.node_mut(index).set(attribute, format!("{folder}/{name}"));
        }
        let folder = path.with_file_name(folder);
        if !copies.files.is_empty() {
            fs::create_dir_all(&folder).map_err(Error::file(&folder))?;
        }
        for (source, name) in copies.files {
            let target = folder.join(name);
            let content = file::read_regular(&source).map_err(Error::file(&source))?;
            file::replace(&target, |out| std::io::Write::write_all(out, &content))?;
        }
        write(path, &tree)
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

/// Names of the copies of files, which differ also if a file system ignores case.
#[derive(Default)]
struct Copies {
    files: HashMap<PathBuf, String>,
    names: HashSet<String>,
}

impl Copies {
    /// Returns the name of the copy of a file, or `None` if it is not UTF-8.
    fn name(&mut self, source: PathBuf) -> Option<String> {
        if let Some(name) = self.files.get(&source) {
            return Some(name.clone());
        }
        let [stem, extension] = [source.file_stem(), source.extension()].map(|part| part.unwrap_or_default().to_str());
        let (stem, extension) = (stem?, extension?);
        let dot = if extension.is_empty() { "" } else { "." };
        let mut names = (1..).map(|number| match number {
            1 => format!("{stem}{dot}{extension}"),
            number => format!("{stem}-{number}{dot}{extension}"),
        });
        let name = names.find(|name| self.names.insert(name.to_lowercase()))?;
        self.files.insert(source, name.clone());
        Some(name)
    }
}

fn write(path: &Path, tree: &Tree) -> Result<()> {
    let text = text::write(tree).text;
    file::replace(path, |out| std::io::Write::write_all(out, text.as_bytes()))
}

fn not_utf8(path: &Path, wrong: &Path) -> Error {
    Error::Save { path: path.to_owned(), reason: format!("the path {} is not UTF-8", wrong.display()) }
}
