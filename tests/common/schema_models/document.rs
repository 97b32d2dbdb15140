//! A document of XML that can be edited.

use std::fmt::Write as _;

/// An element with its attributes and children. Text between elements is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Node>,
}

impl Node {
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), attributes: Vec::new(), children: Vec::new() }
    }

    /// Reads a text, which must be well-formed.
    pub fn parse(text: &str) -> Self {
        let document = roxmltree::Document::parse(text).unwrap_or_else(|error| panic!("{error}: {text}"));
        Self::from_xml(document.root_element())
    }

    fn from_xml(node: roxmltree::Node<'_, '_>) -> Self {
        let attributes = node.attributes().map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned()));
        Self {
            name: node.tag_name().name().to_owned(),
            attributes: attributes.collect(),
            children: node.children().filter(|child| child.is_element()).map(Self::from_xml).collect(),
        }
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(other, _)| other == name).map(|(_, value)| &value[..])
    }

    pub fn set(&mut self, name: &str, value: &str) {
        match self.attributes.iter_mut().find(|(other, _)| other == name) {
            Some((_, old)) => value.clone_into(old),
            None => self.attributes.push((name.to_owned(), value.to_owned())),
        }
    }

    pub fn remove(&mut self, name: &str) {
        self.attributes.retain(|(other, _)| other != name);
    }

    /// Returns the node at a path of names, the first of each, and creates what is missing.
    pub fn descend<'n>(&mut self, names: impl IntoIterator<Item = &'n str>) -> &mut Self {
        let mut node = self;
        for name in names {
            let index = node.children.iter().position(|child| child.name == name).unwrap_or_else(|| {
                node.children.push(Self::new(name));
                node.children.len() - 1
            });
            node = &mut node.children[index];
        }
        node
    }

    /// Returns the first node that satisfies a condition, in the order of the text.
    pub fn find_mut(&mut self, condition: &impl Fn(&Self) -> bool) -> Option<&mut Self> {
        if condition(self) {
            return Some(self);
        }
        self.children.iter_mut().find_map(|child| child.find_mut(condition))
    }

    /// Calls a function with each node.
    pub fn visit<'n>(&'n self, function: &mut impl FnMut(&'n Self)) {
        function(self);
        self.children.iter().for_each(|child| child.visit(function));
    }

    /// Calls a function with each node, which it may change.
    pub fn visit_mut(&mut self, function: &mut impl FnMut(&mut Self)) {
        function(self);
        self.children.iter_mut().for_each(|child| child.visit_mut(function));
    }

    pub fn text(&self) -> String {
        let mut text = String::new();
        self.write(&mut text, 0);
        text
    }

    fn write(&self, text: &mut String, depth: usize) {
        let _ = write!(text, "{:1$}<{2}", "", 2 * depth, self.name);
        for (name, value) in &self.attributes {
            let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
            let _ = write!(text, " {name}=\"{value}\"");
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
        } else {
            text.push_str(">\n");
            self.children.iter().for_each(|child| child.write(text, depth + 1));
            let _ = writeln!(text, "{:1$}</{2}>", "", 2 * depth, self.name);
        }
    }
}
