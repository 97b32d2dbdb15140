//! Meaning of the attributes of MJCF: which ones are names, references, angles, limits, files.
//!
//! The table in `attributes.txt` has every attribute of every engine that this crate knows. An
//! attribute of a newer engine that is not in it has no meaning: it may be a reference or an angle,
//! so operations that change references or units reject it.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::schema;
use super::tree::{Index, Tree};
use crate::kind::Kind;

/// Elements with names that others refer to. In each class the names are unique.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Named {
    /// Kind of the compiled model.
    Kind(Kind),
    /// Class of defaults (`class`).
    Class,
    /// Frame, which the compiler removes. Nothing refers to it.
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

/// Meaning of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// Number, word or text that has the same meaning in every model.
    Plain,
    /// Name of the element.
    Name,
    /// Start of the names of the elements that the element creates.
    Prefix,
    /// Name of another element.
    Reference(Named),
    /// Name of a body whose pose counts, not only its elements.
    Frame,
    /// Names of such bodies, separated by spaces.
    Frames,
    /// Name of another element whose kind is in another attribute, such as `objtype` for `objname`.
    Object,
    /// Orientation in the unit of angles, for `euler` also in the order of rotations.
    Rotation,
    /// Joint position, which is an angle for some types of joints.
    Angle,
    /// Switch of a limit (`…limited`). Its range has the same name with `range` in place of
    /// `limited`.
    Limited,
    /// Name of a file.
    File,
    /// Setting of `compiler` on which attached specs must agree.
    Agreed,
    /// Setting of `compiler` to which attached specs are converted.
    Converted,
    /// Setting of `compiler` for the model as a whole; the setting of an attached spec is not used.
    Ours,
}

/// Attributes of an element.
pub(super) type Meanings = HashMap<&'static str, Meaning>;

/// Returns the meanings of the attributes of an element. An attribute without a meaning is one of a
/// newer engine.
pub(super) fn meanings(tree: &Tree, index: Index) -> &'static Meanings {
    static NONE: OnceLock<Meanings> = OnceLock::new();
    let path = schema::path(tree, index);
    let place = match (tree.tag(index), path.strip_prefix("mujoco/").unwrap_or(&path)) {
        (tag @ ("frame" | "replicate"), schema::BODY) => tag.to_owned(),
        (_, place) => place.replace(schema::BODY, "body"),
    };
    table().get(&place).unwrap_or_else(|| NONE.get_or_init(Meanings::new))
}

/// Returns the attributes of an element that have no meaning.
pub(super) fn unknown(tree: &Tree, index: Index) -> impl Iterator<Item = &str> {
    let known = meanings(tree, index);
    tree.node(index).attributes.iter().map(|(name, _)| &name[..]).filter(|name| !known.contains_key(name))
}

/// Returns the table: the meanings by the place of the element.
fn table() -> &'static HashMap<String, Meanings> {
    static TABLE: OnceLock<HashMap<String, Meanings>> = OnceLock::new();
    TABLE.get_or_init(|| parse(include_str!("attributes.txt")))
}

/// Parses the table. Places in brackets are followed by rows of attributes, each with their meaning
/// before a colon. Rows are continued by lines that start with a space.
fn parse(text: &'static str) -> HashMap<String, Meanings> {
    let mut table: HashMap<String, Meanings> = HashMap::new();
    let mut places: Vec<String> = Vec::new();
    let mut in_places = false;
    let mut row = Meaning::Plain;
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        if in_places || line.starts_with('[') {
            if line.starts_with('[') {
                places.clear();
            }
            for place in line.trim_start_matches(['[', ' ']).trim_end_matches(']').split(' ') {
                places.extend(default_of(place));
                places.push(place.to_owned());
            }
            in_places = !line.ends_with(']');
            for place in &places {
                table.entry(place.clone()).or_default();
            }
            continue;
        }
        let attributes = match line.split_once(':') {
            Some((word, attributes)) => {
                row = meaning(word);
                attributes
            }
            None => line,
        };
        for place in &places {
            let meanings = table.entry(place.clone()).or_default();
            meanings.extend(attributes.split_whitespace().map(|attribute| (attribute, row)));
        }
    }
    table
}

/// Returns the place in a class of the defaults of an element.
fn default_of(place: &str) -> Option<String> {
    let tag = match place.split_once('/')? {
        ("tendon", "spatial" | "fixed") => "tendon",
        ("equality", _) => "equality",
        ("body" | "asset" | "contact" | "actuator", tag) => tag,
        _ => return None,
    };
    Some(format!("default/{tag}"))
}

/// Returns the meaning of a word in the table. Other words than these are kinds of elements.
fn meaning(word: &str) -> Meaning {
    let kind = match word {
        "plain" => return Meaning::Plain,
        "name" => return Meaning::Name,
        "prefix" => return Meaning::Prefix,
        "object" => return Meaning::Object,
        "rotation" => return Meaning::Rotation,
        "angle" => return Meaning::Angle,
        "limited" => return Meaning::Limited,
        "file" => return Meaning::File,
        "agreed" => return Meaning::Agreed,
        "converted" => return Meaning::Converted,
        "ours" => return Meaning::Ours,
        "bodyframe" => return Meaning::Frame,
        "bodyframes" => return Meaning::Frames,
        "class" => Named::Class,
        "flex" => Named::Flex,
        "instance" => Named::Instance,
        "model" => Named::Model,
        "hfield" => Named::Kind(Kind::HeightField),
        word => {
            let kind = Kind::ALL.iter().find(|kind| kind.to_string() == word);
            Named::Kind(*kind.unwrap_or_else(|| unreachable!("Bug: '{word}' in attributes.txt has no meaning")))
        }
    };
    Meaning::Reference(kind)
}

#[cfg(test)]
mod tests {
    use super::super::paths::{FILES, is_asset};
    use super::super::schema::Schema;
    use super::super::text;
    use super::{Meaning, table, unknown};

    /// A new version of the engine adds attributes. Somebody has to decide for each of them whether
    /// it is a reference, an angle, a limit, a file, or depends on the pose of the element or on
    /// the settings of the compiler.
    #[test]
    fn every_attribute_of_the_engine_has_a_meaning() {
        let mut undecided = Vec::new();
        for (path, attribute) in Schema::of_engine().unwrap().all_attributes() {
            let place = path.strip_prefix("mujoco/").unwrap_or(path).replace("(world)body", "body");
            if !table().get(&place).is_some_and(|meanings| meanings.contains_key(attribute)) {
                undecided.push(format!("{place} {attribute}"));
            }
        }
        assert!(undecided.is_empty(), "without a meaning: {undecided:#?}");
    }

    #[test]
    fn an_invented_attribute_or_element_has_no_meaning() {
        let text = "<mujoco><worldbody><geom name='a' size='1' warp='2'/><blob heat='1'/></worldbody></mujoco>";
        let tree = text::parse(text).unwrap();
        let found: Vec<&str> = tree.descendants(0).into_iter().flat_map(|index| unknown(&tree, index)).collect();
        assert_eq!(found, ["warp", "heat"]);
    }

    /// `paths` handles the attributes of files by their names.
    #[test]
    fn all_files_are_those_of_assets() {
        for (place, meanings) in table() {
            let tag = place.rsplit('/').next().unwrap();
            let tree = text::parse(&format!("<{tag}/>")).unwrap();
            for (attribute, _) in meanings.iter().filter(|(_, meaning)| **meaning == Meaning::File) {
                assert!(FILES.contains(attribute) && is_asset(&tree, 0), "{place} {attribute}");
            }
        }
    }

    #[test]
    fn limits_have_ranges() {
        for (place, meanings) in table() {
            for (attribute, meaning) in meanings {
                let range = attribute.strip_suffix("limited").map(|start| format!("{start}range"));
                let is_limit = range.is_some_and(|range| meanings.contains_key(&range[..]));
                assert_eq!(is_limit, *meaning == Meaning::Limited, "{place} {attribute}");
            }
        }
    }
}
