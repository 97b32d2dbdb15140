//! Kinds and names of elements, and the attributes by which elements refer to each other.

use std::collections::HashMap;

use super::attributes::{self, Meaning, Named};
use super::tree::{Index, Tree};
use crate::kind::Kind;

/// Returns the kind of an element by its place, or `None` if it has no name in the compiled model.
pub(super) fn kind(tree: &Tree, index: Index) -> Option<Kind> {
    match named(tree, index)? {
        Named::Kind(kind) => Some(kind),
        _ => None,
    }
}

/// Returns the class of names to which the name of an element belongs.
pub(super) fn named(tree: &Tree, index: Index) -> Option<Named> {
    let tag = tree.tag(index);
    let kind = match (tree.tag(tree.parent(index)?), tag) {
        ("mujoco", "worldbody") | ("worldbody" | "body" | "frame" | "replicate", "body") => Kind::Body,
        ("worldbody" | "body" | "frame" | "replicate", _) => match tag {
            "joint" | "freejoint" => Kind::Joint,
            "geom" => Kind::Geom,
            "site" => Kind::Site,
            "camera" => Kind::Camera,
            "light" => Kind::Light,
            "frame" => return Some(Named::Frame),
            "flexcomp" => return Some(Named::Flex),
            _ => return None,
        },
        ("asset" | "deformable", _) => match tag {
            "mesh" => Kind::Mesh,
            "skin" => Kind::Skin,
            "hfield" => Kind::HeightField,
            "texture" => Kind::Texture,
            "material" => Kind::Material,
            "model" => return Some(Named::Model),
            "flex" => return Some(Named::Flex),
            _ => return None,
        },
        ("contact", "pair") => Kind::Pair,
        ("contact", "exclude") => Kind::Exclude,
        ("equality", _) => Kind::Equality,
        ("tendon", "spatial" | "fixed") => Kind::Tendon,
        ("actuator", _) => Kind::Actuator,
        ("sensor", _) => Kind::Sensor,
        ("custom", "numeric") => Kind::Numeric,
        ("custom", "text") => Kind::Text,
        ("custom", "tuple") => Kind::Tuple,
        ("keyframe", "key") => Kind::Keyframe,
        ("mujoco" | "default", "default") => return Some(Named::Class),
        ("plugin", "instance") => return Some(Named::Instance),
        _ => return None,
    };
    Some(Named::Kind(kind))
}

/// Returns the attribute with the name of an element.
pub(super) fn name_attribute(named: Named) -> &'static str {
    if named == Named::Class { "class" } else { "name" }
}

/// Returns the name of an element: that in the text, or the one that the compiler derives from a
/// file.
pub(super) fn name(tree: &Tree, index: Index) -> Option<&str> {
    let class = named(tree, index)?;
    let node = tree.node(index);
    let explicit = node.attribute(name_attribute(class)).filter(|name| !name.is_empty());
    explicit.or_else(|| match class {
        Named::Kind(Kind::Body) if node.tag == "worldbody" => Some(WORLD),
        Named::Class if tree.parent(index) == Some(Tree::ROOT) => Some(MAIN),
        Named::Kind(Kind::Mesh | Kind::HeightField | Kind::Texture | Kind::Skin) | Named::Model => {
            let file = node.attribute("file")?.rsplit(['/', '\\']).next()?;
            Some(file.rsplit_once('.').map_or(file, |(stem, _)| stem)).filter(|name| !name.is_empty())
        }
        _ => None,
    })
}

/// Name of the world.
pub(super) const WORLD: &str = "world";

/// Name of the outermost class of defaults.
pub(super) const MAIN: &str = "main";

/// Returns the element with a name.
pub(super) fn find(tree: &Tree, class: Named, wanted: &str) -> Option<Index> {
    if class == Named::Class {
        // For every attribute that may have a default.
        let found = || {
            let classes = all(tree, class).collect::<Vec<_>>().into_iter().rev();
            classes.filter_map(|index| Some((name(tree, index)?.to_owned(), index))).collect()
        };
        return tree.classes(found).get(wanted).copied();
    }
    all(tree, class).find(|&index| name(tree, index) == Some(wanted))
}

/// Returns all elements of a class of names, in the order of the text.
pub(super) fn all(tree: &Tree, class: Named) -> impl Iterator<Item = Index> {
    tree.descendants(Tree::ROOT).into_iter().filter(move |&index| named(tree, index) == Some(class))
}

/// Reference of an attribute to other elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Referring<'t> {
    pub(super) attribute: &'t str,
    /// Class of the names.
    pub(super) class: Named,
    /// The attribute has several names, separated by spaces. Elsewhere a space is a part of the
    /// name.
    is_list: bool,
    /// The pose of the body counts, not only its elements.
    pub(super) is_frame: bool,
}

impl Referring<'_> {
    /// Returns the names in a value of the attribute.
    fn names<'v>(&self, value: &'v str) -> Vec<&'v str> {
        if self.is_list { value.split_ascii_whitespace().collect() } else { vec![value] }
    }

    /// Returns `true` if the attribute of an element contains one of these names.
    pub(super) fn refers_to(&self, tree: &Tree, index: Index, names: &Names) -> bool {
        let is_one = |name: &&str| names.get(*name).is_some_and(|classes| classes.contains(&self.class));
        tree.attribute(index, self.attribute).is_some_and(|value| self.names(value).iter().any(is_one))
    }
}

/// Returns the attributes of an element that refer to other elements.
pub(super) fn references<'t>(tree: &'t Tree, index: Index) -> Vec<Referring<'t>> {
    let meanings = attributes::meanings(tree, index);
    let node = tree.node(index);
    let referring = |attribute: &'t str| {
        let (class, is_list, is_frame) = match meanings.get(attribute)? {
            Meaning::Reference(class) => (*class, false, false),
            Meaning::Frame => (Named::Kind(Kind::Body), false, true),
            Meaning::Frames => (Named::Kind(Kind::Body), true, true),
            // The attribute `objtype` or `reftype` has the class.
            Meaning::Object => {
                let kind = node.attribute(&attribute.replace("name", "type"))?;
                (class_of_type(kind)?, false, tree.parent(index).is_some_and(|parent| tree.tag(parent) == "sensor"))
            }
            _ => return None,
        };
        Some(Referring { attribute, class, is_list, is_frame })
    };
    node.attributes.iter().filter_map(|(name, _)| referring(name)).collect()
}

/// Returns `true` if an attribute of an element has a list of names.
pub(super) fn has_list(tree: &Tree, index: Index) -> bool {
    references(tree, index).iter().any(|found| found.is_list)
}

/// Returns the class of the names of a type in MJCF.
fn class_of_type(word: &str) -> Option<Named> {
    let kind = match word {
        "body" | "xbody" => Kind::Body,
        "hfield" => Kind::HeightField,
        "key" => Kind::Keyframe,
        "flex" => return Some(Named::Flex),
        "plugin" => return Some(Named::Instance),
        word => *Kind::ALL.iter().find(|kind| kind.to_string() == word)?,
    };
    Some(Named::Kind(kind))
}

/// Classes of names by the names.
pub(super) type Names = HashMap<String, Vec<Named>>;

/// Returns the elements that refer to one of these names.
pub(super) fn referrers(tree: &Tree, names: &Names) -> Vec<Index> {
    let refers = |index: &Index| references(tree, *index).iter().any(|found| found.refers_to(tree, *index, names));
    tree.descendants(Tree::ROOT).into_iter().filter(refers).collect()
}

/// Replaces the name in all references to an element.
pub(super) fn rename_references(tree: &mut Tree, class: Named, old: &str, new: &str) {
    map_references(tree, &mut |found, name| (found == class && name == old).then(|| new.to_owned()));
}

/// Replaces names in all references. `map` returns the new name, or `None` to keep the old one.
pub(super) fn map_references(tree: &mut Tree, map: &mut dyn FnMut(Named, &str) -> Option<String>) {
    for index in tree.descendants(Tree::ROOT) {
        let mut changes = Vec::new();
        for found in references(tree, index) {
            let value = tree.attribute(index, found.attribute).unwrap_or_default();
            let names: Vec<(&str, Option<String>)> =
                found.names(value).into_iter().map(|name| (name, map(found.class, name))).collect();
            if names.iter().any(|(_, new)| new.is_some()) {
                let names: Vec<String> =
                    names.into_iter().map(|(old, new)| new.unwrap_or_else(|| old.to_owned())).collect();
                changes.push((found.attribute.to_owned(), names.join(" ")));
            }
        }
        for (attribute, value) in changes {
            tree.node_mut(index).set(&attribute, value);
        }
    }
}

/// Describes an element for messages: its kind and its name, or its tag and its place.
pub(super) fn describe(tree: &Tree, index: Index) -> String {
    /// Number of elements around an element without a name.
    const MOST_LEVELS: usize = 4;
    let mut parts = Vec::new();
    let mut at = Some(index).filter(|&index| index != Tree::ROOT);
    while let Some(index) = at.filter(|_| parts.len() < MOST_LEVELS) {
        let tag = tree.tag(index);
        if let Some(name) = name(tree, index).filter(|_| tag != "default") {
            parts.push(if tag == "worldbody" { "the world".to_owned() } else { format!("{tag} '{name}'") });
            break;
        }
        at = tree.parent(index).filter(|&parent| parent != Tree::ROOT);
        let siblings = tree.parent(index).map_or(&[][..], |parent| tree.children(parent));
        let same: Vec<Index> = siblings.iter().copied().filter(|&child| tree.tag(child) == tag).collect();
        let number = same.iter().position(|&child| child == index).unwrap_or_default();
        parts.push(if same.len() > 1 { format!("{tag} {number}") } else { tag.to_owned() });
    }
    if parts.is_empty() { "the spec".to_owned() } else { parts.join(" of ") }
}

#[cfg(test)]
mod tests {
    use super::super::text::parse;
    use super::{Referring, references};

    #[test]
    fn colours_classes_and_names_of_models_are_no_references() {
        let text = "<mujoco model='m'><visual><rgba joint='1 0 0 1'/></visual>
            <default><default class='c'><geom material='d'/></default></default>
            <worldbody><attach model='a' body='b' prefix='p'/></worldbody></mujoco>";
        let tree = parse(text).unwrap();
        let all: Vec<&str> = (tree.descendants(0).into_iter())
            .flat_map(|index| references(&tree, index).into_iter().map(|Referring { attribute, .. }| attribute))
            .collect();
        assert_eq!(all, ["material", "model"]);
    }
}
