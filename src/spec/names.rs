//! Kinds and names of elements, and the attributes by which elements refer to each other.

use super::tree::{Index, Tree};
use crate::kind::Kind;

/// Elements with names that others refer to. In each class the names are unique.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Named {
    /// Kind of the compiled model.
    Kind(Kind),
    /// Class of defaults (`class`).
    Class,
    /// Frame, which the compiler removes.
    Frame,
    /// Model that is an asset (`<model>`).
    Model,
    /// Flexible object.
    Flex,
    /// Instance of a plugin.
    Instance,
}

impl std::fmt::Display for Named {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Kind(kind) => kind.fmt(f),
            Self::Class => f.write_str("class"),
            Self::Frame => f.write_str("frame"),
            Self::Model => f.write_str("model"),
            Self::Flex => f.write_str("flex"),
            Self::Instance => f.write_str("plugin instance"),
        }
    }
}

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

/// Returns the name of an element: that in the text, or the one that the compiler derives from a file.
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
    all(tree, class).find(|&index| name(tree, index) == Some(wanted))
}

/// Returns all elements of a class of names, in the order of the text.
pub(super) fn all(tree: &Tree, class: Named) -> impl Iterator<Item = Index> {
    // Classes are looked up for every attribute that may have a default.
    let places = match class {
        Named::Class => tree.sections("default").flat_map(|section| tree.descendants(section)).collect(),
        _ => tree.descendants(Tree::ROOT),
    };
    places.into_iter().filter(move |&index| named(tree, index) == Some(class))
}

/// Attributes that contain the name of an element, and the class of the name. The attributes of these names in the section `visual` are
/// colours and sizes.
const REFERENCES: [(&str, Named); 38] = {
    use Kind::{Actuator, Body, Camera, Geom, HeightField, Joint, Material, Mesh, Site, Tendon, Texture};
    [
        ("joint", Named::Kind(Joint)),
        ("joint1", Named::Kind(Joint)),
        ("joint2", Named::Kind(Joint)),
        ("jointinparent", Named::Kind(Joint)),
        ("body", Named::Kind(Body)),
        ("body1", Named::Kind(Body)),
        ("body2", Named::Kind(Body)),
        ("node", Named::Kind(Body)),
        ("target", Named::Kind(Body)),
        ("subtree1", Named::Kind(Body)),
        ("subtree2", Named::Kind(Body)),
        ("geom", Named::Kind(Geom)),
        ("geom1", Named::Kind(Geom)),
        ("geom2", Named::Kind(Geom)),
        ("site", Named::Kind(Site)),
        ("site1", Named::Kind(Site)),
        ("site2", Named::Kind(Site)),
        ("sidesite", Named::Kind(Site)),
        ("slidersite", Named::Kind(Site)),
        ("cranksite", Named::Kind(Site)),
        ("refsite", Named::Kind(Site)),
        ("tendon", Named::Kind(Tendon)),
        ("tendon1", Named::Kind(Tendon)),
        ("tendon2", Named::Kind(Tendon)),
        ("actuator", Named::Kind(Actuator)),
        ("camera", Named::Kind(Camera)),
        ("mesh", Named::Kind(Mesh)),
        ("hfield", Named::Kind(HeightField)),
        ("material", Named::Kind(Material)),
        ("texture", Named::Kind(Texture)),
        ("class", Named::Class),
        ("childclass", Named::Class),
        ("flex", Named::Flex),
        ("instance", Named::Instance),
        ("model", Named::Model),
        ("frame", Named::Frame),
        // The attribute `objtype` or `reftype` has the class.
        ("objname", Named::Kind(Body)),
        ("refname", Named::Kind(Body)),
    ]
};

/// Returns the attributes of an element that refer to other elements, with the class of the names in them. An attribute can contain several
/// names, separated by spaces.
pub(super) fn references(tree: &Tree, index: Index) -> Vec<(&str, Named)> {
    let node = tree.node(index);
    let parent = tree.parent(index).map(|parent| tree.tag(parent));
    // The names in `attach` are those of another model, except that of the asset. The root has the name of the model.
    if index == Tree::ROOT || parent == Some("visual") || node.tag == "default" && parent != Some("default") {
        return Vec::new();
    }
    let refers = |&(attribute, _): &(&str, Named)| match (&node.tag[..], attribute) {
        ("attach", attribute) => attribute == "model",
        ("default", attribute) => attribute != "class",
        _ => true,
    };
    let present =
        REFERENCES.iter().filter(|(attribute, _)| node.attribute(attribute).is_some()).filter(|row| refers(row));
    present
        .filter_map(|&(attribute, class)| match attribute {
            "objname" => Some((attribute, class_of_type(node.attribute("objtype")?)?)),
            "refname" => Some((attribute, class_of_type(node.attribute("reftype")?)?)),
            _ => Some((attribute, class)),
        })
        .collect()
}

/// Returns the class of the names of a type in MJCF.
fn class_of_type(word: &str) -> Option<Named> {
    let kind = match word {
        "body" | "xbody" => Kind::Body,
        "hfield" => Kind::HeightField,
        "key" => Kind::Keyframe,
        "flex" => return Some(Named::Flex),
        word => *Kind::ALL.iter().find(|kind| kind.to_string() == word)?,
    };
    Some(Named::Kind(kind))
}

/// Returns `true` if an attribute contains a name. A name may contain spaces, but not in an attribute with a list of names.
fn refers_to(value: &str, name: &str) -> bool {
    value == name || value.split_ascii_whitespace().any(|word| word == name)
}

/// Returns the elements that refer to an element.
pub(super) fn referrers(tree: &Tree, class: Named, name: &str) -> Vec<Index> {
    let refers = |index: &Index| {
        let mut attributes = references(tree, *index).into_iter().filter(|&(_, found)| found == class);
        attributes.any(|(attribute, _)| tree.attribute(*index, attribute).is_some_and(|value| refers_to(value, name)))
    };
    tree.descendants(Tree::ROOT).into_iter().filter(refers).collect()
}

/// Replaces the name in all references to an element.
pub(super) fn rename_references(tree: &mut Tree, class: Named, old: &str, new: &str) {
    map_references(tree, &mut |found, name| (found == class && name == old).then(|| new.to_owned()));
}

/// Replaces names in all references. `map` returns the new name, or `None` to keep the old one.
pub(super) fn map_references(tree: &mut Tree, map: &mut dyn FnMut(Named, &str) -> Option<String>) {
    for index in tree.descendants(Tree::ROOT) {
        let attributes: Vec<(String, Named)> =
            references(tree, index).into_iter().map(|(attribute, class)| (attribute.to_owned(), class)).collect();
        for (attribute, class) in attributes {
            let value = tree.attribute(index, &attribute).unwrap_or_default().to_owned();
            let is_list = matches!((tree.tag(index), &attribute[..]), ("flex", "body" | "node"));
            let mapped = if is_list {
                let words =
                    value.split_ascii_whitespace().map(|word| map(class, word).unwrap_or_else(|| word.to_owned()));
                Some(words.collect::<Vec<_>>().join(" "))
            } else {
                map(class, &value)
            };
            if let Some(mapped) = mapped.filter(|mapped| *mapped != value) {
                tree.node_mut(index).set(&attribute, mapped);
            }
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
    use super::super::schema::Schema;
    use super::{REFERENCES, references};

    /// A new version of the engine adds attributes, which may be references.
    #[test]
    fn every_attribute_of_the_engine_is_known_to_be_a_reference_or_not() {
        let listed: Vec<&str> = include_str!("plain_attributes.txt").split_whitespace().collect();
        for attribute in Schema::of_engine().unwrap().all_attributes() {
            let is_reference = REFERENCES.iter().any(|(name, _)| *name == attribute);
            assert!(is_reference != listed.contains(&attribute), "{attribute}: reference {is_reference}");
        }
    }

    #[test]
    fn colours_and_classes_are_no_references() {
        let text = "<mujoco model='m'><visual><rgba joint='1 0 0 1'/></visual><default><default class='c'><geom class='d'/></default></default></mujoco>";
        let tree = super::super::text::parse(text).unwrap();
        let all: Vec<String> = tree
            .descendants(0)
            .into_iter()
            .flat_map(|index| references(&tree, index).into_iter().map(|(name, _)| name.to_owned()).collect::<Vec<_>>())
            .collect();
        assert_eq!(all, ["class"]);
    }
}
