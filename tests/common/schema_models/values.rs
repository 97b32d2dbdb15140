//! Values of attributes: a table, and guesses for attributes that it lacks.

use std::collections::HashSet;
use std::sync::OnceLock;

use super::document::Node;
use super::schema::Attribute;

struct Row {
    /// End of the path of the element, or `*`.
    element: &'static str,
    /// Name, in which one `*` stands for any letters.
    attribute: &'static str,
    values: Vec<&'static str>,
}

impl Row {
    fn matches(&self, attribute: &Attribute) -> bool {
        let Attribute { element, name } = attribute;
        let is_element = self.element == "*"
            || element.strip_suffix(self.element).is_some_and(|head| head.is_empty() || head.ends_with('/'));
        is_element
            && match self.attribute.split_once('*') {
                Some((head, tail)) => {
                    name.len() >= head.len() + tail.len() && name.starts_with(head) && name.ends_with(tail)
                }
                None => name == self.attribute,
            }
    }
}

fn table() -> &'static [Row] {
    static TABLE: OnceLock<Vec<Row>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let lines = include_str!("values.txt").lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let row = |line: &'static str| {
            let (subject, values) = line.split_once(": ").expect("a row with values");
            let (element, attribute) = subject.split_once(' ').expect("an element and an attribute");
            Row { element, attribute, values: values.split(" | ").collect() }
        };
        lines.map(row).collect()
    })
}

/// Values to try for an attribute that is in no row: flags, numbers, vectors of several sizes.
const GUESSES: [&str; 13] = [
    "true",
    "false",
    "0.3",
    "1",
    "2",
    "0",
    "0.1 0.2",
    "0.1 0.2 0.3",
    "0.1 0.2 0.3 0.4",
    "0.1 0.2 0.3 0.4 0.5",
    "0.1 0.2 0.3 0.4 0.5 0.6",
    "1 1 1",
    "1 2",
];

/// Returns `true` if the table has values for the attribute.
pub fn is_known(attribute: &Attribute) -> bool {
    table().iter().any(|row| row.matches(attribute))
}

/// Returns sensible values to try, with names of a document. Values of the table come first.
pub fn candidates(attribute: &Attribute, document: &Node) -> Vec<String> {
    match table().iter().find(|row| row.matches(attribute)) {
        Some(row) => row.values.iter().flat_map(|value| named(value, document)).collect(),
        None => guesses(),
    }
}

/// Returns values to try for an attribute about which nothing is known: flags and numbers.
pub fn guesses() -> Vec<String> {
    GUESSES.map(str::to_owned).to_vec()
}

/// Returns all words of the table, and the names in a document. They are tried if a message about a
/// guess says that the attribute needs a keyword or a name.
pub fn words(document: &Node) -> Vec<String> {
    let is_word = |value: &&&str| value.starts_with(|first: char| first.is_ascii_alphabetic());
    let words = table().iter().flat_map(|row| &row.values).filter(is_word);
    let mut all: Vec<String> = words.map(|&value| value.to_owned()).collect();
    document.visit(&mut |node| all.extend(node.get("name").map(str::to_owned)));
    let mut seen = HashSet::new();
    all.retain(|value| seen.insert(value.clone()));
    all
}

/// Returns `true` if the message says that an attribute needs a keyword or a name. No word helps
/// without the plugin.
pub fn needs_word(message: &str) -> bool {
    !message.contains("plugin mujoco.")
        && ["keyword", "unrecognized", "unknown", "not found", "could not find"]
            .iter()
            .any(|part| message.contains(part))
}

/// Returns a value, or the names of all elements of the kind that it stands for.
fn named(value: &str, document: &Node) -> Vec<String> {
    let Some(kind) = value.strip_prefix('@') else { return vec![value.to_owned()] };
    let sections: &[&str] = match kind {
        "tendon" => &["spatial", "fixed"],
        "joint" => &["joint", "freejoint"],
        "actuator" => &["motor"],
        "flex" => &["flexcomp", "flex"],
        kind => &[kind],
    };
    let mut names = Vec::new();
    document.visit(&mut |node| {
        if sections.contains(&&node.name[..]) {
            names.extend(node.get("name").map(str::to_owned));
        }
    });
    names
}
