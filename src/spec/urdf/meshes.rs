//! Meshes of a URDF: their names and files.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::Attributes;
use crate::model::LoadOptions;
use crate::spec::value::Value;

/// Meshes that geoms use, in the order of the first use.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) attributes: Vec<Attributes>,
    by_file: HashMap<(String, [u64; 3]), String>,
    names: HashSet<String>,
    /// Number of meshes with files of this name.
    counts: HashMap<String, usize>,
}

impl Meshes {
    /// Returns the name of the mesh of a file with a scale: the name of the file, with a number if
    /// another one has it.
    pub(super) fn name(&mut self, file: String, scale: [f64; 3]) -> String {
        let key = (file, scale.map(f64::to_bits));
        if let Some(name) = self.by_file.get(&key) {
            return name.clone();
        }
        let last = last_part(&key.0);
        let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem).to_owned();
        let count = self.counts.entry(stem.clone()).or_default();
        let name = loop {
            let name = if *count == 0 && !stem.is_empty() { stem.clone() } else { format!("{stem}{count}") };
            *count += 1;
            if self.names.insert(name.clone()) {
                break name;
            }
        };
        let mut attributes = vec![("name", name.clone()), ("file", key.0.clone())];
        if scale != [1.0; 3] {
            attributes.push(("scale", scale.text().into_owned()));
        }
        self.attributes.push(attributes);
        self.by_file.insert(key, name.clone());
        name
    }
}

/// File of a mesh.
pub(super) enum Found {
    /// Name for MJCF: a path relative to the directory of the URDF, an absolute path, or the name
    /// of a file in memory.
    File(String),
    /// No file was found; this is the name in the URDF, relative to its directory.
    Missing(String),
    /// The engine cannot read the file, for this reason.
    Unreadable(String),
    /// The package of the file is not known, for this reason.
    Unknown(String),
}

/// Files that a URDF can name.
pub(super) struct Files<'a> {
    /// Directory of the URDF, `None` for a text from memory.
    pub(super) directory: Option<&'a Path>,
    pub(super) options: &'a LoadOptions<'a>,
    /// Directory of the meshes by `<mujoco>`.
    pub(super) folder: String,
    /// Names are those after the last slash, by `<mujoco>`.
    pub(super) strips: bool,
    /// Directories of packages that were found.
    pub(super) packages: HashMap<String, Result<PathBuf, String>>,
}

impl Files<'_> {
    /// Finds the file of a mesh by its name in the URDF.
    pub(super) fn find(&mut self, name: &str) -> Found {
        if !LoadOptions::is_mesh(name) {
            return Found::Unreadable(format!("the engine reads only {}", LoadOptions::MESHES.join(", ")));
        }
        if let Some(known) = self.options.file_name(name) {
            return Found::File(known.to_owned());
        }
        if let Some(uri) = name.strip_prefix("package://") {
            let (package, inside) = uri.split_once('/').unwrap_or((uri, ""));
            let find = || self.options.package(package, inside, self.directory);
            let found = self.packages.entry(package.to_owned()).or_insert_with(find);
            let path = match found {
                Ok(folder) => folder.join(inside),
                Err(reason) => return Found::Unknown(reason.clone()),
            };
            let path = std::path::absolute(&path).unwrap_or(path);
            return match path.to_str() {
                Some(text) if path.is_file() => Found::File(text.to_owned()),
                Some(text) => Found::Missing(text.to_owned()),
                None => Found::Unknown(format!("the path {} is not UTF-8", path.display())),
            };
        }
        let name = name.strip_prefix("file://").unwrap_or(name);
        let base = last_part(name);
        let whole = [Path::new(&self.folder).join(name), PathBuf::from(name)];
        let stripped = [Path::new(&self.folder).join(base), PathBuf::from(base)];
        let candidates = if self.strips { [stripped, whole] } else { [whole, stripped] };
        let directory = self.directory.unwrap_or(Path::new(""));
        let found = candidates.as_flattened().iter().find(|path| directory.join(path).is_file());
        let path = found.unwrap_or(&candidates[0][0]).to_string_lossy().into_owned();
        if found.is_some() { Found::File(path) } else { Found::Missing(path) }
    }
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}
