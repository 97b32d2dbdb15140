//! Reading and writing of MJCF as text.

use super::tree::{Index, Tree};
use super::{control, lenient, value};

/// Largest depth of elements, which the compiler has too.
const MOST_NESTED: usize = 400;

/// Parses a text. Returns the position and the reason if it is not XML. Like the engine's reader,
/// it accepts references to control characters and the other forms of [`lenient`], and does not
/// know namespaces: the prefix of a name is a part of it.
pub(super) fn parse(text: &str) -> Result<Tree, String> {
    // A file that a C program has written can end with NUL.
    let text = text.trim_end_matches('\0');
    let hidden = control::hide(text)?;
    let text = hidden.as_deref().unwrap_or(text);
    let corrected;
    let mut is_corrected = false;
    let (document, text) = match roxmltree::Document::parse(text) {
        Ok(document) => (document, text),
        Err(error) => {
            corrected = lenient::to_xml(text);
            is_corrected = true;
            (roxmltree::Document::parse(&corrected).map_err(|_| error.to_string())?, &corrected[..])
        }
    };
    let name = |name: &str| if is_corrected { name.replace(lenient::COLON, ":") } else { name.to_owned() };
    let tag = |element: roxmltree::Node<'_, '_>| name(tag(&text[element.range()]));
    let root = document.root_element();
    let mut tree = Tree::new(&tag(root));
    // Pairs of an element of the document and its copy in the tree.
    let mut open = vec![(root, Tree::ROOT, 1)];
    while let Some((element, index, depth)) = open.pop() {
        if depth > MOST_NESTED {
            return Err(format!("elements are nested more than {MOST_NESTED} deep"));
        }
        for attribute in element.attributes() {
            let name = name(&text[attribute.range_qname()]);
            if name.starts_with("xmlns:") {
                continue;
            }
            let mut value = exact(attribute.value(), &text[attribute.range_value()]);
            if hidden.is_some() {
                value = control::show(&value);
            }
            tree.node_mut(index).attributes.push((name, value));
        }
        for child in element.children().filter(roxmltree::Node::is_element) {
            open.push((child, tree.add(index, &tag(child)), depth + 1));
        }
    }
    Ok(tree)
}

/// Returns the name at the start of an element, with its prefix.
fn tag(element: &str) -> &str {
    let name = element.strip_prefix('<').unwrap_or(element);
    let end = name.find(|character: char| character.is_ascii_whitespace() || matches!(character, '/' | '>'));
    &name[..end.unwrap_or(name.len())]
}

/// Returns the value of an attribute with the white space of its text, which XML replaces by spaces
/// and the engine keeps. A list of numbers has spaces.
fn exact(value: &str, text: &str) -> String {
    if !text.contains(['\t', '\n', '\r']) || value::numbers(value).is_some() {
        return value.to_owned();
    }
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let mut rest = text.chars();
    let mut exact = String::new();
    for character in value.chars() {
        let found = rest.next();
        if found == Some('&') {
            // A reference is one character of the value.
            rest.by_ref().find(|&character| character == ';');
        }
        exact.push(found.filter(|character| matches!(character, '\t' | '\n')).unwrap_or(character));
    }
    exact
}

/// Text of a tree, with at most one start tag in each line.
pub(super) struct Written {
    pub(super) text: String,
    /// The element of each line. A line with an end tag belongs to the same element as the start
    /// tag.
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

/// Appends an attribute value. Readers would replace white space by spaces, and a line break would
/// shift the numbers of the lines.
fn escape(value: &str, text: &mut String) {
    for character in value.chars() {
        match character {
            '&' => *text += "&amp;",
            '<' => *text += "&lt;",
            '>' => *text += "&gt;",
            '"' => *text += "&quot;",
            // No reader of XML accepts NUL.
            '\0' => text.push(character),
            _ if character.is_control() || control::is_not_xml(character) => {
                text.extend(["&#", &u32::from(character).to_string(), ";"]);
            }
            _ => text.push(character),
        }
    }
}
