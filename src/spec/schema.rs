//! The elements and attributes of MJCF that the engine's compiler accepts.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::tree::{Index, Tree};
use crate::error::Result;
use crate::model;

/// Attributes of each element, by the path of the element from the root.
pub(super) struct Schema(HashMap<String, Vec<String>>);

/// Attributes of elements that are not in the schema of the engine, because its reader handles them
/// first.
const FRAME: [&str; 8] = ["name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"];
const REPLICATE: [&str; 4] = ["count", "offset", "euler", "sep"];

/// Tag of bodies and of the world in the schema.
pub(super) const BODY: &str = "(world)body";

impl Schema {
    /// Returns the schema of the engine.
    pub(super) fn of_engine() -> Result<&'static Self> {
        static SCHEMA: OnceLock<Schema> = OnceLock::new();
        if let Some(schema) = SCHEMA.get() {
            return Ok(schema);
        }
        let text = model::schema()?;
        Ok(SCHEMA.get_or_init(|| Self::parse(&text)))
    }

    /// Parses the engine's text: each element is indented by three spaces per level and followed by
    /// its attributes, in this line and in the next ones.
    fn parse(text: &str) -> Self {
        const INDENT: usize = 3;
        let mut elements: HashMap<String, Vec<String>> = HashMap::new();
        let mut path: Vec<&str> = Vec::new();
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let is_element = words.get(1).is_some_and(|word| word.starts_with('(') && word.ends_with(')'));
            let attributes = if is_element {
                path.truncate((line.len() - line.trim_start().len()) / INDENT);
                path.push(words[0]);
                &words[2..]
            } else {
                &words
            };
            elements.entry(path.join("/")).or_default().extend(attributes.iter().map(|&word| word.to_owned()));
        }
        Self(elements)
    }

    /// Returns the attributes of an element, or `None` if the compiler does not accept the element
    /// at this place.
    pub(super) fn attributes(&self, tree: &Tree, index: Index) -> Option<Vec<&str>> {
        let path = path(tree, index);
        match tree.tag(index) {
            tag @ ("frame" | "replicate") if path.ends_with(BODY) => {
                let attributes = if tag == "frame" { &FRAME[..] } else { &REPLICATE };
                Some(attributes.to_vec())
            }
            _ => self.0.get(&path).map(|attributes| attributes.iter().map(String::as_str).collect()),
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
            .0
            .keys()
            .filter_map(|key| key.strip_prefix(&path)?.strip_prefix('/'))
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
        self.0.iter().flat_map(|(path, names)| names.iter().map(|name| (&path[..], &name[..])))
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
