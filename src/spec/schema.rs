//! The elements and attributes of MJCF that the engine's compiler accepts.

use super::tree::{Index, Tree};
pub(super) use crate::model::Schema;

/// Attributes of elements that are not in the schema of the engine, because its reader handles them
/// first.
const FRAME: [&str; 8] = ["name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"];
const REPLICATE: [&str; 4] = ["count", "offset", "euler", "sep"];

/// Tag of bodies and of the world in the schema.
pub(super) const BODY: &str = "(world)body";

impl Schema {
    /// Returns the attributes of an element, or `None` if the compiler does not accept the element
    /// at this place.
    pub(super) fn attributes(&self, tree: &Tree, index: Index) -> Option<Vec<&str>> {
        let path = path(tree, index);
        match tree.tag(index) {
            tag @ ("frame" | "replicate") if path.ends_with(BODY) => {
                let attributes = if tag == "frame" { &FRAME[..] } else { &REPLICATE };
                Some(attributes.to_vec())
            }
            _ => self.get(&path).map(|attributes| attributes.iter().map(String::as_str).collect()),
        }
    }

    /// Returns `true` if the compiler accepts an attribute of an element.
    pub(super) fn has(&self, tree: &Tree, index: Index, attribute: &str) -> bool {
        self.attributes(tree, index).is_some_and(|attributes| attributes.contains(&attribute))
    }

    /// Returns the elements that the compiler accepts in an element.
    pub(super) fn children(&self, tree: &Tree, index: Index) -> Vec<&str> {
        let path = path(tree, index);
        let mut found: Vec<&str> = self
            .elements()
            .filter_map(|(element, _)| element.strip_prefix(&path)?.strip_prefix('/'))
            .filter(|rest| !rest.contains('/'))
            .map(|tag| if tag == BODY { "worldbody" } else { tag })
            .collect();
        if path.ends_with(BODY) {
            found.extend(["body", "frame", "replicate"]);
        }
        if path.ends_with("/default") {
            found.push("default");
        }
        found.sort_unstable();
        found
    }

    /// Returns the path of each element with the name of each of its attributes.
    #[cfg(test)]
    pub(super) fn all_attributes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.elements().flat_map(|(path, names)| names.iter().map(move |name| (path, &name[..])))
    }
}

/// Returns the path of an element in the schema. Bodies, frames and classes in each other have the
/// path of the outermost.
pub(super) fn path(tree: &Tree, index: Index) -> String {
    let mut tags = Vec::new();
    let mut at = Some(index);
    while let Some(index) = at {
        let tag = match tree.tag(index) {
            "worldbody" | "body" | "frame" | "replicate" => BODY,
            tag => tag,
        };
        if !(matches!(tag, BODY | "default") && tags.last() == Some(&tag)) {
            tags.push(tag);
        }
        at = tree.parent(index);
    }
    tags.reverse();
    tags.join("/")
}
