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
}

impl Files<'_> {
    /// Finds the file of a mesh by its name in the URDF. The settings in `<mujoco>` come first,
    /// and the last part of the name alone comes last.
    pub(super) fn find(&self, name: &str) -> Found {
        if !LoadOptions::is_mesh(name) {
            return Found::Unreadable(format!("the engine reads only {}", LoadOptions::MESHES.join(", ")));
        }
        if let Some(known) = self.options.file_name(name) {
            return Found::File(known.to_owned());
        }
        let base = last_part(name);
        let folder = Path::new(&self.folder);
        let mut candidates = Vec::new();
        if self.strips {
            candidates.push(folder.join(base));
        }
        let absolute = |path: PathBuf| std::path::absolute(&path).unwrap_or(path);
        let package = name.strip_prefix("package://");
        let package = package.map(|uri| self.options.package(uri, self.directory).map(absolute));
        let spellings = if package.is_some() { Vec::new() } else { spellings(name) };
        candidates.extend(spellings.iter().map(|name| folder.join(name)));
        if !self.folder.is_empty() {
            candidates.push(folder.join(base));
        }
        candidates.extend(package.iter().flatten().cloned());
        candidates.extend(spellings.iter().map(PathBuf::from));
        candidates.extend([folder.join(base), PathBuf::from(base)]);
        let directory = self.directory.unwrap_or(Path::new(""));
        let found = candidates.iter().find(|path| directory.join(path).is_file());
        let path = match (found, &package) {
            (None, Some(Err(reason))) => return Found::Unknown(reason.clone()),
            (None, None) => &candidates[0],
            (None, Some(Ok(path))) | (Some(path), _) => path,
        };
        match path.to_str() {
            Some(text) if found.is_some() => Found::File(text.to_owned()),
            Some(text) => Found::Missing(text.to_owned()),
            None => Found::Unknown(format!("the path {} is not UTF-8", path.display())),
        }
    }
}

/// Returns the paths that the name of a file can mean: without `file://` and the references of such
/// a URI to characters (`%20`), and with the slashes of the other platforms.
fn spellings(name: &str) -> Vec<String> {
    let mut spellings = match name.strip_prefix("file://") {
        Some(path) => vec![path.to_owned(), without_references(path)],
        None => vec![name.to_owned()],
    };
    spellings.push(spellings[0].replace('\\', "/"));
    spellings
}

/// Replaces references to the bytes of UTF-8: `%20`.
fn without_references(uri: &str) -> String {
    let mut parts = uri.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let digits = part.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        if let Some(byte) = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            bytes.push(byte);
            bytes.extend_from_slice(&part.as_bytes()[2..]);
        } else {
            bytes.push(b'%');
            bytes.extend_from_slice(part.as_bytes());
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}
