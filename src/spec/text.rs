//! Reading and writing of MJCF as text.

use super::tree::{Index, Tree};

/// Largest depth of elements, which the compiler has too.
const MOST_NESTED: usize = 400;

/// Parses a text. Returns the position and the reason if it is not XML.
pub(super) fn parse(text: &str) -> Result<Tree, String> {
    let document = roxmltree::Document::parse(text).map_err(|error| error.to_string())?;
    let root = document.root_element();
    let mut tree = Tree::new(root.tag_name().name());
    // Pairs of an element of the document and its copy in the tree.
    let mut open = vec![(root, Tree::ROOT, 1)];
    while let Some((element, index, depth)) = open.pop() {
        if depth > MOST_NESTED {
            return Err(format!("elements are nested more than {MOST_NESTED} deep"));
        }
        for attribute in element.attributes() {
            tree.node_mut(index).attributes.push((attribute.name().to_owned(), attribute.value().to_owned()));
        }
        for child in element.children().filter(roxmltree::Node::is_element) {
            open.push((child, tree.add(index, child.tag_name().name()), depth + 1));
        }
    }
    Ok(tree)
}

/// Text of a tree, with at most one start tag in each line.
pub(super) struct Written {
    pub(super) text: String,
    /// The element of each line. A line with an end tag belongs to the same element as the start tag.
    pub(super) lines: Vec<Index>,
}

/// Writes a tree. Does not recurse, because a program can nest elements in any depth.
pub(super) fn write(tree: &Tree) -> Written {
    /// Start or end of an element.
    enum Tag {
        Start(Index),
        End(Index),
    }
    let mut written = Written { text: String::new(), lines: Vec::new() };
    let mut depth = 0;
    let mut open = vec![Tag::Start(Tree::ROOT)];
    while let Some(tag) = open.pop() {
        match tag {
            Tag::Start(index) => {
                let children = tree.children(index);
                written.start(tree, index, depth);
                if !children.is_empty() {
                    open.push(Tag::End(index));
                    open.extend(children.iter().rev().map(|&child| Tag::Start(child)));
                    depth += 1;
                }
            }
            Tag::End(index) => {
                depth -= 1;
                written.line(index, depth, &format!("</{}>", tree.tag(index)));
            }
        }
    }
    written
}

impl Written {
    fn start(&mut self, tree: &Tree, index: Index, depth: usize) {
        let node = tree.node(index);
        let mut tag = format!("<{}", node.tag);
        for (name, value) in &node.attributes {
            tag.push(' ');
            tag += name;
            tag += "=\"";
            escape(value, &mut tag);
            tag.push('"');
        }
        tag += if node.children.is_empty() { "/>" } else { ">" };
        self.line(index, depth, &tag);
    }

    fn line(&mut self, index: Index, depth: usize, tag: &str) {
        const INDENT: &str = "  ";
        self.text += &INDENT.repeat(depth.min(MOST_NESTED));
        self.text += tag;
        self.text.push('\n');
        self.lines.push(index);
    }
}

/// Appends an attribute value. A line break would shift the numbers of the lines.
fn escape(value: &str, text: &mut String) {
    for character in value.chars() {
        match character {
            '&' => *text += "&amp;",
            '<' => *text += "&lt;",
            '>' => *text += "&gt;",
            '"' => *text += "&quot;",
            '\n' => *text += "&#10;",
            '\r' => *text += "&#13;",
            _ => text.push(character),
        }
    }
}
