//! The schema that the linked engine prints, as a list of elements.

use std::fmt;

/// An element of MJCF. Its path omits the root, and the body of the world and nested bodies are
/// `body`: `body/joint`, `actuator/plugin/config`.
#[derive(Clone, Debug)]
pub struct Element {
    pub path: String,
    /// `!` once, `?` at most once, `*` any number of times, `R` recursively.
    pub multiplicity: char,
    pub attributes: Vec<String>,
}

/// An attribute of an element.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Attribute {
    pub element: String,
    pub name: String,
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.element, self.name)
    }
}

/// Width of the column of element names, and of one level of indentation.
const COLUMN: usize = 30;
const INDENTATION: usize = 3;

/// Returns the elements of the linked engine without the root.
pub fn elements() -> Vec<Element> {
    parsed(&mujoco_safe::model::schema().expect("the engine prints its schema"))
}

fn parsed(text: &str) -> Vec<Element> {
    let mut elements: Vec<Element> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let is_continued = line.len() >= COLUMN && line[..COLUMN].trim().is_empty();
        if !is_continued {
            let depth = (line.len() - line.trim_start().len()) / INDENTATION;
            let (name, rest) = line.trim_start().split_once(' ').expect("a name and a multiplicity");
            let multiplicity = rest.trim_start().chars().nth(1).expect("a multiplicity in parentheses");
            names.truncate(depth);
            names.push(name.trim_start_matches("(world)").to_owned());
            let path = names[1..].join("/");
            elements.push(Element { path, multiplicity, attributes: Vec::new() });
        }
        let column = if is_continued {
            line
        } else {
            line.split_once(')').map_or("", |(head, rest)| {
                // The name of the body of the world contains parentheses.
                if head.trim() == "(world" { rest.split_once(')').map_or("", |(_, rest)| rest) } else { rest }
            })
        };
        let attributes = column.split_whitespace().map(str::to_owned);
        elements.last_mut().expect("the first line has a name").attributes.extend(attributes);
    }
    elements.retain(|element| !element.path.is_empty());
    elements
}

/// Returns all attributes of all elements of the linked engine.
pub fn attributes() -> Vec<Attribute> {
    let attributes = elements().into_iter().flat_map(|element| {
        let path = element.path;
        element.attributes.into_iter().map(move |name| Attribute { element: path.clone(), name })
    });
    attributes.collect()
}
