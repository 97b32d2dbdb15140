//! Resolution of the `package://` URIs and the directories by which ROS names meshes in URDF.
//!
//! The engine does not support these URIs, nor before 3.7 directories (this module resolves them
//! before 3.0). It strips the path, searches for the file name in the directory of the model, and
//! treats two meshes with the same file name as one. This module therefore reads the files and
//! passes them to the engine in memory, under unique names.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use crate::file;
use crate::model::xml_guard::{Tags, decoded};

const SCHEME: &str = "package://";

/// Extensions of the mesh formats that the engine reads.
pub(super) const FORMATS: [&str; 3] = ["stl", "obj", "msh"];

/// Directories of ROS packages.
#[derive(Clone, Debug, Default)]
pub(super) struct Packages {
    directories: HashMap<String, PathBuf>,
    search_path: Vec<PathBuf>,
}

impl Packages {
    pub(super) fn add(&mut self, name: String, directory: PathBuf) {
        self.directories.insert(name, directory);
    }

    pub(super) fn search(&mut self, list: &OsStr) {
        self.search_path.extend(std::env::split_paths(list).filter(|path| !path.as_os_str().is_empty()));
    }

    fn directory(&self, package: &str) -> Option<PathBuf> {
        let searched = || self.search_path.iter().flat_map(|path| places(path, package));
        self.directories.get(package).cloned().or_else(|| searched().find(|path| path.is_dir()))
    }

    /// Returns the path of a file in a package, given its URI without the scheme. Without a known
    /// directory, the package is searched for in the directories around `directory`: one that has
    /// its name, or whose `package.xml` has it. The first with the file is used, else the first.
    pub(super) fn find(&self, uri: &str, directory: Option<&Path>) -> Result<PathBuf, String> {
        let (package, inside) = uri.split_once('/').unwrap_or((uri, ""));
        let inside = inside.trim_start_matches('/');
        if !matches!(Path::new(package).components().collect::<Vec<_>>()[..], [Component::Normal(_)]) {
            return Err(format!("{SCHEME}{uri} does not have the form {SCHEME}name/path"));
        }
        if !is_inside(inside) {
            return Err(format!("the path of {SCHEME}{uri} leaves the package"));
        }
        if let Some(known) = self.directory(package) {
            return Ok(known.join(inside));
        }
        // A file without a directory in its path is in the working directory.
        let directory = directory.map(|directory| if directory == "" { Path::new(".") } else { directory });
        let around = directory.and_then(|directory| std::path::absolute(directory).ok());
        let places = around.iter().flat_map(|directory| directory.ancestors()).flat_map(|path| {
            let named = is_named(path, package).then(|| path.to_owned());
            named.into_iter().chain(places(path, package))
        });
        let found: Vec<PathBuf> = places.filter(|path| path.is_dir()).map(|path| path.join(inside)).collect();
        let file = found.iter().find(|path| path.is_file());
        file.or(found.first()).cloned().ok_or_else(|| unknown(package))
    }
}

/// Returns `true` if a path relative to a directory does not leave it.
fn is_inside(path: &str) -> bool {
    let mut depth = 0_usize;
    Path::new(path).components().all(|component| {
        let next = match component {
            Component::Normal(_) => depth.checked_add(1),
            Component::CurDir => Some(depth),
            Component::ParentDir => depth.checked_sub(1),
            Component::RootDir | Component::Prefix(_) => None,
        };
        depth = next.unwrap_or_default();
        next.is_some()
    })
}

/// Returns the directories in which a package can be, given a directory of a search path.
fn places(path: &Path, package: &str) -> Vec<PathBuf> {
    let is_itself = path.file_name() == Some(OsStr::new(package));
    let mut places = vec![path.join(package), path.join("share").join(package)];
    places.extend(is_itself.then(|| path.to_owned()));
    places
}

/// Returns `true` if a directory has a `package.xml` with the name of a package.
fn is_named(path: &Path, package: &str) -> bool {
    let manifest = file::read_regular(&path.join("package.xml")).unwrap_or_default();
    let text = String::from_utf8_lossy(&manifest);
    text.split_once("<name>")
        .is_some_and(|(_, rest)| rest.split("</name>").next().unwrap_or_default().trim() == package)
}

fn unknown(package: &str) -> String {
    format!(
        "the directory of package '{package}' is unknown; set it with LoadOptions::with_package or with_package_path"
    )
}

/// Result of resolving the `package://` URIs of a text.
#[derive(Default)]
pub(super) struct Resolved<'t> {
    /// The text, in which files are renamed if two packages have files of the same name.
    pub(super) text: Cow<'t, [u8]>,
    /// Names and contents of the files.
    pub(super) files: Vec<(String, Vec<u8>)>,
    /// File names of the URIs that were not resolved, and the reasons.
    pub(super) unresolved: Vec<(String, String)>,
}

/// Reads the meshes that a text names by `package://` URIs, and those in other directories than
/// that of the text, which older engines do not find. Files of `given` take precedence over files
/// of the same name.
pub(super) fn resolve<'t>(
    text: &'t [u8],
    packages: &Packages,
    given: &[(&str, &[u8])],
    directory: &Path,
) -> Resolved<'t> {
    let mut resolved = Resolved { text: Cow::Borrowed(text), ..Resolved::default() };
    let mut names: HashMap<PathBuf, String> = HashMap::new();
    let mut missing = Vec::new();
    let mut renamed: Vec<(Range<usize>, String)> = Vec::new();
    for (range, name) in file_names(text) {
        let uri = name.strip_prefix(SCHEME).unwrap_or(&name).to_owned();
        let base = last_part(&uri);
        if is_taken(base, given.iter().map(|(name, _)| *name)) {
            continue;
        }
        let located = if name.starts_with(SCHEME) {
            locate(&uri, packages, directory)
        } else {
            let Some(path) = in_other_directory(&name, directory) else { continue };
            Ok(path)
        };
        let path = match located {
            Ok(path) => path,
            Err(reason) => {
                resolved.unresolved.push((base.to_owned(), reason));
                missing.push((range, uri));
                continue;
            }
        };
        if !names.contains_key(&path) {
            let content = match file::read_regular(&path) {
                Ok(content) => content,
                Err(error) => {
                    resolved.unresolved.push((base.to_owned(), format!("{name} is {}: {error}", path.display())));
                    missing.push((range, uri));
                    continue;
                }
            };
            let is_unique = !is_taken(base, resolved.files.iter().map(|(name, _)| &name[..]));
            let name = if is_unique { base.to_owned() } else { unique_name(&uri) };
            resolved.files.push((name.clone(), content));
            names.insert(path.clone(), name);
        }
        if names[&path] != base {
            renamed.push((range, names[&path].clone()));
        }
    }
    // Rename missing files too, so that the engine does not use a file of the same name from
    // another package.
    for (range, uri) in missing {
        if is_taken(last_part(&uri), resolved.files.iter().map(|(name, _)| &name[..])) {
            renamed.push((range, unique_name(&uri)));
        }
    }
    if !renamed.is_empty() {
        renamed.sort_by_key(|(range, _)| range.start);
        resolved.text = Cow::Owned(replace(text, &renamed));
    }
    resolved
}

/// Returns the path of a mesh, given the URI without its scheme.
fn locate(uri: &str, packages: &Packages, directory: &Path) -> Result<PathBuf, String> {
    let path = packages.find(uri, Some(directory))?;
    if has_known_format(&path) {
        Ok(path)
    } else {
        Err(format!("{SCHEME}{uri} is not a mesh in a format that the engine supports: {}", FORMATS.join(", ")))
    }
}

/// Returns the path of a mesh whose name has a directory, which the reader of older engines
/// ignores, unless there is a file where these engines look. Engines from 3.1 to 3.6 keep meshes
/// in memory by their names, so another mesh of the same name would be the wrong one there.
fn in_other_directory(name: &str, directory: &Path) -> Option<PathBuf> {
    if cfg!(engine_since = "3.0.0") || !has_known_format(Path::new(name)) {
        return None;
    }
    let path = directory.join(name);
    let is_beside = directory.join(last_part(name)).exists();
    Some(path).filter(|path| !is_beside && path.is_file())
}

/// Returns a file name that contains the complete URI.
fn unique_name(uri: &str) -> String {
    uri.replace(['/', '\\'], "-")
}

/// Finds the file names of meshes, with the ranges of the attribute values.
fn file_names(text: &[u8]) -> impl Iterator<Item = (Range<usize>, String)> {
    Tags::new(text).filter(|tag| tag.name == b"mesh").filter_map(|tag| {
        let range = tag.attribute_range(b"filename")?;
        let value = String::from_utf8(decoded(&text[range.clone()]).into_owned()).ok()?;
        Some((range, value))
    })
}

/// Returns `true` if the engine could confuse one of `names` with `name`. It compares the last
/// parts of paths and ignores case.
fn is_taken<'n>(name: &str, mut names: impl Iterator<Item = &'n str>) -> bool {
    names.any(|taken| last_part(taken).eq_ignore_ascii_case(name))
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}

pub(super) fn has_known_format(path: &Path) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    FORMATS.iter().any(|known| known.eq_ignore_ascii_case(extension))
}

/// Replaces the attribute values at the given ranges, which are in ascending order.
fn replace(text: &[u8], values: &[(Range<usize>, String)]) -> Vec<u8> {
    let mut result = Vec::with_capacity(text.len());
    let mut done = 0;
    for (range, value) in values {
        result.extend_from_slice(&text[done..range.start]);
        let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('\'', "&apos;");
        result.extend_from_slice(value.as_bytes());
        done = range.end;
    }
    result.extend_from_slice(&text[done..]);
    result
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::Packages;

    /// Tests run in the directory of this crate.
    #[test]
    fn packages_are_found_around_the_working_directory() {
        let found = Packages::default().find("src/lib.rs", Some(Path::new(""))).unwrap();
        assert!(found.is_absolute() && found.is_file(), "{}", found.display());
    }

    #[test]
    fn names_and_paths_stay_in_the_package() {
        let mut packages = Packages::default();
        for name in ["arm", ".", ".."] {
            packages.add(name.to_owned(), "/packages/arm".into());
        }
        for (uri, expected) in [
            ("arm/meshes/a.obj", "/packages/arm/meshes/a.obj"),
            ("arm//etc/a.obj", "/packages/arm/etc/a.obj"),
            ("arm/x/../a.obj", "/packages/arm/x/../a.obj"),
        ] {
            assert_eq!(packages.find(uri, None).unwrap(), Path::new(expected));
        }
        for uri in ["", "/a.obj", "./a.obj", "../a.obj"] {
            assert!(packages.find(uri, None).unwrap_err().contains("form package://name/path"), "{uri}");
        }
        for uri in ["arm/../a.obj", "arm/x/../../a.obj"] {
            assert!(packages.find(uri, None).unwrap_err().contains("leaves the package"), "{uri}");
        }
    }
}
