//! Complete elements, and the places for them in a document.

use std::sync::OnceLock;

use super::document::Node;

/// An element with what it needs elsewhere.
#[derive(Clone, Debug)]
pub struct Specimen {
    /// Path of [`Self::node`].
    path: String,
    /// Name of the body for a child of a body.
    body: String,
    node: Node,
    /// Elements of sections.
    others: Vec<(String, Node)>,
}

fn all() -> &'static [Specimen] {
    static ALL: OnceLock<Vec<Specimen>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut all = Vec::new();
        for group in Node::parse(include_str!("specimens.xml")).children {
            let (with, nodes): (Vec<_>, Vec<_>) =
                group.children.iter().cloned().partition(|child| child.name == "with");
            let others: Vec<_> = with
                .into_iter()
                .flat_map(|with| {
                    let section = with.get("section").expect("a section").to_owned();
                    with.children.into_iter().map(move |child| (section.clone(), child))
                })
                .collect();
            let path = group.get("path").expect("a path");
            // The entry of a child describes its parent.
            let root = nodes[0].name.clone();
            let path = &path[..path.find(&format!("/{root}/")).map_or(path.len(), |at| at + 1 + root.len())];
            all.extend(nodes.into_iter().map(|node| Specimen {
                path: path.to_owned(),
                body: group.get("at").unwrap_or("host").to_owned(),
                node,
                others: others.clone(),
            }));
        }
        all
    })
}

/// Attributes whose values are names of other elements, by which elements without an entry are
/// tried.
const REFERENCES: [&[(&str, &str)]; 12] = [
    &[],
    &[("site", "tip")],
    &[("site", "spot")],
    &[("joint", "slide")],
    &[("joint", "ball")],
    &[("tendon", "cable")],
    &[("tendon", "coupling")],
    &[("body", "host")],
    &[("actuator", "motor")],
    &[("objtype", "site"), ("objname", "tip")],
    &[("site", "tip"), ("refsite", "spot")],
    &[("objtype", "site"), ("objname", "tip"), ("reftype", "body"), ("refname", "crate")],
];
const MORE_REFERENCES: [&[(&str, &str)]; 4] = [
    &[("joint", "slide"), ("ctrlrange", "-0.2 0.2"), ("forcerange", "-0.1 0.1")],
    &[("jointinparent", "ball")],
    &[("cranksite", "elbow"), ("slidersite", "spot"), ("cranklength", "1.2")],
    &[("geom1", "lower"), ("geom2", "box")],
];

/// Returns the specimens that contain an element of this path, or guesses.
pub fn of(path: &str) -> Vec<Specimen> {
    let contains = |specimen: &&Specimen| {
        specimen.path == path || path.strip_prefix(&specimen.path).is_some_and(|rest| rest.starts_with('/'))
    };
    let matching: Vec<&Specimen> = all().iter().filter(contains).collect();
    if !matching.is_empty() {
        return matching.into_iter().cloned().collect();
    }
    let name = path.rsplit('/').next().expect("a name");
    let is_object = path.starts_with("sensor/")
        || path.starts_with("actuator/")
        || path.starts_with("equality/")
        || path.starts_with("contact/");
    let references = REFERENCES.iter().chain(&MORE_REFERENCES).take(if is_object { usize::MAX } else { 1 });
    references
        .map(|attributes| {
            let mut node = Node::new(name);
            attributes.iter().for_each(|(name, value)| node.set(name, value));
            if is_object {
                node.set("name", "extra");
            }
            Specimen { path: path.to_owned(), body: "host".to_owned(), node, others: Vec::new() }
        })
        .collect()
}

impl Specimen {
    /// Inserts the specimen into a document.
    pub fn insert(&self, document: &mut Node) {
        for (section, node) in &self.others {
            document.descend([&section[..]]).children.push(node.clone());
        }
        self.parent(document).children.push(self.node.clone());
    }

    fn parent<'d>(&self, document: &'d mut Node) -> &'d mut Node {
        let Some((parent, _)) = self.path.rsplit_once('/') else {
            return match &self.path[..] {
                "body" if self.body == "world" => document.descend(["worldbody"]),
                "body" => body(document, &self.body),
                _ => document,
            };
        };
        match parent {
            "body" if self.body == "world" => document.descend(["worldbody"]),
            "body" => body(document, &self.body),
            parent => document.descend(parent.split('/')),
        }
    }

    /// Returns the inserted node.
    pub fn root<'d>(&self, document: &'d mut Node) -> &'d mut Node {
        self.parent(document).children.last_mut().expect("the specimen was inserted")
    }

    /// Returns the inserted node of a path, created if the specimen lacks it.
    pub fn find<'d>(&self, document: &'d mut Node, path: &str) -> &'d mut Node {
        let rest = path.strip_prefix(&self.path).expect("the specimen contains the element");
        self.root(document).descend(rest.split('/').filter(|name| !name.is_empty()))
    }
}

fn body<'d>(document: &'d mut Node, name: &str) -> &'d mut Node {
    document.find_mut(&|node| node.name == "body" && node.get("name") == Some(name)).expect("the rig has this body")
}
