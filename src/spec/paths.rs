//! Files of assets.

use std::path::{Path, PathBuf};

use super::tree::{Index, Tree};

/// Attributes that name a file.
pub(super) const FILES: [&str; 7] = ["file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"];

/// Attributes of `compiler` that determine the directories of assets.
const SETTINGS: [&str; 4] = ["meshdir", "texturedir", "assetdir", "strippath"];

/// Returns `true` if an element can name the file of an asset.
pub(super) fn is_asset(tree: &Tree, index: Index) -> bool {
    matches!(tree.tag(index), "mesh" | "skin" | "hfield" | "texture" | "flexcomp" | "model")
}

/// Returns the directory in which the compiler looks for the files of an asset, relative to the
/// directory of the model.
pub(super) fn directory_of(tree: &Tree, index: Index) -> Option<&str> {
    let specific = match tree.tag(index) {
        "model" => return None,
        "texture" => "texturedir",
        _ => "meshdir",
    };
    // A later section overrides an earlier one, whichever of the two attributes it has.
    let of_section = |section: Index| tree.attribute(section, specific).or_else(|| tree.attribute(section, "assetdir"));
    tree.sections("compiler").rev().find_map(of_section)
}

/// Returns an attribute of `compiler`; a later section overrides an earlier one.
pub(super) fn setting<'t>(tree: &'t Tree, attribute: &str) -> Option<&'t str> {
    tree.sections("compiler").rev().find_map(|section| tree.attribute(section, attribute))
}

/// Replaces the names of all files by paths that do not depend on the settings of the compiler, and
/// removes these settings. The paths are relative to the directory of the model, or in `directory`
/// if the file exists there. Other files can be in memory.
pub(super) fn resolve(tree: &mut Tree, directory: Option<&Path>) {
    let strips = setting(tree, "strippath") == Some("true");
    for index in tree.descendants(Tree::ROOT) {
        if !is_asset(tree, index) {
            continue;
        }
        for attribute in FILES {
            let Some(name) = tree.attribute(index, attribute) else { continue };
            let name = if strips { name.rsplit(['/', '\\']).next().unwrap_or_default() } else { name };
            let relative = directory_of(tree, index).map(PathBuf::from).unwrap_or_default().join(name);
            let moved = directory.map(|directory| directory.join(&relative)).filter(|path| path.exists());
            let path = moved.unwrap_or(relative).to_string_lossy().into_owned();
            tree.node_mut(index).set(attribute, path);
        }
    }
    let sections: Vec<Index> = tree.sections("compiler").collect();
    for section in sections {
        for attribute in SETTINGS {
            tree.node_mut(section).unset(attribute);
        }
    }
}
