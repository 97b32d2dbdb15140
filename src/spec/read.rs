//! Reading of files: MJCF with the files that it includes, and URDF.

use std::borrow::Cow;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::paths::{FILES, directory_of, is_asset};
use super::text;
use super::tree::{Index, Tree};
use super::urdf::{self, UrdfWarning};
use crate::error::{Error, Result};
use crate::file;
use crate::model::LoadOptions;

/// Largest depth of includes, which the compiler has too.
const MOST_INCLUDED: usize = 50;

/// Files that a text may include.
pub(super) struct Sources<'a> {
    /// Directory of the main text, `None` for a text from memory.
    pub(super) directory: Option<&'a Path>,
    pub(super) options: &'a LoadOptions<'a>,
}

impl Sources<'_> {
    /// Parses a text and replaces its includes, or converts a URDF, in which there are none.
    pub(super) fn read(&self, source_name: &str, text: &str) -> Result<(Tree, Vec<UrdfWarning>)> {
        let mut tree = parsed(source_name, text)?;
        if urdf::is_urdf(&tree) {
            return urdf::convert(&tree, source_name, self.directory, self.options);
        }
        if tree.tag(Tree::ROOT) != "mujoco" {
            let message =
                format!("the text is a <{}>, not a <mujoco> (MJCF) or a <robot> (URDF)", tree.tag(Tree::ROOT));
            return Err(Error::Load { source_name: source_name.to_owned(), message });
        }
        let mut reader = Reader { sources: self, known: HashSet::new(), assets: Vec::new() };
        let whole = tree.descendants(Tree::ROOT);
        reader.include(source_name, &mut tree, &whole, Path::new(""), 0)?;
        // Older compilers look in the directory of the main text only.
        if cfg!(engine_since = "2.3.0") {
            for (index, folder) in reader.assets {
                self.place_asset(&mut tree, index, &folder);
            }
        }
        Ok((tree, Vec::new()))
    }

    /// Returns the content of a file, or `None` if there is none.
    fn content(&self, name: &Path) -> Option<Cow<'_, [u8]>> {
        if let Some(content) = self.options.file(&name.to_string_lossy()) {
            return Some(Cow::Borrowed(content));
        }
        file::read_regular(&self.path(name)).ok().map(Cow::Owned)
    }

    /// Prepends the directory of an included text to the file names of an asset that only exist
    /// there.
    fn place_asset(&self, tree: &mut Tree, index: Index, folder: &Path) {
        let directory = directory_of(tree, index).map(PathBuf::from).unwrap_or_default();
        for attribute in FILES {
            let Some(name) = tree.attribute(index, attribute).map(str::to_owned) else { continue };
            let moved = folder.join(&name);
            if !self.exists(&directory.join(&name)) && self.exists(&directory.join(&moved)) {
                tree.node_mut(index).set(attribute, moved.to_string_lossy().into_owned());
            }
        }
    }

    fn exists(&self, name: &Path) -> bool {
        self.options.file(&name.to_string_lossy()).is_some() || self.path(name).is_file()
    }

    fn path(&self, name: &Path) -> PathBuf {
        self.directory.map_or_else(|| name.to_owned(), |directory| directory.join(name))
    }
}

fn parsed(source_name: &str, text: &str) -> Result<Tree> {
    text::parse(text).map_err(|message| Error::Load { source_name: source_name.to_owned(), message })
}

struct Reader<'s> {
    sources: &'s Sources<'s>,
    /// Included files. As in the compiler, a file can be included once.
    known: HashSet<PathBuf>,
    /// Assets of included texts in another directory, and that directory.
    assets: Vec<(Index, PathBuf)>,
}

impl Reader<'_> {
    /// Replaces the includes among elements that come from a text in `folder`, which is relative to
    /// the directory of the main text.
    fn include(
        &mut self,
        source_name: &str,
        tree: &mut Tree,
        elements: &[Index],
        folder: &Path,
        depth: usize,
    ) -> Result<()> {
        let reject = |message: String| Err(Error::Load { source_name: source_name.to_owned(), message });
        for &index in elements {
            if tree.tag(index) != "include" {
                if is_asset(tree, index) && !folder.as_os_str().is_empty() {
                    self.assets.push((index, folder.to_owned()));
                }
                continue;
            }
            let Some(name) = tree.attribute(index, "file").map(str::to_owned) else {
                return reject("an <include> has no attribute 'file'".to_owned());
            };
            if depth == MOST_INCLUDED {
                return reject(format!("includes are nested more than {MOST_INCLUDED} deep"));
            }
            // The compiler looks in the directory of the main text first.
            let paths = [PathBuf::from(&name), folder.join(&name)];
            let Some((path, content)) =
                paths.into_iter().find_map(|path| self.sources.content(&path).map(|content| (path, content)))
            else {
                return reject(format!("the included file '{name}' cannot be read"));
            };
            if !self.known.insert(path.clone()) {
                return reject(format!("the file '{name}' is included twice, or includes itself"));
            }
            let Ok(text) = std::str::from_utf8(&content) else {
                return reject(format!("the included file '{name}' is not UTF-8"));
            };
            let copies = tree.replace(index, &parsed(&name, text)?);
            let elements: Vec<Index> = copies.into_iter().flat_map(|copy| tree.descendants(copy)).collect();
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            self.include(&name, tree, &elements, &folder, depth + 1)?;
        }
        Ok(())
    }
}
